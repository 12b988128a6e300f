// Uses: elementary/erfcx, elementary/exponential, gaussian/path. Fills: nothing.
// Mean over a path of e^(−x² − h²) (Song et al. 2009, section 4.2; Kniss et al. 2003, Eq. 11), in forms that do not
// cancel. Mirrored so that |a| ≤ b:
// - 2 b d ≤ 1: e^(−x̄²) × the mean of e^(−y²) cosh(2 x̄ y), y ∈ [0, d/2], by Gauss-Legendre with 5 points;
// - else √π/2 ((a < 0: 2 − E_a; a ≥ 0: E_a) − E_b)/d with E_x = e^(−x²) erfcx |x|.
// Twin of `lanes::optics::gaussian::mean_profile`.

// e^(−y²) cosh(2 x̄ y) for y² ≤ ¼, 2 x̄ y ≤ ½: truncation 1e-7 and 1e-8.
fn gaussian_even_part(y: f32, middle: f32) -> f32 {
    let y2 = y * y;
    let gauss = 1.0 - y2 * (1.0 - y2 * (0.5 - y2 * (1.0 / 6.0 - y2 * (1.0 / 24.0 - y2 * (1.0 / 120.0)))));
    let w = 2.0 * middle * y;
    let w2 = w * w;
    return gauss * (1.0 + w2 * (0.5 + w2 * (1.0 / 24.0 + w2 * (1.0 / 720.0))));
}

fn gaussian_tail(x: f32, offset_squared: f32) -> f32 {
    return exponential(-(x * x + offset_squared)) * erfcx(abs(x));
}

fn gaussian_mean_profile(path: GaussianPath) -> f32 {
    let mirrored = path.front + path.back < 0.0;
    let low = select(path.front, -path.back, mirrored);
    let high = select(path.back, -path.front, mirrored);
    let h2 = path.offset_squared;
    if 2.0 * high * path.length <= 1.0 {
        let middle = (low + high) * 0.5;
        let half = path.length * 0.5;
        let quadrature = 0.28444445
            + 0.47862867 * gaussian_even_part(half * 0.5384693, middle)
            + 0.23692689 * gaussian_even_part(half * 0.90617985, middle);
        return exponential(-(middle * middle + h2)) * quadrature;
    }
    let tail_low = gaussian_tail(low, h2);
    let tail_high = gaussian_tail(high, h2);
    let across = select(tail_low, 2.0 * exponential(-h2) - tail_low, low < 0.0);
    return max(0.8862269 * (across - tail_high) * path.inverse, 0.0);
}
