// Uses: compositing. Fills: nothing.
// Composites segments (colour, opacity) front to back onto the sums in `values`.

@group(1) @binding(0) var<storage, read> rows: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> values: array<f32>;
@compute @workgroup_size(1)
fn evaluate() {
    var sum = Composite(vec3f(values[0], values[1], values[2]), values[3], values[4]);
    for (var i = 0u; i < arrayLength(&rows); i++) {
        sum = composite_add(sum, rows[i].rgb, rows[i].a);
    }
    values[0] = sum.color.r;
    values[1] = sum.color.g;
    values[2] = sum.color.b;
    values[3] = sum.opacity;
    values[4] = sum.transparency;
    values[5] = composite_opacity(sum);
}
