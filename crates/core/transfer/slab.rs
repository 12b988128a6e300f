//! Slabs of the (s, g) plane, and the distance up to which a widget counts.

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
