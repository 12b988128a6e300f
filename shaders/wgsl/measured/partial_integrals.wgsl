// Uses: linear/psi, linear/front_back, elementary/exponential. Fills: nothing.
// ψ, F, B and ζ of linear extinction from rows[0].x to rows[0].y; rows[0].z is their mean.

@group(1) @binding(0) var<storage, read> rows: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> values: array<f32>;
@compute @workgroup_size(1)
fn evaluate() {
    let x = rows[0];
    let sides = front_back(x.x, x.y);
    values[0] = psi(x.x, x.y);
    values[1] = sides.x;
    values[2] = sides.y;
    values[3] = exponential(-x.z);
}
