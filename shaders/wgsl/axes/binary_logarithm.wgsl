// Uses: nothing. Fills: nothing.
// log₂ of a normal number as a sum of two, so that what is counted from near it keeps its digits.

struct BinaryLogarithm {
    // The exponent, exact.
    whole: f32,
    // log₂ of the significand, 0 to 1 (the device's own, to 5e-7).
    rest: f32,
}

fn binary_logarithm(x: f32) -> BinaryLogarithm {
    let bits = bitcast<u32>(x);
    let significand = bitcast<f32>((bits & 0x007fffffu) | 0x3f800000u);
    return BinaryLogarithm(f32(i32(bits >> 23u) - 127), log2(significand));
}
