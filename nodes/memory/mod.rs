//! Memory: what a grid takes while it is read and drawn, what this process may still take, and the most that it took.
//!
//! What is taken was measured (largest resident memory of a run) on grids of 28 thousand to 6 million tetrahedra and follows
//! from the arrays that stand at the same time; `tests/program/memory.rs` holds the two against each other.

mod peak;

pub use peak::{forget_peak, peak};

use voltet_core::grid::{Cells, code};
use voltet_engine::drawing_bytes;

/// What the program takes before it has read anything: its code, its threads, and what they set aside.
const PROGRAM_BYTES: u64 = 30 << 20;
/// A point: its position and one scalar.
const POINT_BYTES: u64 = 32;
/// A tetrahedron: the numbers of its four points.
const TETRAHEDRON_BYTES: u64 = 16;
/// The number of the cell that it is a part of.
const SOURCE_BYTES: u64 = 4;
/// While overlapping cells are looked for: where the cells of a point begin, and how many there are; each cell twice.
const POINT_LOOKED_AT_BYTES: u64 = 12;
const TETRAHEDRON_LOOKED_AT_BYTES: u64 = 8;
/// The neighbours of a point, 14 on average, while `least-squares` solves for its gradient.
const NEIGHBOURS_BYTES: u64 = 64;
/// The gradient at a point, and its length.
const GRADIENT_BYTES: u64 = 32;
/// The picture that [`Needs`] speaks of, pixels along its sides.
pub const SIDE: u32 = 1024;

/// The size of a grid.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct GridSize {
    /// Its points.
    pub points: u64,
    /// Its tetrahedra.
    pub tetrahedra: u64,
    /// Bytes of the cells as they stand in the file, where they are split into tetrahedra.
    pub split: Option<u64>,
}

/// The most memory that a run takes, in bytes: the whole process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Reading the grid with one scalar.
    pub reading: u64,
    /// Drawing all of its cells by the scalar alone, [`SIDE`] × [`SIDE`] pixels.
    pub drawing: u64,
    /// The same by the scalar and the gradient magnitude, with light.
    pub lit: u64,
}

/// About how many tetrahedra a cell becomes.
fn tetrahedra_of(cell: u8) -> u64 {
    match cell {
        0..=9 | 21..=23 => 0,
        code::TETRA => 1,
        code::PYRAMID => 2,
        code::WEDGE => 3,
        code::QUADRATIC_TETRA => 8,
        code::QUADRATIC_HEXAHEDRON..=code::TRIQUADRATIC_PYRAMID => 32,
        _ => 6,
    }
}

impl GridSize {
    /// Adds the cells of a file, or of a piece of it.
    pub fn add(&mut self, cells: &Cells) {
        let (tetrahedra, bytes) = match cells {
            Cells::Tetrahedra(own) => (own.len() as u64, None),
            Cells::Mixed(set) => {
                let bytes = size_of_val(&set.connectivity[..])
                    + size_of_val(&set.offsets[..])
                    + size_of_val(&set.types[..]);
                (set.types.iter().map(|&cell| tetrahedra_of(cell)).sum(), Some(bytes as u64))
            }
            Cells::Structured(_) => (6 * cells.count() as u64, Some(0)),
        };
        self.tetrahedra = self.tetrahedra.saturating_add(tetrahedra);
        self.split = match (self.split, bytes) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(0).saturating_add(b.unwrap_or(0))),
        };
    }

    /// The grid in memory.
    pub fn bytes(&self) -> u64 {
        let tetrahedron = TETRAHEDRON_BYTES + if self.split.is_some() { SOURCE_BYTES } else { 0 };
        (self.points.saturating_mul(POINT_BYTES)).saturating_add(self.tetrahedra.saturating_mul(tetrahedron))
    }

    /// What reading takes beside the program itself: the grid, and the cells that it is made from or, after these, the
    /// look for cells that overlap.
    pub fn reading_bytes(&self) -> u64 {
        let looking = self.points.saturating_mul(POINT_LOOKED_AT_BYTES);
        let looking = looking.saturating_add(self.tetrahedra.saturating_mul(TETRAHEDRON_LOOKED_AT_BYTES));
        self.bytes().saturating_add(looking.max(self.split.unwrap_or(0)))
    }

    /// What a run takes.
    pub fn needs(&self) -> Needs {
        let grid = PROGRAM_BYTES.saturating_add(self.bytes());
        let drawn = |attributes| drawing_bytes(self.tetrahedra, self.points, attributes, [SIDE; 2]);
        let reading = PROGRAM_BYTES.saturating_add(self.reading_bytes());
        let gradient = self.points.saturating_mul(GRADIENT_BYTES);
        let solving = self.points.saturating_mul(GRADIENT_BYTES + NEIGHBOURS_BYTES);
        let drawing = reading.max(grid.saturating_add(drawn(1)));
        // s, g and the three components of ∇s.
        let lit = gradient.saturating_add(drawn(5)).max(solving);
        Needs { reading, drawing, lit: drawing.max(grid.saturating_add(lit)) }
    }
}

/// Bytes that this process may still take: what the system has left, and what limits on the process leave of it. `None` where
/// the system does not tell.
pub fn left() -> Option<u64> {
    [available(), group(), address_space()].into_iter().flatten().min()
}

/// What Linux has for new work without swapping.
fn available() -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// What the control groups of the process leave (version 2: every group up to the root; version 1: the one that is mounted).
fn group() -> Option<u64> {
    let of_process = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let own = of_process.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let root = std::path::Path::new("/sys/fs/cgroup");
    let own = root.join(own);
    let groups = own.ancestors().take_while(|folder| folder.starts_with(root));
    let second = groups.filter_map(|folder| rest(folder, "memory.max", "memory.current", "inactive_file"));
    let first =
        rest(&root.join("memory"), "memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file");
    second.chain(first).min()
}

/// What one group leaves; files kept in memory that nobody uses give way.
fn rest(folder: &std::path::Path, limit: &str, used: &str, idle: &str) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let limit: u64 = read(limit)?.trim().parse().ok()?;
    let used: u64 = read(used)?.trim().parse().ok()?;
    let statistics = read("memory.stat").unwrap_or_default();
    let idle =
        statistics.lines().find_map(|line| line.strip_prefix(idle)?.trim().parse().ok()).unwrap_or(0u64);
    Some(limit.saturating_sub(used.saturating_sub(idle)))
}

/// What the limit on the address space (`ulimit -v`) leaves.
fn address_space() -> Option<u64> {
    let limits = std::fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits.lines().find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let used = kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmSize:")?;
    Some(limit.saturating_sub(used))
}

/// The number of a line such as "VmSize:  1024 kB", in bytes.
fn kibibytes(text: &str, key: &str) -> Option<u64> {
    let line = text.lines().find_map(|line| line.strip_prefix(key))?;
    line.split_whitespace().next()?.parse::<u64>().ok()?.checked_mul(1024)
}
