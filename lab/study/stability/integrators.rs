//! Every integrator in 64 bits on the segments whose exact values are known: what it is off by, and whether what it gives can
//! be seen at all (finite, no more than opaque, no brighter than its widgets).

use serde::Serialize;
use voltet_core::progress::Progress;
use voltet_core::transfer::{OpticalModel, Widget};
use voltet_core::{Error, Result};
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, segments, tabulated};
use voltet_judge::{Case, Kind, SegmentCase, stiff};
use voltet_optics::integrators::{self, Extent, Integrator, IntegratorKind};
use voltet_optics::{CompiledTransferFunction, Contribution, WidgetBlend};
use voltet_reference::REFERENCE;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IntegratorReport {
    /// The name in pipeline files.
    pub integrator: &'static str,
    pub cases: usize,
    /// Largest error of A and of C as shares of what is possible at most: 1, and the brightest colour there.
    pub worst_error: f64,
    pub worst_case: String,
    /// Bound of its error, if it has any: the referee as a share; `adaptive` beside the closed forms, whose
    /// places along a segment are its own, and twice what those are off by.
    pub bound: Option<f64>,
    /// Cases that broke the bound, and by what they are off.
    pub broken: Vec<String>,
    /// Cases whose result cannot be, and what it was.
    pub impossible: Vec<String>,
}

impl IntegratorReport {
    /// True if all that it gave can be, within what it promises.
    pub fn passed(&self) -> bool {
        self.impossible.is_empty() && self.broken.is_empty()
    }
}

/// Tolerance of `adaptive`, as it is judged here.
const TOLERANCE: f64 = 1e-6;

/// Excess of a result over its limit, opaque or as bright as its widgets: a thousandth of a step of 8 bits. Tables that are
/// interpolated take up to 2e-6 of it.
const MIN_TRANSMITTANCE: f64 = 4e-6;

/// The quadrature of the referee: ten times what it allows itself of each stretch.
const REFEREE: f64 = 1e-10;

/// One of each kind, with what it promises. Tables are small, as each case needs one of its own.
fn settings(kind: &'static dyn IntegratorKind) -> (Integrator, Option<f64>) {
    let default = Integrator::new(kind);
    match default.name() {
        "adaptive" => (Integrator::adaptive(TOLERANCE), Some(TOLERANCE)),
        "segments" => (segments(16, 64), None),
        "riemann" => (riemann(64), None),
        "pre-integrated" => (pre_integrated(5, 2), None),
        "pre-integrated-cylindrical" => (pre_integrated_cylindrical(5, 2, 1), None),
        "tabulated" => (tabulated(128), None),
        "reference" => (REFERENCE, Some(REFEREE)),
        // The ends of a segment count as points for `vertex-sampled`; the values of `analytic` are judged as forms, by the condition
        // of each case.
        _ => (default, None),
    }
}

/// All kinds, those that ship first.
fn kinds() -> impl Iterator<Item = &'static dyn IntegratorKind> {
    integrators::KINDS.into_iter().chain([REFERENCE.kind()]).chain(voltet_integrators::KINDS)
}

/// Tries every integrator. Errors: a stopped run, a transfer function out of range.
pub(super) fn integrators(cases: &[Case], progress: &dyn Progress) -> Result<Vec<IntegratorReport>> {
    let stiff = stiff()?;
    let mut all = Vec::new();
    for (k, every) in kinds().enumerate() {
        let (integrator, bound) = settings(every);
        progress.report(integrator.name(), k as f64 / kinds().count() as f64);
        let mut found = IntegratorReport {
            integrator: integrator.name(),
            cases: 0,
            worst_error: 0.0,
            worst_case: String::new(),
            bound,
            broken: Vec::new(),
            impossible: Vec::new(),
        };
        for case in cases.iter().chain(&stiff) {
            if progress.cancelled() {
                return Err(Error::cancelled());
            }
            if let Kind::Segment(segment) = &case.kind {
                found.add(&integrator, &case.id, segment)?;
            }
        }
        all.push(found);
    }
    Ok(all)
}

impl IntegratorReport {
    fn add(&mut self, integrator: &Integrator, id: &str, case: &SegmentCase) -> Result<()> {
        let transfer_function = &case.transfer_function;
        if integrators::can_serve(integrator, transfer_function).is_err() {
            return Ok(());
        }
        let segment = case.segment();
        let (a, b) = (segment.front[0], segment.back[0]);
        let extent = Extent { scalar: [a.min(b), a.max(b)], longest: case.length };
        let made = integrators::new(integrator, WidgetBlend::Exact, transfer_function, &extent)?;
        let given = made.integrate(&segment);
        self.cases += 1;
        if let Some(error) = made.failure() {
            self.impossible.push(format!("{id}: {error}"));
            return Ok(());
        }
        let most = brightest(case);
        if !possible(&given, most) {
            self.impossible.push(format!("{id}: {given:?}"));
            return Ok(());
        }
        let error = off(&given, &case.exact, most);
        if error > self.worst_error {
            (self.worst_error, self.worst_case) = (error, id.into());
        }
        let beyond = match integrator.tolerance() {
            Some(_) => {
                let closed =
                    CompiledTransferFunction::new(transfer_function)?.integrate(&segment, WidgetBlend::Exact);
                off(&given, &case.exact, 1.0) - 2.0 * off(&closed, &case.exact, 1.0)
            }
            None => error,
        };
        if self.bound.is_some_and(|bound| beyond > bound) {
            self.broken.push(format!("{id}: {beyond:e}"));
        }
        Ok(())
    }
}

/// The larger error of A and of C, that as a share of `most`.
fn off(found: &Contribution, exact: &Contribution, most: f64) -> f64 {
    let share = |found: f64, exact: f64| if most > 0.0 { (found - exact).abs() / most } else { 0.0 };
    let colors = (0..3).map(|c| share(found.color[c], exact.color[c]));
    colors.fold((found.opacity - exact.opacity).abs(), f64::max)
}

/// The brightest that the segment's colour can be: ∫ κ e^(−T) (docs/src/explanation/optics.md, section 5).
fn brightest(case: &SegmentCase) -> f64 {
    match case.transfer_function.model {
        OpticalModel::DensityEmitter => case.brightest(),
        OpticalModel::ConstantEmitter { .. } => {
            let each = case.transfer_function.widgets.iter().map(Widget::max_emission);
            each.sum::<f64>() * case.length / case.transfer_function.unit_distance
        }
    }
}

fn possible(given: &Contribution, most: f64) -> bool {
    let within = |x: f64, most: f64| (0.0..=most * (1.0 + MIN_TRANSMITTANCE)).contains(&x);
    given.optical_depth >= 0.0 && within(given.opacity, 1.0) && given.color.iter().all(|c| within(*c, most))
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::progress::NoProgress;
    use voltet_judge::shipped;

    #[test]
    fn every_integrator_gives_what_can_be() {
        let cases = shipped().expect("well formed");
        let all = integrators(&cases, &NoProgress).expect("run");
        assert_eq!(all.len(), kinds().count());
        for found in all {
            assert!(found.passed() && found.cases > 5, "{found:#?}");
        }
    }

    #[test]
    fn what_cannot_be_is_noticed() {
        let given = Contribution { optical_depth: 1.0, color: [0.5; 3], opacity: 0.6 };
        assert!(possible(&given, 0.5));
        for wrong in [
            Contribution { opacity: 1.0 + 1e-5, ..given },
            Contribution { optical_depth: f64::NAN, ..given },
            Contribution { color: [0.5, -1e-300, 0.0], ..given },
            Contribution { color: [0.5 + 1e-5, 0.0, 0.0], ..given },
            Contribution { color: [f64::INFINITY; 3], ..given },
        ] {
            assert!(!possible(&wrong, 0.5), "{wrong:?}");
        }
    }
}
