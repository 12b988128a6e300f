//! Where widgets lie, in slabs low ≤ a s + b g ≤ high of stored values, for the device to leave out the cells that none
//! touches.
//!
//! A cell is kept if for some support its corners reach every slab. That is less sharp than the native engine's hulls,
//! and as safe: what is left out adds less than 1e-7 of optical depth along the grid's diagonal.

use voltet_core::transfer::{Slab, TransferFunction, Widget};
use voltet_shaders::Axis;

/// Optical depth that all cells left out together may have along the longest ray.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// Room for the rounding of stored values and of the slabs themselves, in units of a value's span: 32 bits leave 1e-7.
const SLACK: f64 = 1e-6;

/// The supports of a transfer function as the shader reads them: where each one's slabs begin and the last one's end,
/// then four numbers a slab. And how many supports there are.
pub(crate) fn supports(transfer_function: &TransferFunction, axes: &[Axis], length: f64) -> (Vec<u32>, u32) {
    let share = DEPTH_LEFT_OUT / transfer_function.widgets.len().max(1) as f64;
    let longest = length / transfer_function.unit_distance;
    let of = |widget: &Widget| widget.slabs(longest * widget.peak(), share, transfer_function.model);
    let supports: Vec<Vec<Slab>> = transfer_function.widgets.iter().flat_map(of).collect();
    let (mut starts, mut numbers) = (vec![0u32], Vec::new());
    for slabs in &supports {
        numbers.extend(slabs.iter().flat_map(|slab| stored(slab, axes)));
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

/// A slab in stored values, widened by what rounding can do.
fn stored(slab: &Slab, axes: &[Axis]) -> [f32; 4] {
    let Slab { normal, low, high } = slab;
    let [a, b] = [0, 1].map(|k| normal[k] * axes[k].scale);
    let largest = a.abs().max(b.abs());
    if largest == 0.0 || !largest.is_finite() {
        return [0.0, 0.0, -1.0, 1.0];
    }
    let moved = |k: usize| if normal[k] == 0.0 { 0.0 } else { normal[k] * axes[k].offset };
    let offset = moved(0) + moved(1);
    // What cancels here lost digits of the offset: they widen the slab.
    let slack = SLACK + 4.0 * f64::EPSILON * (moved(0).abs() + moved(1).abs()) / largest;
    let bound = |x: f64, sign: f64| {
        let x = (x - offset) / largest + sign * slack;
        (x + sign * SLACK * x.abs()).clamp(-1e30, 1e30) as f32
    };
    [(a / largest) as f32, (b / largest) as f32, bound(*low, -1.0), bound(*high, 1.0)]
}
