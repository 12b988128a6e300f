//! A picture that shows nothing, next to nothing or only what lies in front says so, with the reason and the remedy: as a
//! warning on standard error and in the report, once.

use super::support::{Folder, SLAB, cube};

/// Runs the slab with these options and gives its warnings, which are those of the report.
#[track_caller]
fn warnings(folder: &Folder, file: &str, options: &[&str]) -> Vec<String> {
    let sets: Vec<&str> = options.iter().flat_map(|option| ["--set", option]).collect();
    let cpu = ["--set", "file.path=a.exr"];
    let ran = folder.voltet(&[&["run", file, "--report", "r.json"], &sets[..], &cpu].concat()).ok();
    let report = folder.report("r.json");
    let warnings =
        report["warnings"].as_array().unwrap().iter().map(|warning| warning.as_str().unwrap().to_string());
    let warnings: Vec<String> = warnings.collect();
    let said: Vec<&str> = ran.stderr.lines().filter_map(|line| line.strip_prefix("warning: ")).collect();
    assert_eq!(said, warnings);
    warnings
}

/// The stages one by one, in place of the renderer.
fn by_stages() -> String {
    SLAB.replace(
        "type = \"renderer\"\ninputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }",
        "type = \"composite\"\ninputs = { projection = \"cover\", transfer_function = \"look\" }\n\n\
         [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\n\
         [nodes.cells]\ntype = \"cull\"\n\
         inputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }",
    )
}

#[test]
fn a_picture_that_shows_nothing_says_why() {
    let folder = Folder::new();
    folder.write("stages.toml", by_stages());
    for (options, wanted) in [
        (&[][..], None),
        (
            &["look.widgets.0.region={ s = [5.0, 6.0] }"],
            Some(
                "the picture is empty: every widget lies outside the values of 'x': these are from 0 to 1, the widgets from 5 to 6. Were",
            ),
        ),
        // A curve is constant beyond its ends.
        (
            &[
                "look.widgets=[{ kind = \"piecewise-linear\", points = [[5, 1, 0, 0, 0.1], [6, 0, 1, 0, 0.2]] }]",
            ],
            Some(
                "picture: every widget lies outside the values of 'x': these are from 0 to 1, the widgets from 5 to 6.",
            ),
        ),
        (&["look.widgets=[{ kind = \"piecewise-linear\", points = [[5, 1, 0, 0, 0.1]] }]"], None),
        (
            &[
                "look.widgets=[{ kind = \"piecewise-linear\", points = [[1, 1, 0, 0, 0.1], [6, 0, 1, 0, 0.2]] }]",
            ],
            None,
        ),
        (
            &[
                "grid.scalar=ones",
                "look.widgets.0={ kind = \"gaussian\", centre = [0.0, 0.0], sigma = [0.1, inf], color = [1, 1, 1], extinction = 1e3 }",
            ],
            Some(
                "the picture is empty: every widget lies outside the values of 'ones': these are from 1 to 1, the widgets from -0.52",
            ),
        ),
        (
            &[
                "grid.scalar=ones",
                "look.widgets.0={ kind = \"gaussian\", centre = [0.0, 0.0], sigma = [0.2, inf], color = [1, 1, 1], extinction = 1e3 }",
            ],
            None,
        ),
        (
            &["look.widgets.0.region={ s = [-1.0, 2.0], g = [5.0, 6.0] }"],
            Some("no widget reaches any of the 162 cells (s lies within [0, 1], g lies within [1, 1])"),
        ),
        (
            &["view.target=[-6.0, 0.5, 0.5]"],
            Some(
                "the picture is empty: all 162 cells lie out of the camera's view. Look at the grid, which reaches from [0, 0, 0] to [1, 1, 1]: target = [0.5, 0.5, 0.5]",
            ),
        ),
        // The first layer alone is touched, and lies behind the eye.
        (
            &[
                "look.widgets.0.region={ s = [0.0, 0.1] }",
                "view.eye=[0.5, 0.5, 0.5]",
                "view.target=[2.0, 0.5, 0.5]",
            ],
            Some(
                "no widget reaches 108 of the 162 cells (s lies within [0, 1]), and the others lie out of the camera's view",
            ),
        ),
        (
            &["view.height=1e4"],
            Some("the picture is empty: no cell covers the middle of a pixel. Come nearer"),
        ),
        (
            &["look.widgets.0.extinction=0"],
            Some("the picture is empty: the extinction of every widget is 0."),
        ),
        (
            &["grid.scalar=ones", "look.widgets.0.extinction=0"],
            Some("the picture is empty: the extinction of every widget is 0."),
        ),
        // Half opaque: ln 2 over the depth 2e-5 of the slab.
        (
            &["look.widgets.0.extinction=1e-5"],
            Some(
                "nearly empty: no pixel reaches 1/255 (the largest opacity is 2.0e-5). With 3.5e4 times the extinction",
            ),
        ),
        // On both sides of 1/255.
        (
            &["look.widgets.0.extinction=1.9e-3"],
            Some("nearly empty: no pixel reaches 1/255 (the largest opacity is 3.8e-3)"),
        ),
        (&["look.widgets.0.extinction=2.1e-3"], None),
        // Seen askew some pixels are opaque and some are not.
        (&["view.eye=[-3.0, -3.0, 0.5]", "look.widgets.0.extinction=6"], None),
        (
            &["look.widgets.0.extinction=100"],
            Some("every pixel that shows anything is opaque: what lies behind"),
        ),
        (
            &["look.widgets.0.color=[200, 128, 0]"],
            Some(
                "a colour of widgets[0] has a component of 200: linear RGB, brighter than white above 1; was 0 to 255 meant?",
            ),
        ),
    ] {
        for file in ["slab.toml", "stages.toml"] {
            let found = warnings(&folder, file, options);
            assert_eq!(found.len(), usize::from(wanted.is_some()), "{file} {options:?}: {found:?}");
            let fits = |warning: &String| {
                warning.starts_with("picture: ") && wanted.is_some_and(|wanted| warning.contains(wanted))
            };
            assert!(found.iter().all(fits), "{file} {options:?}: {found:?}");
        }
    }
}

#[test]
fn cells_that_are_there_twice_are_counted_and_placed() {
    let folder = Folder::new();
    assert_eq!(warnings(&folder, "slab.toml", &[]), Vec::<String>::new());
    // The last of the eight hexahedra in place of the first, so that it is there twice.
    let text = cube(2);
    let (head, list) = text.split_once("Name=\"connectivity\" format=\"ascii\">").unwrap();
    let numbers: Vec<&str> = list.split_once('<').unwrap().0.split_whitespace().collect();
    let changed = [&numbers[numbers.len() - 8..], &numbers[8..]].concat().join(" ");
    let rest = list.split_once('<').unwrap().1;
    folder.write("cube.vtu", format!("{head}Name=\"connectivity\" format=\"ascii\">{changed}<{rest}"));
    let found = warnings(&folder, "slab.toml", &[]);
    assert_eq!(found.len(), 1, "{found:?}");
    assert!(found[0].starts_with("grid: 2 cells overlap others"), "{found:?}");
    assert!(found[0].contains("drawn twice as dense there; the first is cell 0, about [0."), "{found:?}");
}
