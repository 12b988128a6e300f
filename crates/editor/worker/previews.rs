//! Small pictures for the nodes whose pictures are not the one that is shown.

use super::following::Following;
use super::pixels::Pixels;
use super::preview_observer::NAME;
use super::request::RenderRequest;
use super::shared::lock;
use super::work::WorkerState;
use voltet_core::{Error, Result};
use voltet_graph::{Demand, Registry, Session, Value};

/// Pixels of one, at most: as many as a node has room for.
const PIXELS: f64 = 160.0 * 120.0;

/// The picture, without the nodes that it does not need being forgotten as a run forgets them.
fn draw(
    wanted: &RenderRequest,
    session: &mut Session,
    registry: &Registry,
    following: &Following,
) -> Result<Pixels> {
    let divisor = (wanted.pixels() / PIXELS).sqrt().ceil().max(1.0) as u32;
    let graph = wanted.graph(registry, divisor)?;
    let none = || Error::run("the node gives no picture").at_node(&wanted.node);
    let place = graph.nodes.iter().position(|node| node.node.name == NAME).ok_or_else(none)?;
    let (values, _) = session.feed(&graph, place, &Demand::default(), following)?;
    let of_node = graph.nodes[place].inputs.iter().zip(values);
    let mut pictures = of_node.filter_map(|(edge, value)| match value {
        Value::Image(picture) if graph.nodes[edge.node].name == wanted.node => Some(picture),
        _ => None,
    });
    Ok(Pixels::new(pictures.next().ok_or_else(none)?, wanted.background, divisor, 0))
}

impl WorkerState<'_> {
    /// A small picture; given up for the one that is shown, and begun again after it. One that cannot be drawn is none: what is
    /// wrong is said at its node.
    pub(super) fn preview(&mut self, wanted: RenderRequest) {
        let registry = self.registry;
        let found = self.aside(|session, following: &Following| draw(&wanted, session, registry, following));
        match found {
            Some(Ok(pixels)) => self.shared.show(|shown| {
                shown.previews.insert(wanted.node, pixels);
            }),
            Some(Err(_)) => self.shared.show(|shown| {
                shown.previews.remove(&wanted.node);
            }),
            None => {
                lock(&self.shared.wanted).previews.entry(wanted.node.clone()).or_insert(wanted);
            }
        }
    }
}
