//! The part of a segment that lies in a convex region, in closed form: the path through the (s, g) plane is
//! straight, so each edge cuts it at most once (Song et al. 2009, Figure 4).
//!
//! Symbols: t ∈ [0, 1] the share of the segment, u = 1 − t; d_f, d_b the signed distances of the ends from an
//! edge, positive inside. t = d_f/(d_f − d_b) and u = −d_b/(d_f − d_b) are kept side by side, because the
//! difference 1 − t loses the digits of a short piece.

use super::special::difference_of_products;
use crate::transfer::Region;
use crate::{Error, Result};

/// A part [t₀, t₁] of a segment, with the complements and the length known by themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stretch {
    /// t₀.
    pub start: f64,
    /// 1 − t₀.
    pub start_to_back: f64,
    /// t₁.
    pub end: f64,
    /// 1 − t₁.
    pub end_to_back: f64,
    /// t₁ − t₀, to working precision.
    pub length: f64,
}

impl Stretch {
    /// The whole segment.
    pub const WHOLE: Stretch =
        Stretch { start: 0.0, start_to_back: 1.0, end: 1.0, end_to_back: 0.0, length: 1.0 };

    /// The part that two stretches share.
    pub fn intersection(&self, other: &Stretch) -> Option<Stretch> {
        let first = if self.start >= other.start { self } else { other };
        let last = if self.end_to_back >= other.end_to_back { self } else { other };
        let length = if first == last { first.length } else { last.end - first.start };
        let (start, start_to_back) = (first.start, first.start_to_back);
        let (end, end_to_back) = (last.end, last.end_to_back);
        (length > 0.0).then_some(Stretch { start, start_to_back, end, end_to_back, length })
    }

    /// The value at the start of what is `front` and `back` at the segment's ends.
    #[inline]
    pub fn at_start(&self, front: f64, back: f64) -> f64 {
        front * self.start_to_back + back * self.start
    }

    /// The value at the end.
    #[inline]
    pub fn at_end(&self, front: f64, back: f64) -> f64 {
        front * self.end_to_back + back * self.end
    }
}

/// A region made ready for clipping.
#[derive(Debug, Clone, PartialEq)]
pub enum Clip {
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

/// A cut as a fraction p/q of the segment, with the distance q − p kept apart.
#[derive(Clone, Copy)]
struct Cut {
    numerator: f64,
    denominator: f64,
    rest: f64,
    /// 0 or 1: level line of s or g; 2: of neither.
    axis: u8,
    /// The level, for axes 0 and 1.
    level: f64,
}

impl Cut {
    fn lies_before(&self, other: &Cut) -> bool {
        difference_of_products(other.numerator, self.denominator, self.numerator, other.denominator) > 0.0
    }
}

/// The cuts found so far.
#[derive(Default)]
struct Cuts {
    entry: Option<Cut>,
    exit: Option<Cut>,
}

impl Cuts {
    /// Takes in one edge; false if the segment lies outside it.
    #[inline]
    fn edge(&mut self, front: f64, back: f64, axis: u8, level: f64) -> bool {
        if front >= 0.0 && back >= 0.0 {
            return true;
        }
        if front < 0.0 && back < 0.0 {
            return false;
        }
        let cut =
            Cut { numerator: front.abs(), denominator: (front - back).abs(), rest: back.abs(), axis, level };
        if front < 0.0 {
            if self.entry.is_none_or(|old| old.lies_before(&cut)) {
                self.entry = Some(cut);
            }
        } else if self.exit.is_none_or(|old| cut.lies_before(&old)) {
            self.exit = Some(cut);
        }
        true
    }

    fn stretch(&self, delta: [f64; 2]) -> Option<Stretch> {
        let mut stretch = Stretch::WHOLE;
        if let Some(cut) = self.entry {
            stretch.start = cut.numerator / cut.denominator;
            stretch.start_to_back = cut.rest / cut.denominator;
            stretch.length = stretch.start_to_back;
        }
        if let Some(cut) = self.exit {
            stretch.end = cut.numerator / cut.denominator;
            stretch.end_to_back = cut.rest / cut.denominator;
            stretch.length = stretch.end;
        }
        if let (Some(entry), Some(exit)) = (self.entry, self.exit) {
            stretch.length = if entry.axis == exit.axis && entry.axis < 2 {
                // Both are level lines of one quantity: the span between the levels.
                (exit.level - entry.level).abs() / delta[usize::from(entry.axis)].abs()
            } else {
                difference_of_products(exit.numerator, entry.denominator, entry.numerator, exit.denominator)
                    / (entry.denominator * exit.denominator)
            };
        }
        (stretch.length > 0.0).then_some(stretch)
    }
}

impl Clip {
    /// Checks a region (at least three corners, convex, with an area) and makes it ready.
    pub fn new(region: &Region) -> Result<Clip> {
        let corners = &region.corners;
        if corners.iter().flatten().any(|c| c.is_nan()) {
            return Err(Error::usage("a region's corner is not a number").accepted("finite corners [s, g]"));
        }
        if let Some(rectangle) = rectangle(corners) {
            return Ok(rectangle);
        }
        if corners.len() < 3 {
            return Err(Error::usage("a region has too few corners")
                .found(corners.len())
                .accepted("a convex polygon of at least 3 corners"));
        }
        if corners.iter().flatten().any(|c| c.is_infinite()) {
            return Err(Error::usage("a region that is no rectangle has an infinite corner")
                .accepted("finite corners [s, g]"));
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
        match (left, right) {
            (true, false) => Ok(Clip::Polygon(corners.clone())),
            (false, true) => Ok(Clip::Polygon(corners.iter().rev().copied().collect())),
            (false, false) => Err(Error::usage("a region has no area").accepted("a convex polygon")),
            (true, true) => Err(Error::usage("a region is not convex").accepted("a convex polygon")),
        }
    }

    /// The part of the path from `front` to `back` inside the region, whose boundary belongs to it; `None`
    /// where it has no length. A path that stays at one point of the region is inside over its whole length.
    pub fn stretch(&self, front: [f64; 2], back: [f64; 2]) -> Option<Stretch> {
        let delta = [back[0] - front[0], back[1] - front[1]];
        let mut cuts = Cuts::default();
        let inside = self.distances(front, back, |f, b, axis, level| cuts.edge(f, b, axis, level));
        if inside { cuts.stretch(delta) } else { None }
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
            Clip::Rectangle { low, high } => (0..2).all(|i| {
                let axis = i as u8;
                f(front[i] - low[i], back[i] - low[i], axis, low[i])
                    && f(high[i] - front[i], high[i] - back[i], axis, high[i])
            }),
            Clip::Polygon(corners) => {
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

/// The region as an axis-parallel rectangle, if it is one.
fn rectangle(corners: &[[f64; 2]]) -> Option<Clip> {
    let &[a, b, c, d] = corners else { return None };
    let along_s = a[1] == b[1] && b[0] == c[0] && c[1] == d[1] && d[0] == a[0];
    let along_g = a[0] == b[0] && b[1] == c[1] && c[0] == d[0] && d[1] == a[1];
    let low = [a[0].min(c[0]), a[1].min(c[1])];
    let high = [a[0].max(c[0]), a[1].max(c[1])];
    ((along_s || along_g) && low[0] < high[0] && low[1] < high[1]).then_some(Clip::Rectangle { low, high })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unit_square() -> Clip {
        Clip::new(&Region::rectangle([0.0, 1.0], [0.0, 1.0])).expect("a square is a region")
    }

    #[test]
    fn an_edge_belongs_to_the_region_and_a_touched_corner_has_no_length() {
        let triangle =
            Clip::new(&Region { corners: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] }).expect("convex");
        for clip in [unit_square(), triangle] {
            let along = clip.stretch([-1.0, 0.0], [3.0, 0.0]).expect("runs along an edge");
            assert_eq!((along.start, along.length), (0.25, 0.25));
            assert_eq!(clip.stretch([-1.0, 1.0], [1.0, -1.0]), None, "touches the corner only");
            assert_eq!(clip.stretch([0.0, 0.0], [0.0, 0.0]), Some(Stretch::WHOLE), "stays at a corner");
            assert_eq!(clip.stretch([0.0, -1e-300], [1.0, -1e-300]), None, "beside the edge");
        }
    }

    #[test]
    fn the_length_of_a_clipped_corner_keeps_its_digits() {
        // The line s + g = 2⁻³⁰ cuts the corner at the origin over 2⁻³⁰ of its length of (2, 2)/√2.
        let tiny = f64::powi(2.0, -30);
        let stretch = unit_square().stretch([-1.0, 1.0 + tiny], [1.0, -1.0 + tiny]).expect("cuts the corner");
        assert_eq!(stretch.length, tiny / 2.0);
    }

    #[test]
    fn a_region_that_is_none_is_refused() {
        let message =
            |corners: Vec<[f64; 2]>| Clip::new(&Region { corners }).expect_err("refused").to_string();
        assert!(message(vec![[0.0, 0.0], [1.0, 1.0]]).contains("too few corners"));
        assert!(message(vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).contains("no area"));
        let dart = vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [1.0, 1.0]];
        assert!(message(dart).contains("not convex"));
        assert!(message(vec![[f64::NAN, 0.0], [1.0, 0.0], [0.0, 1.0]]).contains("not a number"));
    }

    #[test]
    fn an_axis_without_limits_does_not_clip() {
        let clip =
            Clip::new(&Region::rectangle([0.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY])).expect("a strip");
        let stretch = clip.stretch([-1.0, -1e30], [1.0, 1e30]).expect("crosses the strip");
        assert_eq!((stretch.start, stretch.length), (0.5, 0.5));
    }
}
