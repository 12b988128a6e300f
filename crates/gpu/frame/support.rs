//! Supports of widgets, in slabs low ≤ a s + b g ≤ high of stored values, for the device to leave out the cells that none
//! touches.
//!
//! A cell is kept if for some support its corners reach every slab. That is less sharp than the native engine's hulls,
//! and as safe: what is left out adds less than 1e-7 of optical depth along the grid's diagonal.

use voltet_core::transfer::{Slab, TransferFunction, Widget};
use voltet_shaders::Axis;

/// Optical depth that all cells left out together may have along the longest ray.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// The supports of a transfer function as the shader reads them: where each one's slabs begin and the last one's end,
/// then four numbers a slab. And how many supports there are.
pub(crate) fn supports(transfer_function: &TransferFunction, axes: &[Axis], length: f64) -> (Vec<u32>, u32) {
    let share = DEPTH_LEFT_OUT / transfer_function.widgets.len().max(1) as f64;
    let longest = length / transfer_function.unit_distance;
    let of = |widget: &Widget| widget.slabs(longest * widget.peak(), share, transfer_function.model);
    let supports: Vec<Vec<Slab>> = transfer_function.widgets.iter().flat_map(of).collect();
    let axis = |k: usize| axes.get(k).map_or([0.0, 1.0], |axis| [axis.offset, axis.scale]);
    let axes = [axis(0), axis(1)];
    let (mut starts, mut numbers) = (vec![0u32], Vec::new());
    for slabs in &supports {
        numbers.extend(slabs.iter().flat_map(|slab| slab.stored(axes)));
        starts.push(numbers.len() as u32 / 4);
    }
    let count = supports.len() as u32;
    starts.extend(numbers.iter().map(|x: &f32| x.to_bits()));
    (starts, count)
}

/// One support that holds every cell.
pub(crate) fn everywhere() -> (Vec<u32>, u32) {
    (vec![0, 0], 1)
}
