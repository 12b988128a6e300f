// Uses: gaussian/line, widgets/widget. Fills: nothing.
// Paths through a Gaussian of the scalar alone: over the whole segment, and over the widget's part.

fn gaussian_line_ends(index: u32, part: Part) -> vec2f {
    let s = vec2f(value_s(part.front), value_s(part.back));
    return scene.widgets[index].matrix.x * (s - vec2f(scene.widgets[index].centre.x));
}

fn gaussian_line_whole(index: u32, part: Part) -> GaussianPath {
    let q = gaussian_line_ends(index, part);
    return gaussian_line_path(q.x, q.y);
}

fn gaussian_line_inside(index: u32, part: Part) -> GaussianPath {
    let q = gaussian_line_ends(index, part);
    return gaussian_line_path(part_start(part, q.x, q.y), part_end(part, q.x, q.y));
}
