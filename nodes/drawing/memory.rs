//! Memory that a whole process takes with a grid, known before any of it is read.
//!
//! Sums of the arrays that stand at the same time, measured (largest resident memory) on grids of 28 thousand to 24 million tetrahedra.

use std::path::Path;
use voltet_core::Result;
use voltet_cpu::drawing_bytes;
use voltet_io::formats::{Request, piece_sizes};
use voltet_io::memory::GridSize;

/// The program before it has read anything: its code, its threads, and their stacks.
const PROGRAM_BYTES: u64 = 30 << 20;
/// The neighbours of a point, 14 on average, while `least-squares` solves for its gradient.
const NEIGHBOURS_BYTES: u64 = 64;
/// The gradient at a point, and its length.
const GRADIENT_BYTES: u64 = 32;
/// Partial sums of a window's histogram. Whole processes with windows on 1, 4 and 16 million tetrahedra took to their first picture 0.9 to 1.1
/// times what is counted for it, the program, and 48 MiB of the window's own.
const SUMS_BYTES: u64 = 32 << 20;

/// Bytes that a process takes with a grid of some size and one scalar.
#[derive(Debug, Clone, Copy)]
pub struct MemoryNeed {
    size: GridSize,
    piece_count: usize,
}

impl MemoryNeed {
    /// Side of the picture that is assumed (pixels).
    pub const SIDE: u32 = 1024;

    /// Need of a grid of this size.
    pub fn new(size: GridSize) -> MemoryNeed {
        MemoryNeed { size, piece_count: 1 }
    }

    /// Need of the grid that a file holds, by headers alone.
    ///
    /// # Errors
    /// As of reading it, as far as headers show them.
    pub fn of_file(path: &Path, request: &Request) -> Result<MemoryNeed> {
        let mut size = GridSize::default();
        let pieces = piece_sizes(path, request)?;
        for piece in &pieces {
            size.points = size.points.saturating_add(piece.points);
            size.add_size(piece);
        }
        Ok(MemoryNeed { size, piece_count: pieces.len() })
    }

    /// Number of pieces that the file holds, which can be drawn some at a time.
    pub fn piece_count(&self) -> usize {
        self.piece_count
    }

    /// Bytes for reading it.
    pub fn reading(&self) -> u64 {
        PROGRAM_BYTES.saturating_add(self.size.reading_bytes())
    }

    /// Bytes for reading it and drawing all of its cells on the CPU by the scalar alone.
    pub fn drawing(&self) -> u64 {
        self.reading().max(self.grid().saturating_add(self.drawn(1)))
    }

    /// Bytes for reading it and drawing all of its cells on the CPU by the scalar and the gradient magnitude, with light.
    pub fn drawing_lit(&self) -> u64 {
        // s, g and the three components of ∇s.
        self.with_gradient(5)
    }

    /// Bytes that opening it takes beside a window that stands, to its first picture: a pipeline is made for it, and the picture is drawn by
    /// the scalar and the gradient magnitude.
    pub fn opening(&self) -> u64 {
        SUMS_BYTES.saturating_add(self.with_gradient(2)).saturating_sub(PROGRAM_BYTES)
    }

    fn with_gradient(&self, attributes: u64) -> u64 {
        let gradient = self.size.points.saturating_mul(GRADIENT_BYTES);
        let solving = self.size.points.saturating_mul(GRADIENT_BYTES + NEIGHBOURS_BYTES);
        let drawing = gradient.saturating_add(self.drawn(attributes)).max(solving);
        self.drawing().max(self.grid().saturating_add(drawing))
    }

    fn grid(&self) -> u64 {
        PROGRAM_BYTES.saturating_add(self.size.bytes())
    }

    fn drawn(&self, attributes: u64) -> u64 {
        drawing_bytes(self.size.tetrahedra, self.size.points, attributes, [Self::SIDE; 2])
    }
}
