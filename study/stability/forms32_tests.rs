use super::*;
use voltet_judge::{Report, judge, judge_all};

const FIXTURES: &str = include_str!("../../judge/fixtures/segments.jsonl");
const VARIATIONS: &str = include_str!("../../judge/fixtures/variations.jsonl");

fn table(report: &Report) -> String {
    report.rows.iter().map(|row| format!("{row}\n")).collect()
}

#[test]
fn the_32_bit_twins_keep_every_bound() {
    for forms in Native32::each() {
        the_twins_keep_every_bound(&judge(FIXTURES, &forms).expect("the case file is well formed"));
    }
}

fn the_twins_keep_every_bound(report: &Report) {
    println!("{}\n{}", report.forms, table(report));
    assert!(report.passed(), "{}\n{}", report.forms, table(report));
    let judged = report.total(|row| row.judged);
    assert!(judged > 6000, "only {judged} values were judged");
    assert_eq!(report.total(|row| row.skipped), 0);
    // What spans over 100,000 widths of a Gaussian, and one wave that is opaque where it begins.
    let wider: usize = report.excuses.iter().map(|excuse| excuse.count).sum();
    assert!(wider <= 49, "{:?}", report.excuses);
}

#[test]
fn random_variations_keep_every_bound() {
    let twins: Vec<Native32> = Native32::each().collect();
    let forms: Vec<&dyn Forms> = twins.iter().map(|twin| twin as &dyn Forms).collect();
    for report in judge_all(VARIATIONS, &forms).expect("the case file is well formed") {
        assert!(report.passed(), "{}\n{}", report.forms, table(&report));
        let skipped: usize = report.excuses.iter().filter(|e| !e.wider).map(|e| e.count).sum();
        assert!(skipped * 20 < report.cases, "{skipped} cases were skipped");
    }
}
