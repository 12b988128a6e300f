//! Arrays that are computed by an expression.

use crate::support::{Folder, Ran, SLAB};

/// The cube filled where the result lies from `low` to `high`, seen along x.
fn scene(folder: &Folder, keys: &str, [low, high]: [f64; 2]) {
    let text = SLAB
        .replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"result\" }")
        .replace("region = { s = [-1.0, 2.0] }", &format!("region = {{ s = [{low:?}, {high:?}] }}"))
        + &format!("\n[nodes.result]\ntype = \"calculator\"\ninputs = {{ grid = \"grid\" }}\n{keys}\n");
    folder.write("slab.toml", text);
}

fn run(folder: &Folder) -> Ran {
    folder.voltet(&["run", "slab.toml", "--quiet", "--report", "report.json", "--set", "picture.engine=cpu"])
}

/// Opacity at the middle of the picture: 1 − e^(−2 × the length in the region).
fn length(folder: &Folder) -> f64 {
    run(folder).ok();
    let (width, pixels) = folder.floats("slab.exr");
    -f64::ln(1.0 - f64::from(pixels[width * 4 + 4][3])) / 2.0
}

#[test]
fn the_result_is_drawn_at_points_and_in_cells() {
    let folder = Folder::new();
    // 4 x - 1 + |(1, 0, 0)| is linear, so exact between points: below 2 for x below a half.
    scene(&folder, "expression = \"2*(x + x*ones) - 1 + mag(gradient)*gradient:0\"", [-1.0, 2.0]);
    assert!((length(&folder) - 0.5).abs() < 1e-5);
    let counts = &folder.report("report.json")["nodes"];
    let reader = counts.as_array().unwrap().iter().find(|node| node["name"] == "grid").unwrap();
    // y and layer are not read.
    assert_eq!(reader["counts"]["arrays_decoded"], 4, "{reader:#}");
    // Cells in columns 0, 1, 2 along x; each of them constant where points belong to one cell alone.
    scene(&folder, "expression = \"(layer - 1)^2\"\nassociation = \"cell\"", [0.5, 2.0]);
    let mut text = std::fs::read_to_string(folder.join("slab.toml")).unwrap();
    assert!((length(&folder) - 2.0 / 3.0).abs() < 0.25);
    text = text.replace("scalar = \"x\"", "scalar = \"layer\"\ncell_values = \"constant\"");
    folder.write("slab.toml", text);
    assert!((length(&folder) - 2.0 / 3.0).abs() < 1e-5);
}

#[test]
fn what_no_node_uses_is_neither_read_nor_computed() {
    let folder = Folder::new();
    scene(&folder, "expression = \"y + ones\"\nscalar = false", [-1.0, 2.0]);
    run(&folder).ok();
    let report = folder.report("report.json");
    let count = |node: &str, name: &str| {
        let nodes = report["nodes"].as_array().unwrap();
        nodes.iter().find(|entry| entry["name"] == node).unwrap()["counts"][name].clone()
    };
    assert_eq!((count("grid", "arrays_decoded"), count("result", "values_computed")), (1.into(), 0.into()));
}

#[test]
fn mistakes_are_shown_in_the_expression() {
    let folder = Folder::new();
    for (keys, code, caret, said) in [
        ("expression = \"sqrt(x*x\"", 2, 22, &["cannot be read", "its end", "')'"][..]),
        ("expression = \"x + sqr(x)\"", 2, 19, &["'sqrt', the nearest name"]),
        ("expression = \"x * oness\"", 1, 19, &["no array 'oness'", "ones", "cube.vtu"]),
        ("expression = \"x + gradient:7\"", 1, 19, &["no such component", "'7'"]),
        (
            "expression = \"1 + gradient\"",
            2,
            19,
            &["'gradient' is no number", "mag(gradient)", "3 components"],
        ),
        ("expression = \"x + layer\"", 2, 19, &["'layer' is an array of cells", "a calculator of its own"]),
        ("expression = \"2*layer\"", 2, 17, &["'layer' is an array of cells", "association = \"cell\""]),
        ("expression = \"layer + x\"\nassociation = \"cell\"", 1, 23, &["'x'", "point"]),
        ("expression = \"1/(x - x)\"", 2, 14, &["not finite at 64 points", "max("]),
        ("expression = \"2*x\"\nname = \"x\"", 2, 8, &["a name of its own"]),
    ] {
        scene(&folder, keys, [-1.0, 2.0]);
        let ran = run(&folder).fails(code, said);
        assert!(ran.stderr.contains(&format!(":{caret}\n")), "{keys}, column {caret}: {}", ran.stderr);
    }
}
