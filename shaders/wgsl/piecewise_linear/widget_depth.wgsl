// Uses: piecewise_linear/depth, piecewise_linear/widget. Fills: nothing.
// Optical depth of a piecewise-linear widget.

fn piecewise_depth(index: u32, count: u32, part: Part) -> f32 {
    let s = piecewise_ends(part);
    return points_depth(widget_points(index, count), s.x, s.y, widget_peak(index, part));
}
