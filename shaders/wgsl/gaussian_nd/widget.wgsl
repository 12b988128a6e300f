// Uses: gaussian_nd/path, widgets/fields, widgets/widget. Fills: nothing.
// Paths through a Gaussian over `count` fields.

fn gaussian_fields_whole(index: u32, count: u32, part: Part) -> GaussianPath {
    return gaussian_fields_path(
        widget_fields(index, count, part.front),
        widget_fields(index, count, part.back),
    );
}

fn gaussian_fields_inside(index: u32, count: u32, part: Part) -> GaussianPath {
    let front = widget_fields(index, count, part.front);
    let back = widget_fields(index, count, part.back);
    var start = Fields();
    var end = Fields();
    for (var i = 0u; i < count; i++) {
        start[i] = part_start(part, front[i], back[i]);
        end[i] = part_end(part, front[i], back[i]);
    }
    return gaussian_fields_path(start, end);
}
