// Uses: wave/bell. Fills: wave_mean_on_flank.
// Mean of max(0, 1 − (1 − |sin πφ|)/w) between two places of one flank (Song et al. 2009, section 4.4).

const PI = 3.14159265;

// sin πx for 0 ≤ x ≤ ½: Taylor polynomial of degree 13 (7e-10 at ½).
fn sin_pi(x: f32) -> f32 {
    let y = x * PI;
    let y2 = y * y;
    var series = 1.0 / 6227020800.0;
    series = 1.0 / 39916800.0 - y2 * series;
    series = 1.0 / 362880.0 - y2 * series;
    series = 1.0 / 5040.0 - y2 * series;
    series = 1.0 / 120.0 - y2 * series;
    series = 1.0 / 6.0 - y2 * series;
    series = 1.0 - y2 * series;
    return y * series;
}

// 1 − sin(πx)/(πx) for 0 ≤ x ≤ ¼.
fn one_minus_sinc(x: f32) -> f32 {
    let y = x * PI;
    let y2 = y * y;
    return y2 * (1.0 / 6.0 - y2 * (1.0 / 120.0 - y2 * (1.0 / 5040.0 - y2 * (1.0 / 362880.0))));
}

fn sine_mean_on_flank(bell: Bell, low: Spot, high: Spot) -> f32 {
    if bell.is_full == 1u {
        let half = (high.foot - low.foot) * 0.5;
        return sin_pi((low.foot + high.foot) * 0.5) * (1.0 - one_minus_sinc(half));
    }
    let sine = sin_pi((low.peak + high.peak) * 0.25);
    let missing = one_minus_sinc((low.peak - high.peak) * 0.5);
    let away = 2.0 * sine * sine * (1.0 - missing) + missing;
    return max(1.0 - away * bell.inverse_width, 0.0);
}
