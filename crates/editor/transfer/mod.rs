//! The transfer function editor: the volume-weighted histogram over s and g, or over two arrays, and every widget on it, edited
//! where it lies.

mod edited_function;
mod images;
mod kinds;
mod list;
mod plane;
mod pointer;
mod proposals;
mod relative;
mod scalar;
mod screen_widget;
#[cfg(test)]
mod tests;

use crate::focus::FollowFocus;
use crate::scene::{Action, Command, Scene};
use crate::theme::{self, Help};
use crate::ways_out::{buttons, ways_out_of_data};
use crate::worker::{HISTOGRAM, short, short_by};
use edited_function::{EditedFunction, axis_name, axis_title};
pub(crate) use edited_function::{
    data_scope, drawn_with, edited_node, fields_of, looks_at_g, scales, volume_of, volumes_of,
};
use eframe::egui::{
    self, Align, Align2, Button, FontId, Layout, Rect, ScrollArea, Sense, Stroke, StrokeKind, Ui, UiBuilder,
    WidgetInfo, WidgetType, pos2, vec2,
};
use images::Images;
pub(crate) use plane::S_AND_G;
use plane::{Change, Counts, Handle, Plane};
use relative::PlaneAxes;
pub(crate) use relative::in_numbers;
use screen_widget::{Drag, HeldVolume, ScreenWidget};
use std::collections::BTreeSet;
use voltet_document::links::sources;
use voltet_document::{Edit, Path};
use voltet_graph::{ArrayRef, LocatedValue, ParameterValue, find_setting};

/// Room for the numbers of the axes: left, below, and right where a curve has its own.
const MARGIN: [f32; 3] = [52.0, 18.0, 44.0];

/// Least share of the panel's height that the plane has; what stands above it scrolls where it needs more.
const PLANE_SHARE: f32 = 0.6;

/// The panel, with what a hand is doing in it.
#[derive(Default)]
pub(crate) struct TransferPanel {
    /// The quantities of the plane; s and g until a hand chose others.
    axes: Option<[ArrayRef; 2]>,
    typed_axis: [String; 2],
    /// Name that is being typed, with the node and the place of its widget.
    typed_name: Option<((String, usize), String)>,
    /// The shown part of the plane; all of the data until a hand chose another.
    shown: Option<[[f64; 2]; 2]>,
    /// The widget in hand, by its place, and the one before the last click.
    chosen: usize,
    before_click: usize,
    held: Option<Handle>,
    /// Widget under the pointer, by its place, and the handle there.
    hovered: Option<(usize, Option<Handle>)>,
    drag: Option<Drag>,
    counts: Counts,
    /// Share of the volume that the widget in hand holds.
    held_volume: HeldVolume,
    images: Images,
    /// Widget that the pointer is about to add.
    proposed: Option<ParameterValue>,
    /// Button that added what it proposed, until the pointer has left it.
    was_added: Option<&'static str>,
    /// Widgets that the window's picture leaves out; the file keeps them.
    hidden: BTreeSet<usize>,
    of: Option<String>,
    /// True if the pointer was over the panel in the last frame.
    has_pointer: bool,
    /// True if keys go to the widgets wherever the pointer is.
    pub by_keyboard: bool,
    /// True if a widget was selected after the last node: it is what is deleted by a key.
    is_last: bool,
    /// True if the widget in hand is to get the focus in the list of widgets.
    pub begins: bool,
    /// A command of the menus for the widget in hand: to delete or duplicate it.
    pub asked: Option<Command>,
    /// True if nothing but a node has the focus, which would take the arrow keys.
    pub has_arrows: bool,
    plane: Option<Plane>,
}

impl TransferPanel {
    pub fn is_wanted(&self, scene: &Scene) -> bool {
        edited_node(scene).is_some()
    }

    /// All of the data into view.
    pub fn show_all(&mut self) {
        self.shown = None;
    }

    /// True if the widget in hand is what was selected last.
    pub fn is_last(&self) -> bool {
        self.by_keyboard || self.is_last
    }

    /// True if keys are for the widgets, but for those that delete.
    pub fn takes_keys(&self) -> bool {
        self.has_pointer || self.is_last()
    }

    /// Has the keys go to the widgets wherever the pointer is, or no more; the widget in hand is still what is deleted, until a node is
    /// selected.
    pub fn switch_keys(&mut self) {
        self.by_keyboard = !self.by_keyboard;
        self.is_last = true;
    }

    /// A node was selected, or nothing is edited any more: keys are for the graph again.
    pub fn lose_keys(&mut self) {
        (self.is_last, self.has_pointer, self.by_keyboard) = (false, false, false);
        self.asked = None;
    }

    /// The widgets of a node that the window's picture leaves out.
    pub fn hidden(&self) -> Option<(&str, &BTreeSet<usize>)> {
        self.of.as_deref().filter(|_| !self.hidden.is_empty()).map(|of| (of, &self.hidden))
    }

    pub fn dragged(&self) -> Option<&str> {
        self.of.as_deref().filter(|_| self.drag.is_some())
    }

    pub fn axes(&self) -> [ArrayRef; 2] {
        self.axes.clone().unwrap_or(S_AND_G)
    }

    /// The transfer function and the place of the widget in hand, while nobody drags it.
    pub fn in_hand(&self) -> Option<(&str, usize)> {
        self.of.as_deref().filter(|_| self.drag.is_none()).map(|of| (of, self.chosen))
    }

    pub fn show(&mut self, ui: &mut Ui, scene: &Scene) {
        self.has_pointer = ui.rect_contains_pointer(ui.max_rect());
        if self.by_keyboard && ui.input(|input| input.key_pressed(egui::Key::Escape)) {
            self.switch_keys();
        }
        let Some(node) = edited_node(scene) else { return };
        let is_another = self.of.as_deref() != Some(&node.name);
        if is_another {
            let before = self.of.replace(node.name.clone());
            (self.chosen, self.drag, self.held, self.shown, self.plane) = (0, None, None, None, None);
            if before.is_some() {
                self.hidden.clear();
            }
        }
        let images = self.images.in_folder(ui.ctx(), scene.document.folder());
        let peak = self.drag.as_ref().map(|drag| drag.peak);
        let mut look = EditedFunction::new(scene, node, self.axes(), self.plane, peak, &images);
        self.chosen = self.chosen.min(look.widgets.len().saturating_sub(1));
        if is_another {
            self.choose(0, &look);
        }
        self.hidden.retain(|place| *place < look.widgets.len());
        ui.add_space(3.0);
        let most = (1.0 - PLANE_SHARE) * ui.available_height();
        let head =
            ScrollArea::vertical().auto_shrink([false, true]).max_height(most).min_scrolled_height(most);
        head.show_followed(ui, |ui| self.head(ui, &look));
        let (whole, response) =
            ui.allocate_exact_size(ui.available_size().max(vec2(60.0, 40.0)), Sense::click_and_drag());
        let in_hand = look.widgets.get(self.chosen);
        let has_curve = in_hand.is_some_and(|widget| widget.peak_of_curve().is_some());
        let rect = Rect::from_min_max(
            pos2(whole.left() + MARGIN[0], whole.top() + 2.0),
            pos2(whole.right() - if has_curve { MARGIN[2] } else { 8.0 }, whole.bottom() - MARGIN[1]),
        );
        // What was shown stays until the next histogram is there.
        let shown = self.shown.or_else(|| look.histogram().map(plane::whole));
        let shown = shown.or(self.plane.map(|plane| plane.shown));
        look.place_on(Plane { rect, shown: shown.unwrap_or([[0.0, 1.0]; 2]), ..look.plane });
        self.plane = Some(look.plane);
        self.draw(ui, &look);
        if has_curve {
            plane::extinctions(ui, look.plane);
        }
        self.name(ui, &response, &look);
        self.move_plane(ui, &response, look.plane);
        self.hover(ui, &response, &look);
        self.hand(ui, &response, &look);
        if look.widgets.is_empty() {
            self.invite(ui, &look);
        }
        self.offer_ways_out(ui, &look);
        self.keys(ui, &look);
        self.readout(ui, &response, &look);
    }

    fn draw(&mut self, ui: &Ui, look: &EditedFunction) {
        let plane = look.plane;
        let (rect, dark) = (plane.rect, ui.visuals().dark_mode);
        ui.painter().rect_filled(rect, 0.0, ui.visuals().extreme_bg_color);
        if let Some(found) = &look.scene.distribution {
            self.counts.draw(ui, plane, found);
        }
        if self.by_keyboard {
            ui.painter().rect_stroke(rect, 0.0, Stroke::new(2.0, theme::accent(dark)), StrokeKind::Inside);
        }
        let [x, y] = look.axes.each_ref().map(|axis| axis_title(look, axis));
        plane::axes(ui, plane, look.scales, [&x, &y]);
        if let Some(probed) = look.scene.probed.as_ref().filter(|_| look.is_of_s_and_g()) {
            plane::probed(ui, plane, &probed.on(look.scales));
        }
        self.draw_proposal(ui, look);
        if let Some(cell) = look.scene.hovered.as_ref().and_then(|hit| hit.cell.as_ref())
            && look.is_of_s_and_g()
            && look.scene.hovered_in == volume_of(look.scene, &look.node.name)
        {
            let values = [cell.s, cell.g.unwrap_or(0.0)];
            plane::mark(ui, plane, [0, 1].map(|k: usize| look.scales[k].position(values[k])));
        }
        // The one in hand above the others.
        let others = (0..look.widgets.len()).filter(|place| *place != self.chosen);
        for place in others.chain([self.chosen]) {
            let Some(widget) = look.widgets.get(place) else { continue };
            let hovered = self.hovered.filter(|(known, _)| *known == place && self.drag.is_none());
            let handle = hovered.and_then(|(_, handle)| handle).or(self.held);
            let handles = (place == self.chosen).then_some((&look.grips[place][..], handle));
            screen_widget::draw(ui, plane, widget, handles, self.hidden.contains(&place));
        }
        if look.scene.distribution.is_none() {
            let fault = look.scene.distribution_fault.as_ref();
            let text = match fault.map(|fault| look.scene.reason("histogram", fault)) {
                Some(fault) => fault,
                None if volume_of(look.scene, &look.node.name).is_some() => computing(look.scene),
                None => {
                    "no histogram: no picture is drawn with this transfer function and a volume yet".into()
                }
            };
            let galley =
                ui.painter().layout(text, FontId::proportional(12.0), theme::weak(dark), rect.width() - 20.0);
            // Below the offer of a first widget.
            let middle =
                if look.widgets.is_empty() { rect.center() + vec2(0.0, 44.0) } else { rect.center() };
            let place = Align2::CENTER_CENTER.anchor_size(middle, galley.size());
            ui.painter().galley(place.min, galley, theme::weak(dark));
        }
    }

    /// Offers a first widget, where there is none.
    fn invite(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let rect = Rect::from_center_size(look.plane.rect.center(), vec2(280.0, 56.0));
        let builder = UiBuilder::new().max_rect(rect).layout(Layout::top_down(Align::Center));
        let fed = look.node.inputs.iter().filter(|link| link.port == "widgets").flat_map(sources).next();
        ui.scope_builder(builder, |ui| {
            if let Some(giving) = fed.map(|source| look.scene.giving(source).0) {
                ui.label(format!("The widgets are those of '{giving}', by a wire."));
                let show = Action::Select([giving.to_string()].into());
                return buttons(ui, look.scene, &[(format!("Show '{giving}'"), show)]);
            }
            ui.label("Nothing to see yet: there are no widgets.");
            let button = ui.add_enabled(look.histogram().is_some(), Button::new("Add a widget at the peak"));
            if button.help("where most of the volume is (P)").clicked() {
                self.add_at_peak(look);
            }
        });
    }

    /// Buttons below the reason for which there is no histogram, unless that is said elsewhere.
    fn offer_ways_out(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let fault = look.scene.distribution_fault.as_ref().filter(|fault| !look.scene.is_said(fault));
        let Some(fault) = fault.filter(|_| look.scene.distribution.is_none()) else { return };
        let room = look.plane.rect.shrink(8.0);
        let builder = UiBuilder::new().max_rect(room).layout(Layout::bottom_up(Align::Center));
        ui.scope_builder(builder, |ui| {
            ui.horizontal_wrapped(|ui| {
                buttons(ui, look.scene, &ways_out_of_data(look.scene, fault));
                if !look.is_of_s_and_g() && ui.small_button("Axes s, g").clicked() {
                    self.set_axes(S_AND_G);
                }
            });
        });
    }

    /// Names of the plane and of the handles on it, by which they are found without a pointer.
    fn name(&self, ui: &Ui, response: &egui::Response, look: &EditedFunction) {
        let [x, y] = look.axes.each_ref().map(axis_name);
        let name = format!("plane of {x} and {y}");
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, &name));
        for screen_widget::Grip { handle, place, .. } in look.grips.get(self.chosen).into_iter().flatten() {
            let rect = Rect::from_center_size(*place, vec2(10.0, 10.0));
            let name = format!("{} of widget {}", handle.name(), self.chosen + 1);
            let grip = ui.interact(rect, ui.id().with((name.as_str(), "grip")), Sense::empty());
            grip.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, &name));
        }
    }

    /// The value and the share of the volume under the pointer.
    fn readout(&self, ui: &Ui, response: &egui::Response, look: &EditedFunction) {
        let plane = look.plane;
        let Some(at) = response.hover_pos().filter(|at| plane.rect.contains(*at)) else { return };
        let value = plane.to_values(at);
        let share = look.histogram().and_then(|histogram| plane::share_at(histogram, value));
        let share =
            share.map_or(String::new(), |share| format!("   {} % of the volume a bin", short(100.0 * share)));
        let [x, y] = look.axes.each_ref().map(axis_name);
        let number = |axis: usize| {
            let scale = look.scales[axis];
            let [at, next] = [value[axis], value[axis] + plane.step(axis)].map(|place| scale.value(place));
            short_by(at, next - at)
        };
        let text = format!("{x} {}   {y} {}{share}", number(0), number(1));
        let color = ui.visuals().text_color();
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(11.5), color);
        let place = Align2::RIGHT_TOP.anchor_size(plane.rect.right_top() + vec2(-6.0, 4.0), galley.size());
        plane::on_ground(ui, place.min, galley);
    }
}

/// Words for the histogram that is being computed.
fn computing(scene: &Scene) -> String {
    match &scene.distribution_progress {
        Some((stage, share)) if stage == HISTOGRAM => {
            format!("computing the histogram: {:.0} %", 100.0 * share)
        }
        // Data that are no longer kept come first.
        Some((stage, share)) => format!("computing the histogram: {stage} {:.0} %", 100.0 * share),
        None => "computing the histogram …".into(),
    }
}

/// The changes of a widget (as it was when they began) as edits of its node, one step.
fn edit(look: &EditedFunction, place: usize, before: &ScreenWidget, changes: Vec<Change>) {
    let Some(entry) = look.list.get(place).and_then(LocatedValue::table) else { return };
    let is_stated = |key: &str| find_setting(entry, key).is_some();
    let known = look.known();
    let path = |key: &str| Path::from("widgets").with(place).and(&Path::from(key));
    let node = || look.node.name.clone();
    let step = |quantity: &ArrayRef| look.step(quantity);
    let axes = PlaneAxes { scales: look.scales, step: &step };
    let edits = changes.into_iter().filter_map(|(key, value)| match value {
        Some(value) => {
            let value = relative::as_written(&before.stated, known, &axes, key, value);
            Some(Edit::Set { node: node(), path: path(key), value })
        }
        None => is_stated(key).then(|| Edit::Unset { node: node(), path: path(key) }),
    });
    look.actions.edits(format!("move widget {} of '{}'", place + 1, look.node.name), edits.collect());
}
