// Uses: compositor/blended. Fills: blending.
// Colours over one another, rounded to multiples of 2⁻ᵇ after each cell, as a frame buffer of b bits a channel rounds them.
//
// No hardware blends in 12 bits, and few devices in 16. So 32-bit floats are blended about a number M = 2²³⁻ᵇ
// (`BLENDED_ABOUT`), where neighbouring floats lie 2⁻ᵇ apart: (1 − A_seg)(M + C) + (C_seg + A_seg M) = M + C_seg + (1 − A_seg) C.
// What is added, and the product, are rounded first, each by up to a quarter of a step, and their sum by up to half a one.
// Opacity stands in a picture of its own, since its own factor is 1 − A_seg, too.

struct Blended {
    @location(0) color: vec4f,
    @location(1) opacity: vec4f,
}

@group(1) @binding(4) var blended_opacity: texture_2d<f32>;

// A frame buffer of whole numbers holds 0 to 1.
fn blended_of(found: Contribution) -> Blended {
    let opacity = clamp(found.opacity, 0.0, 1.0);
    let shift = vec3f(opacity * BLENDED_ABOUT);
    let color = clamp(found.color, vec3f(0.0), vec3f(1.0));
    return Blended(vec4f(color + shift, opacity), vec4f(vec3f(opacity) + shift, opacity));
}

fn pixel_of(blended: vec4f, at: vec2u) -> vec4f {
    let opacity = textureLoad(blended_opacity, at, 0).x;
    return clamp(vec4f(blended.rgb, opacity) - BLENDED_ABOUT, vec4f(0.0), vec4f(1.0));
}
