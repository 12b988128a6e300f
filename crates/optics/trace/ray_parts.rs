//! Parts of a ray in the order of the scene: cells, cut where surfaces and the ends of clips lie within, and surfaces.

use super::crossing::Crossing;
use std::ops::ControlFlow;
use voltet_core::Result;

/// Event along a ray beside its cells.
pub(super) struct Event {
    /// z, internal units.
    pub depth: f64,
    pub kind: EventKind,
}

pub(super) enum EventKind {
    /// Premultiplied colour and opacity.
    Surface([f64; 4]),
    Hide,
    Show,
}

pub(super) enum RayPart<'a> {
    /// A cell, or what events leave of it.
    Cell(&'a Crossing),
    /// A surface: z in internal units, premultiplied colour and opacity.
    Surface { depth: f64, rgba: [f64; 4] },
}

/// Visits the parts of a ray until `visit` breaks off. Crossings and events are in order.
pub(super) fn visit_parts(
    crossings: &[Crossing],
    events: &[Event],
    mut visit: impl FnMut(RayPart) -> Result<ControlFlow<()>>,
) -> Result<()> {
    let (mut events, mut hidden) = (events.iter().peekable(), false);
    for crossing in crossings {
        let mut rest = *crossing;
        while let Some(event) = events.next_if(|event| event.depth < rest.depth[1]) {
            if rest.depth[0] < event.depth {
                let [before, behind] = rest.cut(event.depth);
                rest = behind;
                if !hidden && visit(RayPart::Cell(&before))?.is_break() {
                    return Ok(());
                }
            }
            match event.kind {
                EventKind::Surface(rgba) => {
                    if visit(RayPart::Surface { depth: event.depth, rgba })?.is_break() {
                        return Ok(());
                    }
                }
                EventKind::Hide => hidden = true,
                EventKind::Show => hidden = false,
            }
        }
        if !hidden && visit(RayPart::Cell(&rest))?.is_break() {
            return Ok(());
        }
    }
    for event in events {
        if let EventKind::Surface(rgba) = event.kind
            && visit(RayPart::Surface { depth: event.depth, rgba })?.is_break()
        {
            return Ok(());
        }
    }
    Ok(())
}
