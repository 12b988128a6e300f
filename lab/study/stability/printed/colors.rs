//! Colours as printed: the constant-emitter's closed forms, the integrals of linear extinction, pre-integration, the mix.

use super::measured::{FormulaRow, PrintedFormula, between, error, partial, segment};
use super::real::{Real, integral};
use std::f64::consts::PI;
use voltet_core::Result;
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use voltet_optics::{CompiledTransferFunction, WidgetBlend, linear};

pub(super) fn entries() -> Result<Vec<PrintedFormula>> {
    Ok(vec![uniform()?, gaussian()?, triangle()?, falling_flank()?, sine()?, psi()?, back()?, mix()?])
}

/// One widget of the constant-emitter: white, unit distance 1.
fn glowing(profile: Profile, extinction: f64) -> TransferFunction {
    // A uniform widget needs a region; this one holds every segment below.
    let region = profile.properties().needs_region.then(|| rectangle([-1.0, 2.0]));
    let widget = Widget { profile, color: [1.0; 3], extinction, region };
    let model = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };
    TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] }
}

/// All g of a range of s.
pub(super) fn rectangle([low, high]: [f64; 2]) -> Region {
    Region { corners: vec![[low, -1.0], [high, -1.0], [high, 1.0], [low, 1.0]] }
}

fn uniform() -> Result<PrintedFormula> {
    let printed = |depth: f64| (1.0 - (-depth).exp()) / depth;
    let mut rows = Vec::new();
    for depth in [1.0, 1e-3, 1e-8, 1e-20] {
        let [exact, ours] = segment(&glowing(Profile::Uniform, depth), &between([0.0; 2], [1.0, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.color[0]);
        let printed_32 = (1.0_f32 - Real::exp(-(depth as f32))) / depth as f32;
        rows.push(FormulaRow {
            inputs: format!("a D = {depth:?}"),
            printed_64: error(printed(depth), exact),
            printed_32: error(printed_32, exact),
            ours_32: ours.map(|found| error(found.color[0], exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Song et al. 2009, Eq. 5",
        formula: "C = (c/a) (1 − e^(−a D))",
        fails: "The difference cancels where the segment is thin; 0/0 at a = 0.",
        instead: "c D E(a D), E(x) = −expm1(−x)/x, and its series for small x.",
        rows,
    })
}

/// Song section 4.2 for a path at distance 0 from the centre: C = e^(P erf B)/A (table(P, A + B) − table(P, B)), with
/// table(P, t) = ∫₀ᵗ e^(−P erf x) dx as exact as the precision holds it.
fn gaussian_glow<T: Real>(peak: T, a: T, b: T) -> T {
    let d = b - a;
    let p = peak * T::round(PI.sqrt() / 2.0) / d;
    let table = |t: T| integral(T::round(0.0), t, |x| (-(p * x.erf())).exp());
    (p * a.erf()).exp() / d * (table(b) - table(a))
}

fn gaussian() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for (peak, a, b) in
        [(1.0, -0.5, 0.5), (1.0, 0.5, 0.51), (1.0, 0.5, 0.501), (10.0, 0.0, 0.05), (1.0, 1.0, 1.0 + 1e-6)]
    {
        let matrix = [[1.0, 0.0], [0.0, 1.0]];
        let function = glowing(Profile::Gaussian { centre: [0.0; 2], matrix }, peak);
        let [exact, ours] = segment(&function, &between([a, 0.0], [b, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.color[0]);
        rows.push(FormulaRow {
            inputs: format!("ρ₀ D = {peak:?}, x from {a:?} to {b:?}"),
            printed_64: error(gaussian_glow(peak, a, b), exact),
            printed_32: error(gaussian_glow(peak as f32, a as f32, b as f32), exact),
            ours_32: ours.map(|found| error(found.color[0], exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Song et al. 2009, section 4.2",
        formula: "C = c e^(P erf B)/A [table(P, A D + B) − table(P, B)], table(P, t) = ∫₀ᵗ e^(−P erf x) dx",
        fails: "Even with an exact table: P = √π ρ₀ D/(2|d|) is huge wherever the data vary slowly, and e^(P erf B) leaves \
                64 bits at P = 709 and 32 bits at 88; before that the difference of the entries cancels.",
        instead: "No table: Gauss-Legendre points on panels of depth 2 at most, depths in closed form, counted from the \
                  panel's own start.",
        rows,
    })
}

/// Song section 4.3, the increasing part: extinction k x for x from d1 to d2.
fn rising<T: Real>(k: T, d1: T, d2: T) -> T {
    let half = k / T::round(2.0);
    let root = half.sqrt();
    let factor = (T::round(PI) / (T::round(2.0) * k)).sqrt() * (half * d1 * d1).exp();
    factor * ((root * d2).erf() - (root * d1).erf())
}

fn triangle() -> Result<PrintedFormula> {
    let row = |[k, d1, d2]: [f64; 3]| {
        let length = d2 - d1;
        let (exact, ours) = partial(k * d1 * length, k * d2 * length, |found| found.psi * length)?;
        Ok(FormulaRow {
            inputs: format!("α/Δt = {k:?}, from {d1:?} to {d2:?}"),
            printed_64: error(rising(k, d1, d2), exact),
            printed_32: error(rising(k as f32, d1 as f32, d2 as f32), exact),
            ours_32: ours.map(|found| error(found, exact)),
        })
    };
    Ok(PrintedFormula {
        source: "Song et al. 2009, section 4.3, increasing part",
        formula: "C = c √(π/2k) e^(k d₁²/2) [erf(√(k/2) d₂) − erf(√(k/2) d₁)], k = α/Δt",
        fails: "erf − erf cancels past the first few units of √(k/2) d₁, while e^(k d₁²/2) grows: 32 bits overflow at \
                k d₁² = 177, 64 bits at 1,419.",
        instead: "ψ of linear extinction by erfcx, whose growth is taken out beforehand; Gauss-Legendre points where the \
                  depth is small. Flanks that rise and fall are cases of the one formula.",
        rows: [[3.08, 0.1, 0.9], [50.0, 0.5, 0.9], [50.0, 1.0, 1.1], [200.0, 0.9, 1.0], [2000.0, 0.9, 1.0]]
            .into_iter()
            .map(row)
            .collect::<Result<_>>()?,
    })
}

/// Song section 4.3, the decreasing part: extinction α (1 − x/Δt) for x/Δt from u3 to u4, in units of Δt. `front` and `table`:
/// α Δt/2 of the factor and of the integral, which a table holds as exactly as the precision does.
fn falling<T: Real>(front: T, table: T, [u3, u4]: [T; 2]) -> T {
    let left = |u: T| (T::round(1.0) - u) * (T::round(1.0) - u);
    (-(front * left(u3))).exp() * integral(u3, u4, |u| (table * left(u)).exp())
}

fn falling_flank() -> Result<PrintedFormula> {
    let row = |(depth, made_for, [u3, u4]): (f64, f64, [f64; 2])| {
        let length = u4 - u3;
        let (a, b) = (depth * (1.0 - u3) * length, depth * (1.0 - u4) * length);
        let (exact, ours) = partial(a, b, |found| found.psi * length)?;
        let (front, table) = (0.5 * depth, 0.5 * made_for);
        let entry = if made_for == depth {
            String::new()
        } else {
            format!(", the table's entry made at {made_for:?}")
        };
        Ok(FormulaRow {
            inputs: format!("α Δt = {depth:?}, from {u3:?} to {u4:?} of Δt{entry}"),
            printed_64: error(falling(front, table, [u3, u4]), exact),
            printed_32: error(falling(front as f32, table as f32, [u3 as f32, u4 as f32]), exact),
            ours_32: ours.map(|found| error(found, exact)),
        })
    };
    let whole = [0.0, 0.5];
    Ok(PrintedFormula {
        source: "Song et al. 2009, section 4.3, decreasing part",
        formula: "C = c e^(−(α Δt/2) (1 − d₃/Δt)²) ∫ e^((α Δt/2) (1 − l/Δt)²) dl, the integral from a table by (l/Δt, α)",
        fails: "The product of two exponentials: 32 bits overflow at α Δt = 176, 64 bits at 1,419, and the table with them. \
                Its entry must hold α Δt: by (l/Δt, α), one entry stands for peaks of every width.",
        instead: "ψ of linear extinction by Dawson's function, one exponential of the difference; the formula of the rising \
                  part.",
        rows: [
            (3.0, 3.0, [0.1, 0.9]),
            (100.0, 100.0, [0.1, 0.9]),
            (400.0, 400.0, whole),
            (2000.0, 2000.0, whole),
            (4.0, 2.0, whole),
        ]
        .into_iter()
        .map(row)
        .collect::<Result<_>>()?,
    })
}

/// Song Eq. 10: one band from t1 to t2 (its phase by π), α/k the peak depth of the band by 2.
fn band<T: Real>(alpha_by_k: T, t1: T, t2: T) -> T {
    let inner = integral(t1, t2, |t| (alpha_by_k * t.cos()).exp());
    (-(alpha_by_k * t1.cos())).exp() * inner / (t2 - t1)
}

fn sine() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for peak in [1.0, 100.0, 200.0, 2000.0] {
        let (from, to) = (0.05, 0.95);
        let origin = [0.0; 2];
        let wave = Wave { origin, angle: 0.0, scale: [1.0; 2], period: 1.0, band_width: 1.0 };
        let function = glowing(Profile::SineWave(wave), peak);
        let [exact, ours] = segment(&function, &between([from, 0.0], [to, 0.0], 1.0))?;
        let exact = exact.map_or(f64::NAN, |found| found.color[0]);
        let alpha_by_k = peak / (PI * (to - from));
        let (t1, t2) = (PI * from, PI * to);
        rows.push(FormulaRow {
            inputs: format!("α D = {peak:?}, α/k = {alpha_by_k:.1}, 0.05 to 0.95 of a band"),
            printed_64: error(band(alpha_by_k, t1, t2), exact),
            printed_32: error(band(alpha_by_k as f32, t1 as f32, t2 as f32), exact),
            ours_32: ours.map(|found| error(found.color[0], exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Song et al. 2009, Eq. 10",
        formula: "C = c e^(−(α/k) cos t₁) ∫ e^((α/k) cos t) dt/k, k = π/D_p",
        fails: "e^((α/k) cos t) leaves 32 bits at α/k = 88 and 64 bits at 709, and its table with it.",
        instead: "One exponential of the difference, −(2α/k) sin((t + t₁)/2) sin((t − t₁)/2), on panels of depth 2; any \
                  number of bands on a segment.",
        rows,
    })
}

/// ψ for b > a as erf: e^(u²) (√π/2k) (erf v − erf u).
fn psi_erf<T: Real>(a: T, b: T) -> T {
    let two = T::round(2.0);
    let k = ((b - a) / two).sqrt();
    let (u, v) = (a / (two * k), b / (two * k));
    (u * u).exp() * T::round(PI.sqrt() / 2.0) / k * (v.erf() - u.erf())
}

fn psi() -> Result<PrintedFormula> {
    let row = |[a, b]: [f64; 2]| {
        let (exact, ours) = partial(a, b, |found| found.psi)?;
        Ok(FormulaRow {
            inputs: format!("depths {a:?} and {b:?}"),
            printed_64: error(psi_erf(a, b), exact),
            printed_32: error(psi_erf(a as f32, b as f32), exact),
            ours_32: ours.map(|found| error(found, exact)),
        })
    };
    Ok(PrintedFormula {
        source: "Moreland & Angel 2004, ψ by erf (after Williams et al. 1998)",
        formula: "ψ = e^(u²) (√π/2k) (erf v − erf u), u = α_f D/2k, v = α_b D/2k, k = √((α_b − α_f) D/2)",
        fails: "Where the ends are nearly alike u is large: e^(u²) overflows and erf v − erf u is 0.",
        instead: "Gauss-Legendre points where both depths are under 1; erfcx u − ζ erfcx v, or Dawson's function where \
                  the extinction falls.",
        rows: [[1.0, 2.0], [1.0, 1.1], [5.0, 5.1], [30.0, 31.0], [30.0, 30.1]]
            .into_iter()
            .map(row)
            .collect::<Result<_>>()?,
    })
}

fn back() -> Result<PrintedFormula> {
    let row = |[a, b]: [f64; 2]| {
        let (exact, ours) = partial(a, b, |found| found.back)?;
        // ψ and ζ as good as the precision holds them.
        let psi = linear::psi(a, b);
        let printed_64 = (1.0 - (-0.5 * (a + b)).exp() - a * psi) / (b - a);
        let (x, y) = (a as f32, b as f32);
        let printed_32 = (1.0_f32 - Real::exp(-(0.5 * (x + y))) - x * psi as f32) / (y - x);
        Ok(FormulaRow {
            inputs: format!("depths {a:?} and {b:?}"),
            printed_64: error(printed_64, exact),
            printed_32: error(printed_32, exact),
            ours_32: ours.map(|found| error(found, exact)),
        })
    };
    Ok(PrintedFormula {
        source: "linear colour of the constant-emitter, from ψ and ζ (Song et al. 2009, Eq. 3)",
        formula: "B = (1 − ζ − a ψ)/(b − a), F = ψ − B",
        fails: "1 − ζ and a ψ agree ever better as b nears a, or as both grow; 0/0 at b = a.",
        instead: "Panels whose step follows from the extinction at their start, 8 Gauss-Legendre points on each.",
        rows: [[0.1, 1.0], [1.0, 1.001], [1.0, 1.000001], [100.0, 101.0], [1e-3, 2e-3]]
            .into_iter()
            .map(row)
            .collect::<Result<_>>()?,
    })
}

fn mix() -> Result<PrintedFormula> {
    let mut rows = Vec::new();
    for (name, peak) in [("thin", 0.01), ("half transparent", 1.0), ("dense", 10.0)] {
        let half = |low: f64, color: [f64; 3]| Widget {
            profile: Profile::Uniform,
            color,
            extinction: peak,
            region: Some(rectangle([low, low + 0.5])),
        };
        let widgets = vec![half(0.0, [1.0, 0.0, 0.0]), half(0.5, [0.0, 0.0, 1.0])];
        let model = OpticalModel::DensityEmitter;
        let function = TransferFunction { model, unit_distance: 1.0, widgets };
        let path = between([0.0; 2], [1.0, 0.0], 1.0);
        let prepared = CompiledTransferFunction::new(&function)?;
        let exact = prepared.integrate(&path, WidgetBlend::Exact).color[2];
        let mixed = prepared.integrate(&path, WidgetBlend::Mix).color[2];
        let [_, ours] = segment(&function, &path)?;
        rows.push(FormulaRow {
            inputs: format!("blue behind red, {name} (T = {:?} each)", 0.5 * peak),
            printed_64: error(mixed, exact),
            printed_32: error(mixed as f32, exact),
            ours_32: ours.map(|found| error(found.color[2], exact)),
        });
    }
    Ok(PrintedFormula {
        source: "Kniss et al. 2003, Eq. 15",
        formula: "several widgets: depths added, colours averaged by depth",
        fails: "The order of the widgets along the ray is lost, whatever the precision.",
        instead: "The ordered integral, depths in closed form; `overlap = \"mix\"` keeps Eq. 15 as the fast choice.",
        rows,
    })
}
