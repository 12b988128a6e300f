//! Resources of a composed shader beside `scene`: the buffer `numbers`, and the passes that fill the tables in it on the device.
//!
//! A device crate makes every buffer, runs the passes in their order, and binds the buffers that have a binding; it need
//! not know what they are. They change with the transfer function and the data, not with the camera; where only the widgets'
//! numbers change, which are the last ones, a crate writes those alone.

use crate::shader_key::{ShaderKey, TableSize, registered};
use crate::text::Shader;
use crate::writer::Axis;
use voltet_core::transfer::{ColorSource, TransferFunction};
use voltet_core::{Error, Result};
use voltet_optics::integrators::{Extent, Integrator};
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

/// Buffers, and the passes that fill some of them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Resources {
    /// In the order of their indices; those with a binding are the ones of [`ShaderKey::storage_buffers`].
    pub buffers: Vec<Buffer>,
    /// Run once, in this order, before anything is drawn.
    pub passes: Vec<Pass>,
}

/// A storage buffer.
#[derive(Debug, Clone, PartialEq)]
pub struct Buffer {
    /// As the text names it; a part has a name of its own.
    pub name: String,
    /// Its binding in group 0 of the composed shader, which reads it; `None`: only the passes use it.
    pub binding: Option<u32>,
    /// Initial contents.
    pub contents: Contents,
}

/// Contents of a buffer before the passes run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Contents {
    /// Bytes at its beginning that passes fill.
    pub filled: u64,
    /// The bytes behind those.
    pub bytes: Vec<u8>,
}

/// A compute pass.
#[derive(Debug, Clone, PartialEq)]
pub struct Pass {
    /// Its text.
    pub shader: Shader,
    /// Its entry point.
    pub entry_point: &'static str,
    /// Indices of buffers, bound in group 0 at 0, 1, ….
    pub buffers: Vec<usize>,
    /// Number of written buffers, the last ones; the others are only read.
    pub written: usize,
    /// Workgroups to dispatch.
    pub workgroups: [u32; 3],
}

/// Extension by which a kind of integrators fills a table on the device that stands for all widgets
/// ([`voltet_optics::integrators::IntegratorKind::extensions`]).
pub struct WgslTableExtension(pub &'static dyn WgslTable);

/// Table on the device that stands for all widgets ([`crate::WgslCall::Table`]).
pub trait WgslTable: Send + Sync {
    /// Adds the buffers and passes of the table.
    ///
    /// Errors: data without a domain for the table.
    fn fill(&self, resources: &mut Resources, scene: &TableScene<'_>) -> Result<()>;
}

/// Scene that a table is filled for.
pub struct TableScene<'a> {
    /// Key of the shader that reads the table.
    pub shader_key: &'a ShaderKey,
    /// The integrator.
    pub integrator: &'a Integrator,
    /// The transfer function.
    pub transfer_function: &'a TransferFunction,
    /// Sizes of the parts of the buffer `numbers`.
    pub places: Places,
    /// Storage of the scalar.
    pub axis: Axis,
    /// World units in a scene length.
    pub length: f64,
    /// The domain of the table.
    pub extent: &'a Extent,
    /// Numbers behind those of the table.
    pub numbers: &'a [f32],
}

impl Buffer {
    /// Its length in bytes.
    pub fn length(&self) -> u64 {
        self.contents.filled + self.contents.bytes.len() as u64
    }
}

impl Resources {
    /// `axis`: how s is stored. `length`: the scene length in world units, in which D is counted. `extent` is looked at
    /// only where [`voltet_optics::integrators::Integrator::has_table_of_lengths`] says so. `numbers`: those of [`crate::Parameters`].
    pub fn new(
        shader_key: &ShaderKey,
        transfer_function: &TransferFunction,
        shading: &Shading,
        axis: Axis,
        length: f64,
        extent: &Extent,
        numbers: &[f32],
    ) -> Result<Resources> {
        let mut resources = Resources::default();
        let places = Places::new(transfer_function, shading, numbers.len() as u64);
        let integrator = &shading.integrator;
        let text = registered(integrator);
        let table = integrator.extension::<WgslTableExtension>();
        match table {
            _ if shader_key.storage_buffers().is_empty() => {}
            Some(WgslTableExtension(table)) if shader_key.method.is_table_of_lengths() => {
                let scene = TableScene {
                    shader_key,
                    integrator,
                    transfer_function,
                    places,
                    axis,
                    length,
                    extent,
                    numbers,
                };
                table.fill(&mut resources, &scene)?;
            }
            None if shader_key.method.is_table_of_lengths() => {
                return Err(Error::usage("the integrator's shader reads a table that nothing fills")
                    .got(integrator.name())
                    .expected("a WgslTableExtension among the extensions of its kind"));
            }
            _ => {
                let mut all: Vec<f32> = images(transfer_function).flatten().flatten().copied().collect();
                all.extend(text.map(|text| text.entries(integrator, transfer_function)).unwrap_or_default());
                all.extend(numbers);
                resources.add_numbers(shader_key, 0, &all);
            }
        }
        Ok(resources)
    }

    /// The buffer that the scene reads, in its parts: so many vectors that passes fill, then numbers. Gives their indices.
    pub fn add_numbers(&mut self, shader_key: &ShaderKey, filled: u64, behind: &[f32]) -> Vec<usize> {
        let first = self.buffers.len();
        let mut rest = behind;
        for (part, (name, binding)) in (0u32..).zip(shader_key.storage_buffers()) {
            let parts = shader_key.layout.table;
            let room = 4 * parts.length(part, u64::MAX);
            let filled = parts.length(part, filled);
            let (numbers, others) = rest.split_at(rest.len().min((room - 4 * filled) as usize));
            rest = others;
            let mut bytes = bytemuck::cast_slice(numbers).to_vec();
            // Whole vectors.
            bytes.resize(bytes.len().next_multiple_of(TEXEL_BYTES as usize), 0);
            let contents = Contents { filled: filled * TEXEL_BYTES, bytes };
            self.buffers.push(Buffer { name, binding: Some(binding), contents });
        }
        (first..self.buffers.len()).collect()
    }

    /// A buffer that only passes know. Gives its index.
    pub fn add_buffer(&mut self, name: String, contents: Contents) -> usize {
        self.buffers.push(Buffer { name, binding: None, contents });
        self.buffers.len() - 1
    }
}
