//! `triangular-gaussian` in WGSL.

use super::snippets::{ANY_RATE, Light, Mixing, Snippet, WidgetSnippets, light_of_rates};
use crate::writer::{WidgetRecord, Writer, all_finite, finite};
use voltet_core::Result;

pub(super) fn snippets(constant_emitter: bool) -> WidgetSnippets {
    WidgetSnippets {
        depth: Snippet::new(&["triangular_gaussian/widget"], "triangular_depth(#u, part_#)"),
        light: if constant_emitter { Light::Integrated } else { Light::of_density() },
        track: Snippet::new(&["triangular_gaussian/widget_track"], "triangular_track(#u, part_#)"),
        track_type: "TriangularTrack",
        next_break: "triangular_next_break(members.track_#, t)".into(),
        member_light: light_of_rates("triangular_gaussian/track", "triangular_rates"),
        window: Some(Snippet::new(
            &["triangular_gaussian/track"],
            "triangular_window_ends(members.track_#, scene.level)",
        )),
        threshold: ANY_RATE,
        mixing: Mixing::Bounded,
    }
}

/// matrix.x: σ for stored values; centre: s₀ and the stored g of 0.
pub(super) fn write(centre: f64, sigma: f64, writer: &mut Writer, record: &mut WidgetRecord) -> Result<()> {
    let [s, g] = writer.plane();
    record.matrix[0] = finite("sigma", sigma * g.scale / s.scale)?;
    record.centre = all_finite("the centre", [s.stored(centre), g.stored(0.0)])?;
    Ok(())
}
