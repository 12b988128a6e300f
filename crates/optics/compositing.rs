//! Front-to-back compositing of segments: C += τ C_seg, τ ← τ (1 − A_seg) (docs/src/explanation/optics.md, section 7).
//!
//! The transparency τ is kept by itself. A formed as A += (1 − A) A_seg and 1 − A taken at the end keep an
//! absolute rounding only, which is everything once τ is small; τ formed as 1 − A is nothing once A is small.
//! So both are carried: A as the sum of τ A_seg while it is below ½, as 1 − τ beyond.

/// Colour and opacity of the segments composited so far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Composite {
    /// C, premultiplied linear.
    pub color: [f64; 3],
    /// Σ τ A_seg.
    opacity: f64,
    /// τ = Π (1 − A_seg).
    transparency: f64,
}

impl Default for Composite {
    fn default() -> Self {
        Composite { color: [0.0; 3], opacity: 0.0, transparency: 1.0 }
    }
}

impl Composite {
    /// Adds a segment behind all that was added before.
    #[inline]
    pub fn add(&mut self, color: [f64; 3], opacity: f64) {
        for (sum, c) in self.color.iter_mut().zip(color) {
            *sum += self.transparency * c;
        }
        self.opacity += self.transparency * opacity;
        self.transparency *= 1.0 - opacity;
    }

    /// A, in [0, 1].
    #[inline]
    pub fn opacity(&self) -> f64 {
        if self.opacity < 0.5 { self.opacity } else { 1.0 - self.transparency }
    }

    /// τ = 1 − A, with relative accuracy.
    #[inline]
    pub fn transparency(&self) -> f64 {
        self.transparency
    }
}

#[cfg(test)]
mod tests {
    use super::Composite;

    /// Both sums keep their digits: A while it is small, and what is missing of 1 beyond.
    #[test]
    fn opacities_keep_their_digits_at_both_ends() {
        for (opacity, count) in [(1.0 / 3.0, 1000), (0.01, 100_000), (0.003, 100_000), (1e-12, 1000)] {
            let mut sum = Composite::default();
            (0..count).for_each(|_| sum.add([0.0; 3], opacity));
            let exact = -(f64::from(count) * f64::ln_1p(-opacity)).exp_m1();
            // A thousand roundings of a small sum; what is left of 1 is nothing.
            let bound = if exact < 0.5 { 1e-13 * exact } else { 0.0 };
            assert!((sum.opacity() - exact).abs() <= bound, "{count} of {opacity}: {}", sum.opacity());
        }
    }
}
