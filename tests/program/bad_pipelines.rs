//! Mistakes in a pipeline file or an option: one error, with its line and a caret, exit code 2, and no file.

use super::support::{Folder, SLAB, cube};

#[test]
fn a_mistake_is_shown_with_its_line_and_a_caret() {
    let folder = Folder::new();
    folder.write("slab.toml", SLAB.replace("method = ", "metod = "));
    let ran = folder.voltet(&["run", "slab.toml"]).fails(2, &[]);
    let expected = r#"error: unknown parameter 'metod' (node 'gradient')
  --> slab.toml:12:1
   |
12 | metod = "least-squares"
   | ^^^^^
   |
   = help: expected 'method'
"#;
    assert_eq!(ran.stderr, expected);
    assert_eq!(folder.names(), ["cube.vtu", "slab.toml"]);
}

#[test]
fn every_kind_of_mistake_is_placed() {
    let folder = Folder::new();
    for (from, to, wanted) in [
        ("[pipeline]", "[pipeline", &["not valid TOML", "slab.toml:1:10", "^"][..]),
        ("format = 1", "format = 7", &["does not know the format: found 7", "slab.toml:2:10", "expected 1"]),
        ("format = 1\n", "", &["does not state its format", "slab.toml:1:2"]),
        ("[nodes.grid]", "[node.grid]", &["unknown key 'node'", "'nodes'"]),
        (
            "type = \"renderer\"",
            "type = \"rendrer\"",
            &["unknown node type 'rendrer'", "'renderer', the nearest", ":34:8"],
        ),
        (
            "type = \"renderer\"",
            "type = \"renderer\"\ntolerence = 1",
            &["unknown parameter 'tolerence'", "'tolerance'"],
        ),
        (
            "volume = \"gradient\"",
            "volum = \"gradient\"",
            &["has no input 'volum'", "'volume', the nearest", ":35:12"],
        ),
        (
            "volume = \"gradient\"",
            "volume = \"gradien\"",
            &["there is no node 'gradien'", "'gradient', the nearest"],
        ),
        (
            "volume = \"gradient\"",
            "volume = \"view\"",
            &["wired to the wrong type: found a camera", "grid, gradient"],
        ),
        ("volume = \"gradient\", ", "", &["the input 'volume' is not wired", "node 'picture'", ":33:8"]),
        (
            "grid = \"grid\"",
            "grid = \"gradient\"",
            &["wrong type: found a volume", "expected a grid", "grid"],
        ),
        ("path = \"cube.vtu\"\n", "", &["the parameter 'path' is missing", ":5:8"]),
        ("path = \"cube.vtu\"", "path = 3", &["'path' is of the wrong type: found 3", ":7:8"]),
        (
            "unit_distance = 0.5",
            "unit_distance = 0",
            &["out of range: found 0", "above 0 or \"auto\" (world units)"],
        ),
        ("unit_distance = 0.5", "unit_distance = \"aut\"", &["wrong type: found \"aut\""]),
        ("extinction = 1.0", "extinction = -1.0", &["'extinction' is out of range: found -1.0", ":22:14"]),
        ("extinction = 1.0", "extinction = nan", &["'extinction' is out of range: found nan"]),
        (
            "kind = \"uniform\"",
            "kind = \"unifrom\"",
            &["unknown kind: found \"unifrom\"", "'uniform', the nearest"],
        ),
        ("region = { s = [-1.0, 2.0] }", "", &["the parameter 'region' is missing", ":19:1"]),
        (
            "s = [-1.0, 2.0]",
            "s = [1, 1]",
            &["the range 's' of the region is empty: found [1, 1]", "the smaller first", ":23:16"],
        ),
        ("s = [-1.0, 2.0]", "g = [inf, inf]", &["the range 'g' of the region is empty", ":23:16"]),
        ("s = [-1.0, 2.0]", "s = [\"p50\", \"p50\"]", &["the range 's' of the region is empty", ":23:16"]),
        (
            "s = [-1.0, 2.0]",
            "polygon = [[0, 0], [1, 1], [2, 2]]",
            &["the region is not a convex polygon with an area", ":23:22"],
        ),
        ("s = [-1.0, 2.0]", "polygon = [[0, 0], [1, 0]]", &["not a convex polygon", ":23:22"]),
        ("height = 2.0", "height = 2.0\nfov_y = 30", &["exclude each other", ":30:10"]),
        (
            "height = 2.0",
            "fov_y = 180",
            &["'fov_y' is out of range: found 180", "between 0 and 180 (degrees)"],
        ),
        ("size = [8, 8]", "size = [8, 0]", &["'size' is out of range: found 0"]),
        ("size = [8, 8]", "size = [8.5, 8]", &["'size' is of the wrong type"]),
        ("size = [8, 8]", "size = [1000000000, 8]", &["'size' is out of range"]),
        ("size = [8, 8]", "size = [32768, 32768]", &["too many pixels: found 1073741824"]),
        ("up = [0.0, 0.0, 1.0]", "up = [1.0, 0.0, 0.0]", &["parallel to the view", ":29:6"]),
        ("target = [0.5, 0.5, 0.5]", "target = [-3.0, 0.5, 0.5]", &["are the same point", ":28:10"]),
        (
            "method = \"least-squares\"",
            "method = \"least-square\"",
            &["unknown gradient filter 'least-square'", "'least-squares', the nearest name", ":12:10"],
        ),
        (
            "method = \"least-squares\"",
            "method = \"array\"",
            &[
                "the parameter 'array' is missing",
                "array = … (name of an array): name of the point array",
                ":12:10",
            ],
        ),
        (
            "method = \"least-squares\"",
            "method = \"least-squares\"\narray = \"gradient\"",
            &[
                "the method \"least-squares\" has no parameter 'array'",
                "no parameter beside it; array goes with method = \"array\"",
                ":13:1",
            ],
        ),
        (
            "method = \"least-squares\"",
            "method = \"array\"\narray = 3",
            &["'array' is of the wrong type: found 3", ":13:9"],
        ),
        (
            "path = \"slab.exr\"",
            "path = \"slab.gif\"",
            &["format is not known: found slab.gif", ".png or .exr"],
        ),
        ("type = \"renderer\"", "type = \"renderer\"\nengine = \"gpus\"", &["found \"gpus\"", "gpu"]),
        (
            "type = \"renderer\"",
            "type = \"renderer\"\nintegrator = \"rieman\"",
            &["unknown integrator 'rieman'", "riemann"],
        ),
        (
            "type = \"renderer\"",
            "type = \"renderer\"\nintegrator = \"pre-integrated\"\ntable_size = 513",
            &["'table_size'", "found 513", "2 to 512"],
        ),
        ("type = \"renderer\"", "type = \"renderer\"\nlight = {}", &["'direction' is missing"]),
        (
            "[nodes.file]\ntype = \"image-writer\"\npath = \"slab.exr\"\n",
            "[nodes.file]\ntype = \"project\"\n",
            &["has no input 'image'"],
        ),
    ] {
        assert!(SLAB.contains(from), "{from}");
        folder.write("slab.toml", SLAB.replacen(from, to, 1));
        let ran = folder.voltet(&["check", "slab.toml"]).fails(2, wanted);
        assert!(ran.stderr.contains("slab.toml:") && ran.stderr.contains('^'), "{}", ran.stderr);
        assert_eq!(folder.voltet(&["run", "slab.toml"]).fails(2, wanted).stderr, ran.stderr);
        assert_eq!(folder.names(), ["cube.vtu", "slab.toml"]);
    }
}

#[test]
fn a_cycle_is_named() {
    let folder = Folder::new();
    let first = "[nodes.a]\ntype = \"sort\"\ninputs = { cells = \"b\", camera = \"view\" }\n";
    let second = "[nodes.b]\ntype = \"sort\"\ninputs = { cells = \"a\", camera = \"view\" }\n";
    folder.write("slab.toml", format!("{SLAB}{first}{second}"));
    folder
        .voltet(&["check", "slab.toml"])
        .fails(2, &["the graph has a cycle: found b → a → b", "slab.toml:"]);
}

#[test]
fn a_grid_without_gradient_cannot_serve_a_widget_that_looks_at_it() {
    let folder = Folder::new();
    let direct = SLAB.replace("volume = \"gradient\"", "volume = \"grid\"");
    folder.write("slab.toml", &direct);
    folder.voltet(&["run", "slab.toml"]).ok();
    folder.write("slab.toml", direct.replace("{ s = [-1.0, 2.0] }", "{ g = [-1.0, 2.0] }"));
    let wanted = ["gives a grid without gradient", "gradient-magnitude", "slab.toml:35:21"];
    folder.voltet(&["run", "slab.toml"]).fails(2, &wanted);
}

/// Before any data are read: the data file is not there.
#[test]
fn an_integrator_that_cannot_serve_the_widgets_is_refused_early() {
    let folder = Folder::new();
    std::fs::remove_file(folder.join("cube.vtu")).unwrap();
    folder.write("slab.toml", SLAB.replace("{ s = [-1.0, 2.0] }", "{ g = [-1.0, 2.0] }"));
    for integrator in ["pre-integrated", "pre-integrated-cylindrical"] {
        for command in ["check", "explain", "run"] {
            let option = format!("picture.integrator={integrator}");
            folder.voltet(&[command, "slab.toml", "--set", &option]).fails(
                2,
                &[
                    &format!("the integrator '{integrator}' cannot serve"),
                    "widgets[0] (uniform), which reads the gradient magnitude",
                    "analytic, adaptive, reference, segments, riemann, vertex-sampled, tabulated",
                ],
            );
        }
    }
}

#[test]
fn a_wrong_option_names_itself() {
    let folder = Folder::new();
    for (option, wanted) in [
        ("view.size=3", "'size' is of the wrong type: found 3 (--set view.size=3, node 'view')"),
        ("view.sise=3", "unknown parameter 'sise' (--set view.sise=3, node 'view')"),
        ("veiw.size=3", "there is no node 'veiw' (--set veiw.size=3)"),
        ("view.size", "the option has no '=' (--set view.size)"),
        ("look.widgets.7.extinction=1", "there is no such entry in the list: found 7"),
        ("look.unit_distance=-1", "'unit_distance' is out of range: found -1 (--set look.unit_distance=-1"),
    ] {
        folder.voltet(&["run", "slab.toml", "--set", option]).fails(2, &[wanted]);
    }
    assert_eq!(folder.names(), ["cube.vtu", "slab.toml"]);
}

#[test]
fn an_option_that_is_no_number_says_what_it_should_be() {
    let folder = Folder::new();
    folder
        .voltet(&["pixel", "slab.toml", "1.5", "3"])
        .fails(2, &["<X>", "found '1.5'", "expected a whole number"]);
    folder
        .voltet(&["stability", "--scenes", "x"])
        .fails(2, &["--scenes", "found 'x'", "expected a whole number"]);
    folder
        .voltet(&["study", "slab.toml", "--max-error", "x"])
        .fails(2, &["--max-error", "expected a number such as"]);
}

#[test]
fn a_file_that_is_no_pipeline_file_is_refused() {
    let folder = Folder::new();
    folder
        .voltet(&["run", "slap.toml"])
        .fails(2, &["the pipeline file cannot be read", "slap.toml", "'slab.toml'"]);
    folder.write("binary.toml", [0xff, 0xfe, 0x00]);
    folder.voltet(&["run", "binary.toml"]).fails(2, &["no pipeline file", "byte 0 is no UTF-8"]);
    folder.voltet(&["run", "."]).fails(2, &["the pipeline file cannot be read"]);
    folder.voltet(&["run", "cube.vtu"]).fails(2, &["this is a data file", "voltet start cube.vtu"]);
    folder.write("my cube.vtu", cube(1));
    folder.voltet(&["run", "my cube.vtu"]).fails(2, &["voltet start 'my cube.vtu'"]);
    folder.write("empty.toml", "");
    folder.voltet(&["run", "empty.toml"]).fails(2, &["does not state its format", "[pipeline]"]);
}

#[test]
fn an_integrator_that_cannot_serve_names_those_that_can_and_a_former_name_is_noted() {
    let folder = Folder::new();
    let start = SLAB.find("[[nodes.look.widgets]]").unwrap();
    let end = SLAB.find("[nodes.view]").unwrap();
    let widget = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 1.0, 1.0]\nextinction = 1.0\n\
                  centre = [0.5, 0.5]\nsigma = [0.1, 0.1]\n\n";
    let bivariate = format!("{}{widget}{}", &SLAB[..start], &SLAB[end..]);
    let with = |integrator: &str| {
        bivariate.replacen(
            "type = \"renderer\"",
            &format!("type = \"renderer\"\nintegrator = \"{integrator}\""),
            1,
        )
    };
    folder.write("slab.toml", with("pre-integrated"));
    let others = "analytic, adaptive, reference, segments, riemann, vertex-sampled, tabulated";
    let wanted = ["'pre-integrated' cannot serve", "widgets[0] (gaussian)", others];
    folder.voltet(&["check", "slab.toml"]).fails(2, &wanted);
    folder.write("slab.toml", with("clipped"));
    let ran = folder.voltet(&["check", "slab.toml"]).ok();
    assert!(ran.stderr.contains("'clipped' is now called 'analytic'"), "{}", ran.stderr);
}
