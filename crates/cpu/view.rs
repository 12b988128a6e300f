//! View: from world space to eye space (scene lengths) and pixel coordinates.
//!
//! Lengths are divided by the grid's diagonal first, so a grid 1e-20 or 1e20 wide gives the same numbers, and
//! positions are taken relative to the eye in 64 bits, so an offset costs nothing.
//!
//! **Pixel coordinates** put the centre (or the current sample) of pixel (i, j) at the integers (i, j), j
//! downwards. They are rounded to 2⁻²⁴ of a pixel: points that coincide on the screen up to 64-bit noise then
//! coincide exactly, so that a face seen edge-on has an area of exactly zero, and a ray that lies in it is given
//! to one of the two cells by the fill rule of [`crate::fragments::spans`].

use crate::tolerances::FRUSTUM_SLACK;
use glam::DVec3;
use rayon::prelude::*;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};

/// Camera of one sub-pixel view: from world space to eye space and pixel coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    /// Perspective, or parallel rays.
    pub perspective: bool,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// World units in one scene length.
    pub length: f64,
    /// Depth of the near plane, scene lengths.
    pub near: f64,
    /// Slope of a ray one pixel off the axis (perspective), or a pixel's side in scene lengths.
    pub pixel: f64,
    /// Pixel coordinates of the view axis.
    pub axis: [f64; 2],
    /// Distance of a pixel's samples from its centre at most (pixels); 0 with one sample.
    reach: f64,
    eye: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
}

#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ScreenVertex {
    /// Pixel coordinate to the right.
    pub x: f64,
    /// Pixel coordinate downwards.
    pub y: f64,
    /// Depth along the view direction, scene lengths.
    pub z: f64,
}

/// Adding and taking away 1.5 · 2⁵² · 2⁻²⁴ rounds to a multiple of 2⁻²⁴ (|x| < 2²⁷; above, to a multiple of the
/// spacing of the floats there).
const ROUND: f64 = 1.5 * (1u64 << 28) as f64;

#[inline(always)]
fn snap(x: f64) -> f64 {
    if x.abs() < (1u64 << 27) as f64 { (x + ROUND) - ROUND } else { x }
}

impl View {
    /// `offset` moves the sample within the pixel, −½ … ½.
    pub fn new(camera: &Camera, length: f64, offset: [f64; 2]) -> Result<View> {
        let frame = camera.frame()?;
        let perspective = matches!(camera.projection, Projection::Perspective { .. });
        let size = camera.size.map(|n| n as usize);
        let reach =
            camera.sample_offsets().as_flattened().iter().fold(0.0, |reach: f64, x| reach.max(x.abs()));
        Ok(View {
            perspective,
            size,
            length,
            near: camera.near / length,
            pixel: if perspective { frame.pixel } else { frame.pixel / length },
            axis: [size[0] as f64 * 0.5 - 0.5 - offset[0], size[1] as f64 * 0.5 - 0.5 - offset[1]],
            reach,
            eye: camera.eye,
            right: frame.right,
            up: frame.up,
            forward: frame.forward,
        })
    }

    /// Eye space: right, down, forward, in scene lengths.
    #[inline(always)]
    pub fn eye_from_world(&self, p: DVec3) -> [f64; 3] {
        let q = (p - self.eye) / self.length;
        [q.dot(self.right), -q.dot(self.up), q.dot(self.forward)]
    }

    /// Pixel coordinates of a point in eye space; not finite where a perspective depth is 0.
    #[inline(always)]
    pub fn pixel_from_eye(&self, e: [f64; 3]) -> ScreenVertex {
        let scale = if self.perspective { 1.0 / (e[2] * self.pixel) } else { 1.0 / self.pixel };
        ScreenVertex { x: snap(e[0] * scale + self.axis[0]), y: snap(e[1] * scale + self.axis[1]), z: e[2] }
    }

    /// A point (x z, y z, z) of pixel coordinates x, y and depth z, also at the eye and behind it.
    #[inline(always)]
    pub fn homogeneous(&self, p: DVec3) -> [f64; 3] {
        let [x, y, z] = self.eye_from_world(p);
        [x / self.pixel + self.axis[0] * z, y / self.pixel + self.axis[1] * z, z]
    }

    /// Projects points to the screen, and finds for each the planes of the view that it lies outside of (one bit each: left, right, top,
    /// bottom, near).
    pub fn project(&self, points: &[DVec3]) -> (Vec<ScreenVertex>, Vec<u8>) {
        let vertex_and_outside = |p: &DVec3| {
            let e = self.eye_from_world(*p);
            (self.pixel_from_eye(e), self.outside(e))
        };
        let (mut vertices, mut outside) = (Vec::new(), Vec::new());
        points
            .par_iter()
            .with_min_len(1 << 12)
            .map(vertex_and_outside)
            .unzip_into_vecs(&mut vertices, &mut outside);
        (vertices, outside)
    }

    fn outside(&self, e: [f64; 3]) -> u8 {
        // The planes through the eye and the outermost samples of the outermost pixels, as signed pixel distances × depth.
        let depth = if self.perspective { e[2] } else { 1.0 };
        let (x, y) = (e[0] / self.pixel + self.axis[0] * depth, e[1] / self.pixel + self.axis[1] * depth);
        let (right, bottom) = ((self.size[0] - 1) as f64 * depth, (self.size[1] - 1) as f64 * depth);
        // A sliver of slack, so that rounding never drops a cell that touches the outermost samples.
        let slack =
            FRUSTUM_SLACK * (x.abs() + y.abs() + right.abs() + bottom.abs()) + self.reach * depth.abs();
        u8::from(x < -slack)
            | u8::from(x > right + slack) << 1
            | u8::from(y < -slack) << 2
            | u8::from(y > bottom + slack) << 3
            | u8::from(e[2] < self.near) << 4
    }

    /// Origin and direction, in eye space, of the ray through a pixel. The direction has depth 1; its length
    /// turns depths into distances.
    #[inline(always)]
    pub fn ray(&self, i: f64, j: f64) -> ([f64; 3], [f64; 3]) {
        let (x, y) = ((i - self.axis[0]) * self.pixel, (j - self.axis[1]) * self.pixel);
        if self.perspective { ([0.0; 3], [x, y, 1.0]) } else { ([x, y, 0.0], [0.0, 0.0, 1.0]) }
    }

    /// Unit direction, world axes, of the ray through a pixel.
    pub fn direction(&self, i: f64, j: f64) -> DVec3 {
        let (_, [x, y, _]) = self.ray(i, j);
        (self.forward + x * self.right - y * self.up).normalize()
    }

    /// Length of the ray's direction: Euclidean distance per depth.
    #[inline(always)]
    pub fn length_per_depth(&self, i: f64, j: f64) -> f64 {
        let (_, d) = self.ray(i, j);
        (d[0] * d[0] + d[1] * d[1] + 1.0).sqrt()
    }
}
