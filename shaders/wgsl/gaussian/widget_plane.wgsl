// Uses: gaussian/plane, widgets/widget. Fills: nothing.
// Paths through a Gaussian over the (s, g) plane: over the whole segment, and over the widget's part.

// K (v − v₀).
fn gaussian_plane_point(index: u32, v: Values) -> vec2f {
    let offset = plane(v) - scene.widgets[index].centre;
    let matrix = scene.widgets[index].matrix;
    return vec2f(dot(matrix.xy, offset), dot(matrix.zw, offset));
}

fn gaussian_plane_whole(index: u32, part: Part) -> GaussianPath {
    return gaussian_plane_path(gaussian_plane_point(index, part.front), gaussian_plane_point(index, part.back));
}

fn gaussian_plane_inside(index: u32, part: Part) -> GaussianPath {
    let front = gaussian_plane_point(index, part.front);
    let back = gaussian_plane_point(index, part.back);
    return gaussian_plane_path(
        vec2f(part_start(part, front.x, back.x), part_start(part, front.y, back.y)),
        vec2f(part_end(part, front.x, back.x), part_end(part, front.y, back.y)),
    );
}
