//! Crossings of a ray with tetrahedra and triangles, by exact signs of edge functions.

use glam::DVec3;
use voltet_core::arithmetic::edge_sign;

/// A ray through the picture: positions on it are z·(x, y, 1) (perspective) or (x, y, z) (orthographic).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// To the right: slope (perspective) or offset (orthographic, internal units).
    pub x: f64,
    /// Upward: the same.
    pub y: f64,
    /// True if x and y are slopes.
    pub perspective: bool,
}

impl Ray {
    /// Euclidean length on the ray per unit of z.
    pub fn stretch(&self) -> f64 {
        if self.perspective { (1.0 + self.x * self.x + self.y * self.y).sqrt() } else { 1.0 }
    }

    /// A point (right, up, forward) as seen from the ray.
    fn shear(&self, p: [f64; 3]) -> [f64; 3] {
        let z = if self.perspective { p[2] } else { 1.0 };
        [p[0] - self.x * z, p[1] - self.y * z, p[2]]
    }
}

/// The part of a ray inside one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing {
    /// Number of the tetrahedron.
    pub cell: u32,
    /// z of entry and exit, internal units, entry < exit.
    pub depth: [f64; 2],
    /// Weights of the cell's four vertices at entry and exit.
    pub weights: [[f64; 4]; 2],
}

impl Crossing {
    /// The parts before and behind a depth within.
    pub(super) fn cut(self, depth: f64) -> [Crossing; 2] {
        let share = (depth - self.depth[0]) / (self.depth[1] - self.depth[0]);
        let [front, back] = self.weights;
        let at = std::array::from_fn(|k| front[k] * (1.0 - share) + back[k] * share);
        [
            Crossing { depth: [self.depth[0], depth], weights: [front, at], ..self },
            Crossing { depth: [depth, self.depth[1]], weights: [at, back], ..self },
        ]
    }
}

/// The crossing of the tetrahedron with the given corners (right, up, forward), from z = `near` on.
pub(super) fn cross(ray: &Ray, cell: u32, corners: &[[f64; 3]; 4], near: f64) -> Option<Crossing> {
    let p = corners.map(|c| ray.shear(c));
    // Edge functions of the six edges, each from the corner of lower to the one of higher number.
    let mut sign = [[0i8; 4]; 4];
    for a in 0..4 {
        for b in a + 1..4 {
            sign[a][b] = edge_sign(p[a], p[b]);
            sign[b][a] = -sign[a][b];
        }
    }
    let mut hits = [(0.0, [0.0; 4]); 2];
    let mut count = 0;
    for [a, b, c] in [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]] {
        let inside = sign[a][b] != 0 && sign[a][b] == sign[b][c] && sign[b][c] == sign[c][a];
        if inside && count < 2 {
            let parts = [edge(p[b], p[c]), edge(p[c], p[a]), edge(p[a], p[b])];
            let sum = parts[0] + parts[1] + parts[2];
            let mut weights = [0.0; 4];
            for (corner, part) in [a, b, c].into_iter().zip(parts) {
                weights[corner] = part / sum;
            }
            hits[count] = ((0..4).map(|k| weights[k] * p[k][2]).sum(), weights);
            count += 1;
        }
    }
    if count < 2 {
        return None;
    }
    let [front, back] = if hits[0].0 <= hits[1].0 { hits } else { [hits[1], hits[0]] };
    let mut crossing = Crossing { cell, depth: [front.0, back.0], weights: [front.1, back.1] };
    if front.0 < near && back.0 > near {
        [_, crossing] = crossing.cut(near);
    }
    let [entry, exit] = crossing.depth;
    (entry >= near && exit > entry).then_some(crossing)
}

/// A tetrahedron by its faces: crossings by planes in plain 64 bits, many times as fast as [`cross`]. A ray in a shared face may be given to
/// both cells or none, over a length of rounding.
pub(super) struct FacePlanes {
    /// For the face opposite each corner its inward normal, and the offset c with n · p + c = 0 on the face and 1 at the corner. So n · p + c is
    /// the corner's weight.
    faces: [[f64; 4]; 4],
}

impl FacePlanes {
    /// Planes of a tetrahedron with the given corners (right, up, forward); `None` for a flat one, in which no ray has a length.
    pub fn new(corners: &[[f64; 3]; 4]) -> Option<FacePlanes> {
        let points = corners.map(DVec3::from);
        let face = |corner: usize| {
            let [a, b, c] = [1, 2, 3].map(|k| points[(corner + k) % 4]);
            let normal = (b - a).cross(c - a);
            let normal = normal / normal.dot(points[corner] - a);
            normal.is_finite().then(|| [normal.x, normal.y, normal.z, -normal.dot(a)])
        };
        Some(FacePlanes { faces: [face(0)?, face(1)?, face(2)?, face(3)?] })
    }

    /// The crossing from z = `near` on.
    pub fn cross(&self, ray: &Ray, cell: u32, near: f64) -> Option<Crossing> {
        // Each weight along the ray: value at z = 0, and slope.
        let lines = self.faces.map(|[x, y, z, offset]| {
            let across = x * ray.x + y * ray.y;
            if ray.perspective { [offset, across + z] } else { [across + offset, z] }
        });
        let (mut entry, mut exit) = (near, f64::INFINITY);
        for [value, slope] in lines {
            let zero = -value / slope;
            if slope > 0.0 {
                entry = entry.max(zero);
            } else if slope < 0.0 {
                exit = exit.min(zero);
            } else if value < 0.0 {
                return None;
            }
        }
        let weights = |z: f64| lines.map(|[value, slope]| (value + z * slope).max(0.0));
        (entry < exit && exit < f64::INFINITY).then(|| Crossing {
            cell,
            depth: [entry, exit],
            weights: [weights(entry), weights(exit)],
        })
    }
}

/// Twice the area of (origin, a, b), accurate to the last digits (Kahan's difference of products).
fn edge(a: [f64; 3], b: [f64; 3]) -> f64 {
    let (p, q) = (a[0] * b[1], a[1] * b[0]);
    (p - q) + (a[0].mul_add(b[1], -p) - a[1].mul_add(b[0], -q))
}

/// z and weights where a ray crosses a triangle (right, up, forward), as a face of a cell.
pub(super) fn cross_triangle(ray: &Ray, corners: &[[f64; 3]; 3]) -> Option<(f64, [f64; 3])> {
    let p = corners.map(|c| ray.shear(c));
    let signs = [edge_sign(p[1], p[2]), edge_sign(p[2], p[0]), edge_sign(p[0], p[1])];
    if signs[0] == 0 || signs[0] != signs[1] || signs[1] != signs[2] {
        return None;
    }
    let parts = [edge(p[1], p[2]), edge(p[2], p[0]), edge(p[0], p[1])];
    let weights = parts.map(|part| part / parts.iter().sum::<f64>());
    Some(((0..3).map(|k| weights[k] * p[k][2]).sum(), weights))
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::grid::generate::Random;

    const UNIT: [[f64; 3]; 4] = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 0.0, 2.0]];

    fn along(x: f64, y: f64) -> Ray {
        Ray { x, y, perspective: false }
    }

    #[test]
    fn unit_tetrahedron() {
        let hit = cross(&along(0.25, 0.25), 7, &UNIT, 0.0).expect("hits");
        assert_eq!((hit.cell, hit.depth), (7, [1.0, 1.5]));
        assert_eq!(hit.weights, [[0.5, 0.25, 0.25, 0.0], [0.0, 0.25, 0.25, 0.5]]);
        assert!(cross(&along(0.75, 0.75), 7, &UNIT, 0.0).is_none());
        let clipped = cross(&along(0.25, 0.25), 7, &UNIT, 1.25).expect("hits");
        assert_eq!((clipped.depth, clipped.weights[0]), ([1.25, 1.5], [0.25, 0.25, 0.25, 0.25]));
        assert!(cross(&along(0.25, 0.25), 7, &UNIT, 1.5).is_none());
    }

    /// Six tetrahedra around the diagonal of a cube, seen along an axis by rays through its corners, edges,
    /// face diagonals and inside: every ray that touches the half-open square crosses length 1 in all.
    #[test]
    fn rays_in_shared_faces_are_covered_once() {
        let corner = |bits: usize| [0, 1, 2].map(|k| (bits >> k & 1) as f64);
        let paths = [[1, 3], [1, 5], [2, 3], [2, 6], [4, 5], [4, 6]];
        let mut lengths = Vec::new();
        for j in 0..=4 {
            for i in 0..=4 {
                let ray = along(f64::from(i) / 4.0, f64::from(j) / 4.0);
                let length: f64 = paths
                    .iter()
                    .filter_map(|p| cross(&ray, 0, &[corner(0), corner(p[0]), corner(p[1]), corner(7)], 0.0))
                    .map(|c| c.depth[1] - c.depth[0])
                    .sum();
                lengths.push(length);
            }
        }
        for (k, length) in lengths.iter().enumerate() {
            // The ray is moved to larger x, then y: the upper rims of the square do not belong to it.
            let expected = f64::from(u8::from(k % 5 < 4 && k / 5 < 4));
            assert_eq!(*length, expected, "ray {}, {}", k % 5, k / 5);
        }
    }

    /// Planes find what signs of edge functions find.
    #[test]
    fn face_planes_find_the_crossings_of_exact_signs() {
        let mut random = Random(7);
        let mut hit_count = 0;
        for _ in 0..20_000 {
            let corners = [0; 4].map(|_| [0; 3].map(|_| 2.0 * random.next() - 0.8));
            let ray = Ray { x: random.next(), y: random.next(), perspective: random.next() < 0.5 };
            let planes = FacePlanes::new(&corners).expect("is not flat");
            let (found, exact) = (planes.cross(&ray, 3, 0.1), cross(&ray, 3, &corners, 0.1));
            // A ray may graze a cell by a rounding.
            let length = |crossing: Option<Crossing>| crossing.map_or(0.0, |c| c.depth[1] - c.depth[0]);
            if length(found).max(length(exact)) < 1e-6 {
                continue;
            }
            let (found, exact) = (found.expect("hits"), exact.expect("hits"));
            hit_count += 1;
            let numbers = |c: Crossing| c.depth.into_iter().chain(c.weights.into_iter().flatten());
            for (a, b) in numbers(found).zip(numbers(exact)) {
                // Roundings of a normal of a thin cell, times its height's inverse.
                assert!((a - b).abs() < 1e-8, "{found:?} {exact:?}");
            }
        }
        assert!(hit_count > 500, "{hit_count}");
        assert!(FacePlanes::new(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]]).is_none());
    }

    /// A cell behind the eye is not hit, one around it from the eye on: a line has two sides, a ray one.
    #[test]
    fn nothing_behind_the_eye() {
        let behind = UNIT.map(|p| [p[0] - 0.2, p[1] - 0.2, p[2] - 5.0]);
        let ray = Ray { x: 0.0, y: 0.0, perspective: true };
        assert!(cross(&ray, 0, &behind, 0.0).is_none());
        let around = UNIT.map(|p| [p[0] - 0.2, p[1] - 0.2, p[2] - 1.25]);
        let hit = cross(&ray, 0, &around, 0.0).expect("hits");
        assert_eq!(hit.depth[0], 0.0);
    }
}
