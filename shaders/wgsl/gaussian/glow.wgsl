// Uses: gaussian/mean_profile, gaussian/track. Fills: nothing.
// ∫ e^(−T) dt, t ∈ [0, 1], over the part of a path where the profile exceeds e^(−level), T counted from the front;
// peak = ρ₀ D. Times c D/U it is the constant-emitter colour (Song et al. 2009, Eq. 8 to 10). Walked in widths from the
// window's entry, so that a window that is a small share of the path keeps its digits.
// Twin of `lanes::optics::gaussian::glow`.

fn gaussian_mean_transmittance_along(track: GaussianTrack) -> f32 {
    var walk = walk_start();
    var sum = 0.0;
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let next = gaussian_next_break(track, walk.t);
        let dt = walk_panel(walk, next);
        let rates = Points(
            gaussian_rates(track, vec4f(walk.t) + dt * NODES_LOW),
            gaussian_rates(track, vec4f(walk.t) + dt * NODES_HIGH),
        );
        let seen = walk_take(&walk, next, dt, rates);
        sum += dot(seen.low + seen.high, vec4f(1.0));
    }
    return sum;
}

fn gaussian_glow(path: GaussianPath, peak: f32, level: f32) -> f32 {
    let room = level - path.offset_squared;
    let half = sqrt(max(room, 0.0));
    let start = max(path.front, -half);
    let end = min(path.back, half);
    let flat = path.length <= 0.0;
    // A segment of one point in working precision is inside or not.
    if !(0.0 < room && (start < end || flat)) {
        return 0.0;
    }
    let whole = (start <= path.front && path.back <= end) || flat;
    let width = select(end - start, path.length, whole);
    let share = select(min(width * path.inverse, 1.0), 1.0, whole);
    let rate = peak * exponential(-path.offset_squared);
    // What absorbs before the window.
    let ahead = max(start - path.front, 0.0);
    var before = 0.0;
    if 0.0 < ahead && !flat {
        let entry = GaussianPath(path.front, start, ahead, 1.0 / max(ahead, 1e-30), 0.0);
        before = rate * (ahead * path.inverse) * gaussian_mean_profile(entry);
    }
    let track = GaussianTrack(start, start + width, width, rate * share);
    return share * exponential(-before) * gaussian_mean_transmittance_along(track);
}
