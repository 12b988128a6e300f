//! `table` in WGSL.

use super::snippets::{CUTOFF_RATE, Light, Mixing, Snippet, WidgetSnippets};
use crate::writer::{WidgetRecord, Writer, all_finite};
use voltet_core::Result;
use voltet_core::transfer::Table;

pub(super) fn snippets(constant_emitter: bool) -> WidgetSnippets {
    let cutoff = if constant_emitter { "scene.cutoff" } else { "-1.0" };
    WidgetSnippets {
        depth: Snippet::new(&["table/widget"], "table_depth(#u, part_#)"),
        light: Light::Integrated,
        track: Snippet::new(&["table/widget"], format!("table_track(#u, {cutoff}, part_#)")),
        track_type: "TableTrack",
        next_break: "table_next_break(members.track_#, t)".into(),
        member_light: Snippet::new(
            &["overlap/member_colors", "table/track"],
            "member_texels_light(members.member_#, table_texels(members.track_#, at), at, \
             members.track_#.peak)",
        ),
        window: None,
        threshold: CUTOFF_RATE,
        mixing: Mixing::Unbounded,
    }
}

/// Texel coordinates are factor × stored value + place of the stored 0, columns in matrix.xy, rows in matrix.zw; the texels
/// are those of `Resources`.
pub(super) fn write(table: &Table, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let [s, g] = writer.plane();
    let size = [table.width as f64, table.height as f64];
    let columns = size[0] / (table.s[1] - table.s[0]);
    let rows = size[1] / (table.g[1] - table.g[0]);
    let column = [columns * s.scale, (s.offset - table.s[0]) * columns - 0.5];
    let row = [-rows * g.scale, (table.g[1] - g.offset) * rows - 0.5];
    record.matrix = all_finite("a table's range", [column[0], column[1], row[0], row[1]])?;
    record.bell = [size[0] as f32, size[1] as f32, 0.0, 0.0];
    record.first_number = writer.texel_count;
    writer.texel_count += table.texels.len() as u32;
    Ok(())
}
