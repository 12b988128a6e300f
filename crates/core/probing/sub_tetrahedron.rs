//! A part of a tetrahedron, cut by half-spaces.
//!
//! A piece is a tetrahedron within a tetrahedron: its share of the volume, and N numbers at each of its corners that
//! are linear within the whole (barycentric coordinates, values of fields). A cut keeps the part where a linear
//! function f is positive, as one to three pieces. With t = f_i / (f_i − f_j) the place of the cut on the edge from
//! i (inside) to j (outside), each new piece has a share that is a product of t and 1 − t, so that no digits are lost
//! by subtraction and the shares on both sides of a cut add up to 1.

/// A tetrahedron within a tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SubTetrahedron<const N: usize> {
    /// Its volume, as a share of the whole's.
    pub volume_fraction: f64,
    /// Values at the corners.
    pub corners: [[f64; N]; 4],
}

impl SubTetrahedron<4> {
    /// The whole, with barycentric coordinates.
    pub const WHOLE: SubTetrahedron<4> = SubTetrahedron {
        volume_fraction: 1.0,
        corners: [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
    };

    /// At the corners, the values of a linear function that has these values at the whole's corners.
    pub fn values(&self, of_whole: [f64; 4]) -> [f64; 4] {
        self.corners
            .map(|c| (c[0] * of_whole[0] + c[1] * of_whole[1]) + (c[2] * of_whole[2] + c[3] * of_whole[3]))
    }
}

impl<const N: usize> SubTetrahedron<N> {
    /// Hands the parts where f > 0 to `sink`; `f` are the values at the corners. A face on which f = 0 is no part.
    pub fn clip_to_level(&self, f: [f64; 4], mut sink: impl FnMut(SubTetrahedron<N>)) {
        // Inside corners first.
        let mut at = [0, 1, 2, 3];
        let mut inside = 0;
        for (k, &f) in f.iter().enumerate() {
            if f > 0.0 {
                at.swap(inside, k);
                inside += 1;
            }
        }
        let v = |k: usize| self.corners[at[k]];
        // The place of the cut between corners i (inside) and j (outside): the share of the way, what is left of it,
        // and what the point carries. Halves, since a difference of two huge numbers may leave the range.
        let between = |i: usize, j: usize| {
            let (fi, fj) = (0.5 * f[at[i]], 0.5 * f[at[j]]);
            let (t, rest) = (fi / (fi - fj), -fj / (fi - fj));
            let (a, b) = (v(i), v(j));
            (t, rest, std::array::from_fn::<f64, N, _>(|n| a[n] * rest + b[n] * t))
        };
        let mut give = |share: f64, corners: [[f64; N]; 4]| {
            if share > 0.0 {
                sink(SubTetrahedron { volume_fraction: self.volume_fraction * share, corners });
            }
        };
        match inside {
            0 => {}
            1 => {
                let ((t1, _, p1), (t2, _, p2), (t3, _, p3)) = (between(0, 1), between(0, 2), between(0, 3));
                give(t1 * t2 * t3, [v(0), p1, p2, p3]);
            }
            2 => {
                let ((t02, _, p02), (t03, _, p03)) = (between(0, 2), between(0, 3));
                let ((t12, r12, p12), (t13, r13, p13)) = (between(1, 2), between(1, 3));
                give(t02 * t03 * r13, [v(0), p02, p03, p13]);
                give(t02 * r12 * t13, [v(0), p02, p12, p13]);
                give(t12 * t13, [v(0), v(1), p12, p13]);
            }
            3 => {
                let ((t0, _, p0), (t1, r1, p1), (t2, r2, p2)) = (between(0, 3), between(1, 3), between(2, 3));
                give(t2, [v(0), v(1), v(2), p2]);
                give(t1 * r2, [v(0), v(1), p1, p2]);
                give(t0 * r1 * r2, [v(0), p0, p1, p2]);
            }
            _ => give(1.0, self.corners),
        }
    }
}

/// The distribution of a linear function over a tetrahedron.
#[derive(Debug, Clone, Copy)]
pub(super) struct Distribution {
    /// Values at the corners, rising.
    v: [f64; 4],
    /// 1 / (v_j − v_i) for (i, j) = (0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3).
    inverse: [f64; 6],
}

impl Distribution {
    /// That of the function with these values at the corners.
    pub fn new(mut v: [f64; 4]) -> Self {
        v.sort_unstable_by(f64::total_cmp);
        let inverse = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)].map(|(i, j)| 1.0 / (v[j] - v[i]));
        Distribution { v, inverse }
    }

    /// The share of the volume where the function is below `b`: the shares of [`SubTetrahedron::clip_to_level`], added up.
    pub fn below(&self, b: f64) -> f64 {
        let [v0, v1, v2, v3] = self.v;
        let [i01, i02, i03, i12, i13, i23] = self.inverse;
        if b <= v0 {
            0.0
        } else if b >= v3 {
            1.0
        } else if b <= v1 {
            let d = b - v0;
            (d * i01) * (d * i02) * (d * i03)
        } else if b <= v2 {
            let (t02, t03) = ((b - v0) * i02, (b - v0) * i03);
            let (t12, t13) = ((b - v1) * i12, (b - v1) * i13);
            let (r12, r13) = ((v2 - b) * i12, (v3 - b) * i13);
            t02 * t03 * r13 + t02 * r12 * t13 + t12 * t13
        } else {
            let d = v3 - b;
            1.0 - (d * i03) * (d * i13) * (d * i23)
        }
    }
}

/// Volume of a tetrahedron whose corners were multiplied by `scale`, which keeps it in the number range.
pub(super) fn scaled_volume(grid: &crate::grid::Grid, i: usize, scale: f64) -> f64 {
    let [a, b, c, d] = grid.corners(i);
    crate::grid::tetrahedron_volume([glam::DVec3::ZERO, (b - a) * scale, (c - a) * scale, (d - a) * scale])
}
