//! The formulas as papers print them, computed as they stand in 32 and in 64 bits, and what stands in their place.
//!
//! Truths are the 64-bit forms of `voltet_optics`, which the cases of the same report judge; their place in 32 bits is
//! what the native engine computes. Errors are relative, unless an entry says otherwise.

use serde::Serialize;
use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Wave, Widget};
use voltet_core::{Error, Result};
use voltet_introspect::evaluator;
use voltet_judge::{EvalOutcome, Evaluator64, PartialIntegrals, SegmentEvaluator};
use voltet_nodes::drawing::NATIVE;
use voltet_optics::engine::AdapterRequest;
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend, linear};

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PrintedFormula {
    pub source: &'static str,
    pub formula: &'static str,
    pub fails: &'static str,
    pub instead: &'static str,
    pub rows: Vec<FormulaRow>,
}

/// Errors at one input; not finite where the formula gives no number.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FormulaRow {
    pub inputs: String,
    pub printed_64: f64,
    pub printed_32: f64,
    /// Error of the replacement in 32 bits; `None` where that is 64-bit alone.
    pub ours_32: Option<f64>,
}

/// Formulas in words, why they fail and what stands in their place: a section each, in the order of [`printed`].
const TEXTS: &str = include_str!("printed.md");

pub(super) fn printed() -> Result<Vec<PrintedFormula>> {
    let rows = [
        gaussian()?,
        offset()?,
        mean()?,
        triangular()?,
        opacity()?,
        chain()?,
        uniform_glow()?,
        gaussian_glow()?,
        rising_flank()?,
        falling_flank()?,
        sine()?,
        psi()?,
        back()?,
        mix()?,
        steps()?,
        emission()?,
        tiles(),
    ];
    debug_assert_eq!(TEXTS.matches("### ").count(), rows.len());
    let formula = |(text, rows): (&'static str, Vec<FormulaRow>)| {
        let mut parts = text.split("\n\n").map(str::trim);
        let mut next = || parts.next().unwrap_or_default();
        let (source, formula, fails) = (next(), next().trim_matches('`'), next());
        PrintedFormula { source, formula, fails, instead: next().trim_start_matches("In its place: "), rows }
    };
    Ok(TEXTS.split("### ").skip(1).zip(rows).map(formula).collect())
}

// ---- Numbers of 32 and 64 bits, so that a printed formula is written once.

/// A float. Functions are rounded from 64 bits: no implementation in 32 bits does better.
trait Real:
    Copy
    + PartialOrd
    + Into<f64>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    fn round(x: f64) -> Self;

    fn exp(self) -> Self {
        Self::round(self.into().exp())
    }
    fn sqrt(self) -> Self {
        Self::round(self.into().sqrt())
    }
    fn erf(self) -> Self {
        Self::round(libm::erf(self.into()))
    }
    fn cos(self) -> Self {
        Self::round(self.into().cos())
    }
}

impl Real for f64 {
    fn round(x: f64) -> f64 {
        x
    }
}

impl Real for f32 {
    fn round(x: f64) -> f32 {
        x as f32
    }
}

/// A formula in 64 and in 32 bits.
fn both<const N: usize>(
    wide: impl Fn([f64; N]) -> f64,
    narrow: impl Fn([f32; N]) -> f32,
    inputs: [f64; N],
) -> [f64; 2] {
    [wide(inputs), f64::from(narrow(inputs.map(|x| x as f32)))]
}

/// ∫ f over [from, to] by Simpson's rule on many steps, in the precision of `T`: as good as any table could be filled.
fn integral<T: Real>(from: T, to: T, f: impl Fn(T) -> T) -> T {
    const STEPS: usize = 4096;
    // Values and their sum in 64 bits, so that what is seen is the formula's own cancellation and overflow.
    let (from, to): (f64, f64) = (from.into(), to.into());
    let step = (to - from) / STEPS as f64;
    let at = |i: usize| -> f64 { f(T::round(from + step * i as f64)).into() };
    let inner: f64 = (1..STEPS).map(|i| if i % 2 == 1 { 4.0 } else { 2.0 } * at(i)).sum();
    T::round((at(0) + inner + at(STEPS)) * step / 3.0)
}

// ---- Values to compare with, and errors.

/// A value in 64 bits, and in the lanes of the native engine where these compute it.
type Computed = (f64, Option<f64>);

fn computed<T>(
    evaluate: impl Fn(&dyn SegmentEvaluator) -> Result<EvalOutcome<T>>,
    number: impl Fn(&T) -> f64,
) -> Result<Computed> {
    let value = |forms: &dyn SegmentEvaluator| -> Result<Option<f64>> {
        Ok(match evaluate(forms)? {
            EvalOutcome::Served(value) => Some(number(&value)),
            EvalOutcome::Wider(..) | EvalOutcome::Skipped(_) => None,
        })
    };
    Ok((value(&Evaluator64)?.unwrap_or(f64::NAN), value(native()?.as_ref())?))
}

/// Formulas of the CPU engine on this processor.
fn native() -> Result<Box<dyn SegmentEvaluator>> {
    let forms = evaluator(NATIVE.open(&AdapterRequest::default())?.as_ref());
    forms.ok_or_else(|| Error::run("the engine has no forms of segments").got(NATIVE.name))
}

/// A number of the segment of length 1 from one pair (s, g) to another.
fn segment(
    transfer_function: &TransferFunction,
    ends: [[f64; 2]; 2],
    number: impl Fn(&Contribution) -> f64,
) -> Result<Computed> {
    computed(|forms| forms.segment(transfer_function, &between(ends), WidgetBlend::Exact), number)
}

fn between([front, back]: [[f64; 2]; 2]) -> Segment<'static> {
    Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] }
}

fn partial(a: f64, b: f64, number: impl Fn(&PartialIntegrals) -> f64) -> Result<Computed> {
    computed(|forms| forms.partial(a, b), number)
}

/// |value − exact| / |exact|; ∞ where the formula gives no number.
fn error(value: f64, exact: f64) -> f64 {
    if value.is_finite() { (value - exact).abs() / exact.abs() } else { f64::INFINITY }
}

/// Errors at one input. `printed`: in 64 and in 32 bits.
fn row(inputs: String, printed: [f64; 2], (exact, ours): Computed) -> FormulaRow {
    let [printed_64, printed_32] = printed.map(|value| error(value, exact));
    FormulaRow { inputs, printed_64, printed_32, ours_32: ours.map(|value| error(value, exact)) }
}

fn rows<T>(
    inputs: impl IntoIterator<Item = T>,
    row: impl Fn(T) -> Result<FormulaRow>,
) -> Result<Vec<FormulaRow>> {
    inputs.into_iter().map(row).collect()
}

/// White widgets over a unit distance of 1, each with its profile, extinction and region.
fn white(model: OpticalModel, profile: Profile, extinction: f64) -> TransferFunction {
    // A uniform widget needs a region; this one holds every segment below.
    let region = profile.properties().needs_region.then(|| rectangle([-1.0, 2.0]));
    let widget = Widget { profile, color: [1.0; 3], extinction, region };
    TransferFunction { model, unit_distance: 1.0, widgets: vec![widget], axes: Default::default() }
}

/// All g of a range of s.
fn rectangle([low, high]: [f64; 2]) -> Region {
    Region { corners: vec![[low, -1.0], [high, -1.0], [high, 1.0], [low, 1.0]] }
}

/// One Gaussian of peak depth 1.
fn one_gaussian(centre: [f64; 2], width: f64) -> TransferFunction {
    let matrix = [[1.0 / width, 0.0], [0.0, 1.0 / width]];
    white(OpticalModel::DensityEmitter, Profile::Gaussian { centre, matrix }, 1.0)
}

const GLOWING: OpticalModel = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };

// ---- Optical depth and opacity.

/// Kniss Eq. 11 and 12, from q = K (v − c) at both ends.
fn gaussian_depth<T: Real>([u, v, back_u, back_v]: [T; 4]) -> T {
    let d = [back_u - u, back_v - v];
    let length = (d[0] * d[0] + d[1] * d[1]).sqrt();
    let a = (u * d[0] + v * d[1]) / length;
    let b = a + length;
    let s = (a * a - (u * u + v * v)).exp();
    T::round(PI.sqrt() / 2.0) * s / length * (b.erf() - a.erf())
}

fn gaussian() -> Result<Vec<FormulaRow>> {
    let at = |[a, d, h]: [f64; 3]| {
        let values = segment(&one_gaussian([0.0; 2], 1.0), [[a, h], [a + d, h]], |c| c.optical_depth)?;
        Ok(row(
            format!("a = {a:?}, |d| = {d:?}, h = {h:?}"),
            both(gaussian_depth, gaussian_depth, [a, h, a + d, h]),
            values,
        ))
    };
    let inputs = [
        [-0.5, 1.0, 0.3],
        [3.0, 1.0, 0.0],
        [5.0, 1.0, 0.0],
        [6.0, 1.0, 0.0],
        [1.0, 1e-6, 0.5],
        [1.0, 1e-10, 0.5],
        [-1e4, 1e4 + 1.0, 0.5],
        [4.0, 1e-3, 5.0],
    ];
    rows(inputs, at)
}

/// Kniss Table 2, line 1: the difference after the product.
fn offset_depth<T: Real>([k, front, back, centre]: [T; 4]) -> T {
    let zero = T::round(0.0);
    gaussian_depth([k * front - k * centre, zero, k * back - k * centre, zero])
}

fn offset() -> Result<Vec<FormulaRow>> {
    let at = |offset: f64| {
        let width = 1e-2;
        let (centre, [front, back]) = (offset + 0.25 * width, [offset, offset + width]);
        let ends = [[front, 0.0], [back, 0.0]];
        let values = segment(&one_gaussian([centre, 0.0], width), ends, |c| c.optical_depth)?;
        let printed = both(offset_depth, offset_depth, [1.0 / width, front, back, centre]);
        Ok(row(format!("values near {offset:?}, width {width:?}"), printed, values))
    };
    rows([0.0, 1e4, 1e8], at)
}

/// Kniss Eq. 16.
fn igauss<T: Real>([x1, x2]: [T; 2]) -> T {
    if x1 == x2 {
        return (-(x1 * x1)).exp();
    }
    T::round(PI.sqrt() / 2.0) * (x1.erf() - x2.erf()) / (x1 - x2)
}

fn mean() -> Result<Vec<FormulaRow>> {
    let at = |[x1, x2]: [f64; 2]| {
        let values = segment(&one_gaussian([0.0; 2], 1.0), [[x2, 0.0], [x1, 0.0]], |c| c.optical_depth)?;
        Ok(row(format!("x₁ = {x1:?}, x₂ = {x2:?}"), both(igauss, igauss, [x1, x2]), values))
    };
    rows([[1.0, 0.0], [1.001, 1.0], [1.0 + 1e-8, 1.0], [5.01, 5.0], [8.01, 8.0]], at)
}

fn triangular() -> Result<Vec<FormulaRow>> {
    let at = |front: f64| {
        let mut worst = [0.0_f64; 3];
        for step in 0..=60 {
            // s runs by one unit over widths of σ g, centred all along the ramp.
            let start = -1.5 + 0.05 * f64::from(step);
            let profile = Profile::TriangularGaussian { centre: 0.0, sigma: 1.0 };
            let function = white(OpticalModel::DensityEmitter, profile, 1.0);
            let (exact, ours) =
                segment(&function, [[start, front], [start + 1.0, 1.0]], |c| c.optical_depth)?;
            let g = 0.5 * (front + 1.0);
            let [wide, narrow] = both(igauss, igauss, [(start + 1.0) / g, start / g]);
            for (worst, value) in worst.iter_mut().zip([wide, narrow, ours.unwrap_or(f64::NAN)]) {
                *worst = worst.max((value - exact).abs());
            }
        }
        let [printed_64, printed_32, ours] = worst;
        let inputs = format!("g from {front} to 1, worst of 61 places, absolute");
        Ok(FormulaRow { inputs, printed_64, printed_32, ours_32: Some(ours) })
    };
    rows([0.9, 0.5, 0.1], at)
}

fn plain_opacity<T: Real>([depth]: [T; 1]) -> T {
    T::round(1.0) - (-depth).exp()
}

fn opacity() -> Result<Vec<FormulaRow>> {
    let at = |depth: f64| {
        let function = white(OpticalModel::DensityEmitter, Profile::Uniform, depth);
        let values = segment(&function, [[0.0; 2], [1.0, 0.0]], |c| c.opacity)?;
        Ok(row(format!("T = {depth:?}"), both(plain_opacity, plain_opacity, [depth]), values))
    };
    rows([1.0, 1e-3, 1e-5, 1e-8, 1e-16], at)
}

/// Transparency after so many segments of one opacity.
fn composited<T: Real>(count: u32, [opacity]: [T; 1]) -> T {
    let one = T::round(1.0);
    one - (0..count).fold(T::round(0.0), |sum, _| sum + (one - sum) * opacity)
}

fn chain() -> Result<Vec<FormulaRow>> {
    let forms = native()?;
    let at = |(count, depth): (u32, f64)| {
        let opacity = -(-depth).exp_m1();
        let exact = (-depth * f64::from(count)).exp();
        let parts = vec![Contribution { opacity, ..Contribution::default() }; count as usize];
        let values = (exact, forms.chain(&parts).transparency);
        let printed = both(|x| composited(count, x), |x| composited(count, x), [opacity]);
        Ok(row(format!("{count} segments of T = {depth:?}"), printed, values))
    };
    rows([(100, 0.05), (1000, 0.01), (1000, 0.02), (1000, 0.04)], at)
}

// ---- Colours: the constant-emitter's closed forms, the integrals of linear extinction, the mix.

fn uniform_color<T: Real>([depth]: [T; 1]) -> T {
    (T::round(1.0) - (-depth).exp()) / depth
}

fn uniform_glow() -> Result<Vec<FormulaRow>> {
    let at = |depth: f64| {
        let values =
            segment(&white(GLOWING, Profile::Uniform, depth), [[0.0; 2], [1.0, 0.0]], |c| c.color[0])?;
        Ok(row(format!("a D = {depth:?}"), both(uniform_color, uniform_color, [depth]), values))
    };
    rows([1.0, 1e-3, 1e-8, 1e-20], at)
}

/// Song section 4.2 for a path at distance 0 from the centre: C = e^(P erf B)/A (table(P, A + B) − table(P, B)), with
/// table(P, t) = ∫₀ᵗ e^(−P erf x) dx as exact as the precision holds it.
fn gaussian_color<T: Real>([peak, a, b]: [T; 3]) -> T {
    let d = b - a;
    let p = peak * T::round(PI.sqrt() / 2.0) / d;
    let table = |t: T| integral(T::round(0.0), t, |x| (-(p * x.erf())).exp());
    (p * a.erf()).exp() / d * (table(b) - table(a))
}

fn gaussian_glow() -> Result<Vec<FormulaRow>> {
    let at = |(peak, a, b): (f64, f64, f64)| {
        let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 1.0]] };
        let values = segment(&white(GLOWING, profile, peak), [[a, 0.0], [b, 0.0]], |c| c.color[0])?;
        let printed = both(gaussian_color, gaussian_color, [peak, a, b]);
        Ok(row(format!("ρ₀ D = {peak:?}, x from {a:?} to {b:?}"), printed, values))
    };
    let inputs =
        [(1.0, -0.5, 0.5), (1.0, 0.5, 0.51), (1.0, 0.5, 0.501), (10.0, 0.0, 0.05), (1.0, 1.0, 1.0 + 1e-6)];
    rows(inputs, at)
}

/// Song section 4.3, the increasing part: extinction k x for x from d1 to d2.
fn rising<T: Real>([k, d1, d2]: [T; 3]) -> T {
    let half = k / T::round(2.0);
    let root = half.sqrt();
    let factor = (T::round(PI) / (T::round(2.0) * k)).sqrt() * (half * d1 * d1).exp();
    factor * ((root * d2).erf() - (root * d1).erf())
}

fn rising_flank() -> Result<Vec<FormulaRow>> {
    let at = |[k, d1, d2]: [f64; 3]| {
        let length = d2 - d1;
        let values = partial(k * d1 * length, k * d2 * length, |found| found.psi * length)?;
        Ok(row(format!("α/Δt = {k:?}, from {d1:?} to {d2:?}"), both(rising, rising, [k, d1, d2]), values))
    };
    let inputs =
        [[3.08, 0.1, 0.9], [50.0, 0.5, 0.9], [50.0, 1.0, 1.1], [200.0, 0.9, 1.0], [2000.0, 0.9, 1.0]];
    rows(inputs, at)
}

/// Song section 4.3, the decreasing part: extinction α (1 − x/Δt) for x/Δt from u3 to u4, in units of Δt. `front` and `table`:
/// α Δt/2 of the factor and of the integral, which a table holds as exactly as the precision does.
fn falling<T: Real>([front, table, u3, u4]: [T; 4]) -> T {
    let left = |u: T| (T::round(1.0) - u) * (T::round(1.0) - u);
    (-(front * left(u3))).exp() * integral(u3, u4, |u| (table * left(u)).exp())
}

fn falling_flank() -> Result<Vec<FormulaRow>> {
    let at = |(depth, made_for, [u3, u4]): (f64, f64, [f64; 2])| {
        let length = u4 - u3;
        let (a, b) = (depth * (1.0 - u3) * length, depth * (1.0 - u4) * length);
        let values = partial(a, b, |found| found.psi * length)?;
        let mut inputs = format!("α Δt = {depth:?}, from {u3:?} to {u4:?} of Δt");
        if made_for != depth {
            inputs += &format!(", the table's entry made at {made_for:?}");
        }
        Ok(row(inputs, both(falling, falling, [0.5 * depth, 0.5 * made_for, u3, u4]), values))
    };
    let whole = [0.0, 0.5];
    let inputs = [
        (3.0, 3.0, [0.1, 0.9]),
        (100.0, 100.0, [0.1, 0.9]),
        (400.0, 400.0, whole),
        (2000.0, 2000.0, whole),
        (4.0, 2.0, whole),
    ];
    rows(inputs, at)
}

/// Song Eq. 10: one band from t1 to t2 (its phase by π), α/k the peak depth of the band by 2.
fn band<T: Real>([alpha_by_k, t1, t2]: [T; 3]) -> T {
    let inner = integral(t1, t2, |t| (alpha_by_k * t.cos()).exp());
    (-(alpha_by_k * t1.cos())).exp() * inner / (t2 - t1)
}

fn sine() -> Result<Vec<FormulaRow>> {
    let at = |peak: f64| {
        let (from, to) = (0.05, 0.95);
        let origin = [0.0; 2];
        let wave = Wave { origin, angle: 0.0, scale: [1.0; 2], period: 1.0, band_width: 1.0 };
        let function = white(GLOWING, Profile::SineWave(wave), peak);
        let values = segment(&function, [[from, 0.0], [to, 0.0]], |c| c.color[0])?;
        let alpha_by_k = peak / (PI * (to - from));
        let inputs = format!("α D = {peak:?}, α/k = {alpha_by_k:.1}, 0.05 to 0.95 of a band");
        Ok(row(inputs, both(band, band, [alpha_by_k, PI * from, PI * to]), values))
    };
    rows([1.0, 100.0, 200.0, 2000.0], at)
}

/// ψ for b > a as erf: e^(u²) (√π/2k) (erf v − erf u).
fn psi_erf<T: Real>([a, b]: [T; 2]) -> T {
    let two = T::round(2.0);
    let k = ((b - a) / two).sqrt();
    let (u, v) = (a / (two * k), b / (two * k));
    (u * u).exp() * T::round(PI.sqrt() / 2.0) / k * (v.erf() - u.erf())
}

fn psi() -> Result<Vec<FormulaRow>> {
    let at = |[a, b]: [f64; 2]| {
        let values = partial(a, b, |found| found.psi)?;
        Ok(row(format!("depths {a:?} and {b:?}"), both(psi_erf, psi_erf, [a, b]), values))
    };
    rows([[1.0, 2.0], [1.0, 1.1], [5.0, 5.1], [30.0, 31.0], [30.0, 30.1]], at)
}

/// B from ψ, which is as good as the precision holds it, and ζ.
fn back_weight<T: Real>([a, b, psi]: [T; 3]) -> T {
    (T::round(1.0) - (-(T::round(0.5) * (a + b))).exp() - a * psi) / (b - a)
}

fn back() -> Result<Vec<FormulaRow>> {
    let at = |[a, b]: [f64; 2]| {
        let values = partial(a, b, |found| found.back)?;
        let printed = both(back_weight, back_weight, [a, b, linear::psi(a, b)]);
        Ok(row(format!("depths {a:?} and {b:?}"), printed, values))
    };
    rows([[0.1, 1.0], [1.0, 1.001], [1.0, 1.000001], [100.0, 101.0], [1e-3, 2e-3]], at)
}

fn mix() -> Result<Vec<FormulaRow>> {
    let at = |(name, peak): (&str, f64)| {
        let half = |low: f64, color: [f64; 3]| {
            let region = Some(rectangle([low, low + 0.5]));
            Widget { profile: Profile::Uniform, color, extinction: peak, region }
        };
        let widgets = vec![half(0.0, [1.0, 0.0, 0.0]), half(0.5, [0.0, 0.0, 1.0])];
        let function = TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: 1.0,
            widgets,
            axes: Default::default(),
        };
        let ends = [[0.0; 2], [1.0, 0.0]];
        let compiled = CompiledTransferFunction::new(&function)?;
        let mixed = compiled.integrate(&between(ends), WidgetBlend::Mix).color[2];
        let values = segment(&function, ends, |c| c.color[2])?;
        let inputs = format!("blue behind red, {name} (T = {:?} each)", 0.5 * peak);
        Ok(row(inputs, [mixed, f64::from(mixed as f32)], values))
    };
    rows([("thin", 0.01), ("half transparent", 1.0), ("dense", 10.0)], at)
}

// ---- Pre-integration: the steps of the numerical integral, and the tiles that stand for the table.

/// Roettger & Ertl Eq. 5 in the depth of a Gaussian of width 1: Σ (l/n) ρ(w), w from S_b to S_f with both ends.
fn both_ends<T: Real>(count: u32, [front, back]: [T; 2]) -> T {
    let whole = |n: u32| T::round(f64::from(n));
    let place = |i: u32| back + whole(i) / (whole(count) - T::round(1.0)) * (front - back);
    let density = |w: T| (-(w * w)).exp();
    (0..count).fold(T::round(0.0), |sum, i| sum + density(place(i)) / whole(count))
}

fn steps() -> Result<Vec<FormulaRow>> {
    let profile = Profile::Gaussian { centre: [0.0; 2], matrix: [[1.0, 0.0], [0.0, 0.0]] };
    let function = white(OpticalModel::DensityEmitter, profile, 1.0);
    let at = |(count, front, back): (u32, f64, f64)| {
        let values = segment(&function, [[front, 0.0], [back, 0.0]], |c| c.optical_depth)?;
        let inputs = format!("a Gaussian of width 1, S from {front:?} to {back:?}, {count} steps");
        Ok(row(inputs, both(|x| both_ends(count, x), |x| both_ends(count, x), [front, back]), values))
    };
    let inputs =
        [(0, 0.5, 0.5), (1, 0.0, 1.0), (2, 0.0, 1.0), (8, 0.0, 1.0), (64, 0.0, 1.0), (1024, 0.0, 1.0)];
    rows(inputs, at)
}

/// Light of so many steps of depth h, κ = ρ.
fn stepped<T: Real>(count: u32, [h]: [T; 1]) -> T {
    (0..count).fold(T::round(0.0), |sum, i| sum + h * (-(h * T::round(f64::from(i)))).exp())
}

fn emission() -> Result<Vec<FormulaRow>> {
    let at = |(depth, count): (f64, u32)| {
        // Constant κ = ρ: C = 1 − e^(−T).
        let values = (-(-depth).exp_m1(), None);
        let printed = both(|x| stepped(count, x), |x| stepped(count, x), [depth / f64::from(count)]);
        Ok(row(format!("ρ l = {depth:?}, {count} steps"), printed, values))
    };
    rows([(1.0, 8), (10.0, 8), (100.0, 8), (100.0, 1024)], at)
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
    let apart = found.into_iter().zip(exact).map(|(found, exact)| (found.into() - exact).abs());
    apart.fold(0.0, |most, x: f64| if x.is_nan() { f64::INFINITY } else { most.max(x) })
}

fn tiles() -> Vec<FormulaRow> {
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
        let exact = [to_tile(pixel)[0]];
        FormulaRow {
            inputs: format!("α of the thick vertex at a pixel whose ray is turned by {degrees:?}°, absolute"),
            printed_64: max_difference([to_tile(thick)[0]], exact),
            printed_32: max_difference([to_tile(thick.map(|x| x as f32))[0]], exact),
            ours_32: Some(max_difference([to_tile(pixel.map(|x| x as f32))[0]], exact)),
        }
    };
    let mut rows: Vec<FormulaRow> =
        [[0.7, 0.2, 0.3], [0.2, 0.7, 0.9], [0.500001, 0.5, 1e-7], [0.5, 0.5, 0.0]].map(there_and_back).into();
    rows.extend([0.0, 5.0, 15.0].map(turned));
    rows
}
