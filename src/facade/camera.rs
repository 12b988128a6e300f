//! Cameras, stated by an eye and a target or by the box that they frame.

use glam::DVec3;
use voltet_core::Result;
use voltet_core::camera::{Camera as PlacedCamera, Projection};
use voltet_core::grid::extent::corners;

/// Field of view of a perspective camera without one of its own (degrees).
const DEFAULT_FOV_Y: f64 = 30.0;

/// Direction from the middle of a framed box to the eye: from the front, the side and above.
const DEFAULT_DIRECTION: DVec3 = DVec3::new(-1.0, -2.0, 1.0);

/// Cosine of the angle between view and z beyond which y points up.
const MAX_VERTICAL: f64 = 0.999;

/// Position, projection and picture size. Numbers are checked by the render that uses it, or by [`Camera::place`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    view: View,
    up: Option<DVec3>,
    projection: Projection,
    near: f64,
    size: [u32; 2],
    samples: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum View {
    /// A box (world units), all of which is seen from this direction.
    Framing {
        bounds: [DVec3; 2],
        direction: DVec3,
    },
    LookAt {
        eye: DVec3,
        target: DVec3,
    },
}

impl Camera {
    fn new(view: View) -> Self {
        let projection = Projection::Perspective { fov_y: DEFAULT_FOV_Y };
        Camera { view, up: None, projection, near: 0.0, size: [1024, 768], samples: 1 }
    }

    /// A camera that sees all of a box, such as [`super::Volume::bounds`], which fills the picture but for a margin of 6 %.
    pub fn framing(bounds: [DVec3; 2]) -> Self {
        Self::new(View::Framing { bounds, direction: DEFAULT_DIRECTION })
    }

    /// A camera at `eye` whose picture has `target` in its middle (world units).
    pub fn look_at(eye: impl Into<DVec3>, target: impl Into<DVec3>) -> Self {
        Self::new(View::LookAt { eye: eye.into(), target: target.into() })
    }

    /// Moves the eye to this direction from the target, at the same distance; of any length.
    pub fn from(mut self, direction: impl Into<DVec3>) -> Self {
        let new_direction = direction.into();
        match &mut self.view {
            View::Framing { direction, .. } => *direction = new_direction,
            View::LookAt { eye, target } => {
                *eye = *target + new_direction.normalize_or_zero() * eye.distance(*target);
            }
        }
        self
    }

    /// Direction that points up in the picture. Default: z, and y where the view is along z.
    pub fn up(self, up: impl Into<DVec3>) -> Self {
        Camera { up: Some(up.into()), ..self }
    }

    /// Perspective projection with a vertical field of view (degrees). Default: 30.
    pub fn fov_y(self, degrees: f64) -> Self {
        Camera { projection: Projection::Perspective { fov_y: degrees }, ..self }
    }

    /// Orthographic projection of a height (world units).
    pub fn orthographic(self, height: f64) -> Self {
        Camera { projection: Projection::Orthographic { height }, ..self }
    }

    /// Distance along the view direction before which everything is cut away (world units). Default: 0.
    pub fn near(self, distance: f64) -> Self {
        Camera { near: distance, ..self }
    }

    /// Width and height of the picture (pixels). Default: 1024 × 768.
    pub fn size(self, width: u32, height: u32) -> Self {
        Camera { size: [width, height], ..self }
    }

    /// Rays a pixel, 1 … 256. Default: 1.
    pub fn samples(self, count: u32) -> Self {
        Camera { samples: count, ..self }
    }

    /// The camera with its eye in place.
    ///
    /// # Errors
    /// - a number that is out of range or not finite;
    /// - an eye at the target, or a direction up that is parallel to the view;
    /// - a framed box without an extent.
    pub fn place(&self) -> Result<PlacedCamera> {
        let (eye, target) = match self.view {
            View::LookAt { eye, target } => (eye, target),
            View::Framing { direction, .. } => (direction, DVec3::ZERO),
        };
        let is_vertical = (target - eye).normalize_or_zero().z.abs() > MAX_VERTICAL;
        let up = self.up.unwrap_or(if is_vertical { DVec3::Y } else { DVec3::Z });
        let (projection, near, size, samples) = (self.projection, self.near, self.size, self.samples);
        let camera = PlacedCamera { eye, target, up, projection, near, size, samples };
        camera.check_picture()?;
        camera.frame()?;
        match self.view {
            View::LookAt { .. } => Ok(camera),
            View::Framing { bounds, .. } => {
                Ok(PlacedCamera { projection, ..camera.fitted(&corners(bounds))? })
            }
        }
    }
}

impl From<PlacedCamera> for Camera {
    fn from(camera: PlacedCamera) -> Self {
        let PlacedCamera { eye, target, up, projection, near, size, samples } = camera;
        Camera { view: View::LookAt { eye, target }, up: Some(up), projection, near, size, samples }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_framing_camera_sees_the_corners_of_its_box() {
        let bounds = [DVec3::new(-1.0, 2.0, 3.0), DVec3::new(4.0, 3.0, 5.0)];
        for [width, height] in [[300, 200], [200, 300]] {
            let camera = Camera::framing(bounds).size(width, height).place().unwrap();
            let frame = camera.frame().unwrap();
            for corner in 0..8 {
                let pick = |axis: usize| bounds[(corner >> axis) & 1][axis];
                let v = DVec3::new(pick(0), pick(1), pick(2)) - camera.eye;
                let depth = v.dot(frame.forward);
                let half = [width, height].map(|side| 0.5 * f64::from(side) * frame.pixel * depth);
                assert!(v.dot(frame.right).abs() <= half[0] && v.dot(frame.up).abs() <= half[1]);
            }
        }
    }

    #[test]
    fn numbers_out_of_range_are_refused() {
        let bounds = [DVec3::ZERO, DVec3::ONE];
        let framing = Camera::framing(bounds);
        for camera in [framing.size(0, 3), framing.fov_y(180.0), framing.samples(0), framing.from([0.0; 3])] {
            camera.place().unwrap_err();
        }
        // Seen along z, y is up.
        assert_eq!(framing.from([0.0, 0.0, 1.0]).place().unwrap().up, DVec3::Y);
    }
}
