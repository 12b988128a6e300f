//! Camera: position, direction and projection of a picture (docs/src/explanation/optics.md, section 4).
//!
//! Right-handed. Pixel (i, j) of a W × H picture, row 0 at the top, is seen along the ray through its centre
//! (i + ½, j + ½). Distances along a ray are Euclidean, not depth.

use crate::{Error, Result};
use glam::DVec3;

/// Projection of the camera: perspective or parallel rays.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Rays meet in the eye; `fov_y` is the vertical field of view in degrees, 0 < fov_y < 180.
    Perspective {
        /// Vertical field of view, degrees.
        fov_y: f64,
    },
    /// Parallel rays; `height` is the picture's height in world units, > 0.
    Orthographic {
        /// Height of the picture, world units.
        height: f64,
    },
}

/// Camera: position, direction, projection and image size.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position of the eye, world units.
    pub eye: DVec3,
    /// The point that appears in the middle of the picture, world units.
    pub target: DVec3,
    /// The direction that points up in the picture; need not be perpendicular to the view, nor of unit length.
    pub up: DVec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// Distance of the near plane from the eye along the view direction (world units, ≥ 0); nearer parts are clipped.
    pub near: f64,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Samples a pixel.
    pub samples: u32,
}

/// The camera's unit axes in world space and the size of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector up in the picture (perpendicular to `forward`).
    pub up: DVec3,
    /// Unit view direction, from the eye to the target.
    pub forward: DVec3,
    /// Side of a pixel: at depth 1 (perspective: 2 tan(fov_y/2)/H) or in world units (orthographic: height/H).
    pub pixel: f64,
}

/// Most pixels a side that an engine draws: places in the picture are held in 16 bits.
const MAX_IMAGE_SIDE: u32 = 1 << 15;

impl Camera {
    /// Checks the picture's size and number of samples: errors name one that is out of range.
    pub fn check_picture(&self) -> Result<()> {
        let is_side = |&n: &u32| (1..=MAX_IMAGE_SIDE).contains(&n);
        let size = format!("{} × {}", self.size[0], self.size[1]);
        check("the picture's size", self.size.iter().all(is_side), size, "1 to 32,768 pixels a side")?;
        check("samples", (1..=256).contains(&self.samples), self.samples, "1 to 256 a pixel")
    }

    /// The camera's axes. Errors when eye and target coincide, when up is parallel to the view, or when a
    /// value is not finite or out of its range.
    pub fn frame(&self) -> Result<Frame> {
        let finite = [self.eye, self.target, self.up].iter().all(|v| v.is_finite());
        if !finite {
            return Err(Error::usage("the camera's eye, target and up must be finite numbers"));
        }
        let view = self.target - self.eye;
        // Scale first: squares of 1e-200 or 1e200 leave the range of f64.
        let scaled = |v: DVec3| {
            let largest = v.abs().max_element();
            if largest > 0.0 { (v / largest).normalize() } else { DVec3::ZERO }
        };
        let forward = scaled(view);
        if forward == DVec3::ZERO {
            return Err(Error::usage("the camera's eye and target are the same point").got(self.eye));
        }
        let side = forward.cross(scaled(self.up));
        if side.length() < 1e-12 {
            return Err(Error::usage("the camera's up is zero or parallel to the view direction")
                .got(self.up)
                .expected("a vector that is not parallel to target − eye"));
        }
        let right = side.normalize();
        let up = right.cross(forward);
        let height = f64::from(self.size[1]);
        let pixel = match self.projection {
            Projection::Perspective { fov_y } => {
                check("fov_y", fov_y > 0.0 && fov_y < 180.0, fov_y, "degrees between 0 and 180")?;
                2.0 * (0.5 * fov_y).to_radians().tan() / height
            }
            Projection::Orthographic { height: world } => {
                check("height", world > 0.0 && world.is_finite(), world, "world units above 0")?;
                world / height
            }
        };
        check("near", self.near >= 0.0 && self.near.is_finite(), self.near, "world units, 0 or more")?;
        Ok(Frame { right, up, forward, pixel })
    }

    /// Offsets of the samples of a pixel from its centre: one in the middle, or the centres of a regular n × n division
    /// for square numbers, else Roberts' R₂ sequence (2018), which spreads any number evenly.
    pub fn sample_offsets(&self) -> Vec<[f64; 2]> {
        let count = self.samples;
        let side = f64::from(count).sqrt().round() as u32;
        if side * side == count {
            let at = |k: u32| (f64::from(k) + 0.5) / f64::from(side) - 0.5;
            return (0..count).map(|k| [at(k % side), at(k / side)]).collect();
        }
        const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
        (0..count).map(|k| STEP.map(|step| (0.5 + step * f64::from(k)).fract() - 0.5)).collect()
    }
}

/// Refuses a value out of its range.
fn check(name: &str, is_in_range: bool, value: impl std::fmt::Display, range: &str) -> Result<()> {
    match is_in_range {
        true => Ok(()),
        false => Err(Error::usage(format!("{name} is out of range")).got(value).expected(range)),
    }
}
