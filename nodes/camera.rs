//! `camera`: where the picture is seen from.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::{Camera, Projection};
use voltet_graph::{
    DefaultValue, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Range, RunContext,
    Value,
};

/// Largest side of a picture, pixels: what the engine counts.
const LARGEST_SIDE: f64 = 32768.0;

/// Most pixels of a picture: 4 GiB of floats.
const MAX_PIXELS: f64 = (1u64 << 28) as f64;

/// The declaration.
pub const NODE: Node = Node {
    name: "camera",
    summary: "Says where the picture is seen from, how wide the view is and how many pixels it has.",
    outputs: &[Port { name: "camera", port_type: PortType::Camera, summary: "the camera" }],
    parameters: &[
        Parameter {
            name: "eye",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "world units",
            default: DefaultValue::Required,
            help: "position of the eye; it may lie inside the grid",
        },
        Parameter {
            name: "target",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "world units",
            default: DefaultValue::Required,
            help: "the point that appears in the middle of the picture",
        },
        Parameter {
            name: "up",
            parameter_type: ParameterType::Numbers(Some(3), Range::ANY),
            unit: "",
            default: DefaultValue::Numbers(&[0.0, 0.0, 1.0]),
            help: "the direction that points up in the picture; any length, not parallel to the view",
        },
        Parameter {
            name: "fov_y",
            parameter_type: ParameterType::Number(Range::between(0.0, 180.0)),
            unit: "degrees",
            default: DefaultValue::Unset("30 unless height is given"),
            help: "vertical field of view of a perspective camera",
        },
        Parameter {
            name: "height",
            parameter_type: ParameterType::Number(Range::above(0.0)),
            unit: "world units",
            default: DefaultValue::Unset("a perspective camera"),
            help: "height of the picture of an orthographic camera, in place of fov_y",
        },
        Parameter {
            name: "near",
            parameter_type: ParameterType::Number(Range::at_least(0.0)),
            unit: "world units",
            default: DefaultValue::Number(0.0),
            help: "what is nearer along the view direction is cut off",
        },
        Parameter {
            name: "size",
            parameter_type: ParameterType::Integers(2, Range::within(1.0, LARGEST_SIDE)),
            unit: "pixels",
            default: DefaultValue::Integers(&[1024, 768]),
            help: "width and height of the picture",
        },
        Parameter {
            name: "samples",
            parameter_type: ParameterType::Integer(Range::within(1.0, 256.0)),
            unit: "",
            default: DefaultValue::Integer(1),
            help: "rays a pixel",
        },
    ],
    example: include_str!("examples/stages.toml"),
    early: true,
    check: &|parameters| camera(parameters).map(drop),
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    Ok(vec![Value::Camera(Arc::new(camera(call.parameters)?))])
}

/// The camera that the parameters state; its axes are known to be sound.
fn camera(p: &Parameters) -> Result<Camera> {
    let projection = match (p.optional_number("fov_y"), p.optional_number("height")) {
        (Some(_), Some(_)) => {
            return Err(p
                .error("height", "'fov_y' and 'height' exclude each other")
                .expected("fov_y for a perspective camera, height for an orthographic one"));
        }
        (_, Some(height)) => Projection::Orthographic { height },
        (fov_y, None) => Projection::Perspective { fov_y: fov_y.unwrap_or(30.0) },
    };
    let [width, height]: [f64; 2] = p.vector("size")?;
    if width * height > MAX_PIXELS {
        let error = p.error("size", "the picture has too many pixels").got(width * height);
        return Err(error.expected(format!("width × height of at most {MAX_PIXELS}")));
    }
    let camera = Camera {
        eye: p.vector("eye")?.into(),
        target: p.vector("target")?.into(),
        up: p.vector("up")?.into(),
        projection,
        near: p.number("near")?,
        // Within the declared range, so nothing is lost.
        size: [width as u32, height as u32],
        samples: p.integer("samples")? as u32,
    };
    let place = if camera.eye == camera.target { "target" } else { "up" };
    camera.frame().map_err(|error| p.locate(place, error))?;
    Ok(camera)
}
