//! `calculator`: an array from others by an expression.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;
use voltet_core::expression::{Expression, NamedArray};
use voltet_core::grid::{Array, Grid, means_at_points};
use voltet_core::parameters::suggest;
use voltet_core::{Error, Result, counted};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, Port, PortType,
    RunContext, SourceSpan, Value,
};

/// The declaration.
pub const NODE: Node = Node {
    name: "calculator",
    summary: "Computes an array from others by an expression, and draws it.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with the arrays" }],
    outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the same with the result" }],
    parameters: &[
        Parameter {
            name: "expression",
            parameter_type: ParameterType::Text,
            unit: "",
            default: DefaultValue::Required,
            help: "numbers, arrays (u, V:X, 'mass fraction'), mag(V), + - * / ^, pi, abs, sqrt, cbrt, exp, ln, log10, sin, cos, tan, \
                   asin, acos, atan, atan2, sinh, cosh, tanh, floor, ceil, min, max, pow; in 64 bits",
        },
        Parameter {
            name: "name",
            parameter_type: ParameterType::Text,
            unit: "",
            default: DefaultValue::Text("result"),
            help: "the result's name",
        },
        Parameter {
            name: "association",
            parameter_type: ParameterType::Choice(&[
                ("point", "from point arrays, at the points"),
                ("cell", "from cell arrays, in the cells of the file; what is drawn are means at the points"),
            ]),
            unit: "",
            default: DefaultValue::Text("point"),
            help: "where the arrays are",
        },
        Parameter {
            name: "scalar",
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(true),
            help: "true: the result is the scalar that is drawn; false: an array beside it, computed where a node uses it",
        },
    ],
    example: include_str!("examples/calculator.toml"),
    check: &|parameters| Calculation::new(parameters).map(drop),
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

/// Calculation that the parameters state.
struct Calculation {
    expression: Expression,
    name: String,
    at_cells: bool,
    is_scalar: bool,
}

impl Calculation {
    fn new(p: &Parameters) -> Result<Calculation> {
        let text = p.text("expression")?;
        let expression = Expression::parse(text).map_err(|(error, span)| origin(p, &span).locate(error))?;
        let name = p.text("name")?.to_owned();
        if name.is_empty() || expression.arrays.iter().any(|array| array.name == name) {
            let error = p.error("name", "the result needs a name of its own").got(format!("'{name}'"));
            return Err(error.expected("a name that no array of the expression has"));
        }
        let at_cells = p.text("association")? == "cell";
        Ok(Calculation { expression, name, at_cells, is_scalar: p.flag("scalar")? })
    }

    /// True if the result is drawn, or a node downstream asks for it.
    fn is_needed(&self, demand: &Demand) -> bool {
        self.is_scalar
            || [&demand.arrays, &demand.cell_arrays].iter().any(|arrays| arrays.contains(&self.name))
    }
}

/// Location of some bytes of the expression.
fn origin(p: &Parameters, span: &Range<usize>) -> SourceSpan {
    p.optional("expression").map_or(SourceSpan::Nowhere, |setting| setting.origin_of(span.clone()))
}

fn demand(asking: &mut DemandContext) -> Result<()> {
    let calculation = Calculation::new(asking.parameters)?;
    let mut demand = asking.asked.clone();
    demand.arrays.named.remove(&calculation.name);
    demand.cell_arrays.named.remove(&calculation.name);
    if asking.exhaustive() || calculation.is_needed(asking.asked) {
        let arrays = if calculation.at_cells { &mut demand.cell_arrays } else { &mut demand.arrays };
        for array in &calculation.expression.arrays {
            arrays.named.insert(array.name.clone());
            arrays.origins.insert(array.name.clone(), origin(asking.parameters, &array.span));
        }
    } else {
        asking.notes.record_skipped(&calculation.name, "no node uses it", None);
    }
    asking.ask("grid", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let calculation = Calculation::new(call.parameters)?;
    let mut grid = Grid::clone(&*call.grid("grid")?);
    let is_needed = call.exhaustive() || calculation.is_needed(call.demand);
    call.notes.counts.insert("values_computed", 0);
    if !is_needed {
        return Ok(vec![Value::Grid(Arc::new(grid))]);
    }
    let arrays = arrays(call.parameters, &calculation, &grid)?;
    let count = match (arrays.first(), calculation.at_cells) {
        (Some(array), _) => array.values.len(),
        (None, true) => (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) + 1).max().unwrap_or(0),
        (None, false) => grid.points.len(),
    };
    let of =
        |stack: &mut Vec<f64>, i: usize| calculation.expression.value(|array| arrays[array].values[i], stack);
    let values: Vec<f64> = (0..count).into_par_iter().with_min_len(1024).map_init(Vec::new, of).collect();
    call.notes.counts.insert("values_computed", count as u64);
    let means = calculation.at_cells.then(|| means_at_points(&grid, &values));
    let at_points = means.as_deref().unwrap_or(&values);
    let is_wrong = |value: &&f64| !value.is_finite();
    if let Some(wrong) = at_points.iter().find(is_wrong) {
        let what = format!(
            "the expression is not finite at {}",
            counted(at_points.iter().filter(is_wrong).count(), "point")
        );
        let error = call.parameters.error("expression", what).got(wrong);
        return Err(error.expected("a finite number everywhere, as of ln(max(p, 1e-30)) in place of ln(p)"));
    }
    if calculation.is_scalar {
        (grid.scalar, grid.scalar_name) = (Some(at_points.to_vec().into()), calculation.name.clone());
    }
    let array = Arc::new(Array::from(at_points.to_vec()));
    grid.point_arrays.insert(calculation.name.clone(), array);
    if calculation.at_cells {
        grid.cell_arrays.insert(calculation.name, Arc::new(values.into()));
    }
    Ok(vec![Value::Grid(Arc::new(grid))])
}

/// The arrays of the expression, of one component each, all at the points or all in the cells.
fn arrays(p: &Parameters, calculation: &Calculation, grid: &Grid) -> Result<Vec<Arc<Array>>> {
    let named = &calculation.expression.arrays;
    let all = if calculation.at_cells { &grid.cell_arrays } else { &grid.point_arrays };
    let is_of_cells = |name: &str| grid.origin.arrays_of_cells.iter().any(|own| own == name);
    let of = |array: &NamedArray| {
        let name = &array.name;
        let located = |error: Error| origin(p, &array.span).locate(error);
        if !calculation.at_cells && is_of_cells(name) {
            let error =
                Error::usage(format!("'{name}' is an array of cells, and the expression is over points"));
            let accepted = match named.iter().all(|array| is_of_cells(&array.name)) {
                true => "association = \"cell\"",
                false => {
                    "point arrays alone, or cell arrays alone with association = \"cell\": a calculator \
                          of its own for each kind"
                }
            };
            return Err(located(error.expected(accepted)));
        }
        match all.get(name) {
            Some(found) if found.component_count == 1 => Ok(found.clone()),
            Some(found) => {
                let error = Error::usage(format!("'{name}' is no number"));
                let error = error.got(counted(found.component_count, "component"));
                Err(located(error.expected(format!("mag({name}), or {name}:0 for a component"))))
            }
            None => Err(located(
                Error::usage(format!("there is no array '{name}'"))
                    .expected(suggest(name, all.keys().map(String::as_str))),
            )),
        }
    };
    named.iter().map(of).collect()
}
