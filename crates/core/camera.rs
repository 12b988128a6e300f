//! Camera: position, direction and projection of a picture (docs/src/explanation/optics.md, section 4).
//!
//! Right-handed. Pixel (i, j) of a W × H picture, row 0 at the top, is seen along the ray through its centre
//! (i + ½, j + ½). Distances along a ray are Euclidean, not depth.

use crate::arithmetic::unit_vector;
use crate::grid::extent::{bounds, diagonal};
use crate::{Error, Result};
use glam::{DQuat, DVec3};

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

/// Share of the half sides of a picture within which what it is fitted to lies.
const FITTED_SHARE: f64 = 0.94;

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
        let forward = unit_vector(view);
        if forward == DVec3::ZERO {
            return Err(Error::usage("the camera's eye and target are the same point")
                .got(self.eye)
                .expected("a target apart from the eye"));
        }
        let side = forward.cross(unit_vector(self.up));
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

    /// The camera turned by three angles, degrees, as the methods `Azimuth`, `Elevation` and `Roll` of `vtkCamera` turn it, one
    /// after the other: the eye about the target, by `azimuth` about `up` (to the right) and by `elevation` about the picture's axis
    /// to the left (upwards); then `up` by `roll` about the view direction (to the right, so that the picture turns to the left).
    ///
    /// # Errors
    /// - those of [`Camera::frame`], as where an elevation of 90 leads to a view along `up`.
    pub fn turned(mut self, [azimuth, elevation, roll]: [f64; 3]) -> Result<Camera> {
        let turn = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
        self.frame()?;
        // An angle of 0 leaves every bit.
        if azimuth != 0.0 {
            self.eye = self.target + turn(unit_vector(self.up), azimuth) * (self.eye - self.target);
        }
        if elevation != 0.0 {
            self.eye = self.target + turn(-self.frame()?.right, elevation) * (self.eye - self.target);
        }
        if roll != 0.0 {
            self.up = turn(self.frame()?.forward, roll) * unit_vector(self.up);
        }
        self.frame().map(|_| self)
    }

    /// The camera moved, in the direction in which it looks, to where its picture just holds all finite points, with a margin of 6 %. An
    /// orthographic camera gets the height for it. The target is at the depth of the middle of the points' box.
    ///
    /// # Errors
    /// - points without an extent;
    /// - those of [`Camera::frame`].
    pub fn fitted(mut self, points: &[DVec3]) -> Result<Camera> {
        let Frame { right, up, forward, .. } = self.frame()?;
        let ends = bounds(points).filter(|&ends| (f64::MIN_POSITIVE..=f64::MAX).contains(&diagonal(ends)));
        let none =
            || Error::usage("the camera is fitted to what has no extent").expected("a box with an extent");
        let ends = ends.ok_or_else(none)?;
        let middle = 0.5 * ends[0] + 0.5 * ends[1];
        let aspect = f64::from(self.size[0]) / f64::from(self.size[1]);
        let tan_y = match self.projection {
            Projection::Perspective { fov_y } => FITTED_SHARE * (0.5 * fov_y).to_radians().tan(),
            Projection::Orthographic { .. } => 0.0,
        };
        let tan_x = tan_y * aspect;
        // A point p is in the picture of an eye e where |(p − e)·right| ≤ tan_x (p − e)·forward, and alike above: of each side of the
        // picture the point that is farthest out counts. Positions are those from the box's middle.
        let mut out = [f64::NEG_INFINITY; 4];
        for point in points.iter().filter(|point| point.is_finite()) {
            let p = *point - middle;
            let (x, y, z) = (p.dot(right), p.dot(up), -p.dot(forward));
            let own = [x + tan_x * z, -x + tan_x * z, y + tan_y * z, -y + tan_y * z];
            out.iter_mut().zip(own).for_each(|(out, own)| *out = out.max(own));
        }
        let [east, west, north, south] = out;
        let half = [0.5 * (east + west), 0.5 * (north + south)];
        let distance = match &mut self.projection {
            Projection::Perspective { .. } => (half[0] / tan_x).max(half[1] / tan_y),
            Projection::Orthographic { height } => {
                *height = 2.0 * (half[0] / aspect).max(half[1]) / FITTED_SHARE;
                diagonal(ends)
            }
        };
        let in_middle = middle + 0.5 * (east - west) * right + 0.5 * (north - south) * up;
        self.eye = in_middle - distance * forward;
        // Points before the middle of their box let a wide view begin behind it.
        self.target = self.eye + distance.max(1e-2 * diagonal(ends)) * forward;
        self.frame().map(|_| self)
    }

    /// The camera with a smaller view for a factor above 1, as the method `Zoom` of `vtkCamera`: its angle of view, or its height, divided
    /// by the factor.
    pub fn zoomed(mut self, factor: f64) -> Camera {
        let (Projection::Perspective { fov_y: extent } | Projection::Orthographic { height: extent }) =
            &mut self.projection;
        *extent /= factor;
        self
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::extent::corners;

    fn camera(projection: Projection) -> Camera {
        let (eye, target) = (DVec3::new(1.0, -3.0, 2.0), DVec3::new(1.0, 1.0, 2.0));
        Camera { eye, target, up: 2.0 * DVec3::Z, projection, near: 0.0, size: [400, 300], samples: 1 }
    }

    const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 40.0 };

    fn is_near(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-12
    }

    /// Worked by hand from vtkCamera's definitions: 4 from the target along −y, up along z.
    #[test]
    fn angles_turn_as_those_of_a_vtk_camera() {
        let camera = camera(PERSPECTIVE);
        let (target, half, root) = (camera.target, 0.5, 0.75f64.sqrt());
        let eye = |angles| camera.turned(angles).unwrap().eye - target;
        // To the right, and upwards.
        assert!(is_near(eye([30.0, 0.0, 0.0]), 4.0 * DVec3::new(half, -root, 0.0)));
        assert!(is_near(eye([0.0, 30.0, 0.0]), 4.0 * DVec3::new(0.0, -root, half)));
        // Up stays, so that the elevation is about the turned right: from +x upwards.
        assert!(is_near(eye([90.0, 30.0, 0.0]), 4.0 * DVec3::new(root, 0.0, half)));
        let rolled = camera.turned([0.0, 0.0, 30.0]).unwrap();
        assert!(is_near(rolled.up, DVec3::new(half, 0.0, root)) && rolled.eye == camera.eye);
        assert_eq!(camera.turned([0.0; 3]).unwrap(), camera);
        let error = camera.turned([0.0, 90.0, 0.0]).unwrap_err().to_string();
        assert!(error.contains("parallel to the view"), "{error}");
    }

    #[test]
    fn a_zoom_divides_the_angle_or_the_height() {
        let zoomed = |projection| camera(projection).zoomed(2.5).projection;
        assert_eq!(zoomed(PERSPECTIVE), Projection::Perspective { fov_y: 16.0 });
        let parallel = Projection::Orthographic { height: 5.0 };
        assert_eq!(zoomed(parallel), Projection::Orthographic { height: 2.0 });
    }

    /// Every corner is in the picture, and each of two opposite sides has one at the margin.
    #[test]
    fn a_fitted_picture_just_holds_a_box() {
        let ends = [DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 3.0, 5.0)];
        for projection in [PERSPECTIVE, Projection::Orthographic { height: 1.0 }] {
            for (size, angles) in [([400, 300], [0.0; 3]), ([200, 500], [70.0, -20.0, 33.0])] {
                let turned = Camera { size, ..camera(projection) }.turned(angles).unwrap();
                let fitted = turned.fitted(&corners(ends)).unwrap();
                let frame = fitted.frame().unwrap();
                assert!(is_near(frame.forward, turned.frame().unwrap().forward));
                let mut sides = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
                for corner in corners(ends) {
                    let to = corner - fitted.eye;
                    let depth = to.dot(frame.forward);
                    let scale = match projection {
                        Projection::Perspective { .. } => frame.pixel * depth,
                        Projection::Orthographic { .. } => frame.pixel,
                    };
                    assert!(depth > 0.0);
                    for (axis, side) in [frame.right, frame.up].into_iter().enumerate() {
                        let place = 2.0 * to.dot(side) / (scale * f64::from(size[axis]));
                        sides[axis] = [sides[axis][0].min(place), sides[axis][1].max(place)];
                    }
                }
                let is_full = |[low, high]: [f64; 2]| (low + 0.94).abs().max((high - 0.94).abs()) < 1e-12;
                assert!(sides.iter().all(|[low, high]| *low > -0.9401 && *high < 0.9401), "{sides:?}");
                assert!(sides.into_iter().any(is_full), "{sides:?}");
            }
        }
        camera(PERSPECTIVE).fitted(&[DVec3::ONE, DVec3::ONE, DVec3::splat(f64::NAN)]).unwrap_err();
        camera(PERSPECTIVE).fitted(&[DVec3::splat(-1.7e308), DVec3::splat(1.7e308)]).unwrap_err();
    }
}
