// Uses: clip, elementary/exponential, quadrature. Fills: nothing.
// Mean of exp(−(δ/γ)²) over a segment, δ = s − s₀ and γ = σ g linear along it, 0 where γ ≤ 0 (Kniss et al. 2003,
// section 3.2). x = δ/γ is monotone, so |x| grows from its least value outwards on at most two parts; each is walked
// from there, a panel of 8 points ending where x has grown by 1 or x² by 3, or γ has doubled or halved.
// Twin of `lanes::optics::triangular_gaussian::mean_profile`.

// x² by which a part grows before it counts as dark (e^(−24) = 4e-11).
const TRIANGULAR_REACH = 24.0;
// 5 by x up to 3, 6 by x², 24 halvings of γ until 32 bits reach the end.
const TRIANGULAR_PANELS_MOST = 40u;

fn triangular_values(offset: f32, rise: f32, width: f32, slope: f32, at: vec4f) -> vec4f {
    let gamma = slope * at + vec4f(width);
    let ratio = min((rise * at + vec4f(offset)) / max(gamma, vec4f(1e-37)), vec4f(1e9));
    return select(vec4f(0.0), transmittances(ratio * ratio), vec4f(0.0) < gamma);
}

// The mean over a part on which |x| grows from front to back and δ keeps its sign.
fn triangular_outward(signed_offset: vec2f, width: vec2f) -> f32 {
    let offset = abs(signed_offset);
    let rise = offset.y - offset.x;
    let slope = width.y - width.x;
    // Where δ and γ are both 0 at the start, x is what it is at the end.
    let at_foot = width.x <= 0.0;
    let least = min(select(offset.x, offset.y, at_foot) / max(select(width.x, width.y, at_foot), 1e-37), 1e18);
    let dark = least * least + TRIANGULAR_REACH;
    var t = 0.0;
    var sum = 0.0;
    var x = least;
    for (var i = 0u; i < TRIANGULAR_PANELS_MOST && t < 1.0 && x * x < dark; i++) {
        let here = slope * t + width.x;
        // Where x has grown; never reached where the denominator is not positive.
        let next = min(x + 1.0, sqrt(x * x + 3.0));
        let below = rise - next * slope;
        let ahead = next * width.x - offset.x;
        var level = select(1.0, ahead / max(below, 1e-37), 0.0 < below);
        // Where γ has doubled or halved.
        let doubled = select(0.5 * here, here, 0.0 < slope) / max(abs(slope), 1e-37);
        let change = select(1.0, t + doubled, 0.0 < here);
        // A level within rounding of t counts as reached.
        level = select(level, 1.0, level <= t * (1.0 + 1e-6));
        var end = min(min(level, change), 1.0);
        end = select(end, 1.0, end <= t);
        let length = end - t;
        let values = Points(
            triangular_values(offset.x, rise, width.x, slope, vec4f(t) + length * NODES_LOW),
            triangular_values(offset.x, rise, width.x, slope, vec4f(t) + length * NODES_HIGH),
        );
        sum += length * over_panel(values);
        t = end;
        x = min((rise * t + offset.x) / max(slope * t + width.x, 1e-37), 1e18);
    }
    return sum;
}

fn triangular_gaussian_mean_profile(offset: vec2f, width: vec2f) -> f32 {
    // The part with γ ≥ 0; γ < 0 on all of it leaves nothing.
    let lit = stretch_cut(stretch_whole(), width.x, width.y);
    var ends = offset;
    var widths = width;
    if lit.length < 1.0 {
        ends = vec2f(stretch_at_start(lit, offset.x, offset.y), stretch_at_end(lit, offset.x, offset.y));
        widths = vec2f(stretch_at_start(lit, width.x, width.y), stretch_at_end(lit, width.x, width.y));
        widths = max(widths, vec2f(0.0));
    }
    if lit.length <= 0.0 {
        return 0.0;
    }
    let crosses = (ends.x < 0.0 && 0.0 < ends.y) || (ends.y < 0.0 && 0.0 < ends.x);
    // From the end with the smaller |x| = |δ|/γ.
    let swapped = abs(ends.y) * widths.x < abs(ends.x) * widths.y;
    let path = select(ends, ends.yx, swapped);
    let gamma = select(widths, widths.yx, swapped);
    if !crosses {
        return triangular_outward(path, gamma) * lit.length;
    }
    // Through the centre: two parts, each from there.
    let all = abs(path.x) + abs(path.y);
    let share = abs(path.y) / all;
    let rest = abs(path.x) / all;
    let centre = gamma.x * share + gamma.y * rest;
    let first = triangular_outward(vec2f(0.0, path.y), vec2f(centre, gamma.y));
    let second = triangular_outward(vec2f(0.0, path.x), vec2f(centre, gamma.x));
    return (share * first + rest * second) * lit.length;
}
