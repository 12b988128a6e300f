// Uses: axes/binary_logarithm. Fills: nothing. Asks for: numbers.
// A symmetric logarithmic axis: sign(x) log₁₀(1 + |x|/c). Numbers of an axis stand as `axes/curved` says.

// Position of a stored value, as widgets' numbers are stored.
fn symlog_position(axis: u32, value: f32) -> f32 {
    let log = binary_logarithm(1.0 + abs(value) * number(axis + 6u));
    let turn = select(1.0, -1.0, value < 0.0);
    return number(axis) * ((turn * log.whole - number(axis + 1u)) + (turn * log.rest - number(axis + 2u)));
}

// The value there, to some units in the fifth digit of 1 + |x|/c.
fn symlog_value(axis: u32, position: f32) -> f32 {
    let log = position / number(axis) + (number(axis + 1u) + number(axis + 2u));
    let size = (exp2(abs(log)) - 1.0) / number(axis + 6u);
    return select(size, -size, log < 0.0);
}
