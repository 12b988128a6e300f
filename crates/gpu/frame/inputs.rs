//! What a frame is drawn from.

use crate::device::open::Device;
use crate::frame::renderer::Renderer;
use crate::grid::parts::Sizes;
use crate::grid::uploaded::{DeviceGrid, Stored};
use crate::pass::tables::TableKey;
use std::sync::Arc;
use voltet_core::visibility::FaceOrder;
use voltet_optics::shading::Shading;
use voltet_shaders::{Choices, Shader, ViewRecord};

/// Everything of a scene but the camera's sample.
pub(crate) struct FrameInputs<'a> {
    pub renderer: &'a Renderer,
    pub choices: Choices,
    pub sizes: Sizes,
    pub shading: Shading,
    pub tables: TableKey,
    pub compositor: Shader,
    /// Read-only buffers that the compositor reads, with their bindings in group 0.
    pub storage_buffers: Vec<(String, u32)>,
    /// The scalar.
    pub scalar: Arc<Stored>,
    /// Further values of the points, each with where it is counted from.
    pub attributes: Vec<(Arc<Stored>, [f32; 2])>,
    pub reads_g: bool,
    pub scene: Vec<u8>,
    pub numbers: Vec<f32>,
    pub support: Vec<u32>,
    /// Whether what is blended stands in 8 bits a channel.
    pub in_8_bits: bool,
    /// Whether pixels that are opaque look at no further cells.
    pub stops_where_opaque: bool,
    /// Whether cells are sorted on the device.
    pub sorted: bool,
    /// The order of cells along their faces, where they are blended in it.
    pub ordered: Option<Arc<FaceOrder>>,
    pub samples: Vec<ViewRecord>,
}

impl<'a> FrameInputs<'a> {
    pub fn grid(&self) -> &'a DeviceGrid {
        &self.renderer.grid
    }

    pub fn device(&self) -> &'a Device {
        &self.renderer.grid.device
    }

    /// Bytes of a window's pixels.
    pub fn picture_bytes(&self, window: [u32; 4]) -> u64 {
        let pixels = u64::from(window[2]) * u64::from(window[3]) * u64::from(ViewRecord::TILE).pow(2);
        pixels * 16
    }
}
