// Uses: elementary/one_minus_exp, sampled/partial_table. Fills: piece_light.
// Light of a piece, density-emitter: the table holds the front colour's share of it. The colour of an end is its glow by
// its rate; an end without stuff takes the other's colour.

fn partial_share(a: f32, b: f32) -> f32 {
    let at = partial_place(a, b);
    let side = partial_side();
    let low = vec2f(partial_entry(at.first), partial_entry(at.first + 1u));
    let high = vec2f(partial_entry(at.first + side), partial_entry(at.first + side + 1u));
    let row = low + at.y * (high - low);
    return row.x + at.x * (row.y - row.x);
}

fn end_color(end: vec4f, other: vec4f) -> vec3f {
    let stuff = select(other, end, 1.2e-38 <= end.a);
    return select(vec3f(0.0), stuff.rgb / max(stuff.a, 1.2e-38), 1.2e-38 <= stuff.a);
}

fn piece_light(front: vec4f, back: vec4f, step: f32) -> vec3f {
    let a = front.a * step;
    let b = back.a * step;
    let share = partial_share(a, b);
    let light = one_minus_exp(0.5 * min(a + b, 3e38));
    return light * (share * end_color(front, back) + (1.0 - share) * end_color(back, front));
}
