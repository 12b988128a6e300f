//! Statistics of all steps of a time series: a node that reads one step at a time, as the transfer function does.

use super::request::VolumeSource;
use super::scales::{DataScales, Spread, values_of};
use super::values;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::probing::{Axis, value_range};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{
    ArrayRef, DefaultValue, Demand, Field, Node, Observer, Outputs, Parameter, ParameterType, ParameterValue,
    Port, PortType, Range, Registry, RunContext, Session, Value,
};

const fn parameter(name: &'static str, parameter_type: ParameterType, help: &'static str) -> Parameter {
    Parameter { name, parameter_type, unit: "", default: DefaultValue::Required, help }
}

/// Looks at every step.
pub(super) static NODE: Node = Node {
    name: "(looks at every step)",
    summary: "Finds ranges and volumes below values over all steps of a time series.",
    inputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "one step of the series" }],
    outputs: &[Port { name: "known", port_type: PortType::Cells, summary: "what was found" }],
    parameters: &[
        parameter(
            QUANTITIES,
            ParameterType::Texts,
            "\"s\", \"g\", or the name of an array after a slash; the axes first",
        ),
        parameter(SHOWN, ParameterType::Numbers(Some(4), Range::ANY), "low and high of both axes"),
        parameter(GRADIENT, ParameterType::Boolean, "whether there is a g"),
    ],
    demand: &|asking| asking.ask("volume", &Demand::default()),
    run: &run,
    ..Node::BLANK
};

const QUANTITIES: &str = "quantities";
const SHOWN: &str = "shown";
const GRADIENT: &str = "gradient";

/// Name of a quantity in the parameters.
fn named(quantity: &ArrayRef) -> String {
    match quantity {
        ArrayRef::Array(name) => format!("/{name}"),
        ArrayRef::Named(_) | ArrayRef::Per(..) => quantity.to_string(),
    }
}

fn quantity(text: &str) -> ArrayRef {
    match text.strip_prefix('/') {
        Some(name) => ArrayRef::Array(name.to_string()),
        None => ArrayRef::Named(if text == "g" { "g" } else { "s" }),
    }
}

/// Statistics of the series, by the quantities and axes that they were computed for.
type SeriesCache = Mutex<Vec<((Vec<String>, Vec<u64>), DataScales)>>;

fn run(call: &mut RunContext) -> Result<Outputs> {
    let names = call.parameters.texts(QUANTITIES)?;
    let shown = call.parameters.numbers(SHOWN)?;
    let mut demand = Demand { gradient_magnitude: call.parameters.flag(GRADIENT)?, ..Demand::default() };
    let quantities: Vec<ArrayRef> = names.iter().map(|name| quantity(name)).collect();
    for quantity in &quantities {
        if let ArrayRef::Array(name) = quantity {
            demand.arrays.insert(name.clone());
        }
    }
    let kept: Arc<SeriesCache> = call.keep_over_steps("volume", &demand, || Ok(SeriesCache::default()))?;
    let key = (names, shown.iter().map(|x| x.to_bits()).collect::<Vec<_>>());
    let mut kept = kept.lock().unwrap_or_else(PoisonError::into_inner);
    let known = match kept.iter().find(|(of, _)| *of == key) {
        Some((_, known)) => known.clone(),
        None => {
            let known = find(call, &demand, &quantities, &shown)?;
            kept.push((key, known.clone()));
            known
        }
    };
    Ok(vec![Value::Cells(Arc::new(known))])
}

/// Every step is read twice: for the ranges, and for the volumes below values within them.
fn find(call: &RunContext, demand: &Demand, quantities: &[ArrayRef], shown: &[f64]) -> Result<DataScales> {
    let each = |look: &mut dyn FnMut(&Volume) -> Result<()>| {
        call.each_step("volume", demand, &mut |_, value| match value.volume() {
            Some(volume) => look(&*volume?),
            None => Ok(()),
        })
    };
    let mut known = DataScales::default();
    each(&mut |volume| {
        for quantity in quantities {
            let [low, high] = value_range(&values_of(volume, quantity)?)?;
            let range = known.ranges.entry(quantity.clone()).or_insert([low, high]);
            *range = [range[0].min(low), range[1].max(high)];
        }
        Ok(())
    })?;
    let of_axes = || quantities.iter().zip(shown.chunks_exact(2));
    for (quantity, shown) in of_axes() {
        let spread = Spread::new([shown[0], shown[1]], known.ranges[quantity]);
        known.spreads.insert(quantity.clone(), spread);
    }
    each(&mut |volume| {
        for (quantity, spread) in &mut known.spreads {
            spread.add(&volume.grid, &values_of(volume, quantity)?, call.progress())?;
        }
        Ok(())
    })?;
    known.spreads.values_mut().for_each(|spread| *spread = std::mem::take(spread).finished());
    Ok(known)
}

/// Parameters of the node. `quantities`: those of the plane's axes first; `shown`: these axes.
pub(super) fn settings(quantities: &[ArrayRef], shown: [Axis; 2], gradient: bool) -> Vec<Field> {
    let ends = shown.into_iter().flat_map(|axis| [axis.low, axis.high]);
    vec![
        Field::new(QUANTITIES, quantities.iter().map(named).collect::<ParameterValue>()),
        Field::new(SHOWN, ends.collect::<ParameterValue>()),
        Field::new(GRADIENT, ParameterValue::Boolean(gradient)),
    ]
}

/// Statistics of quantities over all steps of the series that feeds an output.
pub(super) fn known(
    session: &mut Session,
    registry: &Registry,
    source: &VolumeSource,
    settings: Vec<Field>,
    observer: &dyn Observer,
) -> Result<DataScales> {
    let mut nodes = source.nodes(&NODE, settings, Vec::new())?;
    let output = ("cells".to_string(), format!("{}.known", NODE.name));
    nodes.push(values::entry(&values::NODE, Vec::new(), vec![output]));
    let found = source.feed(session, registry, &nodes, observer)?.into_iter().find_map(|value| match value {
        Value::Cells(found) => found.downcast::<DataScales>().ok(),
        _ => None,
    });
    found.map(Arc::unwrap_or_clone).ok_or_else(|| Error::run("nothing was found of the series"))
}
