// Uses: compositor/blended. Fills: blending.
// Colours over one another: each cell's before what is drawn already.

fn blended_of(found: Contribution) -> vec4f {
    return vec4f(found.color, found.opacity);
}

fn pixel_of(blended: vec4f) -> vec4f {
    return blended;
}
