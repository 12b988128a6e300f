//! The memory that a run takes, from the size of its grid.

use voltet_cpu::drawing_bytes;
use voltet_io::memory::GridSize;

/// Bytes of the program before it has read anything: its code, its threads, and their stacks.
const PROGRAM_BYTES: u64 = 30 << 20;
/// The neighbours of a point, 14 on average, while `least-squares` solves for its gradient.
const NEIGHBOURS_BYTES: u64 = 64;
/// The gradient at a point, and its length.
const GRADIENT_BYTES: u64 = 32;
/// The picture that [`Needs`] speaks of, pixels along its sides.
pub const SIDE: u32 = 1024;

/// The most memory that a run takes, in bytes: the whole process.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Needs {
    /// Reading the grid with one scalar.
    pub reading: u64,
    /// Drawing all of its cells by the scalar alone, [`SIDE`] × [`SIDE`] pixels.
    pub drawing: u64,
    /// Drawing by the scalar and the gradient magnitude, with light.
    pub lit: u64,
}

/// Memory of a run that reads and draws a grid of this size.
pub fn needs(size: &GridSize) -> Needs {
    let grid = PROGRAM_BYTES.saturating_add(size.bytes());
    let drawn = |attributes| drawing_bytes(size.tetrahedra, size.points, attributes, [SIDE; 2]);
    let reading = PROGRAM_BYTES.saturating_add(size.reading_bytes());
    let gradient = size.points.saturating_mul(GRADIENT_BYTES);
    let solving = size.points.saturating_mul(GRADIENT_BYTES + NEIGHBOURS_BYTES);
    let drawing = reading.max(grid.saturating_add(drawn(1)));
    // s, g and the three components of ∇s.
    let lit = gradient.saturating_add(drawn(5)).max(solving);
    Needs { reading, drawing, lit: drawing.max(grid.saturating_add(lit)) }
}
