//! A node that takes every output of what feeds a picture and does nothing, so that a run is made for the picture and for nothing
//! else, and what runs through the wires can be asked for; and words for that.

use glam::DVec3;
use std::collections::BTreeMap;
use voltet_core::grid::extent::{bounds, range};
use voltet_core::volume::Volume;
use voltet_graph::{
    DefaultValue, Demand, Field, Graph, LinkEntry, LocatedValue, NoObserver, Node, NodeEntry, Parameter,
    ParameterType, ParameterValue, Port, PortType, Session, SourceSpan, Value,
};

const fn port(name: &'static str, port_type: PortType) -> Port {
    Port { name, port_type, summary: "what is looked at" }
}

/// The node, whose name no pipeline file can be meant to name. One input a type, each fed by any number of outputs. It asks for
/// nothing but arrays: what nobody else needs is not made for it.
pub(super) static NODE: Node = Node {
    name: "(looks on)",
    summary: "Looks on.",
    optional_inputs: &[
        port("grid", PortType::Grid),
        port("volume", PortType::Volume),
        port("transfer-function", PortType::TransferFunction),
        port("camera", PortType::Camera),
        port("cells", PortType::Cells),
        port("projection", PortType::Projection),
        port("image", PortType::Image),
        port("report", PortType::Report),
        port("cell-values", PortType::CellValues),
    ],
    parameters: &[Parameter {
        name: ARRAYS,
        parameter_type: ParameterType::Texts,
        unit: "",
        default: DefaultValue::Unset("no arrays"),
        help: "names of point arrays",
    }],
    demand: &|asking| {
        if !asking.parameters.is_set(ARRAYS) {
            return Ok(());
        }
        let arrays = asking.parameters.texts(ARRAYS)?.into_iter().collect();
        asking.ask("volume", &Demand { arrays, ..Demand::default() })
    },
    ..Node::BLANK
};

/// Parameter of the node: arrays that the volume is to have.
pub(super) const ARRAYS: &str = "arrays";

/// A node of a type of the worker's that is fed by these outputs, each a port's name and `"node.port"`.
pub(super) fn entry(node: &Node, settings: Vec<Field>, fed: Vec<(String, String)>) -> NodeEntry {
    let mut sources: BTreeMap<String, Vec<LocatedValue>> = BTreeMap::new();
    for (port, source) in fed {
        sources.entry(port).or_default().push(source.into());
    }
    let inputs = sources.into_iter().map(|(port, mut sources)| {
        let several = sources.len() > 1;
        let source = if several { ParameterValue::List(sources).into() } else { sources.remove(0) };
        LinkEntry { port, origin: SourceSpan::Nowhere, source }
    });
    NodeEntry {
        name: node.name.into(),
        origin: SourceSpan::Nowhere,
        node_type: node.name.into(),
        settings,
        inputs: inputs.collect(),
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

/// Descriptions of the values on the wires, from the session's cache.
pub(super) fn seen(session: &mut Session, graph: &Graph) -> Option<Values> {
    let place = graph.nodes.iter().position(|node| node.node.name == NODE.name)?;
    let values = session.inputs(graph, place, &Demand::default(), &NoObserver).ok()?;
    let mut seen = Values::default();
    for (edge, value) in graph.nodes[place].inputs.iter().zip(values) {
        let giving = &graph.nodes[edge.node];
        let output = format!("{}.{}", giving.name, giving.node.outputs[edge.output].name);
        seen.words.insert(output, describe(&value));
        seen.bounds = seen.bounds.or_else(|| match &value {
            Value::Grid(grid) => bounds(&grid.points),
            Value::Volume(volume) => bounds(&volume.grid.points),
            _ => None,
        });
    }
    Some(seen)
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
