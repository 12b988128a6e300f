//! Data that cannot be read and files that cannot be written: one error, exit code 1, no partial file.

use super::support::{Folder, cube};

/// Runs the slab and asserts that it fails with one error that says all of this and leaves no file.
#[track_caller]
fn fails(folder: &Folder, options: &[&str], wanted: &[&str]) {
    let before = folder.names();
    let sets: Vec<&str> = options.iter().flat_map(|option| ["--set", option]).collect();
    let ran = folder.voltet(&[&["run", "slab.toml", "--report", "report.json"], &sets[..]].concat());
    ran.fails(1, wanted);
    assert_eq!(folder.names(), before);
}

#[test]
fn a_missing_file_is_named_with_the_nearest() {
    let folder = Folder::new();
    fails(&folder, &["grid.path=cub.vtu"], &["cannot be opened", "cub.vtu", "node 'grid'", "'cube.vtu'"]);
    fails(&folder, &["grid.path=."], &["node 'grid'"]);
}

#[test]
fn an_unknown_array_is_answered_with_those_that_are_there() {
    let folder = Folder::new();
    fails(&folder, &["grid.scalar=z"], &["'z'", "cube.vtu", "node 'grid'", "'x'", "'ones'"]);
    fails(&folder, &["grid.scalar=gradient:7"], &["gradient", "node 'grid'"]);
    let region = "look.widgets.0.region={ g = [0, 2] }";
    fails(&folder, &["gradient.method=array", "gradient.array=grad", region], &["'grad'", "'gradient'"]);
}

#[test]
fn what_is_no_data_file_is_refused() {
    let folder = Folder::new();
    for content in ["", "P6 3 3 255", "<html></html>", "<?xml version=\"1.0\"?>\n<VTKFile"] {
        folder.write("cube.vtu", content);
        fails(&folder, &[], &["cube.vtu", "node 'grid'"]);
    }
}

#[test]
fn surfaces_and_points_alone_are_nothing_to_draw() {
    let folder = Folder::new();
    // VTK type 8, a pixel, in place of the hexahedra: corners 0 … 3 of each.
    let text = cube(1).replace("0 1 3 2 4 5 7 6", "0 1 2 3").replace(">8<", ">4<").replace(">12<", ">8<");
    folder.write("cube.vtu", text);
    fails(&folder, &[], &["cube.vtu", "three-dimensional", "node 'grid'"]);
}

#[test]
fn a_header_that_promises_terabytes_is_an_error() {
    let folder = Folder::new();
    for (from, to) in [
        ("NumberOfPoints=\"64\"", "NumberOfPoints=\"999999999999\""),
        ("NumberOfCells=\"27\"", "NumberOfCells=\"999999999999\""),
        ("NumberOfCells=\"27\"", "NumberOfCells=\"18446744073709551615\""),
        ("NumberOfPoints=\"64\"", "NumberOfPoints=\"-1\""),
        ("Name=\"Points\" NumberOfComponents=\"3\"", "Name=\"Points\" NumberOfComponents=\"4294967295\""),
    ] {
        assert!(cube(3).contains(from));
        folder.write("cube.vtu", cube(3).replacen(from, to, 1));
        fails(&folder, &[], &["cube.vtu", "node 'grid'"]);
    }
}

#[test]
fn a_file_cut_anywhere_is_an_error_and_never_a_panic() {
    let folder = Folder::new();
    let whole = cube(2);
    for part in 1..24 {
        folder.write("cube.vtu", &whole[..whole.len() * part / 24]);
        fails(&folder, &[], &["cube.vtu", "node 'grid'"]);
    }
}

#[test]
fn a_damaged_file_is_an_error_or_a_picture_and_never_a_panic() {
    let folder = Folder::new();
    let whole = cube(2).into_bytes();
    for step in 0..40 {
        let mut damaged = whole.clone();
        // Places spread over the file; the byte becomes another one that ASCII data could hold.
        damaged[(step * 7919) % whole.len()] = b"<>\"0-9e./ \xff\x00"[step % 12];
        folder.write("cube.vtu", damaged);
        let ran = folder.voltet(&["run", "slab.toml"]);
        assert!(matches!(ran.code, 0 | 1), "{}", ran.stderr);
        assert_eq!(ran.errors(), ran.code as usize, "{}", ran.stderr);
        if ran.code == 0 {
            assert!(folder.floats("slab.exr").1.iter().flatten().all(|x| x.is_finite()));
        }
    }
}

#[test]
fn an_output_that_cannot_be_written_is_found_out_before_the_work() {
    let folder = Folder::new();
    folder.write("cube.vtu", "damaged, but nobody gets that far");
    fails(&folder, &["file.path=missing/a.png"], &["folder does not exist", "node 'file'"]);
    std::fs::create_dir(folder.join("folder.png")).unwrap();
    fails(&folder, &["file.path=folder.png"], &["is a folder", "node 'file'"]);
    if cfg!(target_os = "linux") {
        fails(&folder, &["file.path=/proc/a.png"], &["'/proc/a.png' cannot be written", "node 'file'"]);
    }
    let ran = folder.voltet(&["run", "slab.toml", "--report", "missing/report.json"]);
    ran.fails(1, &["missing/report.json", "folder does not exist"]);
}

#[test]
fn a_failed_run_leaves_an_earlier_picture_as_it_was() {
    let folder = Folder::new();
    folder.voltet(&["run", "slab.toml"]).ok();
    let earlier = std::fs::read(folder.join("slab.exr")).unwrap();
    folder.write("cube.vtu", "damaged");
    fails(&folder, &[], &["cube.vtu"]);
    assert_eq!(std::fs::read(folder.join("slab.exr")).unwrap(), earlier);
}
