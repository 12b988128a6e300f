//! `voltet stability`: good, wrong and damaged case files.

use super::support::Folder;

/// Cases of every kind, each line with a key that no reader knows.
fn cases() -> Vec<String> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/core/tests/fixtures/segments.jsonl");
    let text = std::fs::read_to_string(path).unwrap();
    let chosen = text.lines().step_by(23);
    chosen.map(|line| line.replacen('{', "{\"remark\":[\"not known\"],", 1)).collect()
}

#[test]
fn a_good_file_is_judged_per_kind_and_category_in_both_precisions() {
    let folder = Folder::new();
    folder.write("cases.jsonl", cases().join("\n"));
    let ran = folder.voltet(&["stability", "--cases", "cases.jsonl"]).ok();
    let count = cases().len();
    for text in [
        format!("cases.jsonl: {count} cases"),
        "64-bit forms".into(),
        "32-bit forms".into(),
        "64-bit: every bound kept".into(),
        "32-bit: every bound kept".into(),
        // The 32-bit engine leaves what it cannot hold to the 64-bit forms, and that is said.
        "served in 64 bits: 2 cases, since".into(),
    ] {
        assert!(ran.stdout.contains(&text), "'{text}' is not in\n{}", ran.stdout);
    }
    for (kind, category) in
        [("segment", "narrow"), ("segment", "overlap"), ("table", "table"), ("ray", "ray")]
    {
        let found = |line: &&str| line.split_whitespace().take(2).eq([kind, category]);
        assert!(ran.stdout.lines().filter(found).count() >= 6, "{kind} {category}");
    }
}

#[test]
fn a_broken_bound_is_exit_code_1_and_names_its_case() {
    let folder = Folder::new();
    let mut lines = cases();
    let wrong = &mut lines[7];
    let id = serde_json::from_str::<serde_json::Value>(wrong).unwrap()["id"].as_str().unwrap().to_string();
    // A relative error of about a millionth.
    let start = wrong.find("\"T\":\"").unwrap() + 5;
    let digits: Vec<usize> =
        wrong[start..].char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| start + i).collect();
    let first = digits.iter().position(|&i| &wrong[i..=i] != "0").unwrap();
    let place = digits[first + 6];
    let digit = if &wrong[place..=place] == "5" { "9" } else { "5" };
    wrong.replace_range(place..=place, digit);
    folder.write("cases.jsonl", lines.join("\n"));
    let ran = folder.voltet(&["stability", "--cases", "cases.jsonl"]);
    assert_eq!(ran.code, 1, "{}{}", ran.stdout, ran.stderr);
    assert!(ran.stdout.contains(&format!("broken: T of {id}: ")), "{}", ran.stdout);
    assert!(ran.stdout.contains("BROKE"), "{}", ran.stdout);
    let ran = folder.voltet(&["stability", "--json", "--cases", "cases.jsonl"]);
    assert_eq!(ran.code, 1);
    let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(found["passed"], false);
    assert_eq!(found["forms"][0]["broken"][0]["case"], id.as_str());
    assert!(found["forms"][1]["rows"].as_array().unwrap().len() > 10);
}

#[test]
fn a_file_that_is_none_is_exit_code_2_with_its_line() {
    let folder = Folder::new();
    let lines = cases();
    let text = lines[..3].join("\n");
    let fails = |content: &str, wanted: &[&str]| {
        folder.write("cases.jsonl", content);
        folder.voltet(&["stability", "--cases", "cases.jsonl"]).fails(2, wanted);
    };
    fails(&text[..text.len() - 40], &["cases.jsonl:3", "JSON"]);
    fails(&lines[0].replace("\"D\":", "\"E\":"), &["cases.jsonl:1", "'D'"]);
    fails(&lines[0].replace("\"T\":\"", "\"T\":\"x"), &["cases.jsonl:1", "no exact value"]);
    fails(
        &lines[0].replace("\"unit_distance\":", "\"unit_distance\":-"),
        &["cases.jsonl:1", "unit distance"],
    );
    fails("\n", &["no case"]);
    folder.voltet(&["stability", "--cases", "none.jsonl"]).fails(2, &["none.jsonl", "cannot be read"]);
}
