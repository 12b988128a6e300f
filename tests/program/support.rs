//! A folder with a grid and a pipeline, and the program run in it.

use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The unit cube of n × n × n hexahedra as an ASCII .vtu. Point arrays: `x` (the coordinate), `gradient` (its
/// gradient, (1, 0, 0)), `y` and `ones`; cell array `layer` (number of the cell along x).
pub fn cube(n: usize) -> String {
    cube_of(n, "x", |x| x)
}

/// Cube with a function of the coordinate under a name in place of `x`.
pub fn cube_of(n: usize, scalar: &str, of: impl Fn(f64) -> f64) -> String {
    let points: Vec<[usize; 3]> = grid(n + 1);
    let position = |p: &[usize; 3]| p.map(|c| c as f64 / n as f64);
    let list = |values: Vec<String>| values.join(" ");
    let array = |name: &str, components: usize, values: String| {
        format!(
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"ascii\">\
             {values}</DataArray>\n"
        )
    };
    let per_point =
        |value: &dyn Fn([f64; 3]) -> String| list(points.iter().map(|p| value(position(p))).collect());
    let number = |p: [usize; 3]| p[0] + (n + 1) * (p[1] + (n + 1) * p[2]);
    let mut connectivity = String::new();
    for [i, j, k] in grid(n) {
        let corners =
            [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]];
        for [a, b, c] in corners {
            write!(connectivity, "{} ", number([i + a, j + b, k + c])).unwrap();
        }
    }
    let cells = n * n * n;
    let offsets = list((1..=cells).map(|i| (8 * i).to_string()).collect());
    let types = list(vec!["12".to_string(); cells]);
    let layers = list(grid(n).iter().map(|c| c[0].to_string()).collect());
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\">\n<UnstructuredGrid>\n<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">\n",
        points.len()
    );
    text += "<PointData>\n";
    text += &array(scalar, 1, per_point(&|p| of(p[0]).to_string()));
    text += &array("y", 1, per_point(&|p| p[1].to_string()));
    text += &array("ones", 1, per_point(&|_| "1".into()));
    text += &array("gradient", 3, per_point(&|_| "1 0 0".into()));
    text += "</PointData>\n<CellData>\n";
    text += &array("layer", 1, layers);
    text += "</CellData>\n<Points>\n";
    text += &array("Points", 3, per_point(&|p| format!("{} {} {}", p[0], p[1], p[2])));
    text += "</Points>\n<Cells>\n";
    let integers = |name: &str, number_type: &str, values: &str| {
        format!("<DataArray type=\"{number_type}\" Name=\"{name}\" format=\"ascii\">{values}</DataArray>\n")
    };
    text += &integers("connectivity", "Int64", connectivity.trim());
    text += &integers("offsets", "Int64", &offsets);
    text += &integers("types", "UInt8", &types);
    text + "</Cells>\n</Piece>\n</UnstructuredGrid>\n</VTKFile>\n"
}

/// The places of an n × n × n lattice, x fastest.
fn grid(n: usize) -> Vec<[usize; 3]> {
    let mut places = Vec::new();
    for k in 0..n {
        for j in 0..n {
            places.extend((0..n).map(|i| [i, j, k]));
        }
    }
    places
}

/// The cube seen along x, filled evenly: opacity 1 − e^(−2) wherever it is hit.
pub const SLAB: &str = r#"[pipeline]
format = 1
title = "An even slab"

[nodes.grid]
type = "reader"
path = "cube.vtu"
scalar = "x"

[nodes.gradient]
type = "gradient-magnitude"
method = "least-squares"
inputs = { grid = "grid" }

[nodes.look]
type = "transfer-function"
unit_distance = 0.5

[[nodes.look.widgets]]
kind = "uniform"
color = [0.5, 1.0, 0.25]
extinction = 1.0
region = { s = [-1.0, 2.0] }

[nodes.view]
type = "camera"
eye = [-3.0, 0.5, 0.5]
target = [0.5, 0.5, 0.5]
up = [0.0, 0.0, 1.0]
height = 2.0
size = [8, 8]

[nodes.picture]
type = "renderer"
inputs = { volume = "gradient", transfer_function = "look", camera = "view" }

[nodes.file]
type = "image-writer"
path = "slab.exr"
inputs = { image = "picture" }
"#;

/// A folder of its own, removed at the end.
pub struct Folder(tempfile::TempDir);

impl Folder {
    /// With `cube.vtu` (3 × 3 × 3 cells) and the pipeline `slab.toml`.
    pub fn new() -> Self {
        let folder = Folder(tempfile::tempdir().unwrap());
        folder.write("cube.vtu", cube(3));
        folder.write("slab.toml", SLAB);
        folder
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn join(&self, name: &str) -> PathBuf {
        self.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.join(name), content).unwrap();
    }

    /// The names of the files, sorted.
    pub fn names(&self) -> Vec<String> {
        let entries = std::fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    /// The program in this folder, to be run.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_voltet"));
        // What is remembered of devices stays out of the user's own folder.
        command.env("XDG_CACHE_HOME", concat!(env!("CARGO_TARGET_TMPDIR"), "/cache"));
        // Nor is what the user configured theirs.
        command.env("XDG_CONFIG_HOME", concat!(env!("CARGO_TARGET_TMPDIR"), "/configuration"));
        command.current_dir(self.path()).args(arguments).env("NO_COLOR", "1");
        command
    }

    /// Runs the program in this folder.
    pub fn voltet(&self, arguments: &[&str]) -> Ran {
        Ran::new(arguments, self.command(arguments).output().unwrap())
    }

    /// Runs the program with an environment variable set.
    pub fn voltet_where(&self, (variable, value): (&str, &str), arguments: &[&str]) -> Ran {
        Ran::new(arguments, self.command(arguments).env(variable, value).output().unwrap())
    }

    /// The floats of an .exr.
    pub fn floats(&self, name: &str) -> (usize, Vec<[f32; 4]>) {
        let image = image::open(self.join(name)).unwrap().into_rgba32f();
        (image.width() as usize, image.pixels().map(|p| p.0).collect())
    }

    /// Entry of a report's only run.
    pub fn report(&self, name: &str) -> serde_json::Value {
        let mut whole = self.json(name);
        assert_eq!(whole["runs"].as_array().unwrap().len(), 1);
        whole["runs"][0].take()
    }

    /// A JSON file.
    pub fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.join(name)).unwrap()).unwrap()
    }
}

/// Outcome of the program.
pub struct Ran {
    pub command: String,
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl Ran {
    fn new(arguments: &[&str], output: Output) -> Self {
        let ran = Ran {
            command: format!("voltet {}", arguments.join(" ")),
            code: output.status.code().expect("the program was not killed"),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        };
        assert!(!ran.stderr.contains("a mistake of the program itself"), "{}: {}", ran.command, ran.stderr);
        ran
    }

    /// Asserts success.
    #[track_caller]
    pub fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{}: {}", self.command, self.stderr);
        self
    }

    /// Outcome of a run with `--adapter software`; `None` where there is no such driver, said loudly; a failure if the
    /// environment variable `VOLTET_REQUIRE_GPU` is 1.
    #[cfg(feature = "gpu")]
    pub fn on_software_driver(self) -> Option<Self> {
        if !self.stderr.contains("no adapter is called \"software\"") {
            return Some(self.ok());
        }
        voltet_testing::skipped_without_device(&self.stderr);
        None
    }

    /// Number of errors shown.
    pub fn errors(&self) -> usize {
        self.stderr.lines().filter(|line| line.trim_start().starts_with("error:")).count()
    }

    /// Asserts failure with this exit code, and one error that says all of this.
    #[track_caller]
    pub fn fails(self, code: i32, wanted: &[&str]) -> Self {
        assert_eq!(self.code, code, "{}: {}", self.command, self.stderr);
        assert_eq!(self.errors(), 1, "{}: {}", self.command, self.stderr);
        for text in wanted {
            assert!(self.stderr.contains(text), "{}: '{text}' is not in\n{}", self.command, self.stderr);
        }
        self
    }
}
