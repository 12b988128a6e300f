//! Slabs of the (s, g) plane, and how far out a widget still counts.

/// The points v = (s, g) with low ≤ normal · v ≤ high.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    /// Of any length, not 0.
    pub normal: [f64; 2],
    /// −∞ where there is no limit.
    pub low: f64,
    /// ∞ where there is no limit.
    pub high: f64,
}

/// Squared distance from a widget's centre, in widths, at which a profile exp(−r²) no longer counts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reach {
    /// It counts at no distance.
    Nowhere,
    /// This is r².
    Within(f64),
    /// It counts at any distance.
    Everywhere,
}

impl Reach {
    /// `ratio`: the depth of the profile's peak by the least depth that counts. `cutoff`: the constant-emitter's.
    pub(super) fn new(ratio: f64, cutoff: Option<f64>) -> Reach {
        let absorbs = if ratio > 1.0 { ratio.ln() } else { 0.0 };
        match cutoff {
            _ if ratio <= 0.0 => Reach::Nowhere,
            Some(cutoff) if cutoff <= 0.0 => Reach::Everywhere,
            Some(cutoff) => Reach::Within(absorbs.max(-cutoff.ln())),
            None if ratio <= 1.0 => Reach::Nowhere,
            None => Reach::Within(absorbs),
        }
    }

    /// The lists of a support without slabs of its own.
    pub(in crate::transfer) fn everywhere(self) -> Vec<Vec<Slab>> {
        self.within(|_| Vec::new())
    }

    /// One list, of the slabs that hold what lies within a distance.
    pub(in crate::transfer) fn within(self, slabs: impl Fn(f64) -> Vec<Slab>) -> Vec<Vec<Slab>> {
        match self {
            Reach::Nowhere => Vec::new(),
            Reach::Everywhere => vec![Vec::new()],
            Reach::Within(square) => vec![slabs(square.sqrt())],
        }
    }
}
