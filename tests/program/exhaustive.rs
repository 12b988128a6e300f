//! Skipped work is counted, not timed, and an exhaustive run changes no picture.

use super::support::{Folder, SLAB, cube, cube_of};
use voltet::Document;
use voltet::graph::{NoObserver, RunReport, Session};
use voltet_study::{ExhaustiveComparison, SAME};

/// A second widget of another colour, which looks at g; the first one's colour is green.
const TWO: &str = r#"
[[nodes.look.widgets]]
kind = "gaussian"
color = [1.0, 0.1, 0.1]
extinction = 3.0
centre = [0.6, 1.0]
sigma = [0.1, 0.5]

[nodes.view]
"#;

/// On the native engine, whatever devices there are.
fn open(folder: &Folder, name: &str, options: &[&str]) -> Document {
    open_with(folder, name, &[options, &["picture.engine=cpu"]].concat())
}

fn open_with(folder: &Folder, name: &str, options: &[&str]) -> Document {
    let options: Vec<String> = options.iter().map(|option| option.to_string()).collect();
    Document::open(&folder.join(name), &options, &voltet::registry().unwrap()).unwrap()
}

fn run(document: &Document) -> RunReport {
    voltet::nodes::session().run(&document.graph, &NoObserver).unwrap()
}

fn exhaustive(document: &Document) -> RunReport {
    voltet::nodes::session().exhaustive().run(&document.graph, &NoObserver).unwrap()
}

/// Arrays decoded, gradients computed, tiles sorted, cells sorted, tables built.
fn work(report: &RunReport) -> [u64; 5] {
    let count = |name: &str| report.counts.get(name).copied().unwrap_or(0);
    // Rays that go from cell to cell have an order where one is needed, and where it is not say so.
    let is_left_out = report.skipped.iter().any(|left| left.what == "visibility order");
    let tiles = if count("cells_cast") > 0 && !is_left_out { 1 } else { count("tiles_sorted") };
    let [arrays, gradients, cells, tables] =
        ["arrays_decoded", "gradients_computed", "cells_sorted", "tables_built"].map(count);
    [arrays, gradients, tiles, cells, tables]
}

#[test]
fn nothing_is_decoded_computed_sorted_or_tabulated_that_the_scene_does_not_ask_for() {
    let folder = Folder::new();
    let light = "picture.light={ direction = [1, 1, 1], diffuse = 0.7 }";
    let region = "look.widgets.0.region={ g = [0.5, 2.0] }";
    // The picture is 8 pixels wide: one tile.
    for (options, wanted) in [
        (&[][..], [1, 0, 0, 0, 0]),
        (&[region], [1, 1, 0, 0, 0]),
        (&[light], [1, 1, 1, 0, 0]),
        (&["picture.silhouette=2"], [1, 1, 0, 0, 0]),
        (&["picture.silhouette=0"], [1, 0, 0, 0, 0]),
        (&["picture.integrator=segments"], [1, 0, 0, 0, 1]),
        (&["picture.integrator=pre-integrated", "picture.table_size=16"], [1, 0, 0, 0, 1]),
        (&["picture.integrator=riemann"], [1, 0, 0, 0, 0]),
        (&["look.model=constant-emitter"], [1, 0, 1, 0, 0]),
        (&["look.model=constant-emitter", "picture.order=centroid"], [1, 0, 0, 162, 0]),
        (&["gradient.method=array", "gradient.array=gradient"], [1, 0, 0, 0, 0]),
        (&[region, "gradient.method=array", "gradient.array=gradient"], [2, 1, 0, 0, 0]),
    ] {
        assert_eq!(work(&run(&open(&folder, "slab.toml", options))), wanted, "{options:?}");
    }
    folder.write("slab.toml", SLAB.replace("\n[nodes.view]\n", TWO));
    assert_eq!(work(&run(&open(&folder, "slab.toml", &[]))), [1, 1, 1, 0, 0], "two colours");
}

#[test]
fn every_node_and_the_session_say_what_was_left_out_why_and_what_that_saves() {
    let folder = Folder::new();
    let narrow = [
        "view.target=[0.5, 0.9, 0.5]",
        "view.height=0.5",
        "look.widgets.0.region={ s = [0.4, 0.6] }",
        "view.size=[3, 3]",
    ];
    let document = open(&folder, "slab.toml", &narrow);
    let mut session = voltet::nodes::session();
    let report = session.run(&document.graph, &NoObserver).unwrap();
    let said = |report: &RunReport| -> Vec<String> {
        let saving = |left: &voltet::graph::SkippedWork| match left.saving {
            Some(saving) => serde_json::to_string(&saving).unwrap(),
            None => String::new(),
        };
        report.skipped.iter().map(|left| format!("{}: {} {}", left.node, left.what, saving(left))).collect()
    };
    let left_out = said(&report);
    let total = |name: &str| report.counts[name];
    for wanted in [
        // 64 points: y and ones, the gradient's three components; 27 cells: layer.
        format!("grid: arrays y, ones, gradient, layer {{\"bytes\":{}}}", 8 * (64 * 5 + 27)),
        format!("gradient: gradient {{\"bytes\":{}}}", 8 * 64 * 4),
        "picture: cells that show nothing {\"cells\":".into(),
        "picture: cells out of view {\"cells\":".into(),
        "picture: cells under a pixel's reach {\"cells\":".into(),
        format!("picture: visibility order {{\"segments\":{}}}", total("segments")),
    ] {
        assert!(left_out.iter().any(|left| left.starts_with(&wanted)), "'{wanted}' is not in\n{left_out:#?}");
    }
    let cells = |which: &str| {
        let left = report.skipped.iter().find(|left| left.what == format!("cells {which}")).unwrap();
        match left.saving {
            Some(voltet::graph::SavedWork::Cells(count)) => count,
            other => panic!("{other:?}"),
        }
    };
    let culled = cells("that show nothing") + cells("out of view");
    assert_eq!(culled, total("cells_culled"));
    assert_eq!(culled + cells("under a pixel's reach") + total("cells_projected"), total("cells_total"));
    let again = said(&session.run(&document.graph, &NoObserver).unwrap());
    for node in ["grid", "gradient", "look", "view", "picture", "file"] {
        let wanted = format!("{node}: repetition {{\"seconds\":");
        assert!(again.iter().any(|left| left.starts_with(&wanted)), "'{wanted}' is not in\n{again:#?}");
    }
}

/// g = 2x, looked at where s = x² lies near 0.3 alone; where it was not computed it is that of another point, which nobody sees.
#[test]
fn gradients_are_computed_where_widgets_look_for_them() {
    let folder = Folder::new();
    folder.write("cube.vtu", cube_of(18, "x", |x| x * x));
    let widgets = TWO.replace("[0.6, 1.0]", "[0.3, 0.6]").replace("[0.1, 0.5]", "[0.01, 2.0]");
    let pipeline = SLAB.replace("\n[nodes.view]\n", &widgets).replace("[-1.0, 2.0]", "[0.2, 0.35]");
    folder.write("slab.toml", pipeline);
    let points_left = |report: &RunReport| {
        let left = report.skipped.iter().find(|left| left.what == "gradient at points")?;
        match left.saving {
            Some(voltet::graph::SavedWork::Points(count)) => Some(count),
            other => panic!("{other:?}"),
        }
    };
    let light = "picture.light={ direction = [1, 1, 1], diffuse = 0.7 }";
    let inside = "view.eye=[0.4, 0.5, 0.5]";
    let size = "view.size=[48, 40]";
    for options in [&[size][..], &[size, light], &[size, inside, "view.near=0.05"]] {
        let document = open(&folder, "slab.toml", options);
        let usual = run(&document);
        // 19³ points, of which four to eight layers of 19² are corners of cells in the intervals.
        let left = points_left(&usual).unwrap_or(0);
        assert!((11 * 361..=15 * 361).contains(&left), "{options:?}: {left}");
        assert_nothing_left_out(&usual, &exhaustive(&document), &format!("{options:?}"));
        assert!(usual.pictures[0].1.rgba.iter().any(|pixel| pixel[3] > 0.1), "{options:?}");
    }
    // A table spans the range of g; a filter that makes all at once, and widgets that reach all cells, save nothing.
    for options in [
        "picture.integrator=segments",
        "gradient.method=cell-average",
        "look.widgets.0.region={ g = [0.5, 2.0] }",
    ] {
        assert_eq!(points_left(&run(&open(&folder, "slab.toml", &[options]))), None, "{options}");
    }
    // Whose widgets move gets all of it the second time, and then keeps it.
    let mut session = voltet::nodes::session();
    let run_at = |session: &mut Session, s: f64| {
        let moved = format!("look.widgets.1.centre=[{s}, 0.6]");
        let report = session.run(&open(&folder, "slab.toml", &[&moved]).graph, &NoObserver).unwrap();
        let is_kept = report.skipped.iter().any(|left| left.node == "gradient" && left.what == "repetition");
        (points_left(&report).is_some(), is_kept, report.pictures[0].1.rgba.clone())
    };
    let mut pictures = Vec::new();
    for (s, is_left_out, is_kept) in
        [(0.3, true, false), (0.3, true, true), (0.5, false, false), (0.7, false, true), (0.3, false, true)]
    {
        let (left_out, kept, picture) = run_at(&mut session, s);
        assert_eq!((left_out, kept), (is_left_out, is_kept), "{s}");
        pictures.push(picture);
    }
    // The same bits, whatever was computed where nobody looks.
    assert!(pictures[4] == pictures[0] && pictures[2] != pictures[0]);
    // Where a hand will move them nothing is left for the movement to wait for.
    let mut session = voltet::nodes::session().widgets_move();
    for (s, is_kept, former) in [(0.3, false, 0), (0.5, true, 2)] {
        let found = run_at(&mut session, s);
        assert_eq!((found.0, found.1), (false, is_kept), "{s}");
        assert!(found.2 == pictures[former], "{s}");
    }
}

/// Nobody counts the cells behind that rays do not come to.
#[test]
fn tiles_that_stop_early_are_said() {
    let folder = Folder::new();
    // More cells behind each other than a ray passes at a time.
    folder.write("cube.vtu", cube(24));
    let dense = ["look.widgets.0.extinction=1e6", "view.size=[64, 64]", "view.height=0.2"];
    let report = run(&open(&folder, "slab.toml", &dense));
    let tiles = report.counts["tiles_stopped"];
    let wanted = format!("cells of {tiles} tiles that stopped early");
    let left = report.skipped.iter().find(|left| left.what == wanted);
    assert!(tiles > 0 && left.is_some(), "{:#?}", report.skipped);
}

/// Asserts the counts of an exhaustive run beside the usual one.
fn assert_nothing_left_out(usual: &RunReport, all: &RunReport, what: &str) {
    let comparison = ExhaustiveComparison::compare(usual, all);
    assert!(comparison.is_same(), "{what}: {comparison:#?}");
    assert!(all.skipped.is_empty(), "{what}: {:?}", all.skipped);
    assert_eq!(all.findings, usual.findings, "{what}");
    for count in ["cells_culled", "tiles_stopped"] {
        assert_eq!(all.counts.get(count).copied().unwrap_or(0), 0, "{what}: {count}");
    }
}

#[test]
fn doing_everything_changes_no_picture_and_leaves_nothing_out_on_every_engine() {
    let folder = Folder::new();
    folder.write("two.toml", SLAB.replace("\n[nodes.view]\n", TWO));
    let untouched = "look.widgets.1.centre=[9.0, 1.0]";
    let inside = "view.eye=[0.4, 0.5, 0.5]";
    let light = "picture.light={ direction = [1, 1, 1], diffuse = 0.7 }";
    // Enough cells behind each other that a tile can leave some of its list.
    folder.write("dense.vtu", cube(8));
    folder.write("dense.toml", SLAB.replace("cube.vtu", "dense.vtu").replace("\n[nodes.view]\n", TWO));
    let (slab, two, dense) = ("slab.toml", "two.toml", "dense.toml");
    for (name, options) in [
        (slab, &[][..]),
        (slab, &["picture.silhouette=2", "view.eye=[-3.0, 2.5, 1.5]"]),
        (slab, &["look.widgets.0.region={ s = [0.4, 0.6] }", "view.height=0.5"]),
        (two, &[]),
        (two, &[untouched]),
        (two, &[inside, "view.near=0.05"]),
        (two, &[light]),
        (two, &["look.model=constant-emitter"]),
        (two, &["picture.order=centroid"]),
        (dense, &["look.widgets.0.extinction=1e6", "view.height=0.9"]),
    ] {
        for engine in voltet::nodes::drawing::ENGINES {
            let mut options = [options, &["view.size=[48, 40]"]].concat();
            let named = format!("picture.engine={}", engine.name);
            options.push(&named);
            if engine.on_device {
                options.extend(["picture.adapter=software", "picture.compositor=tiles"]);
            }
            let document = open_with(&folder, name, &options);
            let Some(usual) = drawn(&document, voltet::nodes::session()) else { continue };
            let all = exhaustive(&document);
            assert_nothing_left_out(&usual, &all, &format!("{name}, {options:?}"));
            assert_eq!(all.engine.as_ref().map(|named| named.0.as_str()), Some(engine.name));
            assert!(all.pictures[0].1.rgba.iter().any(|pixel| pixel[3] > 0.0), "{options:?}");
            // The analytic integrator has no table that could be left out.
            let [arrays, gradients, tiles, cells, tables] = work(&all);
            assert_eq!([arrays, gradients, tables], [5, 1, 0], "{options:?}");
            // Rays from cell to cell meet them in order.
            let is_in_order = tiles > 0 || cells == 162 || all.counts.contains_key("cells_cast");
            assert!(engine != voltet::nodes::drawing::NATIVE || is_in_order, "{options:?}");
        }
    }
}

/// The report of a run; `None` where there is no device to draw on, said loudly, or a failure where one is required.
fn drawn(document: &Document, mut session: Session) -> Option<RunReport> {
    match session.run(&document.graph, &NoObserver) {
        Ok(report) => Some(report),
        Err(error) => {
            let text = error.to_string();
            assert!(
                text.contains("no adapter is called \"software\"") || text.contains("no GPU engine"),
                "{text}"
            );
            voltet_testing::skipped_without_device(text);
            None
        }
    }
}

/// Every node by its own example, on data that the examples' widgets and probes are about.
#[test]
fn every_node_that_ships_does_everything_where_nothing_may_be_left_out() {
    let folder = Folder::new();
    let cube = cube_of(4, "temperature", |x| 300.0 + 100.0 * x * x);
    folder.write("data.vtu", cube.replace("\"layer\"", "\"zone\"").replace("\"y\"", "\"humidity\""));
    let facet =
        "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";
    folder.write("part.stl", format!("solid part\n{facet}endsolid part\n"));
    let registry = voltet::registry().unwrap();
    for node in registry.iter() {
        let smaller = node.example.replace("[1024, 768]", "[32, 24]").replace("[512, 512]", "[32, 32]");
        let nearer = smaller.replace("eye = [0.0, -12.0, 6.0]", "eye = [0.2, -3.0, 1.0]");
        folder.write("example.toml", nearer.replace("\"discrete\"", "\"software\""));
        let document = Document::open(&folder.join("example.toml"), &[], &registry).unwrap();
        let Some(usual) = drawn(&document, voltet::nodes::session()) else { continue };
        assert!(!usual.skipped.is_empty(), "{}", node.name);
        assert_nothing_left_out(&usual, &exhaustive(&document), node.name);
    }
}

#[test]
fn a_run_that_leaves_nothing_out_says_what_it_costs() {
    let folder = Folder::new();
    let ran = folder
        .voltet(&["run", "slab.toml", "--exhaustive", "--report", "r.json", "--set", "picture.engine=cpu"])
        .ok();
    for text in ["the exhaustive run took", "times as long", "the pictures differ by at most"] {
        assert!(ran.stdout.contains(text), "'{text}' is not in\n{}", ran.stdout);
    }
    let report = folder.report("r.json");
    let comparison = &report["exhaustive"];
    assert_eq!(comparison, &report["no_leave_out"], "the key of former versions");
    assert!(comparison["largest_difference"].as_f64().unwrap() <= SAME, "{comparison:#}");
    assert!(comparison["times_slower"].as_f64().unwrap() > 0.0);
    let left_out: Vec<&str> =
        comparison["left_out"].as_array().unwrap().iter().filter_map(|left| left["what"].as_str()).collect();
    assert_eq!(left_out, ["arrays y, ones, gradient, layer", "gradient", "visibility order"]);
    assert_eq!(comparison["nodes"].as_array().unwrap().len(), 6);
    assert_eq!(report["counts"]["arrays_decoded"], 5);
    assert!(folder.names().contains(&"slab.exr".to_string()));
    let plain = folder.voltet(&["run", "slab.toml"]).ok();
    assert!(!plain.stdout.contains("exhaustive"), "{}", plain.stdout);
}

#[test]
fn explain_knows_from_headers_which_arrays_are_not_read() {
    let folder = Folder::new();
    let ran = folder.voltet(&["explain", "slab.toml"]).ok();
    let text = "grid: no arrays y, ones, gradient, layer: nothing looks at them (saves";
    assert!(ran.stdout.contains(text), "'{text}' is not in\n{}", ran.stdout);
    let ran = folder.voltet(&["explain", "slab.toml", "--no-leave-out"]).ok();
    assert!(ran.stderr.contains("note: --no-leave-out is now called --exhaustive"), "{}", ran.stderr);
    assert!(ran.stdout.contains("Nothing is left out, needed or not"), "{}", ran.stdout);
    assert!(ran.stdout.contains("asked for gradient magnitude, gradient vectors"), "{}", ran.stdout);
    std::fs::remove_file(folder.join("cube.vtu")).unwrap();
    let ran = folder.voltet(&["explain", "slab.toml"]).ok();
    assert!(ran.stdout.contains("'grid' does not read is known once the file is there"), "{}", ran.stdout);
}

/// On a device: what was compiled and sent for one picture serves the next, and a colour is no part of either.
#[test]
fn nothing_is_compiled_or_sent_to_a_device_twice() {
    let folder = Folder::new();
    let registry = voltet::registry().unwrap();
    let mut session = voltet::nodes::session();
    let mut draw = |more: &[&str]| {
        let options: Vec<String> =
            more.iter().chain(&["picture.engine=gpu"]).map(|option| option.to_string()).collect();
        let document = Document::open(&folder.join("slab.toml"), &options, &registry).unwrap();
        session
            .run(&document.graph, &NoObserver)
            .map(|report| ["shader_builds", "uploads", "gradients_computed"].map(|name| report.counts[name]))
    };
    let first = match draw(&[]) {
        Ok(first) => first,
        Err(error) => {
            assert!(error.to_string().contains("no hardware adapter"), "{error}");
            voltet_testing::skipped_without_device(error);
            return;
        }
    };
    assert!(first[0] > 0 && first[1] > 0, "{first:?}");
    assert_eq!(draw(&["look.widgets.0.color=[1, 0, 0]"]).unwrap(), [0, 0, 0], "another colour");
    assert_eq!(draw(&["view.size=[9, 7]"]).unwrap(), [0, 0, 0], "another size");
    // g is a further array, and a region by g further text; nothing else is sent or compiled.
    let [builds, uploads, gradients] = draw(&["look.widgets.0.region={ g = [0.5, 2.0] }"]).unwrap();
    assert!(builds > 0 && uploads > 0 && gradients == 1, "{builds} {uploads} {gradients}");
}
