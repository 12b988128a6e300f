// Uses: nothing. Fills: nothing.
// A vector scaled by its largest component, so that no square leaves 32 bits; 0 where it is 0.

fn scaled_direction(v: vec3f) -> vec3f {
    let largest = max(abs(v.x), max(abs(v.y), abs(v.z)));
    return select(v / max(largest, 1e-37), vec3f(0.0), largest < 1e-37);
}
