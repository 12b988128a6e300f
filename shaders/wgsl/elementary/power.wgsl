// Uses: nothing. Fills: nothing.
// x^p for 0 ≤ x ≤ 1, p > 0; 0 where x is not a normal number. Twin of `lanes::optics::elementary::power`.

fn power(x: f32, p: f32) -> f32 {
    return select(pow(max(x, 1.2e-38), p), 0.0, x < 1.2e-38);
}
