// Uses: nothing. Fills: nothing.
// e^(x²) erfc(x), x ≥ 0: (1 + 2x) erfcx(x) is smooth in t = (x − 2)/(x + 2) (Shepherd & Laframboise 1981); the
// polynomial of degree 11 is the one of the twin, `lanes::optics::elementary::erfcx`.

fn erfcx(distance: f32) -> f32 {
    // Beyond 1e9 it is 1/(x √π), and callers multiply it by an exponential that is 0.
    let x = min(distance, 1e9);
    let a = x + 2.0;
    let b = 2.0 * x + 1.0;
    let both = 1.0 / (a * b);
    let t = (x - 2.0) * (both * b);
    var sum = 6.3370986e-5;
    sum = sum * t + 0.0001608039;
    sum = sum * t - 0.00035792473;
    sum = sum * t - 0.0013957078;
    sum = sum * t + 0.0012174149;
    sum = sum * t + 0.00868916;
    sum = sum * t - 0.008018965;
    sum = sum * t - 0.05421196;
    sum = sum * t + 0.16404946;
    sum = sum * t - 0.16603109;
    sum = sum * t - 0.09276376;
    sum = sum * t + 1.2769784;
    return sum * (both * a);
}
