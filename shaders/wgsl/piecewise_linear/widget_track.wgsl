// Uses: piecewise_linear/track, piecewise_linear/widget. Fills: nothing.
// A piecewise-linear widget over the whole segment.

fn piecewise_track(index: u32, count: u32, part: Part) -> PiecewiseTrack {
    let threshold = scene.widgets[index].matrix.x;
    let rate = widget_rate(index, part);
    return PiecewiseTrack(widget_points(index, count), value_s(part.front), value_s(part.back), rate, threshold);
}
