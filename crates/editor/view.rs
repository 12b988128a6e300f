//! Movements of the camera: from where a picture is seen to where it is seen next. Pure functions, without a window.
//!
//! Distances in the picture are in heights of it, from its middle, to the right and up.

use glam::{DQuat, DVec3};
use voltet_core::arithmetic::decimal;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::grid::extent::corners;
use voltet_graph::{LocatedValue, NodeEntry, ParameterValue};
use voltet_nodes::VIEW_PARAMETERS;

/// Share of the distance to the target that a moved camera is written to: a picture of 30,000 pixels does not show the rest.
const STEP: f64 = 1e-6;

/// Position and direction of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Position of the eye, world units.
    pub eye: DVec3,
    /// The point in the middle of the picture, world units.
    pub target: DVec3,
    /// The direction that points up in the picture.
    pub up: DVec3,
    /// Projection of rays.
    pub projection: Projection,
}

/// Square of the sine of the angle between a line and the sight of a point on it below which places in the picture say nothing of places along
/// the line: 8 degrees.
const END_ON: f64 = 0.02;

/// Least depth to which a point is moved towards the eye, as a share of its own.
const BEFORE_EYE: f64 = 0.05;

impl View {
    /// The view that a camera node states by eye and target; `None` where it states none, or one that is not sound.
    pub fn from_camera(node: &NodeEntry) -> Option<View> {
        if VIEW_PARAMETERS.iter().any(|name| node.setting(name).is_some()) {
            return None;
        }
        let vector = |name: &str| node.setting(name)?.array().map(DVec3::from);
        let projection = match (node.setting("height").and_then(LocatedValue::number), node.setting("fov_y"))
        {
            (Some(height), None) => Projection::Orthographic { height },
            (None, None) => Projection::Perspective { fov_y: 30.0 },
            (_, Some(fov_y)) => Projection::Perspective { fov_y: fov_y.number()? },
        };
        let up = if node.setting("up").is_some() { vector("up")? } else { DVec3::Z };
        let view = View { eye: vector("eye")?, target: vector("target")?, up, projection };
        view.axes().map(|_| view)
    }

    /// The parameters of a camera node that say so: a name and a value each. Numbers are written as finely as a picture shows.
    pub fn settings(&self) -> Vec<(&'static str, ParameterValue)> {
        let scale = (self.eye - self.target).length();
        let vector =
            |v: DVec3, scale: f64| v.to_array().into_iter().map(|x| decimal(x, STEP * scale)).collect();
        let projection = match self.projection {
            Projection::Perspective { fov_y } => ("fov_y", decimal(fov_y, STEP * fov_y).into()),
            Projection::Orthographic { height } => ("height", decimal(height, STEP * height).into()),
        };
        vec![
            ("eye", vector(self.eye, scale)),
            ("target", vector(self.target, scale)),
            ("up", vector(self.up, self.up.length())),
            projection,
        ]
    }

    /// The camera of a picture of that size.
    pub fn camera(&self, size: [u32; 2]) -> Camera {
        let View { eye, target, up, projection } = *self;
        Camera { eye, target, up, projection, near: 0.0, size, samples: 1 }
    }

    /// The picture's own axes in world space.
    fn axes(&self) -> Option<Frame> {
        self.camera([1, 1]).frame().ok()
    }

    /// Unit vectors that point to the right and up in the picture; `None` of a view that is not sound.
    pub fn sides(&self) -> Option<[DVec3; 2]> {
        self.axes().map(|axes| [axes.right, axes.up])
    }

    fn distance(&self) -> f64 {
        (self.target - self.eye).length()
    }

    /// Height of the picture at the target, world units.
    pub fn height(&self) -> f64 {
        match self.projection {
            Projection::Perspective { fov_y } => 2.0 * self.distance() * (0.5 * fov_y).to_radians().tan(),
            Projection::Orthographic { height } => height,
        }
    }

    /// Place of a point in the picture; `None` of a point that is not before the eye.
    pub fn place(&self, point: DVec3) -> Option<[f64; 2]> {
        let axes = self.axes()?;
        let from = point - self.eye;
        let depth = from.dot(axes.forward);
        let height = match self.projection {
            Projection::Perspective { .. } => axes.pixel * depth,
            Projection::Orthographic { height } => height,
        };
        let is_before = depth > 0.0 || matches!(self.projection, Projection::Orthographic { .. });
        is_before.then(|| [from.dot(axes.right) / height, from.dot(axes.up) / height])
    }

    /// Origin and unit direction of the ray through a place of the picture, world units.
    pub fn ray(&self, [right, up]: [f64; 2]) -> Option<[DVec3; 2]> {
        let axes = self.axes()?;
        let aside = axes.pixel * (right * axes.right + up * axes.up);
        Some(match self.projection {
            Projection::Perspective { .. } => [self.eye, (axes.forward + aside).normalize()],
            Projection::Orthographic { .. } => [self.eye + aside, axes.forward],
        })
    }

    /// The point on a line through `from`, before the eye, that is seen nearest to a place, at most `reach` away (world units). It goes one way
    /// along the unit direction while the place does along the line's picture, also beyond the vanishing point. A line that points at the eye
    /// moves with the hand: up is along its direction.
    pub fn on_line(&self, from: DVec3, direction: DVec3, place: [f64; 2], reach: f64) -> Option<DVec3> {
        let (axes, at) = (self.axes()?, self.place(from)?);
        let [_, sight] = self.ray(at)?;
        let by = [place[0] - at[0], place[1] - at[1]];
        let cosine = direction.dot(sight);
        // Depth, and height of the picture there; both change along the line in perspective.
        let depth = (from - self.eye).dot(axes.forward);
        let (height, recedes) = match self.projection {
            Projection::Perspective { .. } => (axes.pixel * depth, direction.dot(axes.forward) / depth),
            Projection::Orthographic { height } => (height, 0.0),
        };
        let along = if 1.0 - cosine * cosine > END_ON {
            // The place is at + along · step / (1 + along · recedes).
            let across = [direction.dot(axes.right), direction.dot(axes.up)];
            let step = [0, 1].map(|k: usize| across[k] / height - at[k] * recedes);
            let length = step[0].hypot(step[1]);
            let way = (by[0] * step[0] + by[1] * step[1]) / length;
            let left = length - way * recedes;
            if left > 0.0 { way / left } else { way.signum() * reach }
        } else {
            by[1] * height
        };
        // Not through the eye, in front of which the depth is a share of that of the point.
        let [low, high] = match (BEFORE_EYE - 1.0) / recedes {
            end if recedes > 0.0 => [end.max(-reach), reach],
            end if recedes < 0.0 => [-reach, end.min(reach)],
            _ => [-reach, reach],
        };
        Some(from + along.clamp(low, high) * direction)
    }

    /// The point at a place of the picture that is as deep as another point.
    pub fn beside(&self, point: DVec3, place: [f64; 2]) -> Option<DVec3> {
        let ([eye, ray], forward) = (self.ray(place)?, self.axes()?.forward);
        Some(eye + (point - eye).dot(forward) / ray.dot(forward) * ray)
    }

    /// The point of a ball that is seen at a place, on the side on which another point lies; of a place beside it, the nearest on its rim.
    pub fn on_ball(&self, centre: DVec3, near: DVec3, place: [f64; 2]) -> Option<DVec3> {
        let [eye, ray] = self.ray(place)?;
        let (radius, middle) = (near.distance(centre), eye + (centre - eye).dot(ray) * ray);
        let aside = middle - centre;
        let half = (radius * radius - aside.length_squared()).max(0.0).sqrt();
        let side = if (near - centre).dot(ray) < 0.0 { -half } else { half };
        Some(centre + radius * (aside + side * ray).try_normalize()?)
    }

    /// The view if it is sound, else the one before.
    fn or(self, before: View) -> View {
        let finite = [self.eye, self.target, self.up].iter().all(|v| v.is_finite());
        if finite && self.axes().is_some() { self } else { before }
    }

    /// About the target: `[to the right, up]`, radians; the scene follows the hand. The view's own axes turn with it, so no
    /// direction is special.
    pub fn orbited(self, [right, up]: [f64; 2]) -> View {
        let Some(axes) = self.axes() else { return self };
        let turn = DQuat::from_axis_angle(axes.up, -right) * DQuat::from_axis_angle(axes.right, up);
        let eye = self.target + turn * (self.eye - self.target);
        View { eye, up: turn * axes.up, ..self }.or(self)
    }

    /// Sideways, in heights of the picture: what lies at the target's depth follows the hand.
    pub fn panned(self, [right, up]: [f64; 2]) -> View {
        let Some(axes) = self.axes() else { return self };
        let step = -self.height() * (right * axes.right + up * axes.up);
        View { eye: self.eye + step, target: self.target + step, ..self }.or(self)
    }

    /// Nearer (`factor` > 1) or farther; what lies at the target's depth under `at` stays there.
    pub fn zoomed(self, factor: f64, [right, up]: [f64; 2]) -> View {
        let Some(axes) = self.axes() else { return self };
        if !(factor > 0.0 && factor.is_finite()) {
            return self;
        }
        let at = self.target + self.height() * (right * axes.right + up * axes.up);
        let target = at + (self.target - at) / factor;
        let view = match self.projection {
            Projection::Perspective { .. } => {
                View { eye: target - axes.forward * self.distance() / factor, target, ..self }
            }
            Projection::Orthographic { height } => {
                let projection = Projection::Orthographic { height: height / factor };
                View { eye: self.eye + (target - self.target), target, projection, ..self }
            }
        };
        // Where eye and target fall together in 64 bits there is no nearer.
        if view.distance() <= 1e-9 * view.target.length() { self } else { view.or(self) }
    }

    /// About the view direction, radians: the picture turns to the left.
    pub fn rolled(self, angle: f64) -> View {
        let Some(axes) = self.axes() else { return self };
        View { up: DQuat::from_axis_angle(axes.forward, angle) * axes.up, ..self }.or(self)
    }

    /// All of a box in a picture of that size, seen from the same side.
    pub fn home(self, bounds: [DVec3; 2], size: [u32; 2]) -> View {
        self.camera(size).fitted(&corners(bounds)).map_or(self, View::from)
    }

    /// Along an axis: the eye lies on its side of the target. `up`: what then points up.
    pub fn looking_along(self, axis: DVec3, up: DVec3) -> View {
        View { eye: self.target + axis.normalize_or_zero() * self.distance(), up, ..self }.or(self)
    }

    /// Turned so that a point is in the middle of the picture and orbited about; the eye moves along with it.
    pub fn centred(self, point: DVec3) -> View {
        let step = point - self.target;
        View { eye: self.eye + step, target: point, ..self }.or(self)
    }
}

impl From<Camera> for View {
    fn from(Camera { eye, target, up, projection, .. }: Camera) -> View {
        View { eye, target, up, projection }
    }
}

#[cfg(test)]
mod tests;
