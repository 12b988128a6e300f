//! The convex hull of the values at a cell's four vertices: its distance from the origin, and whether it meets a region.

use super::region::Convex;

/// The values at a cell's vertices.
#[derive(Debug, Clone, Copy)]
pub struct Corners<'a> {
    /// The scalar.
    pub s: &'a [f64; 4],
    /// The gradient magnitude.
    pub g: &'a [f64; 4],
    /// The further fields in the order of [`super::TransferFunction::fields`]; empty if unknown: then a widget over fields counts as
    /// everywhere.
    pub fields: &'a [[f64; 4]],
}

/// Corners of a box of s and g.
pub fn box_corners(s: [f64; 2], g: [f64; 2]) -> ([f64; 4], [f64; 4]) {
    ([s[0], s[1], s[0], s[1]], [g[0], g[0], g[1], g[1]])
}

impl Corners<'_> {
    /// Least and greatest s.
    #[inline]
    pub fn s_range(&self) -> (f64, f64) {
        range(self.s)
    }

    /// Least and greatest g.
    #[inline]
    pub fn g_range(&self) -> (f64, f64) {
        range(self.g)
    }
}

/// Exact bounds are raised by this, so that rounding never makes them too low.
pub(super) const ROUNDING: f64 = 1e-12;

/// e^(−x²), not too low.
#[inline]
pub(super) fn gaussian(distance_squared: f64) -> f64 {
    (-distance_squared * (1.0 - ROUNDING)).exp()
}

/// Smallest and largest.
#[inline]
pub(super) fn range(values: &[f64; 4]) -> (f64, f64) {
    (
        values[0].min(values[1]).min(values[2].min(values[3])),
        values[0].max(values[1]).max(values[2].max(values[3])),
    )
}

const PAIRS: [(usize, usize); 6] = [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)];

#[inline]
fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// Square of the distance from the origin to the hull; 0 inside.
///
/// The hull is the union of its four triangles; outside it the nearest point lies on one of the six edges
/// and diagonals.
pub fn distance_squared_from_origin(points: &[[f64; 2]; 4]) -> f64 {
    let turn: [f64; 6] = PAIRS.map(|(i, j)| cross(points[i], points[j]));
    // Orientation of each triangle as seen from the origin: (i, j), (j, k), (k, i).
    let [t01, t02, t03, t12, t13, t23] = turn;
    let around =
        |a: f64, b: f64, c: f64| (a >= 0.0 && b >= 0.0 && c >= 0.0) || (a <= 0.0 && b <= 0.0 && c <= 0.0);
    // A triangle that is flat on a line through the origin passes this test without holding the origin; the
    // bound is then too high by what a degenerate cell is worth, never too low.
    let is_inside =
        around(t01, t12, -t02) || around(t01, t13, -t03) || around(t02, t23, -t03) || around(t12, t23, -t13);
    // Where all is flat the edges decide.
    if is_inside && turn.iter().any(|&t| t != 0.0) {
        return 0.0;
    }
    let mut least = f64::INFINITY;
    for (&(i, j), turn) in PAIRS.iter().zip(turn) {
        let (p, q) = (points[i], points[j]);
        let e = [q[0] - p[0], q[1] - p[1]];
        let before = -(p[0] * e[0] + p[1] * e[1]);
        let length = e[0] * e[0] + e[1] * e[1];
        let distance = if before <= 0.0 {
            p[0] * p[0] + p[1] * p[1]
        } else if before >= length {
            q[0] * q[0] + q[1] * q[1]
        } else {
            turn * turn / length
        };
        least = least.min(distance);
    }
    least
}

/// True if the hull of the points (s, g) can meet the region: false only where a line separates them.
pub fn meets(region: &Convex, s: &[f64; 4], g: &[f64; 4]) -> bool {
    match region {
        Convex::Rectangle { low, high } => {
            let (s_low, s_high) = range(s);
            let (g_low, g_high) = range(g);
            if s_high < low[0] || s_low > high[0] || g_high < low[1] || g_low > high[1] {
                return false;
            }
            if low[0] <= s_low && s_high <= high[0] && low[1] <= g_low && g_high <= high[1] {
                return true;
            }
            // What of the rectangle lies in the points' box: finite corners.
            let (a, b) = (low[0].max(s_low), high[0].min(s_high));
            let (c, d) = (low[1].max(g_low), high[1].min(g_high));
            !separated(s, g, &[[a, c], [b, c], [b, d], [a, d]])
        }
        Convex::Polygon(corners) => {
            let mut from = corners[corners.len() - 1];
            for &to in corners {
                let edge = [to[0] - from[0], to[1] - from[1]];
                let outside = (0..4).all(|i| {
                    let offset = [s[i] - from[0], g[i] - from[1]];
                    cross(edge, offset) < -slack(edge, offset)
                });
                if outside {
                    return false;
                }
                from = to;
            }
            !separated(s, g, corners)
        }
    }
}

/// Rounding error bound of a cross product.
#[inline]
fn slack(a: [f64; 2], b: [f64; 2]) -> f64 {
    1e-12 * ((a[0] * b[1]).abs() + (a[1] * b[0]).abs())
}

/// True if a line through two of the points has the polygon on one side and all points on the other.
fn separated(s: &[f64; 4], g: &[f64; 4], corners: &[[f64; 2]]) -> bool {
    PAIRS.iter().any(|&(i, j)| {
        let edge = [s[j] - s[i], g[j] - g[i]];
        let side = |p: [f64; 2]| {
            let offset = [p[0] - s[i], p[1] - g[i]];
            let turn = cross(edge, offset);
            if turn.abs() <= slack(edge, offset) { 0.0 } else { turn }
        };
        let (mut most, mut least) = (f64::NEG_INFINITY, f64::INFINITY);
        for k in 0..4 {
            let turn = side([s[k], g[k]]);
            most = most.max(turn);
            least = least.min(turn);
        }
        (most <= 0.0 && corners.iter().all(|&c| side(c) > 0.0))
            || (least >= 0.0 && corners.iter().all(|&c| side(c) < 0.0))
    })
}
