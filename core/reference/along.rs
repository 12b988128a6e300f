//! Numbers that are linear along a ray segment, and where they pass a value.

/// A number that is linear in t ∈ [0, 1], the share of the segment's length.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Along {
    pub(super) front: f64,
    pub(super) back: f64,
}

impl Along {
    /// Its value at t; exact at both ends.
    pub(super) fn at(self, t: f64) -> f64 {
        self.front * (1.0 - t) + self.back * t
    }

    /// The part from t = a to t = b.
    pub(super) fn part(self, a: f64, b: f64) -> Along {
        Along { front: self.at(a), back: self.at(b) }
    }

    /// Appends the t strictly inside (0, 1) at which it has the given value.
    pub(super) fn level(self, value: f64, out: &mut Vec<f64>) {
        let (f, b) = (self.front - value, self.back - value);
        if (f < 0.0 && b > 0.0) || (f > 0.0 && b < 0.0) {
            let t = f / (f - b);
            if t > 0.0 && t < 1.0 {
                out.push(t);
            }
        }
    }
}

/// Calls `push` with the real roots of square·t² + 2 slope·t + offset = 0.
pub(super) fn quadratic_crossings(square: f64, slope: f64, offset: f64, mut push: impl FnMut(f64)) {
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
        let mut out = Vec::new();
        let rising = Along { front: 1.0, back: 3.0 };
        for value in [1.0, 1.5, 3.0, 4.0] {
            rising.level(value, &mut out);
        }
        assert_eq!(out, [0.25]);
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
