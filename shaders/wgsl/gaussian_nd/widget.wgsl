// Uses: gaussian_nd/path, widgets/widget. Fills: nothing. Asks for: numbers.
// Paths through a Gaussian over `count` fields. Its numbers: the indices of its values, the centre, K row by row.

fn gaussian_fields_point(index: u32, count: u32, values: Values) -> Fields {
    var v = values;
    let first = scene.widgets[index].first_number;
    var q = Fields();
    for (var j = 0u; j < count; j++) {
        let offset = v[u32(numbers[first + j])] - numbers[first + count + j];
        for (var i = 0u; i < count; i++) {
            q[i] += numbers[first + (2u + i) * count + j] * offset;
        }
    }
    return q;
}

fn gaussian_fields_whole(index: u32, count: u32, part: Part) -> GaussianPath {
    return gaussian_fields_path(
        gaussian_fields_point(index, count, part.front),
        gaussian_fields_point(index, count, part.back),
    );
}

fn gaussian_fields_inside(index: u32, count: u32, part: Part) -> GaussianPath {
    let front = gaussian_fields_point(index, count, part.front);
    let back = gaussian_fields_point(index, count, part.back);
    var start = Fields();
    var end = Fields();
    for (var i = 0u; i < count; i++) {
        start[i] = part_start(part, front[i], back[i]);
        end[i] = part_end(part, front[i], back[i]);
    }
    return gaussian_fields_path(start, end);
}
