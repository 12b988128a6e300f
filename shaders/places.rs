//! Layout of `numbers`, the one buffer that a scene reads beside its uniform: images or the colours of a table of lengths, which
//! are vectors of four numbers, then the integrator's further table, then the scene's own numbers. One buffer for all leaves tiles
//! within the eight that every device of WebGPU binds.

use crate::integrator::{TableSize, registered};
use voltet_core::transfer::{ColorSource, TransferFunction};
use voltet_optics::shading::Shading;

/// Lengths of its parts, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Places {
    /// Vectors: texels of all images, or the colours of a table of lengths. With any, all of the buffer is read as vectors.
    pub vectors: u64,
    /// Vectors of the table that those colours are made from, if it is another: it stands in buffers of its own.
    pub source_vectors: u64,
    /// Numbers of the integrator's further table.
    pub entries: u64,
    /// Numbers of the widgets: edges, control points, matrices.
    pub numbers: u64,
}

/// Bytes of a vector.
pub const TEXEL_BYTES: u64 = 16;

impl Places {
    /// Layout for a scene whose widgets have so many `numbers`.
    pub fn new(transfer_function: &TransferFunction, shading: &Shading, numbers: u64) -> Places {
        let integrator = &shading.integrator;
        let table = registered(integrator).map(|text| text.table_size(integrator, transfer_function));
        let TableSize { vectors, source_vectors, entries } = table.unwrap_or_default();
        let texels = || images(transfer_function).map(|texels| texels.len() as u64).sum();
        Places { vectors: if vectors > 0 { vectors } else { texels() }, source_vectors, entries, numbers }
    }

    /// Index of the integrator's first entry (numbers).
    pub fn first_entry(&self) -> u64 {
        self.vectors.saturating_mul(4)
    }

    /// Index of the widgets' first number.
    pub fn first_number(&self) -> u64 {
        self.first_entry().saturating_add(self.entries)
    }

    /// Vectors that hold all, where any are among it; else 0.
    pub fn in_vectors(&self) -> u64 {
        match self.vectors {
            0 => 0,
            _ => self.first_number().saturating_add(self.numbers).div_ceil(4),
        }
    }
}

/// Texels of each table widget.
pub fn images(transfer_function: &TransferFunction) -> impl Iterator<Item = &[[f32; 4]]> {
    transfer_function.widgets.iter().filter_map(|widget| match widget.profile.properties().color {
        ColorSource::Texels(texels) => Some(texels),
        ColorSource::Widget | ColorSource::Points(_) => None,
    })
}
