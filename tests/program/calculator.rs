//! Arrays that are computed by an expression.

use crate::support::{Folder, Ran, SLAB, cube, cube_of};
use std::fmt::Write;

/// The cube filled where the result lies from `low` to `high`, seen along x. `keys`: of the node, and further nodes.
fn scene(folder: &Folder, keys: &str, [low, high]: [f64; 2]) {
    let inputs = if keys.contains("[nodes.second]") { ", other = \"second\"" } else { "" };
    let text = SLAB
        .replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"result\" }")
        .replace("region = { s = [-1.0, 2.0] }", &format!("region = {{ s = [{low:?}, {high:?}] }}"))
        + &format!(
            "\n[nodes.result]\ntype = \"calculator\"\ninputs = {{ grid = \"grid\"{inputs} }}\n{keys}\n"
        );
    folder.write("slab.toml", text);
}

fn run(folder: &Folder) -> Ran {
    folder.voltet(&["run", "slab.toml", "--quiet", "--report", "report.json", "--set", "picture.engine=cpu"])
}

/// A count of a node in the report.
fn count(folder: &Folder, node: &str, name: &str) -> serde_json::Value {
    let report = folder.report("report.json");
    let nodes = report["nodes"].as_array().unwrap();
    nodes.iter().find(|entry| entry["name"] == node).unwrap()["counts"][name].clone()
}

/// Opacity at the middle of the picture: 1 − e^(−2 × the length in the region).
fn length(folder: &Folder) -> f64 {
    run(folder).ok();
    drawn_length(folder)
}

fn drawn_length(folder: &Folder) -> f64 {
    let (width, pixels) = folder.floats("slab.exr");
    -f64::ln(1.0 - f64::from(pixels[width * 4 + 4][3])) / 2.0
}

/// 4 x − 1 + |(1, 0, 0)| is linear, so exact between points: below 2 for x below a half.
const LINEAR: &str = "expression = \"2*(x + x*ones) - 1 + mag(gradient)*gradient:0\"";

#[test]
fn the_result_is_drawn_at_points_and_in_cells() {
    let folder = Folder::new();
    scene(&folder, LINEAR, [-1.0, 2.0]);
    assert!((length(&folder) - 0.5).abs() < 1e-5);
    // y and layer are not read.
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 4);
    folder.voltet(&["run", "slab.toml", "--quiet", "--exhaustive", "--set", "picture.engine=cpu"]).ok();
    assert!((drawn_length(&folder) - 0.5).abs() < 1e-5);
    // Cells in columns 0, 1, 2 along x; 1 in the outer ones, and means at the points between: 1, ½, ½, 1.
    scene(&folder, "expression = \"(layer - 1)^2\"\nassociation = \"cell\"", [0.75, 2.0]);
    assert!((length(&folder) - 1.0 / 3.0).abs() < 1e-5);
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 1);
    let cells = "expression = \"(layer - 1)^2\"\nassociation = \"cell\"\ncell_values = \"constant\"";
    scene(&folder, cells, [0.5, 2.0]);
    assert!((length(&folder) - 2.0 / 3.0).abs() < 1e-5);
}

#[cfg(feature = "gpu")]
#[test]
fn a_device_draws_the_result() {
    let folder = Folder::new();
    scene(&folder, LINEAR, [-1.0, 2.0]);
    let device = ["--set", "picture.engine=gpu", "--set", "picture.adapter=software"];
    let ran = folder.voltet(&[&["run", "slab.toml", "--quiet"], &device[..]].concat());
    if ran.on_software_driver().is_some() {
        assert!((drawn_length(&folder) - 0.5).abs() < 1e-5);
    }
}

#[test]
fn a_reader_needs_no_scalar_and_reads_none_where_the_result_takes_its_place() {
    let folder = Folder::new();
    scene(&folder, "expression = \"2*y - 1\"", [-2.0, 2.0]);
    let text = std::fs::read_to_string(folder.join("slab.toml")).unwrap();
    folder.write("slab.toml", text.replace("scalar = \"x\"\n", ""));
    assert!((length(&folder) - 1.0).abs() < 1e-5);
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 1);
    folder.voltet(&["explain", "slab.toml"]).ok();
    folder.voltet(&["run", "slab.toml", "--quiet", "--exhaustive"]).ok();
    // Another node writes the reader's scalar.
    let writer = "[nodes.out]\ntype = \"grid-writer\"\npath = \"out.vtu\"\ninputs = { volume = \"grid\" }\n";
    folder.write("slab.toml", text + writer);
    run(&folder).ok();
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 2);
}

#[test]
fn what_no_node_uses_is_neither_read_nor_computed() {
    let folder = Folder::new();
    scene(&folder, "expression = \"y + ones\"\nscalar = false", [-1.0, 2.0]);
    run(&folder).ok();
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 1);
    assert_eq!(count(&folder, "result", "values_computed"), 0);
}

#[test]
fn results_are_written_to_files_and_feed_each_other() {
    let folder = Folder::new();
    folder.write(
        "write.toml",
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"cube.vtu\"\nscalar = \"x\"\n\
         [nodes.twice]\ntype = \"calculator\"\nexpression = \"2*layer\"\nname = \"twice\"\nassociation = \"cell\"\n\
         scalar = false\ninputs = { grid = \"grid\" }\n\
         [nodes.more]\ntype = \"calculator\"\nexpression = \"twice + 1\"\nname = \"more\"\nassociation = \"cell\"\n\
         scalar = false\ninputs = { grid = \"twice\" }\n\
         [nodes.file]\ntype = \"grid-writer\"\npath = \"out.vtu\"\ncell_arrays = [\"more\"]\n\
         inputs = { volume = \"more\" }\n",
    );
    folder.voltet(&["run", "write.toml", "--quiet"]).ok();
    // 1, 3 and 5 in the columns, and nothing but what is asked for.
    let listed = folder.voltet(&["info", "out.vtu"]).ok().stdout;
    assert!(
        listed.contains("cell   more") && !listed.contains("point  more") && !listed.contains("twice"),
        "{listed}"
    );
    let text = SLAB
        .replace("cube.vtu", "out.vtu")
        .replace("scalar = \"x\"", "scalar = \"more\"\ncell_values = \"constant\"")
        .replace("s = [-1.0, 2.0]", "s = [2.5, 3.5]");
    folder.write("slab.toml", text);
    assert!((length(&folder) - 1.0 / 3.0).abs() < 1e-5);
}

#[test]
fn gradients_of_linear_fields_are_exact() {
    let folder = Folder::new();
    // (x − 2y, 2x, 3z): curl (0, 0, 4), divergence 4, Q = −½ (1 + 9) + 4 = −1, |∇(x − 2y)| = √5.
    let mut values = String::new();
    for i in 0..64 {
        let [x, y, z] = [i % 4, i / 4 % 4, i / 16].map(|k| f64::from(k) / 3.0);
        write!(values, "{:?} {:?} {:?} ", x - 2.0 * y, 2.0 * x, 3.0 * z).unwrap();
    }
    let array = format!(
        "<PointData>\n<DataArray type=\"Float64\" Name=\"V\" NumberOfComponents=\"3\" format=\"ascii\">{values}\
         </DataArray>\n"
    );
    folder.write("cube.vtu", cube(3).replacen("<PointData>\n", &array, 1));
    for (expression, low) in [
        ("x + vorticity(V) - 4", -0.5),
        ("x + divergence(V) - 4", -0.5),
        ("x + q_criterion(V) + 1", -0.5),
        ("x + gradient_magnitude(V:0)^2 - 5", -0.5),
        ("x + vorticity(V) - divergence(V) + gradient_magnitude(x) - 1", -0.5),
    ] {
        scene(&folder, &format!("expression = \"{expression}\""), [low, 0.25]);
        assert!((length(&folder) - 0.25).abs() < 1e-5, "{expression}");
    }
    // Those of V serve both.
    assert_eq!(count(&folder, "result", "gradients_computed"), 4);
}

/// A second reader.
const SECOND: &str = "[nodes.second]\ntype = \"reader\"\npath = \"second.vtu\"";

#[test]
fn two_grids_of_one_mesh_are_compared() {
    let folder = Folder::new();
    folder.write("second.vtu", cube_of(3, "x", |x| 3.0 * x));
    scene(&folder, &format!("expression = \"other.x - x + mag(other.gradient)\"\n{SECOND}"), [-1.0, 1.5]);
    // 2 x + 1.
    assert!((length(&folder) - 0.25).abs() < 1e-5);
    assert_eq!(count(&folder, "grid", "arrays_decoded"), 1);
    assert_eq!(count(&folder, "second", "arrays_decoded"), 2);
    scene(
        &folder,
        &format!("expression = \"other.layer + layer\"\nassociation = \"cell\"\n{SECOND}"),
        [3.0, 9.0],
    );
    assert!((length(&folder) - 1.0 / 3.0).abs() < 1e-5);
    scene(&folder, &format!("expression = \"gradient_magnitude(other.x)*x\"\n{SECOND}"), [-1.0, 1.5]);
    assert!((length(&folder) - 0.5).abs() < 1e-5);

    let fails = |keys: &str, code: i32, said: &[&str]| {
        scene(&folder, keys, [-1.0, 2.0]);
        run(&folder).fails(code, said)
    };
    let difference = format!("expression = \"x - other.x\"\n{SECOND}");
    fails("expression = \"x - other.x\"", 2, &["'other.x' is of the input 'other', which is not wired"]);
    fails(&format!("expression = \"2*x\"\n{SECOND}"), 2, &["no array is of the input 'other'"]);
    let ran =
        fails(&format!("expression = \"x - other.z\"\n{SECOND}"), 1, &["no array 'z'", "second.vtu", "'x'"]);
    assert!(ran.stderr.contains(":19\n"), "{}", ran.stderr);
    scene(&folder, &difference, [-1.0, 2.0]);
    let text = std::fs::read_to_string(folder.join("slab.toml")).unwrap();
    folder.write("slab.toml", text.replace("other = \"second\"", "other = [\"second\", \"grid\"]"));
    run(&folder).fails(2, &["several outputs feed the input 'other'", "expected one output"]);
    folder.write("second.vtu", cube(2));
    fails(&difference, 1, &["of another mesh", "27 points", "64 points"]);
    let moved = cube(3).replace("1 1 1</DataArray>\n</Points>", "1 1 1.00001</DataArray>\n</Points>");
    folder.write("second.vtu", moved);
    fails(&difference, 1, &["of another mesh", "point 63 at [1, 1, 1.00001]"]);
    // As 32 bits hold it.
    let near = cube(3).replace("1 1 1</DataArray>\n</Points>", "1 1 1.0000001</DataArray>\n</Points>");
    folder.write("second.vtu", near);
    scene(&folder, &difference, [-1.0, 2.0]);
    run(&folder).ok();
}

#[test]
fn units_that_agree_change_nothing() {
    let folder = Folder::new();
    let keys = format!("{LINEAR}\nname = \"mixed\"");
    scene(&folder, &keys, [-1.0, 2.0]);
    let plain = length(&folder);
    let units = "units = [\"x = K\", \"ones = 1\", \"gradient = K/m\"]\nlength_unit = \"m\"\nunit = \"mK\"";
    let agrees = keys.replace("mag(gradient)*gradient:0", "mag(gradient)*x/gradient:0");
    scene(&folder, &format!("{agrees}\n{units}"), [-1.0, 2.0]);
    run(&folder).ok();
    scene(&folder, &format!("{keys}\n{units}"), [-1.0, 2.0]);
    run(&folder).fails(2, &["'+' is of unlike units", "K^2/m^2"]);
    scene(&folder, &format!("{keys}\nunits = [\"ones = 1\"]"), [-1.0, 2.0]);
    assert_eq!(length(&folder), plain);
}

#[test]
fn mistakes_are_shown_in_the_expression() {
    let folder = Folder::new();
    for (keys, code, caret, said, is_seen_before) in [
        ("expression = \"sqrt(x*x\"", 2, 23, &["cannot be read", "its end", "')'"][..], true),
        ("expression = \"x + sqr(x)\"", 2, 19, &["'sqrt', the nearest name"], true),
        (
            "expression = \"x * oness\"",
            1,
            19,
            &["no array 'oness'", "ones", "cube.vtu", "node 'result'"],
            false,
        ),
        ("expression = \"gradient:0 + gradient:7\"", 1, 28, &["no such component", "'7'"], false),
        (
            "expression = \"1 + gradient\"",
            2,
            19,
            &["'gradient' is no number", "mag(gradient)", "3 components"],
            false,
        ),
        (
            "expression = \"1 + vorticity(x)\"",
            2,
            29,
            &["'x' is no vector", "1 component", "3 components"],
            false,
        ),
        (
            "expression = \"x + layer\"",
            2,
            19,
            &["'layer' is an array of cells", "a calculator of its own"],
            false,
        ),
        (
            "expression = \"2*layer\"",
            2,
            17,
            &["'layer' is an array of cells", "association = \"cell\""],
            false,
        ),
        ("expression = \"layer + x\"\nassociation = \"cell\"", 1, 23, &["'x'", "point"], false),
        (
            "expression = \"2*gradient_magnitude(layer)\"\nassociation = \"cell\"",
            2,
            36,
            &["gradients are those of point arrays"],
            true,
        ),
        ("expression = \"1/(x - x)\"", 2, 14, &["not finite at 64 points", "max("], false),
        (
            "expression = \"x + ones\"\nunits = [\"x = mm\", \"ones = K\"]",
            2,
            17,
            &["'+' is of unlike units", "'x' in m and 'ones' in K"],
            true,
        ),
        (
            "expression = \"exp(1 + 2*gradient:0)\"\nunits = [\"gradient = 1/m\"]",
            2,
            19,
            &["'exp' takes a pure number", "'1 + 2*gradient:0' in 1/m"],
            true,
        ),
        (
            "expression = \"x/ones\"\nunits = [\"x = m\", \"ones = s\"]\nunit = \"km\"",
            2,
            8,
            &["another unit: found m/s", "expected m, as \"km\" says"],
            true,
        ),
        (
            "expression = \"gradient_magnitude(x) + x/ones\"\nunits = [\"x = K\", \"ones = s\"]\nlength_unit = \"mm\"",
            2,
            37,
            &["K/m and 'x/ones' in K/s"],
            true,
        ),
        ("expression = \"2*x\"\nunits = [\"y = m\"]", 2, 10, &["that the expression lacks", "x"], true),
        ("expression = \"2*x\"\nunits = [\"x = m\", \"x = s\"]", 2, 19, &["stated twice"], true),
        ("expression = \"2*x\"\nunits = [\"x\"]", 2, 10, &["names no array", "ARRAY = UNIT"], true),
        ("expression = \"2*x\"\nunits = [\"x = furlong\"]", 2, 10, &["not known", "'furlong'"], true),
        ("expression = \"2*x\"\nunit = \"m\"", 2, 8, &["none are stated", "units ="], true),
        ("expression = \"2*x\"\nname = \"x\"", 2, 8, &["a name of its own"], true),
    ] {
        scene(&folder, keys, [-1.0, 2.0]);
        let ran = run(&folder).fails(code, said);
        assert!(ran.stderr.contains(&format!(":{caret}\n")), "{keys}, column {caret}: {}", ran.stderr);
        // Syntax is checked without data.
        let checked = folder.voltet(&["check", "slab.toml"]);
        assert_eq!(checked.code, if is_seen_before { 2 } else { 0 }, "{keys}: {}", checked.stderr);
    }
}
