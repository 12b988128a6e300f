//! Clips: parts of space in which a volume is drawn. Rays are cut where they enter and leave them, so that the cut is exact whatever
//! the cells are.

use crate::arithmetic::unit_vector;
use crate::{Error, Result};
use glam::DVec3;

/// A part of space that is kept, or the rest of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clip {
    /// The part.
    pub shape: ClipShape,
    /// Keeps what is outside of it.
    pub invert: bool,
}

impl Clip {
    /// True if it keeps a point.
    pub fn keeps(&self, p: DVec3) -> bool {
        self.shape.contains(p) != self.invert
    }
}

/// A convex part of space, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum ClipShape {
    /// The half-space on the side of the plane to which the normal points.
    Plane {
        /// A point of the plane.
        origin: DVec3,
        /// Its normal, of any length above 0.
        normal: DVec3,
    },
    /// A box along the axes.
    Box {
        /// Lowest corner.
        low: DVec3,
        /// Highest corner.
        high: DVec3,
    },
    /// A ball.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// A cylinder with flat ends.
    Cylinder {
        /// Middle of one end.
        from: DVec3,
        /// Middle of the other.
        to: DVec3,
        /// Its radius.
        radius: f64,
    },
}

impl ClipShape {
    /// Checks its numbers.
    ///
    /// # Errors
    /// - numbers that are not finite; a plane without direction, a box without inside, a radius of 0 or less, a cylinder of no length.
    pub fn check(&self) -> Result<()> {
        let refuse = |what: &str, expected: &str| Err(Error::usage(what).expected(expected));
        let numbers = match *self {
            ClipShape::Plane { origin, normal } => [origin, normal],
            ClipShape::Box { low, high } => [low, high],
            ClipShape::Sphere { centre, radius } => [centre, DVec3::splat(radius)],
            ClipShape::Cylinder { from, to, radius } => [from + radius, to],
        };
        if numbers.iter().any(|v| !v.is_finite()) {
            return refuse("a clip has a number that is not finite", "finite numbers");
        }
        match *self {
            ClipShape::Plane { normal, .. } if normal == DVec3::ZERO => {
                refuse("the plane's normal has no direction", "a vector that is not zero")
            }
            ClipShape::Box { low, high } if !low.cmplt(high).all() => {
                refuse("the box has no inside", "a lowest corner below the highest on each axis")
            }
            ClipShape::Sphere { radius, .. } | ClipShape::Cylinder { radius, .. } if radius <= 0.0 => {
                refuse("the radius is out of range", "a number above 0")
            }
            ClipShape::Cylinder { from, to, .. } if from == to => {
                refuse("the cylinder has no length", "two points that differ")
            }
            _ => Ok(()),
        }
    }

    /// True if a point is inside.
    pub fn contains(&self, p: DVec3) -> bool {
        match *self {
            ClipShape::Plane { origin, normal } => (p - origin).dot(normal) >= 0.0,
            ClipShape::Box { low, high } => low.cmple(p).all() && p.cmple(high).all(),
            ClipShape::Sphere { centre, radius } => p.distance(centre) <= radius,
            ClipShape::Cylinder { from, to, radius } => {
                let along = (p - from).dot(to - from) / (to - from).length_squared();
                (0.0..=1.0).contains(&along) && p.distance(from + along * (to - from)) <= radius
            }
        }
    }

    /// The range of t in which origin + t · direction is inside; none where it nowhere is.
    pub fn inside(&self, origin: DVec3, direction: DVec3) -> Option<[f64; 2]> {
        let range = match *self {
            ClipShape::Plane { origin: on, normal } => {
                above((origin - on).dot(normal), direction.dot(normal))
            }
            ClipShape::Box { low, high } => {
                let all = [f64::NEG_INFINITY, f64::INFINITY];
                (0..3).fold(all, |range, axis| {
                    let (o, d) = (origin[axis], direction[axis]);
                    both(both(range, above(o - low[axis], d)), above(high[axis] - o, -d))
                })
            }
            ClipShape::Sphere { centre, radius } => within(origin - centre, direction, radius),
            ClipShape::Cylinder { from, to, radius } => {
                let axis = unit_vector(to - from);
                let (o, d) = (origin - from, direction);
                let across = |v: DVec3| v - axis * v.dot(axis);
                let between = above(o.dot(axis), d.dot(axis));
                let end = above((to - origin).dot(axis), -d.dot(axis));
                both(within(across(o), across(d), radius), both(between, end))
            }
        };
        (range[0] < range[1]).then_some(range)
    }
}

/// Range of t in which o + t d ≥ 0.
fn above(o: f64, d: f64) -> [f64; 2] {
    let t = -o / d;
    match d {
        d if d > 0.0 => [t, f64::INFINITY],
        d if d < 0.0 => [f64::NEG_INFINITY, t],
        _ if o >= 0.0 => [f64::NEG_INFINITY, f64::INFINITY],
        _ => EMPTY_RANGE,
    }
}

const EMPTY_RANGE: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn both(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].max(b[0]), a[1].min(b[1])]
}

/// Range of t in which |o + t d| ≤ radius.
fn within(o: DVec3, d: DVec3, radius: f64) -> [f64; 2] {
    let square = d.length_squared();
    if square == 0.0 {
        return if o.length() <= radius { [f64::NEG_INFINITY, f64::INFINITY] } else { EMPTY_RANGE };
    }
    // From the point nearest to the centre: no difference of large squares.
    let middle = -o.dot(d) / square;
    let nearest = o + middle * d;
    let half = (radius * radius - nearest.length_squared()) / square;
    if half > 0.0 { [middle - half.sqrt(), middle + half.sqrt()] } else { EMPTY_RANGE }
}

/// Memory for the parts of one ray after another.
#[derive(Debug, Default)]
pub struct KeptRanges {
    kept: Vec<[f64; 2]>,
    before: Vec<[f64; 2]>,
}

impl KeptRanges {
    /// The parts of a ray that every clip keeps, from t = `near` on: ranges of t, rising.
    pub fn find(&mut self, clips: &[Clip], origin: DVec3, direction: DVec3, near: f64) -> &[[f64; 2]] {
        let KeptRanges { kept, before } = self;
        kept.clear();
        kept.push([near, f64::INFINITY]);
        for clip in clips {
            let inside = clip.shape.inside(origin, direction);
            let parts = match (clip.invert, inside) {
                (false, range) => [range, None],
                (true, Some([from, to])) => [Some([f64::NEG_INFINITY, from]), Some([to, f64::INFINITY])],
                (true, None) => continue,
            };
            std::mem::swap(kept, before);
            kept.clear();
            for range in &*before {
                for part in parts.into_iter().flatten() {
                    let [from, to] = both(*range, part);
                    if from < to {
                        kept.push([from, to]);
                    }
                }
            }
        }
        kept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shapes() -> [ClipShape; 4] {
        [
            ClipShape::Plane { origin: DVec3::new(0.1, 0.0, 0.3), normal: DVec3::new(1.0, -2.0, 0.5) },
            ClipShape::Box { low: DVec3::new(-0.5, -0.2, 0.0), high: DVec3::new(0.4, 0.9, 0.5) },
            ClipShape::Sphere { centre: DVec3::new(0.2, 0.1, 0.3), radius: 0.6 },
            ClipShape::Cylinder {
                from: DVec3::new(-0.5, 0.2, 0.0),
                to: DVec3::new(0.5, 0.4, 0.6),
                radius: 0.3,
            },
        ]
    }

    /// Points of many rays are kept where the definition of every clip says so.
    #[test]
    fn rays_are_kept_where_their_points_are() {
        let shapes = shapes();
        for number in 0..400u32 {
            let turn = f64::from(number);
            let origin = DVec3::new((1.3 * turn).sin(), (0.7 * turn).cos(), (2.1 * turn).sin());
            let direction = DVec3::new((0.37 * turn).cos(), (0.91 * turn).sin(), (0.53 * turn).cos());
            let clips: Vec<Clip> = (0..4)
                .filter(|k| number >> k & 1 == 1)
                .map(|k| Clip { shape: shapes[k], invert: number >> (k + 4) & 1 == 1 })
                .collect();
            let mut ranges = KeptRanges::default();
            let kept = ranges.find(&clips, origin, direction, 0.0);
            for step in 0..300 {
                let t = 0.01 * f64::from(step) + 0.003;
                let p = origin + t * direction;
                let expected = clips.iter().all(|clip| clip.shape.contains(p) != clip.invert);
                let found = kept.iter().any(|[from, to]| (*from..=*to).contains(&t));
                assert_eq!(found, expected, "{clips:?} at {p}");
            }
        }
    }

    /// A ball of radius 1 seen from 1e8 off keeps its chord.
    #[test]
    fn a_far_ball_keeps_its_chord() {
        let shape = ClipShape::Sphere { centre: DVec3::ZERO, radius: 1.0 };
        let [from, to] = shape.inside(DVec3::new(0.0, 0.6, -1e8), DVec3::Z).expect("met");
        assert!((to - from - 1.6).abs() < 1e-7, "{}", to - from);
    }
}
