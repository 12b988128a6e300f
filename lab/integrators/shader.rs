//! Shader text: the pieces under `wgsl/`, and the tables that they read.

use crate::settings::{OVERSAMPLING, PIECES as COUNT, PLANES, SIDE, count};
use crate::{PartialTable, Ramp, last_tile};
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::{Error, Result};
use voltet_optics::integrators::Integrator;
use voltet_shaders::{
    Access, Axis, Contents, PartedArray, Parts, Pass, Resources, TEXEL_BYTES, TableScene, TableSize,
    WgslCall, WgslIntegrator, WgslPiece, WgslTable, compose_pieces_with,
};

macro_rules! piece {
    ($name:literal) => {
        WgslPiece {
            name: $name,
            file: concat!("lab/integrators/wgsl/", $name, ".wgsl"),
            text: include_str!(concat!("wgsl/", $name, ".wgsl")),
        }
    };
}

/// The pieces, by name.
pub static PIECES: &[WgslPiece] = &[
    piece!("pre_integrated/bilinear"),
    piece!("pre_integrated/cylinder"),
    piece!("pre_integrated/fill_slices"),
    piece!("pre_integrated/fill_tiles"),
    piece!("pre_integrated/light"),
    piece!("pre_integrated/mean_extinctions"),
    piece!("pre_integrated/table"),
    piece!("pre_integrated/tiles"),
    piece!("pre_integrated/trilinear"),
    piece!("sampled/partial_constant"),
    piece!("sampled/partial_density"),
    piece!("sampled/partial_table"),
    piece!("sampled/riemann"),
    piece!("sampled/segments"),
];

/// Side of a workgroup of the passes, as they state it.
const GROUP_SIDE: u32 = 8;

/// Numbers before the entries of mean extinctions: side, tiles less 1, where the first node is stored, nodes a stored unit, longest
/// segments a scene length.
const MEAN_HEAD: u64 = 5;

/// The text of `riemann`.
pub(crate) struct RiemannText;

impl WgslIntegrator for RiemannText {
    fn name(&self) -> &'static str {
        "riemann"
    }

    fn pieces(&self) -> &'static [WgslPiece] {
        PIECES
    }

    fn call(&self, _: bool) -> WgslCall {
        WgslCall::Samples { function: "riemann", pieces: &["sampled/riemann"], reads_numbers: false }
    }

    fn piece_count(&self, integrator: &Integrator) -> Option<usize> {
        integrator.count(COUNT)
    }
}

/// The text of `segments`.
pub(crate) struct SegmentsText;

impl WgslIntegrator for SegmentsText {
    fn name(&self) -> &'static str {
        "segments"
    }

    fn pieces(&self) -> &'static [WgslPiece] {
        PIECES
    }

    fn call(&self, constant_emitter: bool) -> WgslCall {
        let pieces: &[&str] = match constant_emitter {
            true => &["sampled/segments", "sampled/partial_constant"],
            false => &["sampled/segments", "sampled/partial_density"],
        };
        WgslCall::Samples { function: "linear_pieces", pieces, reads_numbers: true }
    }

    fn piece_count(&self, integrator: &Integrator) -> Option<usize> {
        integrator.count(COUNT)
    }

    fn table_size(&self, integrator: &Integrator, transfer_function: &TransferFunction) -> TableSize {
        if transfer_function.widgets.is_empty() {
            return TableSize::default();
        }
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        let entries = PartialTable::bytes_of(density, count(integrator, SIDE)) / size_of::<f32>();
        TableSize { entries: 1 + entries as u64, ..TableSize::default() }
    }

    fn entries(&self, integrator: &Integrator, transfer_function: &TransferFunction) -> Vec<f32> {
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        partial_entries(&PartialTable::new(density, count(integrator, SIDE)))
    }
}

/// The text of `pre-integrated`.
pub(crate) struct PreIntegratedText;

impl WgslIntegrator for PreIntegratedText {
    fn name(&self) -> &'static str {
        "pre-integrated"
    }

    fn pieces(&self) -> &'static [WgslPiece] {
        PIECES
    }

    fn call(&self, _: bool) -> WgslCall {
        let pieces = &["pre_integrated/light", "pre_integrated/table"];
        WgslCall::Table { function: "pre_integrated_light", pieces }
    }

    fn table_size(&self, integrator: &Integrator, _: &TransferFunction) -> TableSize {
        let [square, cube] = [2, 3].map(|power| (count(integrator, SIDE) as u64).saturating_pow(power));
        TableSize { vectors: cube, source_vectors: 0, entries: square.saturating_add(MEAN_HEAD) }
    }
}

impl WgslTable for PreIntegratedText {
    fn fill(&self, resources: &mut Resources, scene: &TableScene<'_>) -> Result<()> {
        fill(resources, None, scene)
    }
}

/// The text of `pre-integrated-cylindrical`.
pub(crate) struct CylindricalText;

impl WgslIntegrator for CylindricalText {
    fn name(&self) -> &'static str {
        "pre-integrated-cylindrical"
    }

    fn pieces(&self) -> &'static [WgslPiece] {
        PIECES
    }

    fn call(&self, _: bool) -> WgslCall {
        let pieces = &["pre_integrated/light", "pre_integrated/tiles"];
        WgslCall::Table { function: "pre_integrated_light", pieces }
    }

    fn table_size(&self, integrator: &Integrator, _: &TransferFunction) -> TableSize {
        let [square, cube] = [2, 3].map(|power| (count(integrator, SIDE) as u64).saturating_pow(power));
        TableSize {
            vectors: square.saturating_mul(tiles(integrator) as u64 + 1),
            source_vectors: cube,
            entries: square.saturating_add(MEAN_HEAD),
        }
    }
}

impl WgslTable for CylindricalText {
    fn fill(&self, resources: &mut Resources, scene: &TableScene<'_>) -> Result<()> {
        fill(resources, Some(tiles(scene.integrator)), scene)
    }
}

/// Tiles less 1.
fn tiles(integrator: &Integrator) -> usize {
    last_tile(count(integrator, SIDE), count(integrator, PLANES))
}

/// Adds the buffers and passes of a pre-integrated table, or of its tiles.
fn fill(resources: &mut Resources, last_tile: Option<usize>, scene: &TableScene<'_>) -> Result<()> {
    let TableScene { integrator, transfer_function, axis, length, extent, numbers, .. } = *scene;
    let side = count(integrator, SIDE);
    let ramp = Ramp::new(transfer_function, side, count(integrator, OVERSAMPLING), extent)?;
    let entries = mean_extinctions(&ramp, last_tile, axis, length / extent.longest)?;
    add_passes(resources, &ramp, last_tile, scene, &[&entries, numbers].concat());
    Ok(())
}

/// The passes that fill the table over (D, s_f, s_b), and for tiles the one that resamples it.
fn add_passes(
    resources: &mut Resources,
    ramp: &Ramp,
    last_tile: Option<usize>,
    scene: &TableScene<'_>,
    behind: &[f32],
) {
    let TableScene { shader_key, places, .. } = *scene;
    let side = ramp.size() as u64;
    let across = (side as u32).div_ceil(GROUP_SIDE);
    let bytes = bytemuck::cast_slice(&matter(ramp)).to_vec();
    let ramp_at = resources.add_buffer("ramp".into(), Contents { filled: 0, bytes });
    // Where what is read has one part, so has the table that it is made from, which is no larger.
    let parts = shader_key.layout.table;
    let sliced = parts.with_count(side.pow(3));
    let slices = match last_tile {
        Some(_) => (0..sliced.count)
            .map(|part| {
                let filled = sliced.length(part, side.pow(3)) * TEXEL_BYTES;
                resources.add_buffer(Parts::name("slices", part), Contents { filled, bytes: Vec::new() })
            })
            .collect(),
        None => resources.add_numbers(shader_key, places.vectors, behind)[..sliced.count as usize].to_vec(),
    };
    let array = |name, parts| PartedArray { name, element: "vec4f", stride: None, parts };
    let written = array("slices", sliced);
    let mut text = format!("const SIDE = {side}u;\nconst PARTS = {}u;\n", ramp.parts());
    text += &written.declared(Access::Write, 0, |part| 1 + part);
    text += &written.written_by("put_slice");
    resources.passes.push(Pass {
        shader: compose_pieces_with(&text, &["pre_integrated/fill_slices"], PIECES),
        entry_point: "fill_slices",
        written: slices.len(),
        buffers: std::iter::once(ramp_at).chain(slices.iter().copied()).collect(),
        workgroups: [across, across, side as u32],
    });
    if let Some(last) = last_tile {
        let tiled = parts.with_count(places.vectors);
        let tiles =
            resources.add_numbers(shader_key, places.vectors, behind)[..tiled.count as usize].to_vec();
        let (read, written) = (array("glows", sliced), array("tiles", tiled));
        let mut text = format!("const SIDE = {side}u;\nconst LAST_TILE = {last}u;\n");
        text += &read.declared(Access::Read, 0, |part| part);
        text += &read.read_by("glow");
        text += &written.declared(Access::Write, 0, |part| sliced.count + part);
        text += &written.written_by("put_tile");
        resources.passes.push(Pass {
            shader: compose_pieces_with(&text, &["pre_integrated/fill_tiles"], PIECES),
            entry_point: "fill_tiles",
            written: tiles.len(),
            buffers: slices.into_iter().chain(tiles).collect(),
            workgroups: [across, across, last as u32 + 1],
        });
    }
}

/// The side; then φ, or F (1 + √T) and B (1 + √T) by turns.
fn partial_entries(table: &PartialTable) -> Vec<f32> {
    let mut entries = vec![table.size() as f32];
    for (k, front) in table.front().iter().enumerate() {
        entries.push(*front);
        entries.extend(table.back().get(k));
    }
    entries
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

#[cfg(test)]
mod tests {
    use super::PIECES;

    #[test]
    fn every_header_is_complete_and_names_pieces() {
        for piece in PIECES {
            let header = piece.text.lines().next().unwrap_or("");
            assert!(header.starts_with("// Uses: ") && header.contains(". Fills: "), "{}", piece.file);
            for name in piece.uses() {
                let known = PIECES.iter().any(|other| other.name == name);
                assert!(known || voltet_shaders::piece(name).is_some(), "{} uses '{name}'", piece.file);
            }
        }
    }
}
