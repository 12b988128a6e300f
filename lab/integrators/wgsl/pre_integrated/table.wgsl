// Uses: pre_integrated/mean_extinctions, pre_integrated/trilinear. Fills: glow_between.
// The three-dimensional table (Roettger & Ertl 2002, section 3).

fn glow_between(front: f32, back: f32, share: f32) -> vec3f {
    return glow_trilinear(front, back, share, table_side());
}
