//! `uniform` in WGSL.

use super::snippets::{CUTOFF_RATE, Light, Mixing, Snippet, WidgetSnippets, light_of_rates};

pub(super) fn snippets(constant_emitter: bool) -> WidgetSnippets {
    WidgetSnippets {
        depth: Snippet::new(&["uniform/depth"], "uniform_depth(#u, part_#)"),
        light: match constant_emitter {
            false => Light::of_density(),
            true => Light::Closed(Snippet::new(&["uniform/light"], "uniform_light(#u, part_#, depth_#)")),
        },
        track: Snippet::new(&["uniform/track"], "uniform_track(#u, part_#)"),
        track_type: "UniformTrack",
        next_break: "uniform_next_break(members.track_#, t)".into(),
        member_light: light_of_rates("uniform/track", "uniform_rates"),
        window: None,
        threshold: CUTOFF_RATE,
        mixing: Mixing::Bounded,
    }
}
