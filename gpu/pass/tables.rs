//! Tables that a scene's shader reads: filled on the device, kept while the scene asks for the same ones.

use crate::device::bindings::{Bound, in_order};
use crate::device::open::Device;
use crate::device::pipelines::Program;
use std::sync::Arc;
use voltet_core::optics::integrators::{Extent, Integrator};
use voltet_core::shading::Shading;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_shaders::{Axis, Buffer, Choices, Contents, Pass, Resources};

/// What tables are made from.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct TableKey {
    pub transfer_function: Arc<TransferFunction>,
    pub integrator: Integrator,
    pub axis: Axis,
    pub length: f64,
    pub extent: Extent,
}

/// Buffers by name.
#[derive(Default)]
pub(crate) struct Tables {
    made: Option<(TableKey, Choices)>,
    buffers: Vec<(String, wgpu::Buffer)>,
}

impl Tables {
    /// Those of a scene, made if they are not there.
    pub fn of(
        &mut self,
        device: &Device,
        scene: &TableKey,
        choices: &Choices,
        shading: &Shading,
    ) -> Result<&Tables> {
        let key = (scene.clone(), choices.clone());
        if self.made.as_ref() != Some(&key) {
            self.made = None;
            // There may not be room for both.
            self.buffers.clear();
            let TableKey { transfer_function, axis, length, extent, .. } = scene;
            let resources = Resources::new(choices, transfer_function, shading, *axis, *length, extent)?;
            self.buffers = resources.buffers.iter().map(|b| make(device, b)).collect::<Result<_>>()?;
            for pass in &resources.passes {
                self.fill(device, pass)?;
            }
            // What only the passes read is given up.
            let mut bound = resources.buffers.iter().map(|buffer| buffer.binding.is_some());
            self.buffers.retain(|_| bound.next().unwrap_or(false));
            self.made = Some(key);
        }
        Ok(self)
    }

    /// The buffer of that name.
    pub fn named(&self, name: &str) -> Result<&wgpu::Buffer> {
        let found = self.buffers.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, buffer)| buffer)
            .ok_or_else(|| Error::run("the shader reads a table that nothing fills").found(name))
    }

    fn fill(&self, device: &Device, pass: &Pass) -> Result<()> {
        let read = pass.buffers.len() - pass.written;
        let kinds: Vec<Bound> =
            (0..pass.buffers.len()).map(|i| if i < read { Bound::Read } else { Bound::Write }).collect();
        let pipeline = device.pipeline(&Program {
            shader: &pass.shader,
            entry_point: pass.entry_point,
            constants: vec![],
            groups: [&in_order(&kinds), &[], &[]],
        })?;
        let buffers: Vec<&wgpu::Buffer> = pass.buffers.iter().map(|i| &self.buffers[*i].1).collect();
        let group = device.bind(&pipeline, 0, &in_order(&buffers));
        let [x, y, z] = pass.workgroups;
        device.guarded("the tables", || {
            let mut encoder = device.device.create_command_encoder(&Default::default());
            let mut compute = encoder.begin_compute_pass(&Default::default());
            compute.set_pipeline(&pipeline);
            compute.set_bind_group(0, &group, &[]);
            compute.dispatch_workgroups(x, y, z);
            drop(compute);
            device.queue.submit([encoder.finish()]);
        })
    }
}

fn make(device: &Device, buffer: &Buffer) -> Result<(String, wgpu::Buffer)> {
    let made = device.storage("the integrator's tables", buffer.length())?;
    if let Contents::Bytes(bytes) = &buffer.contents {
        let mut whole = bytes.clone();
        whole.resize(bytes.len().next_multiple_of(4), 0);
        device.guarded("the integrator's tables", || device.write(&made, 0, &whole))?;
    }
    Ok((buffer.name.clone(), made))
}
