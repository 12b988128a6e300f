// Uses: nothing. Fills: nothing.
// A path through a Gaussian, relative to its centre, in widths: q = K (v − v₀), d = |q_b − q_f|, a and b the distances
// of the ends along the line from the foot of the perpendicular, h its distance from the centre (Song et al. 2009,
// section 4.2). Twin of `lanes::optics::gaussian::LaneGaussianPath`.

struct GaussianPath {
    // a.
    front: f32,
    // b, ≥ a.
    back: f32,
    // d; 0 for a segment without extent.
    length: f32,
    // 1/d; 0 for a segment without extent.
    inverse: f32,
    // h².
    offset_squared: f32,
}

// 1/√x, 0 where x is too small for a segment to have an extent.
fn gaussian_inverse_length(squared: f32) -> f32 {
    return select(1.0 / sqrt(max(squared, 1e-30)), 0.0, squared <= 1e-30);
}

// The t between which the profile exceeds e^(−level), not clamped to the path; the first above the second where it
// nowhere does.
fn gaussian_window_ends(path: GaussianPath, level: f32) -> vec2f {
    let room = level - path.offset_squared;
    let half = min(sqrt(max(room, 0.0)), 1e18);
    let flat = path.length <= 0.0;
    let start = select((-half - path.front) * path.inverse, -1.0, flat);
    let end = select((half - path.front) * path.inverse, 2.0, flat);
    return vec2f(start, select(start - 1.0, end, 0.0 < room));
}
