//! A list of segments as the compositor [`crate::CompositorProgram::Segments`] reads it, and what it gives back: for judging the
//! formulas, which needs every digit that 32 bits hold.
//!
//! A segment alone is stored about one origin, so that its values lose nothing; a grid is stored about the middle of its
//! range.

use crate::kinds::Spans;
use crate::parameters::check_32_bits;
use crate::shader_key::{Combine, ShaderKey};
use crate::text::Shader;
use crate::writer::Axis;
use voltet_core::Result;
use voltet_core::transfer::{AxisOrigin, TransferFunction, Widget};
use voltet_optics::{Contribution, Segment};

/// Numbers of a contribution: r, g, b, A, T, and what its alignment adds.
pub const CONTRIBUTION: usize = 8;

/// The one place that all differences of a scene are taken from, if there is one: [s, g], then the fields.
pub fn origin(widgets: &[Widget]) -> Option<Vec<f64>> {
    let [widget] = widgets else { return None };
    if widget.region.is_some() {
        return None;
    }
    let properties = widget.profile.properties();
    if let Some(bands) = properties.bands {
        return Some(bands.origin.to_vec());
    }
    let place = |axis: &AxisOrigin| match axis {
        AxisOrigin::Centre(centre) => *centre,
        AxisOrigin::Any | AxisOrigin::Zero => 0.0,
    };
    let is_centred = properties.axes.iter().any(|axis| matches!(axis, AxisOrigin::Centre(_)));
    is_centred.then(|| properties.axes.iter().map(place).collect())
}

/// [s, g] and the fields at both ends.
fn ends(segment: &Segment) -> [Vec<f64>; 2] {
    [[&segment.front, segment.fields_front].concat(), [&segment.back, segment.fields_back].concat()]
}

/// Axes for one segment alone: values about the origin, at most 1 and with all their digits, since scales are powers of
/// two.
pub fn axes(transfer_function: &TransferFunction, segment: &Segment) -> Vec<Axis> {
    let origin = origin(&transfer_function.widgets).unwrap_or_default();
    let [front, back] = ends(segment);
    let axis = |a: usize| {
        let offset = origin.get(a).copied().unwrap_or(0.0);
        let size = (front[a] - offset).abs().max((back[a] - offset).abs());
        let scale = if size > 0.0 { size.log2().ceil().exp2() } else { 1.0 };
        Axis { offset, scale }
    };
    (0..2 + transfer_function.fields().len()).map(axis).collect()
}

/// Checks that 32 bits hold the segment; see [`check_32_bits`].
pub fn holds(shader_key: &ShaderKey, transfer_function: &TransferFunction, segment: &Segment) -> Result<()> {
    let [front, back] = ends(segment);
    let values: Vec<f64> = front.iter().zip(&back).map(|(a, b)| (b - a).abs()).collect();
    check_32_bits(shader_key, transfer_function, &Spans { values: &values, longest: segment.length })
}

/// The numbers of a segment: D in units of `length`, then the values that the shader reads at both ends, as the axes store
/// them.
pub fn row(shader_key: &ShaderKey, axes: &[Axis], length: f64, segment: &Segment) -> Vec<f32> {
    let mut row = vec![(segment.length / length) as f32];
    for values in ends(segment) {
        let read = |a: usize| match a {
            0 => true,
            1 => shader_key.reads_gradient_magnitude,
            _ => a - 2 < shader_key.field_count,
        };
        for (a, axis) in axes.iter().enumerate().filter(|(a, _)| read(*a)) {
            row.push(axis.stored(values[a]) as f32);
        }
    }
    row
}

/// Constants for a shader whose channels are judged one by one: no product of depths is too small for the order of widgets.
pub fn constants(shader_key: &ShaderKey, shader: &Shader) -> &'static [(&'static str, f64)] {
    let ordered = shader_key.combine == Combine::Ordered && shader.text.contains("order_threshold");
    if ordered { &[("order_threshold", 0.0)] } else { &[] }
}

/// Contributions from the values read back.
pub fn contributions(found: &[f32]) -> Vec<Contribution> {
    let contribution = |found: &[f32]| {
        let [red, green, blue, opacity, optical_depth] = std::array::from_fn(|i| f64::from(found[i]));
        Contribution { optical_depth, color: [red, green, blue], opacity }
    };
    found.chunks_exact(CONTRIBUTION).map(contribution).collect()
}
