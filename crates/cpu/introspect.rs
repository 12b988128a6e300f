//! Single ray segments through the engine's kernels, for comparison with exact values. No part of the public interface: it changes
//! with the engine.
//!
//! A list of segments stands for a grid: its ends are points, whose values are scaled by their ranges as a volume's are;
//! the batches are the compositor's, and the same kernels integrate and composite them.

use crate::attribute::{Attribute, attributes_of};
use crate::composite::accumulators::{Fragment, TileAccumulator, UnboundedFragmentLists, pixel_in_one_color};
use crate::composite::fragment_lists::{FragmentLists, Overflow};
use crate::composite::row_shader::blend_by_numbers;
use crate::cull::VolumeCache;
use crate::fragments::batch::{BATCH, Batch, MAX_LANES};
use crate::native::Native;
use crate::shade::ShaderContext;
use crate::shade::integrator::in_lanes_alone;
use crate::shade::shaded_batch::ShadedBatch;
use crate::shade::shader::{self, Shader};
use crate::tile::{PIXELS, TILE};
use crate::tolerances::MIN_TRANSMITTANCE;
use glam::DVec3;
use std::any::Any;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::{Array, Grid};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_optics::engine::Engine;
use voltet_optics::integrators::{self, Extent};
use voltet_optics::shading::Shading;
use voltet_optics::{Contribution, Segment};
use voltet_simd::optics::elementary::exp;
use voltet_simd::{Float, Kernel, LaneSet, Lanes, dispatch};

/// A segment as the engine integrates it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct IntegratedSegment {
    /// Contribution, rounded to 32 bits.
    pub contribution: Contribution,
    /// Reason that it fell back to the 64-bit formulas; `None` where lanes integrated it.
    pub fallback: Option<&'static str>,
}

/// Lane sets that this processor has, the widest first.
pub fn lane_sets() -> impl Iterator<Item = LaneSet> {
    LaneSet::ALL.into_iter().rev().filter(|lanes| lanes.is_supported())
}

/// The engine on one lane set.
pub fn engine_on(lanes: LaneSet) -> Arc<dyn Engine> {
    Arc::new(Native { lanes })
}

/// Lane set of an engine, if it is this crate's.
pub fn lanes_of(engine: &dyn Engine) -> Option<LaneSet> {
    (engine as &dyn Any).downcast_ref().map(|Native { lanes }| *lanes)
}

/// Integrates segments on a lane set, as if they were the cells of one scene in exhaustive mode. `ordered`: segments are put in
/// order also where one colour needs no order. Errors: those of drawing with this transfer function and shading.
pub fn integrate_segments(
    lanes: LaneSet,
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordered: bool,
    list: &[Segment],
) -> Result<Vec<IntegratedSegment>> {
    let mut found = integrate(lanes, transfer_function, shading, ordered, list)?;
    if found.iter().any(|found| found.contribution.optical_depth.is_nan()) {
        // Where colours need an order no depth is kept; a scene of one colour draws with it.
        let depths = integrate(lanes, &in_white(transfer_function), shading, false, list)?;
        for (found, depth) in found.iter_mut().zip(depths) {
            found.contribution.optical_depth = depth.contribution.optical_depth;
            found.fallback = found.fallback.or(depth.fallback);
        }
    }
    Ok(found)
}

/// Integrates segments; optical depths are NaN where the shader keeps none.
fn integrate(
    lanes: LaneSet,
    transfer_function: &TransferFunction,
    shading: &Shading,
    ordered: bool,
    list: &[Segment],
) -> Result<Vec<IntegratedSegment>> {
    let cells = VolumeCache::new(&Arc::new(volume(transfer_function, list)))?.empty()?;
    let attributes = attributes_of(&cells, transfer_function)?;
    let extent = Extent { scalar: cells.ranges[0], longest: cells.length };
    integrators::can_serve(&shading.integrator, transfer_function)?;
    let exact = || integrators::new(&shading.integrator, shading.overlap, transfer_function, &extent);
    let by_lanes = in_lanes_alone(&shading.integrator);
    let exact = if by_lanes { None } else { Some(exact()?) };
    let length = cells.length;
    let scene = ShaderContext { attributes: &attributes, length, ordered, leave_out: false, extent, lanes };
    let shader = Shader::new(transfer_function, shading, exact, scene, None)?;
    let mut batch = Batch::new(attributes.len(), attributes.len());
    let mut shaded = ShadedBatch::new();
    let mut found = Vec::with_capacity(list.len());
    for (number, part) in list.chunks(BATCH).enumerate() {
        fill(&mut batch, &attributes, number * BATCH, part, cells.length);
        shader::integrate(&shader, lanes, &batch, part.len(), &mut shaded);
        found.extend((0..part.len()).map(|k| integrated_segment(&shader, &shaded, k)));
    }
    Ok(found)
}

/// Volume whose points are the ends of segments, along one axis, so that the longest segment is the diagonal.
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

fn integrated_segment(shader: &Shader, shaded: &ShadedBatch, k: usize) -> IntegratedSegment {
    let fallback = shaded.fallback_queue.iter().position(|&rest| rest == k);
    let depth = if shader.keeps_depth() { f64::from(shaded.depth[k]) } else { f64::NAN };
    let [r, g, b, opacity] = match shader.one_color {
        Some(color) => pixel_in_one_color(color, shaded.depth[k], false),
        None => std::array::from_fn(|c| shaded.rgba[c][k]),
    }
    .map(f64::from);
    IntegratedSegment {
        contribution: Contribution { optical_depth: depth, color: [r, g, b], opacity },
        fallback: fallback.map(|at| shaded.reasons[at].text()),
    }
}

/// Transfer function of the same densities, all white.
fn in_white(transfer_function: &TransferFunction) -> TransferFunction {
    let widgets = transfer_function.widgets.iter().map(|widget| widget.in_color([1.0; 3])).collect();
    TransferFunction { widgets, ..*transfer_function }
}

/// Composites segments front to back in the lists of a tile, or in a list that grows where a pixel's is too short: C and A,
/// and 1 − A with its own relative accuracy, where it is known.
pub fn composite_chain(lanes: LaneSet, rgba: &[[f32; 4]]) -> ([f32; 4], Option<f64>) {
    let mut picture = [[0.0; 4]; PIXELS];
    let mut lists = FragmentLists::default();
    lists.clear(1);
    let listed = (0..rgba.len()).try_for_each(|k| {
        let number = f32::from_bits(k as u32);
        lists.push(0, [k as f32, 1.0], [[number; 2]])
    });
    let transparency = match listed {
        Ok(()) => {
            let mut pixels = TileAccumulator::new();
            blend_by_numbers(lanes, &mut lists, true, rgba, &mut pixels);
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
    (picture[0], transparency)
}

/// e^(−depth) as the kernels of ordered segments compute it.
pub fn transmittance(lanes: LaneSet, depth: f64) -> f64 {
    dispatch(lanes, Transmittance(depth))
}

struct Transmittance(f64);

impl Kernel<f64> for Transmittance {
    #[inline(always)]
    fn run<L: Lanes>(self) -> f64 {
        let mut lanes = [0.0; MAX_LANES];
        exp::<L>(L::F::splat(-self.0 as f32)).store(&mut lanes);
        f64::from(lanes[0])
    }
}
