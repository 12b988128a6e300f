// Uses: elementary/mean_transmittance. Fills: nothing. Asks for: slices.
// Fills the table over (D, s_f, s_b), all entries of a slice side by side (Roettger & Ertl 2002, section 3): a path from
// node i to node j is the pieces between them, each homogeneous and of equal length; a piece absorbs its own light.
// Twin of `optics::integrators::slice`, which shares the work of the paths of equal span.

// Glow and extinction of the nodes, then of the PARTS pieces of each step, times the longest segment.
@group(0) @binding(0) var<storage, read> ramp: array<vec4f>;

@compute @workgroup_size(8, 8)
fn fill_slices(@builtin(global_invocation_id) id: vec3u) {
    let i = id.y;
    let j = id.x;
    if i >= SIDE || j >= SIDE || id.z >= SIDE {
        return;
    }
    let at = (id.z * SIDE + i) * SIDE + j;
    if i == j {
        put_slice(at, vec4f(ramp[i].rgb, 0.0));
        return;
    }
    let falls = j < i;
    let count = select(j - i, i - j, falls) * PARTS;
    let slice = f32(id.z) / f32(SIDE - 1u);
    let step = slice * slice / f32(count);
    // The last piece of a falling path is the lowest one.
    let lowest = SIDE + min(i, j) * PARTS;
    var emission = vec3f(0.0);
    var depth = 0.0;
    for (var k = 0u; k < count; k++) {
        let piece = ramp[lowest + select(k, count - 1u - k, falls)];
        let held = piece.a * step;
        emission += (exponential(-depth) * mean_transmittance(held)) * piece.rgb;
        depth += held;
    }
    // C/(D E₁).
    put_slice(at, vec4f(emission / (f32(count) * mean_transmittance(depth)), 0.0));
}
