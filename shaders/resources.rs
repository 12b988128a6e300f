//! What a composed shader reads beside `scene` and `numbers`: tables, and the passes that fill them on the device.
//!
//! A device crate makes every buffer, runs the passes in their order, and binds the buffers that have a binding; it need
//! not know what they are. They change with the transfer function and the data, not with the camera.

use crate::choices::Choices;
use crate::parts::{Access, PartedArray, Parts};
use crate::text::{Shader, compose_pieces};
use crate::writer::Axis;
use voltet_core::optics::integrators::{Extent, Integrator, PartialTable, Ramp, last_tile};
use voltet_core::shading::Shading;
use voltet_core::transfer::{ColorSource, OpticalModel, TransferFunction};
use voltet_core::{Error, Result};

/// Buffers, and the passes that fill some of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Resources {
    /// In the order of their indices; those with a binding are the ones of [`Choices::storage_buffers`] but `numbers`.
    pub buffers: Vec<Buffer>,
    /// Run once, in this order, before anything is drawn.
    pub passes: Vec<Pass>,
}

/// A storage buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct Buffer {
    /// As the text names it; a part of a table has a name of its own.
    pub name: String,
    /// Its binding in group 0 of the composed shader, which reads it; `None`: only the passes know it.
    pub binding: Option<u32>,
    /// What it holds at first.
    pub contents: Contents,
}

/// What a buffer holds before the passes run.
#[derive(Debug, Clone, PartialEq)]
pub enum Contents {
    /// These bytes.
    Bytes(Vec<u8>),
    /// Nothing: a pass fills all of it. Its length in bytes.
    Empty(u64),
}

/// A compute pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// Its text.
    pub shader: Shader,
    /// Its entry point.
    pub entry_point: &'static str,
    /// Indices of buffers, bound in group 0 at 0, 1, ….
    pub buffers: Vec<usize>,
    /// How many of the last ones are written; the others are only read.
    pub written: usize,
    /// Workgroups to dispatch.
    pub workgroups: [u32; 3],
}

impl Buffer {
    /// Its length in bytes.
    pub fn length(&self) -> u64 {
        match &self.contents {
            Contents::Bytes(bytes) => bytes.len() as u64,
            Contents::Empty(length) => *length,
        }
    }
}

/// Side of a workgroup of the passes, as they state it.
const GROUP_SIDE: u32 = 8;

impl Resources {
    /// `axis`: how s is stored. `length`: the scene length in world units, in which D is counted. `extent` is looked at
    /// only where [`Integrator::has_table_of_lengths`] says so.
    pub fn new(
        choices: &Choices,
        transfer_function: &TransferFunction,
        shading: &Shading,
        axis: Axis,
        length: f64,
        extent: &Extent,
    ) -> Result<Resources> {
        let mut resources = Resources::default();
        let bindings = choices.storage_buffers();
        let binding = |name| bindings.iter().find(|(other, _)| other == name).map(|(_, binding)| *binding);
        match shading.integrator {
            Integrator::Segments { table_size, .. } if binding("partial_table").is_some() => {
                let density = transfer_function.model == OpticalModel::DensityEmitter;
                let bytes = partial_table(&PartialTable::new(density, table_size));
                resources.bytes("partial_table", binding("partial_table"), &bytes);
            }
            Integrator::PreIntegrated { table_size, oversampling }
            | Integrator::PreIntegratedCylindrical { table_size, oversampling, .. } => {
                let ramp = Ramp::new(transfer_function, table_size, oversampling, extent)?;
                let tiles = last_tile_of(&shading.integrator);
                let bytes = mean_extinctions(&ramp, tiles, axis, length / extent.longest)?;
                resources.bytes("mean_extinctions", binding("mean_extinctions"), &bytes);
                resources.glows(&ramp, tiles, choices);
            }
            _ => {}
        }
        if binding("texels").is_some() {
            resources.images(choices, &images(transfer_function).flatten().copied().collect::<Vec<_>>());
        }
        Ok(resources)
    }

    fn bytes(&mut self, name: &str, binding: Option<u32>, bytes: &[u8]) {
        self.buffers.push(Buffer { name: name.into(), binding, contents: Contents::Bytes(bytes.to_vec()) });
    }

    fn images(&mut self, choices: &Choices, texels: &[[f32; 4]]) {
        let mut rest = texels;
        for part in 0..choices.layout.table.count {
            let length = choices.layout.table.length(part, texels.len() as u64) as usize;
            let (texels, others) = rest.split_at(length);
            rest = others;
            let bytes = bytemuck::cast_slice(texels);
            self.bytes(&Parts::name("texels", part), Some(choices.table_binding(part)), bytes);
        }
    }

    /// A table of vectors that a pass fills, one buffer a part. Gives their indices.
    fn table(
        &mut self,
        name: &str,
        parts: Parts,
        length: u64,
        binding: impl Fn(u32) -> Option<u32>,
    ) -> Vec<usize> {
        let first = self.buffers.len();
        for part in 0..parts.count {
            let contents = Contents::Empty(parts.length(part, length) * TEXEL_BYTES);
            self.buffers.push(Buffer { name: Parts::name(name, part), binding: binding(part), contents });
        }
        (first..self.buffers.len()).collect()
    }

    /// The passes that fill the table over (D, s_f, s_b), and for tiles the one that resamples it.
    fn glows(&mut self, ramp: &Ramp, last_tile: Option<usize>, choices: &Choices) {
        let side = ramp.size() as u64;
        let across = (side as u32).div_ceil(GROUP_SIDE);
        self.bytes("ramp", None, bytemuck::cast_slice(&matter(ramp)));
        let ramp_at = self.buffers.len() - 1;
        // Where tiles have one part, so has the table that they are made from, which is no larger.
        let parts = choices.layout.table;
        let sliced = parts.of_as_many(side.pow(3));
        let binding = |part| Some(choices.table_binding(part));
        let slices = match last_tile.is_some() {
            true => self.table("slices", sliced, side.pow(3), |_| None),
            false => self.table("glows", sliced, side.pow(3), binding),
        };
        let array = |name, parts| PartedArray { name, element: "vec4f", stride: None, parts };
        let written = array("slices", sliced);
        let mut text = format!("const SIDE = {side}u;\nconst PARTS = {}u;\n", ramp.parts());
        text += &written.declared(Access::Write, 0, |part| 1 + part);
        text += &written.written_by("put_slice");
        self.passes.push(Pass {
            shader: compose_pieces(&text, &["pre_integrated/fill_slices"]),
            entry_point: "fill_slices",
            written: slices.len(),
            buffers: std::iter::once(ramp_at).chain(slices.iter().copied()).collect(),
            workgroups: [across, across, side as u32],
        });
        if let Some(last) = last_tile.map(|last| last as u64) {
            let tiles = self.table("glows", parts, side * side * (last + 1), binding);
            let (read, written) = (array("glows", sliced), array("tiles", parts));
            let mut text = format!("const SIDE = {side}u;\nconst LAST_TILE = {last}u;\n");
            text += &read.declared(Access::Read, 0, |part| part);
            text += &read.read_by("glow");
            text += &written.declared(Access::Write, 0, |part| sliced.count + part);
            text += &written.written_by("put_tile");
            self.passes.push(Pass {
                shader: compose_pieces(&text, &["pre_integrated/fill_tiles"]),
                entry_point: "fill_tiles",
                written: tiles.len(),
                buffers: slices.into_iter().chain(tiles).collect(),
                workgroups: [across, across, last as u32 + 1],
            });
        }
    }
}

/// Vectors of the table that a scene reads, and of the one that it is made from; 0 without one.
pub fn table_lengths(choices: &Choices, transfer_function: &TransferFunction, shading: &Shading) -> [u64; 2] {
    match (choices.table(), shading.integrator) {
        (None, _) => [0, 0],
        (_, Integrator::PreIntegrated { table_size: side, .. }) => [(side as u64).saturating_pow(3), 0],
        (_, Integrator::PreIntegratedCylindrical { table_size: side, planes, .. }) => {
            let tiles = last_tile(side, planes) as u64 + 1;
            let square = (side as u64).saturating_pow(2);
            [square.saturating_mul(tiles), square.saturating_mul(side as u64)]
        }
        _ => [images(transfer_function).map(|texels| texels.len() as u64).sum(), 0],
    }
}

/// Bytes of a vector of a table.
pub const TEXEL_BYTES: u64 = 16;

/// Texels of each table widget.
fn images(transfer_function: &TransferFunction) -> impl Iterator<Item = &[[f32; 4]]> {
    transfer_function.widgets.iter().filter_map(|widget| match widget.profile.properties().color {
        ColorSource::Texels(texels) => Some(texels),
        ColorSource::Widget | ColorSource::Points(_) => None,
    })
}

/// The side; then φ, or F (1 + √T) and B (1 + √T) by turns.
fn partial_table(table: &PartialTable) -> Vec<u8> {
    let mut bytes = (table.size() as u32).to_le_bytes().to_vec();
    for (k, front) in table.front().iter().enumerate() {
        bytes.extend(front.to_le_bytes());
        bytes.extend(table.back().get(k).map(|back| back.to_le_bytes()).into_iter().flatten());
    }
    bytes
}

/// The number of tiles less 1, where the integrator has them.
fn last_tile_of(integrator: &Integrator) -> Option<usize> {
    match *integrator {
        Integrator::PreIntegratedCylindrical { table_size, planes, .. } => {
            Some(last_tile(table_size, planes))
        }
        _ => None,
    }
}

/// The side, tiles less 1, where the first node is stored, nodes a stored unit, longest segments a scene length; then ρ̄.
fn mean_extinctions(ramp: &Ramp, last_tile: Option<usize>, axis: Axis, per_length: f64) -> Result<Vec<u8>> {
    let [low, high] = ramp.range;
    let steps = (ramp.size() - 1) as f64;
    let head = [axis.stored(low), steps * axis.scale / (high - low), per_length].map(|x| x as f32);
    if !head.iter().all(|x| x.is_finite()) {
        return Err(Error::run("the domain of a pre-integrated table leaves the range of 32 bits")
            .found(format!("scalars {low} to {high}"))
            .accepted("a range that stored values tell apart"));
    }
    let mut bytes = (ramp.size() as u32).to_le_bytes().to_vec();
    bytes.extend((last_tile.unwrap_or(0) as u32).to_le_bytes());
    bytes.extend_from_slice(bytemuck::cast_slice(&head));
    bytes.extend_from_slice(bytemuck::cast_slice(&ramp.mean_extinctions()));
    Ok(bytes)
}

/// Glow and extinction of the nodes, then of the pieces of each step.
fn matter(ramp: &Ramp) -> Vec<[f32; 4]> {
    let all = ramp.nodes().iter().chain(ramp.pieces());
    let single = |x: f64| x.min(f64::from(f32::MAX)) as f32;
    all.map(|m| [m.glow[0], m.glow[1], m.glow[2], m.extinction].map(single)).collect()
}
