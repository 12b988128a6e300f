// Uses: piecewise_linear/points, track. Fills: nothing.
// A piecewise-linear widget along a segment, as the quadrature sees it.
// Twin of `lanes::optics::piecewise_linear::LanePiecewiseTrack`.

struct PiecewiseTrack {
    points: ControlPoints,
    front: f32,
    back: f32,
    // D/U: turns extinctions into rates.
    scale: f32,
    // Extinction above which it glows; negative where none is told apart.
    threshold: f32,
}

fn piecewise_rate(track: PiecewiseTrack, s: f32) -> f32 {
    return track.scale * points_extinction(track.points, points_interval(track.points, s), s);
}

fn piecewise_rates(track: PiecewiseTrack, at: vec4f) -> vec4f {
    let s = along(track.front, track.back, at);
    return vec4f(
        piecewise_rate(track, s.x),
        piecewise_rate(track, s.y),
        piecewise_rate(track, s.z),
        piecewise_rate(track, s.w),
    );
}

// Colours at four places: red, green and blue of each.
fn piecewise_colors(track: PiecewiseTrack, at: vec4f) -> mat3x4f {
    let s = along(track.front, track.back, at);
    let points = track.points;
    return transpose(mat4x3f(
        points_color(points, points_interval(points, s.x), s.x),
        points_color(points, points_interval(points, s.y), s.y),
        points_color(points, points_interval(points, s.z), s.z),
        points_color(points, points_interval(points, s.w), s.w),
    ));
}

// The next place at which the extinction bends or passes the threshold.
fn piecewise_next_break(track: PiecewiseTrack, t: f32) -> f32 {
    let span = track.back - track.front;
    if abs(span) < 1e-37 {
        return 2.0;
    }
    let inverse = 1.0 / span;
    let past = t + PASSED;
    var next = 2.0;
    for (var k = 0u; k < track.points.count; k++) {
        let s = point_s(track.points, k);
        let at = (s - track.front) * inverse;
        next = select(next, at, past < at && at < next);
        if k > 0u && 0.0 <= track.threshold {
            let before = point_s(track.points, k - 1u);
            let low = number(track.points.first + POINT_STRIDE * (k - 1u) + 1u);
            let high = number(track.points.first + POINT_STRIDE * k + 1u);
            let share = (track.threshold - low) / select(high - low, 1e37, high == low);
            let cross = ((before - track.front) + share * (s - before)) * inverse;
            next = select(next, cross, 0.0 < share && share < 1.0 && past < cross && cross < next);
        }
    }
    return next;
}
