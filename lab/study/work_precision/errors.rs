//! Differences of pictures: premultiplied linear RGBA, channel by channel.

use serde::Serialize;
use voltet_core::picture::Picture;
use voltet_io::encode::viridis;

/// A step of an 8-bit channel.
const STEP: f64 = 1.0 / 255.0;

/// Differences of two pictures. A pixel's error is the largest difference of its four channels. Every pixel counts,
/// also those that show nothing.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Errors {
    /// Root of the mean over all pixels and channels of the squared difference.
    pub root_mean_square: f64,
    /// At least 99.9 % of the pixels have an error of at most this (nearest rank).
    pub percentile_99_9: f64,
    pub maximum: f64,
    /// Pixels whose error is over 1/255.
    pub pixels_over_step: u64,
}

/// The difference of each pixel: the largest of its channels; infinite where a number is not finite.
pub fn pixel_errors(a: &Picture, b: &Picture) -> impl Iterator<Item = f64> {
    let channel = |(a, b): (&f32, &f32)| {
        let difference = (f64::from(*a) - f64::from(*b)).abs();
        if difference.is_finite() { difference } else { f64::INFINITY }
    };
    let pixels = a.rgba.iter().zip(&b.rgba);
    pixels.map(move |(a, b)| a.iter().zip(b).map(channel).fold(0.0, f64::max))
}

/// The differences of two pictures of the same size.
pub fn errors(picture: &Picture, reference: &Picture) -> Errors {
    assert_eq!((picture.width, picture.height), (reference.width, reference.height), "pictures of one size");
    let square = |(a, b): (&[f32; 4], &[f32; 4])| -> f64 {
        let channel = |k: usize| (f64::from(a[k]) - f64::from(b[k])).powi(2);
        let sum = (0..4).map(channel).sum::<f64>();
        if sum.is_nan() { f64::INFINITY } else { sum }
    };
    let mut each: Vec<f64> = pixel_errors(picture, reference).collect();
    each.sort_unstable_by(f64::total_cmp);
    let count = each.len().max(1);
    let pairs = picture.rgba.iter().zip(&reference.rgba);
    // Whole thousandths, so that no rounding moves the rank.
    let rank = (count * 999).div_ceil(1000);
    let at = |rank: usize| rank.checked_sub(1).and_then(|i| each.get(i)).map_or(0.0, |&e| e);
    Errors {
        root_mean_square: (pairs.map(square).sum::<f64>() / (4 * count) as f64).sqrt(),
        percentile_99_9: at(rank),
        maximum: at(each.len()),
        pixels_over_step: each.iter().filter(|&&e| e > STEP).count() as u64,
    }
}

/// The error at which the scale of difference pictures begins; it ends at 1. A power of ten.
const FAINTEST: f32 = 1e-6;

/// Each pixel's error on a logarithmic scale, from 1e-6 (dark violet) to 1 (yellow), brighter the larger.
pub fn difference(picture: &Picture, reference: &Picture) -> Picture {
    let level = |error: f64| 1.0 - ((error as f32).clamp(FAINTEST, 1.0).log10() / FAINTEST.log10());
    let rgba = pixel_errors(picture, reference).map(|error| viridis(level(error))).collect();
    Picture { rgba, ..*picture }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(rgba: Vec<[f32; 4]>) -> Picture {
        Picture { width: rgba.len(), height: 1, rgba }
    }

    #[test]
    fn hand_worked_differences() {
        // Of 2,000 pixels three differ: by 0.5, 0.25 and, in one channel, by less than a step.
        let mut rgba = vec![[0.0; 4]; 2000];
        let reference = picture(rgba.clone());
        rgba[3] = [0.5, 0.0, 0.0, 0.5];
        rgba[4] = [0.0, 0.0, 0.0, -0.25];
        rgba[5] = [0.0, 0.003, 0.0, 0.0];
        let found = errors(&picture(rgba), &reference);
        let squares: f64 = 0.25 + 0.25 + 0.0625 + 0.003f64.powi(2);
        // 0.003 is no float: its rounding is 1e-8 of it.
        assert!((found.root_mean_square / (squares / 8000.0).sqrt() - 1.0).abs() < 1e-9);
        assert_eq!(found.maximum, 0.5);
        // 1,998 of 2,000 pixels are at most this.
        assert_eq!(found.percentile_99_9, f64::from(0.003f32));
        assert_eq!(found.pixels_over_step, 2);
    }

    #[test]
    fn equal_pictures_differ_by_nothing_and_nan_by_everything() {
        let one = picture(vec![[0.25; 4]; 7]);
        let none = Errors { root_mean_square: 0.0, percentile_99_9: 0.0, maximum: 0.0, pixels_over_step: 0 };
        assert_eq!(errors(&one, &one), none);
        let mut broken = one.clone();
        broken.rgba[2][1] = f32::NAN;
        let found = errors(&broken, &one);
        assert_eq!((found.maximum, found.root_mean_square), (f64::INFINITY, f64::INFINITY));
        assert_eq!(found.pixels_over_step, 1);
    }

    #[test]
    fn a_difference_of_a_thousandth_is_in_the_middle_of_the_scale() {
        let one = picture(vec![[0.0; 4]; 4]);
        let other = picture(vec![[0.0; 4], [1e-7; 4], [0.0, 1e-3, 0.0, 0.0], [0.0, 0.0, -3.0, 0.0]]);
        let found = difference(&other, &one).rgba;
        assert_eq!([found[0], found[1], found[3]], [viridis(0.0), viridis(0.0), viridis(1.0)]);
        // Rounding of logarithms.
        assert!((0..3).all(|k| (found[2][k] - viridis(0.5)[k]).abs() < 1e-5));
    }
}
