//! `gradient-magnitude`: the gradient of the scalar at the points, where somebody looks at it.

use std::sync::Arc;
use voltet_core::Result;
use voltet_core::field::{Registry, Setting, Settings, magnitude};
use voltet_core::graph::{
    Asking, Call, Demand, Node, Notes, Outputs, Parameter, ParameterType, Parameters, Port, PortType, Saving,
    Standard, Value, suggest,
};
use voltet_core::volume::Volume;

/// The declaration.
pub const NODE: Node = Node {
    name: "gradient-magnitude",
    summary: "Computes the gradient of the scalar and its length, by a filter of your choice.",
    inputs: &[Port { name: "grid", port_type: PortType::Grid, summary: "the grid with its scalar" }],
    outputs: &[Port { name: "volume", port_type: PortType::Volume, summary: "the grid with its gradient" }],
    parameters: &[
        Parameter {
            name: "method",
            parameter_type: ParameterType::Text,
            unit: "",
            standard: Standard::Text("least-squares"),
            help: "the filter: least-squares, quadratic-fit, volume-weighted, cell-average, or array",
        },
        Parameter {
            name: "array",
            parameter_type: ParameterType::Text,
            unit: "",
            standard: Standard::Unset("the method computes it"),
            help: "method \"array\": the point array of three components that holds the gradient",
        },
    ],
    example: include_str!("examples/stages.toml"),
    check: &check,
    demand: &demand,
    run: &run,
    ..Node::BLANK
};

fn check(p: &Parameters) -> Result<()> {
    let filters = Registry::built_in();
    let (method, names) = (p.text("method")?, filters.names());
    if !names.iter().any(|name| name == method) {
        let error = p.error("method", "unknown gradient method").found(format!("'{method}'"));
        return Err(error.accepted(suggest(method, names.iter().map(String::as_str))));
    }
    match (method, p.given("array")) {
        ("array", false) => Err(p
            .error("method", "the method \"array\" needs the name of an array")
            .accepted("array = \"NAME\", a point array of three components")),
        (other, true) if other != "array" => Err(p
            .error("array", "'array' is given, but the method computes the gradient itself")
            .found(format!("method = \"{other}\""))
            .accepted("method = \"array\", or no array")),
        _ => Ok(()),
    }
}

fn settings(p: &Parameters) -> Result<Settings> {
    let mut settings = Settings::new();
    if p.given("array") {
        settings.insert("array".into(), Setting::Text(p.text("array")?.into()));
    }
    Ok(settings)
}

fn demand(asking: &mut Asking) -> Result<()> {
    let asked = asking.asked;
    let (arrays, cell_arrays) = (asked.arrays.clone(), asked.cell_arrays.clone());
    let mut demand = Demand { arrays, cell_arrays, ..Demand::default() };
    leave_out(asking.notes, asked, None);
    if asked.gradient_magnitude || asked.gradient {
        let filters = Registry::built_in();
        let filter = filters.get(asking.parameters.text("method")?)?;
        demand.arrays.extend(filter.arrays(&settings(asking.parameters)?));
    }
    asking.ask("grid", &demand)
}

/// Notes what of the gradient nobody asks for; its memory, where the number of points is known.
fn leave_out(notes: &mut Notes, asked: &Demand, point_count: Option<usize>) {
    let (what, why, numbers) = match (asked.gradient_magnitude, asked.gradient) {
        (false, false) => ("gradient", "no widget looks at the gradient magnitude and nothing is lit", 4),
        (true, false) => ("gradient vectors", "nothing is lit and there is no silhouette", 3),
        (false, true) => ("gradient magnitude", "no widget looks at it", 1),
        (true, true) => return,
    };
    notes.leave_out(what, why, point_count.map(|points| Saving::Bytes(8 * numbers * points as u64)));
}

fn run(call: &mut Call) -> Result<Outputs> {
    let grid = call.grid("grid")?;
    let mut volume = Volume::clone(&*call.volume("grid")?);
    let (wants_magnitude, wants_vectors) = (call.demand.gradient_magnitude, call.demand.gradient);
    leave_out(&mut call.notes, call.demand, Some(grid.points.len()));
    call.notes.counts.insert("gradients_computed", u64::from(wants_magnitude || wants_vectors));
    if wants_magnitude || wants_vectors {
        let filters = Registry::built_in();
        let filter = filters.get(call.parameters.text("method")?)?;
        let settings = settings(call.parameters)?;
        let gradient = filter.gradient(&grid, &volume.scalar, &settings, call.progress())?;
        for fallback in &gradient.fallbacks {
            let what = format!("{} at {} points", fallback.what, fallback.point_count);
            call.notes.warnings.push(what);
        }
        let fallbacks = gradient.fallbacks.iter().map(|fallback| fallback.point_count).sum();
        if fallbacks > 0 {
            call.notes.counts.insert("gradient_fallbacks", fallbacks);
        }
        volume.gradient_magnitude = wants_magnitude.then(|| Arc::new(magnitude(&gradient.vectors)));
        volume.gradient = wants_vectors.then(|| Arc::new(gradient.vectors));
    }
    Ok(vec![Value::Volume(Arc::new(volume))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_help_names_every_built_in_method() {
        for name in Registry::built_in().names() {
            assert!(NODE.parameters[0].help.contains(&name), "{name}");
        }
    }
}
