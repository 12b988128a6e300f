//! `slice`: a plane, a sphere or a cylinder through the cells, coloured by what they hold there.

use crate::relative::{self, NORMAL, ORIGIN, RADIUS, RELATIVE_TO};
use crate::surfacing::{self, Shape, with_paint};
use glam::DVec3;
use rayon::prelude::*;
use voltet_core::Result;
use voltet_core::arithmetic::unit_vector;
use voltet_core::grid::extent::range;
use voltet_core::grid::{Grid, GridSurface, contour};
use voltet_core::transfer::with_placeholders;
use voltet_graph::{DefaultValue, Node, Outputs, Parameter, ParameterType, Parameters, RunContext};

pub const NODE: Node = Node {
    name: "slice",
    summary: "Cuts the cells by a plane, a sphere or a cylinder, and colours the cut by values there.",
    inputs: surfacing::INPUTS,
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surfaces.toml"),
    check: &|p| {
        // Places are those of the data, once these are known.
        distance(&with_placeholders(p)?).map(drop)?;
        surfacing::check(p)
    },
    demand: &|asking| {
        let p = asking.parameters;
        surfacing::ask(asking, [surfacing::color_by(p, Some("s")), None])
    },
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 13] = with_paint(
    [
        Parameter {
            help: "a point of the plane, the centre of the sphere, or a point on the axis of the cylinder",
            ..ORIGIN
        },
        Parameter {
            help: "the plane's normal, or the direction of the cylinder's axis; any length above 0",
            ..NORMAL
        },
        Parameter {
            name: "shape",
            parameter_type: ParameterType::Choice(&[
                ("plane", "exact"),
                ("sphere", "about 'origin', with straight pieces in each cell"),
                (
                    "cylinder",
                    "about the axis through 'origin' along 'normal', with straight pieces in each cell",
                ),
            ]),
            unit: "",
            default: DefaultValue::Text("plane"),
            help: "what the cells are cut by",
        },
        Parameter {
            default: DefaultValue::Unset("none: a plane"),
            help: "radius of the sphere or cylinder; a percentage: of the diagonal of the bounds",
            ..RADIUS
        },
        RELATIVE_TO,
    ],
    "s",
    1.0,
    1.0,
);

/// A function that is 0 on the cut.
type Distance = Box<dyn Fn(DVec3) -> f64 + Sync>;

/// A point of the plane and its unit normal. Errors: a normal of length 0.
pub(crate) fn plane(p: &Parameters) -> Result<[DVec3; 2]> {
    match unit_vector(p.vector("normal")?.into()) {
        DVec3::ZERO => {
            Err(p.error("normal", "the normal has no direction").expected("a vector that is not zero"))
        }
        axis => Ok([p.vector("origin")?.into(), axis]),
    }
}

/// Signed distance from the cut. Errors: a normal of length 0, no radius, or one of a plane.
fn distance(p: &Parameters) -> Result<Distance> {
    let [origin, axis] = plane(p)?;
    let shape = p.text("shape")?;
    let radius = || {
        let error = || p.error("shape", format!("a {shape} needs a radius")).expected("radius = …, above 0");
        p.optional_number("radius").ok_or_else(error)
    };
    Ok(match shape {
        "sphere" => {
            let radius = radius()?;
            Box::new(move |at| (at - origin).length() - radius)
        }
        "cylinder" => {
            let radius = radius()?;
            Box::new(move |at| (at - origin).reject_from_normalized(axis).length() - radius)
        }
        _ if p.is_set("radius") => {
            let error = p.error("radius", "a plane has no radius");
            return Err(error.expected("shape = \"sphere\" or \"cylinder\", or no radius"));
        }
        _ => Box::new(move |at| (at - origin).dot(axis)),
    })
}

/// The surface on which these distances, one a point, are 0.
pub(crate) fn cut(call: &mut RunContext, grid: &Grid, distances: &[f64]) -> Result<GridSurface> {
    call.stage("slice", |progress| {
        let found = contour(grid, distances, 0.0, progress)?;
        if !found.triangles.is_empty() {
            return Ok(found);
        }
        // A side of the data that lies in the plane, with all cells on the plane's positive side.
        let turned: Vec<f64> = distances.iter().map(|distance| -distance).collect();
        contour(grid, &turned, 0.0, progress)
    })
}

/// The reason why nothing is cut: "no cell reaches the plane: points lie from …".
pub(crate) fn nothing_cut(shape: &str, distances: &[f64]) -> String {
    match range(distances) {
        Some([low, high]) => {
            format!("no cell reaches the {shape}: points lie from {low:?} to {high:?} of it")
        }
        None => "the grid has no points".into(),
    }
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let grid = &volume.grid;
    let color_by = surfacing::color_by(p, Some("s"));
    let own = surfacing::known_of_volume(call, &volume, "s", color_by)?;
    let distance = distance(&own)?;
    let distances: Vec<f64> = grid.points.par_iter().map(|&at| distance(at)).collect();
    let surface = cut(call, grid, &distances)?;
    let values = color_by.map(|name| surfacing::values(p, "color_by", &volume, name)).transpose()?;
    let colors = values.map(|values| surface.values(values));
    let why = nothing_cut(p.text("shape")?, &distances);
    Shape::of_grid(surface, &grid.points, colors).painted(call, &own, &why)
}
