//! Error of a picture against the 64-bit reference, at a few thousand pixels.

use super::following::Following;
use super::request::RenderRequest;
use super::work::{WorkerState, picture_of};
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::{Graph, ParameterValue, Registry};

/// Pixels that are compared, at most.
const PIXELS: f64 = 3072.0;

/// Parameter of a node's integrator, and the integrator that others are compared with.
const INTEGRATOR: &str = "integrator";
const REFERENCE: &str = "reference";

/// By how much the sides of a picture are divided where so many pixels are enough.
pub(super) fn coarsened(wanted: &RenderRequest) -> u32 {
    (wanted.pixels() / PIXELS).sqrt().ceil().max(1.0) as u32
}

/// The graphs of both pictures.
fn graphs(wanted: &RenderRequest, registry: &Registry) -> Result<[Graph; 2]> {
    let divisor = coarsened(wanted);
    let mut better = wanted.clone();
    let drawing = better.nodes.iter_mut().find(|node| node.name == wanted.node);
    let known = drawing.as_ref().and_then(|node| registry.find(node.node_type.text()?).ok());
    let (Some(drawing), Some(known)) = (drawing, known.filter(|node| node.parameter(INTEGRATOR).is_some()))
    else {
        return Err(Error::usage(format!("'{}' does not integrate anything", wanted.node))
            .expected("the picture of a node that draws a volume"));
    };
    drawing.set(INTEGRATOR, &[], ParameterValue::Text(REFERENCE.into()).into())?;
    // The reference has an engine of its own.
    let has_engine = known.parameter("engine").is_some();
    if has_engine {
        drawing.set("engine", &[], ParameterValue::Text("auto".into()).into())?;
    }
    drawing.settings.retain(|field| !["compositor", "adapter"].contains(&field.name.as_str()));
    Ok([wanted.graph(registry, divisor)?, better.graph(registry, divisor)?])
}

/// The largest difference of a premultiplied channel, and the root of the mean square.
fn difference(a: &Picture, b: &Picture) -> [f64; 2] {
    let (mut most, mut sum) = (0.0f64, 0.0);
    for (a, b) in a.rgba.iter().flatten().zip(b.rgba.iter().flatten()) {
        let by = f64::from((a - b).abs());
        most = most.max(by);
        sum += by * by;
    }
    [most, (sum / (4 * a.rgba.len().max(1)) as f64).sqrt()]
}

impl WorkerState<'_> {
    /// Estimates the error of a picture; given up for a newer picture.
    pub(super) fn estimate(&mut self, key: u64, wanted: &RenderRequest) {
        let registry = self.registry;
        let found = self.aside(|session, following: &Following| {
            let mut pictures = Vec::new();
            for graph in &graphs(wanted, registry)? {
                let report = session.run(graph, following)?;
                pictures.push(picture_of(&report, wanted)?);
            }
            Ok(difference(&pictures[0], &pictures[1]))
        });
        let given_up = || Err(Error::run("given up for a newer picture").expected("to be asked again"));
        self.shared.show(|shown| shown.estimate = Some((key, found.unwrap_or_else(given_up))));
    }
}
