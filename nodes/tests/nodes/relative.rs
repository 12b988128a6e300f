//! Numbers relative to data: pipelines that serve other arrays and other time steps.

use super::graph;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use voltet_core::Error;
use voltet_core::error::ErrorKind;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{NoObserver, Node, ParameterValue, RunReport, Session};
use voltet_nodes::session;

/// A function of the place.
type Field<'a> = Box<dyn Fn([f64; 3]) -> f64 + 'a>;

/// A grid of 7³ points with the array `a` by this function of the place, `b` = 2 a + 8 and `c`, the same everywhere.
pub(super) fn data(a: impl Fn([f64; 3]) -> f64) -> String {
    let mut text = String::from(
        "# vtk DataFile Version 3.0\ntext\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 7 7 7\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA 343\n",
    );
    let places = || (0..343).map(|i| [i % 7, i / 7 % 7, i / 49].map(f64::from));
    let all: [(&str, Field); 3] =
        [("a", Box::new(&a)), ("b", Box::new(|p| 2.0 * a(p) + 8.0)), ("c", Box::new(|_| 5.0))];
    for (name, values) in all {
        write!(text, "SCALARS {name} double 1\nLOOKUP_TABLE default\n").unwrap();
        places().for_each(|place| writeln!(text, "{:?}", values(place)).unwrap());
    }
    text
}

fn ball([x, y, z]: [f64; 3]) -> f64 {
    (x - 2.0).powi(2) + 0.5 * (y - 3.0).powi(2) + 0.25 * z
}

/// A scene of the array with these widgets; `volume`: what feeds the transfer function.
pub(super) fn scene(file: &str, array: &str, volume: &str, widgets: &str) -> String {
    format!(
        r#"[pipeline]
format = 1
[nodes.grid]
type = "reader"
path = "{file}"
scalar = "{array}"
[nodes.gradient]
type = "gradient-magnitude"
inputs = {{ grid = "grid" }}
[nodes.look]
type = "transfer-function"
unit_distance = 1.0
inputs = {{ {volume} }}
{widgets}
[nodes.view]
type = "camera"
eye = [-9.0, -11.0, 7.0]
target = [3.0, 3.0, 3.0]
up = [0.0, 0.0, 1.0]
size = [40, 30]
[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = {{ volume = "gradient", transfer_function = "look", camera = "view" }}
[nodes.file]
type = "image-writer"
path = "out.exr"
inputs = {{ image = "picture" }}
"#
    )
}

pub(super) const WIRED: &str = "volume = \"gradient\"";

/// One of every kind that looks at s and g.
const WIDGETS: &str = r#"
[[nodes.look.widgets]]
kind = "gaussian"
color = [1.0, 0.5, 0.1]
extinction = 2.0
centre = ["30 %", "p60"]
sigma = ["6 %", "20 %"]
[[nodes.look.widgets]]
kind = "triangular-gaussian"
color = [0.1, 0.5, 1.0]
extinction = 1.0
centre = "p75"
sigma = "15 %"
[[nodes.look.widgets]]
kind = "sine-wave"
color = [0.2, 1.0, 0.1]
extinction = 0.3
origin = ["0 %", "0 %"]
angle = 20.0
period = "20 %"
region = { s = ["p5", "90 %"], g = ["0 %", "80 %"] }
[[nodes.look.widgets]]
kind = "piecewise-linear"
points = [["p40", 1.0, 1.0, 1.0, 0.0], ["p80", 1.0, 0.2, 1.0, 0.4], ["100 %", 1.0, 1.0, 1.0, 0.0]]
"#;

pub(super) fn run(session: &mut Session, text: &str, folder: &Path) -> RunReport {
    let report = graph(text, folder).and_then(|graph| session.run(&graph, &NoObserver));
    report.unwrap_or_else(|error| panic!("{error}"))
}

pub(super) fn pixels(report: &RunReport) -> &[[f32; 4]] {
    &report.pictures[0].1.rgba
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), data(ball)).unwrap();
    folder
}

#[test]
fn one_file_draws_an_array_and_its_map_alike() {
    let folder = folder();
    let mut pictures = ["a", "b"]
        .map(|array| run(&mut session(), &scene("a.vtk", array, WIRED, WIDGETS), folder.path()))
        .map(|report| pixels(&report).to_vec());
    assert!(pictures[0].iter().filter(|pixel| pixel[3] > 0.05).count() > 300);
    let [one, other] = &mut pictures;
    let differences = one.as_flattened().iter().zip(other.as_flattened()).map(|(a, b)| (a - b).abs());
    let most = differences.fold(0.0, f32::max);
    // Twice a number has its digits; the 8 added to it costs some of the last of 64 bits, and s counts from other numbers.
    assert!(most < 2e-6, "{most:e}");
}

/// The widgets with what the report says of their numbers.
fn typed(report: &RunReport, widgets: &str) -> String {
    let mut widgets: Vec<String> =
        widgets.split("[[nodes.look.widgets]]\n").skip(1).map(str::to_string).collect();
    for finding in report.findings.iter().filter(|finding| finding.what.starts_with("widget ")) {
        let (thing, numbers) = finding.what.split_once(": ").unwrap();
        let (numbers, _) = numbers.rsplit_once(" (over").unwrap();
        let number: usize = thing.split(' ').nth(1).unwrap().parse().unwrap();
        // As a person would: each key that the line shows in the place of what the file has.
        for key in ["centre", "sigma", "origin", "period", "region", "points"] {
            let Some(at) = numbers.find(&format!("{key} = ")) else { continue };
            let rest = &numbers[at..];
            let end = ["centre", "sigma", "origin", "period", "region", "points"]
                .iter()
                .filter_map(|other| rest.find(&format!(", {other} = ")))
                .min()
                .unwrap_or(rest.len());
            let lines = widgets[number].lines().map(|line| match line.starts_with(&format!("{key} = ")) {
                true => rest[..end].to_string(),
                false => line.to_string(),
            });
            widgets[number] = lines.collect::<Vec<_>>().join("\n") + "\n";
        }
    }
    widgets.iter().map(|widget| format!("[[nodes.look.widgets]]\n{widget}")).collect()
}

#[test]
fn what_the_report_says_draws_the_very_same_picture() {
    let folder = folder();
    let relative = run(&mut session(), &scene("a.vtk", "a", WIRED, WIDGETS), folder.path());
    let widgets = typed(&relative, WIDGETS);
    // The "p of "piecewise-linear" is the only one left.
    assert!(!widgets.contains('%') && widgets.matches("\"p").count() == 1, "{widgets}");
    let absolute = run(&mut session(), &scene("a.vtk", "a", "", &widgets), folder.path());
    assert!(pixels(&relative) == pixels(&absolute));
    // And nothing is left out of the picture for being relative.
    let all = run(&mut session().exhaustive(), &scene("a.vtk", "a", WIRED, WIDGETS), folder.path());
    assert!(pixels(&relative) == pixels(&all));
}

#[test]
fn numbers_are_those_of_a_ramp() {
    let folder = tempfile::tempdir().unwrap();
    // s from 10 to 40; g = 5 everywhere, but for rounding.
    std::fs::write(folder.path().join("a.vtk"), data(|[x, ..]| 10.0 + 5.0 * x)).unwrap();
    let widgets = "[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1, 1, 1]\nextinction = 1\n\
                   centre = [\"p90\", \"p50\"]\nsigma = [\"10 %\", 1]\nregion = { s = [\"0 %\", \"50 %\"] }\n";
    let report = run(&mut session(), &scene("a.vtk", "a", WIRED, widgets), folder.path());
    let numbers = &report.findings.iter().find(|f| f.what.starts_with("widget 0")).unwrap().figures["relative"]
        ["numbers"];
    let number = |pointer: &str| numbers.pointer(pointer).unwrap().as_f64().unwrap();
    // The share is met to 1e-12; the gradient of a ramp to some roundings.
    for (pointer, wanted) in [
        ("/centre/0", 37.0),
        ("/centre/1", 5.0),
        ("/sigma/0", 3.0),
        ("/region/s/0", 10.0),
        ("/region/s/1", 25.0),
    ] {
        assert!((number(pointer) - wanted).abs() < 1e-10, "{pointer}: {numbers}");
    }
    assert_eq!(report.counts["percentiles_computed"], 2);
}

#[test]
fn what_is_not_relative_is_not_looked_at() {
    let folder = folder();
    let widgets = |s: &str| {
        format!(
            "[[nodes.look.widgets]]\nkind = \"uniform\"\ncolor = [1, 1, 1]\nextinction = 1\nregion = {{ s = {s} }}\n"
        )
    };
    for (s, gradients, percentiles) in
        [("[2, 9]", 0, None), ("[\"10 %\", 9]", 0, Some(0)), ("[\"p10\", \"p20\"]", 0, Some(2))]
    {
        let report = run(&mut session(), &scene("a.vtk", "a", WIRED, &widgets(s)), folder.path());
        assert_eq!(report.counts["gradients_computed"], gradients, "{s}");
        assert_eq!(report.counts["arrays_decoded"], 1, "{s}");
        assert_eq!(report.counts.get("percentiles_computed").copied(), percentiles, "{s}");
    }
    // Another array is read because a width is relative to it, and a second run finds what the first one found.
    let nd = "[[nodes.look.widgets]]\nkind = \"gaussian-nd\"\ncolor = [1, 1, 1]\nextinction = 1\nfields = [\"b\"]\n\
              centre = [\"p50\"]\nsigma = [\"10 %\"]\n";
    let mut session = session();
    let report = run(&mut session, &scene("a.vtk", "a", WIRED, nd), folder.path());
    assert_eq!((report.counts["arrays_decoded"], report.counts["percentiles_computed"]), (2, 1));
    let more = nd.replace("\"10 %\"", "\"12 %\"");
    let report = run(&mut session, &scene("a.vtk", "a", WIRED, &more), folder.path());
    assert_eq!(report.counts["percentiles_computed"], 0);
}

/// Three steps; s of step k from 0 to 6 (k + 1).
pub(super) fn series(folder: &Path) {
    let mut collection = String::from("<VTKFile type=\"Collection\"><Collection>");
    for step in 0..3 {
        // Uniform grids have the simplest XML.
        let values: String =
            (0..343).map(|i| format!("{:?} ", f64::from(i % 7) * f64::from(step + 1))).collect();
        let text = format!(
            "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 6 0 6 0 6\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
             <Piece Extent=\"0 6 0 6 0 6\"><PointData><DataArray type=\"Float64\" Name=\"a\" format=\"ascii\">{values}\
             </DataArray><DataArray type=\"Float64\" Name=\"z\" format=\"ascii\">{values}</DataArray></PointData>\
             </Piece></ImageData></VTKFile>"
        );
        std::fs::write(folder.join(format!("step{step}.vti")), text).unwrap();
        collection += &format!("<DataSet timestep=\"{step}\" file=\"step{step}.vti\"/>");
    }
    std::fs::write(folder.join("all.pvd"), collection + "</Collection></VTKFile>").unwrap();
}

#[test]
fn a_series_has_one_range_over_all_its_steps() {
    let folder = tempfile::tempdir().unwrap();
    series(folder.path());
    let widgets = |s: &str| {
        format!(
            "relative_to = \"series\"\n[[nodes.look.widgets]]\nkind = \"uniform\"\ncolor = [1, 1, 1]\nextinction = 1\n\
             region = {{ s = {s} }}\n"
        )
    };
    let at = |step: usize, s: &str| {
        let text = scene("all.pvd", "a", WIRED, &widgets(s));
        text.replace("scalar =", &format!("time_step = {step}\nscalar ="))
    };
    let limits = |report: &RunReport| -> [f64; 2] {
        let found = report.findings.iter().find(|f| f.what.starts_with("widget 0")).unwrap();
        assert!(found.what.contains("over 3 time steps"), "{}", found.what);
        [0, 1].map(|k| found.figures["relative"]["numbers"]["region"]["s"][k].as_f64().unwrap())
    };
    let mut session = session();
    let report = run(&mut session, &at(0, "[\"50 %\", \"100 %\"]"), folder.path());
    assert_eq!(limits(&report), [9.0, 18.0]);
    // Each step once, with one array; the step that is drawn, too.
    assert_eq!((report.counts["steps_read"], report.counts["arrays_decoded"]), (3, 1));
    // Another step of the same session knows them.
    let report = run(&mut session, &at(2, "[\"50 %\", \"100 %\"]"), folder.path());
    assert_eq!((limits(&report), report.counts["steps_read"]), ([9.0, 18.0], 0));
    // Of all volume a third is even from 0 to 6, one to 12, one to 18: below 6 lie 1/3 + 1/6 + 1/9 = 11/18, below 12 all of
    // the first two and two thirds of the last, 8/9.
    let report =
        run(&mut session, &at(1, "[\"p61.111111111111111\", \"p88.88888888888889\"]"), folder.path());
    let found = limits(&report);
    // A 4,096th of what lies between the steps' own percentiles, 11 at most; by straight lines far less.
    assert!((found[0] - 6.0).abs() < 1e-3 && (found[1] - 12.0).abs() < 1e-3, "{found:?}");
    assert_eq!(report.counts["steps_read"], 6);
    // Of a step alone.
    let text = at(1, "[\"50 %\", \"100 %\"]").replace("\"series\"", "\"step\"");
    let report = run(&mut session, &text, folder.path());
    let found = report.findings.iter().find(|f| f.what.starts_with("widget 0")).unwrap();
    assert!(
        found.what.contains("s = [6.0, 12.0]") && found.what.contains("over the volume"),
        "{}",
        found.what
    );
    assert!(!report.counts.contains_key("steps_read"));
}

/// Steps of two series go on together, so that a difference to one step would be that of a step to itself.
#[test]
fn two_series_are_at_the_same_step() {
    let folder = tempfile::tempdir().unwrap();
    series(folder.path());
    let widgets = "relative_to = \"series\"\n[[nodes.look.widgets]]\nkind = \"uniform\"\ncolor = [1, 1, 1]\nextinction = 1\n\
                   region = { s = [\"0 %\", \"100 %\"] }\n";
    let at = |expression: &str, step: usize| {
        scene("all.pvd", "a", WIRED, widgets)
            .replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"both\" }")
            + &format!(
                "\n[nodes.second]\ntype = \"reader\"\npath = \"all.pvd\"\ntime_step = {step}\n[nodes.both]\ntype = \"calculator\"\n\
                 expression = \"{expression}\"\ninputs = {{ grid = \"grid\", other = \"second\" }}\n"
            )
    };
    let mut session = session();
    let report = run(&mut session, &at("a + other.a", 0), folder.path());
    let found = report.findings.iter().find(|f| f.what.starts_with("widget 0")).unwrap();
    assert!(found.what.contains("s = [0.0, 36.0]"), "{}", found.what);
    let graph = graph(&at("a - other.a", 2), folder.path()).unwrap();
    let error = session.run(&graph, &NoObserver).unwrap_err().to_string();
    assert!(error.contains("step 0 of 'grid' and step 2 of 'second'"), "{error}");
}

/// The file of a step is written again while a session is open, as a solver does.
#[test]
fn a_changed_step_is_read_again() {
    let folder = tempfile::tempdir().unwrap();
    series(folder.path());
    let widgets = |relative: &str| {
        format!(
            "relative_to = \"{relative}\"\n[[nodes.look.widgets]]\nkind = \"uniform\"\ncolor = [1, 1, 1]\nextinction = 1\n\
             region = {{ s = [\"0 %\", \"100 %\"] }}\n"
        )
    };
    let at = |step: usize, relative: &str| {
        let text = scene("all.pvd", "a", WIRED, &widgets(relative));
        text.replace("scalar =", &format!("time_step = {step}\nscalar ="))
    };
    let top = |report: &RunReport| -> f64 {
        let found = report.findings.iter().find(|f| f.what.starts_with("widget 0")).unwrap();
        found.figures["relative"]["numbers"]["region"]["s"][1].as_f64().unwrap()
    };
    let read = |report: &RunReport| !report.nodes.iter().find(|node| node.name == "grid").unwrap().reused;
    let mut session = session();
    for relative in ["step", "series"] {
        let expected = if relative == "step" { 6.0 } else { 18.0 };
        assert_eq!(top(&run(&mut session, &at(0, relative), folder.path())), expected);
    }
    assert!(!read(&run(&mut session, &at(0, "step"), folder.path())));
    let rewrite = |step: usize, from: &str, to: &str| {
        let path = folder.path().join(format!("step{step}.vti"));
        let text = std::fs::read_to_string(&path).unwrap();
        std::fs::write(&path, text.replace(from, to)).unwrap();
    };
    // Another step's file is none of what was read, but of what a range over all steps was found from.
    rewrite(2, "18.0 ", "180.0 ");
    assert!(!read(&run(&mut session, &at(0, "step"), folder.path())));
    assert_eq!(top(&run(&mut session, &at(0, "series"), folder.path())), 180.0);
    rewrite(0, "6.0 ", "60.0 ");
    let report = run(&mut session, &at(0, "step"), folder.path());
    assert!(read(&report) && top(&report) == 60.0);
    let beside = &report.origins.files[0].beside;
    assert_eq!((report.origins.files.len(), beside.len()), (1, 1));
    assert_eq!(beside[0].0, folder.path().join("step0.vti"));
}

#[test]
fn a_probe_is_placed_by_shares_of_the_bounds() {
    let folder = folder();
    let probed = |region: &str| {
        let text = scene("a.vtk", "a", "widgets = \"probe\"", "");
        let text = text
            + &format!("[nodes.probe]\ntype = \"probe\"\ninputs = {{ volume = \"gradient\" }}\n{region}\n");
        run(&mut session(), &text, folder.path())
    };
    let centre = |report: &RunReport| {
        let figures = report.findings.iter().find_map(|f| f.figures.get("centre")).unwrap();
        figures.to_string()
    };
    for (shares, places) in [
        (
            "box = { low = [\"0 %\", \"50 %\", 1], high = [\"50 %\", \"100 %\", 4] }",
            "box = { low = [0, 3, 1], high = [3, 6, 4] }",
        ),
        // Whether this is empty only the grid can say.
        (
            "box = { low = [\"50 %\", 0, 0], high = [4, \"0.5e2 %\", 2] }",
            "box = { low = [3, 0, 0], high = [4, 3, 2] }",
        ),
        ("points = [[\"25 %\", 2, \"50 %\"]]", "points = [[1.5, 2, 3]]"),
    ] {
        let [relative, absolute] = [shares, places].map(probed);
        assert_eq!(centre(&relative), centre(&absolute), "{shares}");
        assert!(relative.findings.iter().any(|f| f.what.starts_with("region: ")), "{shares}");
    }
    let diagonal = probed("sphere = { centre = [\"50 %\", \"50 %\", \"50 %\"], radius = \"10 %\" }");
    let said = &diagonal.findings.iter().find(|f| f.what.starts_with("region: ")).unwrap().what;
    assert!(said.contains("centre = [3.0, 3.0, 3.0], radius = 1.039230484541326"), "{said}");
}

fn refused(text: &str, folder: &Path) -> Error {
    let outcome = graph(text, folder).and_then(|graph| session().run(&graph, &NoObserver));
    outcome.err().unwrap_or_else(|| panic!("not refused: {text}"))
}

#[test]
fn mistakes_are_shown_where_they_are() {
    let folder = folder();
    let widget = |numbers: &str| {
        format!("[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1, 1, 1]\nextinction = 1\n{numbers}\n")
    };
    let refused = |array: &str, volume: &str, numbers: &str, wanted: &str, part: &str| {
        let text = scene("a.vtk", array, volume, &widget(numbers));
        let error = refused(&text, folder.path());
        assert!(error.to_string().contains(wanted), "{error}");
        let span = error.location.span.clone().or_else(|| {
            let (line, column) = error.location.line_column?;
            let start = text.lines().take(line - 1).map(|line| line.len() + 1).sum::<usize>() + column - 1;
            Some(start..start + part.len())
        });
        assert_eq!(&text[span.unwrap()], part, "{error}");
        error
    };
    let error = refused("a", "", "centre = [\"p50\", 1]\nsigma = [1, 1]", "no data are wired in", "\"p50\"");
    assert_eq!(error.kind, ErrorKind::Usage);
    refused("a", WIRED, "centre = [1, 1]\nsigma = [\"p5\", 1]", "is a width", "\"p5\"");
    refused("a", WIRED, "centre = [\"5 percent\", 1]\nsigma = [1, 1]", "no number relative", "\"5 percent\"");
    refused("c", WIRED, "centre = [5, 0]\nsigma = [\"5 %\", 1]", "s is the same everywhere", "\"5 %\"");
    refused(
        "a",
        WIRED,
        "centre = [5, 0]\nsigma = [5, 1]\nregion = { s = [9, \"1 %\"] }",
        "is empty",
        "[9, \"1 %\"]",
    );
    // A grid alone has no gradient.
    let grid = "volume = \"grid\"";
    let text = scene("a.vtk", "a", grid, &widget("centre = [\"p5\", \"p5\"]\nsigma = [5, 1]"));
    let error = self::refused(&text, folder.path());
    assert!(error.to_string().contains("gives a grid without gradient"), "{error}");
    let text = scene("a.vtk", "a", "widgets = \"probe\"", "")
        + "[nodes.probe]\ntype = \"probe\"\ninputs = { volume = \"gradient\" }\npoints = [[\"p5\", 1, 1]]\n";
    let error = self::refused(&text, folder.path());
    assert!(error.to_string().contains("a percentile is a value of a field"), "{error}");
}

/// Pictures are drawn again where a file changed that their numbers come from: each node with such numbers says which steps these are.
#[test]
fn nodes_whose_numbers_are_relative_to_a_series_say_which_steps_they_look_at() {
    let registry = voltet_nodes::registry().unwrap();
    let has_scope = |node: &Node| node.parameter("relative_to").is_some();
    let mut left: Vec<&str> =
        voltet_nodes::NODES.iter().filter(|node| has_scope(node)).map(|node| node.name).collect();
    assert!(left.len() > 8, "{left:?}");
    for node in voltet_nodes::NODES {
        let graph = Pipeline::parse(node.example).unwrap().graph(&registry, PathBuf::new()).unwrap();
        for own in graph.nodes.iter().filter(|own| has_scope(own.node)) {
            let steps = |word: &str| {
                let scope = ParameterValue::Text(word.into());
                (own.node.other_steps)(&own.parameters.with("relative_to", Some(scope)), 10).len()
            };
            assert_eq!(["step", "sample", "series"].map(steps), [0, 8, 10], "{}", own.node.name);
            left.retain(|name| *name != own.node.name);
        }
    }
    assert_eq!(left, [""; 0], "no example has them");
}
