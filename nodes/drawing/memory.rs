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
/// A window, and the partial sums of its histogram. Windows on 1, 4 and 16 million tetrahedra took 0.9 to 1.1 times the sum.
const WINDOW_BYTES: u64 = 80 << 20;

/// Bytes that a process takes with a grid of some size and one scalar.
#[derive(Debug, Clone, Copy)]
pub struct MemoryNeed {
    size: GridSize,
}

impl MemoryNeed {
    /// Side of the picture that is assumed (pixels).
    pub const SIDE: u32 = 1024;

    /// Need of a grid of this size.
    pub fn new(size: GridSize) -> MemoryNeed {
        MemoryNeed { size }
    }

    /// Need of the grid that a file holds, by headers alone.
    ///
    /// # Errors
    /// As of reading it, as far as headers show them.
    pub fn of_file(path: &Path, request: &Request) -> Result<MemoryNeed> {
        let mut size = GridSize::default();
        for piece in piece_sizes(path, request)? {
            size.points = size.points.saturating_add(piece.points);
            size.add_size(&piece);
        }
        Ok(MemoryNeed { size })
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

    /// Bytes for opening it in a window: a pipeline is made for it, and its picture is drawn by the scalar and the gradient magnitude.
    pub fn opening(&self) -> u64 {
        WINDOW_BYTES.saturating_add(self.with_gradient(2))
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
