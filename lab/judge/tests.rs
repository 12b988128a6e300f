use super::*;
use crate::{Chain, PartialIntegrals, Precision};

fn fixtures() -> String {
    read("segments.jsonl")
}

/// Random variations of the same kinds, computed apart with 77 digits by quadrature alone; among them every one that
/// was once got wrong.
fn variations() -> String {
    read("variations.jsonl")
}

fn judge(text: &str, forms: &dyn SegmentEvaluator) -> Result<Report> {
    judge_all(text, &[forms]).map(|mut reports| reports.remove(0))
}

fn read(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
    std::fs::read_to_string(path).expect("the case file is part of the source")
}

fn table(report: &Report) -> String {
    report.rows.iter().map(|row| format!("{row:?}\n")).collect()
}

#[test]
fn the_64_bit_forms_keep_every_bound() {
    let report = judge(&fixtures(), &Evaluator64).expect("the case file is well formed");
    println!("{}", table(&report));
    assert!(report.passed(), "\n{}", table(&report));
}

#[test]
fn random_variations_keep_every_bound() {
    let report = judge(&variations(), &Evaluator64).expect("the case file is well formed");
    assert!(report.passed(), "{}", table(&report));
}

/// Also where the magnitude has both signs and the centre lies behind the foot.
#[test]
fn triangular_gaussians_over_fields_keep_every_bound() {
    let report =
        judge(&read("triangular_gaussian_nd.jsonl"), &Evaluator64).expect("the case file is well formed");
    assert!(report.passed(), "{}", table(&report));
}

/// A judge that cannot fail judges nothing: forms that are off by a millionth break their bounds.
#[test]
fn a_small_error_is_found() {
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
            transfer_function: &voltet_core::transfer::TransferFunction,
            segment: &voltet_optics::Segment,
            overlap: WidgetBlend,
        ) -> Result<EvalOutcome> {
            let EvalOutcome::Served(found) = Evaluator64.segment(transfer_function, segment, overlap)? else {
                return Ok(EvalOutcome::Skipped("not served"));
            };
            let color = found.color.map(|x| x * (1.0 + 1e-6));
            Ok(EvalOutcome::Served(Contribution { color, ..found }))
        }
        fn chain(&self, segments: &[Contribution]) -> Chain {
            Evaluator64.chain(segments)
        }
        fn partial(&self, a: f64, b: f64) -> Result<EvalOutcome<PartialIntegrals>> {
            Evaluator64.partial(a, b)
        }
    }
    let report = judge(&fixtures(), &Off).expect("the case file is well formed");
    assert!(!report.passed());
    let broken =
        |quantity| report.rows.iter().filter(|r| r.quantity == quantity).map(|r| r.broken).sum::<usize>();
    assert!(broken("C") > 1000 && broken("T") == 0);
    assert!(report.worst().is_some_and(|row| row.quantity == "C" && !row.worst_id.is_empty()));
}

#[test]
fn a_case_that_is_none_is_refused_with_its_line() {
    let message = |text: &str| judge(text, &Evaluator64).expect_err("refused").to_string();
    let first = fixtures().lines().next().expect("has lines").to_owned();
    assert!(message("{").contains("JSON"));
    assert!(message(&first.replace("\"D\":", "\"E\":")).contains("`D`"));
    assert!(message(&first.replace("uniform\",", "unicorn\",")).contains("unicorn"));
}
