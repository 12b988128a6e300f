//! Random numbers of a scene: numbers that follow from a seed and a scene's number alone.

use glam::DVec3;
use voltet_core::grid::generate::Random;

pub(super) struct Rng(Random);

impl Rng {
    /// Random numbers of one scene: neighbours' numbers have nothing to do with each other.
    pub(super) fn new(seed: u64, scene: u64) -> Rng {
        // Steele, Lea & Flood 2014, the finaliser of SplitMix64.
        let mut z = (seed << 32 ^ scene).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        z = (z ^ z >> 30).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ z >> 27).wrapping_mul(0x94D0_49BB_1331_11EB);
        Rng(Random((z ^ z >> 31) | 1))
    }

    /// In [low, high).
    pub(super) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.next()
    }

    /// 10 to a power in [low, high).
    pub(super) fn power(&mut self, low: f64, high: f64) -> f64 {
        10_f64.powf(self.between(low, high))
    }

    /// One of 0 … n − 1.
    pub(super) fn pick(&mut self, n: usize) -> usize {
        ((self.0.next() * n as f64) as usize).min(n - 1)
    }

    /// True if something of this probability happens.
    pub(super) fn chance(&mut self, probability: f64) -> bool {
        self.0.next() < probability
    }

    /// In the cube [low, high)³.
    pub(super) fn place(&mut self, low: f64, high: f64) -> DVec3 {
        DVec3::new(self.between(low, high), self.between(low, high), self.between(low, high))
    }

    /// A unit vector, each as likely.
    pub(super) fn direction(&mut self) -> DVec3 {
        loop {
            let place = self.place(-1.0, 1.0);
            if (0.01..=1.0).contains(&place.length_squared()) {
                return place.normalize();
            }
        }
    }

    /// Linear RGB, some of it above 1.
    pub(super) fn color(&mut self) -> [f64; 3] {
        self.place(0.0, 1.2).to_array()
    }
}
