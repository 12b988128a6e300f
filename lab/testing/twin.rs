//! Trial of a 32-bit twin: inputs spread over its ranges, and the error as a share of what is allowed.
//!
//! Used by the tests of the vector lanes and of the shaders, so that both languages are held to one measure.

/// Most inputs of a twin.
pub const INPUTS: usize = 4;

/// Range of one input.
#[derive(Debug, Clone, Copy)]
pub enum Range {
    /// Evenly between.
    Even(f64, f64),
    /// Evenly in the logarithm to base 10.
    Log(f64, f64),
}

/// The `i`th point of a sequence of low discrepancy (Roberts 2018) over the ranges, rounded to what 32 bits hold; inputs
/// without a range are 0.
pub fn inputs(ranges: &[Range], i: usize) -> [f64; INPUTS] {
    let mut row = [0.0; INPUTS];
    for (j, (x, range)) in row.iter_mut().zip(ranges).enumerate() {
        let u = (0.5 + 0.855_674_883_f64.powi(j as i32 + 1) * (i + 1) as f64).fract();
        let value = match *range {
            Range::Even(a, b) => a + (b - a) * u,
            Range::Log(a, b) => 10f64.powf(a + (b - a) * u),
        };
        *x = f64::from(value as f32);
    }
    row
}

/// |found − truth| by `tolerance` · ε (4 + k) |truth|, ε that of 32 bits; k is how much the truth changes, relatively, when
/// each of the first `count` inputs changes by a relative ε, measured with 1e-6. ∞ for what is not a number.
pub fn error_ratio(
    truth: impl Fn(&[f64; INPUTS]) -> f64,
    x: &[f64; INPUTS],
    count: usize,
    found: f32,
    tolerance: f64,
) -> f64 {
    let value = truth(x);
    let change: f64 = (0..count)
        .map(|j| {
            let mut y = *x;
            y[j] *= 1.0 + 1e-6;
            (truth(&y) - value).abs() / 1e-6
        })
        .sum();
    let allowed = tolerance * f64::from(f32::EPSILON) * (4.0 * value.abs() + change) + 1e-30;
    let ratio = (f64::from(found) - value).abs() / allowed;
    if ratio.is_nan() { f64::INFINITY } else { ratio }
}
