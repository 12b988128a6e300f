//! `logarithm`: the common logarithm of the scalar, for values that span decades.

use std::sync::Arc;
use voltet::core::grid::Grid;
use voltet::core::{Error, Result};
use voltet::graph::{
    DefaultValue, Node, Outputs, Parameter, ParameterType, Port, PortType, Range, RunContext, Value,
};

/// The declaration; help, the checker and `explain` are made from it. What is asked of the node's output is asked of its
/// input too, unless it has a function `demand` of its own.
pub const NODE: Node = Node {
    name: "logarithm",
    summary: "Gives the grid with the common logarithm of its scalar.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with its scalar" }],
    outputs: &[Port {
        name: "grid",
        port_type: PortType::Grid,
        summary: "the same with log₁₀ of the scalar",
    }],
    parameters: &[Parameter {
        name: "least",
        parameter_type: ParameterType::Number(Range::above(0.0)),
        unit: "units of s",
        default: DefaultValue::Number(1e-30),
        help: "values below this are taken as this",
    }],
    example: include_str!("../own.toml"),
    run: &run,
    ..Node::BLANK
};

fn run(call: &mut RunContext) -> Result<Outputs> {
    let grid = call.grid("grid")?;
    let least = call.parameters.number("least")?;
    let Some(scalar) = &grid.scalar else {
        return Err(Error::usage("the grid carries no scalar").expected("scalar = \"…\" at the reader"));
    };
    let logarithms = scalar.iter().map(|s| s.max(least).log10()).collect();
    // Points, cells and arrays are shared, not copied.
    let grid = Grid {
        scalar: Some(logarithms),
        scalar_name: format!("log10({})", grid.scalar_name),
        ..Grid::clone(&grid)
    };
    Ok(vec![Value::Grid(Arc::new(grid))])
}
