//! The transfer function that the panel shows and edits.

use super::images::Images;
use super::plane::Plane;
use super::scale::{S_AND_G, Scale};
use super::screen_widget::ScreenWidget;
use super::shape::PlaneContext;
use crate::scene::Scene;
use crate::worker::{Distribution, PixelProbe, Share};
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::probing::Histogram;
use voltet_graph::{ArrayRef, LocatedValue, NodeEntry};

/// The transfer function in the panel, with the data of its plane.
pub(super) struct EditedFunction<'a> {
    pub node: &'a NodeEntry,
    pub list: &'a [LocatedValue],
    pub widgets: Vec<ScreenWidget>,
    /// Quantities of the plane's axes.
    pub axes: [ArrayRef; 2],
    pub found: Option<Arc<Distribution>>,
    /// Lengths of the axes of the data.
    pub extent: [f64; 2],
    /// Lengths along the axes that are equal on the screen, for the axes and angles of ellipses.
    metric: [f64; 2],
    /// The extinction at the top of the plot, for curves.
    pub peak: f64,
    pub probed: Option<Arc<PixelProbe>>,
    pub share: Option<Result<Share>>,
    /// Sets of widgets that the file keeps, by their digits.
    pub sets: &'a BTreeMap<u8, Vec<LocatedValue>>,
}

impl<'a> EditedFunction<'a> {
    /// `plane`: the one of the last frame; `former_peak`: where a point is dragged, the scale stands still.
    pub fn new(
        scene: &Scene<'a>,
        node: &'a NodeEntry,
        axes: &[ArrayRef; 2],
        plane: Option<Plane>,
        former_peak: Option<f64>,
        images: &Images,
    ) -> EditedFunction<'a> {
        let stated = node.settings.iter().find(|field| field.name == "widgets");
        let list = stated.and_then(|field| field.setting.list()).unwrap_or_default();
        let found = scene.distribution.clone();
        let extent =
            found.as_ref().map_or([1.0; 2], |found| found.histogram.axes.map(|axis| axis.high - axis.low));
        let metric = plane.map_or(extent, Plane::metric);
        let known = found.as_ref().map(|found| &found.known);
        let on = PlaneContext { axes, extent: metric, known, images };
        let widget = |entry: &LocatedValue| ScreenWidget::new(entry.table().unwrap_or_default(), &on);
        let widgets: Vec<ScreenWidget> = list.iter().map(widget).collect();
        let peak = former_peak.unwrap_or_else(|| {
            let most = widgets.iter().filter_map(ScreenWidget::peak_of_curve).fold(0.0, f64::max);
            if most > 0.0 { 1.1 * most } else { 1.0 }
        });
        let (probed, share) = (scene.probed.clone(), scene.share.clone());
        EditedFunction {
            node,
            list,
            widgets,
            axes: axes.clone(),
            found,
            extent,
            metric,
            peak,
            probed,
            share,
            sets: &scene.document.view().sets,
        }
    }

    /// The volume in each bin of the plane.
    pub fn histogram(&self) -> Option<&Histogram> {
        self.found.as_ref().map(|found| &found.histogram)
    }

    /// True if the plane is that of s and g.
    pub fn is_of_s_and_g(&self) -> bool {
        self.axes == S_AND_G
    }

    pub fn scale(&self, shown: [[f64; 2]; 2]) -> Scale {
        Scale { extent: self.metric, shown, peak: self.peak }
    }
}
