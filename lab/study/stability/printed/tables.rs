//! Pre-integration as printed: the steps of the numerical integral, and the tiles that stand for the table.

use super::measured::{FormulaRow, PrintedFormula, between, error, segment};
use super::real::Real;
use std::f64::consts::PI;
use voltet_core::Result;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};

pub(super) fn entries() -> Result<Vec<PrintedFormula>> {
    Ok(vec![steps()?, emission(), tiles()])
}

/// Roettger & Ertl Eq. 5 in the depth of a Gaussian of width 1: Σ (l/n) ρ(w), w from S_b to S_f with both ends.
fn both_ends<T: Real>(count: u32, [front, back]: [T; 2]) -> T {
    let whole = |n: u32| T::round(f64::from(n));
    let place = |i: u32| back + whole(i) / (whole(count) - T::round(1.0)) * (front - back);
    let density = |w: T| (-(w * w)).exp();
    (0..count).fold(T::round(0.0), |sum, i| sum + density(place(i)) / whole(count))
}

fn steps() -> Result<PrintedFormula> {
    let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 0.0]] };
    let widget = Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
    let model = OpticalModel::DensityEmitter;
    let function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] };
    let mut rows = Vec::new();
    for (count, front, back) in
        [(0, 0.5, 0.5), (1, 0.0, 1.0), (2, 0.0, 1.0), (8, 0.0, 1.0), (64, 0.0, 1.0), (1024, 0.0, 1.0)]
    {
        let [exact, ours] = segment(&function, &between([front, 0.0], [back, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.optical_depth);
        rows.push(FormulaRow {
            inputs: format!("a Gaussian of width 1, S from {front:?} to {back:?}, {count} steps"),
            printed_64: error(both_ends(count, [front, back]), exact),
            printed_32: error(both_ends(count, [front as f32, back as f32]), exact),
            ours_32: ours.map(|found| error(found.optical_depth, exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Roettger & Ertl 2002, Eq. 5",
        formula: "w = S_b + i/(n − 1) (S_f − S_b), i = 0 … n − 1, each with the weight l/n",
        fails: "Both ends have the weight of a whole step, which is neither the midpoint nor the trapezoid rule: of first \
                order, whatever the precision. 0/0 for one step, and n = ⌈2 m |S_f − S_b|⌉ takes none where both ends are \
                equal.",
        instead: "Closed forms, which take no steps; `riemann` samples at the middles, (i + ½)/n, of second order at the \
                  same cost.",
        rows,
    })
}

fn emission() -> PrintedFormula {
    let row = |(depth, count): (f64, usize)| {
        // Constant κ = ρ: C = 1 − e^(−T).
        let exact = -(-depth).exp_m1();
        let h = depth / count as f64;
        let printed_64: f64 = (0..count).map(|i| h * (-h * i as f64).exp()).sum();
        let printed_32 =
            (0..count).fold(0.0_f32, |sum, i| sum + h as f32 * Real::exp(-(h as f32 * i as f32)));
        FormulaRow {
            inputs: format!("ρ l = {depth:?}, {count} steps"),
            printed_64: error(printed_64, exact),
            printed_32: error(printed_32, exact),
            ours_32: None,
        }
    };
    PrintedFormula {
        source: "Roettger & Ertl 2002, Eq. 6",
        formula: "C_(i+1) = κ h + C_i e^(−ρ h)",
        fails: "First order: a step's light is not absorbed within the step. The error is ρ l/2n, whatever the precision.",
        instead: "κ h E(ρ h), or ψ where both are linear: exact at any number of steps.",
        rows: [(1.0, 8), (10.0, 8), (100.0, 8), (100.0, 1024)].map(row).to_vec(),
    }
}

/// Eq. 10: (α, s, t).
fn to_tile<T: Real>([front, back, length]: [T; 3]) -> [T; 3] {
    let (zero, four, half) = (T::round(0.0), T::round(4.0), T::round(0.5));
    let rise = front - back;
    let fall = back - front;
    if rise >= zero && length <= rise {
        [length / (four * rise), rise, back]
    } else if rise >= zero {
        [half - rise / (four * length), length, back]
    } else if length >= fall {
        [half + fall / (four * length), length, back]
    } else {
        [T::round(1.0) - length / (four * fall), fall, back]
    }
}

/// Eq. 9: (S_f, S_b, l).
fn from_tile<T: Real>([angle, s, t]: [T; 3]) -> [T; 3] {
    let (one, four, half) = (T::round(1.0), T::round(4.0), T::round(0.5));
    if angle <= T::round(0.25) {
        [t + s, t, four * angle * s]
    } else if angle <= half {
        [t + four * (half - angle) * s, t, s]
    } else if angle <= T::round(0.75) {
        [t - four * (angle - half) * s, t, s]
    } else {
        [t - s, t, four * (one - angle) * s]
    }
}

/// The largest difference, absolute; ∞ where there is no number.
fn max_difference<T: Real, const N: usize>(found: [T; N], exact: [f64; N]) -> f64 {
    let apart = |(found, exact): (T, f64)| (found.wide() - exact).abs();
    let all = found.into_iter().zip(exact).map(apart);
    all.fold(0.0, |most, x| if x.is_nan() { f64::INFINITY } else { most.max(x) })
}

fn tiles() -> PrintedFormula {
    let there_and_back = |place: [f64; 3]| {
        let [front, back, length] = place;
        FormulaRow {
            inputs: format!("S_f = {front:?}, S_b = {back:?}, l = {length:?}, there and back, absolute"),
            printed_64: max_difference(from_tile(to_tile(place)), place),
            printed_32: max_difference(from_tile(to_tile(place.map(|x| x as f32))), place),
            ours_32: None,
        }
    };
    // Along a ray at an angle to ∇s, |∇s| = 1, S changes by the cosine of it.
    let turned = |degrees: f64| {
        let along = |angle: f64| [0.5 - 0.3 * (angle * PI / 180.0).cos(), 0.5, 0.3];
        let [thick, pixel] = [along(45.0), along(45.0 + degrees)];
        let of = |place: [f64; 3]| to_tile(place)[0];
        let of_32 = |place: [f64; 3]| to_tile(place.map(|x| x as f32))[0];
        FormulaRow {
            inputs: format!("α of the thick vertex at a pixel whose ray is turned by {degrees:?}°, absolute"),
            printed_64: max_difference([of(thick)], [of(pixel)]),
            printed_32: max_difference([of_32(thick)], [of(pixel)]),
            ours_32: Some(max_difference([of_32(pixel)], [of(pixel)])),
        }
    };
    let mut rows: Vec<FormulaRow> =
        [[0.7, 0.2, 0.3], [0.2, 0.7, 0.9], [0.500001, 0.5, 1e-7], [0.5, 0.5, 0.0]].map(there_and_back).into();
    rows.extend([0.0, 5.0, 15.0].map(turned));
    PrintedFormula {
        source: "Roettger & Ertl 2002, Eq. 9 and 10",
        formula: "f: (α, s, t) → (S_f, S_b, l) fills tiles, f⁻¹ reads them; α the same for all pixels of a cell",
        fails: "Eq. 10 is the inverse of Eq. 9 on all four branches, but 0/0 at S_f = S_b, l = 0. α follows from the angle \
                between ray and gradient: it is one for a whole cell if rays are parallel, not in perspective. Places of a tile \
                whose S_f is outside [0, 1] have no counterpart, and a linear filter reads them.",
        instead: "α from each pixel's own S_f, S_b and l, ½ where these vanish; places without a counterpart take the nearest \
                  that has one.",
        rows,
    }
}
