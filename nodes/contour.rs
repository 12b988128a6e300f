//! `contour`: surfaces of constant value.

use crate::relative::{self, RELATIVE_TO};
use crate::surfacing::{self, QUANTITY, SMOOTH, Shape, with_paint};
use voltet_core::Result;
use voltet_core::grid::{GridSurface, contour};
use voltet_graph::{
    AxisRef, DefaultValue, Node, Outputs, Parameter, ParameterType, Range, RelativeNumberType, RunContext,
    StatisticKind,
};

pub const NODE: Node = Node {
    name: "contour",
    summary: "Makes surfaces on which a quantity has given values, exact for values that are linear in each cell.",
    inputs: surfacing::INPUTS,
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/surfaces.toml"),
    check: &|p| {
        if p.get("values")?.list().is_some_and(<[_]>::is_empty) {
            return Err(p.error("values", "there are no values").got("[]").expected("at least one"));
        }
        surfacing::check(p)
    },
    demand: &|asking| {
        let p = asking.parameters;
        let array = p.text("array")?;
        surfacing::ask(asking, [Some(array), surfacing::color_by(p, None)])
    },
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 12] = with_paint(
    [
        Parameter {
            help: "what is constant: \"s\", the scalar; \"g\", its gradient magnitude; or a point array",
            ..QUANTITY
        },
        Parameter {
            name: "values",
            parameter_type: ParameterType::Measured(&RelativeNumberType {
                plain: ParameterType::Numbers(None, Range::ANY),
                statistic: StatisticKind::Value,
                axis: AxisRef::Every("array"),
            }),
            unit: "units of array",
            default: DefaultValue::Required,
            help: "a surface for each of these",
        },
        SMOOTH,
        RELATIVE_TO,
    ],
    "array",
    1.0,
    0.3,
);

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let array = p.text("array")?;
    let color_by = surfacing::color_by(p, Some(array));
    let values = surfacing::values(p, "array", &volume, array)?;
    let own = surfacing::known_of_volume(call, &volume, array, color_by)?;
    let (mut surface, mut levels, mut missed) = (GridSurface::default(), Vec::new(), Vec::new());
    for level in own.numbers("values")? {
        let found = call.stage("contour", |progress| contour(&volume.grid, values, level, progress))?;
        levels.resize(levels.len() + found.points.len(), level);
        if found.triangles.is_empty() {
            missed.push(format!("{level:?}"));
        }
        surface.append(found);
    }
    let why = format!(
        "no cell has values on both sides of {}: {}",
        missed.join(", "),
        surfacing::range_message(array, values)
    );
    if !missed.is_empty() && !surface.triangles.is_empty() {
        call.notes.warnings.push(why.clone());
    }
    let colors = match color_by {
        None => None,
        // Exact, where a straight line along an edge may be off by rounding.
        Some(name) if name == array => Some(levels),
        Some(name) => Some(surface.values(surfacing::values(p, "color_by", &volume, name)?)),
    };
    Shape::of_grid(surface, &volume.grid.points, colors).smoothed(p)?.painted(call, &own, &why)
}
