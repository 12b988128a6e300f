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

/// Every set of forms that this processor has, every category, the hard pictures and the printed formulas.
#[test]
fn without_a_file_the_program_judges_itself() {
    let folder = Folder::new();
    let ran = folder.voltet(&["stability", "--json"]).ok();
    let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(found["passed"], true);
    let forms = found["forms"].as_array().unwrap();
    let names: Vec<&str> = forms.iter().map(|forms| forms["forms"].as_str().unwrap()).collect();
    assert!(names.starts_with(&["64-bit", "32-bit portable"]), "{names:?}");
    assert_eq!(names.len(), 1 + voltet::core::optics::judge::Native32::each().count());
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
    for category in ["degenerate cells", "extreme coordinates", "long compositing chains"] {
        assert!(pictures.iter().any(|picture| picture["category"] == category), "{category}");
    }
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
    let page = folder.voltet(&["stability", "--markdown"]).ok().stdout;
    for wanted in ["| many bands |", "### Kniss et al. 2003, Eq. 16", "| degenerate cells |"] {
        assert!(page.contains(wanted), "'{wanted}' is not in\n{page}");
    }
    let text = folder.voltet(&["stability"]).ok().stdout;
    assert!(text.ends_with("\nevery bound kept\n"), "{text}");
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
