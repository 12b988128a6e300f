// Uses: linear/emission_weights, piecewise_linear/pieces. Fills: nothing.
// ∫ c ρ e^(−T) over a stretch whose rate is `scale` × extinction: the density-emitter colour, with the optical depth
// in the fourth component. Twin of `optics::piecewise_linear::PiecewisePath::emission`.

fn points_emission(points: ControlPoints, front: f32, back: f32, scale: f32) -> vec4f {
    var walk = pieces_start(points, front, back);
    var color = vec3f(0.0);
    var depth = 0.0;
    for (var i = 0u; i <= points.count && walk.done == 0u; i++) {
        let piece = pieces_next(points, &walk);
        let rate = scale * piece.share;
        let a = rate * points_extinction(points, piece.interval, piece.begin);
        let b = rate * points_extinction(points, piece.interval, piece.end);
        let weights = emission_weights(a, b);
        color += exponential(-depth)
            * (weights.x * points_color(points, piece.interval, piece.begin)
                + weights.y * points_color(points, piece.interval, piece.end));
        depth += 0.5 * (a + b);
    }
    return vec4f(color, depth);
}
