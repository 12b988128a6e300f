//! The commands beside `run`.

use super::support::{Folder, SLAB};

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
        "27  hexahedron",
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
