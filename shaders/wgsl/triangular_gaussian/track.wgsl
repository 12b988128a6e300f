// Uses: clip, track. Fills: nothing.
// A triangular Gaussian along a segment, as the quadrature sees it.
// Twin of `lanes::optics::triangular_gaussian::LaneTriangularTrack`.

struct TriangularTrack {
    // δ = s − s₀ at front and back.
    offset: vec2f,
    // γ = σ g at front and back, ≥ 0.
    width: vec2f,
    // ρ₀ D.
    peak: f32,
}

// e^(−49): beyond it nothing is resolved.
const TRIANGULAR_FAR = 7.0;

// The t between which the profile exceeds e^(−level); the first above the second where it nowhere does.
fn triangular_window_ends(track: TriangularTrack, level: f32) -> vec2f {
    // Inside: δ < x γ, −δ < x γ and γ > 0, each linear in t.
    let reach = min(sqrt(level), 1e18) * track.width;
    let below = reach - track.offset;
    let above = reach + track.offset;
    var lit = stretch_cut(stretch_whole(), below.x, below.y);
    lit = stretch_cut(lit, above.x, above.y);
    lit = stretch_cut(lit, track.width.x, track.width.y);
    return vec2f(lit.start, lit.end);
}

fn triangular_rates(track: TriangularTrack, at: vec4f) -> vec4f {
    let width = along(track.width.x, track.width.y, at);
    let x = along(track.offset.x, track.offset.y, at) / max(width, vec4f(1e-37));
    let bounded = clamp(x, vec4f(-1e9), vec4f(1e9));
    return select(vec4f(0.0), track.peak * transmittances(bounded * bounded), vec4f(0.0) < width);
}

fn triangular_next_break(track: TriangularTrack, t: f32) -> f32 {
    let rise = track.offset.y - track.offset.x;
    let slope = track.width.y - track.width.x;
    let offset = rise * t + track.offset.x;
    let width = slope * t + track.width.x;
    // Turned so that x grows.
    let twist = rise * track.width.x - track.offset.x * slope;
    let turn = select(1.0, -1.0, twist < 0.0);
    let x = turn * offset / max(width, 1e-37);
    let step = min(1.5 / max(abs(x), 0.1), 1.0);
    let level = select(x + step, -TRIANGULAR_FAR, x < -TRIANGULAR_FAR) * turn;
    let below = rise - level * slope;
    let ahead = level * track.width.x - track.offset.x;
    var reached = ahead / select(below, 1e-37, abs(below) < 1e-37);
    // A level that rounding puts at t or just before it is still ahead; one further back is never reached.
    reached = select(2.0, reached, t - 2.0 * PASSED < reached);
    reached = select(reached, 2.0, TRIANGULAR_FAR <= x);
    var change = select(0.5 * width, width, 0.0 < slope) / max(abs(slope), 1e-37);
    change = select(2.0, t + change, 0.0 < width);
    return max(min(reached, change), t + 2.0 * PASSED);
}
