//! Rays through the pixels of a picture, and their intersections with triangles.
//!
//! Symbols: a point is (X w, Y w, w), where (X, Y) is its place in pixels, whole numbers at the rays, and w its depth; 1 for
//! parallel rays. A ray crosses a triangle where the planes through the eye and each of its edges have it on one side. Triangles
//! that share an edge have the same numbers for it but for their sign, and where rounding could turn these, the reference's
//! rule decides; so a ray between triangles meets one of them.

use crate::Result;
use crate::arithmetic::edge_sign;
use crate::camera::{Camera, Projection};
use glam::{DVec2, DVec3};
use std::ops::Range;

/// The rounding of the side of an edge that a ray is on, as a share of the products that are summed.
const ROUNDING: f64 = 1e-14;

/// The rays through one sample of every pixel.
pub(super) struct Rays {
    eye: DVec3,
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    is_perspective: bool,
    /// Side of a pixel: at depth 1 in perspective, else in world units.
    pixel: f64,
    /// The pixel that the view axis passes through.
    axis: DVec2,
    /// Depth of the near plane: nothing nearer is seen.
    pub near: f64,
    /// Width and height of the picture.
    pub size: [u32; 2],
}

impl Rays {
    /// Rays of each sample of a camera's pixels. Errors: a camera out of range.
    pub fn per_sample(camera: &Camera) -> Result<Vec<Rays>> {
        camera.check_picture()?;
        let frame = camera.frame()?;
        let [width, height] = camera.size.map(f64::from);
        let rays = |offset: [f64; 2]| Rays {
            eye: camera.eye,
            right: frame.right,
            down: -frame.up,
            forward: frame.forward,
            is_perspective: matches!(camera.projection, Projection::Perspective { .. }),
            pixel: frame.pixel,
            axis: DVec2::new(0.5 * width - 0.5 - offset[0], 0.5 * height - 0.5 - offset[1]),
            near: camera.near,
            size: camera.size,
        };
        Ok(camera.sample_offsets().into_iter().map(rays).collect())
    }

    /// The rows of the picture in bands that are looked at together.
    pub fn bands(&self) -> Vec<Range<u32>> {
        const ROWS: u32 = 16;
        let height = self.size[1];
        (0..height).step_by(ROWS as usize).map(|y| y..(y + ROWS).min(height)).collect()
    }

    fn pixel_position(&self, point: DVec3) -> DVec3 {
        let from_eye = point - self.eye;
        let across = DVec2::new(from_eye.dot(self.right), from_eye.dot(self.down)) / self.pixel;
        let w = if self.is_perspective { from_eye.dot(self.forward) } else { 1.0 };
        (across + w * self.axis).extend(w)
    }

    /// Intersections of the rays with the plane of a triangle.
    pub fn plane(&self, [a, b, c]: [DVec3; 3]) -> Plane {
        let normal = (b - a).cross(c - a);
        let [right, down] = [self.right, self.down].map(|v| normal.dot(v) * self.pixel);
        let (forward, height) = (normal.dot(self.forward), normal.dot(a - self.eye));
        let slope = right * self.axis.x + down * self.axis.y;
        match self.is_perspective {
            true => {
                Plane { above: DVec3::new(0.0, 0.0, height), below: DVec3::new(right, down, forward - slope) }
            }
            false => Plane {
                above: DVec3::new(-right, -down, height + slope),
                below: DVec3::new(0.0, 0.0, forward),
            },
        }
    }

    /// True if something at this depth is seen.
    pub fn is_visible_depth(&self, depth: f64) -> bool {
        depth > 0.0 && depth >= self.near
    }

    /// The pixels around corners, as ranges of columns and rows; `None` where none of them lies before the eye, or none in the
    /// picture.
    pub fn around<const N: usize>(&self, corners: [DVec3; N]) -> Option<[Range<u32>; 2]> {
        let places = corners.map(|corner| self.pixel_position(corner));
        let most = places.iter().fold(0.0, |most: f64, place| most.max(place.z));
        // Nearer, places leave the numbers' range.
        let least = 1e-9 * most;
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut add = |place: DVec3| {
            let seen = place.truncate() / place.z;
            (low, high) = (low.min(seen), high.max(seen));
        };
        for (i, &a) in places.iter().enumerate() {
            if a.z > least {
                add(a);
            }
            for &b in &places[i + 1..] {
                if (a.z > least) != (b.z > least) {
                    let share = (least - a.z) / (b.z - a.z);
                    add((a + share * (b - a)).truncate().extend(least));
                }
            }
        }
        // A little more: places are rounded.
        let range = |low: f64, high: f64, count: u32| {
            let within = |x: f64| x.clamp(0.0, f64::from(count)) as u32;
            let range = within((low - 1e-6).ceil())..within((high + 1e-6).floor() + 1.0);
            (!range.is_empty()).then_some(range)
        };
        Some([range(low.x, high.x, self.size[0])?, range(low.y, high.y, self.size[1])?])
    }

    /// True if any ray crosses a triangle that is seen.
    pub fn meet(&self, corners: [DVec3; 3]) -> bool {
        let Some(triangle) = self.triangle(corners) else { return false };
        let mut is_met = false;
        triangle
            .each(triangle.rows.clone(), |pixel, _| is_met |= self.is_visible_depth(triangle.depth(pixel)));
        is_met
    }

    /// A triangle as the rays cross it; `None` where none of them does.
    pub fn triangle(&self, corners: [DVec3; 3]) -> Option<Triangle> {
        let [columns, rows] = self.around(corners)?;
        let depths = corners.map(|corner| (corner - self.eye).dot(self.forward));
        let places = corners.map(|corner| self.pixel_position(corner));
        let [width, height] = self.size.map(f64::from);
        let edge = |i: usize| {
            let (a, b) = (places[i], places[(i + 1) % 3]);
            let [p, q] = [a, b].map(DVec3::abs);
            let sum = DVec3::new(p.y * q.z + p.z * q.y, p.z * q.x + p.x * q.z, p.x * q.y + p.y * q.x);
            let rounding = ROUNDING * sum.dot(DVec3::new(width, height, 1.0));
            Edge { normal: a.cross(b), rounding, ends: [a, b] }
        };
        Some(Triangle {
            edges: [edge(0), edge(1), edge(2)],
            plane: self.plane(corners),
            depths: [depths[0].min(depths[1]).min(depths[2]), depths[0].max(depths[1]).max(depths[2])],
            columns,
            rows,
        })
    }
}

/// The depths at which rays meet a plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plane {
    above: DVec3,
    below: DVec3,
}

impl Plane {
    /// The depth, along the view axis, at a pixel; not finite where the ray does not meet the plane.
    #[inline]
    pub fn depth(&self, [x, y]: [u32; 2]) -> f64 {
        let at = DVec3::new(f64::from(x), f64::from(y), 1.0);
        self.above.dot(at) / self.below.dot(at)
    }

    /// Positive where depth grows towards the side of the plane that its normal points to, along the ray of a pixel.
    #[inline]
    pub fn turn(&self, [x, y]: [u32; 2]) -> f64 {
        self.below.dot(DVec3::new(f64::from(x), f64::from(y), 1.0))
    }
}

/// A triangle as rays cross it.
pub(super) struct Triangle {
    edges: [Edge; 3],
    plane: Plane,
    /// The least and the greatest depth.
    depths: [f64; 2],
    columns: Range<u32>,
    /// The rows of pixels that may cross it.
    pub rows: Range<u32>,
}

/// The plane through the eye and an edge.
struct Edge {
    normal: DVec3,
    /// Rays as near to it may lie on either side, for rounding.
    rounding: f64,
    ends: [DVec3; 2],
}

impl Triangle {
    /// The depth at which a pixel's ray crosses it.
    pub fn depth(&self, pixel: [u32; 2]) -> f64 {
        // Seen as a line it may be met anywhere.
        self.plane.depth(pixel).max(self.depths[0]).min(self.depths[1])
    }

    /// Calls `take` with every pixel of these rows whose ray crosses the triangle, and whether to the side that its normal
    /// points to.
    pub fn each(&self, rows: Range<u32>, mut take: impl FnMut([u32; 2], bool)) {
        for y in self.rows.start.max(rows.start)..self.rows.end.min(rows.end) {
            let along = self.edges.each_ref().map(|edge| edge.normal.y * f64::from(y) + edge.normal.z);
            for x in self.columns.clone() {
                let side = |i: usize| {
                    let edge = &self.edges[i];
                    let value = edge.normal.x * f64::from(x) + along[i];
                    if value.abs() > edge.rounding { value } else { f64::from(edge.exact_side([x, y])) }
                };
                let sides = [side(0), side(1), side(2)];
                if sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0) {
                    take([x, y], sides[0] > 0.0);
                }
            }
        }
    }
}

impl Edge {
    /// The side, by the exact sign for ends that are rounded as seen from the ray: once for all edges that meet in one, so that
    /// the faces around a point are met as if it were a little beside the ray.
    #[cold]
    fn exact_side(&self, [x, y]: [u32; 2]) -> i8 {
        let [a, b] = self.ends.map(|end| [end.x - f64::from(x) * end.z, end.y - f64::from(y) * end.z, end.z]);
        edge_sign(a, b)
    }
}
