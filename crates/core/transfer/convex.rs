//! A region as a checked convex polygon, and how far points lie from its edges.

use super::region::Region;
use crate::arithmetic::difference_of_products;
use crate::{Error, Result};

/// A region whose corners were checked.
#[derive(Debug, Clone, PartialEq)]
pub enum Convex {
    /// Axis-parallel; limits may be infinite.
    Rectangle {
        /// Lower corner [s, g].
        low: [f64; 2],
        /// Upper corner.
        high: [f64; 2],
    },
    /// Corners counter-clockwise, finite.
    Polygon(Vec<[f64; 2]>),
}

impl Convex {
    /// Checks a region (at least three corners, convex, with an area) and makes it ready.
    pub fn new(region: &Region) -> Result<Convex> {
        let corners = &region.corners;
        if corners.iter().flatten().any(|c| c.is_nan()) {
            return Err(Error::usage("a region's corner is not a number").expected("finite corners [s, g]"));
        }
        if let Some(rectangle) = rectangle(corners) {
            return Ok(rectangle);
        }
        if corners.len() < 3 {
            return Err(Error::usage("a region has too few corners")
                .got(corners.len())
                .expected("a convex polygon of at least 3 corners"));
        }
        if corners.iter().flatten().any(|c| c.is_infinite()) {
            return Err(Error::usage("a region that is no rectangle has an infinite corner")
                .expected("finite corners [s, g]"));
        }
        // Every corner lies on one side of every edge; what is within rounding of an edge lies on it.
        let (mut left, mut right) = (false, false);
        for (i, from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let edge = [to[0] - from[0], to[1] - from[1]];
            for corner in corners {
                let offset = [corner[0] - from[0], corner[1] - from[1]];
                let side = difference_of_products(edge[0], offset[1], edge[1], offset[0]);
                let rounding = 1e-9 * ((edge[0] * offset[1]).abs() + (edge[1] * offset[0]).abs());
                left |= side > rounding;
                right |= side < -rounding;
            }
        }
        if (left, right) != (false, false) && !goes_once_around(corners) {
            return Err(Error::usage("a region's corners go around more than once")
                .expected("a convex polygon, corners in order"));
        }
        match (left, right) {
            (true, false) => Ok(Convex::Polygon(corners.clone())),
            (false, true) => Ok(Convex::Polygon(corners.iter().rev().copied().collect())),
            (false, false) => Err(Error::usage("a region has no area").expected("a convex polygon")),
            (true, true) => Err(Error::usage("a region is not convex").expected("a convex polygon")),
        }
    }

    /// True if all of a box of s and g lies inside, as far as rounding can say.
    pub fn holds(&self, [s, g]: &[[f64; 2]; 2]) -> bool {
        let corners = [[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]];
        corners.iter().all(|&corner| self.distances(corner, corner, |distance, _, _, _| distance >= 0.0))
    }

    /// Calls `f` with the signed distances of front and back from each edge, positive inside, with the edge's
    /// axis (2: neither) and level, until it returns false; tells whether it never did.
    #[inline]
    pub fn distances(
        &self,
        front: [f64; 2],
        back: [f64; 2],
        mut f: impl FnMut(f64, f64, u8, f64) -> bool,
    ) -> bool {
        match self {
            Convex::Rectangle { low, high } => (0..2).all(|i| {
                let axis = i as u8;
                f(front[i] - low[i], back[i] - low[i], axis, low[i])
                    && f(high[i] - front[i], high[i] - back[i], axis, high[i])
            }),
            Convex::Polygon(corners) => {
                let mut from = corners[corners.len() - 1];
                corners.iter().all(|&to| {
                    let edge = [to[0] - from[0], to[1] - from[1]];
                    let side = |v: [f64; 2]| {
                        difference_of_products(edge[0], v[1] - from[1], edge[1], v[0] - from[0])
                    };
                    let inside = f(side(front), side(back), 2, 0.0);
                    from = to;
                    inside
                })
            }
        }
    }
}

/// True if the directions of the edges turn once around: a star, or a polygon taken twice, turns more often.
fn goes_once_around(corners: &[[f64; 2]]) -> bool {
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    let edges: Vec<[f64; 2]> =
        pairs.map(|(a, b)| [b[0] - a[0], b[1] - a[1]]).filter(|edge| *edge != [0.0; 2]).collect();
    let turns = edges
        .iter()
        .zip(edges.iter().cycle().skip(1))
        .map(|(a, b)| difference_of_products(a[0], b[1], a[1], b[0]).atan2(a[0] * b[0] + a[1] * b[1]));
    (turns.sum::<f64>().abs() / std::f64::consts::TAU).round() == 1.0
}

/// The region as an axis-parallel rectangle, if it is one.
fn rectangle(corners: &[[f64; 2]]) -> Option<Convex> {
    let &[a, b, c, d] = corners else { return None };
    let along_s = a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0];
    let along_g = a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1];
    let low = [a[0].min(c[0]), a[1].min(c[1])];
    let high = [a[0].max(c[0]), a[1].max(c[1])];
    ((along_s || along_g) && low[0] < high[0] && low[1] < high[1]).then_some(Convex::Rectangle { low, high })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_region_that_is_none_is_refused() {
        let message =
            |corners: Vec<[f64; 2]>| Convex::new(&Region { corners }).expect_err("refused").to_string();
        assert!(message(vec![[0.0, 0.0], [1.0, 1.0]]).contains("too few corners"));
        assert!(message(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("no area"));
        let dart = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        assert!(message(dart).contains("not convex"));
        let triangle = [[0.0, 0.0], [2.0, 0.0], [1.0, 1e-3]];
        assert!(message([triangle, triangle].concat()).contains("more than once"));
        // Corners on an edge, or twice, are allowed; to and fro along an edge is not convex.
        let corners = vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 0.0], [1.0, 1e-3]];
        assert!(Convex::new(&Region { corners }).is_ok());
        let to_and_fro = vec![[0.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 1.0]];
        assert!(message(to_and_fro).contains("not convex"));
        assert!(message(vec![[f64::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]).contains("not a number"));
    }
}
