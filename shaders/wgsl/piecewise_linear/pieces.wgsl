// Uses: piecewise_linear/points. Fills: nothing.
// Walks a segment piece by piece, cut at the control points it crosses (Moreland 2004, Eq. 50 to 52). The share of a
// piece comes from the control points, and a flat segment is one piece of share 1.
// Twin of `optics::piecewise_linear::PiecewisePath::pieces`.

struct PieceWalk {
    // s where the piece begins, and at the back of the segment.
    begin: f32,
    back: f32,
    // Interval of the piece, and of the back.
    interval: u32,
    last: u32,
    // 1/|s_b − s_f|.
    inverse: f32,
    // Share of the segment not yet walked.
    rest: f32,
    // 1 when the back is reached.
    done: u32,
}

// One piece: ends in s, interval, share of the segment.
struct LinearPiece {
    begin: f32,
    end: f32,
    interval: u32,
    share: f32,
}

fn pieces_start(points: ControlPoints, front: f32, back: f32) -> PieceWalk {
    let inverse = 1.0 / max(abs(back - front), 1e-37);
    return PieceWalk(front, back, points_interval(points, front), points_interval(points, back), inverse, 1.0, 0u);
}

fn pieces_next(points: ControlPoints, walk: ptr<function, PieceWalk>) -> LinearPiece {
    let state = *walk;
    if state.interval == state.last {
        (*walk).done = 1u;
        return LinearPiece(state.begin, state.back, state.interval, state.rest);
    }
    let rising = state.interval < state.last;
    let to = point_s(points, select(state.interval - 1u, state.interval, rising));
    let share = min(abs(to - state.begin) * state.inverse, state.rest);
    (*walk).begin = to;
    (*walk).interval = select(state.interval - 1u, state.interval + 1u, rising);
    (*walk).rest = select(abs(state.back - to) * state.inverse, 0.0, state.back == to);
    return LinearPiece(state.begin, to, state.interval, share);
}
