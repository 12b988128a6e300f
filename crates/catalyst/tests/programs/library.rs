//! The library with Conduit's functions, and pipelines of the tests.

use crate::tree::Tree;
use libloading::os::unix::{Library, RTLD_GLOBAL, RTLD_NOW};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};
use voltet::{Grid, Pipeline};
use voltet_core::picture::Picture;
use voltet_graph::ranks::OneRank;
use voltet_testing::compilers;

/// Variable that names the real libcatalyst.
const REAL: &str = "VOLTET_CATALYST";

/// The library that programs are linked with, once it is loaded for this process; `None` without a compiler, which was said.
pub fn library() -> Option<&'static Path> {
    static LIBRARY: OnceLock<Option<PathBuf>> = OnceLock::new();
    LIBRARY.get_or_init(load).as_deref()
}

/// The real libcatalyst, where the tests run with it.
pub fn real() -> Option<PathBuf> {
    std::env::var_os(REAL).map(PathBuf::from)
}

fn load() -> Option<PathBuf> {
    let path = match real() {
        Some(path) => path,
        None => {
            eprintln!("\n*** SKIPPED: {REAL} names no libcatalyst; the tests run with a stand-in ***\n");
            let folder = tempfile::tempdir().unwrap().keep();
            let source = compilers::source("crates/catalyst/tests/c/stand_in.c");
            let header = source.parent().unwrap().to_str().unwrap();
            compilers::library(
                &folder,
                "libcatalyst.so",
                std::slice::from_ref(&source),
                &["-I", header, "-ldl"],
            )?
        }
    };
    // SAFETY: a library of C whose loading does nothing.
    std::mem::forget(unsafe { Library::open(Some(&path), RTLD_NOW | RTLD_GLOBAL) }.unwrap());
    Some(path)
}

/// A pipeline that draws the scalar of the node `grid`, with widgets over s and g.
pub const PIPELINE: &str = r#"[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "mesh.vtu"
scalar = "T"

[nodes.gradient]
type = "gradient-magnitude"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
inputs = { volume = "gradient" }
unit_distance = 1.0

[[nodes.look.widgets]]
kind = "gaussian"
centre = [0.5, 1.0]
sigma = [0.3, 1.5]
color = [1.0, 0.4, 0.1]
extinction = 5.0

[nodes.view]
type = "camera"
eye = [4.0, -3.0, 2.5]
target = [0.6, 0.5, 0.5]
size = [48, 40]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.file]
type = "image-writer"
path = "{step:03}.exr"
inputs = { image = "picture" }
"#;

/// A folder with a pipeline, `scene.toml`.
pub fn folder(pipeline: &str) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("scene.toml"), pipeline).unwrap();
    folder
}

/// The tree of a call of `catalyst_initialize` for the pipeline of a folder.
pub fn start(folder: &Path) -> Tree {
    Tree::new().text("catalyst/scripts/picture", folder.join("scene.toml").to_str().unwrap())
}

/// A step's tree, whose channel `grid` holds a mesh that `describe` adds.
pub fn step(number: i64, describe: impl FnOnce(Tree) -> Tree) -> Tree {
    let tree = Tree::new().int64("catalyst/state/timestep", number);
    let tree = tree.float64("catalyst/state/time", 0.25 * number as f64);
    describe(tree.text("catalyst/channels/grid/type", "mesh").within("catalyst/channels/grid/data"))
        .within("")
}

/// The picture of a mesh, drawn by a simulation of one step; the error otherwise.
pub fn drawn(pipeline: &str, describe: impl FnOnce(Tree) -> Tree) -> voltet::Result<Picture> {
    let folder = folder(pipeline);
    let mut simulation = start(folder.path()).simulation(Arc::new(OneRank))?;
    step(7, describe).execute(&mut simulation)?;
    Ok(picture(&folder.path().join("007.exr")))
}

/// A picture that was written.
#[track_caller]
pub fn picture(path: &Path) -> Picture {
    voltet::io::encode::read_picture(path).unwrap().0
}

/// The picture of a grid that the library's user gives.
pub fn truth(pipeline: &str, grid: Grid) -> Picture {
    let mut pipeline = Pipeline::parse(pipeline, "").unwrap().with_grid("grid", grid).unwrap();
    let image = pipeline.render("picture").unwrap();
    let picture = Picture { width: image.width(), height: image.height(), rgba: image.pixels().to_vec() };
    assert!(picture.rgba.iter().any(|pixel| pixel[3] > 0.1), "something is seen");
    picture
}

/// Fails where pictures differ in a bit.
#[track_caller]
pub fn assert_same(one: &Picture, other: &Picture) {
    assert_eq!([one.width, one.height], [other.width, other.height]);
    let differing = one.rgba.iter().zip(&other.rgba).filter(|(a, b)| a != b).count();
    assert_eq!(differing, 0, "pixels differ");
}
