//! Pictures as `voltet run` draws them, through files.

use std::fmt::Write;
use std::path::Path;
use voltet_graph::NoObserver;
use voltet_graph::pipeline::Pipeline;

/// The bytes of the picture that a pipeline draws: 32-bit floats, native order.
pub fn picture(text: &str, folder: &Path) -> Vec<u8> {
    let pipeline = Pipeline::parse(text).unwrap();
    let graph = pipeline.graph(&voltet_nodes::registry().unwrap(), folder.into()).unwrap();
    let report = voltet_nodes::session().run(&graph, &NoObserver).unwrap();
    report.pictures[0].1.rgba.as_flattened().iter().flat_map(|channel| channel.to_ne_bytes()).collect()
}

/// The box of `examples/renderer_c/picture.c` as a file of VTK's, every digit of it.
pub fn write_box(path: &Path) {
    const SIDE: usize = 12;
    let n = SIDE + 1;
    let at = |i: usize| 2.0 * i as f64 / SIDE as f64 - 1.0;
    let mut points = String::new();
    let mut heat = String::new();
    for (k, j, i) in (0..n).flat_map(|k| (0..n).flat_map(move |j| (0..n).map(move |i| (k, j, i)))) {
        let [x, y, z] = [i, j, k].map(at);
        writeln!(points, "{x:?} {y:?} {z:?}").unwrap();
        writeln!(heat, "{:?}", 1.0 - (x * x + y * y + z * z).sqrt()).unwrap();
    }
    let mut cells = String::new();
    for (k, j, i) in (0..SIDE).flat_map(|k| (0..SIDE).flat_map(move |j| (0..SIDE).map(move |i| (k, j, i)))) {
        cells += "8";
        for [di, dj, dk] in
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]
        {
            write!(cells, " {}", i + di + n * (j + dj + n * (k + dk))).unwrap();
        }
        cells += "\n";
    }
    let (points_count, count) = (n * n * n, SIDE * SIDE * SIDE);
    let types = "12\n".repeat(count);
    let text = format!(
        "# vtk DataFile Version 3.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS {points_count} double\n{points}CELLS {count} {}\n{cells}CELL_TYPES {count}\n{types}POINT_DATA {points_count}\nSCALARS heat double 1\nLOOKUP_TABLE default\n{heat}",
        9 * count
    );
    std::fs::write(path, text).unwrap();
}

/// The pipeline that draws it as the example does.
pub const BOX: &str = r#"
[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "box.vtk"

[nodes.gradient]
type = "gradient-magnitude"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
unit_distance = 1.0

[[nodes.look.widgets]]
kind = "gaussian"
color = [1.0, 0.4, 0.05]
extinction = 40.0
centre = [0.6, 1.0]
sigma = [0.05, 0.2]

[[nodes.look.widgets]]
kind = "gaussian"
color = [0.1, 0.3, 1.0]
extinction = 6.0
centre = [0.2, 1.0]
sigma = [0.05, 0.5]

[nodes.view]
type = "camera"
eye = [2.0, -4.0, 1.5]
target = [0.0, 0.0, 0.0]
size = [160, 120]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.file]
type = "image-writer"
path = "box.exr"
inputs = { image = "picture" }
"#;
