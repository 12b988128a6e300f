// Uses: passes/view. Fills: nothing.
// Points on the screen, in coordinates that are whole numbers at the middles of pixels.

fn least(x: vec4f) -> f32 {
    return min(min(x.x, x.y), min(x.z, x.w));
}

fn most(x: vec4f) -> f32 {
    return max(max(x.x, x.y), max(x.z, x.w));
}

// Depth from the eye, of the cell's farthest, in front of which nothing is projected.
const CUT = 1e-4;

// z in front of which nothing of a cell is projected; `deepest` is the z of its farthest corner.
fn cut_before(deepest: f32) -> f32 {
    let farthest = deepest + view.distance;
    let cut = max(CUT * farthest, view.near + view.distance) - view.distance;
    return select(-FAR, cut, 0.0 < view.perspective);
}

// Where a point behind the cut is seen.
fn on_screen(p: vec3f) -> vec2f {
    let depth = select(1.0, p.z + view.distance, 0.0 < view.perspective);
    return p.xy / (depth * view.pixel) + view.axis;
}
