//! Pictures beside the shown one: without a widget, by the 64-bit reference, and small ones of other nodes.

use super::query::{Query, QueryRun};
use super::request::{Pixels, RenderRequest, retain_widgets};
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_graph::{Demand, Registry, RunReport};

/// Pixels that are compared, at most; where a device does not hold so coarse a picture, more.
const PIXELS: f64 = 3072.0;

/// Pixels that the reference draws, at most: it is the slowest way to draw them.
const REFERENCE_PIXELS: f64 = 16.0 * PIXELS;

/// Pixels of a small picture, at most: as many as a node has room for; where a device does not hold so coarse a picture, more.
const PREVIEW_PIXELS: f64 = 160.0 * 120.0;

/// Parameter of a node's integrator, and the integrator that others are compared with.
const INTEGRATOR: &str = "integrator";
const REFERENCE: &str = "reference";

/// Query for the error of a picture against the reference: the largest difference of a premultiplied channel, and the root of the
/// mean square. Errors: a device does not hold pictures that are coarse enough for the reference.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Estimate(pub RenderRequest);

impl Query for Estimate {
    type Reply = [f64; 2];
    const WAITS: bool = false;

    fn answer(&self, run: &mut QueryRun) -> Result<[f64; 2]> {
        let QueryRun { session, registry, observer, crowding } = run;
        let better = by_reference(&self.0, registry)?;
        let mut draw = |wanted: &RenderRequest, divisor| {
            let report = session.run(&wanted.graph(registry, divisor)?, *observer)?;
            self.0.picture_of(&report)
        };
        let divisors = [PIXELS, REFERENCE_PIXELS].map(|enough| self.0.divisor_for(enough));
        crowding.finer_where_crowded(&self.0, divisors, |divisor| {
            Ok(difference(&*draw(&self.0, divisor)?, &*draw(&better, divisor)?))
        })
    }
}

/// The request for the same picture by the reference. Errors: nothing is integrated for it.
fn by_reference(wanted: &RenderRequest, registry: &Registry) -> Result<RenderRequest> {
    let (mut better, mut is_drawn) = (wanted.clone(), false);
    for drawing in &mut better.nodes {
        let known = registry.node_type(drawing).filter(|node| node.parameter(INTEGRATOR).is_some());
        let Some(known) = known else { continue };
        is_drawn = true;
        drawing.set(INTEGRATOR, &[], REFERENCE.into())?;
        // The reference has an engine of its own.
        if known.parameter("engine").is_some() {
            drawing.set("engine", &[], "auto".into())?;
        }
        drawing.settings.retain(|field| !["compositor", "adapter"].contains(&field.name.as_str()));
    }
    match is_drawn {
        true => Ok(better),
        false => Err(Error::usage("no volume is drawn in the picture, so no error of it can be estimated")
            .expected("the picture of a node that draws a volume, or one that is made of it")
            .at_node(&wanted.node)),
    }
}

/// The largest difference of a premultiplied channel, and the root of the mean square.
pub(crate) fn difference(a: &Picture, b: &Picture) -> [f64; 2] {
    let (mut most, mut sum) = (0.0f64, 0.0);
    for (a, b) in a.rgba.iter().flatten().zip(b.rgba.iter().flatten()) {
        let by = f64::from((a - b).abs());
        // No number is a difference, too; `max` would drop it.
        most = if by > most || by.is_nan() { by } else { most };
        sum += by * by;
    }
    [most, (sum / (4 * a.rgba.len().max(1)) as f64).sqrt()]
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ShareQuery {
    pub picture: u64,
    pub look: String,
    /// The picture, and the widget's place in the list that it is drawn with.
    pub wanted: RenderRequest,
    pub widget: usize,
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Share {
    /// Fraction of the picture's opacity that is gone without the widget, 0 to 1; parts that it hides come to light
    /// instead.
    pub opacity: f64,
    /// Fraction of the picture's light that changes without the widget; above 1 where more comes to light than it gave.
    pub light: f64,
    pub pixels: usize,
    /// Cells that it may contribute in, of all; none where no engine counts them.
    pub cells: Option<[u64; 2]>,
}

impl Share {
    fn between(with: &Picture, without: &Picture) -> Share {
        let sum = |of: &dyn Fn([f32; 4], [f32; 4]) -> f64| {
            with.rgba.iter().zip(&without.rgba).map(|(a, b)| of(*a, *b)).sum::<f64>()
        };
        let alpha = |p: [f32; 4]| f64::from(p[3]);
        let light = |p: [f32; 4]| p[..3].iter().map(|x| f64::from(*x)).sum::<f64>();
        let apart = |a: [f32; 4], b: [f32; 4]| (0..3).map(|k| f64::from((a[k] - b[k]).abs())).sum::<f64>();
        let of = |part: f64, all: f64| if all > 0.0 { part / all } else { 0.0 };
        Share {
            opacity: of(sum(&|a, b| alpha(a) - alpha(b)), sum(&|a, _| alpha(a))).max(0.0),
            light: of(sum(&apart), sum(&|a, _| light(a))),
            pixels: with.rgba.len(),
            cells: None,
        }
    }
}

impl ShareQuery {
    fn with(&self, keeps: impl Fn(usize) -> bool) -> RenderRequest {
        let mut wanted = self.wanted.clone();
        retain_widgets(&mut wanted.nodes, &self.look, keeps);
        wanted
    }
}

impl Query for ShareQuery {
    type Reply = Share;
    // A newer picture asks again.
    const WAITS: bool = false;

    /// A coarse picture with the widget and without it, and one of it alone for its cells.
    fn answer(&self, run: &mut QueryRun) -> Result<Share> {
        let QueryRun { session, registry, observer, crowding } = run;
        let mut draw = |wanted: &RenderRequest, divisor| -> Result<(Arc<Picture>, RunReport)> {
            let report = session.run(&wanted.graph(registry, divisor)?, *observer)?;
            Ok((wanted.picture_of(&report)?, report))
        };
        crowding.finer_where_crowded(&self.wanted, [self.wanted.divisor_for(PIXELS), 1], |divisor| {
            let (with, _) = draw(&self.wanted, divisor)?;
            let (without, _) = draw(&self.with(|place| place != self.widget), divisor)?;
            let (_, alone) = draw(&self.with(|place| place == self.widget), divisor)?;
            Ok(Share { cells: cells(&alone), ..Share::between(&with, &without) })
        })
    }
}

fn cells(report: &RunReport) -> Option<[u64; 2]> {
    let count = |name: &str| report.nodes.iter().find_map(|node| node.counts.get(name).copied());
    let all = count("cells_total")?;
    Some([all.saturating_sub(count("cells_culled")?), all])
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct PreviewQuery(pub RenderRequest);

impl Query for PreviewQuery {
    type Reply = Pixels;
    const WAITS: bool = true;

    /// The picture, without the nodes that it does not need being forgotten as a run forgets them.
    fn answer(&self, run: &mut QueryRun) -> Result<Pixels> {
        let wanted = &self.0;
        let QueryRun { session, registry, observer, crowding } = run;
        crowding.finer_where_crowded(wanted, [wanted.divisor_for(PREVIEW_PIXELS), 1], |divisor| {
            let graph = wanted.graph(registry, divisor)?;
            let place = graph.nodes.len() - 1;
            let (fed, _) = session.feed(&graph, place, &Demand::default(), *observer)?;
            let fed = graph.nodes[place].inputs.iter().zip(fed);
            let mut pictures = fed
                .filter(|(edge, _)| graph.nodes[edge.node].name == wanted.node)
                .filter_map(|(_, value)| value.picture().cloned());
            let picture = pictures.next().ok_or_else(|| wanted.no_picture())?;
            Ok(Pixels::new(picture, wanted, divisor, 0))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_is_what_is_gone() {
        let picture = |rgba: [[f32; 4]; 2]| Picture { width: 2, height: 1, rgba: rgba.to_vec() };
        let with = picture([[0.5, 0.0, 0.0, 0.5], [0.0, 0.25, 0.0, 0.5]]);
        let without = picture([[0.0; 4], [0.0, 0.25, 0.0, 0.5]]);
        let share = Share::between(&with, &without);
        assert!((share.opacity - 0.5).abs() < 1e-12 && (share.light - 2.0 / 3.0).abs() < 1e-12, "{share:?}");
        let nothing = Share::between(&picture([[0.0; 4]; 2]), &picture([[0.0; 4]; 2]));
        assert_eq!([nothing.opacity, nothing.light], [0.0, 0.0]);
    }
}
