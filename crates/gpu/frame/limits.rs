//! Limits of a device, checked before anything is drawn.

use crate::grid::device_grid::{DeviceArray, DeviceGrid};
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_core::{Error, Result};
use voltet_optics::shading::Shading;
use voltet_shaders::{CompositorProgram, ShaderKey, Spans, TileOrder, check_32_bits};

/// True if the device has shaders for the scene. What depends on the data is found when it is drawn.
pub fn can_serve(transfer_function: &TransferFunction, shading: &Shading) -> Result<()> {
    ShaderKey::new(transfer_function, shading, CompositorProgram::Tiles(TileOrder::Exact)).map(drop)
}

/// True if 32 bits hold what segments of this grid can span. `values`: s, g (anything where it is not read), then the
/// fields, as the transfer function numbers them.
pub(crate) fn check(
    grid: &DeviceGrid,
    shader_key: &ShaderKey,
    transfer_function: &TransferFunction,
    values: &[Arc<DeviceArray>],
) -> Result<()> {
    let span = |(k, value): (usize, &Arc<DeviceArray>)| match k {
        1 if !shader_key.reads_gradient_magnitude => 0.0,
        _ => value.span * value.cell_span,
    };
    let spans: Vec<f64> = values.iter().enumerate().map(span).collect();
    let spans = Spans { values: &spans, longest: grid.longest };
    check_32_bits(shader_key, transfer_function, &spans).map_err(|error: Error| {
        let accepted = error.expected.clone().unwrap_or_default();
        error.expected(format!("{accepted}; engine = \"cpu\" holds it"))
    })
}
