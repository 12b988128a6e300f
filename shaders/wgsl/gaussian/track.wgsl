// Uses: gaussian/path, track. Fills: nothing.
// A Gaussian along a segment, as the quadrature sees it. Twin of `lanes::optics::gaussian::LaneGaussianTrack`.

struct GaussianTrack {
    // x at the front.
    front: f32,
    // x at the back, ≥ front.
    back: f32,
    // Their difference.
    length: f32,
    // ρ₀ D e^(−h²).
    peak: f32,
}

// How far 8 points resolve e^(−x²) from x on: over 1.2 about the centre, and where x² changes by 3 further out.
const GAUSSIAN_STEP = 1.2;
// e^(−49) = 5e-22: beyond it nothing is resolved.
const GAUSSIAN_FAR = 7.0;

fn gaussian_track(path: GaussianPath, peak: f32) -> GaussianTrack {
    return GaussianTrack(path.front, path.back, path.length, peak * exponential(-path.offset_squared));
}

fn gaussian_rates(track: GaussianTrack, at: vec4f) -> vec4f {
    let x = along(track.front, track.back, at);
    return track.peak * transmittances(x * x);
}

fn gaussian_next_break(track: GaussianTrack, t: f32) -> f32 {
    let x = (track.back - track.front) * t + track.front;
    var step = min(1.5 / max(abs(x), 0.1), GAUSSIAN_STEP);
    step = select(step, -GAUSSIAN_FAR - x, x < -GAUSSIAN_FAR);
    let next = t + max(step / max(track.length, 1e-30), 2.0 * PASSED);
    return select(2.0, next, x < GAUSSIAN_FAR);
}
