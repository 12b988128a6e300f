//! Numbers that are linear along a ray segment, and places on it, of twice 53 bits: unevaluated sums of two doubles.
//!
//! Where 1e30 of optical depth lie in one cell, the light ends within 1e-30 of the segment's length behind the place
//! where the matter begins, and two widgets that begin within less than that are seen together. So places are known
//! to 2⁻¹⁰² of their distance from the nearer end of the segment, and numbers on it as well ([`Wide`]).
//!
//! Dekker, "A floating-point technique for extending the available precision", 1971; sums and quotients as in
//! Hida, Li and Bailey, "Algorithms for quad-double precision floating point arithmetic", 2001. Sums, differences and
//! products are right to a relative 2⁻¹⁰⁴, quotients to 2⁻¹⁰².
//!
//! Breakpoints of a segment: every place where a widget changes its character.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// high + low, |low| at most half a unit in the last place of high.
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd, Default)]
pub(crate) struct Wide {
    high: f64,
    low: f64,
}

impl Wide {
    pub(crate) const ZERO: Wide = Wide { high: 0.0, low: 0.0 };

    /// a − b, exactly.
    pub(crate) fn difference(a: f64, b: f64) -> Wide {
        two_sum(a, -b)
    }

    /// The nearest double.
    pub(crate) fn value(self) -> f64 {
        self.high
    }

    /// Its half, exactly.
    pub(crate) fn half(self) -> Wide {
        Wide { high: 0.5 * self.high, low: 0.5 * self.low }
    }

    pub(crate) fn abs(self) -> Wide {
        if self.high < 0.0 { -self } else { self }
    }

    /// The largest whole number that is not above it.
    pub(crate) fn floor(self) -> f64 {
        let floor = self.high.floor();
        if floor == self.high && self.low < 0.0 { floor - 1.0 } else { floor }
    }

    /// The order of numbers; what is no number is before and behind none.
    pub(crate) fn order(self, other: Wide) -> Ordering {
        self.partial_cmp(&other).unwrap_or(Ordering::Equal)
    }
}

impl From<f64> for Wide {
    fn from(high: f64) -> Wide {
        Wide { high, low: 0.0 }
    }
}

impl Neg for Wide {
    type Output = Wide;
    fn neg(self) -> Wide {
        Wide { high: -self.high, low: -self.low }
    }
}

impl Add for Wide {
    type Output = Wide;
    fn add(self, other: Wide) -> Wide {
        let (high, low) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let sum = quick_two_sum(high.high, high.low + low.high);
        quick_two_sum(sum.high, sum.low + low.low)
    }
}

impl Sub for Wide {
    type Output = Wide;
    fn sub(self, other: Wide) -> Wide {
        self + -other
    }
}

impl Mul for Wide {
    type Output = Wide;
    fn mul(self, other: Wide) -> Wide {
        let product = two_product(self.high, other.high);
        quick_two_sum(product.high, product.low + (self.high * other.low + self.low * other.high))
    }
}

impl Mul<f64> for Wide {
    type Output = Wide;
    fn mul(self, other: f64) -> Wide {
        let product = two_product(self.high, other);
        quick_two_sum(product.high, product.low + self.low * other)
    }
}

impl Div for Wide {
    type Output = Wide;
    fn div(self, other: Wide) -> Wide {
        let first = self.high / other.high;
        let rest = self - other * first;
        let second = rest.high / other.high;
        let third = (rest - other * second).high / other.high;
        quick_two_sum(first, second) + Wide::from(third)
    }
}

/// a + b, exactly.
fn two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    let from_b = high - a;
    Wide { high, low: (a - (high - from_b)) + (b - from_b) }
}

/// a + b, exactly, where |a| ≥ |b| or a is 0.
fn quick_two_sum(a: f64, b: f64) -> Wide {
    let high = a + b;
    Wide { high, low: b - (high - a) }
}

/// a · b, exactly where nothing underflows.
fn two_product(a: f64, b: f64) -> Wide {
    let high = a * b;
    Wide { high, low: a.mul_add(b, -high) }
}

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

    /// Like [`LinearOnSegment::new`], of factors that are doubles.
    pub(crate) fn exact(
        front: &[f64],
        back: &[f64],
        parts: impl Iterator<Item = (usize, f64, f64)>,
    ) -> LinearOnSegment {
        let wide = |(column, factor, origin): (usize, f64, f64)| (column, Wide::from(factor), origin);
        LinearOnSegment::new(front, back, parts.map(wide))
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

/// Two features nearer to each other than this share of their distance from the nearer end are one that was found in
/// two ways: eight bits above the rounding of places.
const ONE_PLACE: f64 = 1.3e-29;

/// Features that are nearer to each other than this, but not one, are told from one another with fewer than twelve
/// digits.
const TOO_NEAR: f64 = 1e-19;

#[derive(Debug, Clone, Copy)]
struct Cut {
    place: Place,
    /// True if something begins, ends or breaks there; else the cut only helps the quadrature.
    firm: bool,
}

pub(crate) struct Cuts {
    list: Vec<Cut>,
    /// Interval of the widget: cuts outside are of no use to it.
    window: [Place; 2],
}

/// A place where one stretch ends and the next begins.
#[derive(Debug, Clone, Copy)]
pub(crate) struct End {
    pub(crate) place: Place,
    /// Something else begins or ends so near before it that the distance is not known well.
    pub(crate) blurred: bool,
}

impl Default for Cuts {
    fn default() -> Self {
        Cuts { list: Vec::new(), window: [Place::FRONT, Place::BACK] }
    }
}

impl Cuts {
    pub(crate) fn clear(&mut self) {
        self.list.clear();
    }

    /// The cuts to come belong to a widget that is between these places only.
    pub(crate) fn begin(&mut self, window: [Place; 2]) {
        self.window = window;
        for end in window {
            if end != Place::FRONT && end != Place::BACK {
                self.list.push(Cut { place: end, firm: true });
            }
        }
    }

    pub(crate) fn window(&self) -> [Place; 2] {
        self.window
    }

    /// Something begins, ends or breaks here.
    pub(crate) fn firm(&mut self, place: Option<Place>) {
        self.push(place, true);
    }

    /// The quadrature is helped by a cut here.
    pub(crate) fn soft(&mut self, place: Option<Place>) {
        self.push(place, false);
    }

    fn push(&mut self, place: Option<Place>, firm: bool) {
        let [from, to] = self.window;
        if let Some(place) = place.filter(|place| from.is_before(*place) && place.is_before(to)) {
            self.list.push(Cut { place, firm });
        }
    }

    /// The ends of all stretches in their order, the front's and the back's among them.
    pub(crate) fn ends(&mut self, ends: &mut Vec<End>) {
        ends.clear();
        ends.push(End { place: Place::FRONT, blurred: false });
        self.list.sort_unstable_by(|a, b| a.place.order(b.place));
        let mut last = Cut { place: Place::FRONT, firm: true };
        let mut last_firm = Place::FRONT;
        let back = Cut { place: Place::BACK, firm: true };
        for cut in self.list.iter().copied().chain([back]) {
            let apart = relative_distance(last.place, cut.place);
            if cut.firm {
                if !last.firm && apart < TOO_NEAR {
                    ends.pop();
                }
                let from_firm = relative_distance(last_firm, cut.place);
                last = Cut { place: last_firm, firm: true };
                if from_firm < ONE_PLACE {
                    continue;
                }
                last_firm = cut.place;
                ends.push(End { place: cut.place, blurred: from_firm < TOO_NEAR });
            } else if apart < if last.firm { TOO_NEAR } else { ONE_PLACE } {
                continue;
            } else {
                ends.push(End { place: cut.place, blurred: false });
            }
            last = cut;
        }
    }
}

/// The distance of two places, as a share of their distance from the nearer end.
fn relative_distance(a: Place, b: Place) -> f64 {
    let distance: Wide = a.distance_to(b);
    distance.value() / a.nearer_end().max(b.nearer_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1/3 as a double is 1/3 − 2⁻⁵⁴/3; three times the quotient is 1 to 2⁻¹⁰².
    #[test]
    fn a_quotient_has_both_halves() {
        let third = Wide::from(1.0) / Wide::from(3.0);
        assert_eq!((third.high, third.low), (1.0 / 3.0, 2f64.powi(-54) / 3.0));
        let rest = third * 3.0 - Wide::from(1.0);
        assert!(rest.value().abs() <= 2f64.powi(-102), "{rest:?}");
    }

    /// (1 + 2⁻⁶⁰)² = 1 + 2⁻⁵⁹ + 2⁻¹²⁰: what is left of it beside 1 is far under the last bit of a double.
    #[test]
    fn products_and_differences_keep_what_doubles_lose() {
        let near = Wide::from(1.0) + Wide::from(2f64.powi(-60));
        assert_eq!((near * near - Wide::from(1.0)).value(), 2f64.powi(-59));
        assert_eq!((near * 0.5 - Wide::from(0.5)).value(), 2f64.powi(-61));
        assert_eq!(Wide::difference(1.0, 2f64.powi(-70)) - Wide::from(1.0), Wide::from(-2f64.powi(-70)));
    }

    #[test]
    fn floors_and_order_look_at_both_halves() {
        let below = Wide::difference(3.0, 2f64.powi(-70));
        assert_eq!((below.floor(), Wide::from(3.0).floor(), Wide::from(-0.5).floor()), (2.0, 3.0, -1.0));
        assert_eq!(below.order(Wide::from(3.0)), Ordering::Less);
        assert_eq!((-below).abs(), below);
    }

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
