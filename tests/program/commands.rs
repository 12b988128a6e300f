//! The commands beside `run`.

use super::support::{Folder, SLAB, cube, cube_of};

#[test]
fn check_reads_no_data_and_names_every_wrong_file() {
    let folder = Folder::new();
    std::fs::remove_file(folder.join("cube.vtu")).unwrap();
    let ran = folder.voltet(&["check", "slab.toml"]).ok();
    assert_eq!(ran.stdout, "slab.toml: in order, 6 nodes\n");
    folder.write("a.toml", SLAB.replace("scalar", "scaler"));
    folder.write("b.toml", "nonsense");
    let ran = folder.voltet(&["check", "a.toml", "slab.toml", "b.toml"]);
    assert_eq!((ran.code, ran.errors()), (2, 2), "{}", ran.stderr);
    assert!(ran.stdout.contains("slab.toml: in order"));
    assert_eq!(folder.names(), ["a.toml", "b.toml", "slab.toml"]);
}

#[test]
fn unused_nodes_are_warned_of_with_their_line() {
    let folder = Folder::new();
    folder.write("slab.toml", SLAB.replace("volume = \"gradient\"", "volume = \"grid\""));
    let ran = folder.voltet(&["check", "slab.toml"]).ok();
    assert!(ran.stderr.contains("warning: the node 'gradient' is not used"), "{}", ran.stderr);
    assert!(ran.stderr.contains("slab.toml:10:8"), "{}", ran.stderr);
}

#[test]
fn explain_says_what_runs_and_what_is_left_out_without_the_data() {
    let folder = Folder::new();
    std::fs::remove_file(folder.join("cube.vtu")).unwrap();
    let text = folder.voltet(&["explain", "slab.toml"]).ok().stdout;
    let engine = match cfg!(feature = "gpu") {
        true => "auto (the run takes the GPU if a hardware adapter holds the scene, else the CPU)",
        false => "cpu (this build has no GPU engine)",
    };
    for wanted in [
        "slab.toml: An even slab",
        &format!("Engine of 'picture': {engine}"),
        "gradient: no gradient: no widget looks at the gradient magnitude and nothing is lit",
        "picture: no visibility order: one colour and no light",
    ] {
        assert!(text.contains(wanted), "'{wanted}' is not in\n{text}");
    }
    let place = |name: &str| text.find(&format!("\n  {name} ")).unwrap();
    assert!(place("grid") < place("gradient") && place("gradient") < place("picture"));
    let lit = "picture.light={ direction = [0, 0, 1] }";
    let region = "look.widgets.0.region={ g = [0.5, 2.0] }";
    let text = folder.voltet(&["explain", "slab.toml", "--set", lit, "--set", region]).ok().stdout;
    assert!(text.contains("asked for gradient magnitude, gradient vectors"), "{text}");
    assert!(!text.contains("gradient: no") && !text.contains("no visibility order"), "{text}");
}

#[test]
fn arrays_of_widgets_and_methods_are_asked_of_the_reader() {
    let folder = Folder::new();
    let widget = "kind = \"gaussian-nd\"\nfields = [\"y\", \"ones\"]\ncentre = [0, 0]\nsigma = [1, 1]";
    let text = SLAB.replace("kind = \"uniform\"", widget).replace("region = { s = [-1.0, 2.0] }", "");
    folder.write(
        "nd.toml",
        text.replace("method = \"least-squares\"", "method = \"array\"\narray = \"gradient\""),
    );
    let text = folder.voltet(&["explain", "nd.toml"]).ok().stdout;
    assert!(text.contains("scalar = \"x\"; asked for array \"ones\", array \"y\"\n"), "{text}");
    let region = "look.widgets.0.region={ g = [0.5, 2.0] }";
    let text = folder.voltet(&["explain", "nd.toml", "--set", region]).ok().stdout;
    assert!(text.contains("asked for array \"gradient\", array \"ones\", array \"y\"\n"), "{text}");
}

#[test]
fn completions_and_manual_pages_know_every_command_and_option() {
    let folder = Folder::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = folder.voltet(&["completions", shell]).ok().stdout;
        for word in ["gradient-test", "completions", "exhaustive", "adapter"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    let ran = folder.voltet(&["completions", "tcsh"]);
    assert_eq!(ran.code, 2, "{}", ran.stderr);
    let ran = folder.voltet(&["man", "a/b"]).ok();
    let pages: Vec<String> = std::fs::read_dir(folder.join("a/b"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    assert!(ran.stderr.contains(&format!("{} pages in a/b", pages.len())), "{}", ran.stderr);
    for name in ["voltet.1", "voltet-run.1", "voltet-gradient-test.1", "voltet-man.1"] {
        let page = std::fs::read_to_string(folder.join("a/b").join(name)).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{name}");
    }
    let page = std::fs::read_to_string(folder.join("a/b/voltet-run.1")).unwrap();
    assert!(page.contains("\\-\\-exhaustive") && page.contains("WIDTHxHEIGHT"), "{page}");
    assert!(!pages.iter().any(|name| name.contains("plugin-process")), "{pages:?}");
    // A file stands where the folder should.
    let ran = folder.voltet(&["man", "slab.toml"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("the pages cannot be written"), "{}", ran.stderr);
}

#[test]
fn nodes_are_listed_and_shown() {
    let folder = Folder::new();
    let list = folder.voltet(&["nodes"]).ok().stdout;
    for node in voltet::nodes::NODES {
        assert!(list.contains(node.name) && list.contains(node.summary), "{}", node.name);
        let shown = folder.voltet(&["nodes", node.name]).ok().stdout;
        for parameter in node.parameters {
            assert!(shown.contains(parameter.name) && shown.contains(parameter.help), "{}", parameter.name);
        }
    }
    let markdown = folder.voltet(&["nodes", "--markdown"]).ok().stdout;
    assert!(markdown.contains("## image-writer") && markdown.contains("| `background` |"), "{markdown}");
    folder
        .voltet(&["nodes", "rendrer"])
        .fails(2, &["unknown node type or gradient filter 'rendrer'", "'renderer', the nearest name"]);
    let gradient = folder.voltet(&["nodes", "gradient-magnitude"]).ok().stdout;
    for filter in voltet::core::field::filters() {
        let kind = filter.declaration();
        let shown = folder.voltet(&["nodes", kind.name]).ok().stdout;
        let known = |text: &str, word: &str| text.contains(word) && text.contains(kind.summary);
        assert!(known(&list, kind.name) && known(&shown, &format!("method = \"{}\"", kind.name)), "{shown}");
        assert!(known(&gradient, &format!("method = \"{}\"", kind.name)), "{gradient}");
        assert!(known(&markdown, &format!("`{}`", kind.name)), "{markdown}");
        for parameter in kind.parameters {
            assert!(
                [&shown, &gradient, &markdown].iter().all(|text| text.contains(parameter.help)),
                "{shown}"
            );
        }
    }
}

#[test]
fn info_describes_a_file_and_suggests_a_pipeline_that_runs() {
    let folder = Folder::new();
    let text = folder.voltet(&["info", "cube.vtu"]).ok().stdout;
    for wanted in [
        "64 points, 27 cells",
        "27  hexahedra",
        "x  [0, 1]",
        "gradient  Float64 × 3  length [1, 1]",
        "cell   layer",
    ] {
        assert!(text.contains(wanted), "'{wanted}' is not in\n{text}");
    }
    let (_, pipeline) = text.split_once("A pipeline to start with\n").unwrap();
    folder.write("suggested.toml", pipeline);
    folder.voltet(&["run", "suggested.toml"]).ok();
    let picture = image::open(folder.join("picture.png")).unwrap().into_rgb8();
    assert!(picture.pixels().any(|pixel| pixel.0 != [0; 3]), "the suggested picture shows something");
    folder.voltet(&["info", "cubs.vtu"]).fails(1, &["cubs.vtu"]);
    folder.write("cube.vtu", cube(1));
    let text = folder.voltet(&["info", "cube.vtu"]).ok().stdout;
    for wanted in ["8 points, 1 cell\n", "             1  hexahedron\n", "in 1 piece\n"] {
        assert!(text.contains(wanted), "'{wanted}' is not in\n{text}");
    }
    // A type that VTK does not have is given by its number.
    let unknown =
        cube(1).replace("Name=\"types\" format=\"ascii\">12<", "Name=\"types\" format=\"ascii\">99<");
    folder.write("cube.vtu", unknown);
    let ran = folder.voltet(&["info", "cube.vtu"]);
    assert!(
        (ran.stdout.clone() + &ran.stderr).contains("cell of unknown type (99)"),
        "{}{}",
        ran.stdout,
        ran.stderr
    );
}

#[test]
fn a_name_that_is_wrong_is_answered_with_those_that_are_right_the_nearest_first() {
    let folder = Folder::new();
    let constant = cube_of(1, "x", |_| 1.0);
    let constant: Vec<&str> = constant.lines().filter(|line| !line.contains("Name=\"y\"")).collect();
    folder.write("constant.vtu", constant.join("\n"));
    folder.write("one.vtu", cube(3).replace("Name=\"gradient\"", "Name=\"x gradient\""));
    let set = |option: &'static str| vec!["run", "slab.toml", "--set", option];
    let nodes = "one of grid, gradient, look, view, picture, file";
    for (arguments, hint) in [
        (vec!["rnu"], "'run', the nearest name, or one of run, check, explain, nodes, info, start"),
        (vec!["draw"], "one of run, check, explain"),
        (vec!["help", "rendrer"], "'renderer', the nearest name, or one of renderer, "),
        (vec!["help", "least"], "'least-squares', the nearest name, or one of least-squares, "),
        (vec!["nodes", "rendrer"], "'renderer', the nearest name, or one of renderer, "),
        (vec!["run", "slab.tml"], "'slab.toml'"),
        (vec!["info", "cub.vtu"], "a file that is there, such as 'cube.vtu' beside it"),
        (vec!["start", "cub.vtu", "-o", "new.toml"], "a file that is there, such as 'cube.vtu' beside it"),
        (set("grid.path=cub.vtu"), "a file that is there, such as 'cube.vtu' beside it"),
        (
            vec!["start", "cube.vtu", "-o", "new.toml", "--scalar", "Y"],
            "--scalar NAME: y, x, ones, layer, gradient",
        ),
        (
            vec!["start", "cube.vtu", "-o", "new.toml", "--scalar", "ones"],
            "another array after --scalar: x, y, layer",
        ),
        (vec!["start", "one.vtu", "-o", "new.toml", "--scalar", "gradeint"], "--scalar NAME: x gradient, "),
        (
            vec!["start", "constant.vtu", "-o", "new.toml", "--scalar", "x"],
            "a file with an array whose values differ: this one has none",
        ),
        (vec!["start", "constant.vtu", "-o", "new.toml"], "a file with an array whose values differ"),
        (set("x"), &format!("NODE.PARAMETER=value, where NODE is {nodes}")),
        (set("grdi=3"), &format!("NODE.PARAMETER=value, where NODE is 'grid', the nearest name, or {nodes}")),
        (set("grid=3"), "grid.PARAMETER=value; `voltet nodes reader` shows the parameters"),
        (set("grid.type=3"), "the name of a parameter: grid.PARAMETER=value; `voltet nodes reader`"),
        (set("grdi.path=3"), &format!("'grid', the nearest name, or {nodes}")),
        (set("grid.pat=3"), "'path', the nearest name, or one of path, scalar, "),
        (set("grid.scalar=one"), "'ones', 'x', 'y', "),
        (set("grid.scalar=x:7"), "'magnitude' or 0"),
        (set("gradient.method=least"), "'least-squares', the nearest name, or one of least-squares, "),
        (set("look.widgets.0.kind=gausian"), "'gaussian', the nearest name, or one of uniform, "),
        (
            set(
                "look.widgets.0={ kind = \"gaussian-nd\", fields = [\"gradient\"], centre = [0], sigma = [1], color = [1, 1, 1], extinction = 1 }",
            ),
            "'gradient:magnitude', or 'gradient:0' for a component",
        ),
        (set("picture.engine=gpuu"), "'gpu', the nearest name, or one of auto, cpu, gpu"),
        (set("picture.integrator=segment"), "'segments', the nearest name, or one of analytic, "),
        (set("file.format=gif"), "one of auto, png, exr"),
        (vec!["study", "slab.toml", "--only", "riemannn"], "'riemann', the nearest name, or one of "),
        (vec!["study", "slab.toml", "--node", "foto"], "'picture'"),
        (vec!["pixel", "slab.toml", "1", "1", "--node", "foto"], "'picture'"),
        (vec!["gradient-test", "least"], "'least-squares', the nearest name, or one of least-squares, "),
        (vec!["gradient-test", "least-squares", "--set", "power=1"], "no parameter: there are none"),
    ] {
        let ran = folder.voltet(&arguments);
        let hint = format!(" = help: expected {hint}");
        assert!(
            ran.code != 0 && ran.errors() == 1 && ran.stderr.contains(&hint),
            "{}: '{hint}' is not in\n{}",
            ran.command,
            ran.stderr
        );
    }
}

#[test]
fn a_wrong_command_line_exits_with_2() {
    let folder = Folder::new();
    for arguments in [&["draw"][..], &["run"], &["run", "slab.toml", "--quite"], &["nodes", "a", "b"]] {
        assert_eq!(folder.voltet(arguments).code, 2, "{arguments:?}");
    }
    for arguments in [&["--help"][..], &["run", "--help"], &["--version"]] {
        folder.voltet(arguments).ok();
    }
}
