//! exp, expm1, ln, powers and erfcx in 32-bit lanes.

use crate::{Float, Lanes, Mask, Unsigned};

/// √π/2.
pub const HALF_SQRT_PI: f32 = 0.886_226_9;

/// c₀ + x (c₁ + x (c₂ + …)).
#[inline(always)]
pub fn polynomial<L: Lanes, const N: usize>(x: L::F, coefficients: [f32; N]) -> L::F {
    let mut sum = L::F::splat(coefficients[N - 1]);
    for &c in coefficients[..N - 1].iter().rev() {
        sum = sum.mul_add(x, L::F::splat(c));
    }
    sum
}

/// a · b.
#[inline(always)]
pub fn dot<L: Lanes, const N: usize>(a: &[L::F; N], b: &[L::F; N]) -> L::F {
    let mut sum = a[0] * b[0];
    for i in 1..N {
        sum = a[i].mul_add(b[i], sum);
    }
    sum
}

/// e^x, within 2 ulp for −87.3 ≤ x ≤ 88; 0 below −87.7, e^88 above 88.
///
/// x = n ln 2 + r, |r| ≤ ½ ln 2; ln 2 in two parts (Cody & Waite 1980). The best polynomial of degree 6 that begins with 1 + r
/// (Remez) leaves 5e-9 of e^r, as the Taylor polynomial of degree 7 does. It is summed in pairs (Estrin 1960): a sum term by term
/// would keep a processor waiting.
#[inline(always)]
pub fn exp<L: Lanes>(x: L::F) -> L::F {
    // At −88 n is −127, and 2^n, made of its bits, 0.
    of_clamped::<L>(x.max(L::F::splat(-88.0)).min(L::F::splat(88.0)))
}

/// e^(−x) for x ≥ 0, as [`exp`].
#[inline(always)]
pub fn exp_down<L: Lanes>(x: L::F) -> L::F {
    of_clamped::<L>(-x.min(L::F::splat(88.0)))
}

/// e^x for −88 ≤ x ≤ 88.
#[inline(always)]
fn of_clamped<L: Lanes>(clamped: L::F) -> L::F {
    let splat = L::F::splat;
    // Rounds to whole numbers, as there are no others beside 1.5 × 2²³.
    let shifted = clamped.mul_add(splat(std::f32::consts::LOG2_E), splat(SHIFT));
    let n = shifted - splat(SHIFT);
    let r = n.mul_add(splat(-0.693_359_4), clamped);
    let r = n.mul_add(splat(2.121_944_4e-4), r);
    let square = r * r;
    let second = r.mul_add(splat(0.166_665_2), splat(0.499_999_93));
    let fourth = r.mul_add(splat(0.008_368_717), splat(0.041_668_39));
    let fourth = square.mul_add(splat(0.001_381_459_9), fourth);
    let series = (square * square).mul_add(fourth, square.mul_add(second, r + splat(1.0)));
    series * L::F::from_bits(shifted.to_bits().shl::<23>())
}

/// Added to n it is a number that ends with the bits of n + 127, the exponent of 2^n.
const SHIFT: f32 = 12_582_912.0 + 127.0;

/// 1 − e^(−t) for t ≥ 0, within 3 ulp.
///
/// Under ½ the alternating series, nested (truncation 1e-8; two terms fewer leave 4e-6); above, the difference,
/// which loses less than two bits.
#[inline(always)]
pub fn one_minus_exp<L: Lanes>(t: L::F) -> L::F {
    let splat = L::F::splat;
    let series = t * polynomial::<L, 8>(-t, ONE_MINUS_EXP);
    let small = t.lt(splat(0.5));
    if !small.not().any() {
        return series;
    }
    L::F::select(small, series, splat(1.0) - exp::<L>(-t))
}

/// (1 − e^(−t))/t for t ≥ 0, 1 at 0, within 4 ulp.
///
/// Under ½ by the series of [`one_minus_exp`].
#[inline(always)]
pub fn mean_transparency<L: Lanes>(t: L::F) -> L::F {
    let splat = L::F::splat;
    let series = polynomial::<L, 8>(-t, ONE_MINUS_EXP);
    let small = t.lt(splat(0.5));
    if !small.not().any() {
        return series;
    }
    L::F::select(small, series, (splat(1.0) - exp::<L>(-t)) / t)
}

/// [`mean_transparency`] and e^(−t), for t ≥ 0.
#[inline(always)]
pub fn transparencies<L: Lanes>(t: L::F) -> (L::F, L::F) {
    let splat = L::F::splat;
    let mean = polynomial::<L, 8>(-t, ONE_MINUS_EXP);
    let through = splat(1.0) - t * mean;
    let small = t.lt(splat(0.5));
    if !small.not().any() {
        return (mean, through);
    }
    // Of what is opaque the difference would leave a rounding of 1.
    let exact = exp::<L>(-t);
    (L::F::select(small, mean, (splat(1.0) - exact) / t), L::F::select(small, through, exact))
}

/// (1 − e^(−t))/t in powers of −t.
const ONE_MINUS_EXP: [f32; 8] =
    [1.0, 1.0 / 2.0, 1.0 / 6.0, 1.0 / 24.0, 1.0 / 120.0, 1.0 / 720.0, 1.0 / 5040.0, 1.0 / 40320.0];

/// ln x, within 3 ulp of the larger of 1 and |ln x|, for normal x > 0.
///
/// x = 2^e m, √½ ≤ m < √2, and ln m = 2 artanh((m − 1)/(m + 1)); five terms of the series leave 4e-9.
#[inline(always)]
pub fn ln<L: Lanes>(x: L::F) -> L::F {
    let splat = L::F::splat;
    // Adding what √½ lacks to 1 carries into the exponent where m ≥ √2.
    let shifted = x.to_bits() + L::U::splat(0x3f80_0000 - 0x3f35_04f3);
    let exponent = shifted.shr::<23>().to_float() - splat(127.0);
    let mantissa = shifted.and(L::U::splat(0x007f_ffff)) + L::U::splat(0x3f35_04f3);
    let m = L::F::from_bits(mantissa);
    let s = (m - splat(1.0)) / (m + splat(1.0));
    let square = s * s;
    let series = polynomial::<L, 4>(square, [2.0 / 3.0, 2.0 / 5.0, 2.0 / 7.0, 2.0 / 9.0]);
    let of_m = (s * square).mul_add(series, s + s);
    exponent.mul_add(splat(0.693_359_4), exponent.mul_add(splat(-2.121_944_4e-4), of_m))
}

/// x^p for 0 ≤ x ≤ 1 and p > 0; relative error 1e-7 (2 + |p ln x|). 0 where x is not a normal number.
#[inline(always)]
pub fn power<L: Lanes>(x: L::F, p: L::F) -> L::F {
    let splat = L::F::splat;
    let least = splat(f32::MIN_POSITIVE);
    L::F::select(x.lt(least), splat(0.0), exp::<L>(ln::<L>(x.max(least)) * p))
}

/// e^(x²) erfc(x) for x ≥ 0, relative error 2e-7.
///
/// (1 + 2x) erfcx(x) is smooth in t = (x − 2)/(x + 2) over all x ≥ 0 (the substitution of Shepherd & Laframboise
/// 1981); Chebyshev fit of degree 11 made in 40 digits.
#[inline(always)]
pub fn erfcx<L: Lanes>(x: L::F) -> L::F {
    let splat = L::F::splat;
    // One division serves both quotients: 1/((x + 2)(1 + 2x)). Beyond 1e9 the product would leave f32; there
    // erfcx is 1/(x √π), and callers multiply it by an exponential that is 0.
    let x = x.min(splat(1e9));
    let (a, b) = (x + splat(2.0), x.mul_add(splat(2.0), splat(1.0)));
    let both = splat(1.0) / (a * b);
    let t = (x - splat(2.0)) * (both * b);
    let series = polynomial::<L, 12>(
        t,
        [
            1.276_978_4,
            -0.092_763_76,
            -0.166_031_09,
            0.164_049_46,
            -0.054_211_96,
            -0.008_018_965,
            0.008_689_16,
            0.001_217_414_9,
            -0.001_395_707_8,
            -0.000_357_924_73,
            0.000_160_803_9,
            6.337_098_6e-5,
        ],
    );
    series * (both * a)
}

/// Dawson's function e^(−x²) ∫₀ˣ e^(t²) dt for x ≥ 0, relative error 2e-6.
///
/// (1 + 2x²)/x times it is smooth in t = (x² − 12)/(x² + 12) over all x ≥ 0; Chebyshev fit of degree 17, which leaves 1.4e-7.
#[inline(always)]
pub fn dawson<L: Lanes>(x: L::F) -> L::F {
    let splat = L::F::splat;
    // One division serves both quotients. Beyond 1e9 the product would leave f32; callers multiply by what is 0 there.
    let x = x.min(splat(1e9));
    let square = x * x;
    let (a, b) = (square + splat(12.0), square.mul_add(splat(2.0), splat(1.0)));
    let both = splat(1.0) / (a * b);
    let t = (square - splat(12.0)) * (both * b);
    let series = polynomial::<L, 18>(
        t,
        [
            1.092_220_2,
            -0.208_443_21,
            0.275_991_1,
            -0.395_349_1,
            0.556_489_7,
            -0.595_112_8,
            0.135_318_2,
            0.944_926_4,
            -1.684_813_4,
            0.781_612_8,
            0.884_526_1,
            -0.919_356_35,
            -0.345_036_98,
            0.568_415_1,
            0.100_945_44,
            -0.213_775_07,
            -0.015_640_555,
            0.037_082_3,
        ],
    );
    x * series * (both * a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::portable::Portable;
    use crate::{Kernel, LaneSet, dispatch};

    struct Exponentials([f32; 16]);

    impl Kernel<[f32; 16]> for Exponentials {
        #[inline(always)]
        fn run<L: Lanes>(self) -> [f32; 16] {
            let mut found = [f32::NAN; 16];
            for at in (0..16).step_by(L::WIDTH) {
                exp::<L>(L::F::load(&self.0[at..])).store(&mut found[at..]);
            }
            found
        }
    }

    #[test]
    fn exp_ends_in_0_and_in_a_number() {
        let mut x = [0.0; 16];
        x[..4].copy_from_slice(&[-87.7, -88.0, -1e30, f32::NEG_INFINITY]);
        x[4..9].copy_from_slice(&[-87.6, -87.3, -0.0, 88.1, f32::INFINITY]);
        for lanes in LaneSet::ALL.into_iter().filter(|lanes| lanes.is_supported()) {
            let found = dispatch(lanes, Exponentials(x));
            assert_eq!(found[..4], [0.0; 4], "{}", lanes.name());
            for (x, found) in x[4..].iter().zip(&found[4..]) {
                let exact = f64::from(*x).min(88.0).exp();
                // Numbers under 1.2e-38 lie 1.4e-45 apart.
                let error = (f64::from(*found) - exact).abs() - 1.4e-45;
                assert!(error <= 2.4e-7 * exact, "{x} on {}: {found:e} for {exact:e}", lanes.name());
            }
        }
    }

    /// The rounding of ln m (3e-8 at √2) averages out over neighbours; what the series leaves does not, and is 3e-8 there
    /// with a term less.
    #[test]
    fn the_series_of_ln_has_all_its_terms() {
        const COUNT: u32 = 20_000;
        let below_root_2 = |k: u32| 1.4 + 0.014 * (f64::from(k) + 0.5) / f64::from(COUNT);
        let error = |x: f64| {
            let x = x as f32;
            let mut found = [0.0; Portable::WIDTH];
            ln::<Portable>(<Portable as Lanes>::F::splat(x)).store(&mut found);
            f64::from(found[0]) - f64::from(x).ln()
        };
        let mean = (0..COUNT).map(|k| error(below_root_2(k))).sum::<f64>() / f64::from(COUNT);
        assert!(mean.abs() < 8e-9, "{mean:e}");
    }
}
