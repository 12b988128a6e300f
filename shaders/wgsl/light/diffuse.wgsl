// Uses: light/direction. Fills: nothing.
// k_a + k_d |ĝ·light|; `light` has unit length.

fn diffuse_factor(gradient: vec3f, light: vec3f, ambient: f32, diffuse: f32) -> f32 {
    let g = scaled_direction(gradient);
    let facing = abs(dot(g, light)) / max(length(g), 1e-37);
    return ambient + diffuse * min(facing, 1.0);
}
