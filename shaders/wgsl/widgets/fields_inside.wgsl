// Uses: widgets/fields. Fills: nothing. Asks for: part.
// What a widget over `count` fields makes of the ends of its part of the segment.

struct FieldEnds {
    start: Fields,
    end: Fields,
}

fn widget_fields_inside(index: u32, count: u32, part: Part) -> FieldEnds {
    let front = widget_fields(index, count, part.front);
    let back = widget_fields(index, count, part.back);
    var ends = FieldEnds();
    for (var i = 0u; i < count; i++) {
        ends.start[i] = part_start(part, front[i], back[i]);
        ends.end[i] = part_end(part, front[i], back[i]);
    }
    return ends;
}
