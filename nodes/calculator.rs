//! `calculator`: an array from others by an expression.

use crate::gradient_magnitude::METHOD;
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use voltet_core::expression::{Dimension, Expression, NamedArray};
use voltet_core::field::Derivative;
use voltet_core::grid::{Array, CellValues, Grid, add_from_cells};
use voltet_core::parameters::suggest;
use voltet_core::{Error, Result, counted};
use voltet_graph::{
    DefaultValue, Demand, DemandContext, Node, Outputs, Parameter, ParameterType, Parameters, PartWork, Port,
    PortType, RunContext, SourceSpan, Value,
};

pub const NODE: Node = Node {
    name: "calculator",
    summary: "Computes an array from others by an expression, and makes it the scalar that is drawn.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with the arrays" }],
    optional_inputs: &[Port {
        name: "other",
        port_type: PortType::Grid,
        summary: "a second grid of the same points and cells, whose arrays are named other.T: another step or run",
    }],
    outputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the same with the result" }],
    parameters: &[
        Parameter {
            name: "expression",
            parameter_type: ParameterType::Expression,
            unit: "",
            default: DefaultValue::Required,
            help: "such as \"mag(V) - ln(p)/2\": arrays, x y z, + - * / ^ and the functions that docs/src/how-to/calculator.md lists",
        },
        Parameter {
            name: "name",
            parameter_type: ParameterType::NewArrayName,
            unit: "",
            default: DefaultValue::Text("result"),
            help: "the result's name",
        },
        Parameter {
            name: "association",
            parameter_type: ParameterType::Choice(&[
                ("point", "from point arrays, at the points"),
                ("cell", "from cell arrays, in the cells of the file"),
            ]),
            unit: "",
            default: DefaultValue::Text("point"),
            help: "where the arrays are",
        },
        Parameter { help: "what becomes of a result in the cells", ..crate::reader::CELL_VALUES },
        Parameter {
            name: "scalar",
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(true),
            help: "true: the result is the scalar that is drawn, in place of the input's; false: an array beside it",
        },
        Parameter {
            help: "the filter for gradients in the expression; its own parameters stand beside this one",
            ..METHOD
        },
        Parameter {
            name: "units",
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("none are checked"),
            help: "units of arrays, such as [\"p = kPa\", \"U = m/s\"]: sums of unlike units are errors; numbers are not converted",
        },
        Parameter {
            name: "unit",
            default: DefaultValue::Unset("any"),
            help: "unit of the result, which those of the arrays must give; numbers are not converted",
            ..UNIT
        },
        Parameter {
            name: "length_unit",
            default: DefaultValue::Unset("not known, nor are units of gradients"),
            help: "unit of the coordinates, for gradients in the expression",
            ..UNIT
        },
    ],
    example: include_str!("examples/calculator.toml"),
    check: &|parameters| Calculation::new(parameters).map(drop),
    demand: &demand,
    part_work: PartWork::Each,
    run: &run,
    ..Node::BLANK
};

const UNIT: Parameter = Parameter {
    name: "",
    parameter_type: ParameterType::Text,
    unit: "",
    default: DefaultValue::Unset(""),
    help: "",
};

/// The axis whose coordinates a name stands for where there is no array of it.
fn axis(name: &str) -> Option<usize> {
    ["x", "y", "z"].iter().position(|axis| *axis == name)
}

/// Beginning of the names of arrays of the input `other`.
const OTHER: &str = "other.";

struct Calculation {
    expression: Expression,
    name: String,
    at_cells: bool,
    cell_values: CellValues,
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
        if let Some(array) = expression.arrays.iter().find(|array| array.derivative.is_some()) {
            let located = |error: Error| Err(origin(p, &array.span).locate(error));
            if at_cells {
                let error = Error::usage("gradients are those of point arrays").got("association = \"cell\"");
                return located(error.expected("association = \"point\""));
            }
            if p.text("method")? == "array" {
                let error = p.error("method", "an array holds the gradient of one field");
                return Err(error.expected("a method that computes gradients"));
            }
        }
        check_units(p, &expression)?;
        let cell_values = crate::reader::cell_values(p)?;
        Ok(Calculation { expression, name, at_cells, cell_values, is_scalar: p.flag("scalar")? })
    }

    /// True if the result is drawn, or a node downstream asks for it.
    fn is_needed(&self, demand: &Demand) -> bool {
        let as_cell_array = self.at_cells && demand.cell_arrays.contains(&self.name);
        self.is_scalar || demand.arrays.contains(&self.name) || as_cell_array
    }
}

/// Checks that the units of the expression agree, where some are stated.
fn check_units(p: &Parameters, expression: &Expression) -> Result<()> {
    let units = units(p, expression)?;
    let unit = |name: &str| {
        let read = |text| Dimension::parse(text).map_err(|error| p.locate(name, error));
        p.optional(name).and_then(|setting| setting.text()).map(read).transpose()
    };
    let (length, wanted) = (unit("length_unit")?, unit("unit")?);
    if units.is_empty() {
        let Some(name) = ["unit", "length_unit"].into_iter().find(|name| p.is_set(name)) else {
            return Ok(());
        };
        let error =
            p.error(name, format!("'{name}' is checked against units of arrays, and none are stated"));
        return Err(error.expected("units = [\"ARRAY = UNIT\"] too"));
    }
    let of = |array: &str| units.get(own_name(array)).or_else(|| units.get(vector_name(array))).copied();
    let text = p.text("expression")?;
    let found = expression.dimension(text, of, length);
    let found = found.map_err(|(error, span)| origin(p, &span).locate(error))?;
    match (found, wanted) {
        (Some(found), Some(wanted)) if !found.is_like(wanted) => {
            let error = p.error("unit", "the expression has another unit").got(found);
            Err(error.expected(format!("{wanted}, as {} says", p.get("unit")?.datum)))
        }
        _ => Ok(()),
    }
}

/// The unit of each array that has one. Errors: it cannot be read, is stated twice, or the expression has no such array.
fn units<'a>(p: &'a Parameters, expression: &Expression) -> Result<BTreeMap<&'a str, Dimension>> {
    let mut units = BTreeMap::new();
    for setting in p.optional("units").and_then(|setting| setting.list()).unwrap_or_default() {
        let Some((name, unit)) = setting.text().and_then(|text| text.rsplit_once('=')) else {
            return Err(setting.error("a unit names no array", "\"ARRAY = UNIT\", such as \"p = kPa\""));
        };
        let name = name.trim();
        let dimension = Dimension::parse(unit.trim()).map_err(|error| setting.origin.locate(error))?;
        let names = || expression.arrays.iter().map(|array| own_name(&array.name));
        if !names().any(|own| own == name || vector_name(own) == name) {
            return Err(
                setting.error("a unit is of an array that the expression lacks", suggest(name, names()))
            );
        }
        if units.insert(name, dimension).is_some() {
            return Err(
                setting.error(format!("the unit of '{name}' is stated twice"), "one unit for each array")
            );
        }
    }
    Ok(units)
}

/// The array's name in its own grid.
fn own_name(array: &str) -> &str {
    array.strip_prefix(OTHER).unwrap_or(array)
}

/// The name of the array whose component or length this is.
fn vector_name(array: &str) -> &str {
    own_name(array).rsplit_once(':').map_or(own_name(array), |(name, _)| name)
}

/// Location of some bytes of the expression.
fn origin(p: &Parameters, span: &Range<usize>) -> SourceSpan {
    p.optional("expression").map_or(SourceSpan::Nowhere, |setting| setting.origin_of(span.clone()))
}

fn demand(asking: &mut DemandContext) -> Result<()> {
    let calculation = Calculation::new(asking.parameters)?;
    let mut demand = asking.asked.clone();
    let mut of_other = Demand { without_scalar: true, ..Demand::default() };
    demand.arrays.named.remove(&calculation.name);
    demand.arrays.optional.remove(&calculation.name);
    if calculation.at_cells {
        demand.cell_arrays.named.remove(&calculation.name);
    }
    demand.without_scalar |= calculation.is_scalar;
    if !asking.exhaustive() && !calculation.is_needed(asking.asked) {
        asking.notes.record_skipped(&calculation.name, "no node uses it", None);
        asking.ask("other", &of_other)?;
        return asking.ask("grid", &demand);
    }
    let has_other = asking.fed_by("other")?.is_some();
    for array in &calculation.expression.arrays {
        let NamedArray { name, derivative, span } = array;
        let origin = origin(asking.parameters, span);
        let (demand, name) = match name.strip_prefix(OTHER) {
            Some(name) if has_other => (&mut of_other, name),
            Some(_) => {
                let error = Error::usage(format!("'{name}' is of the input 'other', which is not wired"));
                return Err(origin.locate(error.expected("inputs = { grid = \"NODE\", other = \"NODE\" }")));
            }
            None => (&mut demand, name.as_str()),
        };
        if derivative.is_some() {
            demand.arrays.named.extend(asking.method()?.arrays()?);
        }
        let arrays = if calculation.at_cells { &mut demand.cell_arrays } else { &mut demand.arrays };
        match axis(name).filter(|_| !calculation.at_cells && name == array.name) {
            Some(_) => drop(arrays.optional.insert(name.to_owned())),
            None => arrays.request(name, origin),
        }
    }
    if has_other && of_other.arrays.named.is_empty() && of_other.cell_arrays.named.is_empty() {
        let error = asking.parameters.error("expression", "no array is of the input 'other', which is wired");
        return Err(error.expected("an array such as other.T, or no input 'other'"));
    }
    asking.ask("other", &of_other)?;
    asking.ask("grid", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let calculation = Calculation::new(call.parameters)?;
    let mut grid = Grid::clone(&*call.grid("grid")?);
    call.notes.counts.insert("values_computed", 0);
    if !call.exhaustive() && !calculation.is_needed(call.demand) {
        return Ok(vec![Value::Grid(Arc::new(grid))]);
    }
    let other = call.is_wired("other")?.then(|| call.grid("other")).transpose()?;
    if let Some(other) = &other {
        let at_expression = |error| call.parameters.locate("expression", error);
        refuse_other_mesh(&grid, other).map_err(at_expression)?;
    }
    let arrays = arrays(call, &calculation, &grid, other.as_deref())?;
    let count = match (arrays.first(), calculation.at_cells) {
        (Some(array), _) => array.values.len(),
        (None, true) => (0..grid.tetrahedra.len()).map(|i| grid.source_cell(i) + 1).max().unwrap_or(0),
        (None, false) => grid.points.len(),
    };
    let of =
        |stack: &mut Vec<f64>, i: usize| calculation.expression.value(|array| arrays[array].values[i], stack);
    let values: Vec<f64> = (0..count).into_par_iter().with_min_len(1024).map_init(Vec::new, of).collect();
    call.notes.counts.insert("values_computed", count as u64);
    // What is left are the arrays that nodes downstream use.
    grid.point_arrays.retain(|name, _| call.demand.arrays.contains(name));
    grid.cell_arrays.retain(|name, _| call.demand.cell_arrays.contains(name));
    let (name, array) = (calculation.name, Array::from(values));
    let unit = call.parameters.optional("unit").and_then(|unit| unit.text());
    set_unit(&mut grid, &name, unit);
    if calculation.at_cells {
        grid.cell_arrays.insert(name.clone(), Arc::new(array.clone()));
        if !calculation.is_scalar && !call.demand.arrays.contains(&name) {
            return Ok(vec![Value::Grid(Arc::new(grid))]);
        }
        if call.part().is_some() && calculation.cell_values == CellValues::Average {
            let what = "means of cell values at points are found in whole grids";
            let error = call.parameters.error("association", what).got("a grid in parts (--memory)");
            return Err(
                error.expected("association = \"point\", cell_values = \"constant\", or a larger --memory")
            );
        }
        add_from_cells(&mut grid, &name, array, calculation.cell_values)?;
    } else {
        grid.point_arrays.insert(name.clone(), Arc::new(array));
    }
    let at_points = grid.point_array(&name, 1)?.values.clone();
    let is_wrong = |value: &&f64| !value.is_finite();
    if let Some(wrong) = at_points.iter().find(is_wrong) {
        let wrong_count = counted(at_points.iter().filter(is_wrong).count(), "point");
        let what = format!("the expression is not finite at {wrong_count}");
        let error = call.parameters.error("expression", what).got(wrong);
        return Err(error.expected("a finite number everywhere, as of ln(max(p, 1e-30)) in place of ln(p)"));
    }
    if !call.demand.arrays.contains(&name) {
        grid.point_arrays.remove(&name);
    }
    if calculation.is_scalar {
        (grid.scalar, grid.scalar_name) = (Some(at_points), name);
    }
    Ok(vec![Value::Grid(Arc::new(grid))])
}

/// Sets the unit of an array: an array of the file that had the name is no more.
fn set_unit(grid: &mut Grid, name: &str, unit: Option<&str>) {
    if unit.is_none() && !grid.origin.units.contains_key(name) {
        return;
    }
    let units = &mut Arc::make_mut(&mut grid.origin).units;
    match unit {
        Some(unit) => units.insert(name.to_owned(), unit.to_owned()),
        None => units.remove(name),
    };
}

/// The arrays of the expression, one number each at the points or in the cells.
fn arrays(
    call: &mut RunContext,
    calculation: &Calculation,
    grid: &Grid,
    other: Option<&Grid>,
) -> Result<Vec<Arc<Array>>> {
    let mut arrays: Vec<Arc<Array>> = Vec::new();
    // Gradients of the components of each array.
    let mut gradients: BTreeMap<&str, Vec<Vec<glam::DVec3>>> = BTreeMap::new();
    for array in &calculation.expression.arrays {
        let (grid, name) = match array.name.strip_prefix(OTHER).zip(other) {
            Some((name, other)) => (other, name),
            None => (grid, array.name.as_str()),
        };
        let locate = |p: &Parameters, error| origin(p, &array.span).locate(error);
        let found = found(calculation, grid, name, array).map_err(|error| locate(call.parameters, error))?;
        if let Some(first) =
            arrays.first().filter(|first| first.values.len() * found.component_count != found.values.len())
        {
            let error = Error::run(format!("'{name}' is of another number of cells"));
            let error = error.got(found.values.len()).expected(first.values.len());
            return Err(locate(call.parameters, error));
        }
        let Some(derivative) = array.derivative else {
            arrays.push(found);
            continue;
        };
        if !gradients.contains_key(array.name.as_str()) {
            gradients.insert(&array.name, gradients_of(call, grid, &array.name, &found)?);
            *call.notes.counts.entry("gradients_computed").or_default() += found.component_count as u64;
        }
        arrays.push(Arc::new(derived(derivative, &gradients[array.name.as_str()]).into()));
    }
    Ok(arrays)
}

fn gradients_of(
    call: &mut RunContext,
    grid: &Grid,
    name: &str,
    array: &Array,
) -> Result<Vec<Vec<glam::DVec3>>> {
    let component_count = array.component_count;
    let of = |component: usize| {
        let values: Vec<f64> =
            array.values.iter().skip(component).step_by(component_count).copied().collect();
        let gradient = call.method()?.gradient(grid, &values, call.progress())?;
        for fallback in &gradient.fallbacks {
            call.notes.warnings.push(format!("'{name}': {fallback}"));
        }
        Ok(gradient.vectors)
    };
    (0..component_count).map(of).collect()
}

fn derived(derivative: Derivative, gradients: &[Vec<glam::DVec3>]) -> Vec<f64> {
    let at = |component: usize, p: usize| gradients.get(component).map_or(glam::DVec3::ZERO, |all| all[p]);
    let points = (0..gradients[0].len()).into_par_iter().with_min_len(1024);
    points.map(|p| derivative.value([0, 1, 2].map(|component| at(component, p)))).collect()
}

/// An array of the expression: a number, or what its derivative is of. Points and cells are not mixed.
fn found(calculation: &Calculation, grid: &Grid, name: &str, array: &NamedArray) -> Result<Arc<Array>> {
    let all = if calculation.at_cells { &grid.cell_arrays } else { &grid.point_arrays };
    let is_of_cells = |name: &str| grid.origin.arrays_of_cells.iter().any(|own| own == name);
    if !calculation.at_cells && is_of_cells(name) {
        let error = Error::usage(format!("'{name}' is an array of cells, and the expression is over points"));
        let arrays = &calculation.expression.arrays;
        let own_name =
            |array: &NamedArray| is_of_cells(array.name.strip_prefix(OTHER).unwrap_or(&array.name));
        return Err(error.expected(match arrays.iter().all(own_name) {
            true => "association = \"cell\"",
            false => {
                "point arrays alone, or cell arrays alone with association = \"cell\": a calculator of its \
                      own for each kind"
            }
        }));
    }
    let place = axis(name).filter(|_| name == array.name && !all.contains_key(name));
    if let Some(axis) = place.filter(|_| !calculation.at_cells) {
        let coordinates: Vec<f64> = grid.points.iter().map(|point| point[axis]).collect();
        return Ok(Arc::new(coordinates.into()));
    }
    let Some(found) = all.get(name) else {
        let error = Error::usage(format!("there is no array '{name}'"));
        return Err(error.not_among(name, all.keys().map(String::as_str)));
    };
    match (array.derivative.map_or(1, Derivative::component_count), found.component_count) {
        (wanted, count) if wanted == count => Ok(found.clone()),
        (1, count) => {
            let error = Error::usage(format!("'{name}' is no number")).got(counted(count, "component"));
            Err(error.expected(format!("mag({name}), or {name}:0 for a component")))
        }
        (wanted, count) => {
            let error = Error::usage(format!("'{name}' is no vector of space"));
            Err(error.got(counted(count, "component")).expected(counted(wanted, "component")))
        }
    }
}

/// Positions that differ by no more than this part of the grid's extent are the same: files hold them in 32 bits or in 64.
const SAME_PLACE: f64 = 1e-6;

fn refuse_other_mesh(grid: &Grid, other: &Grid) -> Result<()> {
    let error = Error::run("the input 'other' is of another mesh than 'grid'");
    let size = |grid: &Grid| {
        format!(
            "{} and {}",
            counted(grid.points.len(), "point"),
            counted(grid.tetrahedra.len(), "tetrahedron")
        )
    };
    if size(grid) != size(other) {
        return Err(error.got(size(other)).expected(size(grid)));
    }
    let count = grid.tetrahedra.len();
    let differs =
        |&i: &usize| grid.tetrahedra[i] != other.tetrahedra[i] || grid.source_cell(i) != other.source_cell(i);
    if let Some(i) = (0..count).find(differs) {
        let error = error.got(format!("other points at cell {}", other.source_cell(i)));
        return Err(error.expected("the same cells in the same order"));
    }
    let [low, high] = grid.bounds().unwrap_or_default();
    let near = SAME_PLACE * (high - low).max_element();
    let is_elsewhere = |&p: &usize| (grid.points[p] - other.points[p]).abs().max_element() > near;
    match (0..grid.points.len()).find(is_elsewhere) {
        None => Ok(()),
        Some(p) => {
            let at = |grid: &Grid| format!("point {p} at {}", grid.points[p]);
            Err(error.got(at(other)).expected(at(grid)))
        }
    }
}
