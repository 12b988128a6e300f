use super::*;

fn fixtures() -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/segments.jsonl");
    std::fs::read_to_string(path).expect("the case file is part of the source")
}

fn table(report: &Report) -> String {
    let mut text = String::new();
    for r in &report.rows {
        text += &format!(
            "{:8} {:9} {:12} judged {:5} finite {:4} skipped {:4} broken {:4} worst {:9.3} {} ({:.1e})\n",
            r.kind,
            r.category,
            r.quantity,
            r.judged,
            r.only_finite,
            r.skipped,
            r.broken,
            r.worst,
            r.worst_id,
            r.worst_error
        );
    }
    text
}

#[test]
fn the_64_bit_forms_keep_every_bound() {
    let report = judge(&fixtures(), &Native64).expect("the case file is well formed");
    for r in report.rows.iter().filter(|r| r.worst > 0.2) {
        println!("{r:?}");
    }
    println!("{}", table(&report));
    assert!(report.passed(), "\n{}", table(&report));
}
