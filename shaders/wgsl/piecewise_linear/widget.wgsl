// Uses: piecewise_linear/points, widgets/widget. Fills: nothing.
// Piecewise-linear widget: s at the start and end of its part. `extinction` is 1/U in scene lengths.

fn widget_points(index: u32, count: u32) -> ControlPoints {
    return ControlPoints(scene.widgets[index].first_number, count);
}

fn piecewise_ends(part: Part) -> vec2f {
    let front = value_s(part.front);
    let back = value_s(part.back);
    return vec2f(part_start(part, front, back), part_end(part, front, back));
}
