//! The part of a segment that lies in a convex region, in closed form: the path through the (s, g) plane is
//! straight, so each edge cuts it at most once (Song et al. 2009, Figure 4).
//!
//! Symbols: t ∈ [0, 1] the share of the segment, u = 1 − t; d_f, d_b the signed distances of the ends from an
//! edge, positive inside. t = d_f/(d_f − d_b) and u = −d_b/(d_f − d_b) are kept side by side, because the
//! difference 1 − t loses the digits of a short piece.

use voltet_core::arithmetic::difference_of_products;
use voltet_core::transfer::Convex;

/// A part [t₀, t₁] of a segment, with the complements and the length known by themselves.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClippedSpan {
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

impl ClippedSpan {
    /// The whole segment.
    pub const WHOLE: ClippedSpan =
        ClippedSpan { start: 0.0, start_to_back: 1.0, end: 1.0, end_to_back: 0.0, length: 1.0 };

    /// The part of the path from `front` to `back` inside the region, whose boundary belongs to it; `None`
    /// where it has no length. A path that stays at one point of the region is inside over its whole length.
    pub fn within(region: &Convex, front: [f64; 2], back: [f64; 2]) -> Option<ClippedSpan> {
        let delta = [back[0] - front[0], back[1] - front[1]];
        let mut cuts = Cuts::default();
        let inside = region.distances(front, back, |f, b, axis, level| cuts.edge(f, b, axis, level));
        if inside { cuts.stretch(delta) } else { None }
    }

    /// The part that two stretches share.
    pub fn intersection(&self, other: &ClippedSpan) -> Option<ClippedSpan> {
        let first = if self.start >= other.start { self } else { other };
        let last = if self.end_to_back >= other.end_to_back { self } else { other };
        let length = if first == last { first.length } else { last.end - first.start };
        let (start, start_to_back) = (first.start, first.start_to_back);
        let (end, end_to_back) = (last.end, last.end_to_back);
        (length > 0.0).then_some(ClippedSpan { start, start_to_back, end, end_to_back, length })
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

    fn stretch(&self, delta: [f64; 2]) -> Option<ClippedSpan> {
        let mut stretch = ClippedSpan::WHOLE;
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

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::Region;

    fn unit_square() -> Convex {
        Convex::new(&Region::rectangle([0.0, 1.0], [0.0, 1.0])).expect("a square is a region")
    }

    #[test]
    fn an_edge_belongs_to_the_region_and_a_touched_corner_has_no_length() {
        let triangle =
            Convex::new(&Region { corners: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] }).expect("convex");
        for clip in [unit_square(), triangle] {
            let along = ClippedSpan::within(&clip, [-1.0, 0.0], [3.0, 0.0]).expect("runs along an edge");
            assert_eq!((along.start, along.length), (0.25, 0.25));
            assert_eq!(ClippedSpan::within(&clip, [-1.0, 1.0], [1.0, -1.0]), None, "touches the corner only");
            assert_eq!(
                ClippedSpan::within(&clip, [0.0, 0.0], [0.0, 0.0]),
                Some(ClippedSpan::WHOLE),
                "stays at a corner"
            );
            assert_eq!(ClippedSpan::within(&clip, [0.0, -1e-300], [1.0, -1e-300]), None, "beside the edge");
        }
    }

    #[test]
    fn the_length_of_a_clipped_corner_keeps_its_digits() {
        // The line s + g = 2⁻³⁰ cuts the corner at the origin over 2⁻³⁰ of its length of (2, 2)/√2.
        let tiny = f64::powi(2.0, -30);
        let stretch = ClippedSpan::within(&unit_square(), [-1.0, 1.0 + tiny], [1.0, -1.0 + tiny])
            .expect("cuts the corner");
        assert_eq!(stretch.length, tiny / 2.0);
    }

    #[test]
    fn an_axis_without_limits_does_not_clip() {
        let clip =
            Convex::new(&Region::rectangle([0.0, 1.0], [f64::NEG_INFINITY, f64::INFINITY])).expect("a strip");
        let stretch = ClippedSpan::within(&clip, [-1.0, -1e30], [1.0, 1e30]).expect("crosses the strip");
        assert_eq!((stretch.start, stretch.length), (0.5, 0.5));
    }
}
