//! Numbers that are linear along a ray segment, and places on it.
//!
//! Where 1e30 of optical depth lie in one cell, the light ends within 1e-30 of the segment's length behind the place
//! where the matter begins, and two widgets that begin within less than that are seen together. So places are known
//! to 2⁻¹⁰² of their distance from the nearer end of the segment, and numbers on it as well ([`Wide`]).

use crate::wide::Wide;
use std::cmp::Ordering;

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Place {
    /// True if it is counted from the back: beyond the middle.
    from_back: bool,
    /// Share of the segment's length from that end; negative towards the front.
    offset: Wide,
}

impl Place {
    pub(crate) const FRONT: Place = Place { from_back: false, offset: Wide::ZERO };
    pub(crate) const BACK: Place = Place { from_back: true, offset: Wide::ZERO };

    /// The place at the share `offset` behind the front.
    pub(crate) fn behind_front(offset: Wide) -> Place {
        if offset.value() > 0.5 {
            Place { from_back: true, offset: offset - Wide::from(1.0) }
        } else {
            Place { from_back: false, offset }
        }
    }

    /// The place at the share `offset` (negative: before) behind the back.
    fn behind_back(offset: Wide) -> Place {
        if offset.value() <= -0.5 {
            Place { from_back: false, offset: offset + Wide::from(1.0) }
        } else {
            Place { from_back: true, offset }
        }
    }

    /// The place at the share `by` behind this one.
    pub(crate) fn moved(self, by: Wide) -> Place {
        let offset = self.offset + by;
        if self.from_back { Place::behind_back(offset) } else { Place::behind_front(offset) }
    }

    /// Share of the length from here to a place behind it.
    pub(crate) fn distance_to(self, back: Place) -> Wide {
        let difference = back.offset - self.offset;
        match (self.from_back, back.from_back) {
            (false, true) => difference + Wide::from(1.0),
            (true, false) => difference - Wide::from(1.0),
            _ => difference,
        }
    }

    /// The place half way to another.
    pub(crate) fn middle(self, back: Place) -> Place {
        self.moved(self.distance_to(back).half())
    }

    /// Compares two places, the one in front first.
    pub(crate) fn order(self, other: Place) -> Ordering {
        self.from_back.cmp(&other.from_back).then(self.offset.order(other.offset))
    }

    pub(crate) fn is_before(self, other: Place) -> bool {
        self.order(other) == Ordering::Less
    }

    /// Share of the length from the nearer end: the precision of places counts in it.
    pub(crate) fn nearer_end(self) -> f64 {
        self.offset.value().abs()
    }

    /// Share of the length from the front, as a double.
    pub(crate) fn share(self) -> f64 {
        if self.from_back { 1.0 + self.offset.value() } else { self.offset.value() }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LinearOnSegment {
    pub(crate) front: Wide,
    pub(crate) back: Wide,
    /// back − front, of the differences of the values: not of the two numbers, which may be rounded.
    pub(crate) step: Wide,
}

impl LinearOnSegment {
    /// Σ factor · (value − origin) of the given columns of a value.
    pub(crate) fn new(
        front: &[f64],
        back: &[f64],
        parts: impl Iterator<Item = (usize, Wide, f64)>,
    ) -> LinearOnSegment {
        let mut along = LinearOnSegment { front: Wide::ZERO, back: Wide::ZERO, step: Wide::ZERO };
        // A factor of 0 must not multiply another axis into the sum (0 × ∞).
        for (column, factor, origin) in parts.filter(|part| part.1 != Wide::ZERO) {
            let (front, back) = (front[column], back[column]);
            along.front = along.front + factor * Wide::difference(front, origin);
            along.back = along.back + factor * Wide::difference(back, origin);
            along.step = along.step + factor * Wide::difference(back, front);
        }
        along
    }

    pub(crate) fn rounded(
        front: &[f64],
        back: &[f64],
        parts: impl Iterator<Item = (usize, f64, f64)>,
    ) -> LinearOnSegment {
        let mut ends = [0.0, 0.0];
        for (column, factor, origin) in parts.filter(|part| part.1 != 0.0) {
            ends[0] += factor * (front[column] - origin);
            ends[1] += factor * (back[column] - origin);
        }
        let [front, back] = ends;
        LinearOnSegment { front: front.into(), back: back.into(), step: Wide::difference(back, front) }
    }

    /// One column of a value, exactly.
    pub(crate) fn column(front: &[f64], back: &[f64], column: usize) -> LinearOnSegment {
        let (front, back) = (front[column], back[column]);
        LinearOnSegment { front: front.into(), back: back.into(), step: Wide::difference(back, front) }
    }

    /// This number times `factor`.
    pub(crate) fn times(self, factor: Wide) -> LinearOnSegment {
        LinearOnSegment { front: self.front * factor, back: self.back * factor, step: self.step * factor }
    }

    pub(crate) fn less(self, other: LinearOnSegment) -> LinearOnSegment {
        let LinearOnSegment { front, back, step } = other;
        LinearOnSegment { front: self.front - front, back: self.back - back, step: self.step - step }
    }

    /// Its value at a place; exact at both ends.
    pub(crate) fn at(self, place: Place) -> Wide {
        if place.offset == Wide::ZERO {
            return if place.from_back { self.back } else { self.front };
        }
        let end = if place.from_back { self.back } else { self.front };
        end + self.step * place.offset
    }

    /// The place strictly inside the segment where it passes a value.
    pub(crate) fn passes(self, value: Wide) -> Option<Place> {
        let (f, b) = (self.front - value, self.back - value);
        let (front, back) = (f.value(), b.value());
        if !(front < 0.0 && back > 0.0 || front > 0.0 && back < 0.0) {
            return None;
        }
        let place = if front.abs() <= back.abs() {
            Place::behind_front(-(f / self.step))
        } else {
            Place::behind_back(-(b / self.step))
        };
        (Place::FRONT.is_before(place) && place.is_before(Place::BACK)).then_some(place)
    }
}

/// Calls `push` with the real roots of square·t² + 2 slope·t + offset = 0.
pub(crate) fn quadratic_crossings(square: f64, slope: f64, offset: f64, mut push: impl FnMut(f64)) {
    let under_root = slope * slope - square * offset;
    if under_root < 0.0 || under_root.is_nan() {
        return;
    }
    // The sum of two numbers of equal sign: neither root comes from a difference.
    let sum = -(slope + under_root.sqrt().copysign(slope));
    if square != 0.0 {
        push(sum / square);
    }
    if sum != 0.0 {
        push(offset / sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_lie_strictly_inside() {
        let rising = LinearOnSegment::column(&[1.0], &[3.0], 0);
        let places = [1.0, 1.5, 3.0, 4.0].map(|value| rising.passes(Wide::from(value)));
        assert_eq!(places, [None, Some(Place::behind_front(Wide::from(0.25))), None, None]);
        assert_eq!(rising.passes(Wide::from(2.5)).map(Place::share), Some(0.75));
    }

    /// Behind the front and before the back by 1e-40 of the length: both shares keep all digits, and the number is
    /// 1e-40 and 1 − 1e-40 there.
    #[test]
    fn places_near_either_end_keep_their_digits() {
        let rising = LinearOnSegment::column(&[-1e-40], &[1.0], 0);
        let place = rising.passes(Wide::ZERO).expect("is passed");
        assert!((place.nearer_end() / 1e-40 - 1.0).abs() < 1e-15 && place.share() < 0.5);
        let falling = LinearOnSegment::column(&[1.0], &[-1e-40], 0);
        let place = falling.passes(Wide::ZERO).expect("is passed");
        assert!((place.nearer_end() / 1e-40 - 1.0).abs() < 1e-15 && place.share() > 0.5);
        assert!((place.distance_to(Place::BACK).value() / 1e-40 - 1.0).abs() < 1e-15);
        // The value there is 0 to 2⁻¹⁰⁰ of what it changes by from the end.
        assert!(falling.at(place).value().abs() < 1e-69);
        assert_eq!(falling.at(Place::BACK).value(), -1e-40);
    }

    #[test]
    fn places_are_ordered_and_move_across_the_middle() {
        let at = |t: f64| Place::behind_front(Wide::from(t));
        let places = [Place::FRONT, at(0.25), at(0.5), at(0.75), Place::BACK];
        for pair in places.windows(2) {
            assert!(pair[0].is_before(pair[1]), "{pair:?}");
            assert_eq!(pair[0].distance_to(pair[1]).value(), 0.25);
            assert_eq!(pair[0].moved(Wide::from(0.25)), pair[1]);
            assert_eq!(pair[1].moved(Wide::from(-0.25)).share(), pair[0].share());
        }
        assert_eq!(at(0.25).middle(at(0.75)), at(0.5));
    }

    /// (t − 1e-9)(t − 1) = t² − (1 + 1e-9) t + 1e-9: the small root keeps its digits.
    #[test]
    fn small_root_keeps_its_digits() {
        let mut roots = Vec::new();
        quadratic_crossings(1.0, -0.5 * (1.0 + 1e-9), 1e-9, |t| roots.push(t));
        roots.sort_by(f64::total_cmp);
        assert!((roots[0] / 1e-9 - 1.0).abs() < 1e-15 && (roots[1] - 1.0).abs() < 1e-15, "{roots:?}");
    }
}
