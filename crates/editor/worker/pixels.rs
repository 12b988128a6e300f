//! A picture as a screen shows it.

use rayon::prelude::*;
use std::sync::{Arc, LazyLock};
use voltet_core::picture::Picture;
use voltet_io::encode::srgb_from_linear;

/// Steps of the table from linear to sRGB: finer than the steepest of 256 levels (12.92 × 255) by a factor of five.
const STEPS: usize = 1 << 14;

static SRGB: LazyLock<Vec<u8>> = LazyLock::new(|| {
    let level = |i: usize| (srgb_from_linear(i as f32 / STEPS as f32) * 255.0).round() as u8;
    (0..=STEPS).map(level).collect()
});

/// A drawn picture.
#[derive(Debug, Clone)]
pub struct Pixels {
    /// As the engine gave it.
    pub picture: Arc<Picture>,
    /// 8-bit sRGB over the background, opaque.
    pub rgba: Arc<Vec<[u8; 4]>>,
    /// Side of a pixel in pixels of the full picture; 1 for the full picture.
    pub divisor: u32,
    /// True if it is a preview from the engine's cache, which differs from the full picture by rounding.
    pub is_passing: bool,
    /// The number of the request that it was drawn for.
    pub number: u64,
}

impl Pixels {
    pub(super) fn new(picture: Arc<Picture>, background: [f64; 3], divisor: u32, number: u64) -> Pixels {
        let behind = background.map(|channel| channel as f32);
        let srgb = |v: f32| SRGB[(v.clamp(0.0, 1.0) * STEPS as f32 + 0.5) as usize];
        let rgba: Vec<[u8; 4]> = picture
            .rgba
            .par_iter()
            .with_min_len(4096)
            .map(|&[r, g, b, a]| {
                let channel = |v: f32, k: usize| srgb(v + (1.0 - a) * behind[k]);
                [channel(r, 0), channel(g, 1), channel(b, 2), 255]
            })
            .collect();
        Pixels { picture, rgba: Arc::new(rgba), divisor, is_passing: false, number }
    }

    /// True if it is the picture that a run of the document gives.
    pub fn is_full(&self) -> bool {
        self.divisor == 1 && !self.is_passing
    }

    /// Width and height.
    pub fn size(&self) -> [usize; 2] {
        [self.picture.width, self.picture.height]
    }

    pub(super) fn count(&self) -> f64 {
        self.rgba.len() as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Within one level of what a PNG file of the picture holds.
    #[test]
    fn pixels_are_those_of_a_png() {
        let rgba: Vec<[f32; 4]> = (0..=1000).map(|i| [i as f32 / 1000.0, 0.0, 0.0, 1.0]).collect();
        let picture = Arc::new(Picture { width: 1001, height: 1, rgba });
        for (i, pixel) in Pixels::new(picture, [0.0; 3], 1, 1).rgba.iter().enumerate() {
            let exact = srgb_from_linear(i as f32 / 1000.0) * 255.0;
            assert!((f32::from(pixel[0]) - exact).abs() <= 0.7, "{i}: {} for {exact}", pixel[0]);
        }
    }

    #[test]
    fn the_background_shows_where_nothing_is_drawn() {
        let picture = Arc::new(Picture { width: 1, height: 1, rgba: vec![[0.0; 4]] });
        let pixels = Pixels::new(picture, [1.0, 0.0, 0.5], 1, 1);
        assert_eq!(pixels.rgba[0], [255, 0, 188, 255]);
    }
}
