// Uses: pre_integrated/bilinear. Fills: nothing.
// C/(D E₁) from the table over (D, s_f, s_b), from places in steps and the share of the longest segment. Slices lie at
// D = (k/(n − 1))². Twin of `optics::integrators::PreIntegrated`.

fn glow_trilinear(front: f32, back: f32, share: f32, side: u32) -> vec3f {
    let place = sqrt(clamp(share, 0.0, 1.0)) * f32(side - 1u);
    let low = min(u32(place), side - 2u);
    let slice = side * side;
    return mix(
        glow_bilinear(low * slice, front, back, side),
        glow_bilinear((low + 1u) * slice, front, back, side),
        place - f32(low),
    );
}
