// Uses: table/track, widgets/widget. Fills: nothing.
// An image over the (s, g) plane: matrix.xy and matrix.zw give its columns and rows from stored s and g.

fn table_point(index: u32, v: vec2f) -> vec2f {
    let map = scene.widgets[index].matrix;
    return map.xz * v + map.yw;
}

fn table_track(index: u32, cutoff: f32, part: Part) -> TableTrack {
    let widget = scene.widgets[index];
    return TableTrack(
        widget.first_number,
        widget.bell.xy - vec2f(1.0),
        table_point(index, plane(part.front)),
        table_point(index, plane(part.back)),
        widget_rate(index, part),
        cutoff,
    );
}

// Optical depth: Simpson's rule between the lines through texel centres, which is exact there. The part is walked from
// its own ends, so that a short one keeps its digits.
fn table_depth(index: u32, part: Part) -> f32 {
    var track = table_track(index, -1.0, part);
    let front = track.front;
    let back = track.back;
    track.front = vec2f(part_start(part, front.x, back.x), part_start(part, front.y, back.y));
    track.back = vec2f(part_end(part, front.x, back.x), part_end(part, front.y, back.y));
    let most = u32(track.last.x + track.last.y) + 4u;
    var t = 0.0;
    var sum = 0.0;
    for (var i = 0u; i < most && t < 1.0; i++) {
        let next = min(table_next_break(track, t), 1.0);
        let inside = table_texel(track, t).a
            + 4.0 * table_texel(track, t + 0.5 * (next - t)).a
            + table_texel(track, next).a;
        sum += (next - t) * inside;
        t = next;
    }
    return widget_peak(index, part) * (sum / 6.0);
}
