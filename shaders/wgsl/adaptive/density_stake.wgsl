// Uses: elementary/one_minus_exp. Fills: stretch_light.
// Light of brightness 1 from a stretch, and what the error of a panel is a share of: density-emitter.

fn stretch_light(length: f32, depth: f32) -> f32 {
    return one_minus_exp(depth);
}

fn panel_stake(length: f32, depth: f32) -> f32 {
    return depth;
}
