//! `uniform` in WGSL.

use super::calls::{CUTOFF_RATE, Call, Calls, Light, Mixing, light_of_rates};

pub(super) fn calls(constant_emitter: bool) -> Calls {
    Calls {
        depth: Call::new(&["uniform/depth"], "uniform_depth(#u, part_#)"),
        light: match constant_emitter {
            false => Light::of_density(),
            true => Light::Closed(Call::new(&["uniform/light"], "uniform_light(#u, part_#, depth_#)")),
        },
        track: Call::new(&["uniform/track"], "uniform_track(#u, part_#)"),
        track_type: "UniformTrack",
        next_break: "uniform_next_break(members.track_#, t)".into(),
        member_light: light_of_rates("uniform/track", "uniform_rates"),
        window: None,
        threshold: CUTOFF_RATE,
        mixing: Mixing::Bounded,
    }
}
