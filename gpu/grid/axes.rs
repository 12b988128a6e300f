//! How values are stored on the device: about the place that the transfer function counts them from, so that a widget
//! far narrower than the range loses nothing.

use crate::grid::uploaded::Stored;
use voltet_core::transfer::TransferFunction;
use voltet_shaders::Axis;

/// The numbers that the device counts a value from, in units of its span from its middle: high and low part.
pub(crate) fn offset_parts(stored: &Stored, axis: &Axis) -> [f32; 2] {
    split((axis.offset - stored.middle) / stored.span)
}

/// A number as the sum of two of 32 bits.
pub(crate) fn split(x: f64) -> [f32; 2] {
    let high = x as f32;
    [high, (x - f64::from(high)) as f32]
}

/// The axis of a value. `number`: 0 for s, 1 for g, further on for fields.
pub(crate) fn axis(stored: &Stored, transfer_function: &TransferFunction, number: usize) -> Axis {
    let centre = transfer_function.axis_origin(number);
    let [low, high] = stored.range();
    let offset = centre.filter(|centre| (low..=high).contains(centre)).unwrap_or(stored.middle);
    Axis { offset, scale: stored.span }
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
