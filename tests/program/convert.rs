//! `voltet convert`: grids in other formats, the same to the last bit, and what is said of what they do not hold.

use super::support::{Folder, cube, cube_of};
use voltet::core::grid::{Grid, Options};
use voltet::core::progress::NoProgress;
use voltet::io::formats::{Request, read};

/// The file's points, cells and these arrays, as they are.
fn grid(folder: &Folder, name: &str, point_arrays: &[&str], cell_arrays: &[&str]) -> Grid {
    let names = |names: &[&str]| names.iter().map(|name| name.to_string()).collect();
    let request = Request {
        without_scalar: true,
        point_arrays: names(point_arrays),
        cell_arrays: names(cell_arrays),
        options: Options { keep_cells: true, without_tetrahedra: true, ..Options::default() },
        ..Request::default()
    };
    read(&folder.join(name), &request, &NoProgress).unwrap_or_else(|error| panic!("{error}"))
}

/// A tetrahedron, a triangle, and a point of neither, with values that are not finite; `more`: further arrays at the points.
fn odd(more: &str) -> String {
    format!(
        "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"6\" NumberOfCells=\"2\">\
         <PointData><DataArray type=\"Float64\" Name=\"T\">0.1 nan 3 4 -inf 6</DataArray>{more}</PointData>\
         <CellData><DataArray type=\"Int32\" Name=\"material\">7 8</DataArray></CellData>\
         <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1 2 2 2.1 3 3 3</DataArray></Points>\
         <Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3 1 2 4</DataArray>\
         <DataArray type=\"Int64\" Name=\"offsets\">4 7</DataArray>\
         <DataArray type=\"UInt8\" Name=\"types\">10 5</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
    )
}

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| value.to_bits()).collect()
}

#[test]
fn cells_points_and_values_come_through_every_format_as_they_are() {
    let folder = Folder::new();
    folder.write("odd.vtu", odd(""));
    folder.voltet(&["convert", "odd.vtu", "odd.vtkhdf"]).ok();
    let ran = folder.voltet(&["convert", "odd.vtkhdf", "again.vtu"]).ok();
    assert!(ran.stdout.contains("again.vtu: 6 points, 2 cells, 2 arrays"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "nothing is left out, and nothing is warned of");
    let values = [0.1, f64::NAN, 3.0, 4.0, f64::NEG_INFINITY, 6.0];
    for name in ["odd.vtu", "odd.vtkhdf", "again.vtu"] {
        let grid = grid(&folder, name, &["T"], &["material"]);
        assert!(grid.tetrahedra.is_empty(), "nobody asked for tetrahedra");
        assert_eq!(grid.origin.cells_by_type, [(5, 1), (10, 1)].into(), "{name}");
        assert_eq!(bits(&grid.point_arrays["T"].values), bits(&values), "{name}");
        assert_eq!(*grid.cell_arrays["material"].values, [7.0, 8.0], "{name}");
        assert_eq!((grid.points.len(), grid.points[4].to_array()), (6, [2.0, 2.0, 2.1]), "{name}");
    }
}

#[test]
fn a_picture_of_the_new_file_is_that_of_the_old_one() {
    let folder = Folder::new();
    for name in ["new.vtkhdf", "new.vtu"] {
        folder.voltet(&["convert", "cube.vtu", name, "--quiet"]).ok();
        folder.voltet(&["run", "slab.toml", "--output", "old.exr"]).ok();
        let data = format!("grid.path={name}");
        folder.voltet(&["run", "slab.toml", "--output", "new.exr", "--set", &data]).ok();
        folder.voltet(&["diff", "old.exr", "new.exr", "--limit", "0"]).ok();
    }
}

#[test]
fn what_the_new_file_lacks_is_listed() {
    let folder = Folder::new();
    let whole = "<DataArray type=\"Int32\" Name=\"count\">1 2 3 4 5 6</DataArray>";
    folder.write("odd.vtu", odd(whole));
    let all = folder.voltet(&["convert", "odd.vtu", "all.vtu"]).ok().stdout;
    assert!(all.contains("types of whole numbers: 'count', 'material' are written as floats"), "{all}");
    assert!(!all.contains("--arrays"), "{all}");
    let one = folder.voltet(&["convert", "odd.vtu", "one.vtkhdf", "--arrays", "T"]).ok().stdout;
    assert!(one.contains("1 array\n") || one.contains("1 array,"), "{one}");
    assert!(one.contains("2 arrays not named by --arrays: 'count', 'material'"), "{one}");
    let text = folder.voltet(&["info", "one.vtkhdf"]).ok().stdout;
    assert!(text.contains("  point  T") && !text.contains("count"), "{text}");
    let quiet = folder.voltet(&["convert", "odd.vtu", "quiet.vtu", "--quiet"]).ok();
    assert_eq!(quiet.stdout + &quiet.stderr, "");
}

#[test]
fn blocks_are_chosen_by_name_and_one_that_lacks_an_array_has_nan() {
    let folder = Folder::new();
    folder.write("b.vtu", cube_of(2, "T", |x| x));
    folder.write("flat.vtu", odd("").replace("10 5", "9 5"));
    folder.write(
        "all.vtm",
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><Block index=\"0\" name=\"fluid\">\
         <DataSet index=\"0\" name=\"rotor\" file=\"cube.vtu\"/><DataSet index=\"1\" name=\"stator\" file=\"b.vtu\"/></Block>\
         <DataSet index=\"1\" name=\"wall\" file=\"flat.vtu\"/></vtkMultiBlockDataSet></VTKFile>",
    );
    let ran = folder.voltet(&["convert", "all.vtm", "fluid.vtkhdf", "--blocks", "fluid/*"]).ok();
    assert!(ran.stdout.contains("91 points, 35 cells"), "{}", ran.stdout);
    assert!(ran.stdout.contains("1 block not named by --blocks: 'wall'"), "{}", ran.stdout);
    assert!(ran.stdout.contains("0 is 'fluid/rotor', 1 is 'fluid/stator', 2 is 'wall'"), "{}", ran.stdout);
    assert!(
        ran.stderr.contains("warning: A block lacks the array 'T' and has nan there: 'fluid/rotor'"),
        "{}",
        ran.stderr
    );
    let grid = grid(&folder, "fluid.vtkhdf", &["T", "y"], &["block", "layer"]);
    let is_nan: Vec<bool> = grid.point_arrays["T"].values.iter().map(|value| value.is_nan()).collect();
    assert_eq!(is_nan, (0..91).map(|point| point < 64).collect::<Vec<_>>());
    assert!(grid.point_arrays["y"].values.iter().all(|value| value.is_finite()));
    assert_eq!(grid.cell_arrays["block"].values.iter().sum::<f64>(), 8.0);
    let all = folder.voltet(&["convert", "all.vtm", "all.vtu"]).ok();
    assert!(all.stdout.contains("97 points, 37 cells"), "{}", all.stdout);
    let wrong = folder.voltet(&["convert", "all.vtm", "no.vtu", "--blocks", "fluid/roter"]);
    wrong.fails(1, &["no such block", "'fluid/rotor', the nearest"]);
    assert!(!folder.join("no.vtu").exists());
}

/// A series of four steps, at the times 0, 0.5, 1 and 1.5.
fn series() -> Folder {
    let folder = Folder::new();
    let mut steps = String::new();
    for step in 0..4 {
        folder.write(&format!("s{step}.vtu"), cube_of(1, "T", |x| x + f64::from(step)));
        steps += &format!("<DataSet timestep=\"{}\" file=\"s{step}.vtu\"/>", 0.5 * f64::from(step));
    }
    folder
        .write("run.pvd", format!("<VTKFile type=\"Collection\"><Collection>{steps}</Collection></VTKFile>"));
    folder
}

/// The time of a file and its largest T.
fn time_and_value(folder: &Folder, name: &str) -> (Option<f64>, f64) {
    let grid = grid(folder, name, &["T"], &[]);
    (grid.origin.time, grid.point_arrays["T"].values.iter().copied().fold(f64::MIN, f64::max))
}

#[test]
fn steps_of_a_series_become_files_with_their_times() {
    let folder = series();
    let first = folder.voltet(&["convert", "run.pvd", "first.vtu"]).ok().stdout;
    assert!(first.contains("first.vtu: step 0, time 0, 8 points"), "{first}");
    assert!(first.contains("3 time steps of 4: --steps all writes them all"), "{first}");
    folder.voltet(&["convert", "run.pvd", "third.vtkhdf", "--step", "2"]).ok();
    folder.voltet(&["convert", "run.pvd", "near_{step}.vtu", "--time", "0.6"]).ok();
    let all = folder.voltet(&["convert", "run.pvd", "all_{step:03}.vtkhdf", "--steps", "all"]).ok().stdout;
    assert!(all.contains("all_003.vtkhdf: step 3, time 1.5") && !all.contains("not in"), "{all}");
    folder.voltet(&["convert", "run.pvd", "some_{step}.vtu", "--steps", "1::2"]).ok();
    folder.voltet(&["convert", "run.pvd", "ends.vtu", "--steps", "-1,0"]).ok();
    folder.voltet(&["convert", "run.pvd", "at_{time}.vtu", "--step", "1"]).ok();
    for (name, expected) in [
        ("first.vtu", (Some(0.0), 1.0)),
        ("third.vtkhdf", (Some(1.0), 3.0)),
        ("near_1.vtu", (Some(0.5), 2.0)),
        ("all_000.vtkhdf", (Some(0.0), 1.0)),
        ("all_003.vtkhdf", (Some(1.5), 4.0)),
        ("some_1.vtu", (Some(0.5), 2.0)),
        ("some_3.vtu", (Some(1.5), 4.0)),
        ("ends_0003.vtu", (Some(1.5), 4.0)),
        ("ends_0000.vtu", (Some(0.0), 1.0)),
        ("at_0.5.vtu", (Some(0.5), 2.0)),
    ] {
        assert_eq!(time_and_value(&folder, name), expected, "{name}");
    }
    assert!(!folder.join("some_0.vtu").exists() && !folder.join("some_2.vtu").exists());
}

#[test]
fn wrong_steps_are_refused_before_anything_is_written() {
    let folder = series();
    let before = folder.names();
    let refused = |arguments: &[&str], code: i32, wanted: &[&str]| {
        folder.voltet(&[&["convert", "run.pvd"], arguments].concat()).fails(code, wanted);
        assert_eq!(folder.names(), before, "{arguments:?}");
    };
    refused(&["-", "--steps", "all"], 2, &["several files", "standard output"]);
    refused(&["a_{step}.vtu", "--steps", "2:4"], 2, &["no such time step", "found 4", "0 to 3"]);
    refused(&["a.vtu", "--step", "4"], 1, &["no such step", "0 to 3"]);
    refused(&["a.vtu", "--time", "9"], 1, &["no such time", "0 to 1.5"]);
    refused(&["a.vtu", "--steps", "3:1"], 2, &["FIRST:LAST"]);
    let both = folder.voltet(&["convert", "run.pvd", "a.vtu", "--step", "1", "--steps", "all"]);
    assert_eq!(both.code, 2, "{}", both.stderr);
    let none = folder.voltet(&["convert", "cube.vtu", "a.vtu", "--step", "1"]);
    none.fails(1, &["the file is no time series"]);
    assert_eq!(folder.names(), before);
}

#[test]
fn files_that_are_there_or_read_are_kept() {
    let folder = Folder::new();
    folder.write("there.vtu", "mine");
    let before = folder.names();
    let refused = |arguments: &[&str], code: i32, wanted: &[&str]| {
        folder.voltet(&[&["convert"], arguments].concat()).fails(code, wanted);
        assert_eq!(folder.names(), before, "{arguments:?}");
    };
    refused(&["cube.vtu", "there.vtu"], 2, &["is there already", "--force"]);
    refused(&["cube.vtu", "./cube.vtu", "--force"], 2, &["written over data that are read"]);
    refused(&["cube.vtu", "new.vtk"], 2, &["found new.vtk", "ends in .vtu or .vtkhdf"]);
    refused(&["cube.vtu", "no/new.vtu"], 1, &["its folder does not exist"]);
    refused(&["cub.vtu", "new.vtu"], 1, &["such as 'cube.vtu' beside it"]);
    refused(&["cube.vtu", "new.vtu", "--arrays", "x,layr"], 2, &["no such array", "'layer', the nearest"]);
    assert_eq!(std::fs::read_to_string(folder.join("cube.vtu")).unwrap(), cube(3));
    assert_eq!(std::fs::read_to_string(folder.join("there.vtu")).unwrap(), "mine");
    folder.voltet(&["convert", "cube.vtu", "there.vtu", "--force"]).ok();
    assert_eq!(grid(&folder, "there.vtu", &[], &[]).points.len(), 64);
    let stream = folder.voltet(&["convert", "cube.vtu", "-"]).ok();
    assert!(stream.stdout.starts_with("<?xml") && stream.stdout.trim_end().ends_with("</VTKFile>"));
    assert!(stream.stderr.contains("64 points, 27 cells, 5 arrays"), "{}", stream.stderr);
}

#[test]
fn an_array_whose_name_a_format_does_not_take_is_renamed_and_said() {
    let folder = Folder::new();
    folder.write("slash.vtu", cube_of(1, "a/b", |x| x));
    let ran = folder.voltet(&["convert", "slash.vtu", "slash.vtkhdf"]).ok();
    assert!(ran.stderr.contains("warning: the array 'a/b' is called 'a_b' in the file"), "{}", ran.stderr);
    assert_eq!(grid(&folder, "slash.vtkhdf", &["a_b"], &[]).point_arrays["a_b"].values.len(), 8);
    folder.write("two.vtu", cube_of(1, "a/b", |x| x).replace("\"ones\"", "\"a_b\""));
    folder.voltet(&["convert", "two.vtu", "two.vtkhdf"]).fails(1, &["two arrays have one name", "'a_b'"]);
    assert!(!folder.join("two.vtkhdf").exists());
}

#[test]
fn cells_that_several_pieces_hold_are_written_once() {
    let folder = Folder::new();
    // Two tetrahedra with a common face; each piece has the other's as a ghost.
    for (name, ghosts, value) in [("a.vtu", "0 1", "5 9"), ("b.vtu", "1 0", "9 6")] {
        let cells = format!(
            "<CellData><DataArray type=\"UInt8\" Name=\"vtkGhostType\">{ghosts}</DataArray>\
             <DataArray type=\"Float32\" Name=\"c\">{value}</DataArray></CellData>"
        );
        folder.write(
            name,
            format!(
                "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece NumberOfPoints=\"5\" NumberOfCells=\"2\">{cells}\
                 <Points><DataArray type=\"Float64\" NumberOfComponents=\"3\">0 0 0 1 0 0 0 1 0 0 0 1 1 1 1</DataArray></Points>\
                 <Cells><DataArray type=\"Int64\" Name=\"connectivity\">0 1 2 3 1 2 3 4</DataArray>\
                 <DataArray type=\"Int64\" Name=\"offsets\">4 8</DataArray>\
                 <DataArray type=\"UInt8\" Name=\"types\">10 10</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
            ),
        );
    }
    folder.write(
        "all.pvtu",
        "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid GhostLevel=\"1\"><PCellData>\
         <PDataArray type=\"UInt8\" Name=\"vtkGhostType\"/><PDataArray type=\"Float32\" Name=\"c\"/></PCellData>\
         <PPoints><PDataArray type=\"Float64\" NumberOfComponents=\"3\"/></PPoints>\
         <Piece Source=\"a.vtu\"/><Piece Source=\"b.vtu\"/></PUnstructuredGrid></VTKFile>",
    );
    let ran = folder.voltet(&["convert", "all.pvtu", "all.vtkhdf"]).ok();
    assert!(ran.stdout.contains("5 points, 2 cells, 1 array"), "{}", ran.stdout);
    assert!(ran.stdout.contains("  2 ghost cells of pieces, whose originals are written"), "{}", ran.stdout);
    assert_eq!(*grid(&folder, "all.vtkhdf", &[], &["c"]).cell_arrays["c"].values, [5.0, 6.0]);
    let shown = folder.voltet(&["info", "all.vtkhdf"]).ok().stdout;
    assert!(!shown.contains("ghost"), "{shown}");
}

#[test]
fn damaged_cells_are_refused_also_those_that_no_picture_shows() {
    let folder = Folder::new();
    for (from, to, wanted) in [
        ("1 2 4<", "1 2 9<", "cell 1 names a point that does not exist"),
        ("10 5", "10 99", "cell 1 has an unknown type"),
    ] {
        folder.write("bad.vtu", odd("").replace(from, to));
        folder.voltet(&["convert", "bad.vtu", "new.vtu"]).fails(1, &[wanted]);
        assert!(!folder.join("new.vtu").exists(), "{wanted}");
    }
    folder.write("bad.vtu", odd("").replace("1 2 4<", "1 2<").replace(">4 7<", ">4 6<"));
    let wanted = "cell 1, a triangle, has the wrong number of points";
    folder.voltet(&["convert", "bad.vtu", "new.vtu"]).fails(1, &[wanted]);
}

/// Steps of a series may hold other arrays: each is written with its own.
#[test]
fn each_step_is_written_with_its_own_arrays() {
    let folder = Folder::new();
    folder.write("r0.vtu", odd(""));
    folder.write("r1.vtu", odd("<DataArray type=\"Float64\" Name=\"q\">1 2 3 4 5 6</DataArray>"));
    folder.write(
        "s.pvd",
        "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"r0.vtu\"/>\
         <DataSet timestep=\"1\" file=\"r1.vtu\"/></Collection></VTKFile>",
    );
    let all = folder.voltet(&["convert", "s.pvd", "o_{step}.vtu", "--steps", "all"]).ok().stdout;
    assert!(all.contains("o_0.vtu: step 0, time 0, 6 points, 2 cells, 2 arrays"), "{all}");
    assert!(all.contains("o_1.vtu: step 1, time 1, 6 points, 2 cells, 3 arrays"), "{all}");
    assert!(all.contains("arrays that some steps lack: 'q'"), "{all}");
    let named = ["convert", "s.pvd", "n_{step}.vtu", "--steps", "all", "--arrays", "q"];
    let named = folder.voltet(&named).ok().stdout;
    assert!(named.contains("n_0.vtu: step 0, time 0, 6 points, 2 cells, 0 arrays"), "{named}");
}

/// Parts of a file that have no cells to be written are named.
#[test]
fn a_block_without_thickness_is_named() {
    let folder = Folder::new();
    folder.write("odd.vtu", odd(""));
    folder.write(
        "flat.vti",
        "<VTKFile type=\"ImageData\"><ImageData WholeExtent=\"0 2 0 2 0 0\" Origin=\"0 0 0\" Spacing=\"1 1 1\">\
         <Piece Extent=\"0 2 0 2 0 0\"><PointData><DataArray type=\"Float64\" Name=\"T\" format=\"ascii\">\
         1 2 3 4 5 6 7 8 9</DataArray></PointData></Piece></ImageData></VTKFile>",
    );
    folder.write(
        "both.vtm",
        "<VTKFile type=\"vtkMultiBlockDataSet\"><vtkMultiBlockDataSet><DataSet index=\"0\" name=\"vol\" file=\"odd.vtu\"/>\
         <DataSet index=\"1\" name=\"inlet\" file=\"flat.vti\"/></vtkMultiBlockDataSet></VTKFile>",
    );
    let ran = folder.voltet(&["convert", "both.vtm", "both.vtu"]).ok();
    assert!(
        ran.stderr.contains("1 part without thickness") && ran.stderr.contains("inlet"),
        "{}",
        ran.stderr
    );
}
