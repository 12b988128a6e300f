// Uses: elementary/mean_transmittance. Fills: nothing. Asks for: glow_between.
// Light of a segment from a table: colour, and the optical depth in the fourth component.

fn pre_integrated_light(length: f32, front: f32, back: f32) -> vec4f {
    let share = length * longest_per_length();
    let i = node_place(front);
    let j = node_place(back);
    let depth = mean_extinction(i, j) * share;
    return vec4f(glow_between(i, j, share) * (share * mean_transmittance(depth)), depth);
}
