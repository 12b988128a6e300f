//! Pre-integration of a transfer function of the scalar alone: a table over (s_f, s_b, D), or the same resampled to two-dimensional tiles.
//!
//! Roettger & Ertl 2002, section 3, with its sums corrected (module `ramp`). Kept are the mean extinction ρ̄ of a
//! path, which does not depend on D, and C/(D E₁(ρ̄D)) with E₁(T) = (1 − e^(−T))/T: both vary slowly where C and A
//! themselves rise and saturate, so that T = ρ̄D and A = 1 − e^(−T) have no error along D, C ≤ c A holds between
//! entries, and a colour is never darkened towards where nothing is. Slices lie at D = (k/(n − 1))² of the longest
//! segment, closer where D is small. Trilinear; the error falls with the side (bench `tables`).
//!
//! Tiles, section 4: the pixels of one cell lie on a plane through the diagonal s_f = s_b, D = 0, so two tiles,
//! the nearest in the angle α, hold a whole cell. Symbols: s_f, s_b, l the ends and the length, each over [0, 1];
//! α ∈ [0, 1] the plane, s and t the place on its tile, t = s_b. f of Eq. 9 fills the tiles, f⁻¹ of Eq. 10 reads
//! them; at s_f = s_b, l = 0 every α serves. A place of a tile whose s_f is outside [0, 1] takes the nearest inside,
//! so that the linear filter does not read nothing. In perspective α varies over a cell; it is taken anew for each
//! segment.

use crate::ramp::{Material, Ramp, last_tile, single};
use crate::settings::{
    MAX_PLANES, MAX_TABLE_SIDE, OVERSAMPLING, OVERSAMPLING_PARAMETER, PLANES, PLANES_PARAMETER,
    PreparedKernel, SIDE, SIDE_PARAMETER, WGSL_PIECES, boxed, count, widget_label,
};
use crate::square::{Bilinear, LaneSquare};
use rayon::prelude::*;
use std::any::Any;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_cpu::integrator::{
    LaneExtension, LaneIntegratorKind, LaneKernel, LaneScene, NEGLIGIBLE_DEPTH, SegmentBatch, SegmentResults,
};
use voltet_optics::integrators::{
    Extent, Integrator, IntegratorKind, Obstacle, SegmentIntegrator, TableDomain, can_serve,
};
use voltet_optics::special::{mean_transmittance, opacity};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_shaders::{
    Access, Axis, Contents, PartedArray, Parts, Pass, Resources, TEXEL_BYTES, TableScene, TableSize,
    WgslCall, WgslExtension, WgslIntegrator, WgslPiece, WgslTable, WgslTableExtension, compose_pieces_with,
};
use voltet_simd::optics::elementary::mean_transparency;
use voltet_simd::{Float, Lanes, Mask, Unsigned, array, inlined};

/// A three-dimensional table: 2 … [`MAX_TABLE_SIDE`] entries a side, 1 … [`crate::MAX_OVERSAMPLING`] pieces of a path from one to the next.
pub const fn pre_integrated(side: usize, oversampling: usize) -> Integrator {
    Integrator::with_settings(&TABLE, [side as f64, oversampling as f64])
}

/// The table of [`pre_integrated`], resampled to `planes` tiles for each entry of a side, 1 … [`MAX_PLANES`]; all of them take no more
/// memory than those of the largest side with one.
pub const fn pre_integrated_cylindrical(side: usize, oversampling: usize, planes: usize) -> Integrator {
    Integrator::with_settings(&TILES, [side as f64, oversampling as f64, planes as f64])
}

pub(crate) const TABLE: PreIntegratedKind = PreIntegratedKind { tiles: false };

pub(crate) const TILES: PreIntegratedKind = PreIntegratedKind { tiles: true };

const MAX_TILE_ENTRIES: usize = MAX_TABLE_SIDE * MAX_TABLE_SIDE * (last_tile(MAX_TABLE_SIDE, 1) + 1);

pub(crate) struct PreIntegratedKind {
    tiles: bool,
}

impl PreIntegratedKind {
    /// Number of tiles less 1, where there are tiles.
    fn last_tile(&self, integrator: &Integrator) -> Option<usize> {
        self.tiles.then(|| last_tile(count(integrator, SIDE), count(integrator, PLANES)))
    }

    fn filled(
        &self,
        integrator: &Integrator,
        function: &TransferFunction,
        extent: &Extent,
    ) -> Result<PreIntegrated> {
        let [side, oversampling, planes] = [SIDE, OVERSAMPLING, PLANES].map(|name| count(integrator, name));
        PreIntegrated::new(function, side, oversampling, self.tiles.then_some(planes), extent)
    }
}

impl IntegratorKind for PreIntegratedKind {
    fn schema(&self) -> VariantSchema {
        match self.tiles {
            false => VariantSchema {
                name: "pre-integrated",
                summary: "a three-dimensional table, for transfer functions of the scalar alone",
                parameters: &[SIDE_PARAMETER, OVERSAMPLING_PARAMETER],
            },
            true => VariantSchema {
                name: "pre-integrated-cylindrical",
                summary: "the same table as tiles",
                parameters: &[SIDE_PARAMETER, OVERSAMPLING_PARAMETER, PLANES_PARAMETER],
            },
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        integrator.check_ranges()?;
        let side = count(integrator, SIDE);
        let fit = |planes: &usize| side * side * (last_tile(side, *planes) + 1) <= MAX_TILE_ENTRIES;
        let max = (1..=MAX_PLANES).rev().find(fit).unwrap_or(1);
        match count(integrator, PLANES) {
            planes if planes <= max => Ok(()),
            planes => {
                let what = format!("{PLANES}, with table_size = {side},");
                Err(integrator.out_of_range(&what, planes, format!("1 to {max}")))
            }
        }
    }

    fn obstacle(&self, transfer_function: &TransferFunction) -> Option<Obstacle> {
        let mut widgets = transfer_function.widgets.iter().enumerate();
        let found = widgets.find_map(|(number, widget)| {
            let why = match widget.profile.properties().fields.is_empty() {
                _ if widget.uses_gradient_magnitude() => "which reads the gradient magnitude",
                true => return None,
                false => "which reads further fields",
            };
            Some(widget_label(transfer_function, number, why))
        })?;
        Some(Obstacle { found, accepted: "widgets of the scalar alone" })
    }

    fn table(&self) -> TableDomain {
        TableDomain::Data
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        function: &TransferFunction,
        extent: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(self.filled(integrator, function, extent)?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        match self.tiles {
            false => &[&LaneExtension(&TABLE), &WgslExtension(&TABLE), &WgslTableExtension(&TABLE)],
            true => &[&LaneExtension(&TILES), &WgslExtension(&TILES), &WgslTableExtension(&TILES)],
        }
    }
}

impl LaneIntegratorKind for PreIntegratedKind {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<PreparedKernel> {
        let table = self.filled(integrator, scene.transfer_function, scene.extent())?;
        Ok(Ok(boxed(LaneTable::new(table, scene))))
    }

    fn integrates_all(&self) -> bool {
        true
    }
}

impl WgslIntegrator for PreIntegratedKind {
    fn pieces(&self) -> &'static [WgslPiece] {
        WGSL_PIECES
    }

    fn call(&self, _: bool) -> WgslCall {
        let pieces: &[&str] = match self.tiles {
            false => &["pre_integrated/light", "pre_integrated/table"],
            true => &["pre_integrated/light", "pre_integrated/tiles"],
        };
        WgslCall::Table { function: "pre_integrated_light", pieces }
    }

    fn table_size(&self, integrator: &Integrator, _: &TransferFunction) -> TableSize {
        let [square, cube] = [2, 3].map(|power| (count(integrator, SIDE) as u64).saturating_pow(power));
        let entries = square.saturating_add(MEAN_HEAD);
        match self.last_tile(integrator) {
            None => TableSize { vectors: cube, source_vectors: 0, entries },
            Some(last) => {
                let vectors = square.saturating_mul(last as u64 + 1);
                TableSize { vectors, source_vectors: cube, entries }
            }
        }
    }
}

impl WgslTable for PreIntegratedKind {
    fn fill(&self, resources: &mut Resources, scene: &TableScene<'_>) -> Result<()> {
        let TableScene { integrator, transfer_function, axis, length, extent, numbers, .. } = *scene;
        let side = count(integrator, SIDE);
        let last_tile = self.last_tile(integrator);
        let ramp = Ramp::new(transfer_function, side, count(integrator, OVERSAMPLING), extent)?;
        let entries = mean_extinctions(&ramp, last_tile, axis, length / extent.longest)?;
        add_passes(resources, &ramp, last_tile, scene, &[&entries, numbers].concat());
        Ok(())
    }
}

/// The table in 64 bits, or the tiles that it is resampled to.
#[derive(Debug, Clone)]
pub struct PreIntegrated {
    pub(crate) ramp: Ramp,
    longest: f64,
    /// ρ̄ by (s_f, s_b).
    pub(crate) extinction: Vec<f32>,
    /// Number of tiles less 1, a multiple of 4, so that the mapping's creases lie on tiles.
    pub(crate) last_tile: Option<usize>,
    /// C/(D E₁) and ρ̄ by (D, s_f, s_b); of tiles C/(D E₁) by (α, s, t).
    pub glow: Vec<[f32; 4]>,
}

impl PreIntegrated {
    /// Fills the table on all cores. Serves transfer functions of the scalar alone; `table_size` entries a side,
    /// 2 … [`super::MAX_TABLE_SIDE`], `oversampling` pieces from one to the next, 1 … [`super::MAX_OVERSAMPLING`].
    /// Segments longer than the extent's longest take the colour of that one. With `planes` it is resampled to `planes` × `table_size`
    /// (rounded up to a multiple of 4) and one more tiles: with 1 they take as much memory as the table. The paper holds four times
    /// its side for enough to lose nothing.
    pub fn new(
        transfer_function: &TransferFunction,
        table_size: usize,
        oversampling: usize,
        planes: Option<usize>,
        extent: &Extent,
    ) -> Result<Self> {
        can_serve(&pre_integrated(table_size, oversampling), transfer_function)?;
        let ramp = Ramp::new(transfer_function, table_size, oversampling, extent)?;
        let extinction = ramp.mean_extinctions();
        let slice = table_size * table_size;
        let mut glow = vec![[0.0; 4]; slice * table_size];
        glow.par_chunks_mut(slice).enumerate().for_each(|(k, slice)| {
            let share = k as f64 / (table_size - 1) as f64;
            ramp.fill(share * share, slice);
            slice.iter_mut().zip(&extinction).for_each(|(entry, mean)| entry[3] = *mean);
        });
        let table = PreIntegrated { extinction, longest: extent.longest, ramp, last_tile: None, glow };
        let Some(planes) = planes else { return Ok(table) };
        let last = last_tile(table_size, planes);
        let mut tiles = vec![[0.0; 4]; table_size * table_size * (last + 1)];
        let step = (table_size - 1) as f64;
        tiles.par_chunks_mut(table_size * table_size).enumerate().for_each(|(plane, tile)| {
            for (k, texel) in tile.iter_mut().enumerate() {
                let (s, t) = ((k / table_size) as f64 / step, (k % table_size) as f64 / step);
                // Where s_f lies outside [0, 1] the nearest inside is taken, so that the linear filter does not read nothing.
                let [front, back, length] = from_cylinder(plane as f64 / last as f64, s, t);
                let [r, g, b] = table.glow_at(front.clamp(0.0, 1.0) * step, back * step, length);
                *texel = [r as f32, g as f32, b as f32, 0.0];
            }
        });
        Ok(PreIntegrated { last_tile: Some(last), glow: tiles, ..table })
    }

    /// C/(D E₁) at places in s, and the share of the longest segment.
    fn glow_at(&self, front: f64, back: f64, share: f64) -> [f64; 3] {
        let n = self.ramp.size();
        let step = (n - 1) as f64;
        let (plane, last, at) = match self.last_tile {
            None => (share.clamp(0.0, 1.0).sqrt() * step, n - 1, Bilinear::new(front, back, n)),
            Some(last) => {
                let [angle, s, t] = to_cylinder(front / step, back / step, share.min(1.0));
                (angle * last as f64, last, Bilinear::new(s * step, t * step, n))
            }
        };
        let low = (plane as usize).min(last - 1);
        let read = |k: usize, c: usize| at.read(|entry| f64::from(self.glow[k * n * n + entry][c]));
        std::array::from_fn(|c| {
            let near = read(low, c);
            near + (plane - low as f64) * (read(low + 1, c) - near)
        })
    }
}

impl SegmentIntegrator for PreIntegrated {
    fn table_bytes(&self) -> usize {
        size_of_val(self.extinction.as_slice()) + size_of_val(self.glow.as_slice())
    }

    /// Values that are not numbers contribute nothing.
    fn integrate(&self, segment: &Segment) -> Contribution {
        let (front, back) = (self.ramp.place(segment.front[0]), self.ramp.place(segment.back[0]));
        let extinction = Bilinear::new(front, back, self.ramp.size()).read(|k| f64::from(self.extinction[k]));
        let length = segment.length / self.longest;
        let depth = extinction * length;
        if !(depth >= 0.0 && length > 0.0) {
            return Contribution::default();
        }
        let reach = length * mean_transmittance(depth);
        let color = self.glow_at(front, back, length).map(|glow| glow * reach);
        Contribution { optical_depth: depth, color, opacity: opacity(depth) }
    }
}

/// f: (s_f, s_b, l) of (α, s, t); s_f may lie outside [0, 1].
pub fn from_cylinder(angle: f64, s: f64, t: f64) -> [f64; 3] {
    let [front, length] = if angle <= 0.25 {
        [t + s, 4.0 * angle * s]
    } else if angle <= 0.5 {
        [t + 4.0 * (0.5 - angle) * s, s]
    } else if angle <= 0.75 {
        [t - 4.0 * (angle - 0.5) * s, s]
    } else {
        [t - s, 4.0 * (1.0 - angle) * s]
    };
    [front, t, length]
}

/// f⁻¹: (α, s, t).
pub fn to_cylinder(front: f64, back: f64, length: f64) -> [f64; 3] {
    let fall = front - back;
    let (angle, s) = if length <= 0.0 && fall == 0.0 {
        (0.5, 0.0)
    } else if fall >= 0.0 {
        if length <= fall { (0.25 * length / fall, fall) } else { (0.5 - 0.25 * fall / length, length) }
    } else if length >= -fall {
        (0.5 - 0.25 * fall / length, length)
    } else {
        (1.0 + 0.25 * length / fall, -fall)
    };
    [angle, s, back]
}

/// Depths of a segment or a step beyond which it is opaque whatever they are; their products stay numbers.
const MAX_DEPTH: f32 = 1e30;

/// Nodes about a place that tiles read: the next in s and in t, four for the next plane, and the next of the table that filled
/// them; one over.
const TILES_REACH: f32 = 8.0;

pub(crate) struct LaneTable {
    table: PreIntegrated,
    /// Stored position of the first node, and nodes a stored unit.
    start: f32,
    per_value: f32,
    per_length: f32,
    /// For each step from node to node the first at or behind it in which something is.
    filled: Vec<f32>,
    /// ρ̄ of (s_f, s_b), where tiles do not hold it.
    means: Option<LaneSquare>,
}

impl LaneTable {
    pub fn new(table: PreIntegrated, scene: &LaneScene<'_>) -> LaneTable {
        let longest = scene.length() / scene.extent().longest;
        let [low, high] = table.ramp.range;
        let (axis, size) = (scene.scalar_axis(), table.ramp.size());
        LaneTable {
            start: ((low - axis.offset) / axis.scale) as f32,
            per_value: ((size - 1) as f64 * axis.scale / (high - low)) as f32,
            per_length: longest as f32,
            filled: filled(&table.ramp, longest, scene.may_skip()),
            means: table.last_tile.map(|_| LaneSquare::new(&table.extinction, size)),
            table,
        }
    }

    /// Trilinear, at a place in entries, which must lie within.
    #[inline(always)]
    fn read<L: Lanes>(&self, row: L::F, column: L::F, plane: L::F) -> [L::F; 4] {
        let splat = L::F::splat;
        let split = inlined!(|x: L::F, last: usize| {
            let low = x.floor().min(splat((last - 1) as f32));
            (low.to_unsigned(), x - low)
        });
        let size = self.table.ramp.size();
        let last_plane = self.table.last_tile.unwrap_or(size - 1);
        let ((i, u), (j, v), (k, w)) =
            (split(row, size - 1), split(column, size - 1), split(plane, last_plane));
        let [next_row, next_plane] = [size, size * size].map(|n| L::U::splat(n as u32));
        let first = k * next_plane + i * next_row + j;
        let mix = inlined!(|a: [L::F; 4], b: [L::F; 4], share: L::F| -> [L::F; 4] {
            array!(|c| share.mul_add(b[c] - a[c], a[c]))
        });
        let corner = inlined!(|at: L::U| {
            let near = L::F::gather_parts(&self.table.glow, at);
            mix(near, L::F::gather_parts(&self.table.glow, at + next_plane), w)
        });
        let next_column = L::U::splat(1);
        let low = mix(corner(first), corner(first + next_column), v);
        let second = first + next_row;
        mix(low, mix(corner(second), corner(second + next_column), v), u)
    }
}

impl LaneKernel for LaneTable {
    fn table_bytes(&self) -> usize {
        size_of_val(self.table.glow.as_slice()) + self.means.as_ref().map_or(0, LaneSquare::bytes)
    }

    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        let last = splat((self.table.ramp.size() - 1) as f32);
        for at in (0..batch.count()).step_by(L::WIDTH) {
            let segments = batch.segments::<L>(at);
            let (front_values, back_values) = (segments.front, segments.back);
            let [front, back]: [L::F; 2] = array!(|end| {
                let s = if end == 0 { front_values[0] } else { back_values[0] };
                ((s - splat(self.start)) * splat(self.per_value)).max(zero).min(last)
            });
            // Values that are not numbers contribute nothing.
            let numbers = front_values[0].le(front_values[0]).and(back_values[0].le(back_values[0]));
            let reach = splat(if self.means.is_some() { TILES_REACH } else { 0.0 });
            let first = (front.min(back) - reach).floor().max(zero).min(last - one);
            let next = L::F::gather(&self.filled, first.to_unsigned());
            let behind = (front.max(back) + reach).floor() + one;
            let there = segments.crossing.and(numbers).and(next.lt(behind));
            if !there.any() {
                results.put_nothing::<L>(at);
                continue;
            }
            results.count_evaluations(u64::from(batch.within::<L>(there, at).count_ones()));
            let length = segments.length * splat(self.per_length);
            let share = length.max(zero).min(one);
            let [r, g, b, mean] = match (&self.means, self.table.last_tile) {
                (Some(means), Some(last_tile)) => {
                    let [angle, s] = lane_to_cylinder::<L>(front / last, back / last, share);
                    let [r, g, b, _] =
                        self.read::<L>(s.min(one) * last, back, angle * splat(last_tile as f32));
                    [r, g, b, means.read(&means.place::<L>(front, back))]
                }
                _ => self.read::<L>(front, back, share.sqrt() * last),
            };
            let depth = L::F::select(there, mean * length, zero);
            let through = mean_transparency::<L>(depth.min(splat(MAX_DEPTH)));
            let reach = L::F::select(there, length * through, zero);
            let opacity = (depth.min(splat(MAX_DEPTH)) * through).min(one);
            results.put_depth::<L>(at, depth.min(splat(f32::MAX)));
            results.put_color::<L>(at, [r * reach, g * reach, b * reach], opacity);
        }
    }
}

/// For each step between nodes the first at or behind it in which something is, or beyond all. What a ray of a scene's length may
/// lose by the others is what it may lose by the widgets that segments hardly meet; without leave to leave out, nothing.
/// `longest`: longest segments a scene length.
fn filled(ramp: &Ramp, longest: f64, leave_out: bool) -> Vec<f32> {
    let least = if leave_out { NEGLIGIBLE_DEPTH } else { 0.0 };
    let most = |matter: &Material| matter.glow.into_iter().fold(matter.extinction, f64::max) * longest;
    let (nodes, parts) = (&ramp.nodes, ramp.parts);
    let pieces = |k: usize| &ramp.pieces[k * parts..(k + 1) * parts];
    let holds = |k: usize| nodes[k..=k + 1].iter().chain(pieces(k)).any(|matter| most(matter) > least);
    let mut next = nodes.len() as f32 + 1.0 + TILES_REACH;
    let mut filled = vec![next; nodes.len() - 1];
    for k in (0..filled.len()).rev() {
        if holds(k) {
            next = k as f32;
        }
        filled[k] = next;
    }
    filled
}

/// f⁻¹, Eq. 10: α and s of (s_f, s_b, l); t is s_b. At s_f = s_b, l = 0 every α serves.
#[inline(always)]
fn lane_to_cylinder<L: Lanes>(front: L::F, back: L::F, length: L::F) -> [L::F; 2] {
    let splat = L::F::splat;
    let fall = front - back;
    let (steep, size) = (fall.abs(), fall.abs().max(length));
    // Which of the two is the smaller decides the branch; the quotient is then at most 1.
    let long = steep.le(length);
    let quotient = splat(0.25) * steep.min(length) / size.max(splat(f32::MIN_POSITIVE));
    let from_start = L::F::select(long, splat(0.5) - quotient, quotient);
    let angle = L::F::select(fall.lt(splat(0.0)), splat(1.0) - from_start, from_start);
    [L::F::select(splat(0.0).lt(size), angle, splat(0.5)), size]
}

/// Side of a workgroup of the passes, as they state it.
const GROUP_SIDE: u32 = 8;

/// Numbers before the entries of mean extinctions: side, tiles less 1, where the first node is stored, nodes a stored unit, longest
/// segments a scene length.
pub(crate) const MEAN_HEAD: u64 = 5;

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
    let mut text = format!("const SIDE = {side}u;\nconst PARTS = {}u;\n", ramp.parts);
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
    let all = ramp.nodes.iter().chain(&ramp.pieces);
    all.map(|m| [m.glow[0], m.glow[1], m.glow[2], m.extinction].map(single)).collect()
}
