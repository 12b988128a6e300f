//! Shipped files work: every pipeline file checks and draws.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn voltet(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_voltet")).args(arguments).output().expect("the program starts")
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn pipelines() -> Vec<PathBuf> {
    let of = |folder: &str| std::fs::read_dir(root().join(folder)).expect("the folder of pipelines");
    let folders = of("pipelines").chain(of("lab/pipelines/papers"));
    let mut files: Vec<PathBuf> = folders.map(|entry| entry.expect("a folder entry").path()).collect();
    files.retain(|path| path.extension().is_some_and(|ending| ending == "toml"));
    files.sort();
    assert!(files.len() >= 5, "the pipelines that ship are gone: {files:?}");
    files
}

fn assert_done(output: &Output, what: &str) {
    assert!(output.status.success(), "{what}: {}", String::from_utf8_lossy(&output.stderr));
}

#[test]
fn every_pipeline_checks() {
    for path in pipelines() {
        let path = path.to_str().unwrap();
        assert_done(&voltet(&["check", path]), path);
    }
}

/// It writes a grid.
const WITHOUT_PICTURE: &str = "gradient_for_others";

#[test]
fn every_pipeline_draws_something() {
    let folder = tempfile::tempdir().unwrap();
    for path in pipelines() {
        let stem = path.file_stem().unwrap().to_str().unwrap();
        if stem == WITHOUT_PICTURE {
            continue;
        }
        let png = folder.path().join(format!("{stem}.png"));
        let to = |node: &str, name: &str| format!("{node}.path={}", folder.path().join(name).display());
        let mut options = vec![format!("file.path={}", png.display())];
        // A histogram has no camera: its bins are the pixels.
        options.extend(match stem {
            "histogram" => ["plane.bins=[48,36]", "plane.magnify=1"].map(String::from).to_vec(),
            _ => vec!["view.size=[48,36]".into()],
        });
        match stem {
            "stages" => options.push(to("linear", "linear.exr")),
            "histogram" => options.push(to("table", "table.csv")),
            _ => {}
        }
        let mut arguments = vec!["run", path.to_str().unwrap()];
        arguments.extend(options.iter().flat_map(|option| ["--set", option]));
        assert_done(&voltet(&arguments), stem);
        let picture = image::open(&png).unwrap().to_rgb8();
        assert_eq!(picture.dimensions(), (48, 36), "{stem}");
        let drawn = picture.pixels().filter(|pixel| pixel.0.iter().any(|&channel| channel > 40)).count();
        assert!(drawn > 48 * 36 / 50, "{stem}: {drawn} pixels are not dark");
    }
}

#[test]
fn the_gradient_for_other_programs_is_written_on_the_cells_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let written = folder.path().join("out.vtu");
    let path = root().join(format!("pipelines/{WITHOUT_PICTURE}.toml"));
    let to = format!("file.path={}", written.display());
    assert_done(&voltet(&["run", path.to_str().unwrap(), "--set", &to]), WITHOUT_PICTURE);
    let info = voltet(&["info", written.to_str().unwrap()]);
    assert_done(&info, "info");
    let info = String::from_utf8_lossy(&info.stdout).to_string();
    for wanted in ["214,020 cells", "Temperature_gradient_magnitude", "Temperature_gradient", "culled"] {
        assert!(info.contains(wanted), "{wanted}: {info}");
    }
}
