//! A node that looks on: it takes every output of what feeds a picture and does nothing, so that a run is made for the picture
//! and for nothing else, and what runs through the wires can be asked for.

use glam::DVec3;
use std::collections::BTreeMap;
use voltet_core::Result;
use voltet_core::graph::{Datum, Value};
use voltet_core::graph::{
    Demand, Field, Graph, LinkEntry, Node, NodeEntry, Origin, Parameter, ParameterType, Port, PortType,
    Registry, Setting, Standard,
};
use voltet_core::grid::extent::{bounds, range};
use voltet_core::volume::Volume;

/// The type's name, which no pipeline file can be meant to name.
pub(super) const NAME: &str = "(looks on)";

const fn port(name: &'static str, port_type: PortType) -> Port {
    Port { name, port_type, summary: "what is looked at" }
}

/// One input a type, each fed by any number of outputs.
const PORTS: [Port; 9] = [
    port("grid", PortType::Grid),
    port("volume", PortType::Volume),
    port("transfer-function", PortType::TransferFunction),
    port("camera", PortType::Camera),
    port("cells", PortType::Cells),
    port("projection", PortType::Projection),
    port("image", PortType::Image),
    port("report", PortType::Report),
    port("cell-values", PortType::CellValues),
];

static NODE: Node = Node {
    name: NAME,
    summary: "Looks on.",
    optional_inputs: &PORTS,
    // It asks for nothing: what nobody else needs is not made for it.
    demand: &|_| Ok(()),
    ..Node::BLANK
};

/// What asks for *g* and arrays besides.
pub(super) static ASKS_FOR_ARRAYS: Node = Node {
    name: "(asks for arrays)",
    summary: "Looks on, and asks for g and for arrays.",
    inputs: &[port("volume", PortType::Volume)],
    parameters: &[Parameter {
        name: ARRAYS,
        parameter_type: ParameterType::Texts,
        unit: "",
        standard: Standard::Unset("no arrays"),
        help: "names of point arrays",
    }],
    demand: &|asking| {
        let arrays = match asking.parameters.given(ARRAYS) {
            true => asking.parameters.texts(ARRAYS)?.into_iter().collect(),
            false => Default::default(),
        };
        // A grid alone has no gradient to give.
        let gradient_magnitude = asking.fed_by("volume")? != Some(PortType::Grid);
        asking.ask("volume", &Demand { gradient_magnitude, arrays, ..Demand::default() })
    },
    ..Node::BLANK
};

const ARRAYS: &str = "arrays";

/// What asks for all that a ray of the picture is made of.
pub(super) static PROBES: Node = Node {
    name: "(probes)",
    summary: "Looks on, and asks for g.",
    optional_inputs: &[PORTS[1], PORTS[2], PORTS[3]],
    demand: &|asking| match asking.fed_by("volume")? {
        // A grid alone has no gradient to give.
        Some(PortType::Grid) => Ok(()),
        _ => asking.ask("volume", &Demand { gradient_magnitude: true, ..Demand::default() }),
    },
    ..Node::BLANK
};

/// The same registry with these nodes.
pub(super) fn with_own(registry: &Registry) -> Result<Registry> {
    let mut own = Registry::new();
    registry.iter().try_for_each(|node| own.add(node))?;
    registry.filters().try_for_each(|filter| own.add_filter(filter.clone()))?;
    own.add(&NODE)?;
    own.add(&ASKS_FOR_ARRAYS)?;
    own.add(&PROBES)?;
    Ok(own)
}

/// A node of the type `node_type` that looks at these outputs, each a port's name and `"node.port"`.
pub(super) fn entry(node_type: &str, looked_at: impl Iterator<Item = (String, String)>) -> NodeEntry {
    let mut inputs: Vec<LinkEntry> = Vec::new();
    for (port, source) in looked_at {
        let source = Setting::from(Datum::Text(source));
        match inputs.iter_mut().find(|link| link.port == port) {
            Some(LinkEntry { source: Setting { datum: Datum::List(list), .. }, .. }) => list.push(source),
            _ => {
                let list = Setting::from(Datum::List(vec![source]));
                inputs.push(LinkEntry { port, origin: Origin::Nowhere, source: list });
            }
        }
    }
    let node_type = Setting::from(Datum::Text(node_type.into()));
    NodeEntry { name: NAME.into(), origin: Origin::Nowhere, node_type, settings: Vec::new(), inputs }
}

/// A node that looks at one output, given as `"node.port"`, and asks for arrays.
pub(super) fn fed_by(node: &Node, source: &str, arrays: &[&String]) -> NodeEntry {
    let text = |text: &str| Setting::from(Datum::Text(text.to_string()));
    let link = LinkEntry { port: node.inputs[0].name.into(), origin: Origin::Nowhere, source: text(source) };
    let list = Datum::List(arrays.iter().map(|name| text(name)).collect());
    let arrays = Field { name: ARRAYS.into(), origin: Origin::Nowhere, setting: list.into() };
    NodeEntry {
        name: NAME.into(),
        origin: Origin::Nowhere,
        node_type: text(node.name),
        settings: vec![arrays],
        inputs: vec![link],
    }
}

/// What runs through the wires of a run.
#[derive(Default)]
pub(super) struct Values {
    /// For each output, `"node.port"`, in words.
    pub words: BTreeMap<String, String>,
    /// Least and greatest coordinates of the data.
    pub bounds: Option<[DVec3; 2]>,
}

/// What runs through the wires.
pub(super) fn seen(graph: &Graph, place: usize, values: &[Value]) -> Values {
    let mut seen = Values::default();
    for (edge, value) in graph.nodes[place].inputs.iter().zip(values) {
        let giving = &graph.nodes[edge.node];
        let output = format!("{}.{}", giving.name, giving.node.outputs[edge.output].name);
        seen.words.insert(output, describe(value));
        match value {
            Value::Grid(grid) => seen.bounds = seen.bounds.or_else(|| bounds(&grid.points)),
            Value::Volume(volume) => seen.bounds = seen.bounds.or_else(|| bounds(&volume.grid.points)),
            Value::TransferFunction(_)
            | Value::Camera(_)
            | Value::Cells(_)
            | Value::Projection(_)
            | Value::Image(_)
            | Value::Report(_)
            | Value::CellValues(_) => {}
        }
    }
    seen
}

fn describe(value: &Value) -> String {
    let grid = |grid: &voltet_core::grid::Grid| {
        format!("{} tetrahedra, {} points", grouped(grid.tetrahedra.len()), grouped(grid.points.len()))
    };
    match value {
        Value::Grid(of) => match of.scalar.as_ref().and_then(|s| range(s)) {
            Some([low, high]) => format!("{}\ns from {} to {}", grid(of), short(low), short(high)),
            None => grid(of),
        },
        Value::Volume(volume) => {
            let Volume { scalar, gradient_magnitude, .. } = &**volume;
            let mut text = grid(&volume.grid);
            if let Some([low, high]) = range(scalar) {
                text += &format!("\ns from {} to {}", short(low), short(high));
            }
            if let Some([low, high]) = gradient_magnitude.as_deref().and_then(|g| range(g)) {
                text += &format!("\ng from {} to {}", short(low), short(high));
            }
            text
        }
        Value::TransferFunction(look) => match look.transfer_function.widgets.len() {
            1 => "1 widget".into(),
            count => format!("{count} widgets"),
        },
        Value::Camera(camera) => format!("{} × {} pixels", camera.size[0], camera.size[1]),
        Value::Cells(_) => "cells that can contribute".into(),
        Value::Projection(_) => "projected cells".into(),
        Value::Image(picture) => format!("{} × {} pixels", picture.width, picture.height),
        Value::Report(report) => format!("{} characters of JSON", report.len()),
        Value::CellValues(values) => match values.arrays.keys().cloned().collect::<Vec<_>>().join(", ") {
            names if names.is_empty() => "no arrays asked for".into(),
            names => names,
        },
    }
}

/// Four digits, as a person reads them.
pub fn short(x: f64) -> String {
    let size = x.abs();
    if x == 0.0 || (1e-3..1e5).contains(&size) {
        let digits = if size >= 1.0 { 3 - (size.log10().floor() as i32).min(3) } else { 4 };
        let text = format!("{x:.*}", digits.max(0) as usize);
        match text.contains('.') {
            true => text.trim_end_matches('0').trim_end_matches('.').to_string(),
            false => text,
        }
    } else {
        format!("{x:.3e}")
    }
}

/// A count with its thousands apart.
fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}
