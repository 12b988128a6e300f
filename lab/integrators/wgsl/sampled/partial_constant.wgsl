// Uses: sampled/partial_table. Fills: piece_light.
// Light of a piece, constant-emitter, without D/U: the table holds F (1 + √T) and B (1 + √T) by turns.

fn partial_pair(at: u32) -> vec2f {
    return vec2f(partial_entry(2u * at), partial_entry(2u * at + 1u));
}

fn piece_light(front: vec4f, back: vec4f, step: f32) -> vec3f {
    let a = front.a * step;
    let b = back.a * step;
    let at = partial_place(a, b);
    let below = at.first + partial_side();
    let low = mix(partial_pair(at.first), partial_pair(at.first + 1u), at.x);
    let high = mix(partial_pair(below), partial_pair(below + 1u), at.x);
    let weights = mix(low, high, at.y) / (1.0 + sqrt(0.5 * min(a + b, 3e38)));
    return step * (weights.x * front.rgb + weights.y * back.rgb);
}
