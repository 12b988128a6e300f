//! Adaptive grids: patches of several levels (.vthb, VTKHDF) and hyper trees (.htg, VTKHDF), against formulas and what VTK says of them.

use super::packed::{grid, grid_at, path, request};
use glam::DVec3;
use std::path::{Path, PathBuf};
use voltet_core::grid::{CellValues, Grid, HangingPoint, Options, cells_of_points, tetrahedron_volume};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, BLOCK, Request, files_read_beside, inspect, read};
use voltet_testing::files::samples::file;

type Field = fn(DVec3) -> f64;

/// The field of `files/make_adaptive.py`.
fn linear(p: DVec3) -> f64 {
    1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.z
}

fn quadratic(p: DVec3) -> f64 {
    p.x * p.x + 0.5 * p.y * p.y - p.z * p.z + p.x * p.y
}

/// Greatest second derivative of [`quadratic`] in any direction: the Hessian's eigenvalues are 1.5 ± √1.25 and -2.
const CURVATURE: f64 = 2.62;

const ORIGIN: DVec3 = DVec3::new(0.5, -1.0, 0.0);

/// Cells of a patch: the first and the end along each axis, in cells of its level.
type Extent = [[usize; 3]; 2];

/// Text of an image with the cell array c and the point array p.
fn image([low, end]: Extent, h: f64, field: Field) -> String {
    let values = |shift: f64, more: usize| -> String {
        let mut text = String::new();
        for k in low[2]..end[2] + more {
            for j in low[1]..end[1] + more {
                for i in low[0]..end[0] + more {
                    let at = ORIGIN + h * (DVec3::new(i as f64, j as f64, k as f64) + shift);
                    text += &format!("{} ", field(at));
                }
            }
        }
        text
    };
    let n = [0, 1, 2].map(|axis| end[axis] - low[axis]);
    let origin = ORIGIN + h * DVec3::from_array(low.map(|n| n as f64));
    let extent = format!("0 {} 0 {} 0 {}", n[0], n[1], n[2]);
    let array = |name: &str, values: String| {
        format!("<DataArray type=\"Float64\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>")
    };
    format!(
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"{extent}\" Origin=\"{} {} {}\" Spacing=\"{h} {h} {h}\">\
         <Piece Extent=\"{extent}\"><PointData>{}</PointData><CellData>{}</CellData></Piece></ImageData></VTKFile>",
        origin.x,
        origin.y,
        origin.z,
        array("p", values(0.0, 1)),
        array("c", values(0.5, 0)),
    )
}

/// Patches of levels, each finer by `ratio`; the coarsest cells have the size 1/4.
fn patches(folder: &tempfile::TempDir, ratio: usize, levels: &[Vec<Extent>], field: Field) -> PathBuf {
    let mut text =
        "<VTKFile type=\"vtkOverlappingAMR\" version=\"1.1\"><vtkOverlappingAMR origin=\"0.5 -1 0\" \
        grid_description=\"XYZ\">"
            .to_owned();
    for (level, extents) in levels.iter().enumerate() {
        let h = 0.25 / ratio.pow(level as u32) as f64;
        text += &format!("<Block level=\"{level}\" spacing=\"{h} {h} {h}\">");
        for (number, &extent) in extents.iter().enumerate() {
            let name = format!("{level}_{number}.vti");
            file(folder, &name, image(extent, h, field).as_bytes());
            let ([i, j, k], end) = (extent[0], extent[1].map(|end| end - 1));
            text += &format!(
                "<DataSet index=\"{number}\" amr_box=\"{i} {} {j} {} {k} {}\" file=\"{name}\"/>",
                end[0], end[1], end[2]
            );
        }
        text += "</Block>";
    }
    text += "</vtkOverlappingAMR></VTKFile>";
    file(folder, "a.vthb", text.as_bytes())
}

/// Two patches, two over both of them, and one over both of these.
fn levels(ratio: usize) -> Vec<Vec<Extent>> {
    let scaled = |extent: Extent, factor: usize| extent.map(|corner| corner.map(|n| n * factor));
    vec![
        vec![[[0, 0, 0], [4, 8, 8]], [[4, 0, 0], [8, 8, 8]]],
        vec![scaled([[2, 2, 2], [4, 6, 6]], ratio), scaled([[4, 2, 2], [6, 6, 4]], ratio)],
        vec![scaled([[3, 3, 2], [5, 5, 4]], ratio * ratio)],
    ]
}

fn of_cells(scalar: &str) -> Request {
    Request { cell_arrays: vec!["c".into(), BLOCK.into()], ..request(scalar) }
}

fn read_grid(path: &Path, request: &Request) -> Grid {
    read(path, request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

fn volume(grid: &Grid) -> f64 {
    (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
}

/// Number of cells of the file, each of which has the field's value at its centre in the array c.
fn cells_with_values(grid: &Grid, field: Field) -> usize {
    let mut corners = vec![Vec::new(); grid.cell_arrays["c"].values.len()];
    for i in 0..grid.tetrahedra.len() {
        corners[grid.source_cell(i)].extend(grid.corners(i));
    }
    for (number, corners) in corners.iter().enumerate() {
        let low = corners.iter().copied().reduce(DVec3::min).unwrap();
        let high = corners.iter().copied().reduce(DVec3::max).unwrap();
        let (found, expected) = (grid.cell_arrays["c"].values[number], field(0.5 * (low + high)));
        assert!((found - expected).abs() < 1e-12, "{found} {expected} in cell {number}");
    }
    corners.len()
}

/// Differences between the values of hanging points and what the larger cells have there, with the sizes of these. The corners that say
/// this are those of a tetrahedron that holds the point.
fn jumps(grid: &Grid) -> Vec<(f64, f64)> {
    let scalar = grid.scalar.as_ref().unwrap();
    let hanging = grid.hanging.as_ref().expect("values on cells");
    assert!(!hanging.is_empty());
    let cells = cells_of_points(grid);
    let jump = |own: &HangingPoint| {
        let terms = || own.corners.iter().map(|&p| p as usize).zip(own.weights);
        let used = |tetrahedron: &&u32| {
            let corners = grid.tetrahedra[**tetrahedron as usize];
            own.corners.iter().all(|corner| corners.contains(corner))
        };
        let host =
            *cells.row(own.corners[0] as usize).iter().find(used).expect("a tetrahedron of the corners");
        let at: DVec3 = terms().map(|(p, w)| w * grid.points[p]).sum();
        assert!(at.distance(grid.points[own.point as usize]) < 1e-12);
        let value: f64 = terms().map(|(p, w)| w * scalar[p]).sum();
        let volume = tetrahedron_volume(grid.corners(host as usize));
        ((scalar[own.point as usize] - value).abs(), (6.0 * volume).cbrt())
    };
    hanging.iter().map(jump).collect()
}

#[test]
fn patches_cover_each_place_once_and_are_blocks() {
    let folder = tempfile::tempdir().unwrap();
    let path = patches(&folder, 2, &levels(2), linear);
    let whole = read_grid(&path, &of_cells("c"));
    // 512 cells without 48 under 384 finer ones, of these without 64 under 512.
    assert_eq!(cells_with_values(&whole, linear), 512 - 48 + 384 - 64 + 512);
    assert!(
        (volume(&whole) - 8.0).abs() < 1e-12 && whole.origin.warnings.is_empty(),
        "{:?}",
        whole.origin.warnings
    );
    let names = ["level0/box0", "level0/box1", "level1/box0", "level1/box1", "level2/box0"];
    assert_eq!(whole.origin.blocks, names);
    let summary = inspect(&path, &Request::default(), &NoProgress).unwrap();
    let counts: Vec<u64> = summary.blocks.iter().map(|block| block.cell_count()).collect();
    assert_eq!((counts.iter().sum::<u64>(), counts[4]), (1296, 512));
    assert_eq!(summary.notes, ["112 cells under finer ones, left out"]);
    // Of the finest patch all eight points at each cell's corners are one: 9³, and no more.
    let alone = read_grid(&path, &Request { blocks: vec!["level2/*".into()], ..of_cells("c") });
    assert_eq!((alone.points.len(), cells_with_values(&alone, linear)), (729, 512));
    // Cells under patches that are not read are drawn.
    let coarse = Request { blocks: vec!["level0".into()], ..of_cells("c") };
    assert_eq!(cells_with_values(&read_grid(&path, &coarse), linear), 512);
    assert_eq!(
        files_read_beside(&path, &coarse),
        ["0_0.vti", "0_1.vti"].map(|name| folder.path().join(name))
    );
    // Boxes without extents in the tree are those of their files.
    let text = std::fs::read_to_string(&path).unwrap();
    for kind in ["vtkNonOverlappingAMR", "vtkHierarchicalBoxDataSet"] {
        let text = text.replace("vtkOverlappingAMR", kind).replace("amr_box", "other");
        let other = read_grid(&file(&folder, "b.vthb", text.as_bytes()), &of_cells("c"));
        assert_eq!(other.points.to_vec(), whole.points.to_vec(), "{kind}");
    }
    let wrong = Request { blocks: vec!["level3".into()], ..of_cells("c") };
    assert!(read(&path, &wrong, &NoProgress).unwrap_err().to_string().contains("no such block"));
}

#[test]
fn finer_patches_cover_a_coarser_cell_together() {
    let folder = tempfile::tempdir().unwrap();
    let finer = vec![[[2, 2, 2], [5, 5, 6]], [[5, 2, 2], [6, 6, 6]], [[2, 5, 2], [5, 6, 6]]];
    let levels = vec![vec![[[0, 0, 0], [4, 4, 4]]], finer.clone()];
    let whole = read_grid(&patches(&folder, 2, &levels, linear), &of_cells("c"));
    assert_eq!(cells_with_values(&whole, linear), 64 - 8 + 64);
    assert!((volume(&whole) - 1.0).abs() < 1e-12);
    // Without one of them a part of a cell is bare, whatever lies there twice.
    let levels = vec![levels[0].clone(), vec![finer[0], finer[1], finer[0]]];
    let path = patches(&folder, 2, &levels, linear);
    let found = read(&path, &of_cells("c"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("within a cell of a coarser one") && found.contains("together"), "{found}");
}

/// Points but those on the outer boundary, where means of cells lie on one side, and values there.
fn inner(grid: &Grid) -> Vec<(DVec3, f64)> {
    let is_inner =
        |point: DVec3| (point - ORIGIN).min_element() > 1e-9 && (ORIGIN + 2.0 - point).min_element() > 1e-9;
    let all = grid.points.iter().copied().zip(grid.scalar.as_ref().unwrap().iter().copied());
    all.filter(|&(point, _)| is_inner(point)).collect()
}

#[test]
fn a_linear_field_is_exact_at_levels() {
    let folder = tempfile::tempdir().unwrap();
    for (ratio, count) in [(2, 3), (4, 2), (3, 2)] {
        let path = patches(&folder, ratio, &levels(ratio)[..count], linear);
        for scalar in ["c", "p"] {
            let grid = read_grid(&path, &of_cells(scalar));
            assert!(inner(&grid).len() > 500);
            for (point, value) in inner(&grid) {
                assert!((value - linear(point)).abs() < 1e-12, "{ratio} {scalar}: {value} at {point}");
            }
            assert!(jumps(&grid).iter().all(|&(jump, _)| jump < 1e-12), "{ratio} {scalar}");
        }
    }
}

/// Values of cells have no seam. Values at points jump by what linear interpolation leaves in a right triangle of legs H, half a square:
/// at most C/2 times the square of its circumradius H/√2, where C bounds the second derivative. At points between levels the mean of
/// cells is off by at most C/2 times the square of the distance √3/2 H of the farthest centre, and a hanging point by C/4 H² more.
#[test]
fn a_quadratic_field_is_off_by_the_square_of_the_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = patches(&folder, 2, &levels(2), quadratic);
    let of_points = read_grid(&path, &of_cells("p"));
    let shares = jumps(&of_points).into_iter().map(|(jump, size)| jump / (CURVATURE * size * size));
    let greatest = shares.fold(0.0, f64::max);
    assert!((0.02..0.25).contains(&greatest), "{greatest}");
    let of_means = read_grid(&path, &of_cells("c"));
    assert!(jumps(&of_means).iter().all(|&(jump, _)| jump < 1e-12));
    let off = inner(&of_means).into_iter().map(|(point, value)| (value - quadratic(point)).abs());
    let greatest = off.fold(0.0, f64::max) / (CURVATURE * 0.25 * 0.25);
    assert!((0.02..0.375 + 0.25).contains(&greatest), "{greatest}");
}

#[test]
fn cells_may_keep_their_values() {
    let folder = tempfile::tempdir().unwrap();
    let path = patches(&folder, 2, &levels(2), linear);
    let options = Options { cell_values: CellValues::Constant, ..Options::default() };
    let request = Request { options, association: Some(Association::Cell), ..request("c") };
    let grid = read_grid(&path, &request);
    assert!(grid.hanging.is_none());
    assert_eq!(grid.points.len(), 8 * 1296);
}

#[test]
fn patches_of_vtkhdf_have_steps() {
    // 64 coarse cells, without 8 and 6 under the finer ones.
    for (step, cells) in [(0, 64 - 8 + 64), (1, 64 - 8 - 3 + 64 + 24)] {
        let own = Request { time_step: Some(voltet_io::formats::TimeStep::Index(step)), ..of_cells("p") };
        let grid = grid("vtkhdf_patches.vtkhdf", &own);
        let shift = 100.0 * grid.origin.time.unwrap();
        assert_eq!(grid.cell_arrays["c"].values.len(), cells);
        for (&point, &value) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
            assert!((value - shift - linear(point)).abs() < 1e-12, "{value} at {point}");
        }
        assert!((volume(&grid) - 4.0).abs() < 1e-12);
    }
    assert!(grid_at("vtkhdf_patches.vtkhdf", "c", 1).hanging.is_some());
}

/// The number of leaves and their volume are VTK's.
#[test]
fn hyper_trees_are_those_of_vtk_in_every_form() {
    let names = [
        "trees_1_ascii.htg",
        "trees_1_appended.htg",
        "trees_2_binary.htg",
        "trees_2_appended.htg",
        "vtkhdf_trees.vtkhdf",
    ];
    for name in names {
        let grid = grid(name, &Request { cell_arrays: vec!["c".into()], ..request("c") });
        assert_eq!(cells_with_values(&grid, linear), 163, "{name}");
        assert!((volume(&grid) - 9.62890625).abs() < 1e-12, "{name}: {}", volume(&grid));
        assert!(grid.origin.warnings.is_empty(), "{name}: {:?}", grid.origin.warnings);
        let summary = inspect(&path(name), &Request::default(), &NoProgress).unwrap();
        assert_eq!((summary.cell_count, summary.blocks.len()), (163, 0), "{name}");
    }
}

#[test]
fn a_series_of_patches_has_their_blocks() {
    let folder = tempfile::tempdir().unwrap();
    patches(&folder, 2, &levels(2), linear);
    let series = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"3\" file=\"a.vthb\"/></Collection></VTKFile>";
    let series = file(&folder, "a.pvd", series.as_bytes());
    let grid = read_grid(&series, &Request { blocks: vec!["level*/box0".into()], ..of_cells("c") });
    assert_eq!((grid.origin.blocks.len(), grid.origin.time), (5, Some(3.0)));
    assert!(cells_with_values(&grid, linear) > 0);
}

/// Ghosts are another patch's, and flags of cells under finer ones hold where these are read.
#[test]
fn flags_of_cells_hold() {
    let folder = tempfile::tempdir().unwrap();
    let path = patches(&folder, 2, &levels(2)[..2], linear);
    let name = folder.path().join("0_0.vti");
    let sound = std::fs::read_to_string(&name).unwrap();
    let flags: String = ["1 ", "8 ", "32 "].into_iter().chain(std::iter::repeat_n("0 ", 253)).collect();
    let flags = format!(
        "<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">{flags}</DataArray></CellData>"
    );
    std::fs::write(&name, sound.replace("</CellData>", &flags)).unwrap();
    let drawn = |blocks: &[&str]| {
        let blocks = blocks.iter().map(|name| name.to_string()).collect();
        let grid = read_grid(&path, &Request { blocks, ..of_cells("c") });
        assert!(grid.origin.warnings.is_empty(), "{:?}", grid.origin.warnings);
        (volume(&grid) * 64.0).round()
    };
    assert_eq!((drawn(&[]), drawn(&["level0"])), (512.0 - 3.0, 512.0 - 2.0));
    // Another array that one patch alone has is left out.
    std::fs::write(&name, sound.replace("\"p\"", "\"q\"")).unwrap();
    let warnings = read_grid(&path, &of_cells("c")).origin.warnings.clone();
    let left_out =
        |name| format!("The array '{name}' is left out: not all parts of the adaptive grid have it.");
    assert_eq!(warnings, ["q", "p"].map(left_out));
}

/// The message about patches of which the text of a file was changed.
fn refused(levels: &[Vec<Extent>], name: &str, from: &str, to: &str) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = patches(&folder, 2, levels, linear);
    let changed = folder.path().join(name);
    let text = std::fs::read_to_string(&changed).unwrap();
    assert!(text.contains(from), "{from}");
    std::fs::write(changed, text.replace(from, to)).unwrap();
    read(&path, &request("c"), &NoProgress).unwrap_err().to_string()
}

#[test]
fn damaged_patches_are_named() {
    let levels = levels(2);
    for (name, from, to, parts) in [
        ("a.vthb", "amr_box=\"0 3", "amr_box=\"0 4", &["[4, 8, 8]", "[5, 8, 8]", "amr_box", "0_0.vti"][..]),
        ("0_1.vti", "0.25 0.25 0.25", "0.25 0.25 0.3", &["one lattice", "level0/box1"]),
        ("1_0.vti", "Origin=\"1 ", "Origin=\"1.03 ", &["one lattice", "level1/box0"]),
        ("1_0.vti", "Origin=\"1 ", "Origin=\"1.125 ", &["within a cell of a coarser one", "level0/box"]),
        ("1_0.vti", "Spacing=\"0.125", "Spacing=\"-0.125", &["damaged", "level1/box0"]),
        ("0_0.vti", "Spacing=", "Direction=\"0 1 0 1 0 0 0 0 1\" Spacing=", &["Direction", "0_0.vti"]),
        ("0_0.vti", "ImageData", "StructuredGrid", &["no <Points>", "0_0.vti"]),
    ] {
        let message = refused(&levels, name, from, to);
        assert!(parts.iter().all(|part| message.contains(part)), "{name} {to}: {message}");
    }
    let flat = vec![vec![[[0, 0, 0], [4, 4, 1]]]];
    let flat = refused(&flat, "0_0.vti", "0 4 0 4 0 1", "0 4 0 4 0 0");
    assert!(flat.contains("no three-dimensional cells") && flat.contains("level0/box0"), "{flat}");
}

/// A hyper tree grid of one root with two children's levels, changed.
fn tree(from: &str, to: &str) -> String {
    let array = |kind: &str, name: &str, values: &str| {
        let count = values.split_whitespace().count();
        format!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfTuples=\"{count}\" format=\"ascii\">{values}</DataArray>"
        )
    };
    let axis = |name| array("Float64", name, "0 1");
    let text = format!(
        "<VTKFile type=\"HyperTreeGrid\" version=\"2.0\"><HyperTreeGrid BranchFactor=\"2\" TransposedRootIndexing=\"0\" \
         Dimensions=\"2 2 2\"><Grid>{}{}{}</Grid><Trees>{}{}{}{}</Trees><CellData>{}</CellData></HyperTreeGrid></VTKFile>",
        axis("XCoordinates"),
        axis("YCoordinates"),
        axis("ZCoordinates"),
        array("Bit", "Descriptors", "1 1 0 0 0 0 0 0 0"),
        array("Int64", "NumberOfVerticesPerDepth", "1 8 8"),
        array("Int64", "TreeIds", "0"),
        array("UInt32", "DepthPerTree", "3"),
        array("Float64", "s", &"2 ".repeat(17)),
    );
    assert!(text.contains(from), "{from}");
    text.replace(from, to)
}

#[test]
fn damaged_hyper_trees_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let read = |text: &str| read(&file(&folder, "a.htg", text.as_bytes()), &request("s"), &NoProgress);
    let sound = read(&tree("", "")).unwrap();
    assert_eq!(sound.origin.cells_by_type[&11], 15);
    assert!((volume(&sound) - 1.0).abs() < 1e-12);
    for (from, to, parts) in [
        ("version=\"2.0\"", "version=\"0.1\"", &["version", "0.1"][..]),
        ("BranchFactor=\"2\"", "BranchFactor=\"4\"", &["branch factor", "4"]),
        ("Dimensions=\"2 2 2\"", "Dimensions=\"2 2 1\"", &["ZCoordinates"]),
        ("Dimensions=\"2 2 2\"", "Dimensions=\"9223372036854775808 2 2\"", &["XCoordinates"]),
        (
            "\"XCoordinates\" NumberOfTuples=\"2\" format=\"ascii\">0 1",
            "\"XCoordinates\" format=\"ascii\">1 0",
            &["ascend"],
        ),
        ("1 1 0 0 0 0 0 0 0", "1 1 0 0 0 0 0 0 1", &["other vertices", "17", "25", "tree 0"]),
        ("1 8 8", "1 8 9223372036854775807", &["cannot be that large"]),
        ("1 8 8", "1 8 999999", &["larger than the file", "'s'"]),
        (">0</DataArray>", ">1</DataArray>", &["root that the grid lacks", "found 1"]),
        (">3</DataArray>", ">4</DataArray>", &["fewer than their depths"]),
        ("NumberOfTuples=\"9\"", "NumberOfTuples=\"9223372036854775808\"", &["Descriptors"]),
        ("CellData", "FieldData", &["holds no arrays"]),
    ] {
        let message = read(&tree(from, to)).expect_err(to).to_string();
        assert!(parts.iter().all(|part| message.contains(part)), "{to}: {message}");
    }
    let plane = tree("Dimensions=\"2 2 2\"", "Dimensions=\"2 2 1\"").replace(
        "ZCoordinates\" NumberOfTuples=\"2\" format=\"ascii\">0 1",
        "ZCoordinates\" NumberOfTuples=\"1\" format=\"ascii\">0",
    );
    let plane = read(&plane).unwrap_err().to_string();
    assert!(plane.contains("no three-dimensional cells"), "{plane}");
}

/// A tree whose levels each cut one cell again: its lattice leaves 32 bits.
#[test]
fn trees_that_are_too_deep_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let depth = |levels: usize| {
        let bits = "1".to_owned() + &" 1 0 0 0 0 0 0 0".repeat(levels - 2);
        let vertices = 1 + 8 * (levels - 1);
        tree("1 1 0 0 0 0 0 0 0", &bits)
            .replace("NumberOfTuples=\"9\"", &format!("NumberOfTuples=\"{}\"", 1 + 8 * (levels - 2)))
            .replace(
                "NumberOfTuples=\"3\" format=\"ascii\">1 8 8",
                &format!("NumberOfTuples=\"{levels}\" format=\"ascii\">1{}", " 8".repeat(levels - 1)),
            )
            .replace(">3</DataArray>", &format!(">{levels}</DataArray>"))
            .replace(&"2 ".repeat(17), &"2 ".repeat(vertices))
    };
    let read = |levels| read(&file(&folder, "a.htg", depth(levels).as_bytes()), &request("s"), &NoProgress);
    let deepest = read(32).unwrap();
    assert!((volume(&deepest) - 1.0).abs() < 1e-12);
    let message = read(33).unwrap_err().to_string();
    assert!(message.contains("too deep") && message.contains("32 levels"), "{message}");
}

/// Patches nest: one of the finest may begin within a coarsest cell, for a patch between them covers that.
#[test]
fn a_finest_patch_may_begin_within_a_coarsest_cell() {
    for ratio in [2, 3] {
        let folder = tempfile::tempdir().unwrap();
        let mut levels = levels(ratio);
        levels[2][0].iter_mut().for_each(|corner| corner[0] += ratio);
        let path = patches(&folder, ratio, &levels, linear);
        let grid = read_grid(&path, &of_cells("c"));
        assert!((volume(&grid) - 8.0).abs() < 1e-9, "{}", volume(&grid));
        cells_with_values(&grid, linear);
        // Where nothing lies between, half a cell would be left.
        levels[1].clear();
        let path = patches(&folder, ratio, &levels, linear);
        let error = read(&path, &of_cells("c"), &NoProgress).unwrap_err().to_string();
        assert!(error.contains("within a cell of a coarser one"), "{error}");
    }
}

/// Ghosts around a finer patch cover nothing: the coarser cells there are drawn.
#[test]
fn ghosts_of_a_finer_patch_cover_nothing() {
    for layers in [1, 2] {
        let folder = tempfile::tempdir().unwrap();
        let fine = [[2 - layers; 3], [6 + layers; 3]];
        let levels = vec![vec![[[0; 3], [4; 3]]], vec![fine]];
        let path = patches(&folder, 2, &levels, linear);
        let mut flags = String::new();
        for k in fine[0][2]..fine[1][2] {
            for j in fine[0][1]..fine[1][1] {
                for i in fine[0][0]..fine[1][0] {
                    let is_own = [i, j, k].iter().all(|n| (2..6).contains(n));
                    flags += if is_own { "0 " } else { "1 " };
                }
            }
        }
        let array =
            format!("<DataArray type=\"UInt8\" Name=\"vtkGhostType\" format=\"ascii\">{flags}</DataArray>");
        let text = image(fine, 0.125, linear).replace("</CellData>", &format!("{array}</CellData>"));
        file(&folder, "1_0.vti", text.as_bytes());
        let grid = read_grid(&path, &of_cells("c"));
        assert!((volume(&grid) - 1.0).abs() < 1e-9, "{layers}: {}", volume(&grid));
        let drawn: std::collections::BTreeSet<usize> =
            (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i)).collect();
        assert_eq!(drawn.len(), 64 - 8 + 64, "{layers}");
    }
}
