// Uses: elementary/one_minus_exp. Fills: nothing.
// (1 − e^(−x))/x, x ≥ 0: the mean transmittance of a homogeneous stretch.
// Twin of `lanes::optics::elementary::mean_transmittance`.

fn mean_transmittance(x: f32) -> f32 {
    let quotient = one_minus_exp(x) / max(x, 1e-4);
    return select(quotient, 1.0 - 0.5 * x, x < 1e-4);
}
