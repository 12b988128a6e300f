//! Clips and slices whose places are not stated, or are shares of the bounds: they cut through the middle of the data, wherever these lie.

use crate::threshold::{TAKER, picture_of, taken};
use glam::DVec3;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::volume::Volume;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Demand, NoObserver, Node, Port, PortType, Value};
use voltet_nodes::{registry, session};

/// A box of 5³ cells of these sides from a corner on.
fn folder(corner: [f64; 3], sides: [f64; 3]) -> tempfile::TempDir {
    let ([x, y, z], [a, b, c]) = (corner, sides);
    let mut text = format!(
        "# vtk DataFile Version 3.0\ntext\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 6 6 6\nORIGIN {x:?} {y:?} {z:?}\n\
         SPACING {a:?} {b:?} {c:?}\nPOINT_DATA 216\nSCALARS a double 1\nLOOKUP_TABLE default\n"
    );
    (0..216).for_each(|i| writeln!(text, "{}", 2 * (i % 6) + i / 36).unwrap());
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), text).unwrap();
    folder
}

/// A pipeline with nodes before the renderer, which draws a volume with further keys.
const PIPELINE: &str = "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"a.vtk\"\nscalar = \"a\"\nNODES\n\
    [nodes.look]\ntype = \"transfer-function\"\ninputs = { volume = \"grid\" }\n\
    [[nodes.look.widgets]]\nkind = \"colormap\"\nextinction = 0.5\n\
    [nodes.view]\ntype = \"camera\"\nview = \"isometric\"\nsize = [48, 40]\ninputs = { volume = \"grid\" }\n\
    [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
    inputs = { volume = \"VOLUME\", transfer_function = \"look\", camera = \"view\" }\nKEYS\n\
    [nodes.taker]\ntype = \"taker\"\ninputs = { image = \"picture\" }\n";

/// The picture of [`PIPELINE`].
fn drawn(folder: &Path, nodes: &str, volume: &str, keys: &str) -> Result<Picture> {
    let text = PIPELINE.replace("NODES", nodes).replace("VOLUME", volume).replace("KEYS", keys);
    Ok(picture_of(&taken(&text, folder, &Demand::default())?.0))
}

#[test]
fn what_is_not_stated_cuts_through_the_middle_of_the_data() {
    for corner in [[0.0; 3], [1e8, -1e8, 3e7]] {
        let folder = folder(corner, [1.0; 3]);
        let [x, y, z] = corner.map(|low| low + 2.5);
        let [top_x, top_y, top_z] = corner.map(|low| low + 5.0);
        let low_z = corner[2];
        let radius = 0.25 * 75f64.sqrt();
        let whole = drawn(folder.path(), "", "grid", "").unwrap();
        for (silent, stated) in [
            (
                "kind = \"plane\"",
                format!("kind = \"plane\", origin = [{x:?}, {y:?}, {z:?}], normal = [1, 0, 0]"),
            ),
            (
                "kind = \"plane\", normal = [1, 2, 3], invert = true",
                format!(
                    "kind = \"plane\", origin = [{x:?}, {y:?}, {z:?}], normal = [1, 2, 3], invert = true"
                ),
            ),
            (
                "kind = \"plane\", origin = [\"50 %\", \"50 %\", \"100 %\"], normal = [0, 1, -1]",
                format!("kind = \"plane\", origin = [{x:?}, {y:?}, {top_z:?}], normal = [0, 1, -1]"),
            ),
            (
                "kind = \"box\"",
                format!(
                    "kind = \"box\", low = [{x:?}, {y:?}, {z:?}], high = [{top_x:?}, {top_y:?}, {top_z:?}]"
                ),
            ),
            (
                "kind = \"sphere\"",
                format!("kind = \"sphere\", centre = [{x:?}, {y:?}, {z:?}], radius = {radius:?}"),
            ),
            (
                "kind = \"cylinder\"",
                format!(
                    "kind = \"cylinder\", from = [{x:?}, {y:?}, {low_z:?}], to = [{x:?}, {y:?}, {top_z:?}], radius = {radius:?}"
                ),
            ),
        ] {
            let clipped =
                |clip: &str| drawn(folder.path(), "", "grid", &format!("clip = [{{ {clip} }}]")).unwrap();
            let found = clipped(silent);
            assert!(found == clipped(&stated) && found != whole, "{silent} {corner:?}");
            assert!(found.rgba.iter().any(|pixel| pixel[3] > 0.1), "{silent} {corner:?}: nothing is seen");
            let kept = |clip: &str| {
                let nodes = format!(
                    "[nodes.kept]\ntype = \"threshold\"\nclip = [{{ {clip} }}]\ninputs = {{ volume = \"grid\" }}\n"
                );
                drawn(folder.path(), &nodes, "kept", "").unwrap()
            };
            let found = kept(silent);
            assert!(found == kept(&stated) && found != whole, "threshold: {silent} {corner:?}");
        }
    }
}

#[test]
fn what_cannot_be_cut_is_refused_before_data_are_read_where_that_is_known() {
    let nowhere = tempfile::tempdir().unwrap();
    for (clip, said) in [
        ("kind = \"plane\", normal = [0, 0, 0]", "has no direction"),
        (
            "kind = \"box\", low = [\"60 %\", \"0 %\", \"0 %\"], high = [\"40 %\", \"100 %\", \"100 %\"]",
            "no inside",
        ),
        ("kind = \"sphere\", radius = \"0 %\"", "'radius' is out of range"),
        ("kind = \"sphere\", centre = [\"p50\", 0, 0]", "a percentile is a value of a field"),
        // What is sound as far as it is known is read, and there is no file.
        ("kind = \"box\", high = [0.2, 0.2, 0.2]", "no such file"),
    ] {
        let error =
            drawn(nowhere.path(), "", "grid", &format!("clip = [{{ {clip} }}]")).unwrap_err().to_string();
        assert!(error.contains(said), "{clip}: {error}");
    }
}

/// Data of almost no height are cut by a plane; of those without any, a box between two equal heights is refused in words.
#[test]
fn flat_data_are_cut_by_a_plane_and_have_no_box() {
    let thin = folder([0.0, 0.0, 1e8], [1.0, 1.0, 1e-4]);
    let clipped = |keys: &str| drawn(thin.path(), "", "grid", keys).unwrap();
    let found = clipped("clip = [{ kind = \"plane\" }]");
    assert!(found != clipped(""));
    assert!(found == clipped("clip = [{ kind = \"plane\", origin = [2.5, 2.5, 1e8], normal = [1, 0, 0] }]"));
    let flat = folder([0.0, 0.0, 1e8], [1.0, 1.0, 1e-10]);
    let error = drawn(flat.path(), "", "grid", "clip = [{ kind = \"box\" }]").unwrap_err().to_string();
    assert!(error.contains("the box has no inside"), "{error}");
}

#[test]
fn the_stages_as_nodes_of_their_own_cut_as_the_renderer_does() {
    let folder = folder([7.0, 0.0, -3.0], [1.0; 3]);
    let clip = "clip = [{ kind = \"plane\", normal = [1, 2, 3] }]\n";
    let whole = drawn(folder.path(), "", "grid", "").unwrap();
    let renderer = drawn(folder.path(), "", "grid", clip).unwrap();
    let text = PIPELINE.replace("VOLUME", "grid").replace("NODES\n", "").replace("KEYS\n", clip).replace(
        "[nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = { volume = \"grid\", transfer_function = \"look\", camera = \"view\" }\n",
        "[nodes.cells]\ntype = \"cull\"\ninputs = { volume = \"grid\", transfer_function = \"look\", camera = \"view\" }\n\
         [nodes.order]\ntype = \"sort\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\
         [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"order\", camera = \"view\" }\n\
         [nodes.picture]\ntype = \"composite\"\ninputs = { projection = \"cover\", transfer_function = \"look\" }\n",
    );
    assert!(text.contains("composite"), "{text}");
    let stages = picture_of(&taken(&text, folder.path(), &Demand::default()).unwrap().0);
    let pairs = stages.rgba.as_flattened().iter().zip(renderer.rgba.as_flattened());
    // Rounding of 32-bit sums over some ten segments.
    assert!(pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) < 1e-5 && renderer != whole);
}

/// A volume whose points are nowhere, which no file gives.
static NOWHERE: Node = Node {
    name: "nowhere",
    summary: "A cell without a place.",
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the cell" }],
    demand: &|_| Ok(()),
    run: &|_| {
        let (points, scalar) = (vec![DVec3::NAN; 4].into(), vec![1.0, 2.0, 3.0, 4.0].into());
        let grid = Arc::new(Grid { points, tetrahedra: vec![[0, 1, 2, 3]].into(), ..Grid::default() });
        Ok(vec![Value::Volume(Arc::new(Volume { grid, scalar, gradient: None, gradient_magnitude: None }))])
    },
    ..Node::BLANK
};

/// It has no middle: a slice says that it is empty, and a view that there is nothing to fit.
#[test]
fn data_without_finite_points_have_no_middle() {
    let mut registry = registry().unwrap();
    registry.add(&TAKER).unwrap();
    registry.add(&NOWHERE).unwrap();
    let fed = |node: &str, input: &str| {
        let text = format!(
            "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"nowhere\"\n\
             [nodes.made]\n{node}\ninputs = {{ volume = \"grid\" }}\n\
             [nodes.taker]\ntype = \"taker\"\ninputs = {{ {input} = \"made\" }}\n"
        );
        let graph = Pipeline::parse(&text).unwrap().graph(&registry, PathBuf::new()).unwrap();
        let place = graph.nodes.iter().position(|node| node.name == "taker").unwrap();
        session().feed(&graph, place, &Demand::default(), &NoObserver)
    };
    let (_, report) = fed("type = \"slice\"", "surface").unwrap();
    let is_empty = |warning: &String| warning.contains("the grid has no points");
    assert!(report.warnings.iter().any(is_empty), "{:?}", report.warnings);
    let error = fed("type = \"camera\"\nview = \"isometric\"", "camera").unwrap_err().to_string();
    assert!(error.contains("no view of them can be fitted"), "{error}");
}
