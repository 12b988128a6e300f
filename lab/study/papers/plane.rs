//! Transfer functions drawn over their own plane.

use voltet_core::picture::Picture;

/// Fills a square: `at` gives straight linear RGB and opacity at places from 0 to 1, upward.
pub(super) fn square(side: usize, at: impl Fn(f64, f64) -> ([f64; 3], f64)) -> Picture {
    let pixel = |k: usize| {
        let (i, j) = (k % side, k / side);
        let place = |n: usize| (n as f64 + 0.5) / side as f64;
        let (color, opacity) = at(place(i), 1.0 - place(j));
        let [r, g, b] = color.map(|c| (c * opacity) as f32);
        [r, g, b, opacity as f32]
    };
    Picture { width: side, height: side, rgba: (0..side * side).map(pixel).collect() }
}

/// e^(−((x − x₀)/w)²) (Kniss et al. 2003, Eq. 1).
pub(super) fn gaussian(x: f64, centre: f64, width: f64) -> f64 {
    (-((x - centre) / width).powi(2)).exp()
}
