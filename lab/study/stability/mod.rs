//! Stability of the program's formulas: every formula of every engine and adapter against exact values, pictures of cells
//! that are hard to draw against the 64-bit referee, every integrator, and the formulas as papers print them.
//!
//! The cases of the formulas are `voltet_judge`'s, which the program carries.

mod pictures;
mod printed;
mod random;
mod report;

pub use pictures::{HardPicture, Subjects, subjects};
pub use printed::{FormulaRow, PrintedFormula};
pub use random::{BoundViolation, Position, RandomReport, random, scene as random_scene};
pub use report::{IntegratorReport, StabilityReport, forms_json, forms_text, json, random_text, text};

use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_judge::{judge_cases, shipped};

/// Judges all of the forms by the cases that the program carries, draws the pictures, evaluates what papers print.
///
/// Errors: a stopped run, and those of drawing.
pub fn stability(subjects: &Subjects, progress: &dyn Progress) -> Result<StabilityReport> {
    let cases = shipped()?;
    let mut forms = Vec::new();
    for (k, subject) in subjects.forms.iter().enumerate() {
        progress.report(subject.name(), k as f64 / subjects.forms.len() as f64);
        progress.check_cancelled()?;
        forms.extend(judge_cases(&cases, &[subject.as_ref()])?);
    }
    let integrators = report::integrators(&cases, progress)?;
    let pictures = pictures::pictures(&subjects.renderers, progress)?;
    progress.report("printed formulas", 1.0);
    Ok(StabilityReport {
        forms,
        integrators,
        pictures,
        printed: printed::printed()?,
        left_out: subjects.left_out.clone(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::transfer::TransferFunction;
    use voltet_judge::{Chain, EvalOutcome, PartialIntegrals, Precision, SegmentEvaluator};
    use voltet_judge::{Evaluator64, Kind};
    use voltet_optics::{Contribution, Segment, WidgetBlend};

    /// The 64-bit forms, with optical depths off by a millionth: what a wrong engine would be.
    struct Off;

    impl SegmentEvaluator for Off {
        fn name(&self) -> &str {
            "off"
        }
        fn precision(&self) -> Precision {
            Precision::F64
        }
        fn segment(
            &self,
            look: &TransferFunction,
            segment: &Segment,
            overlap: WidgetBlend,
        ) -> Result<EvalOutcome> {
            Ok(match Evaluator64.segment(look, segment, overlap)? {
                EvalOutcome::Served(found) => {
                    let optical_depth = found.optical_depth * (1.0 + 1e-6);
                    EvalOutcome::Served(Contribution { optical_depth, ..found })
                }
                other => other,
            })
        }
        fn chain(&self, segments: &[Contribution]) -> Chain {
            Evaluator64.chain(segments)
        }
        fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
            Evaluator64.partial(a, b)
        }
    }

    fn drawn(worst_error: f64) -> HardPicture {
        let (category, scene) = ("degenerate cells", "one".to_string());
        let engine = "an engine".to_string();
        HardPicture { category, scene, engine, refused: None, worst_error, worst_pixel: [0, 0], bound: 1e-4 }
    }

    #[test]
    fn a_bound_broken_anywhere_is_said() {
        let segments = |case: &voltet_judge::Case| matches!(case.kind, Kind::Segment(_));
        let cases: Vec<_> = shipped().unwrap().into_iter().filter(segments).step_by(40).collect();
        let found = |forms: &dyn SegmentEvaluator, error: f64| StabilityReport {
            forms: judge_cases(&cases, &[forms]).unwrap(),
            integrators: Vec::new(),
            pictures: vec![drawn(error)],
            printed: Vec::new(),
            left_out: Vec::new(),
        };
        assert!(found(&Evaluator64, 1e-4).passed());
        for (broken, said) in [
            (found(&Off, 0.0), "BROKE ITS BOUND"),
            (found(&Off, 0.0), ") **broken** |"),
            (found(&Evaluator64, 1.1e-4), "| degenerate cells | one | 1.1e-4 **broken** |"),
            (found(&Evaluator64, f64::INFINITY), "| none **broken** |"),
        ] {
            assert!(!broken.passed());
            let text = text(&broken);
            assert!(text.contains(said) && text.ends_with("A BOUND IS BROKEN\n"), "{text}");
            assert_eq!(json(&broken)["passed"], false);
        }
    }
}
