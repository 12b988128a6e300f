//! Nodes that make surfaces: what they ask for, what they give, what they say.

use crate::lines;
use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::surface::{EyeLight, Paint, Surface};
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Demand, Graph, NoObserver, Node, Port, PortType, RunReport, Value};
use voltet_nodes::{registry, session};
use voltet_testing::files::surfaces::{ply, stl_text};

/// Takes a surface, as a node that draws does.
static TAKER: Node = Node {
    name: "taker",
    summary: "Takes a surface.",
    inputs: &[Port { name: "surface", port_type: PortType::Surface, summary: "the surface" }],
    ..Node::BLANK
};

type Field = fn([f64; 3]) -> f64;

fn a([x, y, z]: [f64; 3]) -> f64 {
    2.0 * x - 3.0 * y + z + 20.0
}

fn b([x, y, z]: [f64; 3]) -> f64 {
    0.5 * x + y * 0.25 - z
}

/// A box of 5³ cells with three arrays, one of which nobody reads.
fn folder() -> tempfile::TempDir {
    let mut text = String::from(
        "# vtk DataFile Version 3.0\ntext\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 6 6 6\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA 216\n",
    );
    let fields: [(&str, Field); 3] = [("a", a), ("b", b), ("unread", |_| f64::NAN)];
    for (name, field) in fields {
        write!(text, "SCALARS {name} double 1\nLOOKUP_TABLE default\n").unwrap();
        for i in 0..216 {
            writeln!(text, "{:?}", field([i % 6, i / 6 % 6, i / 36].map(f64::from))).unwrap();
        }
    }
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), text).unwrap();
    std::fs::write(folder.path().join("a.stl"), stl_text("")).unwrap();
    std::fs::write(folder.path().join("a.ply"), ply("ascii")).unwrap();
    for (name, text) in [
        ("lines.vtp", lines::STREAMLINE),
        ("cloud.ply", lines::CLOUD),
        ("part.obj", lines::PART),
        ("sensors.csv", lines::SENSORS),
        ("one.csv", "x,y,z\n1,2,3\n"),
    ] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// A pipeline of a surface; `keys`: the node's type and parameters.
fn graph(folder: &Path, keys: &str) -> Result<Graph> {
    let of_volume = "[nodes.grid]\ntype = \"reader\"\npath = \"a.vtk\"\nscalar = \"a\"\n\
                     [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = { grid = \"grid\" }\n";
    let (before, inputs) = match keys.contains("surface-reader") {
        true => ("", ""),
        false => (of_volume, "inputs = { volume = \"gradient\" }"),
    };
    let text = format!(
        "[pipeline]\nformat = 1\n{before}[nodes.made]\n{keys}\n{inputs}\n[nodes.taker]\ntype = \"taker\"\n\
         inputs = {{ surface = \"made\" }}\n"
    );
    let mut registry = registry()?;
    registry.add(&TAKER)?;
    Pipeline::parse(&text)?.graph(&registry, folder.into())
}

fn feed(graph: &Graph, name: &str) -> Result<(Vec<Value>, RunReport)> {
    let place = graph.nodes.iter().position(|node| node.name == name).unwrap();
    session().feed(graph, place, &Demand::default(), &NoObserver)
}

pub fn made(keys: &str) -> Result<(Arc<Surface>, RunReport)> {
    let folder = folder();
    let (values, report) = feed(&graph(folder.path(), keys)?, "taker")?;
    let [Value::Surface(surface)] = &values[..] else { panic!("{keys}: {values:?}") };
    surface.check()?;
    Ok((surface.clone(), report))
}

pub fn surface(keys: &str) -> Surface {
    let (surface, report) = made(keys).unwrap_or_else(|error| panic!("{keys}: {error}"));
    assert!(report.warnings.is_empty(), "{keys}: {:?}", report.warnings);
    Arc::unwrap_or_clone(surface)
}

pub fn refused(keys: &str) -> String {
    made(keys).expect_err(keys).to_string()
}

pub fn mapped(surface: &Surface) -> (&[f64], [f64; 2]) {
    let Paint::Mapped { values, range, .. } = &surface.paint else { panic!("{:?}", surface.paint) };
    (values, *range)
}

fn area(surface: &Surface) -> f64 {
    let of = |corners: &[u32; 3]| {
        let [a, b, c] = corners.map(|p| surface.points[p as usize]);
        (b - a).cross(c - a).length() / 2.0
    };
    surface.triangles.iter().map(of).sum()
}

#[test]
fn a_contour_lies_where_its_values_are() {
    // a goes from 5 to 35.
    let found = surface("type = \"contour\"\nvalues = [12.0, \"50 %\"]\nopacity = 0.5");
    let (values, range) = mapped(&found);
    assert_eq!(range, [5.0, 35.0]);
    assert!(values.contains(&12.0) && values.contains(&20.0));
    for (at, value) in found.points.iter().zip(values) {
        assert!((a(at.to_array()) - value).abs() < 1e-13, "{at}: {value}");
    }
    assert_eq!((found.opacity, found.light), (0.5, Some(EyeLight { ambient: 0.3, diffuse: 0.7 })));
    // Of a linear field all normals are its direction.
    let direction = -glam::DVec3::new(2.0, -3.0, 1.0).normalize();
    assert_eq!(found.normals.len(), found.points.len());
    assert!(found.normals.iter().all(|normal| normal.distance(direction) < 1e-12));
    let flat =
        surface("type = \"contour\"\nvalues = [12.0]\nsmooth = false\nambient = 1.0\ncolor = \"#ff0000\"");
    assert_eq!((flat.normals.len(), flat.light), (0, None));
    assert_eq!(flat.paint, Paint::Uniform([1.0, 0.0, 0.0]));
    let median = surface("type = \"contour\"\nvalues = [\"p50\"]");
    // By symmetry the value in the middle; the percentile is found to 1e-12.
    assert!((mapped(&median).0[0] - 20.0).abs() < 1e-9);
}

#[test]
fn a_contour_is_coloured_by_another_array() {
    let found = surface(
        "type = \"contour\"\nvalues = [17.0]\ncolor_by = \"b\"\nrange = [-1.0, \"100 %\"]\nsteps = 4",
    );
    let (values, range) = mapped(&found);
    assert_eq!(range, [-1.0, 3.75]);
    for (at, value) in found.points.iter().zip(values) {
        assert!((b(at.to_array()) - value).abs() < 1e-14, "{at}: {value}");
    }
    let of_b = surface("type = \"contour\"\narray = \"b\"\nvalues = [0.25]");
    assert!(of_b.points.iter().all(|at| (b(at.to_array()) - 0.25).abs() < 1e-14));
    assert_eq!(mapped(&of_b).1, [-5.0, 3.75]);
}

#[test]
fn nothing_else_is_asked_for() {
    let folder = folder();
    for (keys, arrays, has_g) in [
        ("type = \"contour\"\nvalues = [12.0]", &[][..], false),
        ("type = \"contour\"\nvalues = [12.0]\ncolor_by = \"b\"", &["b"], false),
        ("type = \"contour\"\nvalues = [12.0]\ncolor = [1, 1, 1]", &[], false),
        ("type = \"contour\"\narray = \"b\"\nvalues = [0.0]\ncolor_by = \"g\"", &["b"], true),
        ("type = \"slice\"", &[], false),
        ("type = \"slice\"\ncolor_by = \"b\"", &["b"], false),
        ("type = \"boundary\"", &[], false),
        ("type = \"boundary\"\ncolor_by = \"g\"", &[], true),
        ("type = \"edges\"", &[], false),
        ("type = \"edges\"\nkind = \"cells\"\ncolor_by = \"b\"", &["b"], false),
    ] {
        let (values, _) = feed(&graph(folder.path(), keys).unwrap(), "made").unwrap();
        let volume = values[0].volume().unwrap().unwrap();
        assert_eq!(volume.grid.point_arrays.keys().collect::<Vec<_>>(), arrays, "{keys}");
        assert_eq!(volume.gradient_magnitude.is_some(), has_g, "{keys}");
        assert!(volume.gradient.is_none(), "{keys}");
        assert_eq!(volume.grid.file_cells.is_some(), keys.contains("cells"), "{keys}");
    }
}

#[test]
fn a_slice_has_the_values_of_the_data() {
    for keys in [
        "origin = [1.3, 2.1, 3.7]\nnormal = [1.0, -2.0, 0.5]",
        "normal = [0, 0, 1]",
        "origin = [\"20 %\", 0, 0]",
    ] {
        for (by, field) in [("s", a as Field), ("b", b)] {
            let found = surface(&format!("type = \"slice\"\ncolor_by = \"{by}\"\n{keys}"));
            for (at, value) in found.points.iter().zip(mapped(&found).0) {
                assert!((field(at.to_array()) - value).abs() < 1e-13, "{at}: {value}");
            }
            assert_eq!((found.opacity, found.light, found.normals.len()), (1.0, None, 0));
        }
    }
    let found = surface("type = \"slice\"\norigin = [\"20 %\", 0, 0]");
    assert!((area(&found) - 25.0).abs() < 1e-13 && found.points.iter().all(|at| at.x == 1.0));
    // The sides of the data are met from within.
    for x in ["0 %", "100 %"] {
        assert_eq!(area(&surface(&format!("type = \"slice\"\norigin = [\"{x}\", 0, 0]"))), 25.0, "{x}");
    }
    let ball = surface("type = \"slice\"\nshape = \"sphere\"\nradius = 2.0");
    // Of cells of half its radius.
    assert!((area(&ball) / (16.0 * std::f64::consts::PI) - 1.0).abs() < 0.12, "{}", area(&ball));
    let pipe = surface("type = \"slice\"\nshape = \"cylinder\"\nradius = 2.0\nnormal = [0, 0, 3]");
    assert!((area(&pipe) / (20.0 * std::f64::consts::PI) - 1.0).abs() < 0.12, "{}", area(&pipe));
}

#[test]
fn the_boundary_is_the_outside_of_the_box() {
    let found = surface("type = \"boundary\"");
    assert_eq!((found.points.len(), found.triangles.len(), area(&found)), (216 - 64, 2 * 6 * 25, 150.0));
    assert_eq!((found.opacity, found.paint, found.normals.len()), (0.15, Paint::Uniform([0.6; 3]), 0));
    let found = surface("type = \"boundary\"\ncolor_by = \"s\"\nreversed = true\nsmooth = true");
    assert!(found.points.iter().zip(mapped(&found).0).all(|(at, value)| a(at.to_array()) == *value));
    assert_eq!(found.normals.len(), found.points.len());
    let found = surface("type = \"boundary\"\ncolor_by = \"s\"\nsmooth = true\nfeature_angle = 30");
    // Twice along the edges of the box, three times at its corners.
    assert_eq!((found.points.len(), area(&found)), (152 + 12 * 4 + 8 * 2, 150.0));
    assert!(found.points.iter().zip(mapped(&found).0).all(|(at, value)| a(at.to_array()) == *value));
    assert!(found.normals.iter().all(|n| n.abs().max_element() == 1.0 && n.abs().element_sum() == 1.0));
}

#[test]
fn a_file_is_a_surface() {
    let found =
        surface("type = \"surface-reader\"\npath = \"a.stl\"\ncolor = [0.1, 0.2, 0.3]\nopacity = 0.25");
    assert_eq!((found.points.len(), found.triangles.len(), found.normals.len()), (5, 6, 0));
    assert_eq!((found.paint, found.opacity), (Paint::Uniform([0.1, 0.2, 0.3]), 0.25));
    assert_eq!(surface("type = \"surface-reader\"\npath = \"a.stl\"\nsmooth = true").normals.len(), 5);
    let found =
        surface("type = \"surface-reader\"\npath = \"a.ply\"\ncolor_by = \"level\"\nrange = [\"50 %\", 40]");
    assert_eq!(mapped(&found), (&[0.0, 10.0, 20.0, 30.0, 40.0][..], [20.0, 40.0]));
    let error =
        refused("type = \"surface-reader\"\npath = \"a.ply\"\ncolor_by = \"level\"\nrange = [\"p5\", 40]");
    assert!(error.contains("percentiles are of a volume"), "{error}");
    let error = refused("type = \"surface-reader\"\npath = \"b.stl\"");
    assert!(error.contains("a.stl"), "{error}");
}

#[test]
fn places_of_a_file_without_a_value_have_a_colour_of_their_own() {
    let folder = folder();
    // A strip of four triangles over six points, the last of which has no value.
    let text = "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\"><PolyData>\
        <Piece NumberOfPoints=\"6\" NumberOfPolys=\"4\"><PointData>\
        <DataArray type=\"Float64\" Name=\"level\" format=\"ascii\">0 1 2 3 4 nan</DataArray></PointData><Points>\
        <DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">\
        0 0 0 0 1 0 1 0 0 1 1 0 2 0 0 2 1 0</DataArray></Points><Polys>\
        <DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 1 2 3 2 3 4 3 4 5</DataArray>\
        <DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">3 6 9 12</DataArray></Polys></Piece></PolyData></VTKFile>\n";
    std::fs::write(folder.path().join("a.vtp"), text).unwrap();
    let made = |keys: &str| {
        let keys = format!("type = \"surface-reader\"\npath = \"a.vtp\"\n{keys}");
        let (values, report) = feed(&graph(folder.path(), &keys)?, "taker")?;
        let [Value::Surface(surface)] = &values[..] else { panic!("{keys}: {values:?}") };
        surface.check()?;
        Ok::<_, voltet_core::Error>((surface.clone(), report))
    };
    let (rest, report) = made("color_by = \"level\"").unwrap();
    assert_eq!(rest.triangles.len(), 3);
    assert!(format!("{:?}", report.warnings).contains("left out"), "{:?}", report.warnings);
    let (whole, report) = made("color_by = \"level\"\nbad = [1.0, 0.0, 1.0]\nambient = 1.0").unwrap();
    assert!(report.warnings.is_empty(), "{:?}", report.warnings);
    let is_bad = |&number: &usize| whole.color(number, [0.0, 0.0, 1.0], 1.0) == [1.0, 0.0, 1.0, 1.0];
    assert_eq!((0..4).filter(is_bad).collect::<Vec<_>>(), [3]);
    assert_eq!((whole.triangles.len(), mapped(&whole).1), (4, [0.0, 4.0]));
    let error = made("bad = \"#ff00ff\"").expect_err("no values").to_string();
    assert!(error.contains("nothing is coloured by values"), "{error}");
}

#[test]
fn what_is_empty_or_wrong_is_said() {
    for (keys, said) in [
        (
            "type = \"contour\"\nvalues = [3.0, 4]",
            "the surface is empty: no cell has values on both sides of 3.0, 4.0: s goes from 5.0 to 35.0",
        ),
        (
            "type = \"slice\"\norigin = [-1, 0, 0]",
            "no cell reaches the plane: points lie from 1.0 to 6.0 of it",
        ),
    ] {
        let (surface, report) = made(keys).unwrap();
        assert!(surface.triangles.is_empty());
        assert!(report.warnings.iter().any(|warning| warning.contains(said)), "{:?}", report.warnings);
    }
    let (surface, report) = made("type = \"contour\"\nvalues = [3.0, 12.0]").unwrap();
    assert!(!surface.triangles.is_empty());
    assert_eq!(report.warnings, ["made: no cell has values on both sides of 3.0: s goes from 5.0 to 35.0"]);
    for (keys, said) in [
        ("type = \"contour\"", "'values' is missing"),
        ("type = \"contour\"\nvalues = []", "there are no values"),
        ("type = \"contour\"\nvalues = [1.0]\narray = \"c\"", "'c'"),
        (
            "type = \"contour\"\nvalues = [1.0]\ncolor = [1, 1, 1]\ncolor_by = \"b\"",
            "'color' and 'color_by' exclude",
        ),
        ("type = \"contour\"\nvalues = [1.0]\nrange = [2.0, 1.0]", "the range is empty"),
        ("type = \"boundary\"\nopacity = 1.5", "'opacity' is out of range"),
        ("type = \"boundary\"\nfeature_angle = 30", "smooth = false"),
        ("type = \"boundary\"\nsmooth = true\nfeature_angle = 200", "'feature_angle' is out of range"),
        ("type = \"slice\"\nnormal = [0, 0, 0]", "no direction"),
        ("type = \"slice\"\nshape = \"sphere\"", "a sphere needs a radius"),
        ("type = \"slice\"\nradius = 1.0", "a plane has no radius"),
        ("type = \"boundary\"\ncolor_by = \"s\"\ncolormap = \"virdis\"", "viridis"),
    ] {
        let error = refused(keys);
        assert!(error.contains(said), "{keys}: {error}");
    }
}

/// Stages as nodes of their own draw surfaces and clips in the same picture as the node that holds all of them, also where cells alone
/// would need no order.
#[test]
fn stages_draw_surfaces_and_clips_as_the_renderer_does() {
    let folder = folder();
    let scene = |drawing: &str| {
        let text = format!(
            r#"[pipeline]
format = 1
[nodes.grid]
type = "reader"
path = "a.vtk"
scalar = "a"
[nodes.look]
type = "transfer-function"
unit_distance = 1.0
[[nodes.look.widgets]]
kind = "gaussian"
color = [1.0, 0.5, 0.1]
extinction = 0.5
centre = [20.0, 0.0]
sigma = [6.0, inf]
[nodes.level]
type = "contour"
values = [18.0, 22.0]
opacity = 0.5
inputs = {{ volume = "grid" }}
[nodes.view]
type = "camera"
view = "isometric"
size = [40, 30]
inputs = {{ volume = "grid" }}
{drawing}
inputs = {{ {inputs}, transfer_function = "look", surfaces = "level" }}
clip = [{{ kind = "sphere", centre = [2.5, 2.5, 2.5], radius = 1.6, invert = true }}]
[nodes.file]
type = "image-writer"
path = "out.exr"
inputs = {{ image = "picture" }}
"#,
            inputs = if drawing.contains("composite") {
                "projection = \"cover\""
            } else {
                "volume = \"grid\", camera = \"view\""
            }
        );
        let graph =
            Pipeline::parse(&text).unwrap().graph(&registry().unwrap(), folder.path().into()).unwrap();
        let report = session().run(&graph, &NoObserver).unwrap_or_else(|error| panic!("{error}"));
        report.pictures[0].1.rgba.clone()
    };
    let whole = scene("[nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"");
    let staged = scene(
        "[nodes.cells]\ntype = \"cull\"\ninputs = { volume = \"grid\", transfer_function = \"look\", camera = \"view\" }\n\
         [nodes.order]\ntype = \"sort\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\
         [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"order\", camera = \"view\" }\n\
         [nodes.picture]\ntype = \"composite\"",
    );
    assert!(whole.iter().filter(|pixel| pixel[3] > 0.3).count() > 200);
    assert!(whole == staged);
}
