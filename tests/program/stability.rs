//! `voltet stability`: good, wrong and damaged case files.

use super::support::Folder;
use voltet::nodes::drawing::ENGINES;
use voltet::optics::engine::AdapterRequest;
use voltet_introspect::{evaluator, open_variants};

/// Cases of every kind, each line with a key that no reader knows.
fn cases() -> Vec<String> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/lab/judge/fixtures/segments.jsonl");
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
        "32-bit portable forms".into(),
        "64-bit: every bound kept".into(),
        "32-bit portable: every bound kept".into(),
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

/// Every set of forms that this processor has, every category, the hard pictures and the printed formulas. Part by part the tests of
/// `lab/study` ask for the same, so a short series has no need of it.
#[test]
fn without_a_file_the_program_judges_itself() {
    if !voltet_testing::whole_series() {
        return;
    }
    let folder = Folder::new();
    let ran = folder.voltet(&["stability", "--json"]).ok();
    let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(found["passed"], true);
    let forms = found["forms"].as_array().unwrap();
    let names: Vec<&str> = forms.iter().map(|forms| forms["forms"].as_str().unwrap()).collect();
    assert!(names.starts_with(&["64-bit", "32-bit portable"]), "{names:?}");
    // Each engine is judged in each of its ways, or said to be missing.
    let opened: Vec<_> = ENGINES
        .iter()
        .filter_map(|engine| open_variants(engine, &AdapterRequest::hardware(None)).ok())
        .collect();
    let ways: Vec<_> = opened.iter().flatten().collect();
    assert_eq!(names.len(), 1 + ways.iter().filter(|engine| evaluator(engine.as_ref()).is_some()).count());
    assert_eq!(found["left_out"].as_array().unwrap().len() + opened.len(), ENGINES.len(), "{names:?}");
    for forms in forms {
        let rows = forms["rows"].as_array().unwrap();
        for category in [
            "ordinary", "stiff", "narrow", "flat", "tails", "bands", "offset", "scale", "edges", "overlap",
            "table", "chain", "ray",
        ] {
            let of = |row: &&serde_json::Value| row["category"] == category;
            assert!(rows.iter().filter(of).count() >= 3, "{category}");
        }
        for formula in ["gaussian-nd (constant-emitter)", "piecewise-linear (density-emitter)", "compositing"]
        {
            let of = |row: &&serde_json::Value| row["formula"] == formula && row["judged"].as_u64() > Some(0);
            let row = rows.iter().find(of).unwrap_or_else(|| panic!("{formula} of {}", forms["forms"]));
            assert!(!row["worst_inputs"].as_str().unwrap().is_empty());
        }
    }
    let pictures = found["pictures"].as_array().unwrap();
    assert_eq!(pictures.len(), 48 * ways.len());
    for category in [
        "degenerate cells",
        "extreme coordinates",
        "long compositing chains",
        "optical depths",
        "narrow widgets",
        "steps",
        "many bands",
        "constant emitter",
        "tables",
        "light and silhouettes",
        "cameras",
    ] {
        assert!(pictures.iter().any(|picture| picture["category"] == category), "{category}");
    }
    let integrators: Vec<&str> = found["integrators"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(|one| one["integrator"].as_str())
        .collect();
    assert!(integrators.contains(&"reference") && integrators.contains(&"riemann"), "{integrators:?}");
    // What papers print fails somewhere (JSON has no infinity: null), and what stands in its place does not.
    let printed = found["printed"].as_array().unwrap();
    assert!(printed.len() >= 12);
    for entry in printed {
        let rows = entry["rows"].as_array().unwrap();
        let fails = |row: &serde_json::Value| row["printed_32"].as_f64().is_none_or(|error| error > 1e-3);
        assert!(rows.iter().any(fails), "{entry:#}");
        for row in rows.iter().filter(|row| row.get("ours_32").is_some_and(|ours| !ours.is_null())) {
            assert!(row["ours_32"].as_f64().unwrap() < 2e-5, "{entry:#}");
        }
    }
    let text = folder.voltet(&["stability"]).ok().stdout;
    for wanted in ["| many bands |", "### Kniss et al. 2003, Eq. 16", "| degenerate cells |"] {
        assert!(text.contains(wanted), "'{wanted}' is not in\n{text}");
    }
    assert!(text.ends_with("\nevery bound kept\n"), "{text}");
}

/// Changes a digit of the case's T, the `behind`th after the first that counts; gives the case's name.
fn spoil(case: &mut String, behind: usize) -> String {
    let id = serde_json::from_str::<serde_json::Value>(case).unwrap()["id"].as_str().unwrap().to_string();
    let start = case.find("\"T\":\"").unwrap() + 5;
    let digits: Vec<usize> =
        case[start..].char_indices().filter(|(_, c)| c.is_ascii_digit()).map(|(i, _)| start + i).collect();
    let first = digits.iter().position(|&i| &case[i..=i] != "0").unwrap();
    let place = digits[first + behind];
    let digit = if &case[place..=place] == "5" { "9" } else { "5" };
    case.replace_range(place..=place, digit);
    id
}

#[test]
fn a_broken_bound_is_exit_code_1_and_names_its_case() {
    let folder = Folder::new();
    let mut lines = cases();
    // A relative error of about a millionth.
    let id = spoil(&mut lines[7], 6);
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
    fails(&lines[0].replace("\"D\":", "\"E\":"), &["cases.jsonl:1", "`D`"]);
    fails(&lines[0].replace("\"T\":\"", "\"T\":\"x"), &["cases.jsonl:1", "no exact value"]);
    fails(
        &lines[0].replace("\"unit_distance\":", "\"unit_distance\":-"),
        &["cases.jsonl:1", "unit distance"],
    );
    fails("\n", &["no case"]);
    folder.voltet(&["stability", "--cases", "none.jsonl"]).fails(2, &["none.jsonl", "cannot be read"]);
}

/// The shaders of the software driver, on every 23rd case: within their bounds, what they do not hold is counted, and a wrong
/// value is found.
#[test]
#[cfg(feature = "gpu")]
fn the_shaders_of_a_device_are_judged_by_name() {
    let folder = Folder::new();
    let mut lines = cases();
    folder.write("cases.jsonl", lines.join("\n"));
    let command = ["stability", "--json", "--adapter", "software", "--cases", "cases.jsonl"];
    let ran = folder.voltet(&command);
    if ran.stderr.contains("no adapter is called \"software\"") {
        voltet_testing::skipped_without_device(&ran.stderr);
        return;
    }
    let read = |text: &str| -> serde_json::Value { serde_json::from_str(text).unwrap() };
    let found = read(&ran.ok().stdout);
    let device = found["forms"].as_array().unwrap().last().unwrap();
    let name = device["forms"].as_str().unwrap();
    assert!(name.starts_with("WGSL on ") && name.contains("software"), "{name}");
    assert_eq!(found["left_out"].as_array().unwrap().len(), 0);
    let rows = device["rows"].as_array().unwrap();
    let sum = |what: &str| rows.iter().map(|row| row[what].as_u64().unwrap()).sum::<u64>();
    assert!(sum("judged") > 200, "{} judged", sum("judged"));
    let skipped = device["skipped"].as_array().unwrap();
    assert!(
        skipped.iter().any(|excuse| excuse["reason"].as_str().unwrap().contains("refuses")),
        "{skipped:?}"
    );
    // Wrong by a tenth.
    let id = spoil(&mut lines[7], 1);
    folder.write("cases.jsonl", lines.join("\n"));
    let ran = folder.voltet(&command);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    let device = read(&ran.stdout)["forms"].as_array().unwrap().last().unwrap().clone();
    assert_eq!((&device["passed"], &device["broken"][0]["case"]), (&false.into(), &id.into()));
}

#[test]
fn a_device_that_is_not_there_is_an_error() {
    Folder::new().voltet(&["stability", "--adapter", "no such thing"]).fails(1, &["no such thing"]);
}
