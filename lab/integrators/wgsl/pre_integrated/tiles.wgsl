// Uses: pre_integrated/bilinear, pre_integrated/cylinder, pre_integrated/mean_extinctions. Fills: glow_between.
// Two of the tiles, those nearest in the angle (Roettger & Ertl 2002, section 4).

fn glow_between(front: f32, back: f32, share: f32) -> vec3f {
    let side = table_side();
    let step = f32(side - 1u);
    let at = to_cylinder(front / step, back / step, clamp(share, 0.0, 1.0));
    let last = last_tile();
    let place = at.x * f32(last);
    let low = min(u32(place), last - 1u);
    let tile = side * side;
    return mix(
        glow_bilinear(low * tile, at.y * step, at.z * step, side),
        glow_bilinear((low + 1u) * tile, at.y * step, at.z * step, side),
        place - f32(low),
    );
}
