//! Memory: what a grid takes while it is read and drawn, what this process may still take, and the most that it took.
//!
//! What is taken was measured (largest resident memory of a run) on grids of 28 thousand to 6 million tetrahedra and follows
//! from the arrays that stand at the same time; `tests/program/memory.rs` holds the two against each other.

use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet_core::grid::{CellType, Cells, code};

/// A point: its position and one scalar.
const POINT_BYTES: u64 = 32;
/// A tetrahedron: the numbers of its four points.
const TETRAHEDRON_BYTES: u64 = 16;
/// The number of the cell that it is a part of.
const SOURCE_BYTES: u64 = 4;
/// While overlapping cells are looked for: where the cells of a point begin, and how many there are; each cell twice.
const POINT_LOOKED_AT_BYTES: u64 = 12;
const TETRAHEDRON_LOOKED_AT_BYTES: u64 = 8;

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

/// Types of cells with a volume, their corners, and about how many tetrahedra they become; quadratic ones at one subdivision.
const SPLIT: [(u8, u64, u64); 7] = [
    (code::TETRA, 4, 1),
    (code::PYRAMID, 5, 2),
    (code::WEDGE, 6, 3),
    (code::HEXAHEDRON, 8, 6),
    (code::QUADRATIC_TETRA, 10, 8),
    (code::QUADRATIC_HEXAHEDRON, 20, 32),
    (code::TRIQUADRATIC_HEXAHEDRON, 27, 32),
];

/// Most corners of a cell that is no polyhedron, but for those of higher degrees.
pub(crate) const MAX_CORNERS: f64 = SPLIT[SPLIT.len() - 1].1 as f64;

/// About how many tetrahedra a cell of any type becomes, by its corners or by the mean of those of several cells: as many as cells of
/// the types with so many do. A polyhedron that is split at one of its corners becomes about as many.
pub(crate) fn tetrahedra_by_corners(corners: f64) -> f64 {
    let mut before = (3.0, 0.0);
    for (_, after, most) in SPLIT.map(|(code, corners, count)| (code, corners as f64, count as f64)) {
        if corners <= after {
            let share = ((corners - before.0) / (after - before.0)).max(0.0);
            return before.1 + (most - before.1) * share;
        }
        before = (after, most);
    }
    // A closed surface of n corners has 2n - 4 triangles.
    before.1 + 2.0 * (corners - before.0)
}

/// About how many tetrahedra a cell of a type becomes.
fn tetrahedra_of(cell: u8, corners: u64) -> u64 {
    match SPLIT.iter().find(|known| known.0 == cell) {
        Some(known) => known.2,
        None if CellType::from_code(cell).is_some_and(|cell| cell.dimension < 3) => 0,
        None => tetrahedra_by_corners(corners as f64).round() as u64,
    }
}

impl GridSize {
    /// Adds the cells of a file, or of a piece of it.
    pub fn add(&mut self, cells: &Cells) {
        let (tetrahedra, bytes) = match cells {
            Cells::Tetrahedra(own) => (own.len() as u64, None),
            Cells::Mixed(set) => {
                // Faces of polyhedra as a stream has them.
                let faces = set.polyhedra.iter().flat_map(|polyhedron| &polyhedron.faces);
                let bytes = size_of_val(&set.connectivity[..])
                    + size_of_val(&set.offsets[..])
                    + size_of_val(&set.types[..])
                    + faces.map(|face| size_of::<u32>() * (1 + face.len())).sum::<usize>();
                let corners = set.offsets.windows(2).map(|ends| ends[1].saturating_sub(ends[0]));
                let tetrahedra = set.types.iter().zip(corners).map(|(&cell, own)| tetrahedra_of(cell, own));
                (tetrahedra.sum(), Some(bytes as u64))
            }
            Cells::Structured(_) => ((cells.count() as u64).saturating_mul(6), Some(0)),
        };
        self.add_size(&GridSize { points: 0, tetrahedra, split: bytes });
    }

    /// Adds the size of another piece.
    pub fn add_size(&mut self, other: &GridSize) {
        self.points = self.points.saturating_add(other.points);
        self.tetrahedra = self.tetrahedra.saturating_add(other.tetrahedra);
        self.split = match (self.split, other.split) {
            (None, None) => None,
            (a, b) => Some(a.unwrap_or(0).saturating_add(b.unwrap_or(0))),
        };
    }

    /// The grid in memory.
    pub fn bytes(&self) -> u64 {
        let tetrahedron = TETRAHEDRON_BYTES + if self.split.is_some() { SOURCE_BYTES } else { 0 };
        (self.points.saturating_mul(POINT_BYTES)).saturating_add(self.tetrahedra.saturating_mul(tetrahedron))
    }

    /// Bytes that reading takes beside the program itself: the grid, and the cells that it is made from or, after these, the
    /// look for cells that overlap.
    pub fn reading_bytes(&self) -> u64 {
        let looking = self.points.saturating_mul(POINT_LOOKED_AT_BYTES);
        let looking = looking.saturating_add(self.tetrahedra.saturating_mul(TETRAHEDRON_LOOKED_AT_BYTES));
        self.bytes().saturating_add(looking.max(self.split.unwrap_or(0)))
    }
}

/// Time for which an answer of the system stands: a file of many pieces asks for each.
const ANSWER_STANDS: Duration = Duration::from_millis(100);

/// Bytes that this process may still take, as of at most 100 ms ago: what the system has left, and what limits on the process leave
/// of it. `None` where the system does not tell.
pub fn available() -> Option<u64> {
    static LAST: Mutex<Option<(Instant, Option<u64>)>> = Mutex::new(None);
    let mut last = LAST.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, answer)) = last.filter(|(at, _)| at.elapsed() < ANSWER_STANDS) {
        return answer;
    }
    // Not by `flatten`: the compiler compares the undefined half of `None`, and tools that look at memory say so.
    let least = [system_available(), group(), address_space()]
        .into_iter()
        .fold(u64::MAX, |least, known| least.min(known.unwrap_or(u64::MAX)));
    let answer = (least < u64::MAX).then_some(least);
    *last = Some((Instant::now(), answer));
    answer
}

/// Memory that Linux has for new work without swapping.
fn system_available() -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/meminfo").ok()?, "MemAvailable:")
}

/// Memory that the process's control groups leave (version 2: every group up to the root; version 1: the mounted one).
fn group() -> Option<u64> {
    let of_process = std::fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let own = of_process.lines().find_map(|line| line.strip_prefix("0::/")).unwrap_or_default();
    let root = std::path::Path::new("/sys/fs/cgroup");
    let own = root.join(own);
    let groups = own.ancestors().take_while(|folder| folder.starts_with(root));
    let second =
        groups.filter_map(|folder| cgroup_available(folder, "memory.max", "memory.current", "inactive_file"));
    let first = cgroup_available(
        &root.join("memory"),
        "memory.limit_in_bytes",
        "memory.usage_in_bytes",
        "total_inactive_file",
    );
    second.chain(first).min()
}

/// Memory that one group leaves; idle cached files give way.
fn cgroup_available(folder: &std::path::Path, limit: &str, used: &str, idle: &str) -> Option<u64> {
    let read = |name: &str| std::fs::read_to_string(folder.join(name)).ok();
    let limit: u64 = read(limit)?.trim().parse().ok()?;
    let used: u64 = read(used)?.trim().parse().ok()?;
    let statistics = read("memory.stat").unwrap_or_default();
    let idle =
        statistics.lines().find_map(|line| line.strip_prefix(idle)?.trim().parse().ok()).unwrap_or(0u64);
    Some(limit.saturating_sub(used.saturating_sub(idle)))
}

/// Bytes that the limit on the address space (`ulimit -v`) leaves; `None` where there is none, or the system does not tell.
pub fn address_space() -> Option<u64> {
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

/// The largest resident memory so far, or since [`forget_peak`], in bytes; `None` where the system does not tell.
pub fn peak() -> Option<u64> {
    kibibytes(&std::fs::read_to_string("/proc/self/status").ok()?, "VmHWM:")
}

/// True if memory is left for other data beside those that are drawn: three times what all took so far, of which drawing may take one
/// again. So what can be drawn alone is not refused for what was read too early.
pub fn has_room_ahead() -> bool {
    available().zip(peak()).is_some_and(|(left, most)| left / 3 >= most)
}

/// Lets the system's count of it begin anew (Linux: proc(5), clear_refs); whether it does.
pub fn forget_peak() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_of_memory_is_forgotten_and_found_again() {
        if !forget_peak() {
            eprintln!("skipped: this system does not let a process forget its peak");
            return;
        }
        let touched = |mebibytes: usize| std::hint::black_box(vec![1u8; mebibytes << 20]).len();
        touched(256);
        let high = peak().unwrap();
        assert!(forget_peak());
        touched(16);
        let low = peak().unwrap();
        // Other tests of this process may hold some memory.
        assert!(high > low + (64 << 20), "{high} {low}");
    }
}
