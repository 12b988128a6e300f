// Uses: piecewise_linear/pieces. Fills: nothing.
// Optical depth of a stretch whose rate is `scale` × extinction.

fn points_depth(points: ControlPoints, front: f32, back: f32, scale: f32) -> f32 {
    var walk = pieces_start(points, front, back);
    var depth = 0.0;
    for (var i = 0u; i <= points.count && walk.done == 0u; i++) {
        let piece = pieces_next(points, &walk);
        let sum = points_extinction(points, piece.interval, piece.begin)
            + points_extinction(points, piece.interval, piece.end);
        depth += 0.5 * (scale * piece.share) * sum;
    }
    return depth;
}
