//! `probe`: the statistics of the data where somebody points at them, as a Gaussian widget.

use crate::probing::{PARAMETERS, check_region, fields, figures, mask, placed, region, sentence};
use crate::relative;
use std::sync::Arc;
use voltet_core::error::ErrorKind;
use voltet_core::probing::{ProbeRegion, kernel, probe};
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{
    Demand, DemandContext, Node, Outputs, Parameters, Port, PortType, RunContext, TransferFunctionSpec, Value,
};

/// The declaration.
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
        look(parameters, names, vec![0.0; n], vec![vec![1.0; n]; n])
    },
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

fn demand(asking: &mut DemandContext) -> Result<()> {
    let names = fields(asking.parameters)?;
    let mask =
        asking.parameters.table("mask")?.map(|mask| mask.text("array").map(str::to_string)).transpose()?;
    let demand = Demand {
        gradient_magnitude: names.is_none(),
        arrays: names.into_iter().flatten().collect(),
        cell_arrays: mask.into_iter().collect(),
        ..Demand::default()
    };
    asking.ask("volume", &demand)
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let p = call.parameters;
    let volume = call.volume("volume")?;
    let names = fields(p)?;
    let values = values(&volume, names.as_deref()).map_err(|error| p.locate("fields", error))?;
    let own = placed(p, &volume.grid)?;
    let region = region(&own)?;
    if own != *p {
        relative::note_numbers(&mut call.notes, "region", "over the bounds", p, &own);
    }
    let mask = mask(p, &volume)?;
    let found = call
        .stage("probe", |progress| probe(&volume.grid, &values, &region, mask.as_deref(), progress))
        .map_err(|error| locate(p, error))?;
    if let ProbeRegion::Points(points) = &region
        && found.point_count < points.len() as u64
    {
        let outside = points.len() as u64 - found.point_count;
        call.notes.warnings.push(format!("{outside} of {} points lie in no cell that counts", points.len()));
    }
    let matrix = kernel(&found, p.number("least_sigma")?, p.number("sigma_scale")?, p.flag("correlated")?);
    let names_shown = names.clone().unwrap_or_else(|| vec!["s".into(), "g".into()]);
    for (name, _) in names_shown.iter().zip(&found.extent).filter(|(_, extent)| **extent == 0.0) {
        let what = format!("{name} is constant over the whole grid: the widget does not look at it");
        call.notes.warnings.push(what);
    }
    call.notes.find(sentence(&found, &names_shown), figures(&found, &names_shown, &matrix));
    look(p, names, found.mean, matrix)
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
    let array = |name: &String| match volume.grid.point_arrays.get(name) {
        Some(array) if array.component_count == 1 => Ok(array.values.as_slice()),
        Some(array) => Err(Error::usage(format!("the field '{name}' is not a scalar"))
            .got(format!("{} components", array.component_count))
            .expected(format!("'{name}:magnitude', or '{name}:0' for a component"))),
        None => Err(Error::usage("the probe looks at a field that the volume does not have")
            .got(name)
            .expected("a point array that the reader was asked for")),
    };
    names.iter().map(array).collect()
}

/// The widget alone: its extinction counts per unit distance of whatever it is wired into.
fn look(
    p: &Parameters,
    names: Option<Vec<String>>,
    centre: Vec<f64>,
    matrix: Vec<Vec<f64>>,
) -> Result<Outputs> {
    let profile = match names {
        Some(fields) => Profile::GaussianNd { fields, centre, matrix },
        None => Profile::Gaussian {
            centre: [centre[0], centre[1]],
            matrix: [[matrix[0][0], matrix[0][1]], [matrix[1][0], matrix[1][1]]],
        },
    };
    let widget =
        Widget { profile, color: p.vector("color")?, extinction: p.number("extinction")?, region: None };
    let model = OpticalModel::DensityEmitter;
    let transfer_function = TransferFunction { model, unit_distance: 1.0, widgets: vec![widget] };
    Ok(vec![Value::TransferFunction(Arc::new(TransferFunctionSpec {
        transfer_function,
        auto_unit_distance: true,
    }))])
}
