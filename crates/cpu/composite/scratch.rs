//! Scratch memory of a worker.

use crate::cast::boundary_hits::BoundaryHits;
use crate::cast::packet::PACKETS_IN_FLIGHT;
use crate::composite::frame::FrameContext;
use crate::composite::row_shader::RowShader;
use crate::counts::Counts;
use crate::fragments::batch::{Batch, MAX_LANES};
use crate::fragments::crossing::CellPacket;
use crate::fragments::spans::{Edges, Fragments};
use crate::shade::light::rays;
use crate::tile::{PIXELS, TileRect};

/// Scratch memory of a worker.
pub(crate) struct Scratch {
    pub fragments: Fragments,
    pub edges: Edges,
    pub packet: CellPacket,
    pub length_per_depth: [f32; PIXELS],
    pub row_shader: RowShader,
    /// Boundary faces that rays enter by, and batches of packets beside the first, where rays are cast.
    pub hits: BoundaryHits,
    pub further: [Batch; PACKETS_IN_FLIGHT - 1],
    pub counts: Counts,
}

impl Scratch {
    pub fn new(frame: &FrameContext<'_>) -> Scratch {
        let attribute_count = frame.attribute_count();
        Scratch {
            fragments: Fragments::new(MAX_LANES),
            edges: Edges::new(),
            packet: CellPacket::new(attribute_count),
            length_per_depth: [1.0; PIXELS],
            row_shader: RowShader::new(frame),
            hits: BoundaryHits::default(),
            further: std::array::from_fn(|_| Batch::new(attribute_count, frame.scalar_count)),
            counts: Counts::default(),
        }
    }

    /// Finds lengths, directions and depth limits of a tile's rays.
    pub fn begin(&mut self, frame: &FrameContext<'_>, rect: TileRect) {
        frame.lengths_per_depth(rect, &mut self.length_per_depth);
        let RowShader { rays: of_tile, depth_limits, .. } = &mut self.row_shader;
        if frame.shader.surface.is_some_and(|surface| surface.silhouette.is_some()) {
            rays(frame.view, rect.left, rect.top, of_tile);
        }
        frame.depth_limits_of(rect, depth_limits);
    }
}
