//! `probe`: the statistics of the data of a region, as a Gaussian widget.

use crate::relative::{self, DataScope, POSITION, RADIUS, RELATIVE_TO, placed};
use glam::DVec3;
use serde_json::json;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::error::ErrorKind;
use voltet_core::parameters::suggest;
use voltet_core::probing::{ProbeRegion, ProbeResult, kernel, probe, value_range};
use voltet_core::progress::Progress;
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget, with_placeholders};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, agreeing, counted};
use voltet_graph::{
    AxisRef, DefaultValue, Demand, DemandContext, Field, Node, Outputs, Parameter, ParameterType,
    ParameterValue, Parameters, Port, PortType, Range, RelativeNumberType, RunContext, StatisticKind,
    TransferFunctionSpec, Value,
};

pub const NODE: Node = Node {
    name: "probe",
    summary: "Places a Gaussian widget on the data of a region: their mean, deviations and correlation there.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the cells and their values" }],
    outputs: &[Port {
        name: "transfer_function",
        port_type: PortType::TransferFunction,
        summary: "the widget, for the input widgets of a transfer-function, or to draw alone",
    }],
    parameters: PARAMETERS,
    example: include_str!("examples/probe.toml"),
    check: &|parameters| {
        fields(parameters)?;
        check_region(parameters)
    },
    outline: &|parameters, _| {
        let names = fields(parameters)?;
        let n = names.as_ref().map_or(2, Vec::len);
        let look = look(parameters, names, vec![0.0; n], vec![vec![1.0; n]; n])?;
        Ok(vec![Value::TransferFunction(Arc::new(look))])
    },
    demand: &demand,
    other_steps: &relative::other_steps,
    run: &run,
    ..Node::BLANK
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let of_step = DataScope::from_parameters(asking.parameters)? == DataScope::Step;
    asking.ask("volume", &if of_step { demand_of(asking.parameters)? } else { Demand::default() })
}

fn demand_of(p: &Parameters) -> Result<Demand> {
    let names = fields(p)?;
    let mask = p.table("mask")?.map(|mask| mask.text("array").map(str::to_string)).transpose()?;
    Ok(Demand {
        gradient_magnitude: names.is_none(),
        arrays: names.into_iter().flatten().collect(),
        cell_arrays: mask.into_iter().collect(),
        ..Demand::default()
    })
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let p = call.parameters;
    let names = fields(p)?;
    let scope = DataScope::from_parameters(p)?;
    let found = match scope {
        DataScope::Step => of_volume(call)?,
        _ => of_series(call, scope)?,
    };
    let matrix = kernel(&found, p.number("least_sigma")?, p.number("sigma_scale")?, p.flag("correlated")?);
    let names_shown = names.clone().unwrap_or_else(|| vec!["s".into(), "g".into()]);
    for (name, _) in names_shown.iter().zip(&found.extent).filter(|(_, extent)| **extent == 0.0) {
        let what = format!("{name} is constant over the whole grid: the widget does not look at it");
        call.notes.warnings.push(what);
    }
    let over = match scope {
        DataScope::Step => String::new(),
        _ => format!(" ({})", scope.phrase(call)?),
    };
    call.notes.find(sentence(&found, &names_shown) + &over, figures(&found, &names_shown, &matrix));
    let mut look = look(p, names, found.mean, matrix)?;
    look.series_diagonal = relative::series_diagonal(call)?;
    Ok(vec![Value::TransferFunction(Arc::new(look))])
}

fn of_volume(call: &mut RunContext) -> Result<ProbeResult> {
    let (p, volume) = (call.parameters, call.volume("volume")?);
    let own = placed(p, volume.grid.bounds())?;
    if own != *p {
        relative::note_numbers(&mut call.notes, "region", "over the bounds", p, &own);
    }
    let found = call.stage("probe", |progress| probed(p, &volume, progress))?;
    if let ProbeRegion::Points(points) = region(&own)?
        && found.point_count < points.len() as u64
    {
        let outside = points.len() as u64 - found.point_count;
        let (of, lie) = (counted(points.len(), "point"), agreeing(&outside, "lies", "lie"));
        call.notes.warnings.push(format!("{outside} of {of} {lie} in no cell that counts"));
    }
    Ok(found)
}

fn probed(p: &Parameters, volume: &Volume, progress: &dyn Progress) -> Result<ProbeResult> {
    let names = fields(p)?;
    let values = values(volume, names.as_deref()).map_err(|error| p.locate("fields", error))?;
    let (region, mask) = (region(&placed(p, volume.grid.bounds())?)?, mask(p, volume)?);
    probe(&volume.grid, &values, &region, mask.as_deref(), progress).map_err(|error| locate(p, error))
}

/// The probe of steps of the series together, each with the weight of its region.
fn of_series(call: &mut RunContext, scope: DataScope) -> Result<ProbeResult> {
    let (p, demand) = (call.parameters, demand_of(call.parameters)?);
    let kept = call.keep_over_steps("volume", &demand, || Ok(KeptProbes::default()))?;
    let mut kept = kept.0.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = kept.iter().find(|(known, _)| known == p) {
        return Ok(found.clone());
    }
    let steps = scope.steps(call.step_count("volume")?);
    let mut found: Option<PooledProbe> = None;
    call.each_step("volume", &demand, steps.as_deref(), &mut |_, value| {
        let Some(volume) = value.volume().transpose()? else { return Ok(()) };
        let names = fields(p)?;
        let ranges =
            values(&volume, names.as_deref())?.into_iter().map(value_range).collect::<Result<_>>()?;
        let own = PooledProbe { found: probed(p, &volume, call.progress())?, ranges };
        found = Some(match found.take() {
            Some(before) => before.with(own),
            None => own,
        });
        Ok(())
    })?;
    let none = || Error::run("the series has no steps that could be probed");
    let found = found.ok_or_else(none)?.found;
    kept.push((p.clone(), found.clone()));
    Ok(found)
}

/// Probes over steps of a series, by their parameters; a session keeps them.
#[derive(Default)]
struct KeptProbes(Mutex<Vec<(Parameters, ProbeResult)>>);

/// Moments of several steps together, with the range of each field.
struct PooledProbe {
    found: ProbeResult,
    ranges: Vec<[f64; 2]>,
}

impl PooledProbe {
    /// Both together. Moments of parts are merged about their own means (Chan, Golub and LeVeque 1979).
    fn with(self, other: PooledProbe) -> PooledProbe {
        let parts = [&self.found, &other.found];
        let weights =
            parts.map(|part| if part.point_count > 0 { part.point_count as f64 } else { part.volume });
        let shares = weights.map(|weight| weight / (weights[0] + weights[1]));
        let ranges: Vec<[f64; 2]> =
            self.ranges.iter().zip(&other.ranges).map(|(a, b)| [a[0].min(b[0]), a[1].max(b[1])]).collect();
        let extent: Vec<f64> = ranges.iter().map(|[low, high]| high - low).collect();
        let fields = 0..extent.len();
        let mean = |i: usize| parts[0].mean[i] * shares[0] + parts[1].mean[i] * shares[1];
        let between = |i: usize| parts[1].mean[i] - parts[0].mean[i];
        let covariance = |i: usize, j: usize| {
            let unit = extent[i] * extent[j];
            let within = |part: &ProbeResult| part.covariance[i][j] * part.extent[i] * part.extent[j];
            let sum = shares[0] * within(parts[0]) + shares[1] * within(parts[1]);
            let all = sum + shares[0] * shares[1] * between(i) * between(j);
            if unit > 0.0 { all / unit } else { 0.0 }
        };
        let found = ProbeResult {
            mean: fields.clone().map(mean).collect(),
            covariance: fields.clone().map(|i| fields.clone().map(|j| covariance(i, j)).collect()).collect(),
            extent: extent.clone(),
            cell_count: parts[0].cell_count + parts[1].cell_count,
            volume: parts[0].volume + parts[1].volume,
            point_count: parts[0].point_count + parts[1].point_count,
        };
        PooledProbe { found, ranges }
    }
}

/// Adds the place of the parameter that names the region.
fn locate(p: &Parameters, error: Error) -> Error {
    match ["box", "sphere", "points", "mask"].into_iter().find(|name| p.is_set(name)) {
        Some(name) if error.kind != ErrorKind::Cancelled => p.locate(name, error),
        _ => error,
    }
}

/// The values of the fields: one array each.
fn values<'a>(volume: &'a Volume, names: Option<&[String]>) -> Result<Vec<&'a [f64]>> {
    let Some(names) = names else {
        let g = volume.gradient_magnitude.as_ref().ok_or_else(|| {
            Error::usage("the probe looks at the gradient magnitude, and the volume has none")
                .expected("a node of type \"gradient-magnitude\" before this one, or fields = [\"NAME\"]")
        })?;
        return Ok(vec![&volume.scalar, g]);
    };
    names.iter().map(|name| volume.grid.field("the probe", name)).collect()
}

/// The widget alone: its extinction counts per unit distance of whatever it is wired into.
fn look(
    p: &Parameters,
    names: Option<Vec<String>>,
    centre: Vec<f64>,
    matrix: Vec<Vec<f64>>,
) -> Result<TransferFunctionSpec> {
    let profile = match names {
        Some(fields) => Profile::GaussianNd { fields, centre, matrix },
        None => Profile::Gaussian {
            centre: [centre[0], centre[1]],
            matrix: [[matrix[0][0], matrix[0][1]], [matrix[1][0], matrix[1][1]]],
        },
    };
    let widget =
        Widget { profile, color: p.color("color")?, extinction: p.number("extinction")?, region: None };
    let model = OpticalModel::DensityEmitter;
    let transfer_function =
        TransferFunction { model, unit_distance: 1.0, widgets: vec![widget], axes: Default::default() };
    Ok(TransferFunctionSpec::new(transfer_function, true))
}

/// The parameters, for the declaration.
pub const PARAMETERS: &[Parameter] = &[
    Parameter {
        name: "box",
        parameter_type: ParameterType::Table(&[
            Parameter { name: "low", help: "lowest x, y, z", ..POSITION },
            Parameter { name: "high", help: "highest x, y, z", ..POSITION },
        ]),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the parts of cells in a box, cut exactly",
    },
    Parameter {
        name: "sphere",
        parameter_type: ParameterType::Table(&[
            Parameter { name: "centre", help: "its centre", ..POSITION },
            Parameter { help: "its radius; a percentage: of the diagonal of the bounds", ..RADIUS },
        ]),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the parts of cells in a ball, whose volume is met to 1e-6",
    },
    Parameter {
        name: "points",
        parameter_type: ParameterType::Measured(&RelativeNumberType {
            plain: ParameterType::Rows(Some(3)),
            statistic: StatisticKind::Place,
            axis: AxisRef::Places(&["x", "y", "z"]),
        }),
        unit: "world units",
        default: DefaultValue::Unset("another region"),
        help: "the region: the values at points [x, y, z], each counting the same",
    },
    Parameter {
        name: "mask",
        parameter_type: ParameterType::Table(&[
            Parameter {
                name: "array",
                parameter_type: ParameterType::ArrayName,
                unit: "",
                help: "a cell array of one component; \"NAME:0\" and \"NAME:magnitude\" for vectors",
                ..POSITION
            },
            Parameter {
                name: "equals",
                parameter_type: ParameterType::Number(Range::ANY),
                unit: "as in the array",
                default: DefaultValue::Unset("any but 0"),
                help: "the value of the cells that count",
            },
        ]),
        unit: "",
        default: DefaultValue::Unset("all cells"),
        help: "the region, or what counts in it: cells by the value of a cell array",
    },
    Parameter {
        name: "fields",
        parameter_type: ParameterType::ArrayNames,
        unit: "",
        default: DefaultValue::Unset("s and g, as a gaussian"),
        help: "one to eight point arrays to look at instead, as a gaussian-nd",
    },
    Parameter {
        name: "color",
        parameter_type: ParameterType::Color(Range::at_least(0.0)),
        unit: "linear RGB",
        default: DefaultValue::Numbers(&[1.0, 1.0, 1.0]),
        help: "colour of the widget; components may exceed 1",
    },
    Parameter {
        name: "extinction",
        parameter_type: ParameterType::Number(Range::at_least(0.0)),
        unit: "per unit_distance",
        default: DefaultValue::Number(1.0),
        help: "peak of the extinction, per unit_distance of the transfer-function that it is wired into",
    },
    Parameter {
        name: "sigma_scale",
        parameter_type: ParameterType::Number(Range::above(0.0)),
        unit: "",
        default: DefaultValue::Number(1.0),
        help: "factor on the standard deviations: above 1 the widget reaches beyond what was probed",
    },
    Parameter {
        name: "least_sigma",
        parameter_type: ParameterType::Number(Range::within(1e-6, 1.0)),
        unit: "share of a field's range in the data",
        default: DefaultValue::Number(1e-3),
        help: "smallest deviation in any direction, before sigma_scale: where the data do not vary, or exactly together",
    },
    Parameter {
        name: "correlated",
        parameter_type: ParameterType::Boolean,
        unit: "",
        default: DefaultValue::Boolean(true),
        help: "true: a full matrix, tilted as the fields vary together; false: along the axes",
    },
    Parameter {
        help: "the data that are probed: each step's own, or steps of the series together",
        ..RELATIVE_TO
    },
];

/// The point arrays that the parameters name; `None`: s and g.
pub fn fields(p: &Parameters) -> Result<Option<Vec<String>>> {
    let Some(_) = p.optional("fields") else { return Ok(None) };
    let names = p.texts("fields")?;
    let distinct = (1..names.len()).all(|i| !names[..i].contains(&names[i]));
    match (1..=8).contains(&names.len()) && distinct && !names.iter().any(String::is_empty) {
        true => Ok(Some(names)),
        false => {
            let error = p.error("fields", "'fields' cannot be probed").got(format!("{names:?}"));
            Err(error.expected("1 to 8 different names of point arrays"))
        }
    }
}

/// Checks the region as far as it can be before the grid is known: whether a box that mixes percentages and numbers is empty
/// is not.
pub fn check_region(p: &Parameters) -> Result<()> {
    let of_box = p.table("box")?.map_or(0, |table| table.relative_numbers().len());
    let corner = |name: &str, at: f64| Field::new(name, [at; 3].into_iter().collect::<ParameterValue>());
    let any_box = || ParameterValue::Table(vec![corner("low", 0.0), corner("high", 1.0)]);
    let p = if matches!(of_box, 1..=5) { p.with("box", Some(any_box())) } else { p.clone() };
    region(&with_placeholders(&p)?).map(drop)
}

/// The region that the parameters name.
pub fn region(p: &Parameters) -> Result<ProbeRegion> {
    let mut regions = Vec::new();
    if let Some(table) = p.table("box")? {
        let (low, high): (DVec3, DVec3) = (table.vector("low")?.into(), table.vector("high")?.into());
        if low.cmpge(high).any() {
            let error = table.error("high", "the box is empty").got(format!("from {low} to {high}"));
            return Err(error.expected("'low' below 'high' along every axis"));
        }
        regions.push(ProbeRegion::Box { low, high });
    }
    if let Some(table) = p.table("sphere")? {
        let (centre, radius) = (table.vector("centre")?.into(), table.number("radius")?);
        regions.push(ProbeRegion::Sphere { centre, radius });
    }
    if p.optional("points").is_some() {
        let points = p.rows("points")?;
        regions.push(ProbeRegion::Points(points.iter().map(|row| DVec3::from_slice(row)).collect()));
    }
    let accepted = "one of box, sphere and points, or a mask, which may also go with one of them";
    match (regions.pop(), regions.is_empty(), p.optional("mask").is_some()) {
        (Some(region), true, _) => Ok(region),
        (None, _, true) => Ok(ProbeRegion::Everywhere),
        (None, _, false) => Err(Error::usage("the probe has no region").expected(accepted)),
        (Some(_), false, _) => Err(Error::usage("the probe has several regions").expected(accepted)),
    }
}

/// True if a tetrahedron counts.
pub type Holds<'a> = Box<dyn Fn(usize) -> bool + Sync + 'a>;

/// Selection of tetrahedra by the parameters.
pub fn mask<'a>(p: &Parameters, volume: &'a Volume) -> Result<Option<Holds<'a>>> {
    let Some(table) = p.table("mask")? else { return Ok(None) };
    let name = table.text("array")?;
    let grid = &volume.grid;
    let Some(array) = grid.cell_arrays.get(name).filter(|array| array.component_count == 1) else {
        let error = table.error("array", format!("the mask '{name}' is not an array with one number a cell"));
        let scalars = grid.cell_arrays.iter().filter(|(_, array)| array.component_count == 1);
        let known = suggest(name, scalars.map(|(name, _)| name.as_str()));
        return Err(
            error.expected(format!("a cell array of one component ({known}), or \"NAME:0\" for a component"))
        );
    };
    let equals = table.optional_number("equals");
    let counts = move |value: f64| equals.map_or(value != 0.0 && !value.is_nan(), |wanted| value == wanted);
    Ok(Some(Box::new(move |i| counts(array.values[grid.source_cell(i)]))))
}

/// Mean and deviation of each field.
pub fn sentence(found: &ProbeResult, names: &[String]) -> String {
    let sigma = found.sigma();
    let field = |k: usize| format!("{} {}", names[k], with_deviation(found.mean[k], sigma[k]));
    let fields: Vec<String> = (0..names.len()).map(field).collect();
    let place = match found.point_count {
        0 => format!("{}, volume {:.6e}", counted(found.cell_count, "cell"), found.volume),
        count => format!("{} in {}", counted(count, "point"), counted(found.cell_count, "cell")),
    };
    format!("{} ({place})", fields.join(", "))
}

/// A mean and its deviation, to three digits of the deviation.
fn with_deviation(mean: f64, sigma: f64) -> String {
    if sigma <= 0.0 {
        return format!("{mean:?} ± 0");
    }
    let decimals = 2.0 - sigma.log10().floor();
    match (0.0..=9.0).contains(&decimals) && mean.abs() < 1e9 {
        true => format!("{mean:.0$} ± {sigma:.0$}", decimals as usize),
        // Far from 0 as many as tell the deviation, of the 17 that there are.
        false => {
            let digits = (2.0 + (mean.abs() / sigma).log10()).clamp(8.0, 16.0) as usize;
            format!("{mean:.digits$e} ± {sigma:.2e}")
        }
    }
}

/// Figures from which a pipeline file can state the widget, and their source.
pub fn figures(found: &ProbeResult, names: &[String], matrix: &[Vec<f64>]) -> serde_json::Value {
    let n = names.len();
    let covariance = |i: usize, j: usize| found.covariance[i][j] * found.extent[i] * found.extent[j];
    let covariance: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| covariance(i, j)).collect()).collect();
    json!({
        "fields": names,
        "centre": found.mean,
        "sigma": found.sigma(),
        "covariance": covariance,
        "matrix": matrix,
        "cells": found.cell_count,
        "volume": found.volume,
        "points": found.point_count,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_show_three_digits_of_their_deviation() {
        for (mean, sigma, wanted) in [
            (457.889822, 32.208, "457.9 ± 32.2"),
            (0.0270821, 0.00012345, "0.027082 ± 0.000123"),
            (1e8 + 0.5, 0.00289, "100000000.50000 ± 0.00289"),
            (5.0, 0.0, "5.0 ± 0"),
            (-2.5e-20, 3e-21, "-2.50000000e-20 ± 3.00e-21"),
            (7e6, 12345.0, "7.00000000e6 ± 1.23e4"),
            (5e12 + 3.0, 1.5, "5.00000000000300e12 ± 1.50e0"),
        ] {
            assert_eq!(with_deviation(mean, sigma), wanted);
        }
    }
}
