//! Outputs that would overwrite what a call reads or writes: refused before anything runs, by one error that names both
//! places.

use super::support::{Folder, SLAB};
use std::collections::BTreeMap;
use std::path::Path;

/// Every file below a folder, with its content.
fn contents(folder: &Path) -> BTreeMap<std::path::PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        match path.is_dir() {
            true => found.extend(contents(&path)),
            false => drop(found.insert(path.clone(), std::fs::read(&path).unwrap_or_default())),
        }
    }
    found
}

/// Asserts that the command is refused with exit code 2 and one error that says all of this, and that no file changed.
#[track_caller]
fn refused(folder: &Folder, command: &[&str], wanted: &[&str]) {
    let before = contents(folder.path());
    folder.voltet(command).fails(2, wanted);
    assert!(contents(folder.path()) == before, "{command:?} changed a file");
}

const OVERWRITES: &str = "this output would overwrite what the call reads";
const ONE_FILE: &str = "two outputs of this call are one file";

#[test]
fn a_report_onto_what_the_run_reads_or_writes_is_refused() {
    let folder = Folder::new();
    let run = |path| ["run", "slab.toml", "--report", path];
    let reads_pipeline = "the program, as a pipeline file, reads";
    refused(&folder, &run("slab.toml"), &[OVERWRITES, reads_pipeline, "(--report slab.toml)"]);
    let reads_data = "'path' of the node 'grid' (slab.toml:7:8) reads";
    refused(&folder, &run("cube.vtu"), &[OVERWRITES, reads_data, "(--report cube.vtu)"]);
    refused(
        &folder,
        &run("./cube.vtu"),
        &[OVERWRITES, "found './cube.vtu', the same file as 'cube.vtu'", reads_data],
    );
    let writes = "which 'path' of the node 'file' (slab.toml:39:8) writes, too";
    // The picture is not there yet.
    refused(&folder, &run("slab.exr"), &[ONE_FILE, writes, "(--report slab.exr)"]);
    folder.voltet(&["run", "slab.toml"]).ok();
    refused(&folder, &run("slab.exr"), &[ONE_FILE, writes]);
}

#[test]
fn start_writes_over_no_data_and_no_picture() {
    let folder = Folder::new();
    let start = |path| ["start", "cube.vtu", "-o", path, "--force"];
    for path in ["cube.vtu", "./cube.vtu"] {
        refused(&folder, &start(path), &["would overwrite data", path, "cube.toml"]);
    }
    refused(&folder, &start("cube.png"), &["not its picture", "cube.toml"]);
    let named = |file: &str| {
        format!("<VTKFile type=\"Collection\"><Collection><DataSet file=\"{file}\"/></Collection></VTKFile>")
    };
    folder.write("series.pvd", named("cube.vtu"));
    refused(&folder, &["start", "series.pvd", "-o", "cube.vtu", "--force"], &["would overwrite data"]);
}

#[cfg(unix)]
#[test]
fn links_are_the_files_that_they_lead_to() {
    let folder = Folder::new();
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, folder.join(name)).unwrap();
    let run = |path| ["run", "slab.toml", "--report", path];
    link("cube.vtu", "soft");
    std::fs::hard_link(folder.join("cube.vtu"), folder.join("hard")).unwrap();
    refused(&folder, &run("soft"), &[OVERWRITES, "'soft', the same file as 'cube.vtu'", "(slab.toml:7:8)"]);
    refused(&folder, &run("hard"), &[OVERWRITES, "'hard', the same file as 'cube.vtu'"]);
    link("slab.exr", "not there yet");
    refused(&folder, &run("not there yet"), &[ONE_FILE, "'not there yet', the same file as 'slab.exr'"]);
    link(".", "here");
    refused(&folder, &run("here/slab.exr"), &[ONE_FILE]);
    refused(
        &folder,
        &["run", "here/slab.toml", "--report", "slab.exr"],
        &[ONE_FILE, "(here/slab.toml:39:8)"],
    );
}

#[test]
fn a_picture_that_a_widget_reads_is_not_written_over() {
    let folder = Folder::new();
    image::RgbaImage::from_pixel(2, 2, image::Rgba([9, 9, 9, 255])).save(folder.join("table.png")).unwrap();
    let table = "kind = \"table\"\nimage = \"table.png\"\ns = [-1.0, 2.0]\ng = [0.0, 2.0]";
    let text = SLAB.replace("kind = \"uniform\"", table).replace("region = { s = [-1.0, 2.0] }\n", "");
    folder.write("slab.toml", text.replace("slab.exr", "../table.png"));
    let there = format!("../{}/table.png", folder.path().file_name().unwrap().to_str().unwrap());
    let option = format!("file.path={there}");
    let wanted =
        [OVERWRITES, "'image' of the node 'look' (slab.toml:21:9) reads", "(--set file.path=", "node 'file'"];
    for command in ["run", "check", "explain"] {
        refused(&folder, &[command, "slab.toml", "--set", &option], &wanted);
    }
    folder.write(
        "slab.toml",
        std::fs::read_to_string(folder.join("slab.toml")).unwrap().replace("../table.png", &there),
    );
    refused(&folder, &["run", "slab.toml"], &[OVERWRITES, "slab.toml:41:8", "^", "(slab.toml:21:9)"]);
}

#[test]
fn two_writers_of_one_file_are_refused_within_a_pipeline_and_across_them() {
    let folder = Folder::new();
    let second =
        "[nodes.again]\ntype = \"image-writer\"\npath = \"./slab.exr\"\ninputs = { image = \"picture\" }\n";
    folder.write("two.toml", format!("{SLAB}\n{second}"));
    let wanted = [
        ONE_FILE,
        "'slab.exr', which 'path' of the node 'file' (two.toml:39:8) writes, too",
        "two.toml:44:8",
        "node 'again'",
    ];
    refused(&folder, &["run", "two.toml"], &wanted);
    folder.write("other.toml", SLAB);
    let across = ["'path' of the node 'file' (slab.toml:39:8) writes, too", "other.toml:39:8", ONE_FILE];
    refused(&folder, &["run", "slab.toml", "other.toml"], &across);
    refused(&folder, &["run", "slab.toml", "slab.toml"], &[ONE_FILE]);
    // Each is in order by itself.
    folder.voltet(&["check", "slab.toml", "other.toml"]).ok();
    // One pipeline's picture is another's data.
    let reads = SLAB
        .replace("cube.vtu", "slab.exr")
        .replace("path = \"slab.exr\"\ninputs", "path = \"b.exr\"\ninputs");
    folder.write("other.toml", reads);
    refused(
        &folder,
        &["run", "slab.toml", "other.toml"],
        &[OVERWRITES, "(other.toml:7:8) reads", "slab.toml:39:8"],
    );
}

#[test]
fn a_study_writes_over_nothing_that_it_reads() {
    let folder = Folder::new();
    std::fs::create_dir_all(folder.join("slab.study/differences")).unwrap();
    let copy = |name: &str| std::fs::copy(folder.join("cube.vtu"), folder.join(name)).unwrap();
    for name in ["slab.study/study.csv", "slab.study/differences/a.png"] {
        copy(name);
        let option = format!("grid.path={name}");
        refused(
            &folder,
            &["study", "slab.toml", "--set", &option],
            &[OVERWRITES, "(--output slab.study/", "'path' of the node 'grid'"],
        );
    }
}

#[test]
fn files_that_the_data_name_are_read_too() {
    let folder = Folder::new();
    let pieces = "<VTKFile type=\"PUnstructuredGrid\"><PUnstructuredGrid><Piece Source=\"cube.vtu\"/></PUnstructuredGrid></VTKFile>";
    folder.write("cube.pvtu", pieces);
    let series = "<VTKFile type=\"Collection\"><Collection><DataSet timestep=\"0\" file=\"cube.pvtu\"/></Collection></VTKFile>";
    folder.write("cube.pvd", series);
    for (data, onto) in [("cube.pvtu", "cube.vtu"), ("cube.pvd", "cube.pvtu"), ("cube.pvd", "./cube.vtu")] {
        let option = format!("grid.path={data}");
        let part = format!("which the program, as a part of the data file '{data}', reads");
        let command = ["run", "slab.toml", "--set", &option, "--report", onto];
        refused(&folder, &command, &[OVERWRITES, &part]);
    }
    folder.voltet(&["run", "slab.toml", "--set", "grid.path=cube.pvd", "--report", "r.json"]).ok();
}
