//! `edges`: the edges of cells on the boundary, those of the boundary's features, or those of the box of the data, as tubes.

use crate::relative::{self, RELATIVE_TO};
use crate::surfacing::tubing::{self, tube_parameters};
use crate::surfacing::{self, Shape, with_paint};
use glam::DVec3;
use voltet_core::Result;
use voltet_core::grid::{Grid, boundary, boundary_edges, extent, feature_edges};
use voltet_graph::{
    DefaultValue, Demand, Node, Outputs, Parameter, ParameterType, Parameters, Range, RunContext,
};

pub const NODE: Node = Node {
    name: "edges",
    summary: "Makes tubes of edges: of the cells on the outside of the grid, of its features, or of the box of the data.",
    inputs: surfacing::INPUTS,
    outputs: surfacing::OUTPUTS,
    parameters: &PARAMETERS,
    example: include_str!("examples/edges.toml"),
    check: &check,
    demand: &|asking| {
        let p = asking.parameters;
        let file_cells = p.text("kind")? == "cells";
        asking.ask("volume", &Demand { file_cells, ..Demand::default() })?;
        surfacing::ask(asking, [surfacing::color_by(p, None), None])
    },
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

const PARAMETERS: [Parameter; 13] = {
    let [radius, sides] = tube_parameters("0.1 %");
    with_paint(
        [
            Parameter {
                name: "kind",
                parameter_type: ParameterType::Choice(&[
                    ("features", "where the boundary turns by more than 'feature_angle'"),
                    ("cells", "of the faces of the file's cells on the boundary, without diagonals"),
                    ("outline", "of the box of the data"),
                ]),
                unit: "",
                default: DefaultValue::Text("features"),
                help: "which edges",
            },
            Parameter {
                name: "feature_angle",
                parameter_type: ParameterType::Number(Range::within(0.0, 180.0)),
                unit: "degrees",
                default: DefaultValue::Number(30.0),
                help: "least angle between the normals of two faces at an edge of a feature",
            },
            radius,
            Parameter { default: DefaultValue::Integer(8), ..sides },
            RELATIVE_TO,
        ],
        "one colour",
        1.0,
        0.3,
    )
};

fn check(p: &Parameters) -> Result<()> {
    let kind = p.text("kind")?;
    if kind != "features" && p.is_set("feature_angle") {
        let error = p.error("feature_angle", format!("edges of the kind \"{kind}\" have no such angle"));
        return Err(error.expected("kind = \"features\", or no feature_angle"));
    }
    if kind == "outline" && p.is_set("color_by") {
        let error = p.error("color_by", "a box has no values");
        return Err(error.expected("color = \"#rrggbb\", or another kind"));
    }
    surfacing::check(p)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let grid = &volume.grid;
    let color_by = surfacing::color_by(p, None);
    let own = surfacing::known_of_volume(call, &volume, "s", color_by)?;
    let values = color_by.map(|name| surfacing::values(p, "color_by", &volume, name)).transpose()?;
    let (points, edges): (&[DVec3], _) = match p.text("kind")? {
        "outline" => (&extent::corners(grid.bounds().unwrap_or_default()), box_edges()),
        "cells" => (&grid.points, cell_edges(call, grid)?),
        _ => (&grid.points, of_features(call, grid, p.number("feature_angle")?)?),
    };
    let tubes = tubing::made(call, &own, points, &edges, &[])?;
    Shape::of_tubes(tubes, values, None).painted(call, &own, "the boundary of the grid has no such edges")
}

fn box_edges() -> Vec<[u32; 2]> {
    let from = |corner: u32| [1, 2, 4].map(|bit| [corner, corner | bit]);
    (0..8).flat_map(from).filter(|[a, b]| a != b).collect()
}

fn cell_edges(call: &mut RunContext, grid: &Grid) -> Result<Vec<[u32; 2]>> {
    let found = call.stage("edges", |progress| boundary_edges(grid, progress))?;
    if found.has_diagonals {
        let why = "some cells are not known as the file has them (curved ones, ones of constant values, or ones that a node changed): \
                   of these the edges of the pieces that they are drawn as are shown";
        call.notes.warnings.push(why.into());
    }
    Ok(found.edges)
}

/// Edges at which the boundary turns, by points of the grid.
fn of_features(call: &mut RunContext, grid: &Grid, angle: f64) -> Result<Vec<[u32; 2]>> {
    call.stage("edges", |progress| {
        let surface = boundary(grid, progress)?;
        let edges = feature_edges(&surface.positions(&grid.points), &surface.triangles, angle);
        // Points of the boundary are points of the grid.
        Ok(edges.into_iter().map(|edge| edge.map(|p| surface.points[p as usize].ends[0])).collect())
    })
}
