// Uses: compositor/blended. Fills: blending.
// Colours over one another: each cell's before what is drawn already.

struct Blended {
    @location(0) color: vec4f,
}

fn blended_of(found: Contribution) -> Blended {
    return Blended(vec4f(found.color, found.opacity));
}

fn pixel_of(blended: vec4f) -> vec4f {
    return blended;
}
