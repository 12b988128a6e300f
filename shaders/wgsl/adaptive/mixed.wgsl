// Uses: elementary/mean_transmittance. Fills: nothing.
// The mix of a whole segment (Kniss et al. 2003, Eq. 15) and the bound of its error: whatever the order, a widget is seen
// no better than in front of all others and no worse than behind them. Twin of `optics::integrators::adaptive::mix`.

// A widget's light, and by how much that can be too small and too large.
struct MixedPart {
    color: vec3f,
    light: f32,
    above: f32,
    below: f32,
}

// Density-emitter, from the widget's depth and that of all.
fn mixed_density(color: vec3f, own: f32, depth: f32) -> MixedPart {
    let most = one_minus_exp(own);
    let share = mean_transmittance(depth) * own;
    let least = exponential(own - depth) * most;
    return MixedPart(color, share, max(most - share, 0.0), max(share - least, 0.0));
}

// Constant-emitter, without D/U, from the part [t₀, t₁] where it glows and the depth of all.
fn mixed_constant(color: vec3f, range: vec2f, window: vec2f, depth: f32) -> MixedPart {
    let lit = max(min(min(range.y, window.y), 1.0) - max(max(range.x, window.x), 0.0), 0.0);
    let slack = 0.5 * lit * one_minus_exp(depth);
    return MixedPart(color, 0.5 * lit * (1.0 + exponential(-depth)), slack, slack);
}

// By how much each channel can be too small and too large.
struct MixedError {
    up: vec3f,
    down: vec3f,
}

// `mean`: any colour for the density-emitter, whose light is known as a whole; 0 for the constant-emitter.
fn mixed_add(sum: MixedError, part: MixedPart, mean: vec3f) -> MixedError {
    let more = max(part.color - mean, vec3f(0.0));
    let less = max(mean - part.color, vec3f(0.0));
    return MixedError(
        sum.up + more * part.above + less * part.below,
        sum.down + more * part.below + less * part.above,
    );
}

fn mixed_largest(sum: MixedError) -> f32 {
    let channels = max(sum.up, sum.down);
    return max(channels.r, max(channels.g, channels.b));
}
