// Uses: compositor/blended, elementary/one_minus_exp. Fills: blending.
// One colour: C = c A whatever the order, so that one number a pixel is enough. Optical depths are added; where
// silhouettes give every segment a factor of its own, opacities are composited.

fn blended_of(found: Contribution) -> vec4f {
    return vec4f(select(found.opacity, found.optical_depth, DEPTHS_ADD_UP));
}

fn pixel_of(blended: vec4f) -> vec4f {
    let opacity = select(blended.x, one_minus_exp(blended.x), DEPTHS_ADD_UP);
    return vec4f(scene.widgets[0].color * opacity, opacity);
}
