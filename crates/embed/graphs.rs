//! The graphs that are run for a program: of one value that it wants, or of all that a pipeline writes.

use crate::session::{Scene, Session};
use voltet_core::Result;
use voltet_document::links::{source, sources, upstream};
use voltet_graph::{
    Graph, LinkEntry, LocatedValue, Node, NodeEntry, ParameterValue, Port, PortType, SourceSpan,
};
use voltet_nodes::given;

/// What takes a value: the run is made for it.
pub static TAKER: Node = Node {
    name: "taker",
    summary: "Takes a value for the program.",
    optional_inputs: &[
        Port { name: "image", port_type: PortType::Image, summary: "a picture" },
        Port { name: "report", port_type: PortType::Report, summary: "figures" },
        Port { name: "volume", port_type: PortType::Volume, summary: "a volume" },
        Port { name: "widgets", port_type: PortType::TransferFunction, summary: "widgets, as of a probe" },
    ],
    ..Node::BLANK
};

/// The name of the node that takes: no file can state it.
const TAKER_NAME: &str = "(the program)";

impl Session {
    /// The graph of the whole pipeline: all that it writes, and the pictures and probes that feed nothing.
    pub fn whole(&self, scene: &dyn Scene) -> Result<Graph> {
        let mut entries = scene.pipeline().nodes.clone();
        let feeds = |name: &String| {
            let mut wires = entries.iter().flat_map(|entry| entry.inputs.iter().flat_map(sources));
            wires.any(|text| source(text, &entries).0 == name)
        };
        // Widgets that are made of no data say nothing.
        let of_data = |name: &String| {
            let entry = entries.iter().find(|entry| entry.name == *name);
            let node = entry.and_then(|entry| self.registry.find(entry.node_type.text()?).ok());
            node.is_some_and(|node| !node.inputs.is_empty())
        };
        let mut taker = None;
        for (port, port_type) in [("image", PortType::Image), ("widgets", PortType::TransferFunction)] {
            let mut open = self.giving(scene, port_type);
            open.retain(|name| !feeds(name) && of_data(name));
            if !open.is_empty() {
                let taken = self.taker(&entries, port, &open);
                taker
                    .get_or_insert_with(|| NodeEntry { inputs: Vec::new(), ..taken.clone() })
                    .inputs
                    .extend(taken.inputs);
            }
        }
        entries.extend(taker);
        self.graph(scene, entries)
    }

    /// The nodes that a value needs, and no others, with what takes it.
    pub(crate) fn graph_for(&self, scene: &dyn Scene, node: &str, port: &str) -> Result<Graph> {
        let nodes = &scene.pipeline().nodes;
        let needed = upstream(nodes, node);
        let mut entries: Vec<NodeEntry> =
            nodes.iter().filter(|entry| needed.contains(&entry.name)).cloned().collect();
        entries.push(self.taker(&entries, port, &[node.to_string()]));
        self.graph(scene, entries)
    }

    /// What takes the values of these nodes: of each the first that fits.
    fn taker(&self, entries: &[NodeEntry], port: &str, nodes: &[String]) -> NodeEntry {
        let text = |text: &str| LocatedValue::from(ParameterValue::Text(text.into()));
        let taken = TAKER.optional_inputs.iter().find(|input| input.name == port);
        let output = |name: &String| {
            let entry = entries.iter().find(|entry| entry.name == *name)?;
            let node = self.registry.find(entry.node_type.text()?).ok()?;
            let mut fitting =
                node.outputs.iter().filter(|o| taken.is_some_and(|t| o.port_type.serves(t.port_type)));
            fitting.next().filter(|_| node.outputs.len() > 1)
        };
        let source = |name: &String| match output(name) {
            Some(output) => text(&format!("{name}.{}", output.name)),
            None => text(name),
        };
        NodeEntry {
            name: TAKER_NAME.into(),
            origin: SourceSpan::Nowhere,
            node_type: text(TAKER.name),
            settings: Vec::new(),
            inputs: vec![LinkEntry {
                port: port.into(),
                origin: SourceSpan::Nowhere,
                source: ParameterValue::List(nodes.iter().map(source).collect()).into(),
            }],
        }
    }

    fn graph(&self, scene: &dyn Scene, mut entries: Vec<NodeEntry>) -> Result<Graph> {
        for entry in entries.iter_mut().filter(|entry| self.grids.contains_key(&entry.name)) {
            given::stand_in(entry, &self.registry)?;
        }
        let graph = Graph::build(&entries, &self.registry, scene.folder());
        let mut graph = graph.map_err(|error| scene.locate(error))?;
        for (name, given) in &self.grids {
            if graph.nodes.iter().any(|node| node.name == *name) {
                graph.give(name, given.clone())?;
            }
        }
        Ok(graph)
    }
}
