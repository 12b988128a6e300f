//! `gaussian-nd` in WGSL.

use super::gaussian::snippets_of_path;
use super::snippets::WidgetSnippets;
use crate::segment_extent::{SegmentExtent, check_widths};
use crate::writer::{Writer, finite};
use voltet_core::Result;

pub(super) fn snippets(count: usize, constant_emitter: bool) -> WidgetSnippets {
    snippets_of_path("gaussian_nd/widget", "gaussian_fields", &format!("{count}u, "), constant_emitter)
}

/// Numbers of one over so many fields.
pub(super) fn number_count(fields: usize) -> usize {
    (2 + fields) * fields
}

/// Numbers: where the fields lie among a segment's values, the centre, K row by row.
pub(super) fn write(
    fields: &[String],
    centre: &[f64],
    matrix: &[Vec<f64>],
    writer: &mut Writer,
) -> Result<()> {
    let places: Vec<usize> = fields.iter().map(|name| writer.field(name)).collect();
    for &place in &places {
        writer.numbers.push(writer.value_of_field(place) as f32);
    }
    for (&place, &centre) in places.iter().zip(centre) {
        writer.numbers.push(finite("the centre", writer.axis(place).stored(centre))?);
    }
    for row in matrix {
        for (&place, k) in places.iter().zip(row) {
            writer.numbers.push(finite("the matrix", k * writer.axis(place).scale)?);
        }
    }
    Ok(())
}

pub(super) fn check_32_bits(fields: &[String], matrix: &[Vec<f64>], extent: &SegmentExtent) -> Result<()> {
    let spans: Vec<f64> = fields.iter().map(|name| extent.span_of(name)).collect();
    check_widths(matrix.iter().map(|row| row.iter().zip(&spans).map(|(k, span)| (k * span).abs()).sum()))
}
