//! A caller's camera to the parameters of a camera node.

use crate::structs::Camera;
use voltet::{Pipeline, Result};
use voltet_graph::ParameterValue;

/// Sets all parameters of a camera node. `node` is `None`: the only one.
pub(crate) fn set(pipeline: &mut Pipeline, node: Option<&str>, camera: &Camera) -> Result<()> {
    let node = pipeline.camera_node(node)?;
    let list = |values: &[f64]| {
        ParameterValue::List(values.iter().map(|&value| ParameterValue::Number(value).into()).collect())
    };
    // 0 stands for the default, or for the other projection.
    let projection = |value: f64| (value != 0.0).then_some(ParameterValue::Number(value));
    let up = if camera.up == [0.0; 3] { [0.0, 0.0, 1.0] } else { camera.up };
    let mut values = vec![
        ("eye", Some(list(&camera.eye))),
        ("target", Some(list(&camera.target))),
        ("up", Some(list(&up))),
        ("near", Some(ParameterValue::Number(camera.near_plane))),
        ("samples", Some(ParameterValue::Integer(i64::from(camera.samples.max(1))))),
        ("fov_y", projection(camera.fov_y)),
        ("height", projection(camera.height)),
    ];
    if camera.pixels != [0, 0] {
        let sides = camera.pixels.map(|side| ParameterValue::Integer(i64::from(side)).into());
        values.push(("size", Some(ParameterValue::List(sides.to_vec()))));
    }
    pipeline.set_parameters(&node, values)
}
