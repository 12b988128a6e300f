// Uses: nothing. Fills: compositor. Asks for: segment.
// Integrates a list of segments: one invocation each. What special cells and the tests of these pieces take.

// Numbers of a segment: D, the values at the front, the values at the back, and for `finish` what it reads.
@group(1) @binding(0) var<storage, read> segments: array<f32>;
@group(1) @binding(1) var<storage, read_write> contributions: array<Contribution>;

fn segment_values(first: u32) -> Values {
    var values = Values();
    for (var i = 0u; i < VALUE_COUNT; i++) {
        values[i] = segments[first + i];
    }
    return values;
}

fn segment_vector(first: u32) -> vec3f {
    return vec3f(segments[first], segments[first + 1u], segments[first + 2u]);
}

@compute @workgroup_size(64)
fn integrate_segments(@builtin(global_invocation_id) id: vec3u) {
    let index = id.x;
    if index >= arrayLength(&contributions) {
        return;
    }
    let first = index * SEGMENT_STRIDE;
    let front = segment_values(first + 1u);
    let back = segment_values(first + 1u + VALUE_COUNT);
    let found = segment(segments[first], front, back);
    contributions[index] = finish(found, first + 1u + 2u * VALUE_COUNT);
}
