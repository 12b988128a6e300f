//! The program with a filter and a node of its own, as its users meet it.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

use std::path::Path;
use std::process::Command;

const PIPELINE: &str = include_str!("../own.toml");

/// A folder with this pipeline in it.
fn folder(pipeline: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("own.toml"), pipeline).unwrap();
    folder
}

/// Runs the program there: exit code, standard output, standard error.
fn program(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::new(env!("CARGO_BIN_EXE_own-filter"));
    let output = command.current_dir(folder).args(arguments).env("NO_COLOR", "1").output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    (output.status.code().unwrap(), text(output.stdout), text(output.stderr))
}

/// The picture of a pipeline, 40 × 40 pixels, by the CPU; premultiplied linear RGBA.
fn picture(pipeline: &str) -> Vec<f32> {
    let folder = folder(pipeline);
    let options = ["--set", "view.size=[40,40]", "--set", "picture.engine=cpu", "--set", "file.path=own.exr"];
    let (code, _, stderr) = program(folder.path(), &[&["run", "own.toml"], &options[..]].concat());
    assert_eq!(code, 0, "{stderr}");
    image::open(folder.path().join("own.exr")).unwrap().into_rgba32f().into_raw()
}

fn with(method: &str) -> String {
    let own = "method = \"weighted-fit\"\npower = 2.0";
    assert!(PIPELINE.contains(own));
    PIPELINE.replace(own, method)
}

fn largest_difference(a: &[f32], b: &[f32]) -> f32 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn with_power_one_the_picture_is_that_of_least_squares() {
    let built_in = picture(&with("method = \"least-squares\""));
    assert!(built_in.iter().any(|channel| *channel > 0.2), "the picture shows something");
    // The same sums in another order of operations: some 1e-13 of g, so a bit of its 24 at most.
    let own = largest_difference(&picture(&with("method = \"weighted-fit\"")), &built_in);
    assert!(own < 1e-6, "{own:e}");
    let other = largest_difference(&picture(PIPELINE), &built_in);
    assert!(other > 1e-3, "the power is heard: {other:e}");
}

#[test]
fn help_lists_filter_and_node_with_their_parameters() {
    let folder = folder(PIPELINE);
    let help = |arguments: &[&str]| {
        let (code, stdout, stderr) = program(folder.path(), &[&["nodes"], arguments].concat());
        assert_eq!(code, 0, "{stderr}");
        stdout
    };
    let (list, markdown) = (help(&[]), help(&["--markdown"]));
    for text in ["weighted-fit", "logarithm", "grey", "numbers", "least-squares", "renderer"] {
        assert!(list.contains(text) && markdown.contains(text), "'{text}' is not in\n{list}");
    }
    let power = "power (number from 0 to 4; default: 1.0)";
    for (name, wanted) in [
        ("weighted-fit", &[power, "trust (text; default: every point alike)"][..]),
        ("gradient-magnitude", &["method = \"weighted-fit\": Linear fit", power]),
        ("logarithm", &["least (number above 0, units of s; default: 1e-30)", "type = \"logarithm\""]),
    ] {
        let shown = help(&[name]);
        for text in wanted {
            assert!(shown.contains(text), "'{text}' is not in\n{shown}");
        }
    }
}

/// 20 × 20 × 20 values that are those of a grid that ships: x.
#[test]
fn a_format_of_its_own_is_read_and_a_picture_loses_its_colour() {
    let numbers = |count: usize| {
        let values = (0..count.pow(3)).map(|i| (i % count).to_string() + " ").collect::<String>();
        format!("numbers {count} {count} {count}\n{values}\n")
    };
    let text = with("method = \"least-squares\"");
    let (begin, rest) = text.split_once("[nodes.grid]").unwrap();
    let rest = rest.split_once("[nodes.decades]").unwrap().1;
    let own = format!(
        "{begin}[nodes.grid]\ntype = \"numbers\"\npath = \"x.txt\"\nspacing = 0.5\n\n[nodes.decades]{rest}"
    );
    let folder = folder(&own.replace("image = \"picture\"", "image = \"grey\"").replace(
        "[nodes.file]",
        "[nodes.grey]\ntype = \"grey\"\ninputs = { image = \"picture\" }\n\n[nodes.file]",
    ));
    std::fs::write(folder.path().join("x.txt"), numbers(6)).unwrap();
    let (code, stdout, stderr) = program(folder.path(), &["info", "x.txt"]);
    assert_eq!(code, 0, "{stderr}");
    for text in
        ["box of numbers, text", "216 points, 125 cells", "value  Float64  [0, 5]", "type = \"numbers\""]
    {
        assert!(stdout.contains(text), "'{text}' is not in\n{stdout}");
    }
    let options = ["--set", "view.size=[40,40]", "--set", "picture.engine=cpu", "--set", "file.path=own.exr"];
    let seen = [
        "--set",
        "view.eye=[1.2,-6,2]",
        "--set",
        "view.target=[1.2,1.2,1.2]",
        "--set",
        "look.unit_distance=0.1",
    ];
    let seen =
        [&seen[..], &["--set", "look.widgets.0.centre=[0.4,0.3]", "--set", "look.widgets.0.sigma=[0.3,0.5]"]]
            .concat();
    let (code, _, stderr) = program(folder.path(), &[&["run", "own.toml"], &options[..], &seen].concat());
    assert_eq!(code, 0, "{stderr}");
    let pixels = image::open(folder.path().join("own.exr")).unwrap().into_rgba32f();
    assert!(pixels.pixels().any(|pixel| pixel[3] > 0.1), "the picture shows something");
    assert!(pixels.pixels().all(|pixel| pixel[0] == pixel[1] && pixel[1] == pixel[2]));
    // What is wrong with a file is said of it.
    std::fs::write(
        folder.path().join("x.txt"),
        "numbers 6 6 6\n1 2 3 4 many".to_string() + &" 1".repeat(300),
    )
    .unwrap();
    let (code, _, stderr) = program(folder.path(), &["run", "own.toml"]);
    assert_eq!(code, 1);
    for text in ["this is no number: found many", "x.txt", "node 'grid'"] {
        assert!(stderr.contains(text), "'{text}' is not in\n{stderr}");
    }
}

#[test]
fn explain_shows_what_the_filter_was_given_and_reads() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/heat_sink.vtu");
    let reader = format!("type = \"reader\"\npath = '{}'\nscalar = \"Temperature\"", data.display());
    let wavelet = "type = \"wavelet\"\nresolution = [20, 20, 20]";
    assert!(PIPELINE.contains(wavelet));
    let method = "method = \"weighted-fit\"\ntrust = \"part\"";
    let folder = folder(&with(method).replace(wavelet, &reader));
    let (code, stdout, stderr) = program(folder.path(), &["explain", "own.toml"]);
    assert_eq!(code, 0, "{stderr}");
    for line in [
        "decades   logarithm           least = 1.0; asked for array \"part\"",
        "gradient  gradient-magnitude  method = \"weighted-fit\"; trust = \"part\"; asked for gradient magnitude",
    ] {
        assert!(stdout.contains(line), "'{line}' is not in\n{stdout}");
    }
}

#[test]
fn mistakes_are_shown_where_they_stand() {
    for (method, wanted) in [
        (
            "method = \"weighted-fit\"\npower = 5",
            &["'power' is out of range: found 5", "own.toml:17:9", "number from 0 to 4"][..],
        ),
        (
            "method = \"weighted-fit\"\npowr = 1",
            &["the method \"weighted-fit\" has no parameter 'powr'", "own.toml:17:1", "'power', the nearest"],
        ),
        (
            "method = \"least-squares\"\npower = 1",
            &["\"least-squares\" has no parameter 'power'", "power goes with method = \"weighted-fit\""],
        ),
        (
            "method = \"weighted\"",
            &["unknown gradient filter 'weighted'", "'weighted-fit', the nearest name"],
        ),
        (
            "method = \"weighted-fit\"\ntrust = \"weights\"",
            &["a wavelet has no array of this name: found weights"],
        ),
    ] {
        let folder = folder(&with(method));
        let (code, _, stderr) = program(folder.path(), &["run", "own.toml"]);
        assert_ne!(code, 0, "{method}");
        for text in wanted {
            assert!(stderr.contains(text), "'{text}' is not in\n{stderr}");
        }
        assert!(!folder.path().join("own.png").exists());
    }
}

#[test]
fn the_program_as_it_ships_knows_neither_and_says_what_it_knows() {
    let registry = voltet::nodes::registry().unwrap();
    let open = |text: &str| voltet::Document::from_text("own.toml".as_ref(), text.into(), &[], &registry);
    let node = open(PIPELINE).unwrap_err().to_string();
    assert!(node.contains("unknown node type 'logarithm'") && node.contains("reader"), "{node}");
    let without = PIPELINE.replace("type = \"logarithm\"\nleast = 1.0", "type = \"gradient-magnitude\"");
    let filter = open(&without).unwrap_err().to_string();
    let known = "one of least-squares, quadratic-fit, volume-weighted, cell-average, array";
    assert!(filter.contains("unknown gradient filter 'weighted-fit'") && filter.contains(known), "{filter}");
}

#[test]
fn filters_of_plugins_stand_beside_its_own() {
    use voltet_testing::compilers;
    let folder = folder(&with("method = \"c-least-squares\""));
    let source = compilers::source("examples/plugin_c/least_squares.c");
    if compilers::library(folder.path(), "filter.so", &[source], &[]).is_none() {
        return;
    }
    let small = ["--set", "view.size=[40,40]", "--set", "picture.engine=cpu"];
    for own_process in [&[][..], &["--plugin-process"]] {
        let options = ["run", "own.toml", "--plugin", "filter.so"];
        let (code, _, stderr) = program(folder.path(), &[&options, &small[..], own_process].concat());
        assert_eq!(code, 0, "{stderr}");
    }
    let (_, stdout, _) = program(folder.path(), &["nodes", "--plugin", "filter.so"]);
    assert!(stdout.contains("weighted-fit") && stdout.contains("c-least-squares"), "{stdout}");
}
