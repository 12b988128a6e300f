//! Grids larger than the memory that they may take: parts of them, drawn one after the other, give the picture of the whole.

use super::support::Folder;
use std::fmt::Write;

/// Cells along a side.
const SIDE: usize = 8;

/// Most pixels differ by rounding: a pixel of some dozen segments.
const SAME: f32 = 1e-6;

/// A cube of hexahedra with moved points as a .pvtu in pieces; `piece` is that of a cell, by its place.
fn write_pieces(folder: &Folder, name: &str, count: usize, piece: impl Fn([usize; 3]) -> usize) {
    let mut cells: Vec<Vec<[usize; 3]>> = vec![Vec::new(); count];
    for number in 0..SIDE.pow(3) {
        let place = [number % SIDE, number / SIDE % SIDE, number / SIDE / SIDE];
        cells[piece(place)].push(place);
    }
    let mut sources = String::new();
    for (number, own) in cells.iter().enumerate() {
        folder.write(&format!("{name}_{number}.vtu"), piece_text(own));
        write!(sources, "<Piece Source=\"{name}_{number}.vtu\"/>").unwrap();
    }
    let text = format!(
        "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid>{sources}</PUnstructuredGrid></VTKFile>"
    );
    folder.write(&format!("{name}.pvtu"), text);
}

/// A piece of these cells, with the scalar `t` at the points and `c` in the cells.
fn piece_text(cells: &[[usize; 3]]) -> String {
    const CORNERS: [[usize; 3]; 8] =
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
    let n = SIDE + 1;
    let number = |[i, j, k]: [usize; 3]| i + n * (j + n * k);
    let corners =
        |cell: &[usize; 3]| CORNERS.map(|c| number([0, 1, 2].map(|axis: usize| cell[axis] + c[axis])));
    let mut used: Vec<usize> = cells.iter().flat_map(corners).collect();
    used.sort_unstable();
    used.dedup();
    let [mut points, mut t, mut c, mut connectivity, mut offsets, mut types] =
        [(); 6].map(|()| String::new());
    for &point in &used {
        let place = [point % n, point / n % n, point / n / n].map(|x| x as f64);
        // Faces are not flat.
        let wave = |axis: usize| 0.2 * (3.0 * place[(axis + 1) % 3] + 5.0 * place[(axis + 2) % 3]).sin();
        let [x, y, z] = [0, 1, 2].map(|axis| (place[axis] + wave(axis)) / SIDE as f64);
        write!(points, "{x} {y} {z} ").unwrap();
        write!(t, "{} ", (5.0 * x).sin() + y * y + (4.0 * z).cos()).unwrap();
    }
    for (k, cell) in cells.iter().enumerate() {
        let [i, j, l] = cell.map(|x| x as f64);
        write!(c, "{} ", (i * 0.7).sin() + (j * 0.4).cos() + 0.1 * l).unwrap();
        for corner in corners(cell) {
            write!(connectivity, "{} ", used.binary_search(&corner).unwrap()).unwrap();
        }
        write!(offsets, "{} ", 8 * (k + 1)).unwrap();
        types += "12 ";
    }
    let array = |kind: &str, name: &str, components: usize, values: &str| {
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">{values}</DataArray>"
        )
    };
    format!(
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"><UnstructuredGrid>\
         <Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"><PointData>{}</PointData><CellData>{}</CellData><Points>{}</Points>\
         <Cells>{}{}{}</Cells></Piece></UnstructuredGrid></VTKFile>",
        used.len(),
        cells.len(),
        array("Float64", "t", 1, &t),
        array("Float64", "c", 1, &c),
        array("Float64", "Points", 3, &points),
        array("Int64", "connectivity", 1, &connectivity),
        array("Int64", "offsets", 1, &offsets),
        array("UInt8", "types", 1, &types),
    )
}

/// A pipeline whose numbers depend on the whole grid: its range, a percentile, its bounds, its diagonal; with light, two colours and g.
const PIPELINE: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "slabs.pvtu"
scalar = "t"

[nodes.gradient]
type = "gradient-magnitude"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
inputs = { volume = "gradient" }

[[nodes.look.widgets]]
kind = "gaussian"
centre = ["p70", "p50"]
sigma = ["10%", "30%"]
extinction = 9.0
color = [1.0, 0.4, 0.1]

[[nodes.look.widgets]]
kind = "gaussian"
centre = ["20%", "40%"]
sigma = ["15%", "30%"]
extinction = 3.0
color = [0.1, 0.4, 1.0]

[nodes.view]
type = "camera"
view = "isometric"
inputs = { volume = "grid" }
size = [96, 80]

[nodes.picture]
type = "renderer"
engine = "cpu"
light = { direction = [1.0, 2.0, 3.0] }
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.out]
type = "image-writer"
path = "picture.exr"
inputs = { image = "picture" }
"#;

fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.toml", PIPELINE);
    write_pieces(&folder, "slabs", 6, |[i, _, _]| (i * 6 / SIDE).min(5));
    write_pieces(&folder, "blocks", 9, |[i, j, k]| (i * 2 / SIDE) + 2 * (j * 2 / SIDE) + 4 * (k * 2 / SIDE));
    write_pieces(&folder, "random", 5, |[i, j, k]| (7 * i + 13 * j * j + 29 * k * i + k) % 5);
    folder
}

/// Draws the whole grid and its parts, of this much memory; gives the largest difference, and the number of parts read.
fn compare(folder: &Folder, memory: &str, settings: &[&str]) -> f32 {
    let draw = |output: &str, further: &[&str]| {
        let set = settings.iter().flat_map(|setting| ["--set", setting]);
        let command: Vec<&str> = ["run", "scene.toml", "--quiet", "--output", output]
            .into_iter()
            .chain(set)
            .chain(further.iter().copied())
            .collect();
        folder.voltet(&command).ok();
        folder.floats(output).1
    };
    let whole = draw("whole.exr", &[]);
    let parts = draw("parts.exr", &["--memory", memory, "--report", "parts.json"]);
    assert!(whole.iter().any(|pixel| pixel[3] > 0.1), "the scene shows nothing, so it proves nothing");
    assert!(folder.report("parts.json")["counts"]["ray_stretches"].as_u64().unwrap() > 0);
    let values = whole.iter().flatten().zip(parts.iter().flatten());
    values.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

#[test]
fn parts_make_the_picture_of_the_whole_grid() {
    let folder = folder();
    for grid in ["slabs", "blocks", "random"] {
        let path = format!("grid.path={grid}.pvtu");
        for settings in [&[path.as_str()][..], &[&path, "grid.scalar=c"]] {
            let difference = compare(&folder, "1B", settings);
            assert!(difference <= SAME, "{settings:?}: {difference:e}");
        }
    }
}
