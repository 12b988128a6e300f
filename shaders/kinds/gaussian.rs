//! `gaussian` in WGSL: of s alone, and over the (s, g) plane.

use super::snippets::{ANY_RATE, Light, Mixing, Snippet, WidgetSnippets, light_of_rates};
use crate::segment_extent::{SegmentExtent, check_widths};
use crate::writer::{WidgetRecord, Writer, all_finite};
use voltet_core::Result;

/// True if K looks at s alone.
pub(super) fn is_line(matrix: &[[f64; 2]; 2]) -> bool {
    matrix[0][1] == 0.0 && matrix[1][1] == 0.0
}

pub(super) fn line_snippets(constant_emitter: bool) -> WidgetSnippets {
    snippets_of_path("gaussian/widget_line", "gaussian_line", "", constant_emitter)
}

pub(super) fn plane_snippets(constant_emitter: bool) -> WidgetSnippets {
    snippets_of_path("gaussian/widget_plane", "gaussian_plane", "", constant_emitter)
}

/// Snippets of a profile with a path through a Gaussian: `piece` holds the functions `stem`_whole and `stem`_inside, whose arguments
/// before the part are the widget's number and `count`.
pub(super) fn snippets_of_path(
    piece: &'static str,
    stem: &str,
    count: &str,
    constant_emitter: bool,
) -> WidgetSnippets {
    let inside = format!("{stem}_inside(#u, {count}part_#)");
    let whole = format!("{stem}_whole(#u, {count}part_#)");
    let with = |other: &'static str, text: String| Snippet::new(&[piece, other], text);
    WidgetSnippets {
        depth: with("gaussian/depth", format!("gaussian_depth(#u, part_#, {inside})")),
        light: match constant_emitter {
            false => Light::of_density(),
            true => Light::Closed(with("gaussian/light", format!("gaussian_light(#u, part_#, {inside})"))),
        },
        track: with("gaussian/track", format!("gaussian_track({whole}, widget_rate(#u, part_#))")),
        track_type: "GaussianTrack",
        next_break: "gaussian_next_break(members.track_#, t)".into(),
        member_light: light_of_rates("gaussian/track", "gaussian_rates"),
        window: Some(with("gaussian/path", format!("gaussian_window_ends({whole}, scene.level)"))),
        threshold: ANY_RATE,
        mixing: Mixing::Bounded,
    }
}

/// matrix: K for stored values; centre as values are stored.
pub(super) fn write(
    centre: &[f64; 2],
    matrix: &[[f64; 2]; 2],
    writer: &mut Writer,
    record: &mut WidgetRecord,
) -> Result<()> {
    let ([s, g], one_row) = (writer.plane(), is_line(matrix));
    let rows = if one_row {
        [matrix[0][0].hypot(matrix[1][0]) * s.scale, 0.0, 0.0, 0.0]
    } else {
        let [[a, b], [c, d]] = *matrix;
        [a * s.scale, b * g.scale, c * s.scale, d * g.scale]
    };
    record.matrix = all_finite("the matrix", rows)?;
    let centre = [s.stored(centre[0]), if one_row { 0.0 } else { g.stored(centre[1]) }];
    record.centre = all_finite("the centre", centre)?;
    Ok(())
}

pub(super) fn check_32_bits(matrix: &[[f64; 2]; 2], extent: &SegmentExtent) -> Result<()> {
    let spans = [0, 1].map(|axis| extent.span(axis));
    check_widths(matrix.iter().map(|row| (row[0] * spans[0]).abs() + (row[1] * spans[1]).abs()))
}
