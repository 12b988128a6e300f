//! Readers, grid filters and image filters of plug-ins that do what they must not: each is one message that names the plug-in,
//! in the program's process and in one of the plug-in's own, and nothing is written.

use crate::plugin_node_scene::scene;
use crate::support::Folder;
use std::time::{Duration, Instant};
use voltet_testing::compilers;

fn folder() -> Option<Folder> {
    let folder = Folder::new();
    folder.write("scene.toml", scene("faulty", 16));
    folder.write("any.faulty", "whatever");
    let source = compilers::source("tests/plugins/faulty_nodes.c");
    compilers::library(folder.path(), "faulty.so", &[source], &[])?;
    Some(folder)
}

const LOADED: [&str; 4] = ["run", "scene.toml", "--plugin", "faulty.so"];

/// Asserts the messages about a node with these faults.
fn said(node: &str, whose: &str, faults: &[(&str, &[&str])]) {
    let Some(folder) = folder() else { return };
    let before = folder.names();
    for (fault, wanted) in faults {
        for own_process in [&[][..], &["--plugin-process"]] {
            let set = format!("{node}.fault={fault}");
            let ran = folder.voltet(&[&LOADED[..], &["--set", &set], own_process].concat());
            let named = [whose, " of the plug-in 'faulty nodes' (faulty.so)", &format!("node '{node}'")];
            ran.fails(1, &[wanted, &named[..]].concat());
            assert_eq!(folder.names(), before, "nothing was written");
        }
    }
}

#[test]
fn without_a_fault_a_picture_is_drawn() {
    let Some(folder) = folder() else { return };
    folder.voltet(&LOADED).ok();
    let shown = folder.floats("picture.exr").1;
    assert!(shown.iter().any(|pixel| pixel[3] > 0.2), "the picture shows something");
    folder.voltet(&[&LOADED[..], &["--plugin-process"]].concat()).ok();
    assert_eq!(folder.floats("picture.exr").1, shown);
}

/// A filter that keeps points and cells keeps what belongs to them: the arrays beside the one that it makes, the file's own cells.
#[test]
fn what_a_grid_filter_keeps_is_that_of_its_input() {
    let Some(folder) = folder() else { return };
    folder.voltet(&LOADED).ok();
    let wanted = folder.floats("picture.exr").1;
    let writer = "[nodes.out]\ntype = \"grid-writer\"\npath = \"out.vtu\"\ncell_arrays = [\"t\"]\ncells = \"file\"\n\
                  inputs = { volume = \"moved\" }\n";
    folder.write("scene.toml", scene("faulty", 16) + "\n" + writer);
    for own_process in [&[][..], &["--plugin-process"]] {
        folder.voltet(&[&LOADED[..], &["--set", "moved.fault=kept"], own_process].concat()).ok();
        assert_eq!(folder.floats("picture.exr").1, wanted);
        let written = folder.voltet(&["info", "out.vtu"]).ok().stdout;
        assert!(written.contains("point  w ") && written.contains("cell   t "), "{written}");
    }
    folder.voltet(&LOADED).fails(1, &["gives other cells, and so not the cell array 't'", "node 'moved'"]);
}

#[test]
fn what_a_reader_says_of_a_file_wrongly_is_said() {
    let file = "any.faulty";
    said(
        "grid",
        "the reader 'faulty-reader'",
        &[
            ("huge", &["point_count is 1099511627776, at most 4294967295", file]),
            ("many", &["array_count is 1073741824, at most 4096"]),
            ("twins", &["array 1: there are two of the name 's'"]),
            ("nowhere", &["'on_cells' of 't' is 7, neither 0 nor 1"]),
            ("empty", &["array 0: 's' has 0 components"]),
            ("nameless", &["array 0: the name is a null pointer"]),
            ("unknown", &["its scalar 'u' is none of its arrays"]),
            ("flags", &["flags that do not belong there: 0x40"]),
            ("shared", &["flags that do not belong there: 0x2"]),
            ("small", &["voltet_grid_head says that its size is 8 bytes, in place of 72"]),
            ("wild", &["voltet_array_head points to memory that is not there"]),
            ("backwards", &["times do not ascend: 1 after 2"]),
            ("not a time", &["a time is not finite"]),
            ("steps", &["'times' is a null pointer"]),
            ("silent", &["it did not say what the file holds"]),
            ("twice", &["it described its file twice"]),
            ("inspect", &["says: found line 7 is torn", file]),
        ],
    );
}

#[test]
fn what_a_reader_reads_wrongly_is_said() {
    said(
        "grid",
        "the reader 'faulty-reader'",
        &[
            ("few", &["did not write all of the array 's': found 1 of 5 numbers unset", "any.faulty"]),
            ("first", &["out of range: offsets[0]: found 1", "expected 0"]),
            ("order", &["out of range: offsets[2]: found 8", "at least 9, the one before"]),
            ("last", &["out of range: offsets[2]: found 7", "8, the count of the connectivity"]),
            ("far", &["out of range: connectivity_u32[6]: found 5", "a point number below 5"]),
            ("polyhedron", &["out of range: types[1]: found 42"]),
            ("type", &["out of range: types[1]: found 200"]),
            ("hexahedron", &["gave cell 1, a hexahedron, another number of points", "found 4", "expected 8"]),
            ("beyond points", &["wrote beyond the end of the points", "3 numbers for each of the 5 points"]),
            ("beyond types", &["wrote beyond the end of the types"]),
            ("beyond offsets", &["wrote beyond the end of the offsets", "3 of them"]),
            ("beyond cells", &["wrote beyond the end of the connectivity", "8 numbers"]),
            ("beyond array", &["wrote beyond the end of the array 's'"]),
            ("error", &["says: found line 7 is torn", "any.faulty"]),
            ("mute", &["failed and did not say why: found code 77"]),
            ("stopped", &["stopped, and nobody asked it to"]),
        ],
    );
}

#[test]
fn what_is_not_finite_in_a_file_is_left_out_and_counted_as_of_any_file() {
    let Some(folder) = folder() else { return };
    for (fault, wanted) in [
        ("not finite", "1 three-dimensional cell was left out because a position or value is not finite"),
        ("value", "1 three-dimensional cell was left out because a position or value is not finite"),
        ("notes", "(faulty.so): rounded to what the file holds at 3 points."),
    ] {
        for own_process in [&[][..], &["--plugin-process"]] {
            let set = format!("grid.fault={fault}");
            let ran = folder.voltet(&[&LOADED[..], &["--set", &set], own_process].concat()).ok();
            assert!(ran.stderr.contains(wanted), "{fault}: {}", ran.stderr);
        }
    }
}

#[test]
fn more_than_memory_holds_is_refused_before_it_is_taken() {
    let Some(folder) = folder() else { return };
    for node in ["grid", "moved"] {
        let set = format!("{node}.fault=much");
        for own_process in [&[][..], &["--plugin-process"]] {
            let start = Instant::now();
            let ran = folder.voltet(&[&LOADED[..], &["--set", &set], own_process].concat());
            ran.fails(1, &["memory ends", &format!("node '{node}'")]);
            assert!(start.elapsed() < Duration::from_secs(5));
        }
    }
}

#[test]
fn what_a_grid_filter_gives_wrongly_is_said() {
    said(
        "moved",
        "the grid filter 'faulty-grid'",
        &[
            ("silent", &["it did not begin one"]),
            ("twice", &["it began its grid twice"]),
            ("null", &["voltet_grid_buffers is a null pointer"]),
            ("counts", &["cell_count is 2, and its flags say that there are none to give"]),
            ("points", &["point_count is 5, and its flags say that there are none to give"]),
            ("fewer", &["it has 4 points and the input 5"]),
            ("other", &["did not give the array 's', which is asked for: found other, v"]),
            ("vector", &["names an array as the scalar that is none: found 'v' of 3 components"]),
            ("nothing", &["there is nothing to draw"]),
            ("not finite", &["a position that is not finite: found (inf, 0, 0) of point 1"]),
            ("far", &["out of range: tetrahedra[5]: found 5", "a point number below 5"]),
            ("input points", &["it wrote into the points, which it must leave as they are (element 0 of 5)"]),
            ("input cells", &["it wrote into the tetrahedra", "(element 1 of 2)"]),
            ("input arrays", &["it wrote into the values of the arrays", "(element 4 of 5)"]),
            ("input names", &["it wrote into the names of the arrays", "(element 0 of 2)"]),
            ("few", &["did not write all of the tetrahedra: found 1 of 8 numbers unset"]),
            ("beyond", &["wrote beyond the end of the tetrahedra", "4 numbers for each of the 2 cells"]),
            ("error", &["says: found line 7 is torn"]),
            ("mute", &["failed and did not say why: found code 77"]),
            ("stopped", &["stopped, and nobody asked it to"]),
        ],
    );
}

#[test]
fn what_an_image_filter_gives_wrongly_is_said() {
    said(
        "toned",
        "the image filter 'faulty-image'",
        &[
            (
                "few",
                &["did not give every pixel a colour: found 3 without, the first at column 13 of row 15"],
            ),
            ("not finite", &["gave a pixel that is none", "NaN", "at column 2 of row 0"]),
            ("opaque", &["gave a pixel that is none", "1.5", "opacity"]),
            ("input", &["it wrote into the pixels", "(element 255 of 256)"]),
            ("beyond", &["wrote beyond the end of the picture", "16 x 16 pixels"]),
            ("error", &["says: found line 7 is torn"]),
            ("mute", &["failed and did not say why: found code 77"]),
            ("stopped", &["stopped, and nobody asked it to"]),
        ],
    );
}

#[cfg(unix)]
#[test]
fn a_crash_is_said_to_be_the_plugins() {
    let Some(folder) = folder() else { return };
    for (node, whose) in [
        ("grid", "the reader 'faulty-reader'"),
        ("moved", "the grid filter 'faulty-grid'"),
        ("toned", "the image filter 'faulty-image'"),
    ] {
        let set = format!("{node}.fault=crash");
        let whole = format!("{whose} of the plug-in 'faulty nodes' (faulty.so)");
        let ran = folder.voltet(&[&LOADED[..], &["--set", &set]].concat());
        ran.fails(1, &["SIGABRT", &format!("in {whole}"), "--plugin-process"]);
        let ran = folder.voltet(&[&LOADED[..], &["--set", &format!("{node}.fault=exit")]].concat());
        ran.fails(1, &[&format!("a call of exit in {whole}"), "--plugin-process"]);
        let ran = folder.voltet(&[&LOADED[..], &["--set", &set, "--plugin-process"]].concat());
        ran.fails(1, &[&format!("{whole} crashed with signal 6 (SIGABRT)"), &format!("node '{node}'")]);
    }
}

#[cfg(unix)]
#[test]
fn what_never_ends_is_given_up() {
    let Some(folder) = folder() else { return };
    let stopped = |node: &str, own_process: &[&str]| {
        let set = format!("{node}.fault=endless");
        let mut command = folder.command(&[&LOADED[..], &["--set", &set], own_process].concat());
        let piped = std::process::Stdio::piped;
        let child = command.stderr(piped()).stdout(std::process::Stdio::null()).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(1500));
        let stop = std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(stop.unwrap().success());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(1));
        String::from_utf8(output.stderr).unwrap()
    };
    let said = stopped("moved", &[]);
    let wanted = "the grid filter 'faulty-grid' of the plug-in 'faulty nodes' (faulty.so) was asked to stop";
    assert!(said.contains(wanted), "{said}");
    for node in ["grid", "toned"] {
        let said = stopped(node, &["--plugin-process"]);
        assert!(said.contains("the run was stopped"), "{said}");
    }
}
