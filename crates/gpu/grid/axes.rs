//! Storage of values on the device: about the place that the transfer function counts them from, so that a widget
//! far narrower than the range loses nothing.

use crate::grid::device_grid::DeviceArray;
use crate::grid::double_single::split;
use voltet_core::transfer::TransferFunction;
use voltet_shaders::Axis;

/// The numbers that the device counts a value from, in units of its span from its middle: high and low part.
pub(crate) fn offset_parts(stored: &DeviceArray, axis: &Axis) -> [f32; 2] {
    split((axis.offset - stored.middle) / stored.span)
}

/// The axis of a value. `number`: 0 for s, 1 for g, further on for fields.
pub(crate) fn axis(stored: &DeviceArray, transfer_function: &TransferFunction, number: usize) -> Axis {
    let centre = transfer_function.axis_origin(number);
    let [low, high] = stored.range();
    // Just beside the values serves, too: widths are counted from 0, however small the least of them.
    let near = low - stored.span..=high + stored.span;
    let offset = centre.filter(|centre| near.contains(centre)).unwrap_or(stored.middle);
    Axis { offset, scale: stored.span }
}
