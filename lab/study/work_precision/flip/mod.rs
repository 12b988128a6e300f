//! LDR-ꟻLIP, the difference that a person sees when two pictures are flipped: Andersson, Nilsson, Akenine-Möller,
//! Oskarsson, Åström, Fairchild, "FLIP: A Difference Evaluator for Alternating Images", Proceedings of the ACM on
//! Computer Graphics and Interactive Techniques 3(2), 2020.
//!
//! Both pictures are taken as shown: linear RGB in 0 … 1. For each pixel:
//!
//! 1. **Colour.** Into YCxCz; each channel blurred by what the eye resolves at p pixels per degree (contrast
//!    sensitivity, section 4.1); back into RGB, clamped, into CIE L*a*b* with a*, b* scaled by 0.01 L* (Hunt). The
//!    HyAB distance |ΔL*| + |(Δa*, Δb*)| to the power q_c = 0.7, mapped to 0 … 1 so that p_c = 0.4 of the largest
//!    distance (green to blue) goes to p_t = 0.95 and the rest is compressed above it: ΔE_c.
//! 2. **Features.** Edges and points of the lightness by first and second derivatives of a Gaussian of width
//!    w = 0.082 degrees (section 4.2): ΔE_f = (max(|Δ edges|, |Δ points|)/√2)^q_f, q_f = 0.5.
//! 3. ΔE = ΔE_c^(1 − ΔE_f).
//!
//! The value of a picture is the mean of ΔE over its pixels: 0 where both are equal, 1 at most. p = 67: a screen of
//! 3840 pixels and 0.7 m, seen from 0.7 m, as in the paper.

mod color;
mod filter;

use color::{Rgb, distance, hunt_lab, largest_distance, lightness, linear_rgb, ycxcz};
use filter::{Kernel, Plane, blurred};
use voltet_core::picture::Picture;

/// Pixels per degree: 0.7 m × 3840 pixels / 0.7 m × π/180.
pub const PIXELS_PER_DEGREE: f64 = 3840.0 * std::f64::consts::PI / 180.0;

const QC: f64 = 0.7;
const PC: f64 = 0.4;
const PT: f64 = 0.95;
const QF: f64 = 0.5;
const W_DEGREES: f64 = 0.082;

/// A picture made ready for comparisons.
#[derive(Debug, Clone)]
pub struct PreparedPicture {
    width: usize,
    /// Blurred, L*a*b* with Hunt's adjustment.
    lab: Vec<[f64; 3]>,
    /// Strength of edges and of points.
    features: Vec<[f64; 2]>,
}

impl PreparedPicture {
    /// The picture over a linear background, clamped to what a screen shows.
    pub fn new(picture: &Picture, background: [f64; 3]) -> PreparedPicture {
        let over = |pixel: &[f32; 4]| -> Rgb {
            std::array::from_fn(|k| {
                let value = f64::from(pixel[k]) + (1.0 - f64::from(pixel[3])) * background[k];
                // What is no number shows as black.
                if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
            })
        };
        let opponent: Vec<[f64; 3]> = picture.rgba.iter().map(|pixel| ycxcz(over(pixel))).collect();
        let size = [picture.width, picture.height];
        let channel = |k: usize| Plane::new(size, opponent.iter().map(|v| v[k]).collect());
        let [y, cx, cz] = [0, 1, 2].map(|k| blurred(&channel(k), k, PIXELS_PER_DEGREE));
        let lab = (0..opponent.len())
            .map(|i| {
                let rgb = linear_rgb([y.values[i], cx.values[i], cz.values[i]]);
                hunt_lab(rgb.map(|x| x.clamp(0.0, 1.0)))
            })
            .collect();
        PreparedPicture { width: picture.width, lab, features: features(&channel(0)) }
    }

    /// ΔE of every pixel against another picture of the same size.
    pub fn differences(&self, other: &PreparedPicture) -> Vec<f64> {
        assert_eq!((self.width, self.lab.len()), (other.width, other.lab.len()), "pictures of one size");
        let largest = largest_distance().powf(QC);
        let colors = self.lab.iter().zip(&other.lab).map(|(a, b)| redistributed(distance(*a, *b), largest));
        let features = self.features.iter().zip(&other.features).map(|(a, b)| {
            let change = (a[0] - b[0]).abs().max((a[1] - b[1]).abs());
            (std::f64::consts::FRAC_1_SQRT_2 * change).powf(QF).min(1.0)
        });
        colors.zip(features).map(|(color, feature)| color.powf(1.0 - feature)).collect()
    }

    /// The mean of ΔE.
    pub fn difference(&self, other: &PreparedPicture) -> f64 {
        let all = self.differences(other);
        all.iter().sum::<f64>() / all.len().max(1) as f64
    }
}

/// ΔE_c of a HyAB distance; `largest`: the largest distance to the power q_c.
fn redistributed(distance: f64, largest: f64) -> f64 {
    let (e, limit) = (distance.powf(QC), PC * largest);
    match e < limit {
        true => e * PT / limit,
        false => PT + (e - limit) / (largest - limit) * (1.0 - PT),
    }
}

/// Strength of edges and points of the lightness plane Y of YCxCz.
fn features(y: &Plane) -> Vec<[f64; 2]> {
    let deviation = 0.5 * W_DEGREES * PIXELS_PER_DEGREE;
    let normal = Plane { values: y.values.iter().map(|&v| lightness(v)).collect(), ..*y };
    let [smooth, edge, point] = Kernel::feature(deviation);
    let strength = |kernel: &Kernel| -> Vec<f64> {
        let along_x = normal.along_x(kernel).along_y(&smooth);
        let along_y = normal.along_x(&smooth).along_y(kernel);
        along_x.values.iter().zip(&along_y.values).map(|(x, y)| x.hypot(*y)).collect()
    };
    strength(&edge).into_iter().zip(strength(&point)).map(|(edge, point)| [edge, point]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn even(rgb: [f32; 3]) -> Picture {
        let [r, g, b] = rgb;
        Picture { width: 24, height: 20, rgba: vec![[r, g, b, 1.0]; 480] }
    }

    fn flip(a: &Picture, b: &Picture) -> f64 {
        PreparedPicture::new(a, [0.0; 3]).difference(&PreparedPicture::new(b, [0.0; 3]))
    }

    #[test]
    fn even_pictures_as_worked_by_hand() {
        // Black to white: no features; HyAB = ΔL* = 100, 100^0.7 = 25.1189. Green to blue, the largest distance:
        // L*a*b* (87.735, −86.183, 83.180) and (32.301, 79.188, −107.860), after Hunt a*b* of (−75.613, 72.978)
        // and (25.578, −34.840): 55.434 + 147.868 = 203.302, to the power 0.7 41.279. 0.4 of it, 16.512, goes to
        // 0.95, so black to white is 0.95 + (25.1189 − 16.512)/(41.279 − 16.512) × 0.05 = 0.96738.
        // Five digits of the hand's figures.
        assert!((flip(&even([0.0; 3]), &even([1.0; 3])) - 0.96738).abs() < 1e-5);
        assert!((flip(&even([0.0, 1.0, 0.0]), &even([0.0, 0.0, 1.0])) - 1.0).abs() < 1e-12);
        // Linear 0.18 is L* 49.496; linear 0.2, 51.837: 2.341^0.7 × 0.95/16.512 = 0.10435.
        assert!((flip(&even([0.18; 3]), &even([0.2; 3])) - 0.10435).abs() < 1e-4);
    }

    #[test]
    fn nothing_differs_from_itself_and_order_is_of_no_account() {
        let mut spotted = even([0.2, 0.4, 0.6]);
        spotted.rgba[250] = [1.0, 0.0, 0.0, 1.0];
        assert_eq!(flip(&spotted, &spotted), 0.0);
        let (there, back) = (flip(&spotted, &even([0.2, 0.4, 0.6])), flip(&even([0.2, 0.4, 0.6]), &spotted));
        assert!(there > 0.0 && there == back);
    }

    #[test]
    fn a_spot_is_seen_where_it_is() {
        let grey = even([0.2; 3]);
        let mut spotted = grey.clone();
        // Column 14 of row 12.
        spotted.rgba[302] = [0.4, 0.4, 0.4, 1.0];
        let map =
            PreparedPicture::new(&spotted, [0.0; 3]).differences(&PreparedPicture::new(&grey, [0.0; 3]));
        assert!(map[302] > 0.1, "{}", map[302]);
        // Beyond the reach of all filters, 10 pixels, there is the rounding of sums only.
        assert!(map[0] < 1e-6, "{}", map[0]);
    }

    #[test]
    fn a_background_is_seen_through_what_is_not_opaque() {
        let clear = Picture::transparent(24, 20);
        let background = [0.1, 0.5, 0.9];
        let on = PreparedPicture::new(&clear, background);
        // A float of 0.1 is off by 1e-9.
        assert!(on.difference(&PreparedPicture::new(&even([0.1, 0.5, 0.9]), [0.0; 3])) < 1e-5);
    }
}
