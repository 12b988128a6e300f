//! A node that looks on: it takes every output of what feeds a picture and does nothing, so that a run is made for the picture
//! and for nothing else, and what runs through the wires can be asked for.

use glam::DVec3;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::error::ErrorKind;
use voltet_core::grid::extent::{bounds, range};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_document::links::upstream;
use voltet_graph::{
    DefaultValue, Demand, Field, Graph, LinkEntry, LocatedValue, Node, NodeEntry, Observer, Parameter,
    ParameterType, Port, PortType, Registry, Session, SourceSpan,
};
use voltet_graph::{ParameterValue, Value};

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

pub(super) static NODE: Node = Node {
    name: NAME,
    summary: "Looks on.",
    optional_inputs: &PORTS,
    // It asks for nothing: what nobody else needs is not made for it.
    demand: &|_| Ok(()),
    ..Node::BLANK
};

/// Node that requests further arrays, and *g*.
pub(super) static ASKS_FOR_ARRAYS: Node = Node {
    name: "(asks for arrays)",
    summary: "Looks on, and asks for arrays and for g.",
    inputs: &[port("volume", PortType::Volume)],
    parameters: &[
        Parameter {
            name: ARRAYS,
            parameter_type: ParameterType::Texts,
            unit: "",
            default: DefaultValue::Unset("no arrays"),
            help: "names of point arrays",
        },
        Parameter {
            name: GRADIENT,
            parameter_type: ParameterType::Boolean,
            unit: "",
            default: DefaultValue::Boolean(true),
            help: "whether g is wanted",
        },
    ],
    demand: &|asking| {
        let arrays = asking.parameters.texts(ARRAYS)?.into_iter().collect();
        let gradient_magnitude = asking.parameters.flag(GRADIENT)?;
        asking.ask("volume", &Demand { gradient_magnitude, arrays, ..Demand::default() })
    },
    ..Node::BLANK
};

const ARRAYS: &str = "arrays";
const GRADIENT: &str = "gradient";

/// Node that requests all inputs of a ray's picture.
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

/// A node of the type `node_type` that looks at these outputs, each a port's name and `"node.port"`.
pub(super) fn entry(node_type: &str, looked_at: impl Iterator<Item = (String, String)>) -> NodeEntry {
    let mut inputs: Vec<LinkEntry> = Vec::new();
    for (port, source) in looked_at {
        let source = LocatedValue::from(ParameterValue::Text(source));
        match inputs.iter_mut().find(|link| link.port == port) {
            Some(LinkEntry { source: LocatedValue { datum: ParameterValue::List(list), .. }, .. }) => {
                list.push(source)
            }
            _ => {
                let list = LocatedValue::from(ParameterValue::List(vec![source]));
                inputs.push(LinkEntry { port, origin: SourceSpan::Nowhere, source: list });
            }
        }
    }
    let node_type = LocatedValue::from(ParameterValue::Text(node_type.into()));
    NodeEntry { name: NAME.into(), origin: SourceSpan::Nowhere, node_type, settings: Vec::new(), inputs }
}

/// The volume that an output gives (`"node"` or `"node.port"`), with arrays, and with *g* where what feeds it has a gradient.
pub(super) fn volume_with(
    session: &mut Session,
    registry: &Registry,
    (nodes, folder): (&[NodeEntry], &std::path::Path),
    source: &str,
    arrays: &[&String],
    observer: &dyn Observer,
) -> Result<Arc<Volume>> {
    let (name, _) = voltet_document::links::source(source, nodes);
    let mut feed = |gradient: bool| {
        let mut nodes = feeding(nodes, name)?;
        nodes.push(asking(source, arrays, gradient));
        let graph = Graph::build(&nodes, registry, folder.to_path_buf())?;
        let (values, _) = session.feed(&graph, graph.nodes.len() - 1, &Demand::default(), observer)?;
        let none = || Error::run("the node gives no volume").at_node(name);
        values.first().and_then(Value::volume).ok_or_else(none)?
    };
    match feed(true) {
        // Without a gradient to have there is no g; every other mistake is made again.
        Err(error) if error.kind == ErrorKind::Usage => feed(false),
        found => found,
    }
}

fn asking(source: &str, arrays: &[&String], gradient: bool) -> NodeEntry {
    let text = |text: &str| LocatedValue::from(ParameterValue::Text(text.to_string()));
    let field = |name: &str, datum: ParameterValue| Field {
        name: name.into(),
        origin: SourceSpan::Nowhere,
        setting: LocatedValue::from(datum),
    };
    NodeEntry {
        name: NAME.into(),
        origin: SourceSpan::Nowhere,
        node_type: text(ASKS_FOR_ARRAYS.name),
        settings: vec![
            field(ARRAYS, ParameterValue::List(arrays.iter().map(|name| text(name)).collect())),
            field(GRADIENT, ParameterValue::Boolean(gradient)),
        ],
        inputs: vec![LinkEntry { port: "volume".into(), origin: SourceSpan::Nowhere, source: text(source) }],
    }
}

/// Descriptions of the values on the wires of a run.
#[derive(Default)]
pub(super) struct Values {
    /// For each output, `"node.port"`, in words.
    pub words: BTreeMap<String, String>,
    /// Least and greatest coordinates of the data.
    pub bounds: Option<[DVec3; 2]>,
}

/// Descriptions of the values on the wires.
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
            if let Some([low, high]) = gradient_magnitude.as_deref().and_then(range) {
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
        let text = format!("{x:.3e}");
        match text.split_once('e') {
            Some((digits, power)) => {
                format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
            }
            None => text,
        }
    }
}

/// A count with its thousands apart.
pub fn grouped(count: usize) -> String {
    let digits = count.to_string();
    let groups: Vec<&str> =
        digits.as_bytes().rchunks(3).rev().filter_map(|group| std::str::from_utf8(group).ok()).collect();
    groups.join(",")
}

/// The nodes that feed one, and it; in the order of the document.
pub(super) fn feeding(nodes: &[NodeEntry], name: &str) -> Result<Vec<NodeEntry>> {
    if !nodes.iter().any(|node| node.name == name) {
        return Err(Error::usage(format!("there is no node '{name}' to show the picture of")));
    }
    let names = upstream(nodes, name);
    Ok(nodes.iter().filter(|node| names.contains(&node.name)).cloned().collect())
}
