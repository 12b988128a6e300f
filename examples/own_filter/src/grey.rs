//! `grey`: an image filter, a picture without colour.

use std::sync::Arc;
use voltet::core::Result;
use voltet::core::picture::Picture;
use voltet::graph::{Node, Outputs, Port, PortType, RunContext, Value};

/// The declaration.
pub const NODE: Node = Node {
    name: "grey",
    summary: "Takes the colour out of a picture and leaves luminance and opacity.",
    inputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the same in grey" }],
    example: include_str!("../own.toml"),
    run: &run,
    ..Node::BLANK
};

/// Luminance of linear RGB with the primaries of sRGB (ITU-R BT.709-6, 3.2).
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

fn run(call: &mut RunContext) -> Result<Outputs> {
    let picture = call.image("image")?;
    // Premultiplied linear RGBA: sums of colours are sums of light.
    let grey = |&[r, g, b, a]: &[f32; 4]| {
        let y = LUMINANCE[0] * r + LUMINANCE[1] * g + LUMINANCE[2] * b;
        [y, y, y, a]
    };
    let rgba = picture.rgba.iter().map(grey).collect();
    Ok(vec![Value::Image(Arc::new(Picture { rgba, ..*picture }))])
}
