//! What stands in the one buffer that a scene reads beside its uniform, `numbers`: images or the colours of a table of lengths, which
//! are vectors of four numbers, then the integrator's further table, then the scene's own numbers. One buffer for all leaves tiles
//! within the eight that every device of WebGPU binds.

use voltet_core::transfer::{ColorSource, OpticalModel, TransferFunction};
use voltet_optics::research::{PartialTable, last_tile};
use voltet_optics::shading::Shading;

/// How long its parts are, in their order.
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

/// Numbers before the entries of mean extinctions: side, tiles less 1, where the first node is stored, nodes a stored unit, longest
/// segments a scene length.
pub(crate) const MEAN_HEAD: u64 = 5;

impl Places {
    /// Those of a scene, whose widgets have so many `numbers`.
    pub fn new(transfer_function: &TransferFunction, shading: &Shading, numbers: u64) -> Places {
        let none = Places { vectors: 0, source_vectors: 0, entries: 0, numbers };
        let [square, cube] = [2, 3].map(|power| {
            let side = shading.integrator.count("table_size").unwrap_or(0) as u64;
            side.saturating_pow(power)
        });
        let texels = images(transfer_function).map(|texels| texels.len() as u64).sum();
        let count = |name: &str| shading.integrator.count(name).unwrap_or(0);
        match shading.integrator.name() {
            "pre-integrated" => Places { vectors: cube, entries: square.saturating_add(MEAN_HEAD), ..none },
            "pre-integrated-cylindrical" => Places {
                vectors: square.saturating_mul(last_tile(count("table_size"), count("planes")) as u64 + 1),
                source_vectors: cube,
                entries: square.saturating_add(MEAN_HEAD),
                ..none
            },
            "segments" if !transfer_function.widgets.is_empty() => {
                let density = transfer_function.model == OpticalModel::DensityEmitter;
                let entries = PartialTable::bytes_of(density, count("table_size")) / size_of::<f32>();
                Places { vectors: texels, entries: 1 + entries as u64, ..none }
            }
            _ => Places { vectors: texels, ..none },
        }
    }

    /// Where the integrator's entries begin, in numbers.
    pub fn first_entry(&self) -> u64 {
        self.vectors.saturating_mul(4)
    }

    /// Where the widgets' numbers begin.
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
