//! Regions of the (s, g) plane: their half-planes, checked convex polygons, slabs, and the distance up to which a widget counts.

use super::axis::AxisScale;
use crate::arithmetic::difference_of_products;
use crate::{Error, Result};

/// A convex polygon in the (s, g) plane, corners in either orientation, at least three.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    /// Corners [s, g].
    pub corners: Vec<[f64; 2]>,
}

/// The points v of the (s, g) plane with normal · (v − corner) ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfPlane {
    /// Points inwards; of any length.
    pub normal: [f64; 2],
    /// A point of its edge; 0 along an axis that the normal has no part in.
    pub corner: [f64; 2],
}

impl Region {
    /// A rectangle; infinite limits (an axis that was not limited) are allowed.
    pub fn rectangle(s: [f64; 2], g: [f64; 2]) -> Self {
        Region { corners: vec![[s[0], g[0]], [s[1], g[0]], [s[1], g[1]], [s[0], g[1]]] }
    }

    /// True if it is a rectangle along the axes.
    pub fn is_rectangle(&self) -> bool {
        let [a, b, c, d] = *self.corners else { return false };
        let along_s = a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0];
        let along_g = a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1];
        along_s || along_g
    }

    /// False for a strip that is limited in s only.
    pub fn depends_on_g(&self) -> bool {
        self.corners.iter().any(|c| c[1].is_finite())
    }

    /// True if a place lies within; the boundary belongs to it.
    pub fn holds(&self, v: [f64; 2]) -> bool {
        self.half_planes().iter().all(|plane| {
            let part = |k: usize| plane.normal[k] * (v[k] - plane.corner[k]);
            part(0) + part(1) >= 0.0
        })
    }

    /// [low, high] along an axis (0: s, 1: g).
    pub fn limits(&self, axis: usize) -> [f64; 2] {
        let wider = |[low, high]: [f64; 2], c: &[f64; 2]| [low.min(c[axis]), high.max(c[axis])];
        self.corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], wider)
    }

    /// The half-planes that it is the intersection of; a rectangle with open sides has fewer than four.
    pub fn half_planes(&self) -> Vec<HalfPlane> {
        if self.corners.iter().flatten().any(|x| x.is_infinite()) {
            return self.open_half_planes();
        }
        let corners = &self.corners;
        // Differences from the first corner, so that an offset of all of them costs no digits.
        let from_first = |c: [f64; 2]| [c[0] - corners[0][0], c[1] - corners[0][1]];
        let pairs = || corners.iter().zip(corners.iter().cycle().skip(1));
        let turn: f64 = pairs()
            .map(|(a, b)| {
                let (a, b) = (from_first(*a), from_first(*b));
                a[0] * b[1] - a[1] * b[0]
            })
            .sum();
        let sign = if turn >= 0.0 { 1.0 } else { -1.0 };
        let edge = |(a, b): (&[f64; 2], &[f64; 2])| HalfPlane {
            normal: [sign * (a[1] - b[1]), sign * (b[0] - a[0])],
            corner: *a,
        };
        pairs().map(edge).filter(|edge| edge.normal != [0.0; 2]).collect()
    }

    /// Half-planes of a rectangle with sides at infinity.
    fn open_half_planes(&self) -> Vec<HalfPlane> {
        let mut found = Vec::new();
        for axis in 0..2 {
            let [low, high] = self.limits(axis);
            for (sign, limit) in [(1.0, low), (-1.0, high)] {
                if limit.is_finite() {
                    let along = |value: f64| if axis == 0 { [value, 0.0] } else { [0.0, value] };
                    found.push(HalfPlane { normal: along(sign), corner: along(limit) });
                }
            }
        }
        found
    }
}

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
        if region.is_rectangle() {
            let limits = [0, 1].map(|axis| region.limits(axis));
            let [low, high] = [0, 1].map(|end| limits.map(|axis| axis[end]));
            return match low[0] < high[0] && low[1] < high[1] {
                true => Ok(Convex::Rectangle { low, high }),
                false => Err(without_area()),
            };
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
            (false, false) => Err(without_area()),
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

fn without_area() -> Error {
    Error::usage("a region has no area").expected("a convex polygon")
}

/// The points v = (s, g) with low ≤ normal · v ≤ high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Normal, of any length but 0.
    pub normal: [f64; 2],
    /// −∞ where there is no limit.
    pub low: f64,
    /// ∞ where there is no limit.
    pub high: f64,
}

/// Room for the rounding of stored values and of the slabs themselves, in units of a value's span: 32 bits leave 1e-7.
const SLACK: f64 = 1e-6;

impl Slab {
    /// Slab of the values at its positions; `None` aslant to a curved axis, where it is none.
    pub fn of_values(&self, axes: &[AxisScale; 2]) -> Option<Slab> {
        let Slab { normal, low, high } = *self;
        let is_curved = |axis: usize| normal[axis] != 0.0 && axes[axis].is_curved();
        let axis = match [is_curved(0), is_curved(1)] {
            [false, false] => return Some(*self),
            [true, false] if normal[1] == 0.0 => 0,
            [false, true] if normal[0] == 0.0 => 1,
            _ => return None,
        };
        let ends = [low, high].map(|end| axes[axis].value(end / normal[axis]));
        let mut across = [0.0; 2];
        across[axis] = 1.0;
        Some(Slab { normal: across, low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) })
    }

    /// Slab over values stored in 32 bits, value = offset + scale × stored: [a, b, low, high] with the larger of |a| and
    /// |b| 1, widened by what rounding can do. `axes`: offset and scale of s and g.
    pub fn stored(&self, axes: [[f64; 2]; 2]) -> [f32; 4] {
        let Slab { normal, low, high } = self;
        let [a, b] = [0, 1].map(|k| normal[k] * axes[k][1]);
        let largest = a.abs().max(b.abs());
        if largest == 0.0 || !largest.is_finite() {
            return [0.0, 0.0, -1.0, 1.0];
        }
        let moved = |k: usize| if normal[k] == 0.0 { 0.0 } else { normal[k] * axes[k][0] };
        let offset = moved(0) + moved(1);
        // What cancels here lost digits of the offset: they widen the slab.
        let slack = SLACK + 4.0 * f64::EPSILON * (moved(0).abs() + moved(1).abs()) / largest;
        let bound = |x: f64, sign: f64| {
            let x = (x - offset) / largest + sign * slack;
            (x + sign * SLACK * x.abs()).clamp(-1e30, 1e30) as f32
        };
        [(a / largest) as f32, (b / largest) as f32, bound(*low, -1.0), bound(*high, 1.0)]
    }
}

/// Squared distance from a widget's centre, in widths, at which a profile exp(−r²) no longer counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SupportRadius {
    /// It counts at no distance.
    Nowhere,
    /// This is r².
    Within(f64),
    /// It counts at any distance.
    Everywhere,
}

impl SupportRadius {
    /// `ratio`: the depth of the profile's peak by the least depth that counts. `cutoff`: the constant-emitter's.
    pub(super) fn new(ratio: f64, cutoff: Option<f64>) -> SupportRadius {
        let absorbs = if ratio > 1.0 { ratio.ln() } else { 0.0 };
        match cutoff {
            _ if ratio <= 0.0 => SupportRadius::Nowhere,
            Some(cutoff) if cutoff <= 0.0 => SupportRadius::Everywhere,
            Some(cutoff) => SupportRadius::Within(absorbs.max(-cutoff.ln())),
            None if ratio <= 1.0 => SupportRadius::Nowhere,
            None => SupportRadius::Within(absorbs),
        }
    }

    /// The lists of a support without slabs of its own.
    pub(in crate::transfer) fn everywhere(self) -> Vec<Vec<Slab>> {
        self.within(|_| Vec::new())
    }

    /// One list, of the slabs that hold what lies within a distance.
    pub(in crate::transfer) fn within(self, slabs: impl Fn(f64) -> Vec<Slab>) -> Vec<Vec<Slab>> {
        match self {
            SupportRadius::Nowhere => Vec::new(),
            SupportRadius::Everywhere => vec![Vec::new()],
            SupportRadius::Within(square) => vec![slabs(square.sqrt())],
        }
    }
}

#[cfg(test)]
mod region_tests {
    use super::*;

    #[test]
    fn half_planes_hold_the_region_whichever_way_its_corners_turn() {
        let corners = vec![[1e8, 2.0], [1e8 + 2.0, 2.0], [1e8 + 1.0, 5.0]];
        let reversed = corners.iter().rev().copied().collect();
        for region in [Region { corners }, Region { corners: reversed }] {
            assert!(region.holds([1e8 + 1.0, 3.0]) && region.holds([1e8, 2.0]));
            assert!(!region.holds([1e8 + 1.0, 1.9]) && !region.holds([1e8 + 0.1, 4.0]));
        }
    }

    #[test]
    fn an_open_side_has_no_half_plane() {
        let strip = Region::rectangle([1.0, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]);
        assert_eq!(strip.half_planes(), [HalfPlane { normal: [1.0, 0.0], corner: [1.0, 0.0] }]);
        assert!(!strip.depends_on_g());
    }
}

#[cfg(test)]
mod convex_tests {
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
