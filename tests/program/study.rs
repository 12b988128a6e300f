//! `voltet study`: a whole study of a tiny scene, its files, the recommendation written back, bad input.

use super::support::{Folder, SLAB, cube, cube_of};
use serde_json::Value;
use voltet_testing::pictures::integrators::NAMES;

/// The slab with two Gaussian widgets that overlap, so that integrators differ, orders and overlaps count.
pub fn scene() -> String {
    let widgets = r#"[[nodes.look.widgets]]
kind = "gaussian"
color = [0.5, 1.0, 0.25]
extinction = 2.0
centre = [0.4, 0.0]
sigma = [0.1, inf]

[[nodes.look.widgets]]
kind = "gaussian"
color = [1.0, 0.1, 0.25]
extinction = 3.0
centre = [0.5, 0.0]
sigma = [0.08, inf]

[nodes.view]"#;
    let start = SLAB.find("[[nodes.look.widgets]]").unwrap();
    let end = SLAB.find("[nodes.view]").unwrap();
    format!("{}{widgets}{}", &SLAB[..start], &SLAB[end + "[nodes.view]".len()..])
}

/// A folder with the scene, and what is asked of every study here.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", scene());
    folder
}

const QUICK: [&str; 7] = ["--engine", "cpu", "--frames", "2", "--cache", "cache", "--only"];

fn study<'a>(more: &[&'a str]) -> Vec<&'a str> {
    ["study", "scene.toml"].into_iter().chain(QUICK).chain(more.iter().copied()).collect()
}

#[test]
fn a_study_writes_its_files_and_says_what_is_worth_taking() {
    let folder = folder();
    let ran = folder.voltet(&[&study(&[])[..QUICK.len() + 1], &["--max-error", "0.002"]].concat()).ok();
    let json: Value = folder.json("scene.study/study.json");
    let rows = json["rows"].as_array().unwrap();
    assert_eq!(rows.len() as u64, json["settings"].as_u64().unwrap());
    let of = |name: &str| rows.iter().filter(|row| row["setting"]["integrator"] == name).collect::<Vec<_>>();
    // Exact and mix, each in exact and centroid order; the scene's widgets depend on s alone.
    let counts = NAMES.map(|name| of(name).len());
    assert_eq!(counts, [4, 6, 10, 9, 7, 9]);
    let error = |row: &Value| row["errors"]["maximum"].as_f64().unwrap();
    // What the engine's pictures of ordinary scenes are held to elsewhere.
    assert!(error(of("analytic")[0]) < 2e-4, "{}", of("analytic")[0]);
    assert!(error(of("riemann")[0]) > 10.0 * error(of("riemann")[6]));
    assert!(of("analytic")[0]["of_file"].as_bool().unwrap());
    let chosen = &json["recommended"];
    assert!(error(chosen) <= 0.002);
    let time = |row: &Value| row["cost"]["picture"]["median_ms"].as_f64().unwrap();
    assert!(rows.iter().filter(|row| error(row) <= 0.002).all(|row| time(row) >= time(chosen)));
    assert!(chosen["on_front"].as_bool().unwrap());
    assert_eq!(json["convergence"].as_array().unwrap().len(), 2);
    assert_eq!(json["convergence"][0]["expected"], 2.0);

    let csv = std::fs::read_to_string(folder.join("scene.study/study.csv")).unwrap();
    let width = csv.lines().next().unwrap().split(',').count();
    assert_eq!(csv.lines().count(), rows.len() + 1);
    assert!(csv.lines().all(|line| line.split(',').count() == width), "{csv}");
    for name in ["reference.png", "differences/analytic.png", "differences/riemann_16_samples.png"] {
        assert!(image::open(folder.join("scene.study").join(name)).is_ok(), "{name}");
    }
    let svg = std::fs::read_to_string(folder.join("scene.study/plot.svg")).unwrap();
    let page = std::fs::read_to_string(folder.join("scene.study/study.html")).unwrap();
    for text in ["time of a picture, set-up included (ms)", "largest error", "Pareto front", "recommended"] {
        assert!(svg.contains(text) && page.contains(text), "{text}");
    }
    // One file: nothing is fetched.
    assert!(!page.contains("src=\"http") && !page.contains("href=") && !page.contains("<script"));
    for text in ["order of riemann: observed", "Cheapest with the largest error at most 0.002", "drawn ("] {
        assert!(ran.stdout.contains(text), "'{text}' is not in\n{}", ran.stdout);
    }

    // The reference is kept, also for another integrator; another camera has its own.
    let again = folder.voltet(&study(&["analytic", "--set", "picture.integrator=riemann"])).ok();
    assert!(again.stdout.contains("kept from before"), "{}", again.stdout);
    let other = folder.voltet(&study(&["analytic", "--set", "view.height=1.5"])).ok();
    assert!(!other.stdout.contains("kept from before"), "{}", other.stdout);
}

#[test]
fn apply_writes_the_setting_and_leaves_every_other_byte() {
    let folder = folder();
    let wide = scene().replace(
        "type = \"renderer\"\n",
        "type = \"renderer\"   # the picture\n  integrator =  'segments'\t# slow\nsegments = 3 # few\n",
    );
    let arguments = study(&["analytic", "--max-error", "0.5", "--measure", "rms", "--apply", "--quiet"]);
    for (text, ends) in [(wide.clone(), "\n"), (wide.replace('\n', "\r\n"), "\r\n")] {
        folder.write("scene.toml", &text);
        folder.voltet(&arguments).ok();
        let found = std::fs::read_to_string(folder.join("scene.toml")).unwrap();
        assert_eq!(found.matches(ends).count(), found.matches('\n').count());
        // Which of the four is fastest is a matter of chance: overlap and order may stand there too.
        let lines: Vec<&str> =
            found.lines().filter(|l| !l.starts_with("overlap =") && !l.starts_with("order =")).collect();
        let wanted = text.replace("'segments'", "\"analytic\"");
        assert_eq!(lines, wanted.lines().collect::<Vec<_>>());
        folder.voltet(&["check", "scene.toml"]).ok();
    }
}

/// The slab's scalar is linear: no grid says more of it, and what is left is rounding. Of a curved one finer grids do.
#[test]
fn a_refined_study_tells_the_data_model_from_the_integration() {
    let folder = folder();
    let errors = |curved: bool| {
        folder.write("cube.vtu", if curved { cube_of(3, "x", |x| x * x) } else { cube(3) });
        let ran = folder.voltet(&study(&["analytic", "--refine", "1", "--output", "out"])).ok();
        let found = &folder.json("out/study.json")["refinement"];
        assert_eq!(found["cells"], serde_json::json!([162, 8 * 162]));
        for text in ["grids of 162, 1296 cells", "since the data are taken as linear in cells"] {
            assert!(ran.stdout.contains(text), "'{text}' is not in\n{}", ran.stdout);
        }
        let page = std::fs::read_to_string(folder.join("out/study.html")).unwrap();
        assert!(page.contains("since the data are taken as linear in cells"));
        ["model_error", "integration_error"].map(|name| found[name].as_f64().unwrap())
    };
    let ([straight, _], [curved, integration]) = (errors(false), errors(true));
    // Pictures of 32 bits.
    assert!(straight < 1e-5, "{straight:e}");
    assert!(curved > 1e-3 && curved > 10.0 * integration, "{curved:e}, {integration:e}");
}

/// The scene with a node for each stage.
pub fn stages() -> String {
    let start = scene().find("[nodes.picture]").unwrap();
    let end = scene().find("[nodes.file]").unwrap();
    let stages = r#"[nodes.cells]
type = "cull"
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.order]
type = "sort"
inputs = { cells = "cells", camera = "view" }

[nodes.cover]
type = "project"
inputs = { cells = "order", camera = "view" }

[nodes.picture]
type = "composite"
inputs = { projection = "cover", transfer_function = "look" }

"#;
    format!("{}{stages}{}", &scene()[..start], &scene()[end..])
}

#[test]
fn the_stages_one_by_one_are_studied_too() {
    let folder = folder();
    folder.write("scene.toml", stages());
    folder.voltet(&study(&["analytic,riemann"])).ok();
    let json = folder.json("scene.study/study.json");
    assert_eq!(json["rows"].as_array().unwrap().len(), 4 + 9);
    assert_eq!(json["node"], "picture");
}

#[test]
fn what_cannot_be_studied_is_said() {
    let folder = folder();
    let whole = scene();
    folder.voltet(&study(&["rieman"])).fails(2, &["--only", "rieman", "riemann"]);
    let point =
        "kind = \"piecewise-linear\"\npoints = [[0.2, 1.0, 1.0, 1.0, 1.0], [0.6, 1.0, 1.0, 1.0, 2.0]]\n\n";
    let (start, end) = (whole.find("kind = \"gaussian\"").unwrap(), whole.find("[nodes.view]").unwrap());
    folder.write("scene.toml", format!("{}{point}{}", &whole[..start], &whole[end..]));
    folder.voltet(&study(&["tabulated"])).fails(2, &["none of the integrators", "tabulated"]);
    folder.write("scene.toml", &whole);
    folder.voltet(&["study", "none.toml"]).fails(2, &["none.toml", "cannot be read"]);
    folder.voltet(&study(&["analytic", "--node", "pictur"])).fails(2, &["pictur", "picture"]);
    let note = "[nodes.figure]\ntype = \"annotation\"\ninputs = { image = \"picture\" }\n";
    folder.write("figure.toml", whole.replace("image = \"picture\"", "image = \"figure\"") + note);
    let of_figure = ["study", "figure.toml"].into_iter().chain(QUICK).chain(["analytic", "--node", "figure"]);
    // It is of the picture behind the annotation.
    folder.voltet(&of_figure.collect::<Vec<_>>()).ok();
    folder.voltet(&study(&["analytic", "--max-error", "-1"])).fails(2, &["--max-error"]);
    folder.voltet(&study(&["analytic", "--frames", "0"])).fails(2, &["--frames"]);
    folder.voltet(&study(&["riemann", "--max-error", "0"])).fails(1, &["no setting keeps", "at most 0"]);
    assert_eq!(std::fs::read_to_string(folder.join("scene.toml")).unwrap(), whole);
    folder.write("taken", "a file");
    folder.voltet(&study(&["analytic", "--output", "taken"])).fails(1, &["taken", "folder"]);
    folder.voltet(&study(&["analytic", "--output", "taken/below"])).fails(1, &["taken", "folder"]);
    folder.voltet(&["study", "scene.toml", "--cache", "taken"]).fails(1, &["taken", "--cache"]);
    folder.write("scene.toml", whole.replace("\"renderer\"", "\"rendrer\""));
    folder.voltet(&study(&["analytic"])).fails(2, &["scene.toml", "rendrer"]);
}
