//! What the counts of a picture become in the notes of a node, whatever engine counted them.

use super::order::leave_out_order;
use voltet_core::Result;
use voltet_graph::{MayLeaveOut, NodeDiagnostics, RunContext, SavedWork};
use voltet_optics::engine::RenderStats;
use voltet_optics::scene::Scene;
use voltet_optics::shading::VisibilityOrder;

/// Notes what was counted: of a whole picture, or of one stage.
pub(super) fn note(call: &mut RunContext, counts: &RenderStats) {
    let leave = call.may_leave_out();
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
    if let Some(leave) = leave {
        leave_out(notes, leave, counts);
    }
    if let Some(count @ 1..) = counts.pixels_disordered {
        notes.warnings.push(format!("{count} pixels were composited in an order that is not exact"));
    }
}

fn leave_out(notes: &mut NodeDiagnostics, leave: MayLeaveOut, counts: &RenderStats) {
    for (which, why, count) in [
        ("that show nothing", "no widget touches their values", counts.culled_by_transfer_function),
        ("out of view", "they lie outside the view", counts.culled_by_frustum),
        ("under a pixel's reach", "they cover no pixel centre", counts.under_a_pixel),
    ] {
        if let Some(count @ 1..) = count {
            notes.record_skipped(leave, format!("cells {which}"), why, Some(SavedWork::Cells(count)));
        }
    }
    if let Some(tiles @ 1..) = counts.tiles_stopped {
        let what = format!("cells of {tiles} tiles that stopped early");
        let saving = counts.cells_hidden.map(SavedWork::Cells);
        notes.record_skipped(leave, what, "every pixel of the tile is opaque", saving);
    }
}

/// Notes the order that was not made.
pub(super) fn note_whole(call: &mut RunContext, scene: &Scene, counts: &RenderStats) -> Result<()> {
    if let (Some(leave), VisibilityOrder::Auto, false) =
        (call.may_leave_out(), scene.order, scene.needs_order())
    {
        leave_out_order(&mut call.notes, leave, counts.segments);
    }
    Ok(())
}
