//! Diagnostics of a node from the counts of a picture, whatever engine counted them.

use super::order::record_unsorted;
use voltet_core::Result;
use voltet_graph::{Diagnostics, RunContext, SavedWork};
use voltet_optics::engine::RenderStats;
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;

/// Notes what was counted: of a whole picture, or of one stage.
pub(super) fn note(call: &mut RunContext, counts: &RenderStats) {
    let notes = &mut call.notes;
    let culled = counts.culled_by_transfer_function.zip(counts.culled_by_frustum).map(|(a, b)| a + b);
    for (name, count) in [
        ("cells_culled", culled),
        ("cells_projected", counts.cells_projected),
        ("segments", counts.segments),
        ("segments_exact", counts.segments_exact),
        ("evaluations", counts.evaluations),
        ("pixels_disordered", counts.pixels_disordered),
        ("tiles_stopped", counts.tiles_stopped),
        ("tables_built", counts.tables_built),
    ] {
        notes.counts.extend(count.map(|count| (name, count)));
    }
    record_skipped_cells(notes, counts);
    if let Some(count @ 1..) = counts.pixels_disordered {
        notes.warnings.push(format!("{count} pixels were composited in an order that is not exact"));
    }
}

fn record_skipped_cells(notes: &mut Diagnostics, counts: &RenderStats) {
    for (which, why, count) in [
        ("that show nothing", "no widget touches their values", counts.culled_by_transfer_function),
        ("out of view", "they lie outside the view", counts.culled_by_frustum),
        ("under a pixel's reach", "they cover no pixel centre", counts.under_a_pixel),
    ] {
        if let Some(count @ 1..) = count {
            notes.record_skipped(format!("cells {which}"), why, Some(SavedWork::Cells(count)));
        }
    }
    if let Some(tiles @ 1..) = counts.tiles_stopped {
        let what = format!("cells of {tiles} tiles that stopped early");
        let saving = counts.cells_hidden.map(SavedWork::Cells);
        notes.record_skipped(what, "every pixel of the tile is opaque", saving);
    }
}

/// Notes the order that was not made.
pub(super) fn note_whole(call: &mut RunContext, scene: &Scene, counts: &RenderStats) -> Result<()> {
    if scene.ordering(call.exhaustive()) == Ordering::Independent {
        record_unsorted(&mut call.notes, counts.segments);
    }
    Ok(())
}
