// Uses: axes/binary_logarithm. Fills: nothing. Asks for: numbers.
// A logarithmic axis: log₁₀ of the value. Numbers of an axis stand as `axes/curved` says.

// Position of a stored value > 0, as widgets' numbers are stored.
fn log_position(axis: u32, value: f32) -> f32 {
    let log = binary_logarithm(value);
    return number(axis) * ((log.whole - number(axis + 1u)) + (log.rest - number(axis + 2u)));
}

// The value there, to some units in the fifth digit.
fn log_value(axis: u32, position: f32) -> f32 {
    return exp2(position / number(axis) + (number(axis + 1u) + number(axis + 2u)));
}
