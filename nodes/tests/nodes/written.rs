//! Files of `grid-writer` read back by this program's own reader, by vtkio and by VTK: every bit.

use super::graph;
use std::path::Path;
use std::process::Command;
use std::sync::Arc;
use voltet_core::grid::{Grid, code};
use voltet_core::progress::NoProgress;
use voltet_core::volume::Volume;
use voltet_graph::{Demand, Graph, NoObserver, RunReport, Value};
use voltet_io::formats::{Request, read};
use voltet_nodes::session;
use voltet_testing::files::samples;

/// A file of VTK's own writer: a cell of every type that is a volume, a triangle, a vertex, a point that no cell uses.
const EVERY_TYPE: &[u8] = include_bytes!("../../../lab/testing/files/every_type.vtu");

/// Reader, gradient and writer; `reader` and `writer` hold further keys.
fn pipeline(folder: &Path, reader: &str, writer: &str) -> Graph {
    pipeline_to("out.vtu", folder, reader, writer)
}

fn pipeline_to(path: &str, folder: &Path, reader: &str, writer: &str) -> Graph {
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"in.vtu\"\n{reader}\n\
         [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n\
         [nodes.file]\ntype = \"grid-writer\"\npath = \"{path}\"\ninputs = {{ volume = \"gradient\" }}\n{writer}\n"
    );
    graph(&text, folder).unwrap()
}

fn run(graph: &Graph) -> RunReport {
    session().run(graph, &NoObserver).unwrap_or_else(|error| panic!("{error}"))
}

/// Volume at the writer's input.
fn volume(graph: &Graph) -> Arc<Volume> {
    let place = graph.nodes.iter().position(|node| node.node.name == "grid-writer").unwrap();
    let (inputs, _) = session().feed(graph, place, &Demand::default(), &NoObserver).unwrap();
    inputs.iter().find_map(Value::volume).unwrap().unwrap()
}

fn read_back(folder: &Path, scalar: &str, point_arrays: &[&str], cell_arrays: &[&str]) -> Grid {
    read_file(&folder.join("out.vtu"), scalar, point_arrays, cell_arrays)
}

fn read_file(path: &Path, scalar: &str, point_arrays: &[&str], cell_arrays: &[&str]) -> Grid {
    let names = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
    let request = Request {
        scalar: Some(scalar.into()),
        point_arrays: names(point_arrays),
        cell_arrays: names(cell_arrays),
        ..Request::default()
    };
    read(path, &request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

fn folder_with(bytes: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("in.vtu"), bytes).unwrap();
    folder
}

/// The volume and what was read back are the same, but for what the file does not hold.
fn assert_same(volume: &Volume, again: &Grid) {
    assert_eq!(volume.grid.points, again.points);
    assert_eq!(volume.grid.tetrahedra, again.tetrahedra);
    assert_eq!(volume.grid.source_cells, again.source_cells);
    assert_eq!(bits(&volume.scalar), bits(again.scalar.as_ref().unwrap()));
    // Within curved cells the grid has points that the file has not; their gradient is read as the mean of others'.
    let file = volume.grid.file_cells.as_ref().unwrap();
    let own = |values: &[f64], n: usize| -> Vec<u64> {
        let points = (0..file.points.len()).filter_map(|p| file.grid_point(p));
        points.flat_map(|p| bits(&values[n * p..n * (p + 1)])).collect()
    };
    let g = volume.gradient_magnitude.as_ref().unwrap();
    assert!(own(g, 1) == own(&again.point_arrays["s_gradient_magnitude"].values, 1));
    let gradient: Vec<f64> = volume.gradient.as_ref().unwrap().iter().flat_map(|v| v.to_array()).collect();
    assert!(own(&gradient, 3) == own(&again.point_arrays["s_gradient"].values, 3));
}

const KEYS: &str = "point_arrays = [\"T\", \"v\"]\ncell_arrays = [\"material\"]";

#[test]
fn every_type_of_cell_comes_back_with_its_values() {
    for (path, more) in [
        ("out.vtu", ""),
        ("out.vtu", "compression = \"zlib\""),
        ("out.vtu", "precision = \"double\""),
        ("out.vtkhdf", ""),
        ("out.vtkhdf", "precision = \"double\""),
    ] {
        let folder = folder_with(EVERY_TYPE);
        let graph = pipeline_to(path, folder.path(), "scalar = \"s\"", &format!("{KEYS}\n{more}"));
        let report = run(&graph);
        assert_eq!(report.counts["arrays_written"], 6);
        let said = report.warnings.join("\n");
        assert!(
            said.contains("points belong to no cell with a volume; their values are written as nan"),
            "{said}"
        );
        let arrays = ["s_gradient_magnitude", "s_gradient", "T", "v"];
        let again = read_file(&folder.path().join(path), "s", &arrays, &["material"]);
        let volume = volume(&graph);
        assert_same(&volume, &again);
        assert_eq!(again.origin.cells_by_type, volume.grid.origin.cells_by_type);
        for name in ["T", "v"] {
            assert_eq!(bits(&volume.grid.point_arrays[name].values), bits(&again.point_arrays[name].values));
        }
        let material = &again.cell_arrays["material"].values;
        assert_eq!(*material, (0..material.len()).map(|i| 7.0 * i as f64 - 3.0).collect::<Vec<_>>());
    }
}

#[test]
fn tetrahedra_are_written_with_the_cells_that_they_were() {
    let folder = folder_with(EVERY_TYPE);
    let graph =
        pipeline(folder.path(), "scalar = \"s\"", "cells = \"tetrahedra\"\ncell_arrays = [\"material\"]");
    run(&graph);
    let again =
        read_back(folder.path(), "s", &["s_gradient_magnitude", "s_gradient"], &["file_cell", "material"]);
    let volume = volume(&graph);
    assert_eq!(volume.grid.points, again.points);
    assert_eq!(volume.grid.tetrahedra, again.tetrahedra);
    let cells = volume.grid.source_cells.as_ref().unwrap();
    assert_eq!(**cells, again.cell_arrays["file_cell"].values.iter().map(|&x| x as u32).collect::<Vec<_>>());
    let material = again.cell_arrays["material"].values.iter();
    assert!(material.zip(cells.iter()).all(|(&material, &cell)| material == 7.0 * f64::from(cell) - 3.0));
}

#[test]
fn vtkio_reads_what_was_written() {
    let encoding = voltet_testing::files::xml::encodings().into_iter().next().unwrap();
    let folder = folder_with(&samples::unstructured(encoding, 3, true));
    let graph = pipeline(folder.path(), "scalar = \"Float32\"", "arrays = [\"scalar\"]");
    run(&graph);
    let volume = volume(&graph);
    let file = vtkio::Vtk::import(folder.path().join("out.vtu")).unwrap();
    let vtkio::model::DataSet::UnstructuredGrid { pieces, .. } = file.data else {
        panic!("another data set")
    };
    let piece = pieces.into_iter().next().unwrap().into_loaded_piece_data(None).unwrap();
    let counts = &volume.grid.origin.cells_by_type;
    for (&code, &count) in counts {
        let found = piece.cells.types.iter().filter(|&&t| t as u8 == code).count();
        assert_eq!(found as u64, count, "type {code}");
    }
    assert!(counts.len() == 2 && counts.contains_key(&code::TETRA));
    assert_eq!(piece.data.point[0].name(), volume.grid.scalar_name);
}

#[test]
fn only_what_is_asked_for_is_computed_and_read() {
    let folder = folder_with(EVERY_TYPE);
    for (keys, gradients, decoded, written) in [
        ("arrays = [\"scalar\"]", 0, 1, 1),
        ("arrays = []\npoint_arrays = [\"T\"]", 0, 2, 1),
        ("arrays = [\"gradient\"]", 1, 1, 1),
        ("", 1, 1, 3),
    ] {
        let report = run(&pipeline(folder.path(), "scalar = \"s\"", keys));
        let counts =
            ["gradients_computed", "arrays_decoded", "arrays_written"].map(|name| report.counts[name]);
        assert_eq!(counts, [gradients, decoded, written], "{keys}");
    }
}

#[test]
fn an_array_of_whole_blocks_is_compressed_and_reads_back() {
    // 16³ points: their positions fill three blocks.
    let text = "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"wavelet\"\nresolution = [15, 15, 15]\n\
                [nodes.file]\ntype = \"grid-writer\"\npath = \"out.vtu\"\ncompression = \"zlib\"\n\
                precision = \"double\"\ninputs = { volume = \"grid\" }\n";
    let folder = tempfile::tempdir().unwrap();
    let graph = graph(text, folder.path()).unwrap();
    run(&graph);
    let length = std::fs::metadata(folder.path().join("out.vtu")).unwrap().len();
    let (volume, again) = (volume(&graph), read_back(folder.path(), "wavelet", &[], &["file_cell"]));
    assert_eq!((&volume.grid.points, &volume.grid.tetrahedra), (&again.points, &again.tetrahedra));
    assert_eq!(bits(&volume.scalar), bits(again.scalar.as_ref().unwrap()));
    let plain = 24 * again.points.len() + 8 * again.points.len() + 17 * again.tetrahedra.len();
    assert!(length < plain as u64, "{length} of {plain} bytes");
}

const SCENE: &str = r#"
[nodes.look]
type = "transfer-function"
unit_distance = 1.0
[[nodes.look.widgets]]
kind = "sine-wave"
color = [1.0, 1.0, 1.0]
extinction = 1.0
period = 0.7
region = { s = [20.0, 50.0] }
[nodes.view]
type = "camera"
eye = [22.0, -60.0, 0.0]
target = [22.0, 0.0, 0.0]
size = [32, 8]
[nodes.left]
type = "cull"
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }
[nodes.finer]
type = "bands"
inputs = { volume = "gradient", transfer_function = "look" }
"#;

#[test]
fn culled_cells_and_bands_are_those_of_their_tetrahedra() {
    let folder = folder_with(EVERY_TYPE);
    let text = |cells: &str| {
        format!(
            "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"in.vtu\"\nscalar = \"s\"\n\
             [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n{SCENE}\
             [nodes.file]\ntype = \"grid-writer\"\npath = \"out.vtu\"\ncells = \"{cells}\"\n\
             inputs = {{ volume = \"gradient\", cells = \"left\", cell_values = \"finer\" }}\n"
        )
    };
    let report = run(&graph(&text("tetrahedra"), folder.path()).unwrap());
    let fine = read_back(folder.path(), "s", &[], &["culled", "bands_0", "file_cell"]);
    let [culled, bands, cell] = ["culled", "bands_0", "file_cell"].map(|name| &fine.cell_arrays[name].values);
    assert_eq!(culled.iter().sum::<f64>(), report.counts["cells_culled"] as f64);
    let widest = report.findings.iter().find_map(|f| f.figures["bands"]["most"].as_f64()).unwrap();
    assert_eq!(bands.iter().copied().fold(0.0, f64::max), widest);
    run(&graph(&text("file"), folder.path()).unwrap());
    let own = read_back(folder.path(), "s", &[], &["culled", "bands_0"]);
    let mut kept = 0;
    for number in 0..own.cell_arrays["culled"].values.len() {
        let parts = || (0..cell.len()).filter(move |&i| cell[i] == number as f64);
        let all = parts().all(|i| culled[i] == 1.0);
        kept += usize::from(!all);
        assert_eq!(own.cell_arrays["culled"].values[number], f64::from(u8::from(all)), "cell {number}");
        let most = parts().map(|i| bands[i]).fold(0.0, f64::max);
        assert_eq!(own.cell_arrays["bands_0"].values[number], most, "cell {number}");
    }
    assert!((2..20).contains(&kept), "{kept}");
}

#[test]
fn what_cannot_be_written_is_refused_with_its_place() {
    let refused = |text: &str, wanted: &str| {
        let folder = folder_with(EVERY_TYPE);
        let error =
            graph(text, folder.path()).and_then(|graph| session().run(&graph, &NoObserver)).unwrap_err();
        assert!(error.to_string().contains(wanted), "{error}");
        assert!(error.location.span.is_some() || error.location.line_column.is_some(), "{error}");
        assert!(!folder.path().join("out.vtu").exists());
    };
    let text = |reader: &str, volume: &str, keys: &str| {
        format!(
            "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"in.vtu\"\n{reader}\n\
             [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"grid\" }}\n\
             [nodes.file]\ntype = \"grid-writer\"\n{keys}\ninputs = {{ volume = \"{volume}\" }}\n"
        )
    };
    let (s, out) = ("scalar = \"s\"", "path = \"out.vtu\"");
    refused(&text(s, "grid", "path = \"out.vtk\""), "ends in .vtu or .vtkhdf");
    let packed = "path = \"out.vtkhdf\"\ncompression = \"zlib\"";
    refused(&text(s, "grid", packed), "arrays are not compressed in this format");
    refused(&text(s, "gradient", &format!("{out}\narrays = [\"gradent\"]")), "expected 'gradient'");
    refused(&text(s, "gradient", &format!("{out}\narrays = [\"culled\"]")), "the input 'cells' is not wired");
    refused(&text(s, "grid", &format!("{out}\narrays = [\"gradient\"]")), "gives a grid without gradient");
    let constant = "scalar = \"material\"\ncell_values = \"constant\"";
    refused(
        &text(constant, "grid", &format!("{out}\ncells = \"file\"")),
        "does not keep the cells of a file",
    );
}

/// Prints what VTK reads: types, connectivity, faces, and each array's type and bits.
const BY_VTK: &str = r#"
import json, sys, vtk
from vtk.util.numpy_support import vtk_to_numpy
def grid(path):
    reader = vtk.vtkHDFReader() if path.endswith("hdf") else vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(path); reader.Update()
    assert reader.GetErrorCode() == 0
    return reader.GetOutput()
def array(a):
    values = vtk_to_numpy(a)
    return [a.GetDataTypeAsString(), a.GetNumberOfComponents(), values.tobytes().hex()]
def arrays(data):
    return {data.GetArrayName(i): array(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}
def cells(g):
    found = []
    for i in range(g.GetNumberOfCells()):
        cell = g.GetCell(i)
        points = [cell.GetPointId(k) for k in range(cell.GetNumberOfPoints())]
        faces = []
        if cell.GetCellType() == 42:
            for f in range(cell.GetNumberOfFaces()):
                face = cell.GetFace(f)
                faces.append([face.GetPointId(k) for k in range(face.GetNumberOfPoints())])
        found.append([cell.GetCellType(), points, faces])
    return found
read = []
for path in sys.argv[1:]:
    g = grid(path)
    read.append({"points": array(g.GetPoints().GetData()), "cells": cells(g),
                 "point": arrays(g.GetPointData()), "cell": arrays(g.GetCellData()),
                 "scalars": g.GetPointData().GetScalars().GetName() if g.GetPointData().GetScalars() else ""})
print(json.dumps(read))
"#;

/// The Python that has VTK: that of the environment variable `VOLTET_TEST_PYTHON`, else `python3`.
fn python() -> Option<String> {
    let python = std::env::var("VOLTET_TEST_PYTHON").unwrap_or_else(|_| "python3".into());
    let has = Command::new(&python).args(["-c", "import vtk, numpy"]).output();
    has.is_ok_and(|output| output.status.success()).then_some(python)
}

#[test]
fn vtk_reads_what_was_written() {
    let Some(python) = python() else {
        eprintln!("SKIPPED: no Python with VTK; VOLTET_TEST_PYTHON names one");
        return;
    };
    for (out, compression) in [("out.vtu", "none"), ("out.vtu", "zlib"), ("out.vtkhdf", "none")] {
        let folder = folder_with(EVERY_TYPE);
        let keys = format!("{KEYS}\ncompression = \"{compression}\"");
        let graph = pipeline_to(out, folder.path(), "scalar = \"s\"", &keys);
        run(&graph);
        let volume = volume(&graph);
        let paths = ["in.vtu", out].map(|name| folder.path().join(name));
        let output = Command::new(&python).arg("-c").arg(BY_VTK).args(&paths).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let read: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let (before, after) = (&read[0], &read[1]);
        assert_eq!(before["cells"], after["cells"]);
        assert_eq!(after["scalars"], "s");
        assert_eq!(after["cells"].as_array().unwrap().len(), 23);
        // The material's numbers are whole, and its type is not kept.
        assert_eq!(after["cell"]["material"][0], "float");
        let file = volume.grid.file_cells.as_ref().unwrap();
        let gradient: Vec<f64> =
            volume.gradient.as_ref().unwrap().iter().flat_map(|v| v.to_array()).collect();
        let expected = |values: &[f64], n: usize, single: bool| -> String {
            let own = (0..file.points.len()).flat_map(|p| match file.grid_point(p) {
                Some(at) => values[at * n..(at + 1) * n].to_vec(),
                None => vec![f64::NAN; n],
            });
            let hex = |bytes: &[u8]| bytes.iter().map(|b| format!("{b:02x}")).collect::<String>();
            own.map(|x| if single { hex(&(x as f32).to_le_bytes()) } else { hex(&x.to_le_bytes()) }).collect()
        };
        let of = |name: &str| &volume.grid.point_arrays[name].values[..];
        for (name, number_type, n, values) in [
            ("s", "float", 1, &volume.scalar[..]),
            ("T", "double", 1, of("T")),
            ("v", "double", 3, of("v")),
            ("s_gradient_magnitude", "double", 1, &volume.gradient_magnitude.as_ref().unwrap()[..]),
            ("s_gradient", "double", 3, &gradient),
        ] {
            let found = &after["point"][name];
            assert_eq!((&found[0], &found[1]), (&number_type.into(), &n.into()), "{name}");
            assert!(found[2] == expected(values, n, number_type == "float"), "{name}: other bits");
        }
        // The file's positions are whole numbers and thirds: 64 bits, as they were.
        assert_eq!(before["points"], after["points"]);
    }
}

/// Values of the calculator's result at the points of a tetrahedron whose array has this name.
fn calculated(array: &str, expression: &str) -> Vec<f64> {
    let folder = folder_with(
        format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"4\" NumberOfCells=\"1\"><PointData>\
             <DataArray type=\"Float64\" Name=\"{array}\" format=\"ascii\">5 6 7 8</DataArray></PointData><Points><DataArray \
             type=\"Float64\" NumberOfComponents=\"3\" format=\"ascii\">0 0 0 1 0 0 0 2 0 0 0 3</DataArray></Points><Cells>\
             <DataArray type=\"Int32\" Name=\"connectivity\" format=\"ascii\">0 1 2 3</DataArray><DataArray type=\"Int32\" \
             Name=\"offsets\" format=\"ascii\">4</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10\
             </DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        )
        .as_bytes(),
    );
    let text = format!(
        "[pipeline]\nformat = 1\n[nodes.grid]\ntype = \"reader\"\npath = \"in.vtu\"\n\
         [nodes.sum]\ntype = \"calculator\"\nexpression = \"{expression}\"\ninputs = {{ grid = \"grid\" }}\n\
         [nodes.gradient]\ntype = \"gradient-magnitude\"\ninputs = {{ grid = \"sum\" }}\n\
         [nodes.file]\ntype = \"grid-writer\"\npath = \"out.vtu\"\narrays = [\"scalar\"]\ninputs = {{ volume = \"gradient\" }}\n"
    );
    run(&graph(&text, folder.path()).unwrap());
    let grid = read_back(folder.path(), "result", &[], &[]);
    grid.scalar.as_ref().unwrap().to_vec()
}

#[test]
fn names_of_axes_are_coordinates_where_no_array_has_them() {
    let values = calculated("q", "x + 10*y + 100*z + q");
    assert_eq!(values, [5.0, 7.0, 27.0, 308.0]);
    assert_eq!(calculated("q", "z"), [0.0, 0.0, 0.0, 3.0]);
    assert_eq!(calculated("x", "x + y"), [5.0, 6.0, 9.0, 8.0]);
}
