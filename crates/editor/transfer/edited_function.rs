//! The transfer function that the panel shows and edits, the volume that it is drawn with, and the quantities of its plane.

use super::geometry::{S_AND_G, Scale};
use super::images::Images;
use super::plane::Plane;
use super::relative;
use super::screen_widget::{self, ScreenWidget};
use super::shape::PlaneContext;
use crate::scene::Scene;
use crate::worker::DataScales;
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::probing::Histogram;
use voltet_document::links::{self, upstream};
use voltet_graph::{ArrayRef, LocatedValue, NodeEntry, PortType};

/// The transfer function in the panel, with the data of its plane.
pub(super) struct EditedFunction<'a> {
    pub scene: &'a Scene<'a>,
    pub node: &'a NodeEntry,
    pub list: &'a [LocatedValue],
    pub widgets: Vec<ScreenWidget>,
    /// Quantities of the plane's axes.
    pub axes: [ArrayRef; 2],
    /// Lengths of the axes of the data.
    pub extent: [f64; 2],
    /// Lengths along the axes that are equal on the screen, for the axes and angles of ellipses.
    metric: [f64; 2],
    /// The extinction at the top of the plot, for curves.
    pub peak: f64,
}

impl<'a> EditedFunction<'a> {
    /// `plane`: the one of the last frame; `former_peak`: where a point is dragged, the scale stands still.
    pub fn new(
        scene: &'a Scene<'a>,
        node: &'a NodeEntry,
        axes: &[ArrayRef; 2],
        plane: Option<Plane>,
        former_peak: Option<f64>,
        images: &Images,
    ) -> EditedFunction<'a> {
        let list = widgets_of(node);
        let found = scene.distribution.as_ref();
        let extent = found.map_or([1.0; 2], |found| found.histogram.axes.map(|axis| axis.high - axis.low));
        let metric = plane.map_or(extent, Plane::metric);
        let known = found.map(|found| &found.known);
        let on = PlaneContext { axes, extent: metric, known, images };
        let widget = |entry: &LocatedValue| ScreenWidget::new(entry.table().unwrap_or_default(), &on);
        let widgets: Vec<ScreenWidget> = list.iter().map(widget).collect();
        let peak = former_peak.unwrap_or_else(|| {
            let most = widgets.iter().filter_map(ScreenWidget::peak_of_curve).fold(0.0, f64::max);
            if most > 0.0 { 1.1 * most } else { 1.0 }
        });
        EditedFunction { scene, node, list, widgets, axes: axes.clone(), extent, metric, peak }
    }

    /// The volume in each bin of the plane.
    pub fn histogram(&self) -> Option<&Histogram> {
        self.scene.distribution.as_ref().map(|found| &found.histogram)
    }

    /// Statistics of the data, once they are known.
    pub fn known(&self) -> Option<&DataScales> {
        self.scene.distribution.as_ref().map(|found| &found.known)
    }

    /// Sets of widgets that the file keeps, by their digits.
    pub fn sets(&self) -> &BTreeMap<u8, Vec<LocatedValue>> {
        &self.scene.document.view().sets
    }

    /// True if the plane is that of s and g.
    pub fn is_of_s_and_g(&self) -> bool {
        self.axes == S_AND_G
    }

    pub fn scale(&self, shown: [[f64; 2]; 2]) -> Scale {
        Scale { extent: self.metric, shown, peak: self.peak }
    }
}

/// The transfer function that is edited: the selected one, else the first that feeds the picture.
pub(crate) fn edited_node<'a>(scene: &Scene<'a>) -> Option<&'a NodeEntry> {
    let nodes = &scene.document.pipeline().nodes;
    let is_one = |node: &&NodeEntry| node.node_type.text() == Some("transfer-function");
    let selected = nodes.iter().filter(is_one).find(|node| scene.selection.contains(&node.name));
    let feeding = upstream(nodes, scene.shown_node?);
    selected.or_else(|| nodes.iter().filter(is_one).find(|node| feeding.contains(&node.name)))
}

/// The arrays that the widgets of a transfer function name.
pub(crate) fn fields_of(look: &NodeEntry) -> Vec<String> {
    let all: BTreeSet<String> =
        widgets_of(look).iter().filter_map(LocatedValue::table).flat_map(screen_widget::arrays).collect();
    all.into_iter().collect()
}

/// True if a transfer function has numbers relative to all steps of a time series.
pub(crate) fn is_of_series(look: &NodeEntry) -> bool {
    let says_so = look.setting("relative_to").and_then(LocatedValue::text) == Some("series");
    says_so && widgets_of(look).iter().filter_map(LocatedValue::table).any(relative::is_relative)
}

/// The widgets of a transfer function as stated.
fn widgets_of(look: &NodeEntry) -> &[LocatedValue] {
    look.setting("widgets").and_then(LocatedValue::list).unwrap_or_default()
}

/// The output that gives the volume that a transfer function is drawn with: "node" or "node.port".
pub(crate) fn volume_of(scene: &Scene, look: &str) -> Option<String> {
    let nodes = &scene.document.pipeline().nodes;
    let source = |node: &NodeEntry, port_type: PortType| {
        let declared = scene.node_type(node)?;
        let port = declared.all_inputs().find(|port| port.port_type == port_type)?;
        node.inputs.iter().find(|link| link.port == port.name)?.source.text().map(str::to_string)
    };
    let draws = |node: &&NodeEntry| {
        source(node, PortType::TransferFunction)
            .is_some_and(|text| text == look || text.split('.').next() == Some(look))
    };
    let mut drawn = nodes.iter().filter(draws).filter(|node| node.name != look);
    let by_use = drawn.find_map(|node| source(node, PortType::Volume));
    by_use.or_else(|| source(scene.entry(look)?, PortType::Volume))
}

/// An axis with what it is: s is the array that the reader reads for it, where one does.
pub(super) fn axis_title(look: &EditedFunction, axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Named("s") => {
            let scene = look.scene;
            let source = volume_of(scene, &look.node.name);
            let nodes = &scene.document.pipeline().nodes;
            let feeding = source.map(|source| upstream(nodes, links::source(&source, nodes).0));
            let reads = |node: &&NodeEntry| feeding.as_ref().is_some_and(|names| names.contains(&node.name));
            let scalar = |node: &NodeEntry| Some(format!("s = {}", node.setting("scalar")?.text()?));
            nodes.iter().filter(reads).find_map(scalar).unwrap_or_else(|| "s".into())
        }
        ArrayRef::Named("g") => "g = |grad s|".into(),
        ArrayRef::Array(_) | ArrayRef::Named(_) | ArrayRef::Per(..) => axis_name(axis),
    }
}

/// A quantity as an axis names it.
pub(super) fn axis_name(axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Array(name) => name.clone(),
        ArrayRef::Named(_) | ArrayRef::Per(..) => axis.to_string(),
    }
}
