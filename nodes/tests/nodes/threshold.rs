//! `threshold`: which cells it keeps, where it cuts them, what it asks for and says.

use std::fmt::Write;
use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::tetrahedron_volume;
use voltet_core::picture::Picture;
use voltet_core::volume::Volume;
use voltet_graph::pipeline::Pipeline;
use voltet_graph::{Demand, NoObserver, Node, Port, PortType, RunReport, Value};
use voltet_nodes::{registry, session};

/// Takes what a node gives, of any of four types.
pub static TAKER: Node = Node {
    name: "taker",
    summary: "Takes a volume, a picture, a surface or a camera.",
    optional_inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the volume" },
        Port { name: "image", port_type: PortType::Image, summary: "the picture" },
        Port { name: "surface", port_type: PortType::Surface, summary: "the surface" },
        Port { name: "camera", port_type: PortType::Camera, summary: "the camera" },
    ],
    ..Node::BLANK
};

fn a([x, y, z]: [f64; 3]) -> f64 {
    2.0 * x - 3.0 * y + z + 20.0
}

/// A box of n × 5 × 5 cells of side 1 with arrays at points and in cells: `a`; `material`, the number of the cell along x; `gaps`.
fn boxed(n: usize) -> String {
    let points = (n + 1) * 36;
    let mut text = format!(
        "# vtk DataFile Version 3.0\ntext\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS {} 6 6\nORIGIN 0 0 0\n\
         SPACING 1 1 1\nPOINT_DATA {points}\nSCALARS a double 1\nLOOKUP_TABLE default\n",
        n + 1
    );
    for i in 0..points {
        writeln!(text, "{:?}", a([i % (n + 1), i / (n + 1) % 6, i / (n + 1) / 6].map(|k| k as f64))).unwrap();
    }
    writeln!(text, "CELL_DATA {}", 25 * n).unwrap();
    for (name, gap) in [("material", usize::MAX), ("gaps", 3)] {
        write!(text, "SCALARS {name} double 1\nLOOKUP_TABLE default\n").unwrap();
        for i in 0..25 * n {
            writeln!(text, "{}", if i % n == gap { "nan".into() } else { (i % n).to_string() }).unwrap();
        }
    }
    text
}

pub fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.vtk"), boxed(5)).unwrap();
    std::fs::write(folder.path().join("b.vtk"), boxed(3)).unwrap();
    folder
}

pub const BEGIN: &str = "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"a.vtk\"\nscalar = \"a\"\n\
                     [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = { grid = \"grid\" }\n";

/// The values at the inputs of the node `taker`, after nodes that `text` states.
pub fn taken(text: &str, folder: &Path, demand: &Demand) -> Result<(Vec<Value>, RunReport)> {
    let mut registry = registry()?;
    registry.add(&TAKER)?;
    let graph = Pipeline::parse(text)?.graph(&registry, folder.into())?;
    let place = graph.nodes.iter().position(|node| node.name == "taker").unwrap();
    session().feed(&graph, place, demand, &NoObserver)
}

fn made_for(keys: &str, demand: &Demand) -> Result<(Arc<Volume>, RunReport)> {
    let text = format!(
        "{BEGIN}[nodes.made]\ntype = \"threshold\"\ninputs = {{ volume = \"gradient\" }}\n{keys}\n\
         [nodes.taker]\ntype = \"taker\"\ninputs = {{ volume = \"made\" }}\n"
    );
    let (values, report) = taken(&text, folder().path(), demand)?;
    Ok((values[0].volume().unwrap()?, report))
}

fn made(keys: &str) -> Volume {
    let (volume, report) =
        made_for(keys, &Demand::default()).unwrap_or_else(|error| panic!("{keys}: {error}"));
    assert!(report.warnings.is_empty(), "{keys}: {:?}", report.warnings);
    Volume::clone(&volume)
}

fn refused(keys: &str) -> String {
    made_for(keys, &Demand::default()).expect_err(keys).to_string()
}

fn total(volume: &Volume) -> f64 {
    let grid = &volume.grid;
    (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
}

/// The numbers along x of the cells of the file that are left, each once; all cells are whole.
fn columns(volume: &Volume) -> Vec<usize> {
    let grid = &volume.grid;
    let mut cells: Vec<usize> = (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i)).collect();
    cells.sort_unstable();
    cells.dedup();
    // A sum of some 700 volumes.
    assert!((total(volume) - cells.len() as f64).abs() < 1e-11, "{} of {}", total(volume), cells.len());
    let mut columns: Vec<usize> = cells.iter().map(|cell| cell % 5).collect();
    columns.sort_unstable();
    columns.dedup();
    assert_eq!(cells.len(), 25 * columns.len(), "a column in part");
    columns
}

#[test]
fn whole_cells_are_kept_by_their_values() {
    let by_cells = "array = \"material\"\nassociation = \"cell\"\n";
    for (keys, expected) in [
        ("range = [1.0, 2.5]", &[1, 2][..]),
        ("range = [-inf, 1]", &[0, 1]),
        ("range = [2, inf]", &[2, 3, 4]),
        ("range = [2, 2]\ninvert = true", &[0, 1, 3, 4]),
        ("range = [\"50 %\", \"100 %\"]", &[2, 3, 4]),
        // Of 80 % of the volume the number is 3 at most.
        ("range = [\"p70\", \"p80\"]", &[3]),
        ("values = [4.0, 1]", &[1, 4]),
        ("values = [4.0]\ninvert = true", &[0, 1, 2, 3]),
        ("range = [0, 9]", &[0, 1, 2, 3, 4]),
    ] {
        assert_eq!(columns(&made(&format!("{by_cells}{keys}"))), expected, "{keys}");
    }
    for (keys, expected) in
        [("range = [0, 9]", &[0, 1, 2, 4][..]), ("values = [0]\ninvert = true", &[1, 2, 4])]
    {
        let keys = format!("array = \"gaps\"\nassociation = \"cell\"\n{keys}");
        let (volume, report) = made_for(&keys, &Demand::default()).unwrap();
        assert_eq!(columns(&volume), expected, "{keys}");
        assert_eq!(report.warnings, ["made: 25 cells left out, whose 'gaps' is nan"]);
    }
    let (volume, report) = made_for(&format!("{by_cells}values = [1, 7, 8]"), &Demand::default()).unwrap();
    assert_eq!(columns(&volume), [1]);
    let said = "made: 'material' is nowhere 7.0, 8.0; it is 0.0, 1.0, 2.0, 3.0, 4.0";
    assert_eq!(report.warnings, [said]);
    assert_eq!(report.counts["cells_selected"], volume.grid.tetrahedra.len() as u64);
}

#[test]
fn whole_cells_are_kept_by_their_points() {
    let clip = "\n[[nodes.made.clip]]\nkind = \"plane\"\norigin = [2.5, 0, 0]\nnormal = [1, 0, 0]";
    for (keys, expected) in [
        ("", &[3, 4][..]),
        ("keep = \"any\"", &[2, 3, 4]),
        ("invert = true", &[0, 1, 2]),
        ("keep = \"any\"\ninvert = true", &[0, 1]),
    ] {
        assert_eq!(columns(&made(&format!("{keys}{clip}"))), expected, "{keys}");
    }
    // Of a cell at (x, y, z) values go from a(x, y + 1, z) to a(x + 1, y, z + 1).
    for (keep, corner) in [("all", [0, 1, 0]), ("any", [1, 0, 1])] {
        let volume = made(&format!("range = [17.0, inf]\nkeep = \"{keep}\""));
        let counts = |cell: &usize| {
            let at = [cell % 5, cell / 5 % 5, cell / 25];
            a([0, 1, 2].map(|k| (at[k] + corner[k]) as f64)) >= 17.0
        };
        let expected: Vec<usize> = (0..125).filter(counts).collect();
        let mut found: Vec<usize> =
            (0..volume.grid.tetrahedra.len()).map(|i| volume.grid.source_cell(i)).collect();
        found.dedup();
        assert_eq!(found, expected, "{keep}");
    }
}

/// Volume of the part of the box in which a is at most `level`: inclusion and exclusion of its corners.
fn volume_below(level: f64) -> f64 {
    // With y from the other side, a = 5 + 2 x + 3 y + z.
    let corner = |set: u32| {
        let sum: f64 = (0..3).filter(|k| set >> k & 1 == 1).map(|k| [10.0, 15.0, 5.0][k]).sum();
        let sign = if set.count_ones() % 2 == 1 { -1.0 } else { 1.0 };
        sign * (level - 5.0 - sum).max(0.0).powi(3)
    };
    125.0 * (0..8).map(corner).sum::<f64>() / (6.0 * 10.0 * 15.0 * 5.0)
}

#[test]
fn a_smooth_threshold_cuts_where_the_values_are() {
    let between = volume_below(27.0) - volume_below(12.3);
    for (keys, expected) in [
        ("range = [12.3, 27.0]", between),
        ("range = [12.3, 27.0]\ninvert = true", 125.0 - between),
        ("range = [12.3, inf]", 125.0 - volume_below(12.3)),
        ("range = [-inf, 12.3]", volume_below(12.3)),
        ("range = [12.3, inf]\ninvert = true", volume_below(12.3)),
        ("range = [\"50 %\", \"100 %\"]", 62.5),
        ("range = [-inf, \"p20\"]", 25.0),
    ] {
        let volume = made(&format!("smooth = true\n{keys}"));
        // Sums of a thousand volumes; a percentile is found to 1e-12 of the volume of 125.
        assert!((total(&volume) - expected).abs() < 3e-10, "{keys}: {} for {expected}", total(&volume));
        for (at, s) in volume.grid.points.iter().zip(volume.scalar.iter()) {
            assert!((a(at.to_array()) - s).abs() < 1e-13, "{keys}: {s} at {at}");
        }
    }
    let whole = made("smooth = true\nrange = [0, 50]");
    assert_eq!(columns(&whole), [0, 1, 2, 3, 4]);
}

#[test]
fn the_gradient_is_that_of_the_whole() {
    let demand = Demand { gradient_magnitude: true, gradient: true, ..Demand::default() };
    // The field of the cells: at points means over cells, also of those that are not kept.
    let whole = made_for("range = [-inf, inf]", &demand).unwrap().0;
    let (g, all) = (whole.gradient_magnitude.as_ref().unwrap(), whole.gradient.as_ref().unwrap());
    assert!(g.iter().all(|g| (g - 14_f64.sqrt()).abs() < 1e-12));
    for keys in ["range = [17.0, inf]", "range = [17.0, inf]\nsmooth = true"] {
        let part = made_for(keys, &demand).unwrap().0;
        assert!(part.grid.tetrahedra.len() < whole.grid.tetrahedra.len() || keys.contains("smooth"));
        assert!(part.gradient_magnitude.as_ref().unwrap().iter().all(|g| (g - 14_f64.sqrt()).abs() < 1e-12));
        assert!(part.gradient.as_ref().unwrap().iter().all(|v| v.distance(all[0]) < 1e-12));
    }
    // Its own demand.
    let by_g = made_for("array = \"g\"\nrange = [3.0, 4.0]", &Demand::default()).unwrap().0;
    assert_eq!(by_g.grid.tetrahedra.len(), whole.grid.tetrahedra.len());
    let nothing = made("range = [17.0, inf]");
    assert!(nothing.gradient_magnitude.is_none() && nothing.grid.cell_arrays.is_empty());
    let of_cells = made("array = \"material\"\nassociation = \"cell\"\nvalues = [1]");
    assert!(of_cells.grid.point_arrays.is_empty());
}

#[test]
fn what_is_wrong_or_empty_is_said() {
    let cells = "array = \"material\"\nassociation = \"cell\"";
    for (keys, said) in [
        ("", "the threshold has no condition"),
        ("range = [1, 2]\nvalues = [1]", "several conditions"),
        ("range = [2, 1]", "the range is empty"),
        ("range = [1, nan]", "'range' is out of range"),
        ("values = []", "there are no values"),
        ("range = [1, 2]\nsmooth = true\nkeep = \"any\"", "none is kept whole"),
        ("range = [2, 2]\nsmooth = true\ninvert = true", "the range is empty"),
        ("values = [1]\nsmooth = true", "keep whole cells"),
        (&format!("{cells}\nrange = [1, 2]\nsmooth = true"), "no cell is cut"),
        (&format!("{cells}\nrange = [1, 2]\nkeep = \"any\""), "one value"),
        ("association = \"cell\"\nrange = [1, 2]", "not named"),
        ("array = \"material\"\nrange = [1, 2]", "'material' is an array of cells"),
        ("array = \"materail\"\nassociation = \"cell\"\nrange = [1, 2]", "material"),
        ("array = \"b\"\nrange = [1, 2]", "'b'"),
        ("range = [50.0, 60.0]", "no cell is kept"),
        ("range = [50.0, 60.0]\nsmooth = true", "s goes from 5.0 to 35.0"),
        (&format!("{cells}\nvalues = [9]"), "'material' goes from 0.0 to 4.0"),
        (
            &format!(
                "{cells}\nrange = [1, 2]\n[[nodes.made.clip]]\nkind = \"sphere\"\ncentre = [0,0,0]\nradius = 1"
            ),
            "several",
        ),
        (
            "smooth = true\n[[nodes.made.clip]]\nkind = \"sphere\"\ncentre = [0,0,0]\nradius = 1",
            "whole cells",
        ),
        (
            "keep = \"any\"\n[[nodes.made.clip]]\nkind = \"sphere\"\ncentre = [9,9,9]\nradius = 1",
            "no cell is kept",
        ),
        ("[[nodes.made.clip]]\nkind = \"sphere\"\ncentre = [0,0,0]\nradius = -1", "'radius' is out of range"),
    ] {
        let error = refused(keys);
        assert!(error.contains(said), "{keys}: {error}");
    }
}

/// A picture of the node `of` after these nodes; `keys` are the renderer's.
fn picture(nodes: &str, of: &str, keys: &str) -> Picture {
    let text = format!(
        "{nodes}[nodes.look]\ntype = \"transfer-function\"\nunit_distance = 1.0\n\
         [[nodes.look.widgets]]\nkind = \"gaussian\"\ncentre = [18.0, 3.7]\nsigma = [6.0, 1.0]\n\
         color = [1, 0.5, 0.1]\nextinction = 0.4\n\
         [nodes.view]\ntype = \"camera\"\neye = [12, -9, 8]\ntarget = [2.5, 2.5, 2.5]\nsize = [64, 48]\n\
         [nodes.picture]\ntype = \"renderer\"\nengine = \"cpu\"\n\
         inputs = {{ volume = \"{of}\", transfer_function = \"look\", camera = \"view\" }}\n{keys}\n\
         [nodes.taker]\ntype = \"taker\"\ninputs = {{ image = \"picture\" }}\n"
    );
    let (values, _) = taken(&text, folder().path(), &Demand::default()).unwrap();
    let picture = picture_of(&values);
    assert!(picture.rgba.iter().any(|pixel| pixel[3] > 0.1), "nothing is seen");
    picture
}

/// The picture that the node `taker` was given.
pub fn picture_of(values: &[Value]) -> Picture {
    let [Value::Image(picture)] = values else { panic!("{values:?}") };
    Picture::clone(picture)
}

/// Largest difference of a channel.
fn difference(one: &Picture, other: &Picture) -> f32 {
    let channels = one.rgba.as_flattened().iter().zip(other.rgba.as_flattened());
    channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Other tetrahedra along a ray differ by roundings in 32 bits.
const ROUNDING: f32 = 2e-5;

#[test]
fn the_picture_is_that_of_the_cells_alone() {
    let kept = format!(
        "{BEGIN}[nodes.part]\ntype = \"threshold\"\narray = \"material\"\nassociation = \"cell\"\n\
         range = [0, 2]\ninputs = {{ volume = \"gradient\" }}\n"
    );
    let by_hand = BEGIN.replace("a.vtk", "b.vtk");
    let found = picture(&kept, "part", "");
    let apart = difference(&found, &picture(&by_hand, "gradient", ""));
    assert!(apart < ROUNDING, "{apart}");
    assert!(difference(&found, &picture(BEGIN, "gradient", "")) > 0.1);
}

#[test]
fn a_smooth_cut_of_a_linear_field_is_a_clip_at_a_plane() {
    let part = |keys: &str| {
        let nodes = format!(
            "{BEGIN}[nodes.part]\ntype = \"threshold\"\nsmooth = true\n{keys}\ninputs = {{ volume = \"gradient\" }}\n"
        );
        picture(&nodes, "part", "")
    };
    let plane = |invert: bool| {
        format!(
            "[[nodes.picture.clip]]\nkind = \"plane\"\norigin = [0, 0, 1.5]\nnormal = [2, -3, 1]\ninvert = {invert}"
        )
    };
    for (keys, invert) in [("range = [21.5, inf]", false), ("range = [-inf, 21.5]", true)] {
        let apart = difference(&part(keys), &picture(BEGIN, "gradient", &plane(invert)));
        assert!(apart < ROUNDING, "{keys}: {apart}");
    }
}

/// Keeps blocks of a tree of three rows of cubes: names and cubes.
fn kept_blocks(keys: &str) -> Result<Volume> {
    let folder = folder();
    let leaf = |name: &str, cubes: usize| {
        let encoding = voltet_testing::files::xml::encodings()[0];
        let bytes = voltet_testing::files::samples::unstructured(encoding, cubes, false);
        std::fs::write(folder.path().join(format!("{name}.vtu")), bytes).unwrap();
        format!("<DataSet index=\"0\" name=\"{name}\" file=\"{name}.vtu\"/>")
    };
    let tree = format!(
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"fluid\">{}{}</Block>{}\
         </vtkMultiBlockDataSet></VTKFile>",
        leaf("rotor", 1),
        leaf("stator", 2),
        leaf("solid", 4)
    );
    std::fs::write(folder.path().join("a.vtm"), tree).unwrap();
    let text = BEGIN.replace("a.vtk", "a.vtm").replace("\"a\"", "\"Float64\"");
    let text = format!(
        "{text}[nodes.made]\ntype = \"threshold\"\ninputs = {{ volume = \"gradient\" }}\n{keys}\n\
         [nodes.taker]\ntype = \"taker\"\ninputs = {{ volume = \"made\" }}\n"
    );
    let (values, _) = taken(&text, folder.path(), &Demand::default())?;
    Ok(Volume::clone(&*values[0].volume().unwrap()?))
}

#[test]
fn blocks_are_kept_by_their_names() {
    // Six tetrahedra a cube.
    let cubes = |keys: &str| kept_blocks(keys).unwrap().grid.tetrahedra.len() / 6;
    assert_eq!(cubes("blocks = [\"solid\"]"), 4);
    assert_eq!(cubes("blocks = [\"fluid\"]"), 3);
    assert_eq!(cubes("blocks = [\"*tor\", \"solid\"]"), 7);
    assert_eq!(cubes("blocks = [\"fluid/rotor\"]\ninvert = true"), 6);
    assert_eq!(cubes("array = \"block\"\nassociation = \"cell\"\nvalues = [1, 2]"), 6);
    for (keys, said) in [
        ("blocks = []", "there are no blocks"),
        ("blocks = [\"fluid/roter\"]", "'fluid/rotor', the nearest"),
        ("blocks = [\"solid\"]\nrange = [0, 1]", "several conditions"),
        ("blocks = [\"solid\"]\nkeep = \"any\"", "names of blocks"),
        ("blocks = [\"*\"]\ninvert = true", "no cell is kept"),
    ] {
        let error = kept_blocks(keys).expect_err(keys).to_string();
        assert!(error.contains(said), "{keys}: {error}");
    }
    let without = refused("blocks = [\"a\"]");
    assert!(without.contains("no blocks"), "{without}");
}
