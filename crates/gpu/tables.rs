//! Data that a scene's shader reads beside its uniform: tables, filled on the device and kept while the scene needs the same ones,
//! and behind them the widgets' numbers, which are written where they change.

use crate::device::pipelines::{Bound, Program, in_order};
use crate::device::{Device, Timing};
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_optics::engine::Stage;
use voltet_optics::integrators::{Extent, Integrator};
use voltet_optics::shading::Shading;
use voltet_shaders::{Axis, Buffer, Contents, Pass, Places, Resources, ShaderKey, TEXEL_BYTES, images};

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TableKey {
    pub transfer_function: Arc<TransferFunction>,
    pub integrator: Integrator,
    pub axis: Axis,
    pub length: f64,
    pub extent: Extent,
}

impl TableKey {
    /// True if the tables of another are the same: those of lengths hold all of the scene, others images and what the model says.
    fn makes_those_of(&self, other: &TableKey) -> bool {
        if self.integrator.has_table_of_lengths() {
            return self == other;
        }
        let (mine, others) = (&*self.transfer_function, &*other.transfer_function);
        self.integrator == other.integrator && mine.model == others.model && images(mine).eq(images(others))
    }
}

/// The buffer `numbers` in its parts.
#[derive(Default)]
pub(crate) struct Tables {
    made: Option<BuiltTable>,
    buffers: Vec<(String, wgpu::Buffer)>,
}

struct BuiltTable {
    key: TableKey,
    /// Their layout.
    buffers: Vec<(String, u32)>,
    places: Places,
    /// Numbers of the widgets.
    numbers: Vec<f32>,
}

impl Tables {
    /// The tables of a scene, made if they are not there; `numbers` of its widgets are written if they are not.
    pub fn update(
        &mut self,
        device: &Device,
        scene: &TableKey,
        shader_key: &ShaderKey,
        shading: &Shading,
        numbers: &[f32],
    ) -> Result<&Tables> {
        let places = Places::new(&scene.transfer_function, shading, numbers.len() as u64);
        let buffers = shader_key.storage_buffers();
        let is_there = self.made.as_ref().is_some_and(|made| {
            made.buffers == buffers && made.places == places && made.key.makes_those_of(scene)
        });
        if !is_there {
            self.made = None;
            // There may not be room for both.
            self.buffers.clear();
            let TableKey { transfer_function, axis, length, extent, .. } = scene;
            let resources =
                Resources::new(shader_key, transfer_function, shading, *axis, *length, extent, numbers)?;
            self.buffers = resources.buffers.iter().map(|b| make(device, b)).collect::<Result<_>>()?;
            for pass in &resources.passes {
                self.fill(device, pass)?;
            }
            // What only the passes read is given up.
            let mut bound = resources.buffers.iter().map(|buffer| buffer.binding.is_some());
            self.buffers.retain(|_| bound.next().unwrap_or(false));
            self.made = Some(BuiltTable { key: scene.clone(), buffers, places, numbers: numbers.to_vec() });
        } else if let Some(made) = self.made.as_mut().filter(|made| made.numbers != numbers) {
            made.numbers = numbers.to_vec();
            let part_bytes = TEXEL_BYTES * shader_key.layout.table.length(0, u64::MAX);
            put(device, &self.buffers, 4 * places.first_number(), part_bytes, bytemuck::cast_slice(numbers))?;
        }
        Ok(self)
    }

    pub fn named(&self, name: &str) -> Result<&wgpu::Buffer> {
        let found = self.buffers.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, buffer)| buffer)
            .ok_or_else(|| Error::run("the shader reads a table that nothing fills").got(name))
    }

    fn fill(&self, device: &Device, pass: &Pass) -> Result<()> {
        let read = pass.buffers.len() - pass.written;
        let bound = pass.buffers.iter().enumerate().map(|(i, number)| {
            let kind = if i < read { Bound::Read } else { Bound::Write };
            (kind, &self.buffers[*number].1)
        });
        let filling = device.pass(&Program {
            name: (pass.entry_point, Stage::SetUp),
            shader: &pass.shader,
            constants: vec![],
            groups: [&in_order(bound), &[], &[]],
            workgroups: pass.workgroups,
        })?;
        device.submit("the tables", |encoder| filling.run(encoder, &mut Timing::default())).map(drop)
    }
}

/// Writes bytes to an array whose parts but the last have so many bytes each.
fn put(
    device: &Device,
    parts: &[(String, wgpu::Buffer)],
    at: u64,
    part_bytes: u64,
    bytes: &[u8],
) -> Result<()> {
    let mut rest = bytes;
    let mut at = at;
    while !rest.is_empty() {
        let (part, offset) = (at / part_bytes, at % part_bytes);
        let (now, later) = rest.split_at(rest.len().min((part_bytes - offset) as usize));
        let (_, buffer) = &parts[part as usize];
        device.guarded("the scene's numbers", || device.write(buffer, offset, now))?;
        at += now.len() as u64;
        rest = later;
    }
    Ok(())
}

fn make(device: &Device, buffer: &Buffer) -> Result<(String, wgpu::Buffer)> {
    let made = device.storage("the integrator's tables", buffer.length())?;
    let Contents { filled, bytes } = &buffer.contents;
    if !bytes.is_empty() {
        device.guarded("the integrator's tables", || device.write(&made, *filled, bytes))?;
    }
    Ok((buffer.name.clone(), made))
}
