//! Optical depth and opacity as printed.

use super::colors::rectangle;
use super::measured::{FormulaRow, PrintedFormula, between, error, ours, segment};
use super::real::Real;
use std::f64::consts::PI;
use voltet_core::Result;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_optics::Contribution;

pub(super) fn entries() -> Result<Vec<PrintedFormula>> {
    Ok(vec![gaussian()?, offset()?, mean()?, triangular()?, opacity()?, chain()?])
}

/// Kniss Eq. 11 and 12, from q = K (v − c) at both ends.
fn gaussian_depth<T: Real>(front: [T; 2], back: [T; 2]) -> T {
    let d = [back[0] - front[0], back[1] - front[1]];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let a = (front[0] * d[0] + front[1] * d[1]) / length;
    let b = a + length;
    let s = (a * a - (front[0] * front[0] + front[1] * front[1])).exp();
    T::round(PI.sqrt() / 2.0) * s / length * (b.erf() - a.erf())
}

/// One Gaussian of width 1 (K the identity) and peak depth 1.
fn look(centre: [f64; 2], width: f64) -> TransferFunction {
    let matrix = [[1.0 / width, 0.0], [0.0, 1.0 / width]];
    let profile = Profile::Gaussian { centre, matrix };
    let widget = Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets: vec![widget] }
}

fn gaussian() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for [a, d, h] in [
        [-0.5, 1.0, 0.3],
        [3.0, 1.0, 0.0],
        [5.0, 1.0, 0.0],
        [6.0, 1.0, 0.0],
        [1.0, 1e-6, 0.5],
        [1.0, 1e-10, 0.5],
        [-1e4, 1e4 + 1.0, 0.5],
        [4.0, 1e-3, 5.0],
    ] {
        let (front, back) = ([a, h], [a + d, h]);
        let [exact, ours] = segment(&look([0.0; 2], 1.0), &between(front, back, 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.optical_depth);
        let to_32 = |v: [f64; 2]| v.map(|x| x as f32);
        rows.push(FormulaRow {
            inputs: format!("a = {a:?}, |d| = {d:?}, h = {h:?}"),
            printed_64: error(gaussian_depth(front, back), exact),
            printed_32: error(gaussian_depth(to_32(front), to_32(back)), exact),
            ours_32: ours.map(|found| error(found.optical_depth, exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Kniss et al. 2003, Eq. 11 and 12",
        formula: "T = (√π/2) S/|d| (erf B − erf A), S = exp(A² − |v₁'|²), A = v₁'·d/|d|, B = A + |d|",
        fails: "Right as mathematics. The difference of erf cancels where both ends are on one side of the centre (every \
                digit is gone 6 widths out) and where the segment is flat; A² − |v₁'|² cancels where the ray passes far \
                from the centre; B = A + |d| loses the digits of an end near the centre. Eq. 2 prints vᵀKv where Eq. 12 \
                integrates vᵀKᵀKv.",
        instead: "Both ends of the path from their own differences, the distance of the line from the centre at the \
                  nearer end, and three branches: Gauss-Legendre points where the profile changes little, erf across \
                  the centre, erfcx on one side.",
        rows,
    })
}

fn offset() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for (offset, width) in [(0.0, 1e-2), (1e4, 1e-2), (1e8, 1e-2)] {
        let (centre, [front, back]) = (offset + 0.25 * width, [offset, offset + width]);
        let [exact, ours] = segment(&look([centre, 0.0], width), &between([front, 0.0], [back, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.optical_depth);
        let k = 1.0 / width;
        let printed_64 = gaussian_depth([k * front - k * centre, 0.0], [k * back - k * centre, 0.0]);
        let in_32 = |v: f64| k as f32 * v as f32 - (k as f32 * centre as f32);
        let printed_32 = gaussian_depth([in_32(front), 0.0], [in_32(back), 0.0]);
        rows.push(FormulaRow {
            inputs: format!("values near {offset:?}, width {width:?}"),
            printed_64: error(printed_64, exact),
            printed_32: error(printed_32, exact),
            ours_32: ours.map(|found| error(found.optical_depth, exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Kniss et al. 2003, Table 2, line 1",
        formula: "v' = K v − c', c' = K c",
        fails: "The difference is taken after the product, of two large numbers.",
        instead: "K (v − c), the difference first, in 64 bits before anything is rounded to 32.",
        rows,
    })
}

/// Kniss Eq. 16.
fn igauss<T: Real>(x1: T, x2: T) -> T {
    if x1 == x2 {
        return (-(x1 * x1)).exp();
    }
    T::round(PI.sqrt() / 2.0) * (x1.erf() - x2.erf()) / (x1 - x2)
}

fn mean() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for [x1, x2] in [[1.0, 0.0], [1.001, 1.0], [1.0 + 1e-8, 1.0], [5.01, 5.0], [8.01, 8.0]] {
        let [exact, ours] = segment(&look([0.0; 2], 1.0), &between([x2, 0.0], [x1, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.optical_depth);
        rows.push(FormulaRow {
            inputs: format!("x₁ = {x1:?}, x₂ = {x2:?}"),
            printed_64: error(igauss(x1, x2), exact),
            printed_32: error(igauss(x1 as f32, x2 as f32), exact),
            ours_32: ours.map(|found| error(found.optical_depth, exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Kniss et al. 2003, Eq. 16",
        formula: "IGauss(x₁, x₂) = (√π/2) (erf x₁ − erf x₂)/(x₁ − x₂)",
        fails: "The same difference, and the test x₁ = x₂ comes too late: near it every digit is lost.",
        instead: "The mean of e^(−x²) by the three branches above.",
        rows,
    })
}

fn triangular() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for front in [0.9, 0.5, 0.1] {
        let mut worst = [0.0_f64; 3];
        for step in 0..=60 {
            // s runs by one unit over widths of σ g, centred all along the ramp.
            let start = -1.5 + 0.05 * f64::from(step);
            let profile = Profile::TriangularGaussian { centre: 0.0, sigma: 1.0 };
            let widget = Widget { profile, color: [1.0; 3], extinction: 1.0, region: None };
            let model = OpticalModel::DensityEmitter;
            let function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] };
            let [exact, ours] = segment(&function, &between([start, front], [start + 1.0, 1.0], 1.0))?;
            let exact = exact.map_or(f64::NAN, |found| found.optical_depth);
            let g = 0.5 * (front + 1.0);
            let printed = igauss((start + 1.0) / g, start / g);
            let printed_32 = igauss(((start + 1.0) / g) as f32, (start / g) as f32);
            let ours = ours.map_or(f64::NAN, |found| found.optical_depth);
            for (worst, found) in worst.iter_mut().zip([printed, printed_32.wide(), ours]) {
                *worst = worst.max((found - exact).abs());
            }
        }
        rows.push(FormulaRow {
            inputs: format!("g from {front} to 1, worst of 61 places, absolute"),
            printed_64: worst[0],
            printed_32: worst[1],
            ours_32: Some(worst[2]),
        });
    }
    Ok(PrintedFormula {
        source: "Kniss et al. 2003, section 5.2.1",
        formula: "triangular Gaussian with g replaced by its mean over the segment",
        fails: "No rounding: g changes along the segment, and the profile with it.",
        instead: "The ratio (s − s₀)/(σ g) is monotone along the ray: panels between its level lines, Gauss-Legendre \
                  points on each.",
        rows,
    })
}

fn opacity() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for depth in [1.0, 1e-3, 1e-5, 1e-8, 1e-16] {
        let profile = Profile::Uniform;
        let region = Some(rectangle([-1.0, 2.0]));
        let widget = Widget { profile, color: [1.0; 3], extinction: depth, region };
        let model = OpticalModel::DensityEmitter;
        let function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] };
        let [exact, ours] = segment(&function, &between([0.0; 2], [1.0, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.opacity);
        rows.push(FormulaRow {
            inputs: format!("T = {depth:?}"),
            printed_64: error(1.0 - (-depth).exp(), exact),
            printed_32: error(1.0_f32 - Real::exp(-(depth as f32)), exact),
            ours_32: ours.map(|found| error(found.opacity, exact)),
        });
    }
    Ok(PrintedFormula {
        source: "every paper (Max 1995)",
        formula: "A = 1 − e^(−T)",
        fails: "The difference cancels for thin segments, of which a picture has hundreds on a pixel.",
        instead: "−expm1(−T); in 32 bits a polynomial under T = 0.5.",
        rows,
    })
}

fn chain() -> Result<PrintedFormula> {
    let forms = ours()?;
    let row = |(count, depth): (usize, f64)| {
        let opacity = -(-depth).exp_m1();
        let exact = (-depth * count as f64).exp();
        let printed_64 = (0..count).fold(0.0_f64, |sum, _| sum + (1.0 - sum) * opacity);
        let printed_32 = (0..count).fold(0.0_f32, |sum, _| sum + (1.0 - sum) * opacity as f32);
        let parts = vec![Contribution { opacity, ..Contribution::default() }; count];
        let ours = forms.chain(&parts).transparency;
        FormulaRow {
            inputs: format!("{count} segments of T = {depth:?}"),
            printed_64: error(1.0 - printed_64, exact),
            printed_32: error(1.0 - printed_32, exact),
            ours_32: ours.map(|found| error(found, exact)),
        }
    };
    Ok(PrintedFormula {
        source: "front-to-back compositing (Porter & Duff 1984)",
        formula: "A ← A + (1 − A) a, transparency 1 − A",
        fails: "The transparency keeps an absolute 6e-8 (1e-16) only, so what lies behind a dense part has no digits.",
        instead: "The transparency itself is carried along: τ ← τ (1 − a).",
        rows: [(100, 0.05), (1000, 0.01), (1000, 0.02), (1000, 0.04)].map(row).to_vec(),
    })
}
