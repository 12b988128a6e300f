// Uses: triangular_gaussian/mean_profile, triangular_gaussian/track, triangular_gaussian_nd/path, widgets/fields, widgets/fields_inside, widgets/widget. Fills: nothing.
// Triangular Gaussian over `count` fields. Its numbers: those of its fields, then the index of m, and m = 0 as it is stored.

fn triangular_fields_width(index: u32, count: u32, values: Values) -> f32 {
    var v = values;
    let at = scene.widgets[index].first_number + (2u + count) * count;
    return v[u32(number(at))] - number(at + 1u);
}

fn triangular_fields_depth(index: u32, count: u32, part: Part) -> f32 {
    let ends = widget_fields_inside(index, count, part);
    let near = triangular_fields_width(index, count, part.front);
    let far = triangular_fields_width(index, count, part.back);
    let path = triangular_fields_path(ends.start, ends.end, vec2f(part_start(part, near, far), part_end(part, near, far)));
    let mean = triangular_gaussian_mean_profile(path.offset, path.width);
    return widget_peak(index, part) * exponential(-path.offset_squared) * mean;
}

// Over the whole segment.
fn triangular_fields_whole(index: u32, count: u32, part: Part) -> TriangularPath {
    let width = vec2f(
        triangular_fields_width(index, count, part.front),
        triangular_fields_width(index, count, part.back),
    );
    let front = widget_fields(index, count, part.front);
    return triangular_fields_path(front, widget_fields(index, count, part.back), width);
}

fn triangular_fields_track(index: u32, count: u32, part: Part) -> TriangularTrack {
    let path = triangular_fields_whole(index, count, part);
    let peak = widget_rate(index, part) * exponential(-path.offset_squared);
    return TriangularTrack(path.offset, path.width, peak);
}

// The t between which the profile exceeds e^(−level); the first above the second where it nowhere does.
fn triangular_fields_window(index: u32, count: u32, part: Part, level: f32) -> vec2f {
    let path = triangular_fields_whole(index, count, part);
    let room = level - path.offset_squared;
    if room <= 0.0 {
        return vec2f(2.0, -1.0);
    }
    return triangular_window_ends(TriangularTrack(path.offset, path.width, 0.0), room);
}
