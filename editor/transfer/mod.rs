//! The transfer function editor: the volume-weighted histogram over s and g, and every widget on it, edited where it lies.

mod draw;
mod form;
mod hand;
mod head;
mod look;
mod moved;
mod plane;
mod sets;

use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use crate::worker::short;
use eframe::egui::{self, Align2, FontId, Rect, Sense, Ui, pos2, vec2};
use form::Drawn;
use look::Look;
use moved::{Change, Handle};
use plane::{Counts, Plane};
use sets::Sets;
use std::collections::BTreeSet;
use voltet_core::graph::{NodeEntry, PortType, Setting};
use voltet_document::links::upstream;
use voltet_document::{Edit, Path};

/// Room for the numbers of the axes: left, below.
const MARGIN: [f32; 2] = [52.0, 18.0];

/// The panel, with what a hand is doing in it.
#[derive(Default)]
pub(crate) struct TransferPanel {
    /// The shown part of the plane; all of the data until a hand chose another.
    shown: Option<[[f64; 2]; 2]>,
    /// The widget in hand, by its place.
    chosen: usize,
    drag: Option<Drag>,
    counts: Counts,
    sets: Sets,
    /// Widgets that the window's picture leaves out; the file keeps them.
    hidden: BTreeSet<usize>,
    of: Option<String>,
    /// The plane of the last frame, for tests.
    #[cfg(test)]
    plane: Option<Plane>,
}

/// A drag: the widget as it was, what is held, and where it began.
struct Drag {
    widget: Drawn,
    handle: Option<Handle>,
    from: [f64; 2],
}

/// The transfer function that is edited: the selected one, else the first that feeds the picture.
pub(crate) fn of<'a>(scene: &Scene<'a>) -> Option<&'a NodeEntry> {
    let nodes = &scene.document.pipeline().nodes;
    let is_one = |node: &&NodeEntry| node.node_type.text() == Some("transfer-function");
    let selected = nodes.iter().filter(is_one).find(|node| scene.selection.contains(&node.name));
    let feeding = upstream(nodes, scene.shown_node?);
    selected.or_else(|| nodes.iter().filter(is_one).find(|node| feeding.contains(&node.name)))
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

impl TransferPanel {
    /// Whether there is a transfer function to edit.
    pub fn is_wanted(&self, scene: &Scene) -> bool {
        of(scene).is_some()
    }

    /// The widgets of a node that the window's picture leaves out.
    pub fn hidden(&self) -> Option<(&str, &BTreeSet<usize>)> {
        self.of.as_deref().filter(|_| !self.hidden.is_empty()).map(|of| (of, &self.hidden))
    }

    /// Where a value was drawn.
    #[cfg(test)]
    pub fn place_of(&self, value: [f64; 2]) -> Option<egui::Pos2> {
        self.plane.map(|plane| plane.to_window(value))
    }

    /// The axes that were drawn.
    #[cfg(test)]
    pub fn shown_axes(&self) -> [[f64; 2]; 2] {
        self.plane.map_or([[0.0; 2]; 2], |plane| plane.shown)
    }

    pub fn show(&mut self, ui: &mut Ui, scene: &Scene, actions: &mut Actions) {
        let Some(node) = of(scene) else { return };
        if self.of.as_deref() != Some(&node.name) {
            let before = self.of.replace(node.name.clone());
            (self.chosen, self.drag, self.shown) = (0, None, None);
            if before.is_some() {
                self.hidden.clear();
            }
        }
        let look = self.look(scene, node);
        self.chosen = self.chosen.min(look.widgets.len().saturating_sub(1));
        self.hidden.retain(|place| *place < look.widgets.len());
        ui.add_space(3.0);
        self.head(ui, &look, actions);
        let (whole, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(60.0, 60.0)), Sense::click_and_drag());
        let rect = Rect::from_min_max(
            pos2(whole.left() + MARGIN[0], whole.top() + 2.0),
            pos2(whole.right() - 8.0, whole.bottom() - MARGIN[1]),
        );
        let of_data = look.histogram.as_ref().map(|histogram| plane::whole(histogram));
        let shown = self.shown.or(of_data).unwrap_or([[0.0, 1.0], [0.0, 1.0]]);
        let plane = Plane { rect, shown };
        #[cfg(test)]
        {
            self.plane = Some(plane);
        }
        let dark = ui.visuals().dark_mode;
        ui.painter().rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
        if let Some(histogram) = &look.histogram {
            self.counts.draw(ui, plane, histogram);
        }
        plane::axes(ui, plane, ["s", "g = |grad s|"]);
        for (place, widget) in look.widgets.iter().enumerate() {
            let is_chosen = place == self.chosen;
            draw::widget(ui, plane, widget, is_chosen, self.hidden.contains(&place), look.peak);
        }
        if let Some(probed) = &look.probed {
            draw::probed(ui, plane, probed);
        }
        if look.histogram.is_none() {
            let text = scene
                .distribution_fault
                .clone()
                .unwrap_or_else(|| "the distribution of the data comes …".into());
            let font = FontId::proportional(12.0);
            ui.painter().text(rect.center(), Align2::CENTER_CENTER, text, font, theme::weak(dark));
        }
        self.move_plane(ui, &response, plane, of_data);
        self.hand(ui, &response, plane, &look, actions);
        self.keys(ui, whole, plane, &look, actions);
        self.readout(ui, &response, plane, &look);
    }

    fn look<'a>(&self, scene: &Scene<'a>, node: &'a NodeEntry) -> Look<'a> {
        let stated = node.settings.iter().find(|field| field.name == "widgets");
        let list = stated.and_then(|field| field.setting.list()).unwrap_or_default();
        let histogram = scene.distribution.clone();
        let extent =
            histogram.as_ref().map_or([1.0; 2], |histogram| histogram.axes.map(|axis| axis.high - axis.low));
        let known = scene.looks.get(&node.name);
        let widget = |(place, entry): (usize, &Setting)| {
            let resolved = known.and_then(|look| look.transfer_function.widgets.get(place));
            Drawn::read(entry.table().unwrap_or_default(), resolved, extent)
        };
        let widgets: Vec<Drawn> = list.iter().enumerate().map(widget).collect();
        let of_curve = |widget: &Drawn| match &widget.form {
            form::Form::Points(points) => points.iter().map(|point| point[4]).fold(0.0, f64::max),
            _ => 0.0,
        };
        let peak = match &self.drag {
            // The scale stands still while a point is dragged.
            Some(Drag { widget, .. }) => of_curve(widget),
            None => widgets.iter().map(of_curve).fold(0.0, f64::max),
        };
        let peak = if peak > 0.0 { 1.1 * peak } else { 1.0 };
        Look { node, list, widgets, histogram, extent, peak, probed: scene.probed.clone() }
    }

    /// The value and the share of the volume under the pointer.
    fn readout(&self, ui: &Ui, response: &egui::Response, plane: Plane, look: &Look) {
        let Some(at) = response.hover_pos().filter(|at| plane.rect.contains(*at)) else { return };
        let value = plane.to_values(at);
        let share = look.histogram.as_ref().and_then(|histogram| plane::share_at(histogram, value));
        let share =
            share.map_or(String::new(), |share| format!("   {} % of the volume a bin", short(100.0 * share)));
        let text = format!("s {}   g {}{share}", short(value[0]), short(value[1]));
        let color = ui.visuals().text_color();
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(11.5), color);
        let place = Align2::RIGHT_TOP.anchor_size(plane.rect.right_top() + vec2(-6.0, 4.0), galley.size());
        ui.painter().rect_filled(place.expand(3.0), 3.0, ui.visuals().extreme_bg_color.gamma_multiply(0.85));
        ui.painter().galley(place.min, galley, color);
    }
}

/// The changes of a widget as edits of its node, one step.
fn edit(look: &Look, place: usize, changes: Vec<Change>, actions: &mut Actions) {
    let Some(entry) = look.list.get(place).and_then(Setting::table) else { return };
    let is_stated = |key: &str| entry.iter().any(|field| field.name == key);
    let path = |key: &str| Path::from("widgets").with(place).and(&Path::from(key));
    let node = || look.node.name.clone();
    let edits = changes.into_iter().filter_map(|(key, value)| match value {
        Some(value) => Some(Edit::Set { node: node(), path: path(key), value }),
        None => is_stated(key).then(|| Edit::Unset { node: node(), path: path(key) }),
    });
    actions.edits(format!("move widget {} of '{}'", place + 1, look.node.name), edits.collect());
}
