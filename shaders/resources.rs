//! What a composed shader reads beside `scene`: the buffer `numbers`, and the passes that fill the tables in it on the device.
//!
//! A device crate makes every buffer, runs the passes in their order, and binds the buffers that have a binding; it need
//! not know what they are. They change with the transfer function and the data, not with the camera; where only the widgets'
//! numbers change, which are the last ones, a crate writes those alone.

use crate::choices::Choices;
use crate::parts::{Access, PartedArray, Parts};
use crate::places::{MEAN_HEAD, Places, TEXEL_BYTES, images};
use crate::text::{Shader, compose_pieces};
use crate::writer::Axis;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::{Error, Result};
use voltet_optics::integrators::{Extent, Integrator};
use voltet_optics::research::{PartialTable, Ramp, last_tile};
use voltet_optics::shading::Shading;

/// Buffers, and the passes that fill some of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Resources {
    /// In the order of their indices; those with a binding are the ones of [`Choices::storage_buffers`].
    pub buffers: Vec<Buffer>,
    /// Run once, in this order, before anything is drawn.
    pub passes: Vec<Pass>,
}

/// A storage buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct Buffer {
    /// As the text names it; a part has a name of its own.
    pub name: String,
    /// Its binding in group 0 of the composed shader, which reads it; `None`: only the passes know it.
    pub binding: Option<u32>,
    /// What it holds at first.
    pub contents: Contents,
}

/// What a buffer holds before the passes run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// Bytes at its beginning that passes fill.
    pub filled: u64,
    /// The bytes behind those.
    pub bytes: Vec<u8>,
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
        self.contents.filled + self.contents.bytes.len() as u64
    }
}

/// Side of a workgroup of the passes, as they state it.
const GROUP_SIDE: u32 = 8;

impl Resources {
    /// `axis`: how s is stored. `length`: the scene length in world units, in which D is counted. `extent` is looked at
    /// only where [`Integrator::has_table_of_lengths`] says so. `numbers`: those of [`crate::Parameters`].
    pub fn new(
        choices: &Choices,
        transfer_function: &TransferFunction,
        shading: &Shading,
        axis: Axis,
        length: f64,
        extent: &Extent,
        numbers: &[f32],
    ) -> Result<Resources> {
        let mut resources = Resources::default();
        let places = Places::new(transfer_function, shading, numbers.len() as u64);
        let count = |name: &str| shading.integrator.count(name).unwrap_or(0);
        match shading.integrator.name() {
            _ if choices.storage_buffers().is_empty() => {}
            "pre-integrated" | "pre-integrated-cylindrical" => {
                let ramp = Ramp::new(transfer_function, count("table_size"), count("oversampling"), extent)?;
                let tiles = last_tile_of(&shading.integrator);
                let entries = mean_extinctions(&ramp, tiles, axis, length / extent.longest)?;
                resources.glows(&ramp, tiles, choices, &places, &[&entries, numbers].concat());
            }
            name => {
                let mut all: Vec<f32> = images(transfer_function).flatten().flatten().copied().collect();
                if name == "segments" {
                    let density = transfer_function.model == OpticalModel::DensityEmitter;
                    all.extend(partial_table(&PartialTable::new(density, count("table_size"))));
                }
                all.extend(numbers);
                resources.numbers(choices, 0, &all);
            }
        }
        Ok(resources)
    }

    /// The buffer that the scene reads, in its parts: so many vectors that passes fill, then numbers. Gives their indices.
    fn numbers(&mut self, choices: &Choices, filled: u64, behind: &[f32]) -> Vec<usize> {
        let first = self.buffers.len();
        let mut rest = behind;
        for (part, (name, binding)) in (0u32..).zip(choices.storage_buffers()) {
            let parts = choices.layout.table;
            let room = 4 * parts.length(part, u64::MAX);
            let filled = parts.length(part, filled);
            let (numbers, others) = rest.split_at(rest.len().min((room - 4 * filled) as usize));
            rest = others;
            let mut bytes = bytemuck::cast_slice(numbers).to_vec();
            // Whole vectors.
            bytes.resize(bytes.len().next_multiple_of(TEXEL_BYTES as usize), 0);
            let contents = Contents { filled: filled * TEXEL_BYTES, bytes };
            self.buffers.push(Buffer { name, binding: Some(binding), contents });
        }
        (first..self.buffers.len()).collect()
    }

    /// The passes that fill the table over (D, s_f, s_b), and for tiles the one that resamples it.
    fn glows(
        &mut self,
        ramp: &Ramp,
        last_tile: Option<usize>,
        choices: &Choices,
        places: &Places,
        behind: &[f32],
    ) {
        let side = ramp.size() as u64;
        let across = (side as u32).div_ceil(GROUP_SIDE);
        let bytes = bytemuck::cast_slice(&matter(ramp)).to_vec();
        let ramp_at = self.own("ramp".into(), Contents { filled: 0, bytes });
        // Where what is read has one part, so has the table that it is made from, which is no larger.
        let parts = choices.layout.table;
        let sliced = parts.of_as_many(side.pow(3));
        let slices = match last_tile {
            Some(_) => (0..sliced.count)
                .map(|part| {
                    let filled = sliced.length(part, side.pow(3)) * TEXEL_BYTES;
                    self.own(Parts::name("slices", part), Contents { filled, bytes: Vec::new() })
                })
                .collect(),
            None => self.numbers(choices, places.vectors, behind)[..sliced.count as usize].to_vec(),
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
        if let Some(last) = last_tile {
            let tiled = parts.of_as_many(places.vectors);
            let tiles = self.numbers(choices, places.vectors, behind)[..tiled.count as usize].to_vec();
            let (read, written) = (array("glows", sliced), array("tiles", tiled));
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

    /// A buffer that only passes know. Gives its index.
    fn own(&mut self, name: String, contents: Contents) -> usize {
        self.buffers.push(Buffer { name, binding: None, contents });
        self.buffers.len() - 1
    }
}

/// The side; then φ, or F (1 + √T) and B (1 + √T) by turns.
fn partial_table(table: &PartialTable) -> Vec<f32> {
    let mut entries = vec![table.size() as f32];
    for (k, front) in table.front().iter().enumerate() {
        entries.push(*front);
        entries.extend(table.back().get(k));
    }
    entries
}

/// The number of tiles less 1, where the integrator has them.
fn last_tile_of(integrator: &Integrator) -> Option<usize> {
    let count = |name: &str| integrator.count(name).unwrap_or(0);
    (integrator.name() == "pre-integrated-cylindrical")
        .then(|| last_tile(count("table_size"), count("planes")))
}

/// The side, tiles less 1, where the first node is stored, nodes a stored unit, longest segments a scene length; then ρ̄.
fn mean_extinctions(ramp: &Ramp, last_tile: Option<usize>, axis: Axis, per_length: f64) -> Result<Vec<f32>> {
    let [low, high] = ramp.range;
    let steps = (ramp.size() - 1) as f64;
    let head = [axis.stored(low), steps * axis.scale / (high - low), per_length].map(|x| x as f32);
    if !head.iter().all(|x| x.is_finite()) {
        return Err(Error::run("the domain of a pre-integrated table leaves the range of 32 bits")
            .got(format!("scalars {low} to {high}"))
            .expected("a range that stored values tell apart"));
    }
    let counts = [ramp.size() as f32, last_tile.unwrap_or(0) as f32];
    let mut entries = [&counts[..], &head[..]].concat();
    debug_assert_eq!(entries.len() as u64, MEAN_HEAD);
    entries.extend(ramp.mean_extinctions());
    Ok(entries)
}

/// Glow and extinction of the nodes, then of the pieces of each step.
fn matter(ramp: &Ramp) -> Vec<[f32; 4]> {
    let all = ramp.nodes().iter().chain(ramp.pieces());
    let single = |x: f64| x.min(f64::from(f32::MAX)) as f32;
    all.map(|m| [m.glow[0], m.glow[1], m.glow[2], m.extinction].map(single)).collect()
}
