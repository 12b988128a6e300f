// Uses: elementary/exponential. Fills: nothing.
// 1 − e^(−t), t ≥ 0. Under ½ the alternating series, nested (truncation 1e-8); above, the difference, which loses
// less than two bits. Twin of `lanes::optics::elementary::one_minus_exp`.

fn one_minus_exp(t: f32) -> f32 {
    let s = min(t, 0.5);
    var series = 1.0 / 40320.0;
    series = 1.0 / 5040.0 - s * series;
    series = 1.0 / 720.0 - s * series;
    series = 1.0 / 120.0 - s * series;
    series = 1.0 / 24.0 - s * series;
    series = 1.0 / 6.0 - s * series;
    series = 0.5 - s * series;
    series = 1.0 - s * series;
    return select(1.0 - exponential(-t), s * series, t < 0.5);
}
