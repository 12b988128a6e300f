//! A picture beside the axes of another program: the plane of its camera, and the colours along the scalar.

use serde_json::{Value, json};
use voltet_core::Result;
use voltet_core::camera::Projection;
use voltet_core::transfer::AxisScale;
use voltet_nodes::scalar_colors;
use voltet_optics::scene::Scene;

/// Colours along the scalar.
const COLOR_COUNT: usize = 256;

/// The camera's plane through its target (world units), and the scale of the colours, null where there is none: JSON.
pub fn picture_axes(scene: &Scene) -> Result<Value> {
    let camera = &scene.camera;
    let frame = camera.frame()?;
    let is_orthographic = matches!(camera.projection, Projection::Orthographic { .. });
    let depth = if is_orthographic { 1.0 } else { (camera.target - camera.eye).length() };
    let [width, height] = camera.size.map(|pixels| f64::from(pixels) * frame.pixel * depth);
    let colors = scalar_colors(&scene.transfer_function, &scene.volume, COLOR_COUNT)?;
    let scale = colors.map(|found| {
        let (form, linear_below) = match found.axis {
            AxisScale::Linear => ("linear", None),
            AxisScale::Log => ("log", None),
            AxisScale::SymLog { linear_below } => ("symlog", Some(linear_below)),
        };
        json!({
            "name": scene.volume.grid.scalar_name,
            "range": found.range,
            "form": form,
            "linear_below": linear_below,
            "colors": found.colors,
        })
    });
    Ok(json!({
        "right": frame.right.to_array(),
        "up": frame.up.to_array(),
        "middle": [camera.target.dot(frame.right), camera.target.dot(frame.up)],
        "size": [width, height],
        "is_orthographic": is_orthographic,
        "scale": scale,
    }))
}
