//! Points of the grid for rays: screen positions and depths in whole steps, so that differences are exact.

use crate::attribute::Attribute;
use crate::tile::TILE;
use crate::tolerances::MAX_DEPTH_RATIO;
use crate::view::{ScreenVertex, View};
use glam::DVec3;
use rayon::prelude::*;

/// Points of a chunk of work.
const CHUNK: usize = 1 << 13;

/// Bits of a pixel at most: the step that screen positions are rounded to.
const MAX_PIXEL_BITS: i64 = 24;

/// Bits of a pixel at least: cells are larger than any picture.
const MIN_PIXEL_BITS: i64 = 12;

/// Steps of the whole range of depths.
const STEPS: f64 = (1u32 << 31) as f64 - 1024.0;

/// Binary digits of depth steps below a step of positions, where rays spread from an eye among the cells.
pub(super) const SPREAD_BITS: u32 = 8;

/// Steps of a scene length along the view axis and across it, below which their rounding would be seen.
const MIN_STEPS: f64 = (1u32 << 25) as f64;

/// Points on the screen; or, where cells reach behind the near plane or the nearest is far nearer than the others, as each ray sees them:
/// moved along it into the plane of depth 0. That has no division by depth, so points may lie at the eye and behind it.
#[derive(Debug)]
pub(crate) struct Points {
    /// For each point: x and y in steps, without what 32 bits do not hold, so that differences within a cell are exact, and depth in
    /// steps from the nearest (bits in place of floats); the first attribute. Then four further attributes each.
    pub quads: Vec<Vec<[f32; 4]>>,
    /// A step of screen positions is 2^−`pixel_bits` pixel, where rays do not spread.
    pub pixel_bits: u32,
    /// True if inverses of depths are linear on the screen; else depths are, or are as each ray sees them.
    pub perspective: bool,
    /// 1 / depth of step 0 and how much it falls with each step; or with linear depths depth of step 0 and a step.
    pub nearest: f32,
    pub step: f32,
    /// Depth of step 0.
    pub first_depth: f64,
    /// A step of positions (pixels, or pixels × depth).
    pub pixel: f32,
    /// Steps from a pixel's ray to that of the next, at the depth of step 0.
    pub ray_spacing: u32,
    /// Steps by which these move apart in 2^[`SPREAD_BITS`] steps of depth: 1, or 0 where rays do not spread.
    pub ray_spread: u32,
    /// Depth of the near plane (steps), where it may cut cells: depths are linear then.
    pub near: Option<u32>,
    /// The view, where rays spread.
    spread: Option<SpreadView>,
}

/// View whose rays spread from an eye among the cells.
#[derive(Debug, Clone, Copy)]
struct SpreadView {
    view: View,
    /// A step of positions.
    rounding: f64,
}

/// Extent of points on the screen: the largest |x| or |y|, least and greatest depth. It has few digits and holds the points but for
/// rounding, and has the same bits whether it is found of all points of a grid or of those of its parts. Ends that have few digits stay what
/// they are.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ScreenExtent {
    largest: f64,
    pub near: f64,
    far: f64,
}

/// Binary digits that are left of the largest position, and of depths within their range.
const EXTENT_BITS: u32 = 16;

/// Fraction of itself by which rounding may move an end, at most: some units in the last place.
const EXTENT_ROUNDING: f64 = 1e-14;

/// The next number of few digits that is not below but for rounding; `x` ≥ 0.
fn coarse_above(x: f64) -> f64 {
    if !x.is_finite() {
        return x;
    }
    let rest = (1_u64 << (f64::MANTISSA_DIGITS - 1 - EXTENT_BITS)) - 1;
    f64::from_bits(((x - EXTENT_ROUNDING * x).to_bits() + rest) & !rest)
}

impl ScreenExtent {
    pub fn new(vertices: &[ScreenVertex]) -> ScreenExtent {
        let none = || [0.0, f64::INFINITY, f64::NEG_INFINITY];
        let join = |a: [f64; 3], b: [f64; 3]| [a[0].max(b[0]), a[1].min(b[1]), a[2].max(b[2])];
        let of = |s: &ScreenVertex| [s.x.abs().max(s.y.abs()), s.z, s.z];
        ScreenExtent::rounded(vertices.par_iter().with_min_len(CHUNK).map(of).reduce(none, join))
    }

    /// The extent of all points of a grid: their positions about the view axis (pixels), and depths (world units).
    pub fn of_whole([across, down, depth]: [[f64; 2]; 3], view: &View) -> ScreenExtent {
        let farthest = |[low, high]: [f64; 2], axis: f64| (low + axis).abs().max((high + axis).abs());
        let largest = farthest(across, view.axis[0]).max(farthest(down, view.axis[1]));
        ScreenExtent::rounded([largest, depth[0] / view.length, depth[1] / view.length])
    }

    /// Depths are rounded by a share of their range, which may be far smaller than they are.
    fn rounded([largest, near, far]: [f64; 3]) -> ScreenExtent {
        let largest = coarse_above(largest);
        let rounding = [near, far].map(|end| EXTENT_ROUNDING * end.abs());
        let range = far - near + rounding[0] + rounding[1];
        let step = (range.log2().ceil() - f64::from(EXTENT_BITS)).exp2();
        let ends = [((near + rounding[0]) / step).floor() * step, ((far - rounding[1]) / step).ceil() * step];
        // All points in the plane of the eye, or none.
        let [near, far] = if ends.iter().all(|end| end.is_finite()) { ends } else { [near, far] };
        ScreenExtent { largest, near, far }
    }

    /// True if the near plane, or the eye, may cut cells.
    pub fn is_cut(&self, view: &View) -> bool {
        self.near <= view.near
            || (view.perspective && (self.near <= 0.0 || MAX_DEPTH_RATIO * self.near <= self.far))
    }
}

impl Points {
    /// `longest`: the longest edge of a cell, scene lengths. `None` where cells may be larger than whole steps reach.
    pub fn new(
        view: &View,
        points: &[DVec3],
        vertices: &[ScreenVertex],
        extent: &ScreenExtent,
        longest: f64,
        attributes: &[Attribute<'_>],
    ) -> Option<Points> {
        let is_cut = extent.is_cut(view);
        if view.perspective && is_cut {
            return Points::spread(view, points, extent, longest, attributes);
        }
        let &ScreenExtent { largest, near, far } = extent;
        if !far.is_finite() || !largest.is_finite() {
            return None;
        }
        // |x/z − x'/z'| ≤ (|x − x'| + |x'/z'| |z − z'|) / z, and a tile beside the cell.
        let (depth, slope) = if view.perspective { (near, largest * view.pixel) } else { (1.0, 0.0) };
        let reach = longest * (1.0 + 2.0 * slope) / (depth * view.pixel) + 2.0 * TILE as f64;
        let pixel_bits = MAX_PIXEL_BITS.min(30 - reach.log2().ceil() as i64);
        let pixel_bits = u32::try_from(pixel_bits).ok().filter(|_| MIN_PIXEL_BITS <= pixel_bits)?;
        let (nearest, range) =
            if view.perspective { (1.0 / near, 1.0 / near - 1.0 / far) } else { (near, far - near) };
        let per_step = if range > 0.0 { STEPS / range } else { 0.0 };
        let steps_of_pixel = f64::from(1u32 << pixel_bits);
        let quads = quads(vertices.len(), attributes, |point| {
            let s = &vertices[point];
            let behind = if view.perspective { nearest - 1.0 / s.z } else { s.z - nearest };
            [
                steps_of(s.x * steps_of_pixel),
                steps_of(s.y * steps_of_pixel),
                (behind * per_step).round() as u32,
            ]
        });
        Some(Points {
            quads,
            perspective: view.perspective,
            pixel_bits,
            nearest: nearest as f32,
            step: if per_step > 0.0 { 1.0 / per_step } else { 0.0 } as f32,
            first_depth: near,
            pixel: (1.0 / steps_of_pixel) as f32,
            ray_spacing: 1 << pixel_bits,
            ray_spread: 0,
            near: is_cut.then(|| ((view.near - nearest) * per_step).round().min(STEPS) as u32),
            spread: None,
        })
    }

    /// Points as rays see them that spread from an eye among the cells.
    fn spread(
        view: &View,
        points: &[DVec3],
        &ScreenExtent { near, far, .. }: &ScreenExtent,
        longest: f64,
        attributes: &[Attribute<'_>],
    ) -> Option<Points> {
        // A cell's corners from a ray that passes it, |x − x' − i (z − z')|, and from those of a tile beside it.
        let widest =
            view.axis.into_iter().zip(view.size).fold(0.0, |widest: f64, (axis, size)| {
                widest.max(axis.abs()).max((size as f64 - axis).abs())
            });
        let reach = longest * (1.0 / view.pixel + widest) + 2.0 * TILE as f64 * near.abs().max(far.abs());
        let steps_of_depth = f64::from(1u32 << SPREAD_BITS);
        let per_step = (f64::from(1u32 << 30) / reach).min(STEPS / (steps_of_depth * (far - near)));
        let per_depth = per_step * steps_of_depth;
        if !per_step.is_finite() || per_depth < MIN_STEPS || per_step < MIN_STEPS * view.pixel {
            return None;
        }
        let first = (near * per_step).floor();
        let nearest = first / per_step;
        let quads = quads(points.len(), attributes, |point| {
            let [x, y, z] = view.homogeneous(points[point]);
            [steps_of(x * per_step), steps_of(y * per_step), ((z - nearest) * per_depth).round() as u32]
        });
        Some(Points {
            quads,
            perspective: false,
            pixel_bits: 0,
            nearest: nearest as f32,
            step: (1.0 / per_depth) as f32,
            first_depth: nearest,
            pixel: (1.0 / per_step) as f32,
            ray_spacing: steps_of(first),
            ray_spread: 1,
            near: Some(((view.near - nearest) * per_depth).round().min(STEPS) as u32),
            spread: Some(SpreadView { view: *view, rounding: 1.0 / per_step }),
        })
    }

    /// A point (x z, y z, z) of pixel coordinates x, y and depth z, with the rounding of x z and y z; where rays do not spread z is 1.
    pub fn corner(&self, vertices: &[ScreenVertex], points: &[DVec3], point: u32) -> ([f64; 3], f64) {
        match &self.spread {
            Some(SpreadView { view, rounding }) => (view.homogeneous(points[point as usize]), *rounding),
            None => {
                let s = &vertices[point as usize];
                ([s.x, s.y, 1.0], 0.0)
            }
        }
    }
}

/// Whole steps, without what 32 bits do not hold.
fn steps_of(x: f64) -> u32 {
    x.round() as i64 as u32
}

fn quads(
    count: usize,
    attributes: &[Attribute<'_>],
    position: impl Fn(usize) -> [u32; 3] + Sync,
) -> Vec<Vec<[f32; 4]>> {
    let mut quads = vec![filled(count, |point| {
        let [x, y, depth] = position(point).map(f32::from_bits);
        [x, y, depth, stored(attributes.first(), point)]
    })];
    for quad in attributes.get(1..).unwrap_or_default().chunks(4) {
        quads.push(filled(count, |point| [0, 1, 2, 3].map(|a: usize| stored(quad.get(a), point))));
    }
    quads
}

fn filled(count: usize, value: impl Fn(usize) -> [f32; 4] + Sync) -> Vec<[f32; 4]> {
    let mut quad = vec![[0.0; 4]; count];
    quad.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
        for (k, out) in out.iter_mut().enumerate() {
            *out = value(chunk * CHUNK + k);
        }
    });
    quad
}

fn stored(attribute: Option<&Attribute<'_>>, point: usize) -> f32 {
    attribute.map_or(0.0, |a| ((a.at(point) - a.offset) / a.scale) as f32)
}
