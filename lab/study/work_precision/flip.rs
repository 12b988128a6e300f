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

use glam::{DMat3, DVec3};
use std::f64::consts::PI;
use voltet_core::picture::Picture;

/// Pixels per degree: 0.7 m × 3840 pixels / 0.7 m × π/180.
const PIXELS_PER_DEGREE: f64 = 3840.0 * PI / 180.0;

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
        let lab = |i: usize| {
            let rgb = linear_rgb([y.values[i], cx.values[i], cz.values[i]]);
            hunt_lab(rgb.map(|x| x.clamp(0.0, 1.0)))
        };
        let lab = (0..opponent.len()).map(lab).collect();
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

/// Linear sRGB.
type Rgb = [f64; 3];

/// Linear sRGB to XYZ, with the primaries and the white (D65) of IEC 61966-2-1 worked out as fractions; by columns.
const XYZ_FROM_RGB: DMat3 = DMat3::from_cols_array(&[
    10135552.0 / 24577794.0,
    2613072.0 / 12288897.0,
    1425312.0 / 73733382.0,
    8788810.0 / 24577794.0,
    8788810.0 / 12288897.0,
    8788810.0 / 73733382.0,
    4435075.0 / 24577794.0,
    887015.0 / 12288897.0,
    70074185.0 / 73733382.0,
]);

fn white() -> DVec3 {
    XYZ_FROM_RGB * DVec3::ONE
}

/// Linear RGB to YCxCz.
fn ycxcz(rgb: Rgb) -> [f64; 3] {
    let [x, y, z] = (XYZ_FROM_RGB * DVec3::from(rgb) / white()).to_array();
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

fn linear_rgb([y, cx, cz]: [f64; 3]) -> Rgb {
    let y = lightness(y);
    let relative = DVec3::new(y + cx / 500.0, y, y - cz / 200.0);
    (XYZ_FROM_RGB.inverse() * (relative * white())).to_array()
}

/// Y of YCxCz, −16 … 100, as 0 … 1.
fn lightness(y: f64) -> f64 {
    (y + 16.0) / 116.0
}

/// Linear RGB to L*, and a*, b* scaled by 0.01 L* (Hunt: colours of dark places look less colourful).
fn hunt_lab(rgb: Rgb) -> [f64; 3] {
    const D: f64 = 6.0 / 29.0;
    let f = |t: f64| if t > D.powi(3) { t.cbrt() } else { t / (3.0 * D * D) + 4.0 / 29.0 };
    let [x, y, z] = (XYZ_FROM_RGB * DVec3::from(rgb) / white()).to_array().map(f);
    let l = 116.0 * y - 16.0;
    [l, 0.01 * l * 500.0 * (x - y), 0.01 * l * 200.0 * (y - z)]
}

/// HyAB (Abasi, Tehran, Fairchild 2020).
fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).abs() + (a[1] - b[1]).hypot(a[2] - b[2])
}

/// The distance of pure green and pure blue, the largest there is.
fn largest_distance() -> f64 {
    distance(hunt_lab([0.0, 1.0, 0.0]), hunt_lab([0.0, 0.0, 1.0]))
}

#[derive(Debug, Clone, PartialEq)]
struct Plane {
    /// Width and height.
    size: [usize; 2],
    values: Vec<f64>,
}

/// Odd number of weights, the middle one at the pixel.
#[derive(Debug, Clone)]
struct Kernel(Vec<f64>);

impl Kernel {
    fn sampled(radius: usize, weight: impl Fn(f64) -> f64) -> Kernel {
        let radius = radius as i64;
        Kernel((-radius..=radius).map(|x| weight(x as f64)).collect())
    }

    fn sum(&self) -> f64 {
        self.0.iter().sum()
    }

    /// Positive weights sum to 1, negative ones to −1.
    fn balanced(self) -> Kernel {
        let part = |sign: f64| self.0.iter().map(|w| (w * sign).max(0.0)).sum::<f64>();
        let (positive, negative) = (part(1.0), part(-1.0));
        let scale = |w: f64| if w < 0.0 { w / negative } else { w / positive };
        Kernel(self.0.iter().map(|&w| if w == 0.0 { 0.0 } else { scale(w) }).collect())
    }

    /// A Gaussian of this deviation in pixels, its first derivative (edges) and its second one (points).
    fn feature(deviation: f64) -> [Kernel; 3] {
        let radius = (3.0 * deviation).ceil() as usize;
        let gaussian = |x: f64| (-x * x / (2.0 * deviation * deviation)).exp();
        [
            Kernel::sampled(radius, gaussian).balanced(),
            Kernel::sampled(radius, |x| -x * gaussian(x)).balanced(),
            Kernel::sampled(radius, |x| ((x / deviation).powi(2) - 1.0) * gaussian(x)).balanced(),
        ]
    }
}

/// Contrast sensitivity of Y, Cx, Cz: sums of Gaussians a √(π/b) exp(−π² x²/b), x in degrees, as [a, b] (Table 1 of
/// the paper). A second one of a = 0 is left out.
const SENSITIVITY: [&[[f64; 2]]; 3] = [&[[1.0, 0.0047]], &[[1.0, 0.0053]], &[[34.1, 0.04], [13.5, 0.025]]];

/// The largest b of the table: the reach of all three filters is three deviations of that Gaussian.
const WIDEST: f64 = 0.04;

/// Channel `k` of YCxCz as the eye resolves it at this many pixels per degree.
fn blurred(plane: &Plane, k: usize, pixels_per_degree: f64) -> Plane {
    let radius = (3.0 * (WIDEST / (2.0 * PI * PI)).sqrt() * pixels_per_degree).ceil() as usize;
    let mut sum = Plane { values: vec![0.0; plane.values.len()], ..*plane };
    let mut weight = 0.0;
    for [a, b] in SENSITIVITY[k] {
        let kernel = Kernel::sampled(radius, |x| (-(PI * x / pixels_per_degree).powi(2) / b).exp());
        let share = a * (PI / b).sqrt();
        weight += share * kernel.sum().powi(2);
        let part = plane.along_x(&kernel).along_y(&kernel);
        sum.values.iter_mut().zip(&part.values).for_each(|(sum, part)| *sum += share * part);
    }
    sum.values.iter_mut().for_each(|value| *value /= weight);
    sum
}

impl Plane {
    /// `values`: width × height of them.
    fn new(size: [usize; 2], values: Vec<f64>) -> Plane {
        assert_eq!(values.len(), size[0] * size[1], "a value for each pixel");
        Plane { size, values }
    }

    /// Filtered along the rows.
    fn along_x(&self, kernel: &Kernel) -> Plane {
        let width = self.size[0];
        let values = self.values.chunks(width.max(1)).flat_map(|row| filtered(row, kernel)).collect();
        Plane { values, ..*self }
    }

    /// Filtered along the columns.
    fn along_y(&self, kernel: &Kernel) -> Plane {
        self.transposed().along_x(kernel).transposed()
    }

    fn transposed(&self) -> Plane {
        let [width, height] = self.size;
        let values = (0..width).flat_map(|i| (0..height).map(move |j| self.values[j * width + i])).collect();
        Plane { size: [height, width], values }
    }
}

/// Σ_k w(k) row(i + k), as the paper's filters are laid over the picture; rows end as they end.
fn filtered(row: &[f64], Kernel(weights): &Kernel) -> Vec<f64> {
    let radius = weights.len() / 2;
    let (Some(&first), Some(&last)) = (row.first(), row.last()) else { return Vec::new() };
    let mut wide = vec![first; radius];
    wide.extend_from_slice(row);
    wide.resize(row.len() + 2 * radius, last);
    wide.windows(weights.len()).map(|part| part.iter().zip(weights).map(|(x, w)| x * w).sum()).collect()
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

    fn close(a: [f64; 3], b: [f64; 3], tolerance: f64) {
        assert!((0..3).all(|k| (a[k] - b[k]).abs() < tolerance), "{a:?} {b:?}");
    }

    #[test]
    fn known_colours() {
        close(ycxcz([1.0; 3]), [100.0, 0.0, 0.0], 1e-12);
        close(ycxcz([0.0; 3]), [-16.0, 0.0, 0.0], 1e-12);
        // Lindbloom's calculator: green is L*a*b* (87.735, −86.183, 83.180), blue (32.301, 79.188, −107.860); his white
        // has other digits behind the fourth.
        close(hunt_lab([0.0, 1.0, 0.0]), [87.735, -0.87735 * 86.183, 0.87735 * 83.180], 2e-2);
        close(hunt_lab([0.0, 0.0, 1.0]), [32.301, 0.32301 * 79.188, -0.32301 * 107.860], 2e-2);
        close(hunt_lab([1.0; 3]), [100.0, 0.0, 0.0], 1e-12);
        // 55.434 + 147.868 from those figures.
        assert!((largest_distance() - 203.302).abs() < 1e-2, "{}", largest_distance());
    }

    #[test]
    fn there_and_back() {
        for rgb in [[0.2, 0.5, 0.9], [1.0, 0.0, 0.0], [0.01, 0.02, 0.0]] {
            close(linear_rgb(ycxcz(rgb)), rgb, 1e-13);
        }
    }

    #[test]
    fn a_row_is_filtered_with_its_ends_repeated() {
        let kernel = Kernel(vec![0.25, 0.5, 0.25]);
        assert_eq!(filtered(&[4.0, 0.0, 8.0], &kernel), [3.0, 3.0, 6.0]);
        let plane = Plane::new([2, 3], vec![4.0, 1.0, 0.0, 1.0, 8.0, 1.0]);
        assert_eq!(plane.along_y(&kernel).values, [3.0, 1.0, 3.0, 1.0, 6.0, 1.0]);
    }

    #[test]
    fn blurs_keep_what_is_even_and_features_see_nothing_in_it() {
        let plane = Plane::new([30, 25], vec![7.0; 750]);
        for k in 0..3 {
            // Rounding of 21 × 21 products.
            assert!(blurred(&plane, k, 67.0).values.iter().all(|v| (v - 7.0).abs() < 1e-12));
        }
        let [smooth, edge, point] = Kernel::feature(2.75);
        assert!((smooth.sum() - 1.0).abs() < 1e-15 && edge.sum().abs() < 1e-15 && point.sum().abs() < 1e-15);
    }

    #[test]
    fn a_step_has_an_edge_of_its_height() {
        // A step of height 1 between columns: all positive or all negative weights see it.
        let values = (0..60).map(|i| f64::from(u8::from(i % 30 >= 15))).collect();
        let plane = Plane::new([30, 2], values);
        let [_, edge, _] = Kernel::feature(2.75);
        let strongest = plane.along_x(&edge).values.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        assert!((strongest - 1.0).abs() < 1e-12, "{strongest}");
    }
}
