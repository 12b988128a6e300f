//! The filters of FLIP. All are products of one-dimensional ones, or sums of two such products; the picture's edge
//! is repeated outward.

use std::f64::consts::PI;

/// One number for each pixel.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    /// Width and height.
    pub size: [usize; 2],
    /// Row by row.
    pub values: Vec<f64>,
}

/// Odd number of weights, the middle one at the pixel.
#[derive(Debug, Clone)]
pub struct Kernel(Vec<f64>);

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
    pub fn feature(deviation: f64) -> [Kernel; 3] {
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
pub fn blurred(plane: &Plane, k: usize, pixels_per_degree: f64) -> Plane {
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
    pub fn new(size: [usize; 2], values: Vec<f64>) -> Plane {
        assert_eq!(values.len(), size[0] * size[1], "a value for each pixel");
        Plane { size, values }
    }

    /// Filtered along the rows.
    pub fn along_x(&self, kernel: &Kernel) -> Plane {
        let width = self.size[0];
        let values = self.values.chunks(width.max(1)).flat_map(|row| filtered(row, kernel)).collect();
        Plane { values, ..*self }
    }

    /// Filtered along the columns.
    pub fn along_y(&self, kernel: &Kernel) -> Plane {
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
