// Uses: gaussian_nd/path, widgets/fields, widgets/fields_inside, widgets/widget. Fills: nothing.
// Paths through a Gaussian over `count` fields.

fn gaussian_fields_whole(index: u32, count: u32, part: Part) -> GaussianPath {
    return gaussian_fields_path(
        widget_fields(index, count, part.front),
        widget_fields(index, count, part.back),
    );
}

fn gaussian_fields_inside(index: u32, count: u32, part: Part) -> GaussianPath {
    let ends = widget_fields_inside(index, count, part);
    return gaussian_fields_path(ends.start, ends.end);
}
