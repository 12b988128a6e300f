//! Contribution of a widget to the picture: a coarse picture with it and without it, and one of it alone for its cells.

use super::estimate::coarsened;
use super::following::Following;
use super::queries::{Share, ShareQuery};
use super::request::RenderRequest;
use super::work::{WorkerState, picture_of};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_graph::{NodeEntry, ParameterValue, RunReport};

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
    /// The nodes with those widgets alone that `keeps` says.
    fn with(&self, keeps: &dyn Fn(usize) -> bool) -> RenderRequest {
        let mut wanted = self.wanted.clone();
        let find = |node: &&mut NodeEntry| node.name == self.look;
        let field = wanted.nodes.iter_mut().find(find);
        let field = field.and_then(|node| node.settings.iter_mut().find(|field| field.name == "widgets"));
        if let Some(ParameterValue::List(list)) = field.map(|field| &mut field.setting.datum) {
            let mut place = 0..;
            list.retain(|_| place.next().is_some_and(keeps));
        }
        wanted
    }
}

impl WorkerState<'_> {
    /// The share of a widget; given up for a newer picture, which will ask again.
    pub(super) fn share(&mut self, wanted: &ShareQuery) {
        let registry = self.registry;
        let found = self.aside(|session, following: &Following| {
            let mut draw = |wanted: &RenderRequest| -> Result<(Arc<Picture>, RunReport)> {
                let graph = wanted.graph(registry, coarsened(wanted))?;
                let report = session.run(&graph, following)?;
                Ok((picture_of(&report, wanted)?, report))
            };
            let (with, _) = draw(&wanted.wanted)?;
            let (without, _) = draw(&wanted.with(&|place| place != wanted.widget))?;
            let (_, alone) = draw(&wanted.with(&|place| place == wanted.widget))?;
            Ok(Share { cells: cells(&alone), ..Share::between(&with, &without) })
        });
        if let Some(found) = found {
            self.shared.show(|shown| shown.share = Some((wanted.key, found)));
        }
    }
}

/// Cells that were drawn, of all.
fn cells(report: &RunReport) -> Option<[u64; 2]> {
    let count = |name: &str| report.nodes.iter().find_map(|node| node.counts.get(name).copied());
    let all = count("cells_total")?;
    Some([all.saturating_sub(count("cells_culled")?), all])
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
