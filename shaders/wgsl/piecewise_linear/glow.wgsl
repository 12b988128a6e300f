// Uses: linear/front_back, piecewise_linear/pieces. Fills: nothing.
// ∫ c e^(−T) dt where the extinction exceeds `threshold`, over a stretch whose rate is `scale` × extinction, with the
// optical depth in the fourth component. Times D/U it is the constant-emitter colour.
// Twin of `optics::piecewise_linear::PiecewisePath::glow`.

fn points_glow(points: ControlPoints, front: f32, back: f32, scale: f32, threshold: f32) -> vec4f {
    var walk = pieces_start(points, front, back);
    var color = vec3f(0.0);
    var depth = 0.0;
    for (var i = 0u; i <= points.count && walk.done == 0u; i++) {
        let piece = pieces_next(points, &walk);
        let rate = scale * piece.share;
        let at_front = points_extinction(points, piece.interval, piece.begin);
        let at_back = points_extinction(points, piece.interval, piece.end);
        // The part that glows, [x0, x1], its length taken from the end that is nearer.
        let rise = select(at_back - at_front, 1.0, at_back == at_front);
        let front_lit = threshold < at_front;
        let back_lit = threshold < at_back;
        let crossing = (threshold - at_front) / rise;
        let x0 = select(crossing, 0.0, front_lit);
        let x1 = select(crossing, 1.0, back_lit);
        let lit = select(select((at_back - threshold) / rise, 1.0, front_lit), crossing, front_lit && !back_lit);
        if front_lit || back_lit {
            let begin = select(threshold, at_front, front_lit);
            let end = select(threshold, at_back, back_lit);
            let before = rate * x0 * 0.5 * (at_front + threshold);
            let weights = front_back(rate * lit * begin, rate * lit * end);
            let near = points_color(points, piece.interval, piece.begin);
            let far = points_color(points, piece.interval, piece.end);
            let glow = weights.x * (near * (1.0 - x0) + far * x0) + weights.y * (near * (1.0 - x1) + far * x1);
            color += exponential(-(depth + before)) * (piece.share * lit) * glow;
        }
        depth += 0.5 * rate * (at_front + at_back);
    }
    return vec4f(color, depth);
}
