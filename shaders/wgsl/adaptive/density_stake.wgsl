// Uses: elementary/one_minus_exp. Fills: stretch_light.
// Light of brightness 1 from a stretch, and what the error of a panel is a share of: density-emitter.

fn stretch_light(length: f32, depth: f32) -> f32 {
    return one_minus_exp(depth);
}

fn panel_stake(length: f32, depth: f32) -> f32 {
    return depth;
}

// The most of a panel's stake by its light, T/(1 − e^(−T)) for the depth that a panel may hold.
fn stake_of_light(depth: f32) -> f32 {
    return 1.0 + min(depth, 2.2);
}
