// Uses: fields. Fills: nothing. Asks for: scene, numbers, values.
// What a widget over `count` fields makes of a segment's values. Its numbers: their indices, the centre, K row by row.

// K (v − v₀).
fn widget_fields(index: u32, count: u32, values: Values) -> Fields {
    var v = values;
    let first = scene.widgets[index].first_number;
    var q = Fields();
    for (var j = 0u; j < count; j++) {
        let offset = v[u32(number(first + j))] - number(first + count + j);
        for (var i = 0u; i < count; i++) {
            q[i] += number(first + (2u + i) * count + j) * offset;
        }
    }
    return q;
}
