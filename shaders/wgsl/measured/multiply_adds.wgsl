// Uses: nothing. Fills: nothing.
// How many multiply-adds a device does a second: each invocation runs eight chains of four lanes that wait for nothing but
// themselves. What a frame's compositor does is held against that.

// A start and a factor that no compiler knows, then what each invocation ends with.
@group(0) @binding(0) var<storage, read_write> sums: array<vec4f>;

// Software drivers end loops after 65,535 rounds.
const ROUNDS = 1024u;

@compute @workgroup_size(64)
fn multiply_adds(@builtin(local_invocation_index) lane: u32) {
    let factor = sums[0];
    let step = sums[1];
    var a = step + vec4f(f32(lane));
    var b = a + step;
    var c = b + step;
    var d = c + step;
    var e = d + step;
    var f = e + step;
    var g = f + step;
    var h = g + step;
    for (var round = 0u; round < ROUNDS; round++) {
        a = fma(a, factor, step);
        b = fma(b, factor, step);
        c = fma(c, factor, step);
        d = fma(d, factor, step);
        e = fma(e, factor, step);
        f = fma(f, factor, step);
        g = fma(g, factor, step);
        h = fma(h, factor, step);
    }
    sums[2u + lane] = ((a + b) + (c + d)) + ((e + f) + (g + h));
}
