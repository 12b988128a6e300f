//! `triangular-gaussian-nd` in WGSL.

use super::snippets::{Snippet, WidgetSnippets};
use super::{gaussian_nd, triangular_gaussian};
use crate::writer::{Writer, finite};
use voltet_core::Result;

pub(super) fn snippets(count: usize, constant_emitter: bool) -> WidgetSnippets {
    let call = |function: &str| {
        Snippet::new(&["triangular_gaussian_nd/widget"], format!("{function}(#u, {count}u, part_#)"))
    };
    WidgetSnippets {
        depth: call("triangular_fields_depth"),
        track: call("triangular_fields_track"),
        window: Some(Snippet::new(
            &["triangular_gaussian_nd/widget"],
            format!("triangular_fields_window(#u, {count}u, part_#, scene.level)"),
        )),
        ..triangular_gaussian::snippets(constant_emitter)
    }
}

/// Numbers of one over so many fields.
pub(super) fn number_count(fields: usize) -> usize {
    gaussian_nd::number_count(fields) + 2
}

/// Numbers: those of a Gaussian over the fields, K for widths of stored m; where m lies among a segment's values, m = 0 as
/// it is stored.
pub(super) fn write(
    fields: &[String],
    magnitude: &str,
    centre: &[f64],
    matrix: &[Vec<f64>],
    writer: &mut Writer,
) -> Result<()> {
    let place = writer.field(magnitude);
    let axis = writer.axis(place);
    let matrix: Vec<Vec<f64>> =
        matrix.iter().map(|row| row.iter().map(|k| k / axis.scale).collect()).collect();
    gaussian_nd::write(fields, centre, &matrix, writer)?;
    writer.numbers.push(writer.value_of_field(place) as f32);
    writer.numbers.push(finite("the magnitude's origin", axis.stored(0.0))?);
    Ok(())
}
