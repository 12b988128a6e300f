//! Double-single numbers: a high and a low part of 32 bits.

/// A number as the sum of two of 32 bits.
pub(crate) fn split(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_parts_hold_a_number_to_48_bits() {
        for x in [0.1, -1.0 / 3.0, 1e-9, 0.5] {
            let [high, low] = split(x).map(f64::from);
            assert!((high + low - x).abs() <= x.abs() * 2f64.powi(-47), "{x}");
        }
    }
}
