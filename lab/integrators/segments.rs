//! N equal pieces: their ends classified, colour and extinction linear in each piece, combined by ψ, F and B.
//!
//! Song et al. 2009, sections 3.3.2 and 5; Moreland & Angel 2004. The integrals come from the two-dimensional
//! [`PartialTable`], or, to judge the table, from the closed forms of module `linear`.
//!
//! The partial pre-integration table: the weights of the colours at both ends of a piece whose extinction and
//! colour are linear, tabulated (Moreland & Angel 2004; Song et al. 2009, sections 3.3.2 and 5).
//!
//! Symbols as in module `linear`: a = α_f D, b = α_b D; T = (a + b)/2 the depth of the piece; ψ, F, B, ζ. All
//! depend on a and b alone, so two dimensions hold them. Kept are
//!
//! - density-emitter: φ = (1 − ψ)/(1 − ζ), the front colour's share of the light; the back's is 1 − φ, since
//!   (1 − ψ) + (ψ − ζ) = 1 − ζ. Opacity stays exact, and a thin piece keeps its relative accuracy, which a table
//!   of ψ does not give it.
//! - constant-emitter: F (1 + √T) and B (1 + √T), which stay between bounds for all T.
//!
//! The axes are √r with r = a/(a + b), and u = √T/(1 + √T): r because at the origin φ depends on the ratio of a and
//! b, its root because for large T a layer of width 1/√T lies at r = 0, that of T because ψ falls like 1/√T. Bilinear; the error falls with the square of the side (bench `tables`).

use crate::settings::{
    PARTIAL_SIDE_PARAMETER, PIECES, PIECES_PARAMETER, PreparedKernel, SIDE, WGSL_PIECES, boxed, check_pieces,
    count, shared_table,
};
use crate::square::{Bilinear, LaneSquare, Place};
use rayon::prelude::*;
use std::any::Any;
use voltet_core::Result;
use voltet_core::parameters::VariantSchema;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_cpu::integrator::{
    LaneExtension, LaneIntegratorKind, LaneKernel, LaneScene, SIDE_BY_SIDE, SampledSegments, Samples,
    SegmentBatch, SegmentResults, WidgetSampler,
};
use voltet_optics::integrators::{
    Extent, Integrator, IntegratorKind, SegmentIntegrator, TableDomain, can_serve,
};
use voltet_optics::linear::{emission_weights, front_back};
use voltet_optics::overlap::Sample;
use voltet_optics::special::{OPAQUE_DEPTH, opacity};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use voltet_shaders::{TableSize, WgslCall, WgslExtension, WgslIntegrator, WgslPiece};
use voltet_simd::optics::elementary::{exp, transparencies};
use voltet_simd::{Float, Lanes, array, inlined};

/// Equal pieces, `count` ≥ 1 of a segment, combined by a table of `side` ≥ 2 entries a side.
pub const fn segments(count: usize, side: usize) -> Integrator {
    Integrator::with_settings(&SegmentsKind, [count as f64, side as f64])
}

pub(crate) struct SegmentsKind;

impl IntegratorKind for SegmentsKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema {
            name: "segments",
            summary: "equal pieces, linear in each, combined by the partial pre-integration table",
            parameters: &[PIECES_PARAMETER, PARTIAL_SIDE_PARAMETER],
        }
    }

    fn check(&self, integrator: &Integrator) -> Result<()> {
        check_pieces(integrator)
    }

    fn table(&self) -> TableDomain {
        TableDomain::Fixed
    }

    fn compile(
        &self,
        integrator: &Integrator,
        _: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Segments::new(
            transfer_function,
            count(integrator, PIECES),
            Some(count(integrator, SIDE)),
        )?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&LaneExtension(&SegmentsKind), &WgslExtension(&SegmentsKind)]
    }
}

impl LaneIntegratorKind for SegmentsKind {
    fn prepare(&self, integrator: &Integrator, scene: &LaneScene<'_>) -> Result<PreparedKernel> {
        let table = shared_table::<PartialTable>(scene).map(LanePartialTable::new);
        Ok(table.and_then(|table| {
            let ends = WidgetSampler::new(count(integrator, PIECES), true, scene)?;
            Ok(boxed(Pieces { ends, table }))
        }))
    }
}

impl WgslIntegrator for SegmentsKind {
    fn pieces(&self) -> &'static [WgslPiece] {
        WGSL_PIECES
    }

    fn call(&self, constant_emitter: bool) -> WgslCall {
        let pieces: &[&str] = match constant_emitter {
            true => &["sampled/segments", "sampled/partial_constant"],
            false => &["sampled/segments", "sampled/partial_density"],
        };
        WgslCall::Samples { function: "linear_pieces", pieces, reads_numbers: true }
    }

    fn piece_count(&self, integrator: &Integrator) -> Option<usize> {
        integrator.count(PIECES)
    }

    fn table_size(&self, integrator: &Integrator, transfer_function: &TransferFunction) -> TableSize {
        if transfer_function.widgets.is_empty() {
            return TableSize::default();
        }
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        let entries = PartialTable::bytes_of(density, count(integrator, SIDE)) / size_of::<f32>();
        TableSize { entries: 1 + entries as u64, ..TableSize::default() }
    }

    /// The side; then φ, or F (1 + √T) and B (1 + √T) by turns.
    fn entries(&self, integrator: &Integrator, transfer_function: &TransferFunction) -> Vec<f32> {
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        let table = PartialTable::new(density, count(integrator, SIDE));
        let mut entries = vec![table.size as f32];
        for (k, front) in table.front.iter().enumerate() {
            entries.push(*front);
            entries.extend(table.back.get(k));
        }
        entries
    }
}

/// N pieces of linear colour and extinction in 64 bits.
#[derive(Debug, Clone)]
pub struct Segments {
    prepared: CompiledTransferFunction,
    count: usize,
    density: bool,
    /// `None`: closed forms.
    table: Option<PartialTable>,
}

impl Segments {
    /// Serves every transfer function; `count` ≥ 1, `table_size` ≥ 2 entries a side. Without a table it is several times slower,
    /// and has not the table's error.
    pub fn new(
        transfer_function: &TransferFunction,
        count: usize,
        table_size: Option<usize>,
    ) -> Result<Self> {
        can_serve(&segments(count, table_size.unwrap_or(2)), transfer_function)?;
        let density = transfer_function.model == OpticalModel::DensityEmitter;
        let prepared = CompiledTransferFunction::new(transfer_function)?;
        let table = table_size.map(|size| PartialTable::new(density, size));
        Ok(Segments { prepared, count, density, table })
    }

    /// Light of a piece of length `step`.
    fn colors(&self, front: &Sample, back: &Sample, step: f64) -> [f64; 3] {
        let (a, b) = (front.rate * step, back.rate * step);
        let (f, k) = match &self.table {
            Some(table) => table.weights(a, b),
            None if self.density => emission_weights(a, b),
            None => front_back(a, b),
        };
        if !self.density {
            return std::array::from_fn(|i| step * (f * front.glow[i] + k * back.glow[i]));
        }
        // The colour of an end is its glow by its rate; an end without stuff takes the other's colour.
        let (c0, c1) = (front.color(back), back.color(front));
        std::array::from_fn(|i| f * c0[i] + k * c1[i])
    }
}

impl SegmentIntegrator for Segments {
    fn table_bytes(&self) -> usize {
        self.table.as_ref().map_or(0, PartialTable::bytes)
    }

    fn table(&self) -> Option<&dyn Any> {
        self.table.as_ref().map(|table| table as &dyn Any)
    }

    fn integrate(&self, segment: &Segment) -> Contribution {
        let step = 1.0 / self.count as f64;
        self.prepared.sampled(segment, |samples| {
            let (mut color, mut depth) = ([0.0; 3], 0.0_f64);
            let mut front = samples.at(0.0);
            for i in 1..=self.count {
                let back = samples.at(i as f64 * step);
                if depth < OPAQUE_DEPTH {
                    let seen = (-depth).exp();
                    for (sum, c) in color.iter_mut().zip(self.colors(&front, &back, step)) {
                        *sum += seen * c;
                    }
                }
                depth += 0.5 * step * (front.rate + back.rate);
                front = back;
            }
            Contribution { optical_depth: depth, color, opacity: opacity(depth) }
        })
    }
}

struct Pieces {
    ends: WidgetSampler,
    /// Weights of a piece's ends.
    table: LanePartialTable,
}

impl LaneKernel for Pieces {
    #[inline(always)]
    fn integrate<L: Lanes>(&self, batch: SegmentBatch<'_>, results: &mut SegmentResults<'_>) {
        let Pieces { ends, table } = self;
        let count = ends.count();
        ends.integrate::<L>(
            batch,
            count + 1,
            #[inline(always)]
            |crossed| {
                crossed.by_depth(
                    batch.depth_only(),
                    #[inline(always)]
                    |crossed, colors| walk(table, count, crossed, colors),
                )
            },
            results,
        );
    }
}

#[derive(Clone, Copy)]
struct End<L: Lanes> {
    rate: L::F,
    /// Its colour under the density-emitter, its glow in the length of a piece under the constant-emitter.
    light: [L::F; 3],
}

/// Colour, unless `colors` is false, and optical depth.
#[inline(always)]
fn walk<L: Lanes>(
    table: &LanePartialTable,
    count: usize,
    crossed: &mut SampledSegments<'_, '_, L>,
    colors: bool,
) -> ([L::F; 3], L::F) {
    let splat = L::F::splat;
    let (zero, half) = (splat(0.0), splat(0.5));
    let step = crossed.length() * splat(1.0 / count as f32);
    let density = crossed.is_density_emitter();
    let (mut color, mut depth, mut through) = ([zero; 3], zero, splat(1.0));
    let mut front = ends::<L, 1>(&crossed.at([0.0], colors), step, density)[0];
    let share = SIDE_BY_SIDE as f32 / count as f32;
    for block in 0..count.div_ceil(SIDE_BY_SIDE) {
        let first = block * SIDE_BY_SIDE;
        let t = array!(|j| ((first + j + 1).min(count) as f64 / count as f64) as f32);
        let samples = if count == 1 {
            let one = crossed.at::<1>([1.0], colors);
            Samples { rate: [one.rate[0]; SIDE_BY_SIDE], glow: [one.glow[0]; SIDE_BY_SIDE] }
        } else {
            crossed.in_step(block, share, [0.25, 0.5, 0.75, 1.0], t, colors)
        };
        let ends = ends::<L, SIDE_BY_SIDE>(&samples, step, density);
        for j in 0..SIDE_BY_SIDE {
            if first + j == count {
                break;
            }
            let back = ends[j];
            let piece = half * (front.rate + back.rate);
            if colors {
                let (mean, behind) = transparencies::<L>(piece);
                if density {
                    let toward = table.front_share::<L>(front.rate, back.rate);
                    let light = through * (piece * mean);
                    // An end without stuff takes the other's colour.
                    let (bare, bare_back) = (front.rate.lt(least::<L>()), back.rate.lt(least::<L>()));
                    for c in 0..3 {
                        let near = L::F::select(bare, back.light[c], front.light[c]);
                        let far = L::F::select(bare_back, front.light[c], back.light[c]);
                        color[c] = light.mul_add(toward.mul_add(near - far, far), color[c]);
                    }
                } else {
                    let (near, far) = table.front_back::<L>(front.rate, back.rate);
                    for c in 0..3 {
                        let light = near.mul_add(front.light[c], far * back.light[c]);
                        color[c] = through.mul_add(light, color[c]);
                    }
                }
                through = through * behind;
            }
            depth = depth + piece;
            front = back;
        }
        through = exp::<L>(-depth);
    }
    (color, depth)
}

/// The least rate by which a glow is divided.
#[inline(always)]
fn least<L: Lanes>() -> L::F {
    L::F::splat(f32::MIN_POSITIVE)
}

#[inline(always)]
fn ends<L: Lanes, const N: usize>(samples: &Samples<L, N>, step: L::F, density: bool) -> [End<L>; N] {
    array!(|j| {
        let rate = samples.rate[j];
        let scale = if density { L::F::splat(1.0) / rate.max(least::<L>()) } else { step };
        let light = array!(|c| samples.glow[j][c] * scale);
        End { rate: rate * step, light }
    })
}

#[derive(Debug, Clone)]
pub struct PartialTable {
    size: usize,
    /// φ, or F (1 + √T), by (u, √r); rows of equal u.
    front: Vec<f32>,
    /// Empty, or B (1 + √T).
    back: Vec<f32>,
}

/// √T from u; 10⁶ stands for the infinite depth of the last row.
fn root_depth(u: f64) -> f64 {
    u / (1.0 - u).max(1e-6)
}

impl PartialTable {
    /// Fills the table, `size` ≥ 2 entries a side, on all cores.
    pub fn new(density_emitter: bool, size: usize) -> Self {
        let step = 1.0 / (size - 1) as f64;
        let fill = |value: &(dyn Fn(f64, f64, f64) -> f64 + Sync)| -> Vec<f32> {
            let mut entries = vec![0.0; size * size];
            entries.par_chunks_mut(size).enumerate().for_each(|(row, entries)| {
                let root = root_depth(row as f64 * step);
                let whole = 2.0 * root * root;
                for (column, entry) in entries.iter_mut().enumerate() {
                    let r = (column as f64 * step).powi(2);
                    *entry = value(r * whole, (1.0 - r) * whole, root) as f32;
                }
            });
            entries
        };
        if !density_emitter {
            let front = fill(&|a, b, root| front_back(a, b).0 * (1.0 + root));
            return PartialTable { size, front, back: fill(&|a, b, root| front_back(a, b).1 * (1.0 + root)) };
        }
        let mut front = fill(&|a, b, _| {
            let (front, back) = emission_weights(a, b);
            front / (front + back)
        });
        // Thin limit: ∫ (1 − x) ρ over ∫ ρ.
        for (column, entry) in front[..size].iter_mut().enumerate() {
            *entry = ((1.0 + (column as f64 * step).powi(2)) / 3.0) as f32;
        }
        PartialTable { size, front, back: Vec::new() }
    }

    pub fn bytes_of(density_emitter: bool, size: usize) -> usize {
        let tables = if density_emitter { 1 } else { 2 };
        tables * size * size * size_of::<f32>()
    }

    pub fn bytes(&self) -> usize {
        (self.front.len() + self.back.len()) * size_of::<f32>()
    }

    /// Weights of the front and the back colour: (1 − ψ, ψ − ζ) or (F, B).
    #[inline]
    pub fn weights(&self, a: f64, b: f64) -> (f64, f64) {
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(f64::MAX);
        let ratio = if whole > 0.0 { a / whole } else { 0.5 };
        let root = (0.5 * whole).sqrt();
        let last = (self.size - 1) as f64;
        let at = Bilinear::new(root / (1.0 + root) * last, ratio.sqrt() * last, self.size);
        let read = |entries: &[f32]| at.read(|k| f64::from(entries[k]));
        if self.back.is_empty() {
            let share = read(&self.front);
            let light = opacity(0.5 * whole);
            (light * share, light * (1.0 - share))
        } else {
            let scale = 1.0 / (1.0 + root);
            (read(&self.front) * scale, read(&self.back) * scale)
        }
    }
}

#[derive(Debug, Clone)]
pub struct LanePartialTable {
    /// The front colour's share of the light, or F (1 + √T).
    front: LaneSquare,
    /// B (1 + √T), where it is kept.
    back: Option<LaneSquare>,
}

impl LanePartialTable {
    pub fn new(table: &PartialTable) -> LanePartialTable {
        let square = |entries: &[f32]| LaneSquare::new(entries, table.size);
        let back = (!table.back.is_empty()).then(|| square(&table.back));
        LanePartialTable { front: square(&table.front), back }
    }

    /// φ, the front colour's share of a piece's light (density-emitter).
    #[inline(always)]
    pub fn front_share<L: Lanes>(&self, a: L::F, b: L::F) -> L::F {
        self.front.read(&self.place::<L>(a, b).0)
    }

    #[inline(always)]
    pub fn front_back<L: Lanes>(&self, a: L::F, b: L::F) -> (L::F, L::F) {
        let (place, root) = self.place::<L>(a, b);
        let scale = L::F::splat(1.0) / (L::F::splat(1.0) + root);
        let back = match &self.back {
            Some(back) => back.read(&place),
            None => L::F::splat(0.0),
        };
        (self.front.read(&place) * scale, back * scale)
    }

    #[inline(always)]
    fn place<L: Lanes>(&self, a: L::F, b: L::F) -> (Place<L>, L::F) {
        let splat = L::F::splat;
        let (zero, one) = (splat(0.0), splat(1.0));
        // Also where the depth of a piece leaves the range of numbers.
        let whole = (a + b).min(splat(f32::MAX));
        let least = splat(f32::MIN_POSITIVE);
        let ratio = L::F::select(whole.lt(least), splat(0.5), a / whole.max(least)).min(one);
        let root = (splat(0.5) * whole).sqrt();
        let last = splat(self.front.last());
        let within = inlined!(|x: L::F| (x * last).max(zero).min(last));
        (self.front.place(within(root / (one + root)), within(ratio.sqrt())), root)
    }
}
