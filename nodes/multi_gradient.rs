//! `multi-gradient`: how fast several fields change at once, as a point array, where a node downstream uses it.

use crate::gradient_magnitude::METHOD;
use std::sync::Arc;
use voltet_core::field::spectral_norms;
use voltet_core::grid::{Array, Grid};
use voltet_core::volume::Volume;
use voltet_core::{Result, counted};
use voltet_graph::{
    DefaultValue, DemandContext, Diagnostics, Node, Outputs, Parameter, ParameterType, Parameters, PartWork,
    Port, PortType, Range, RunContext, SavedWork, Value,
};

pub const NODE: Node = Node {
    name: "multi-gradient",
    summary: "Computes the magnitude of the gradients of several fields together, as a point array.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the grid with the fields" }],
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the same with the array" }],
    parameters: &[
        Parameter {
            name: "fields",
            parameter_type: ParameterType::ArrayNames,
            unit: "",
            default: DefaultValue::Required,
            help: "names of point arrays; \"NAME:0\" and \"NAME:magnitude\" for vectors",
        },
        Parameter {
            name: "scale",
            parameter_type: ParameterType::Numbers(None, Range::above(0.0)),
            unit: "units of the fields",
            default: DefaultValue::Unset("1, for one field"),
            help: "one number a field, what of it counts as much as 1: rows of D are gradients of field / scale",
        },
        Parameter {
            name: "name",
            parameter_type: ParameterType::NewArrayName,
            unit: "",
            default: DefaultValue::Text("multi-gradient"),
            help: "the array's name; it holds the largest singular value of D, which for one field is |gradient| / scale",
        },
        Parameter { help: "the gradient filter; its own parameters stand beside this one", ..METHOD },
    ],
    example: include_str!("examples/multi_gradient.toml"),
    check: &|parameters| MultiGradientOptions::new(parameters).map(drop),
    demand: &demand,
    part_work: PartWork::Each,
    run: &run,
    ..Node::BLANK
};

struct MultiGradientOptions {
    fields: Vec<String>,
    /// One a field.
    scale: Vec<f64>,
    name: String,
}

impl MultiGradientOptions {
    fn new(p: &Parameters) -> Result<MultiGradientOptions> {
        let (fields, name) = (p.texts("fields")?, p.text("name")?.to_owned());
        if fields.is_empty() || fields.iter().any(String::is_empty) {
            return Err(p.error("fields", "there is no field").expected("at least one name"));
        }
        if name.is_empty() || fields.contains(&name) {
            let error = p.error("name", "the array needs a name of its own").got(format!("'{name}'"));
            return Err(error.expected("a name that no field has"));
        }
        let scale = match (p.is_set("scale"), fields.len()) {
            (true, _) => p.numbers("scale")?,
            (false, 1) => vec![1.0],
            (false, count) => {
                let error = p.error("scale", "fields of several units have no common gradient");
                return Err(error.expected(format!(
                    "scale = [{}, …]: {}",
                    fields[0],
                    counted(count, "number")
                )));
            }
        };
        if scale.len() != fields.len() {
            let error = p.error("scale", "'scale' has the wrong length").got(scale.len());
            return Err(error.expected(format!("{}, one number a field", fields.len())));
        }
        if fields.len() > 1 && p.text("method")? == "array" {
            let error = p.error("method", "an array holds the gradient of one field").got("several fields");
            return Err(error.expected("a method that computes gradients"));
        }
        Ok(MultiGradientOptions { fields, scale, name })
    }
}

fn demand(asking: &mut DemandContext) -> Result<()> {
    let wish = MultiGradientOptions::new(asking.parameters)?;
    let mut demand = asking.asked.clone();
    demand.arrays.named.remove(&wish.name);
    if asking.exhaustive() || asking.asked.arrays.contains(&wish.name) {
        demand.arrays.named.extend(asking.method()?.arrays()?);
        demand.arrays.named.extend(wish.fields);
    } else {
        record_unneeded(asking.notes, &wish, None);
    }
    asking.ask("volume", &demand)
}

fn record_unneeded(notes: &mut Diagnostics, wish: &MultiGradientOptions, point_count: Option<usize>) {
    let saving = point_count.map(|points| SavedWork::Bytes(8 * points as u64));
    notes.record_skipped(&wish.name, "no widget looks at it", saving);
}

fn run(call: &mut RunContext) -> Result<Outputs> {
    let wish = MultiGradientOptions::new(call.parameters)?;
    let mut volume = Volume::clone(&*call.volume("volume")?);
    if !(call.exhaustive() || call.demand.arrays.contains(&wish.name)) {
        call.notes.counts.insert("gradients_computed", 0);
        record_unneeded(&mut call.notes, &wish, Some(volume.grid.points.len()));
        return Ok(vec![Value::Volume(Arc::new(volume))]);
    }
    call.notes.counts.insert("gradients_computed", wish.fields.len() as u64);
    let mut gradients = Vec::with_capacity(wish.fields.len());
    for (field, scale) in wish.fields.iter().zip(&wish.scale) {
        let array = volume.grid.point_array(field, 1)?;
        let values: Vec<f64> = array.values.iter().map(|value| value / scale).collect();
        let gradient = call.method()?.gradient(&volume.grid, &values, call.progress())?;
        for fallback in &gradient.fallbacks {
            let what = format!("'{field}': {fallback}");
            call.notes.warnings.push(what);
        }
        gradients.push(gradient.vectors);
    }
    let array = Array { component_count: 1, values: spectral_norms(&gradients).into() };
    let mut grid = Grid::clone(&volume.grid);
    grid.point_arrays.insert(wish.name, Arc::new(array));
    volume.grid = Arc::new(grid);
    Ok(vec![Value::Volume(Arc::new(volume))])
}
