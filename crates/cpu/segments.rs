//! Segments by themselves: the engine's result for each, so that exact values can judge the kernels.
//!
//! A list of segments stands for a grid: its ends are points, whose values are scaled by their ranges as a volume's are;
//! the batches are the compositor's, and the same kernels integrate and composite them.

use crate::attribute::{Attribute, attributes_of};
use crate::composite::accumulators::TileAccumulator;
use crate::composite::fragment_lists::{FragmentLists, Overflow};
use crate::composite::row_shader::blend_by_numbers;
use crate::composite::sinks::pixel_in_one_color;
use crate::composite::unbounded_lists::{Fragment, UnboundedFragmentLists};
use crate::cull::VolumeCache;
use crate::fragments::batch::{BATCH, Batch, MAX_LANES};
use crate::integrator::in_lanes_alone;
use crate::shade::roads;
use crate::shade::shaded::Shaded;
use crate::shade::shader::{Scene, Shader};
use crate::tile::{PIXELS, TILE};
use crate::tolerances::MIN_TRANSMITTANCE;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::{Array, Grid};
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_optics::engine::{Chain, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator};
use voltet_optics::integrators::{self, Extent};
use voltet_optics::shading::{Integrator, Shading};
use voltet_optics::{Contribution, Segment, WidgetBlend};
use voltet_simd::optics::elementary::exp;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, dispatch};

/// Result of a segment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrated {
    /// Contribution, as 32 bits hold it.
    pub contribution: Contribution,
    /// Reason why the 64-bit forms integrated it; `None` where lanes did.
    pub left: Option<&'static str>,
}

/// Integrates segments on a lane set, as if they were the cells of one scene in exhaustive mode. `ordered`: true if segments are
/// ordered also where one colour needs no order.
///
/// Errors: those of drawing with this transfer function and shading.
pub fn segments(
    lanes: LaneSet,
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordered: bool,
    list: &[Segment],
) -> Result<Vec<Integrated>> {
    let mut results = integrate(lanes, transfer_function, shading, ordered, list)?;
    if results.iter().any(|result| result.contribution.optical_depth.is_nan()) {
        // Where colours need an order no depth is kept; a scene of one colour draws with it.
        let depths = integrate(lanes, &in_white(transfer_function), shading, false, list)?;
        for (result, depth) in results.iter_mut().zip(depths) {
            result.contribution.optical_depth = depth.contribution.optical_depth;
            result.left = result.left.or(depth.left);
        }
    }
    Ok(results)
}

/// Optical depths are NaN where the shader keeps none.
fn integrate(
    lanes: LaneSet,
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordered: bool,
    list: &[Segment],
) -> Result<Vec<Integrated>> {
    let cells = VolumeCache::new(&Arc::new(volume(transfer_function, list)))?.empty()?;
    let attributes = attributes_of(&cells, transfer_function)?;
    let extent = Extent { scalar: cells.ranges[0], longest: cells.length };
    integrators::can_serve(&shading.integrator, transfer_function)?;
    let exact = || integrators::new(&shading.integrator, shading.overlap, transfer_function, &extent);
    let by_lanes = in_lanes_alone(&shading.integrator);
    let exact = if by_lanes { None } else { Some(exact()?) };
    let length = cells.length;
    let scene = Scene { attributes: &attributes, length, ordered, leave_out: false, extent, lanes };
    let shader = Shader::new(transfer_function, shading, exact, scene, None)?;
    let mut batch = Batch::new(attributes.len(), attributes.len());
    let mut shaded = Shaded::new();
    let mut results = Vec::with_capacity(list.len());
    for (number, part) in list.chunks(BATCH).enumerate() {
        fill(&mut batch, &attributes, number * BATCH, part, cells.length);
        roads::integrate(&shader, lanes, &batch, part.len(), &mut shaded);
        results.extend((0..part.len()).map(|k| result_of(&shader, &shaded, k)));
    }
    Ok(results)
}

/// Volume whose points are the ends of segments, one behind the other along an axis, so that the longest is the diagonal.
fn volume(transfer_function: &TransferFunction, list: &[Segment]) -> Volume {
    let points = list.iter().flat_map(|segment| [DVec3::ZERO, DVec3::X * segment.length]).collect();
    let ends = |a: usize| list.iter().flat_map(|segment| [segment.front[a], segment.back[a]]).collect();
    let field = |(i, name): (usize, &str)| {
        let values = list.iter().flat_map(|segment| [segment.fields_front[i], segment.fields_back[i]]);
        (name.to_owned(), Arc::new(Array { component_count: 1, values: values.collect() }))
    };
    let point_arrays = transfer_function.fields().into_iter().enumerate().map(field).collect();
    Volume {
        grid: Arc::new(Grid { points, point_arrays, ..Grid::default() }),
        scalar: ends(0),
        gradient: None,
        gradient_magnitude: Some(ends(1)),
    }
}

/// Fills a batch with segments, the first of which is number `first` of the list.
fn fill(batch: &mut Batch, attributes: &[Attribute<'_>], first: usize, part: &[Segment], length: f64) {
    for (k, segment) in part.iter().enumerate() {
        batch.length[k] = (segment.length / length) as f32;
        for (a, values) in attributes.iter().enumerate() {
            let stored = |point: usize| ((values.at(point) - values.offset) / values.scale) as f32;
            let point = 2 * (first + k);
            (batch.front[a][k], batch.back[a][k]) = (stored(point), stored(point + 1));
        }
    }
}

/// Result of a batch's segment k.
fn result_of(shader: &Shader, shaded: &Shaded, k: usize) -> Integrated {
    let left = shaded.rest.iter().position(|&rest| rest == k);
    let depth = if shader.keeps_depth() { f64::from(shaded.depth[k]) } else { f64::NAN };
    let [r, g, b, opacity] = match shader.one_color {
        Some(color) => pixel_in_one_color(color, shaded.depth[k], false),
        None => std::array::from_fn(|c| shaded.rgba[c][k]),
    }
    .map(f64::from);
    Integrated {
        contribution: Contribution { optical_depth: depth, color: [r, g, b], opacity },
        left: left.map(|at| shaded.why[at].text()),
    }
}

/// The transfer function with all widgets white.
fn in_white(transfer_function: &TransferFunction) -> TransferFunction {
    let widgets = transfer_function.widgets.iter().map(|widget| widget.in_color([1.0; 3])).collect();
    TransferFunction { widgets, ..*transfer_function }
}

/// The engine on one lane set as a set of forms: each segment is a scene of its own.
#[derive(Debug, Clone, Copy)]
pub struct Segments {
    /// Lane set of the kernels.
    pub lanes: LaneSet,
    /// True if segments are ordered also where one colour needs no order.
    pub ordered: bool,
}

impl Segments {
    /// One for each lane set that this processor has.
    pub fn each() -> impl Iterator<Item = Segments> {
        let sets = LaneSet::ALL.into_iter().rev();
        sets.filter(|set| set.is_supported()).map(|lanes| Segments { lanes, ordered: false })
    }

    fn one(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<Integrated> {
        let shading = Shading { integrator: Integrator::ANALYTIC, overlap, silhouette: None, light: None };
        let list = std::slice::from_ref(segment);
        Ok(segments(self.lanes, transfer_function, &shading, self.ordered, list)?.remove(0))
    }
}

impl SegmentEvaluator for Segments {
    fn name(&self) -> &str {
        match self.lanes {
            LaneSet::Portable => "32-bit portable",
            LaneSet::Neon => "32-bit neon",
            LaneSet::Avx2 => "32-bit avx2",
            LaneSet::Avx512 => "32-bit avx512",
        }
    }

    fn precision(&self) -> Precision {
        Precision::F32
    }

    fn segment(
        &self,
        transfer_function: &TransferFunction,
        segment: &Segment,
        overlap: WidgetBlend,
    ) -> Result<EvalOutcome> {
        let Integrated { contribution, left } = self.one(transfer_function, segment, overlap)?;
        Ok(left.map_or(EvalOutcome::Served(contribution), |why| EvalOutcome::Wider(contribution, why)))
    }

    /// Composites segments one behind the other in the lists of a tile, or where they are too many, in one that grows.
    fn chain(&self, segments: &[Contribution]) -> Chain {
        let rgba: Vec<[f32; 4]> = segments
            .iter()
            .map(|segment| {
                let [r, g, b] = segment.color;
                [r, g, b, segment.opacity].map(|x| x as f32)
            })
            .collect();
        let mut picture = [[0.0; 4]; PIXELS];
        let mut lists = FragmentLists::default();
        lists.clear(1);
        let listed = (0..rgba.len()).try_for_each(|k| {
            let number = f32::from_bits(k as u32);
            lists.push(0, [k as f32, 1.0], [[number; 2]])
        });
        let through = match listed {
            Ok(()) => {
                let mut pixels = TileAccumulator::new();
                blend_by_numbers(self.lanes, &mut lists, true, &rgba, &mut pixels);
                pixels.store(&mut picture);
                Some(f64::from(pixels.transmittance(0)[0]))
                    .filter(|through| *through > f64::from(MIN_TRANSMITTANCE))
            }
            Err(Overflow) => {
                let mut lists = UnboundedFragmentLists::default();
                for (k, &rgba) in rgba.iter().enumerate() {
                    lists.push(0, Fragment::new(k as f32, k as f32 + 1.0, rgba));
                }
                lists.composite(true, &mut picture[..TILE]);
                Some(lists.transmittance[0])
            }
        };
        let [r, g, b, opacity] = picture[0].map(f64::from);
        Chain { color: [r, g, b], opacity, transparency: through }
    }

    /// Integrates by a constant-emitter whose colour goes from one channel to another along the segment: it draws F, B and ψ.
    fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
        if a.max(b) < f64::from(f32::MIN_POSITIVE) {
            return Ok(EvalOutcome::Skipped("what does not absorb does not glow"));
        }
        let point = |s, extinction, color| ControlPoint { s, color, extinction };
        let points = vec![point(0.0, a, [1.0, 0.0, 1.0]), point(1.0, b, [0.0, 1.0, 1.0])];
        let profile = Profile::PiecewiseLinear { points };
        let widgets = vec![Widget { profile, color: [0.0; 3], extinction: 0.0, region: None }];
        let model = OpticalModel::ConstantEmitter { cutoff: 0.0 };
        let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets };
        let (front, back) = ([0.0; 2], [1.0, 0.0]);
        let segment = Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] };
        let Integrated { contribution, left } = self.one(&transfer_function, &segment, WidgetBlend::Exact)?;
        let [front, back, psi] = contribution.color;
        let zeta = dispatch(self.lanes, Transmittance(0.5 * (a + b)));
        let found = PartialIntegrals { psi, front, back, zeta };
        Ok(left.map_or(EvalOutcome::Served(found), |why| EvalOutcome::Wider(found, why)))
    }
}

/// e^(−T) as the ordered forms take it.
struct Transmittance(f64);

impl Kernel for Transmittance {
    type Output = f64;
    #[inline(always)]
    fn run<L: Lanes>(self) -> f64 {
        let mut lanes = [0.0; MAX_LANES];
        exp::<L>(L::F::splat(-self.0 as f32)).store(&mut lanes);
        f64::from(lanes[0])
    }
}
