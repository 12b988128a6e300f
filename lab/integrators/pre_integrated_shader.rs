//! Shader text of pre-integrated tables: the buffers and passes that fill them on a device.

use crate::ramp::{Ramp, single};
use crate::settings::{OVERSAMPLING, SIDE, WGSL_PIECES, count};
use voltet_core::{Error, Result};
use voltet_shaders::{
    Access, Axis, Contents, PartedArray, Parts, Pass, Resources, TEXEL_BYTES, TableScene, compose_pieces_with,
};

/// Side of a workgroup of the passes, as they state it.
const GROUP_SIDE: u32 = 8;

/// Numbers before the entries of mean extinctions: side, tiles less 1, where the first node is stored, nodes a stored unit, longest
/// segments a scene length.
pub(crate) const MEAN_HEAD: u64 = 5;

/// Adds the buffers and passes of a pre-integrated table, or of its tiles.
pub(crate) fn fill(
    resources: &mut Resources,
    last_tile: Option<usize>,
    scene: &TableScene<'_>,
) -> Result<()> {
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
        shader: compose_pieces_with(&text, &["pre_integrated/fill_slices"], WGSL_PIECES),
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
            shader: compose_pieces_with(&text, &["pre_integrated/fill_tiles"], WGSL_PIECES),
            entry_point: "fill_tiles",
            written: tiles.len(),
            buffers: slices.into_iter().chain(tiles).collect(),
            workgroups: [across, across, last as u32 + 1],
        });
    }
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
    all.map(|m| [m.glow[0], m.glow[1], m.glow[2], m.extinction].map(single)).collect()
}
