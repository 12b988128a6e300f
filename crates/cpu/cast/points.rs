//! Points of the grid for rays: screen positions and depths in whole steps, so that differences are exact.

use crate::attribute::Attribute;
use crate::tile::TILE;
use crate::tolerances::MAX_DEPTH_RATIO;
use crate::view::{ScreenVertex, View};
use rayon::prelude::*;

/// Points of a chunk of work.
const CHUNK: usize = 1 << 13;

/// Bits of a pixel at most: the step that screen positions are rounded to.
const MAX_PIXEL_BITS: i64 = 24;

/// Bits of a pixel at least: cells are larger than any picture.
const MIN_PIXEL_BITS: i64 = 12;

/// Steps of the whole range of depths.
const STEPS: f64 = (1u32 << 31) as f64 - 1024.0;

/// Points on the screen.
#[derive(Debug)]
pub(crate) struct Points {
    /// For each point: x and y in steps of 2^−`pixel_bits` pixel, without what 32 bits do not hold, so that differences within a cell are
    /// exact, and depth in steps from the nearest (bits in place of floats); the first attribute. Then four further attributes each.
    pub quads: Vec<Vec<[f32; 4]>>,
    pub pixel_bits: u32,
    /// 1 / depth of step 0 and how much it falls with each step; or with parallel rays depth of step 0 and a step.
    pub nearest: f32,
    pub step: f32,
    /// A step of screen positions (pixels).
    pub pixel: f32,
}

/// Extent of points on the screen: the largest |x| or |y|, least and greatest depth.
pub(super) struct ScreenExtent([f64; 3]);

impl ScreenExtent {
    /// `None` unless all points lie well in front of the eye.
    pub fn new(view: &View, vertices: &[ScreenVertex]) -> Option<ScreenExtent> {
        let none = || [0.0, f64::INFINITY, f64::NEG_INFINITY];
        let join = |a: [f64; 3], b: [f64; 3]| [a[0].max(b[0]), a[1].min(b[1]), a[2].max(b[2])];
        let of = |s: &ScreenVertex| [s.x.abs().max(s.y.abs()), s.z, s.z];
        let reach @ [largest, near, far] = vertices.par_iter().with_min_len(CHUNK).map(of).reduce(none, join);
        let in_front =
            near > view.near && (!view.perspective || (near > 0.0 && far < MAX_DEPTH_RATIO * near));
        (in_front && far.is_finite() && largest.is_finite()).then_some(ScreenExtent(reach))
    }
}

impl Points {
    /// `longest`: the longest edge of a cell, scene lengths. `None` where cells may be larger than whole steps reach.
    pub fn new(
        view: &View,
        vertices: &[ScreenVertex],
        &ScreenExtent([largest, near, far]): &ScreenExtent,
        longest: f64,
        attributes: &[Attribute<'_>],
    ) -> Option<Points> {
        // |x/z − x'/z'| ≤ (|x − x'| + |x'/z'| |z − z'|) / z, and a tile beside the cell.
        let (depth, slope) = if view.perspective { (near, largest * view.pixel) } else { (1.0, 0.0) };
        let reach = longest * (1.0 + 2.0 * slope) / (depth * view.pixel) + 2.0 * TILE as f64;
        let pixel_bits = MAX_PIXEL_BITS.min(30 - reach.log2().ceil() as i64);
        let pixel_bits = u32::try_from(pixel_bits).ok().filter(|_| MIN_PIXEL_BITS <= pixel_bits)?;
        let (nearest, range) =
            if view.perspective { (1.0 / near, 1.0 / near - 1.0 / far) } else { (near, far - near) };
        let per_step = if range > 0.0 { STEPS / range } else { 0.0 };
        let steps_of_pixel = f64::from(1u32 << pixel_bits);
        let of = |point: usize, s: &ScreenVertex| {
            let position = |x: f64| f32::from_bits((x * steps_of_pixel).round() as i64 as u32);
            let behind = if view.perspective { nearest - 1.0 / s.z } else { s.z - nearest };
            let depth = f32::from_bits((behind * per_step).round() as u32);
            [position(s.x), position(s.y), depth, stored(attributes.first(), point)]
        };
        let mut first = vec![[0.0; 4]; vertices.len()];
        first.par_chunks_mut(CHUNK).zip(vertices.par_chunks(CHUNK)).enumerate().for_each(
            |(chunk, (out, vertices))| {
                for (k, (out, s)) in out.iter_mut().zip(vertices).enumerate() {
                    *out = of(chunk * CHUNK + k, s);
                }
            },
        );
        let mut quads = vec![first];
        for quad in attributes.get(1..).unwrap_or_default().chunks(4) {
            let mut further = vec![[0.0; 4]; vertices.len()];
            further.par_chunks_mut(CHUNK).enumerate().for_each(|(chunk, out)| {
                for (k, out) in out.iter_mut().enumerate() {
                    *out = [0, 1, 2, 3].map(|a: usize| stored(quad.get(a), chunk * CHUNK + k));
                }
            });
            quads.push(further);
        }
        let step = if per_step > 0.0 { 1.0 / per_step } else { 0.0 };
        let pixel = (1.0 / steps_of_pixel) as f32;
        Some(Points { quads, pixel_bits, nearest: nearest as f32, step: step as f32, pixel })
    }
}

fn stored(attribute: Option<&Attribute<'_>>, point: usize) -> f32 {
    attribute.map_or(0.0, |a| ((a.at(point) - a.offset) / a.scale) as f32)
}
