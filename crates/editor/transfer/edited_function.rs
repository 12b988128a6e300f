//! The transfer function that the panel shows and edits, the volume that it is drawn with, and the quantities of its plane; and new widgets:
//! where most of the volume is, and on the values of a probe.

use super::images::Images;
use super::kinds::{PlaneContext, gaussian, gaussian_over};
use super::plane::{Change, Plane, S_AND_G, list, middle};
use super::relative::{self, PlaneAxes};
use super::screen_widget::{self, Grip, ScreenWidget};
use crate::scene::{Actions, Scene};
use crate::worker::{DataScales, PixelProbe};
use eframe::egui::Rect;
use std::collections::{BTreeMap, BTreeSet};
use std::f64::consts::FRAC_1_SQRT_2;
use voltet_core::arithmetic::decimal;
use voltet_core::probing::{Histogram, ProbeResult, kernel};
use voltet_core::transfer::AxisScale;
use voltet_document::Path;
use voltet_document::links::upstream;
use voltet_graph::{ArrayRef, Field, LocatedValue, NodeEntry, ParameterValue, PortType};
use voltet_nodes::relative::{DataScope, RELATIVE_TO};

/// The transfer function in the panel, with the data of its plane.
pub(super) struct EditedFunction<'a> {
    pub scene: &'a Scene<'a>,
    pub actions: &'a Actions,
    pub node: &'a NodeEntry,
    pub list: &'a [LocatedValue],
    pub widgets: Vec<ScreenWidget>,
    pub axes: [ArrayRef; 2],
    /// Scales of the plane's axes, along which places are positions.
    pub scales: [AxisScale; 2],
    /// Lengths of the axes of the data.
    pub extent: [f64; 2],
    pub plane: Plane,
    /// Grips of each widget in the plane.
    pub grips: Vec<Vec<Grip>>,
    images: &'a Images,
}

impl<'a> EditedFunction<'a> {
    /// `plane`: the one of the last frame; `former_peak`: where a point is dragged, the scale stands still.
    pub fn new(
        scene: &'a Scene<'a>,
        node: &'a NodeEntry,
        axes: [ArrayRef; 2],
        plane: Option<Plane>,
        former_peak: Option<f64>,
        images: &'a Images,
    ) -> EditedFunction<'a> {
        let list = widgets_of(node);
        let found = scene.distribution.as_ref();
        let extent = found.map_or([1.0; 2], |found| found.histogram.axes.map(|axis| axis.high - axis.low));
        let metric = plane.map_or(extent, Plane::metric);
        let known = found.map(|found| &found.known);
        let scales = scales(node, &axes);
        let on = PlaneContext { axes: &axes, scales, extent: metric, known, images };
        let widget = |(place, entry): (usize, &LocatedValue)| {
            let mut widget = ScreenWidget::new(entry.table().unwrap_or_default(), &on);
            let path = Path::from("widgets").with(place);
            widget.name = scene.name_of(&node.name, &path, widget.name.as_deref());
            widget
        };
        let widgets: Vec<ScreenWidget> = list.iter().enumerate().map(widget).collect();
        let peak = former_peak.unwrap_or_else(|| {
            let most = widgets.iter().filter_map(ScreenWidget::peak_of_curve).fold(0.0, f64::max);
            if most > 0.0 { 1.1 * most } else { 1.0 }
        });
        let plane = Plane { rect: Rect::ZERO, shown: [[0.0, 1.0]; 2], extent: metric, peak };
        let (actions, grips) = (scene.actions, Vec::new());
        EditedFunction { scene, actions, node, list, widgets, axes, scales, extent, plane, grips, images }
    }

    /// Takes the plane of this frame, in which the widgets' grips lie.
    pub fn place_on(&mut self, plane: Plane) {
        self.plane = plane;
        self.grips = self.widgets.iter().map(|widget| widget.grips(&plane)).collect();
    }

    pub fn histogram(&self) -> Option<&Histogram> {
        self.scene.distribution.as_ref().map(|found| &found.histogram)
    }

    pub fn known(&self) -> Option<&DataScales> {
        self.scene.distribution.as_ref().map(|found| &found.known)
    }

    /// A widget's table as it lies in the plane.
    pub fn on_plane(&self, fields: &[Field]) -> ScreenWidget {
        let (axes, scales, extent) = (&self.axes, self.scales, self.plane.metric());
        ScreenWidget::new(
            fields,
            &PlaneContext { axes, scales, extent, known: self.known(), images: self.images },
        )
    }

    /// Sets of widgets that the file keeps, by their digits.
    pub fn sets(&self) -> &BTreeMap<u8, Vec<LocatedValue>> {
        &self.scene.document.view().sets
    }

    pub fn is_of_s_and_g(&self) -> bool {
        self.axes == S_AND_G
    }

    /// Length along the axis of a quantity that the pointer resolves.
    pub fn step(&self, quantity: &ArrayRef) -> f64 {
        let axis = self.axes.iter().position(|axis| axis == quantity);
        axis.map_or(f64::INFINITY, |axis| 0.1 * self.plane.step(axis))
    }
}

/// Scales of the axes of a plane, as a transfer function states those of s and g; one that lacks a number is linear.
pub(crate) fn scales(look: &NodeEntry, axes: &[ArrayRef; 2]) -> [AxisScale; 2] {
    let scale = |axis: &str| match look.setting(&format!("{axis}_scale")).and_then(LocatedValue::text) {
        Some("log") => AxisScale::Log,
        Some("symlog") => {
            let linear_below = look.setting(&format!("{axis}_linear_below")).and_then(LocatedValue::number);
            let is_valid = |number: &f64| *number > 0.0 && number.is_finite();
            linear_below
                .filter(is_valid)
                .map_or(AxisScale::Linear, |linear_below| AxisScale::SymLog { linear_below })
        }
        _ => AxisScale::Linear,
    };
    if *axes == S_AND_G { ["s", "g"].map(scale) } else { Default::default() }
}

/// The transfer function that is edited: the selected one, else the first that feeds the picture.
pub(crate) fn edited_node<'a>(scene: &Scene<'a>) -> Option<&'a NodeEntry> {
    let nodes = &scene.document.pipeline().nodes;
    let is_one = |node: &&NodeEntry| node.node_type.text() == Some("transfer-function");
    let selected = nodes.iter().filter(is_one).find(|node| scene.selection.contains(&node.name));
    let feeding = upstream(nodes, scene.shown_node?);
    selected.or_else(|| nodes.iter().filter(is_one).find(|node| feeding.contains(&node.name)))
}

/// The transfer function that the shown picture is drawn with, of several the selected one or else the first; and the output that gives the
/// volume.
pub(crate) fn drawn_with<'a>(scene: &Scene<'a>) -> Option<(&'a NodeEntry, String)> {
    let nodes = &scene.document.pipeline().nodes;
    let feeding = upstream(nodes, scene.shown_node?);
    let feeds = |node: &NodeEntry| feeding.contains(&node.name);
    let is_one = |node: &&NodeEntry| node.node_type.text() == Some("transfer-function") && feeds(node);
    let selected = nodes.iter().filter(is_one).find(|node| scene.selection.contains(&node.name));
    let look = selected.or_else(|| nodes.iter().find(is_one))?;
    Some((look, volume_among(scene, &look.name, feeds)?))
}

pub(crate) fn fields_of(look: &NodeEntry) -> Vec<String> {
    let all: BTreeSet<String> =
        widgets_of(look).iter().filter_map(LocatedValue::table).flat_map(screen_widget::arrays).collect();
    all.into_iter().collect()
}

/// True if a widget of a transfer function looks at the gradient magnitude.
pub(crate) fn looks_at_g(node: &NodeEntry) -> bool {
    let is_one = node.node_type.text() == Some("transfer-function");
    is_one && widgets_of(node).iter().filter_map(LocatedValue::table).any(screen_widget::looks_at_g)
}

/// Data that the relative numbers of a transfer function refer to; one step where it has none.
pub(crate) fn data_scope(look: &NodeEntry) -> DataScope {
    let stated = look.setting(RELATIVE_TO.name).and_then(LocatedValue::text);
    let has_some = || widgets_of(look).iter().filter_map(LocatedValue::table).any(relative::is_relative);
    stated.map(DataScope::from_word).filter(|_| has_some()).unwrap_or_default()
}

fn widgets_of(look: &NodeEntry) -> &[LocatedValue] {
    look.setting("widgets").and_then(LocatedValue::list).unwrap_or_default()
}

/// The output that gives the volume that a transfer function is drawn with: "node" or "node.port".
pub(crate) fn volume_of(scene: &Scene, look: &str) -> Option<String> {
    volume_among(scene, look, |_| true)
}

/// Output that gives the volume with which some nodes draw a transfer function.
fn volume_among(scene: &Scene, look: &str, is_one: impl Fn(&NodeEntry) -> bool) -> Option<String> {
    let mut drawn = drawing(scene, look).filter(|node| is_one(node));
    let by_use = drawn.find_map(|node| source_of(scene, node, PortType::Volume));
    by_use.or_else(|| source_of(scene, scene.entry(look)?, PortType::Volume))
}

/// Nodes that draw a transfer function.
fn drawing<'a>(scene: &'a Scene, look: &'a str) -> impl Iterator<Item = &'a NodeEntry> {
    let draws = move |node: &&NodeEntry| {
        source_of(scene, node, PortType::TransferFunction)
            .is_some_and(|text| text == look || text.split('.').next() == Some(look))
    };
    scene.document.pipeline().nodes.iter().filter(draws).filter(move |node| node.name != look)
}

/// Source of the first input of a type.
fn source_of(scene: &Scene, node: &NodeEntry, port_type: PortType) -> Option<String> {
    let declared = scene.node_type(node)?;
    let port = declared.all_inputs().find(|port| port.port_type == port_type)?;
    node.inputs.iter().find(|link| link.port == port.name)?.source.text().map(str::to_string)
}

/// The outputs, each by node and port, whose volumes are drawn with a transfer function; that which is wired into it where none is.
pub(crate) fn volumes_of(scene: &Scene, look: &str) -> BTreeSet<(String, String)> {
    let volume = |node: &NodeEntry| source_of(scene, node, PortType::Volume);
    let mut sources: Vec<String> = drawing(scene, look).filter_map(volume).collect();
    if sources.is_empty() {
        sources.extend(scene.entry(look).and_then(volume));
    }
    sources.iter().map(|text| scene.output_of(text)).collect()
}

pub(super) fn axis_title(look: &EditedFunction, axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Named("s") => look.scene.scalar().map_or("s".into(), |name| format!("s = {name}")),
        ArrayRef::Named("g") => "g = |grad s|".into(),
        ArrayRef::Array(_) | ArrayRef::Named(_) | ArrayRef::Per(..) => axis_name(axis),
    }
}

pub(super) fn axis_name(axis: &ArrayRef) -> String {
    match axis {
        ArrayRef::Array(name) => name.clone(),
        ArrayRef::Named(_) | ArrayRef::Per(..) => axis.to_string(),
    }
}

/// Deviations of a new Gaussian, as shares of the axes.
const NEW: [f64; 2] = [0.02, 0.05];

/// Least deviation in any direction of one on probed values, as a share of the axes: what a hand can take hold of.
const MIN_DEVIATION: f64 = 0.01;

/// Correlations that are so small are none.
const UPRIGHT: f64 = 0.05;

/// Extinction of a new widget, per unit distance, where no other shows what is usual. The unit is a hundredth of the data's diagonal where
/// nothing else is stated: after a tenth of the diagonal at its peak 63 % are absorbed, so that what lies behind is seen.
const EXTINCTION: f64 = 0.1;

/// Share of the greatest extinction from which on a widget holds a bin: a haze over everything holds none.
const HELD: f64 = 0.1;

/// A Gaussian at the bin with the most volume that no widget holds, or with the most of all where widgets hold all of it; `None` without a
/// histogram, and on axes that no kind of widget is over.
pub(super) fn at_peak(look: &EditedFunction) -> Option<ParameterValue> {
    let histogram = look.histogram()?;
    let [s, g] = histogram.axes;
    let peak = |widget: &ScreenWidget| widget.peak_of_curve().unwrap_or(widget.extinction);
    let least = HELD * look.widgets.iter().map(peak).fold(0.0, f64::max);
    let rank = |k: usize| {
        let at = [middle(s, k % s.bins), middle(g, k / s.bins)];
        let is_free = look.widgets.iter().all(|widget| peak(widget) * widget.strength(at) < least);
        (is_free && histogram.volumes[k] > 0.0, histogram.volumes[k], at)
    };
    let bins = (0..histogram.volumes.len()).map(rank);
    let (.., centre) = bins.max_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)))?;
    let sigma = [NEW[0] * (s.high - s.low), NEW[1] * (g.high - g.low)];
    if look.is_of_s_and_g() {
        let k =
            [[1.0 / sigma[0], 0.0], [0.0, 1.0 / sigma[1]]].map(|row| row.map(|x| x * FRAC_1_SQRT_2).to_vec());
        return Some(widget(look, gaussian(centre, &k, [1.0; 2])));
    }
    Some(widget(look, gaussian_over(&look.axes, centre, sigma)?))
}

/// A Gaussian by the mean and the covariance of probed values (Kniss et al. 2003, section 6), turned to the covariance's principal
/// axes. In a direction in which the values hardly vary it is as wide as a hand can take hold of; a quantity that is the same in
/// all of the data is not looked at. `None` without values.
pub(super) fn at_probe(look: &EditedFunction, probed: &PixelProbe) -> Option<ParameterValue> {
    let (mean, covariance) = probed.on(look.scales).moments()?;
    let known = look.known();
    let extent: Vec<f64> = ["s", "g"]
        .into_iter()
        .enumerate()
        .map(|(k, name)| {
            let range = known.and_then(|known| known.ranges.get(&ArrayRef::Named(name)));
            let range = range.map(|range| look.scales[k].positions(*range));
            let is_constant = range.is_some_and(|[low, high]| low == high);
            if is_constant || !look.is_of_s_and_g() {
                range.map_or(1.0, |[a, b]| b - a)
            } else {
                look.extent[k]
            }
        })
        .collect();
    let share = |i: usize, j: usize| {
        let by = extent[i] * extent[j];
        if by > 0.0 { covariance[i][j] / by } else { 0.0 }
    };
    let found = ProbeResult {
        mean: mean.to_vec(),
        covariance: (0..2).map(|i| (0..2).map(|j| share(i, j)).collect()).collect(),
        cell_count: 0,
        volume: 0.0,
        point_count: probed.values.len() as u64,
        extent,
    };
    let spread = (covariance[0][0] * covariance[1][1]).sqrt();
    let is_correlated = spread > 0.0 && (covariance[0][1] / spread).abs() > UPRIGHT;
    let k = kernel(&found, MIN_DEVIATION, 1.0, is_correlated);
    let extent = [0, 1].map(|k: usize| if found.extent[k] > 0.0 { found.extent[k] } else { 1.0 });
    Some(widget(look, gaussian(mean, &k, extent)))
}

/// Share of the values beyond each end of a proposed range, and the step of its written ends, shares of the data's range.
const LEFT_OUT_SHARE: f64 = 0.05;
const WRITTEN: f64 = 1e-4;

/// The ranges of s and g that hold most of the probed values, at least as wide as a hand can take hold of. `None` without values.
pub(super) fn range_at_probe(look: &EditedFunction, probed: &PixelProbe) -> Option<ParameterValue> {
    let found = probed.on(look.scales).ranges(LEFT_OUT_SHARE).filter(|_| look.is_of_s_and_g())?;
    let wide = |axis: usize| {
        let ([low, high], least) = (found[axis], 2.0 * MIN_DEVIATION * look.extent[axis]);
        let aside = 0.5 * (least - (high - low)).max(0.0);
        let ends = [low - aside, high + aside].map(|end| decimal(end, WRITTEN * look.extent[axis]));
        Field::new(["s", "g"][axis], list(&ends))
    };
    let region = ParameterValue::Table(vec![wide(0), wide(1)]);
    Some(widget(look, ("uniform", vec![("region", Some(region))])))
}

fn widget(look: &EditedFunction, (kind, numbers): (&str, Vec<Change>)) -> ParameterValue {
    let extinction = look.widgets.iter().map(|widget| widget.extinction).fold(0.0, f64::max);
    let extinction = if extinction > 0.0 { extinction } else { EXTINCTION };
    // Hues far apart, one after the other.
    const COLORS: [[f64; 3]; 6] = [
        [1.0, 0.5, 0.1],
        [0.1, 0.45, 1.0],
        [0.2, 0.8, 0.25],
        [0.9, 0.15, 0.5],
        [0.95, 0.85, 0.2],
        [0.3, 0.8, 0.85],
    ];
    let color = COLORS[look.widgets.len() % COLORS.len()];
    let first =
        [Field::new("kind", kind), Field::new("color", list(&color)), Field::new("extinction", extinction)];
    let numbers = numbers.into_iter().filter_map(|(key, value)| Some(Field::new(key, value?)));
    let fields: Vec<Field> = first.into_iter().chain(numbers).collect();
    let step = |quantity: &ArrayRef| look.step(quantity);
    ParameterValue::Table(relative::off_plane(&fields, &PlaneAxes { scales: look.scales, step: &step }))
}
