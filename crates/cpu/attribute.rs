//! Attributes: the point arrays that widgets, light and silhouettes read, scaled for 32 bits.

use crate::selection::CellSelection;
use voltet_core::grid::extent;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result, counted};

/// A point array scaled so that the grid's values lie within about −½ … ½. Scales are powers of two: a value of few
/// binary digits is stored as it is, and lies on the edge of a region where it lies on it in 64 bits.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Attribute<'a> {
    /// Values of the points, `stride` apart.
    pub values: &'a [f64],
    /// Distance between the values of two points.
    pub stride: usize,
    /// Stored value = (value − offset) / scale.
    pub offset: f64,
    /// See `offset`; > 0.
    pub scale: f64,
    /// The least and the greatest value.
    pub range: [f64; 2],
}

/// Difference of a range's ends; finite.
fn span([low, high]: [f64; 2]) -> f64 {
    (high - low).min(f64::MAX)
}

impl Attribute<'_> {
    /// Difference of the greatest and the least value; finite.
    pub fn span(&self) -> f64 {
        span(self.range)
    }

    /// Value of a point, not scaled.
    #[inline(always)]
    pub fn at(&self, point: usize) -> f64 {
        self.values[point * self.stride]
    }
}

/// Attributes of a picture at most: s, g, the further fields and the gradient.
pub(crate) const MAX_ATTRIBUTES: usize = 16;

/// Further fields of a picture at most.
const MAX_FIELDS: usize = MAX_ATTRIBUTES - 5;

/// Point arrays that the transfer function reads, s first, then g, then the further fields, scaled to
/// about −½ … ½.
pub(crate) fn attributes_of<'a>(
    cells: &'a CellSelection,
    transfer_function: &TransferFunction,
) -> Result<Vec<Attribute<'a>>> {
    let volume = &cells.volume;
    let fields = transfer_function.fields();
    if fields.len() > MAX_FIELDS {
        return Err(Error::usage("the widgets read more point arrays than a picture can be drawn from")
            .got(format!("{} beside s and g", fields.len()))
            .expected(format!("at most {MAX_FIELDS}")));
    }
    let active = cells.active_widgets(transfer_function);
    let has_edges = active.widgets.iter().any(|widget| widget.region.is_some());
    let about = |axis: usize| {
        let origin = if cells.centered_ranges { None } else { active.axis_origin(axis) };
        origin.map(|centre| (centre, has_edges))
    };
    let axes = transfer_function.axes_read();
    let on_axis = |number: usize, values| match axes[number].is_curved() {
        true => from_zero(values, cells.ranges[number]),
        false => attribute(values, cells.ranges[number], about(number)),
    };
    let mut attributes = vec![on_axis(0, &volume.scalar)];
    if transfer_function.uses_gradient_magnitude() || !fields.is_empty() {
        match &volume.gradient_magnitude {
            Some(g) => attributes.push(on_axis(1, g)),
            None if transfer_function.uses_gradient_magnitude() => {
                return Err(Error::usage(
                    "the transfer function reads the gradient magnitude, and the volume has none",
                )
                .expected("a gradient-magnitude node before this one"));
            }
            // The further fields stand behind g.
            None => attributes.push(attribute(&volume.scalar, cells.ranges[0], None)),
        }
    }
    for (i, name) in fields.into_iter().enumerate() {
        let values = volume.grid.field("the transfer function", name)?;
        let range = match &cells.whole {
            Some(whole) => whole.fields.get(i).copied().filter(|[low, high]| low <= high),
            None => extent::range(&values[..volume.grid.drawn_points().min(values.len())]),
        };
        attributes.push(attribute(values, range.unwrap_or_default(), about(2 + i)));
    }
    Ok(attributes)
}

/// Attributes as widgets see them: s and g as positions, where their axes are curved.
pub(crate) fn on_axes<'a>(
    attributes: &[Attribute<'a>],
    transfer_function: &TransferFunction,
) -> Vec<Attribute<'a>> {
    let axes = transfer_function.axes_read();
    let has_edges = transfer_function.widgets.iter().any(|widget| widget.region.is_some());
    let mut found = attributes.to_vec();
    for (number, (own, scale)) in
        found.iter_mut().zip(axes).enumerate().filter(|(_, (_, scale))| scale.is_curved())
    {
        let range = scale.positions(own.range);
        // Nothing is drawn of values none of which has a position.
        let range = if range.iter().all(|u| u.is_finite()) { range } else { [0.0, 1.0] };
        let about = transfer_function.axis_origin(number).map(|centre| (centre, has_edges));
        *own = attribute(own.values, range, about);
    }
    found
}

/// Values of a curved axis: counted from 0, since small ones matter.
fn from_zero(values: &[f64], [low, high]: [f64; 2]) -> Attribute<'_> {
    let largest = low.abs().max(high.abs());
    let scale = if largest > 0.0 { largest.log2().ceil().clamp(-1022.0, 1023.0).exp2() } else { 1.0 };
    Attribute { values, stride: 1, offset: 0.0, scale, range: [low, high] }
}

/// Components of the gradient as attributes, for light and silhouettes: no offset and one scale, so that small
/// gradients keep their direction.
pub(crate) fn gradient_attributes(cells: &CellSelection) -> Result<Vec<Attribute<'_>>> {
    let volume = &cells.volume;
    let gradient = volume.gradient.as_ref().filter(|g| g.len() == volume.grid.points.len());
    let Some(gradient) = gradient else {
        let count = volume.gradient.as_ref().map_or(0, |g| g.len());
        return Err(Error::usage("light and silhouettes need a gradient at every point")
            .got(format!("{} at {}", counted(count, "gradient"), counted(volume.grid.points.len(), "point")))
            .expected("a gradient-magnitude node before this one"));
    };
    let scale = if cells.max_gradient > 0.0 { cells.max_gradient } else { 1.0 };
    let values: &[f64] = bytemuck::cast_slice(gradient);
    Ok((0..3)
        .map(|i| Attribute {
            values: values.get(i..).unwrap_or(&[]),
            stride: 3,
            offset: 0.0,
            scale,
            range: [-scale, scale],
        })
        .collect())
}

/// `about`: the centre that values are counted from if it is among them, and whether widgets have edges there.
fn attribute(values: &[f64], [low, high]: [f64; 2], about: Option<(f64, bool)>) -> Attribute<'_> {
    let span = span([low, high]);
    // A constant field: any scale will do. The largest power of two is 2^1023.
    let scale = if span > 0.0 { span.log2().ceil().min(1023.0).exp2() } else { 1.0 };
    let middle = low + 0.5 * span;
    // With edges the offset must not add digits to the values; so near the centre 45 bits of the range are left.
    let coarse = |centre: f64| (centre / scale * OFFSET_STEPS).round() / OFFSET_STEPS * scale;
    let offset = match about {
        // Just beside the values is near enough: widths are counted from 0, however small the least of them.
        Some((centre, has_edges)) if (low - span..=high + span).contains(&centre) => {
            Some(coarse(centre)).filter(|offset| has_edges && offset.is_finite()).unwrap_or(centre)
        }
        _ => middle,
    };
    Attribute { values, stride: 1, offset, scale, range: [low, high] }
}

/// Steps of an offset by the scale, where widgets have edges.
const OFFSET_STEPS: f64 = (1 << 20) as f64;
