//! Files that other programs wrote (`files/make_*.py`), unpacked; and comparisons of what is read of them.

use flate2::read::GzDecoder;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use voltet_core::grid::{Association, Grid};
use voltet_core::progress::{NoProgress, Progress};
use voltet_io::formats::{Request, TimeStep, read};

/// A folder of all files, those that are packed without their ending `.gz`.
static FOLDER: LazyLock<tempfile::TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    for entry in Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").read_dir().unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap();
        let to = folder.path().join(name.strip_suffix(".gz").unwrap_or(name));
        if path.extension().is_some_and(|ending| ending == "gz") {
            let mut unpacked = GzDecoder::new(File::open(&path).unwrap());
            std::io::copy(&mut unpacked, &mut File::create(to).unwrap()).unwrap();
        } else if path.is_file() {
            std::fs::copy(&path, to).unwrap();
        }
    }
    folder
});

/// Progress of a process that may take so many bytes.
pub struct MemoryLeft(pub u64);

impl Progress for MemoryLeft {
    fn report(&self, _stage: &str, _fraction: f64) {}

    fn memory_left(&self) -> Option<u64> {
        Some(self.0)
    }
}

pub fn path(name: &str) -> PathBuf {
    FOLDER.path().join(name)
}

pub fn request(scalar: &str) -> Request {
    Request { scalar: Some(scalar.to_owned()), ..Request::default() }
}

pub fn grid(name: &str, request: &Request) -> Grid {
    read(&path(name), request, &NoProgress).unwrap_or_else(|error| panic!("{name}: {error}"))
}

pub fn grid_at(name: &str, scalar: &str, step: usize) -> Grid {
    grid(name, &Request { time_step: Some(TimeStep::Index(step)), ..request(scalar) })
}

/// The formula of `files/meshes.py`.
pub fn field([x, y, z]: [f64; 3]) -> f64 {
    1.0 + x + 2.0 * y * y - 3.0 * z * y + 0.5 * x * z
}

/// Values at each point by the formula of its position; single precision rounds values below 100 by 4e-6.
pub fn follow(grid: &Grid, formula: impl Fn([f64; 3]) -> f64, what: &str) {
    let scalar = grid.scalar.as_ref().unwrap();
    for (point, &value) in grid.points.iter().zip(scalar.iter()) {
        let expected = formula(point.to_array());
        assert!(
            (value - expected).abs() < 1e-5 * expected.abs().max(1.0),
            "{what}: {value} {expected} at {point}"
        );
    }
    assert!(!grid.points.is_empty(), "{what}");
}

/// The same points, tetrahedra and values; files may hold single precision.
pub fn same(found: &Grid, expected: &Grid, what: &str) {
    assert_eq!(found.points.len(), expected.points.len(), "{what}");
    for (a, b) in found.points.iter().zip(expected.points.iter()) {
        assert!(a.distance(*b) < 1e-6, "{what}: {a} {b}");
    }
    assert!(found.tetrahedra == expected.tetrahedra, "{what}: other tetrahedra");
    let values = |grid: &Grid| grid.scalar.as_ref().unwrap().to_vec();
    for (a, b) in values(found).iter().zip(values(expected)) {
        assert!((a - b).abs() < 1e-6 * b.abs().max(1.0), "{what}: {a} {b}");
    }
}

/// The same grids by a point array, a component of another and a cell array.
pub fn same_files(name: &str, truth: &str) {
    for (scalar, association) in [("s", None), ("v:1", None), ("c", Some(Association::Cell))] {
        let request = Request { association, ..request(scalar) };
        same(&grid(name, &request), &grid(truth, &request), &format!("{name} {scalar}"));
    }
}
