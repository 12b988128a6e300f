// Uses: elementary/mean_transmittance. Fills: stretch_light.
// Light of brightness 1 from a stretch, and what the error of a panel is a share of: constant-emitter, without D/U.

fn stretch_light(length: f32, depth: f32) -> f32 {
    return length * mean_transmittance(depth);
}

fn panel_stake(length: f32, depth: f32) -> f32 {
    return length * one_minus_exp(depth);
}

// The most of a panel's stake by its light, T for the depth that a panel may hold.
fn stake_of_light(depth: f32) -> f32 {
    return min(depth, 3.0);
}
