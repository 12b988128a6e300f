//! `slice-image`: a plane through the cells as a picture of its own.

use crate::drawing;
use crate::relative::{self, NORMAL, ORIGIN};
use crate::slice::{cut, nothing_cut, plane};
use crate::surfacing::{self, map_parameters, range};
use crate::transfer_function::FilesFrom;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::flat_picture::flat_picture;
use voltet_core::grid::GridSurface;
use voltet_core::picture::Picture;
use voltet_core::surface::{Paint, Surface};
use voltet_core::transfer::{TransferFunction, color_curve, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port,
    PortType, Range, RunContext, Value,
};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

pub const NODE: Node = Node {
    name: "slice-image",
    summary: "Draws a plane through the cells alone: colours of values, or those of a transfer function at each place.",
    inputs: &[
        Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" },
        Port { name: "camera", port_type: PortType::Camera, summary: "the view, of parallel rays" },
    ],
    optional_inputs: &[Port {
        name: "transfer_function",
        port_type: PortType::TransferFunction,
        summary: "colours and opacity, in place of a colour map",
    }],
    outputs: &[Port { name: "image", port_type: PortType::Image, summary: "the picture" }],
    parameters: &PARAMETERS,
    example: include_str!("examples/slice_image.toml"),
    check: &|p| {
        let p = with_placeholders(p)?;
        plane(&p)?;
        range(&p).map(drop)
    },
    demand: &demand,
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 9] = {
    let [color_by, colormap, reversed, steps, range] = map_parameters("s");
    let thickness = Parameter {
        name: "thickness",
        parameter_type: ParameterType::Number(Range::above(0.0)),
        unit: "world units",
        default: DefaultValue::Unset("the unit_distance of the transfer function"),
        help: "thickness of the slab of equal values whose light a transfer function gives",
    };
    [ORIGIN, NORMAL, color_by, colormap, reversed, steps, range, relative::RELATIVE_TO, thickness]
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let p = asking.parameters;
    if asking.fed_by("transfer_function")?.is_none() {
        if p.is_set("thickness") {
            let error = p.error("thickness", "a colour map has no thickness");
            return Err(error.needs_input("transfer_function", ""));
        }
        return surfacing::ask(asking, [surfacing::color_by(p, Some("s")), None]);
    }
    if let Some(name) = surfacing::OF_MAP.into_iter().find(|name| p.is_set(name)) {
        let error = p.error(name, format!("'{name}' and a transfer function exclude each other"));
        return Err(error.expected("the colours of a map, or those of the transfer function"));
    }
    let demand = match asking.look("transfer_function") {
        Some(look) => Demand::of_function(&look.transfer_function),
        None => Demand { order: false, ..Demand::unknown() },
    };
    asking.ask("volume", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume, camera) = (call.parameters, call.volume("volume")?, *call.camera("camera")?);
    let is_classified = call.is_wired("transfer_function")?;
    let color_by = surfacing::color_by(p, Some("s")).filter(|_| !is_classified);
    let own = surfacing::known_of_volume(call, &volume, "s", color_by)?;
    let [origin, normal] = plane(&own)?;
    check_view(p, &camera, normal)?;
    let distances: Vec<f64> = volume.grid.points.par_iter().map(|&at| (at - origin).dot(normal)).collect();
    let surface = cut(call, &volume.grid, &distances)?;
    call.notes.counts.insert("triangles", surface.triangles.len() as u64);
    if surface.triangles.is_empty() {
        call.notes.warnings.push(format!("the slice is empty: {}", nothing_cut("plane", &distances)));
    }
    let picture = match color_by {
        Some(name) => mapped(call, &own, &volume, surface, name, &camera)?,
        None => classified(call, &volume, surface, &camera)?,
    };
    Ok(vec![Value::Image(Arc::new(picture))])
}

/// Sine of the angle between a view and the plane below which nothing of it is seen.
const EDGE_ON: f64 = 1e-6;

fn check_view(p: &Parameters, camera: &Camera, normal: DVec3) -> Result<()> {
    if let Projection::Perspective { .. } = camera.projection {
        let error = Error::usage("a slice is drawn by parallel rays").got("a perspective camera");
        return Err(p.locate("normal", error.expected("height = \"auto\" at the camera, or a number")));
    }
    if camera.frame()?.forward.dot(normal).abs() > EDGE_ON {
        return Ok(());
    }
    let error = p.error("normal", "the camera looks along the plane, of which nothing is seen");
    let [x, y, z] = normal.to_array();
    Err(error.expected(format!("direction = [{x:?}, {y:?}, {z:?}] at the camera, or another normal")))
}

/// The picture by a colour map.
fn mapped(
    call: &mut RunContext,
    own: &Parameters,
    volume: &Volume,
    surface: GridSurface,
    name: &str,
    camera: &Camera,
) -> Result<Picture> {
    let values = surface.values(surfacing::values(call.parameters, "color_by", volume, name)?);
    let curve = color_curve(own, &FilesFrom(&|path| call.resolve(path)))?;
    let (points, triangles) = (surface.positions(&volume.grid.points), surface.triangles);
    let paint = Paint::Mapped { values, range: range(own)?, curve, bad: None };
    let surface = Surface { points, triangles, paint, opacity: 1.0, light: None, normals: Vec::new() };
    surface.check()?;
    let color = |triangle, weights| surface.color(triangle, weights, 0.0);
    call.stage("draw", |progress| flat_picture(camera, &surface.points, &surface.triangles, color, progress))
}

/// The picture by the transfer function: the light of a slab in which all is as at the place.
fn classified(
    call: &mut RunContext,
    volume: &Volume,
    surface: GridSurface,
    camera: &Camera,
) -> Result<Picture> {
    let look = call.look("transfer_function")?;
    let function = drawing::for_data(call, &look, volume, call.revision("volume")?)?;
    let length = call.parameters.optional_number("thickness").unwrap_or(function.unit_distance);
    let quantities = quantities(volume, &function)?;
    let quantities: Vec<Vec<f64>> = quantities.into_iter().map(|values| surface.values(values)).collect();
    let compiled = CompiledTransferFunction::new(&function)?;
    let points = surface.positions(&volume.grid.points);
    let color = |triangle: usize, weights: [f64; 3]| {
        let corners = surface.triangles[triangle].map(|p| p as usize);
        // From one corner, so that equal values stay what they are.
        let at = |values: &Vec<f64>| {
            let above = weights.iter().zip(corners).map(|(w, p)| w * (values[p] - values[corners[0]]));
            values[corners[0]] + above.sum::<f64>()
        };
        let values: Vec<f64> = quantities.iter().map(at).collect();
        let (place, fields) = ([values[0], values[1]], &values[2..]);
        let segment =
            Segment { length, front: place, back: place, fields_front: fields, fields_back: fields };
        // Where nothing changes along a segment, this is exact, too.
        let Contribution { color: [r, g, b], opacity, .. } =
            compiled.integrate_values(&segment, WidgetBlend::Mix);
        [r, g, b, opacity]
    };
    call.stage("draw", |progress| flat_picture(camera, &points, &surface.triangles, color, progress))
}

/// Values of s, of g (or s again where the function looks at none), and of further fields, one a point each.
fn quantities<'a>(volume: &'a Volume, function: &TransferFunction) -> Result<Vec<&'a [f64]>> {
    let g = ArrayRef::Named(if function.uses_gradient_magnitude() { "g" } else { "s" });
    let mut quantities = vec![&volume.scalar[..], relative::values(volume, &g)?];
    for name in function.fields() {
        quantities.push(volume.grid.field("the transfer function", name)?);
    }
    Ok(quantities)
}
