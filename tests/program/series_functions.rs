//! One transfer function for a whole series: unit distances and probes.

use crate::series::series;
use crate::support::{Folder, cube_of};

/// A series of cubes with sides of 1, 2, … and a pipeline that leaves its unit distance to the data.
fn growing(count: usize) -> Folder {
    let folder = series(count);
    for step in 0..count {
        let text = cube_of(2, "T", |x| x * (1.0 + step as f64));
        let (head, rest) = text.split_once("Name=\"Points\"").unwrap();
        let (tag, rest) = rest.split_once('>').unwrap();
        let (points, tail) = rest.split_once('<').unwrap();
        let larger =
            points.split_whitespace().map(|number| number.parse::<f64>().unwrap() * (1.0 + step as f64));
        let larger: Vec<String> = larger.map(|number| number.to_string()).collect();
        folder.write(
            &format!("s{step}.vtu"),
            format!("{head}Name=\"Points\"{tag}>{}<{tail}", larger.join(" ")),
        );
    }
    let scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    folder.write("p.toml", scene.replace("unit_distance = 0.5\n", ""));
    folder
}

/// The unit distance of each step of a report.
fn unit_distances(folder: &Folder, report: &str) -> Vec<f64> {
    let steps = folder.json(report)["runs"][0]["steps"].clone();
    let unit = |step: &serde_json::Value| {
        step["run"]["provenance"]["units"]["unit_distances"][0]["length"].as_f64().unwrap()
    };
    steps.as_array().unwrap().iter().map(unit).collect()
}

#[test]
fn a_unit_distance_of_the_data_is_that_of_the_series() {
    let folder = growing(3);
    let run = |arguments: &[&str]| {
        let common = ["run", "p.toml", "--steps", "all", "--report", "r.json"];
        folder.voltet(&[&common[..], arguments].concat()).ok().stdout
    };
    // Cubes at the origin: together the largest.
    let wanted = 27f64.sqrt() / 100.0;
    let said = run(&[]);
    assert!(said.contains(&format!("look: unit_distance = {wanted:?} (over 3 time steps)")), "{said}");
    assert_eq!(unit_distances(&folder, "r.json"), [wanted; 3]);
    // The picture says so itself: it draws the step again, bit for bit.
    folder.voltet(&["run", "p_0000.exr", "-o", "again.exr"]).ok();
    assert_eq!(folder.floats("again.exr"), folder.floats("p_0000.exr"));
    let own = run(&["--ranges", "step"]);
    assert!(!own.contains("unit_distance"), "{own}");
    let of_steps = unit_distances(&folder, "r.json");
    for (unit, side) in of_steps.iter().zip([1.0, 2.0, 3.0]) {
        // Two roundings of the root and one of the hundredth.
        assert!((unit - side * 3f64.sqrt() / 100.0).abs() < 1e-15, "{of_steps:?}");
    }
    assert_ne!(folder.floats("again.exr"), folder.floats("p_0000.exr"), "another unit, another picture");
}

/// T of step k is evenly distributed from 0 to k + 1, and its gradient is k + 1.
#[test]
fn a_probe_finds_one_widget_for_the_whole_series() {
    let folder = series(3);
    let scene = std::fs::read_to_string(folder.join("p.toml")).unwrap();
    let (head, tail) = scene.split_once("[nodes.look]").unwrap();
    let tail = tail.split_once("[nodes.view]").unwrap().1.replace("\"look\"", "\"found\"");
    let probe = "[nodes.found]\ntype = \"probe\"\nbox = { low = [0.0, 0.0, 0.0], high = [1.0, 1.0, 1.0] }\n\
                 inputs = { volume = \"gradient\" }\n\n[nodes.view]";
    folder.write("p.toml", format!("{head}{probe}{tail}"));
    let run = |arguments: &[&str]| {
        folder.voltet(&[&["run", "p.toml", "--steps", "all"], arguments].concat()).ok().stdout
    };
    // Means 1/2, 1, 3/2 and variances 1/12, 4/12, 9/12: together 1 and 14/36 + 1/6; of the gradient 2 and 2/3.
    let said = run(&[]);
    assert!(said.contains("found: s 1.000 ± 0.745, g 2.000 ± 0.816 ("), "{said}");
    assert!(said.contains("(over 3 time steps)"), "{said}");
    assert_eq!(said.matches("found: s ").count(), 1, "one for all: {said}");
    let own = run(&["--ranges", "step"]);
    assert_eq!(own.matches("found: s ").count(), 3, "{own}");
    assert!(own.contains("s 0.500 ± 0.289"), "{own}");
}

/// T of step k is (k + 1) x at the time k / 10: in the middle of the steps 1 and 2 it is 2.5 x.
#[test]
fn values_between_steps_lie_on_a_straight_line_where_that_is_asked_for() {
    let folder = series(4);
    let linear = ["--set", "grid.between_steps=linear"];
    let run = |arguments: &[&str]| folder.voltet(&[&["run", "p.toml"][..], arguments].concat());
    let said = run(&[&linear[..], &["--times", "0.1:0.2:0.05", "-o", "t{time}.exr"]].concat()).ok().stdout;
    assert!(said.contains("grid: between the steps 1 and 2: 0."), "{said}");
    folder.write("middle.vtu", cube_of(2, "T", |x| 2.5 * x));
    run(&["--set", "grid.path=middle.vtu", "-o", "middle.exr"]).ok();
    // 0.15 lies half way up to rounding, which 32 bits of the picture may show in the last place.
    let ((_, middle), (_, between)) = (folder.floats("middle.exr"), folder.floats("t0.15.exr"));
    let pairs = middle.iter().flatten().zip(between.iter().flatten());
    let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    assert!(off < 1e-6, "{off}");
    // At the steps themselves, and without the word, it is the step.
    for (step, time) in [("1", "t0.1.exr"), ("2", "t0.2.exr")] {
        run(&["--steps", step, "-o", "own.exr"]).ok();
        assert_eq!(folder.floats("own.exr"), folder.floats(time), "{step}");
    }
    run(&["--times", "0.16", "-o", "nearest.exr"]).ok();
    assert_eq!(folder.floats("nearest.exr"), folder.floats("t0.2.exr"));
    // The picture says how it was made, of which files, and draws itself again.
    let carried = folder.voltet(&["info", "t0.15.exr"]).ok().stdout;
    for wanted in ["between_steps = \"linear\"", "time = 0.15", "s1.vtu, s2.vtu"] {
        assert!(carried.contains(wanted), "{wanted}: {carried}");
    }
    folder.voltet(&["run", "t0.15.exr", "-o", "again.exr"]).ok();
    assert_eq!(folder.floats("again.exr").1, between);
    // Meshes that differ have nothing between them.
    folder.write("s2.vtu", cube_of(3, "T", |x| x));
    run(&[&linear[..], &["--times", "0.15"]].concat()).fails(2, &["meshes of the steps around", "nearest"]);
}
