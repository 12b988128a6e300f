// Uses: pre_integrated/cylinder, pre_integrated/trilinear. Fills: nothing. Asks for: glows, tiles.
// Resamples the table over (D, s_f, s_b) to tiles over (α, s, t). A place whose s_f is outside [0, 1] takes the nearest
// inside, so that the linear filter does not read nothing.

@compute @workgroup_size(8, 8)
fn fill_tiles(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= SIDE || id.y >= SIDE || id.z > LAST_TILE {
        return;
    }
    let step = f32(SIDE - 1u);
    let at = from_cylinder(f32(id.z) / f32(LAST_TILE), f32(id.y) / step, f32(id.x) / step);
    let glow = glow_trilinear(clamp(at.x, 0.0, 1.0) * step, at.y * step, at.z, SIDE);
    put_tile((id.z * SIDE + id.y) * SIDE + id.x, vec4f(glow, 0.0));
}
