// Uses: elementary/one_minus_exp, track, wave/value. Fills: nothing.
// ∫ e^(−T) dt, t ∈ [0, 1], over the parts of a segment where the profile exceeds the cutoff, T counted from the
// segment's front; peak = ρ₀ D. Times c D/U it is the constant-emitter colour. Whole bands are alike: any number of
// them is a geometric series. Twin of `lanes::optics::wave::LaneBell::glow`.

// A part of one band, by signed distances from its peak.
struct WavePart {
    ends: vec2f,
    peak: f32,
}

fn wave_part_rates(bell: Bell, part: WavePart, at: vec4f) -> vec4f {
    let place = along(part.ends.x, part.ends.y, at);
    return part.peak * wave_values(bell, clamp(vec4f(0.5) - abs(place), vec4f(0.0), vec4f(0.5)));
}

fn wave_part_next_break(part: WavePart, t: f32) -> f32 {
    let peak = -part.ends.x / max(part.ends.y - part.ends.x, 1e-37);
    return select(2.0, peak, part.ends.x < 0.0 && 0.0 < part.ends.y && t + PASSED < peak);
}

fn wave_part_mean_transmittance_along(bell: Bell, part: WavePart) -> f32 {
    var walk = walk_start();
    var sum = 0.0;
    for (var i = 0u; i < PANELS_MOST && walk_is_open(walk); i++) {
        let next = wave_part_next_break(part, walk.t);
        let dt = walk_panel(walk, next);
        let rates = Points(
            wave_part_rates(bell, part, vec4f(walk.t) + dt * NODES_LOW),
            wave_part_rates(bell, part, vec4f(walk.t) + dt * NODES_HIGH),
        );
        let seen = walk_take(&walk, next, dt, rates);
        sum += dot(seen.low + seen.high, vec4f(1.0));
    }
    return sum;
}

// Area between two signed distances from one peak, ends.x ≤ ends.y.
fn wave_part_area(bell: Bell, ends: vec2f) -> f32 {
    let p = abs(ends.x);
    let q = abs(ends.y);
    let over = ends.x < 0.0 && 0.0 < ends.y;
    // On one side of the peak the second flank is empty.
    let near = select(min(p, q), 0.0, over);
    let other = select(0.0, min(p, q), over);
    return wave_flank(bell, Spot(0.5 - max(p, q), max(p, q)), Spot(0.5 - near, near))
        + wave_flank(bell, Spot(0.5 - other, other), Spot(0.5, 0.0));
}

// ∫ e^(−T) dt over what is lit of a part, T from the part's start. `per_phase`: t per unit of phase; `alone`: the part
// is the whole segment.
fn wave_part_light(bell: Bell, ends: vec2f, peak: f32, per_phase: f32, alone: bool) -> f32 {
    let start = max(ends.x, -bell.lit);
    let end = min(ends.y, bell.lit);
    let whole = alone && start <= ends.x && ends.y <= end && -bell.lit < start && end < bell.lit;
    let length = max(end - start, 0.0);
    if !(0.0 < length || whole) {
        return 0.0;
    }
    let share = select(length * per_phase, 1.0, whole);
    var before = 0.0;
    if ends.x < start {
        before = wave_part_area(bell, vec2f(ends.x, start)) * per_phase * peak;
    }
    let part = WavePart(vec2f(start, start + length), peak * share);
    return share * exponential(-before) * wave_part_mean_transmittance_along(bell, part);
}

// Band and signed distance from its peak, of a phase turned to rise.
fn wave_place(phase: Phase, sign: f32) -> vec2f {
    let nearest = phase.nearest * sign;
    let offset = phase.offset * sign;
    return select(vec2f(nearest - 1.0, offset + 0.5), vec2f(nearest, offset - 0.5), 0.0 <= offset);
}

fn wave_glow(bell: Bell, front: Phase, back: Phase, peak: f32) -> f32 {
    // The bell is even: a falling phase is a rising one of the opposite sign.
    let signed_span = (back.nearest - front.nearest) + (back.offset - front.offset);
    let sign = select(1.0, -1.0, signed_span < 0.0);
    let start = wave_place(front, sign);
    let end = wave_place(back, sign);
    let bands = end.x - start.x;
    let per_phase = 1.0 / max(abs(signed_span), 1e-37);
    if bands < 0.5 {
        return wave_part_light(bell, vec2f(start.y, max(end.y, start.y)), peak, per_phase, true);
    }
    // What is left of the band in front, whole bands, what is begun of the last one.
    let first = wave_part_light(bell, vec2f(start.y, 0.5), peak, per_phase, false);
    let band = wave_part_light(bell, vec2f(-0.5, 0.5), peak, per_phase, false);
    let last = wave_part_light(bell, vec2f(-0.5, end.y), peak, per_phase, false);
    let rate = peak * per_phase;
    let first_depth = rate * wave_part_area(bell, vec2f(start.y, 0.5));
    let band_depth = rate * 2.0 * bell.half_area;
    let count = max(bands - 1.0, 0.0);
    var series = count;
    if 1e-25 <= band_depth {
        series = one_minus_exp(count * band_depth) / one_minus_exp(band_depth);
    }
    return first + exponential(-first_depth) * (series * band + exponential(-(count * band_depth)) * last);
}
