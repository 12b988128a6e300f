//! The list of widgets: its commands and their keys over the plane, sets that the file keeps under `[editor]`; and the lines above the plane
//! with the choice of axes: s, g, arrays of the data, and arrays that widgets name.

use super::edited_function::{EditedFunction, at_peak, axis_name, volume_of};
use super::plane::S_AND_G;
use super::pointer::FINE;
use super::scalar::scalar_menu;
use super::screen_widget::{self, ScreenWidget};
use super::{TransferPanel, edit};
use crate::fields::{LIST_WIDTH, by_hand, drag, edited_color, list_area};
use crate::focus::FollowFocus;
use crate::scene::Command;
use crate::theme::{self, Help, button};
use crate::ways_out::{buttons, ways_out_of_data, why_ended};
use crate::worker::{short, widget_count};
use eframe::egui::{
    Button, Key, Modifiers, Popup, RichText, Sense, Stroke, StrokeKind, TextEdit, Ui, WidgetInfo, WidgetType,
    vec2,
};
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::parameters::ENTRY_NAME;
use voltet_core::with_commas;
use voltet_document::{Edit, Path, links};
use voltet_graph::{ArrayRef, Field, LocatedValue, ParameterValue, Range, find_setting};

/// A nudge by an arrow key, as a share of the shown axis.
const NUDGE: f64 = 0.01;

type WidgetCommand = fn(&mut TransferPanel, &EditedFunction);

/// Keys of commands for the widget in hand.
const KEYS: [(Modifiers, Key, WidgetCommand); 10] = [
    (Modifiers::SHIFT, Key::PageUp, |panel, look| panel.reorder(look, panel.chosen.saturating_sub(1))),
    (Modifiers::SHIFT, Key::PageDown, |panel, look| panel.reorder(look, panel.chosen + 1)),
    (Modifiers::NONE, Key::PageUp, |panel, look| panel.choose(panel.chosen + look.widgets.len() - 1, look)),
    (Modifiers::NONE, Key::PageDown, |panel, look| panel.choose(panel.chosen + 1, look)),
    (Modifiers::NONE, Key::V, |panel, _| panel.hide(panel.chosen)),
    (Modifiers::NONE, Key::S, |panel, look| panel.solo(panel.chosen, look.widgets.len())),
    (Modifiers::NONE, Key::P, TransferPanel::add_at_peak),
    (Modifiers::COMMAND, Key::D, TransferPanel::duplicate),
    (Modifiers::NONE, Key::Delete, TransferPanel::take_away),
    (Modifiers::NONE, Key::Backspace, TransferPanel::take_away),
];

/// Reason for which no widget is added at the peak.
const NO_PEAK: &str = "a widget at the peak needs the histogram, of s and g or of two arrays";

impl TransferPanel {
    pub(super) fn add_at_peak(&mut self, look: &EditedFunction) {
        match at_peak(look) {
            Some(entry) => self.add(look, entry),
            None => look.actions.say(NO_PEAK),
        }
    }

    /// A widget more, which is then in hand.
    pub(super) fn add(&mut self, look: &EditedFunction, entry: ParameterValue) {
        let (node, place) = (look.node.name.clone(), look.widgets.len());
        look.actions.edit(Edit::Insert { node, list: "widgets".into(), place, entry });
        (self.chosen, self.held, self.is_last) = (place, None, true);
    }

    pub(super) fn duplicate(&mut self, look: &EditedFunction) {
        let (node, place) = (look.node.name.clone(), self.chosen);
        if look.widgets.is_empty() {
            return;
        }
        look.actions.edit(Edit::Duplicate { node, list: "widgets".into(), place });
        self.hidden = self.hidden.iter().map(|known| known + usize::from(*known > place)).collect();
        (self.chosen, self.held) = (place + 1, None);
    }

    pub(super) fn remove(&mut self, look: &EditedFunction) {
        let place = self.chosen;
        look.actions
            .edit(Edit::Unset { node: look.node.name.clone(), path: Path::from("widgets").with(place) });
        let kept = self.hidden.iter().filter(|known| **known != place);
        self.hidden = kept.map(|known| known - usize::from(*known > place)).collect();
        self.held = None;
    }

    pub(super) fn hide(&mut self, place: usize) {
        if !self.hidden.remove(&place) {
            self.hidden.insert(place);
        }
    }

    pub(super) fn is_solo(&self, place: usize, count: usize) -> bool {
        count > 1 && self.hidden.len() == count - 1 && !self.hidden.contains(&place)
    }

    pub(super) fn solo(&mut self, place: usize, count: usize) {
        self.hidden = if self.is_solo(place, count) {
            BTreeSet::new()
        } else {
            (0..count).filter(|i| *i != place).collect()
        };
    }

    /// Takes a widget in hand, on axes where it can be seen; after the last one follows the first.
    pub(super) fn choose(&mut self, place: usize, look: &EditedFunction) {
        let place = place % look.widgets.len().max(1);
        (self.chosen, self.held) = (place, None);
        let Some(widget) = look.widgets.get(place) else { return };
        if widget.shape.is_none()
            && let Some(axes) = widget.natural_axes()
        {
            self.set_axes(axes);
        }
    }

    /// Another plane, all of it shown.
    pub(crate) fn set_axes(&mut self, axes: [ArrayRef; 2]) {
        if self.axes() != axes {
            (self.axes, self.shown, self.drag, self.plane) = (Some(axes), None, None, None);
        }
    }

    pub(super) fn reorder(&mut self, look: &EditedFunction, to: usize) {
        let from = self.chosen;
        if from == to || to >= look.widgets.len() {
            return;
        }
        let (node, list) = (look.node.name.clone(), Path::from("widgets"));
        look.actions.edit(Edit::MoveEntry { node, list, from, to });
        let moved = |place: usize| match place {
            place if place == from => to,
            place if from < place && place <= to => place - 1,
            place if to <= place && place < from => place + 1,
            place => place,
        };
        self.hidden = self.hidden.iter().map(|place| moved(*place)).collect();
        self.chosen = to;
    }

    pub(super) fn store(&mut self, digit: u8, look: &EditedFunction) {
        let named = |(place, widget): (usize, &LocatedValue)| {
            let (mut widget, path) = (widget.clone(), Path::from("widgets").with(place));
            if let (ParameterValue::Table(fields), Some(name)) =
                (&mut widget.datum, look.scene.name_of(&look.node.name, &path, None))
                && find_setting(fields, ENTRY_NAME).is_none()
            {
                // Comments stay where they are.
                fields.push(Field::new(ENTRY_NAME, name));
            }
            widget
        };
        let list = look.list.iter().enumerate().map(named).collect();
        look.actions.edit(Edit::StoreSet(digit, list));
        look.actions.say(format!("{} stored as {digit}, in the file", widget_count(look.list.len())));
    }

    pub(super) fn recall(&mut self, digit: u8, look: &EditedFunction) {
        match look.sets().get(&digit) {
            Some(list) => {
                let edit = Edit::set(&look.node.name, "widgets", ParameterValue::List(list.clone()));
                look.actions.edits(format!("recall the widgets {digit}"), vec![edit]);
                self.hidden.clear();
            }
            None => look.actions.say(format!("no widgets are stored as {digit}: Ctrl+{digit} stores these")),
        }
    }

    /// Handles keys while the pointer is over the panel, or a widget was selected last, which alone is deleted.
    pub(super) fn keys(&mut self, ui: &Ui, look: &EditedFunction) {
        match self.asked.take() {
            Some(Command::Duplicate) => self.duplicate(look),
            Some(_) => self.take_away(look),
            None => {}
        }
        let is_typing = ui.ctx().text_edit_focused() || look.scene.was_typing;
        let is_choosing = Popup::is_any_open(ui.ctx());
        if is_typing || is_choosing || look.scene.asks || !self.takes_keys() {
            return;
        }
        self.set_keys(ui, look);
        let is_last = self.is_last();
        let is_ours = |key: Key| match key {
            Key::P => true,
            Key::Delete | Key::Backspace => is_last,
            _ => !look.widgets.is_empty(),
        };
        for (modifiers, key, command) in KEYS.into_iter().filter(|(_, key, _)| is_ours(*key)) {
            if ui.input_mut(|input| input.consume_key(modifiers, key)) {
                command(self, look);
                self.is_last = true;
            }
        }
        if self.has_arrows {
            self.nudge(ui, look);
        }
    }

    fn take_away(&mut self, look: &EditedFunction) {
        let Some(widget) = look.widgets.get(self.chosen) else {
            look.actions.say("there is no widget to take away; to delete a node, select it first");
            return;
        };
        match self.held.take().and_then(|handle| widget.without_point(handle)) {
            Some(changes) => edit(look, self.chosen, widget, changes),
            None => self.remove(look),
        }
    }

    fn nudge(&mut self, ui: &Ui, look: &EditedFunction) {
        let plane = look.plane;
        let (modifiers, by) = ui.input(|input| {
            let pressed = |key| f64::from(u8::from(input.key_pressed(key)));
            let by = [
                pressed(Key::ArrowRight) - pressed(Key::ArrowLeft),
                pressed(Key::ArrowUp) - pressed(Key::ArrowDown),
            ];
            (input.modifiers, by)
        });
        if by == [0.0; 2] {
            return;
        }
        let times = match (modifiers.shift, modifiers.alt) {
            (true, _) => 5.0,
            (false, true) => FINE,
            (false, false) => 1.0,
        };
        let step = [0, 1].map(|k: usize| by[k] * times * NUDGE * (plane.shown[k][1] - plane.shown[k][0]));
        let Some(widget) = look.widgets.get(self.chosen) else { return };
        let point = self.held.filter(|handle| widget.without_point(*handle).is_some());
        let held =
            point.and_then(|point| widget.handles(&plane).into_iter().find(|(known, _)| *known == point));
        let changes = match held {
            Some((handle, at)) => widget.moved(handle, plane.moved_place(at, step), &plane),
            None => widget.shifted(step, &plane),
        };
        edit(look, self.chosen, widget, changes);
    }

    fn set_keys(&mut self, ui: &Ui, look: &EditedFunction) {
        for digit in 1..10u8 {
            let Some(key) = Key::from_name(&digit.to_string()) else { continue };
            let (store, recall) = ui.input_mut(|input| {
                (input.consume_key(Modifiers::COMMAND, key), input.consume_key(Modifiers::NONE, key))
            });
            if store {
                self.store(digit, look);
            } else if recall {
                self.recall(digit, look);
            }
        }
    }
}

/// Width of the pane below which what is about a widget is shortened to stand in one line, points.
const NARROW_WIDTH: f32 = 500.0;

fn is_narrow(ui: &Ui) -> bool {
    ui.max_rect().width() < NARROW_WIDTH
}

impl TransferPanel {
    pub(super) fn head(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let dark = ui.visuals().dark_mode;
        ui.horizontal_wrapped(|ui| {
            ui.strong(look.node.name.as_str());
            let peak = Button::new("+ at peak").small();
            let fits =
                look.is_of_s_and_g() || look.axes.iter().all(|axis| matches!(axis, ArrayRef::Array(_)));
            let peak = ui
                .add_enabled(fits && look.histogram().is_some(), peak)
                .help("a Gaussian where most of the volume is that no widget holds (P)")
                .why_disabled(NO_PEAK);
            if look.widgets.is_empty() && std::mem::take(&mut self.begins) {
                peak.request_focus();
            }
            if peak.clicked() {
                self.add_at_peak(look);
            }
            self.proposal_buttons(ui, look);
            // After the buttons, which stay where they are when a widget comes.
            for (place, widget) in look.widgets.iter().enumerate() {
                self.chip(ui, place, widget, look);
            }
            if self.shown.is_some() && ui.small_button("all").help("all of the data into view").clicked() {
                self.shown = None;
            }
            self.set_menu(ui, look);
            self.axes_menu(ui, look);
            scalar_menu(ui, look);
            if !self.hidden.is_empty() {
                let text = format!("{} hidden in this window", self.hidden.len());
                ui.label(RichText::new(text).small().color(theme::accent(dark)));
            }
        });
        ui.horizontal_wrapped(|ui| {
            let Some(widget) = look.widgets.get(self.chosen) else { return };
            self.of_widget(ui, look, widget);
        });
        self.figures(ui, look);
    }

    fn of_widget(&mut self, ui: &mut Ui, look: &EditedFunction, widget: &ScreenWidget) {
        let (place, count) = (self.chosen, look.widgets.len());
        ui.label(format!("{} {}", place + 1, widget.kind));
        self.name_field(ui, look, widget);
        self.color_and_strength(ui, look, widget);
        if button(ui, "×2", "duplicate the widget", "duplicate the widget (Ctrl+D)").clicked() {
            self.duplicate(look);
        }
        if button(ui, "✖", "take the widget away", "take the widget away (Delete)").clicked() {
            self.remove(look);
        }
        // Where they have no room, the widget's menu and keys do the same.
        let orders = [
            ("◀", place.saturating_sub(1), "earlier in the list (Shift+PageUp)"),
            ("▶", (place + 1).min(count - 1), "later in the list (Shift+PageDown)"),
        ];
        let has_room = !is_narrow(ui);
        for (text, to, help) in orders.into_iter().filter(|_| has_room) {
            let button = Button::new(text).small();
            if ui.add_enabled(to != place, button).help(help).clicked() {
                self.reorder(look, to);
            }
        }
        let help = "leave it out of this window's picture; the file keeps it (V)";
        if theme::switch(ui, self.hidden.contains(&place), "hide", help).clicked() {
            self.hide(place);
        }
        let help = "this widget alone in this window's picture (S)";
        if theme::switch(ui, self.is_solo(place, count), "solo", help).clicked() {
            self.solo(place, count);
        }
    }

    /// The widget's name, which the file keeps; a comment before the widget stands in for one.
    fn name_field(&mut self, ui: &mut Ui, look: &EditedFunction, widget: &ScreenWidget) {
        let stated = find_setting(&widget.stated, "name").and_then(LocatedValue::text).unwrap_or_default();
        let key = (look.node.name.clone(), self.chosen);
        let typed = self.typed_name.take().filter(|(known, _)| *known == key);
        let mut text = typed.map_or_else(|| stated.to_string(), |(_, text)| text);
        let field = TextEdit::singleline(&mut text)
            .id_salt(("name", &key))
            .hint_text(widget.name.as_deref().unwrap_or("name"))
            .desired_width(if is_narrow(ui) { 40.0 } else { 90.0 });
        let response = ui.add(field);
        response.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, "name of the widget"));
        if response.has_focus() {
            self.typed_name = Some((key, text));
        } else if response.lost_focus()
            && text.trim() != stated
            && !ui.input(|input| input.key_pressed(Key::Escape))
        {
            let (node, path) = (look.node.name.clone(), Path::from("widgets").with(self.chosen).with("name"));
            look.actions.edit(match text.trim() {
                "" => Edit::Unset { node, path },
                text => Edit::Set { node, path, value: text.into() },
            });
        }
        response.help("name of the widget, such as \"bone\"; the file keeps it");
    }

    /// Share of the data in the selected widget, and its contribution to the picture.
    fn figures(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let Some(widget) = look.widgets.get(self.chosen) else { return };
        let color = theme::weak(ui.visuals().dark_mode);
        let weak = |text: String| RichText::new(text).small().color(color);
        let percent = |share: f64| short((1e4 * share).round() / 100.0);
        let mut texts: Vec<(String, String)> = Vec::new();
        match (&widget.fault, &widget.shape, widget.natural_axes()) {
            (Some(fault), ..) => texts.push((fault.clone(), "what is wrong, or not known yet".into())),
            (None, None, Some(axes)) => {
                let [x, y] = axes.map(|axis| axis_name(&axis));
                let text = format!("lies on the axes {x} and {y}");
                texts.push((text, "choose the axes above, or click on the widget's colour".into()));
            }
            (None, ..) => {}
        }
        if let Some(level) = widget.shape.as_ref().and_then(|shape| shape.level()) {
            let text = format!("drawn where the magnitude is {}", short(level));
            texts.push((
                text,
                "its widths are shares of the magnitude of all gradients; half of the largest is shown"
                    .into(),
            ));
        }
        let (distribution, axes) = (look.scene.distribution.as_ref(), (look.axes.clone(), look.scales));
        if let Some(held) = distribution.and_then(|data| self.held_volume.share(widget, data, &axes)) {
            let text = format!("holds {} % of the volume", percent(held));
            texts.push((text, "where the widget is at half of its peak or more".into()));
        }
        let share = look.scene.share.as_ref().filter(|_| !self.hidden.contains(&self.chosen));
        match share {
            None => {}
            Some(Err(error)) => texts.push((why_ended(look.scene, error), "its share of the picture".into())),
            Some(Ok(share)) => {
                let cells = share.cells.map(|cells| {
                    let [own, all] = cells.map(with_commas);
                    format!("in {own} of {all} tetrahedra, ")
                });
                let text = format!(
                    "{}{} % of the picture's opacity, {} % of its light",
                    cells.unwrap_or_default(),
                    percent(share.opacity),
                    percent(share.light)
                );
                let help = format!(
                    "what a picture of {} pixels loses without the widget; what it hides comes to light instead",
                    with_commas(share.pixels)
                );
                texts.push((text, help));
            }
        }
        ui.horizontal_wrapped(|ui| {
            if texts.is_empty() {
                // The plane below stays where it is while nothing is known.
                ui.label(weak(" ".into()));
            }
            for (i, (text, help)) in texts.into_iter().enumerate() {
                let text = if i > 0 { format!("· {text}") } else { text };
                ui.label(weak(text)).help(help);
            }
            if let Some(Err(error)) = share {
                buttons(ui, look.scene, &ways_out_of_data(look.scene, error));
            }
        });
    }

    /// A widget by its colour; the one in hand has a frame.
    fn chip(&mut self, ui: &mut Ui, place: usize, widget: &ScreenWidget, look: &EditedFunction) {
        let dark = ui.visuals().dark_mode;
        let (rect, response) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::click());
        let color = theme::on_screen(widget.color);
        let color = if self.hidden.contains(&place) { color.gamma_multiply(0.3) } else { color };
        ui.painter().rect_filled(rect.shrink(2.0), 2.0, color);
        if place == self.chosen {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.5, theme::accent(dark)), StrokeKind::Middle);
        }
        let kind = format!("widget {} {}", place + 1, widget.kind);
        let name = widget.name.as_ref().map_or(kind.clone(), |name| format!("{kind}: {name}"));
        let is_chosen = place == self.chosen;
        if is_chosen && std::mem::take(&mut self.begins) {
            response.request_focus();
        }
        response.widget_info(|| WidgetInfo::selected(WidgetType::SelectableLabel, true, is_chosen, &name));
        if response.help(name).clicked() {
            self.choose(place, look);
            self.is_last = true;
        }
    }

    /// Menu of the plane: of the widget in hand, and of all.
    pub(super) fn menu(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let (place, count) = (self.chosen, look.widgets.len());
        let mut entries: Vec<(String, WidgetCommand)> = Vec::new();
        if let Some(widget) = look.widgets.get(place) {
            let hide = if self.hidden.contains(&place) { "Show" } else { "Hide" };
            ui.label(format!("{} {}", place + 1, widget.title()));
            entries.extend([
                ("Duplicate".into(), Self::duplicate as WidgetCommand),
                (hide.into(), |panel, _| panel.hide(panel.chosen)),
                ("Alone, or with the others".into(), |panel, look| {
                    panel.solo(panel.chosen, look.widgets.len())
                }),
                ("Take away".into(), Self::remove),
            ]);
        }
        if count > 1 {
            entries.push(("Earlier in the list".into(), |panel, look| {
                panel.reorder(look, panel.chosen.saturating_sub(1));
            }));
            entries.push(("Later in the list".into(), |panel, look| panel.reorder(look, panel.chosen + 1)));
            entries.push(("Next widget".into(), |panel, look| panel.choose(panel.chosen + 1, look)));
        }
        entries.push(("Add at the peak".into(), Self::add_at_peak));
        entries.push(("All of the data into view".into(), |panel, _| panel.shown = None));
        for (text, command) in entries {
            if ui.button(text).clicked() {
                command(self, look);
                ui.close();
            }
        }
    }

    fn color_and_strength(&self, ui: &mut Ui, look: &EditedFunction, widget: &ScreenWidget) {
        let fields = look.list.get(self.chosen).and_then(LocatedValue::table).unwrap_or_default();
        let is_stated = |key: &str| find_setting(fields, key).is_some();
        let path = |key: &str| Path::from("widgets").with(self.chosen).with(key);
        let set = |key: &str, value: ParameterValue| {
            look.actions.edit(Edit::Set { node: look.node.name.clone(), path: path(key), value });
        };
        if is_stated("color")
            && let Some(color) = edited_color(ui, widget.color)
        {
            set("color", color.into_iter().collect());
        }
        if is_stated("extinction") {
            let before = widget.extinction;
            // What a file states stays until a hand changes it, however wrong.
            let range = Range::at_least(before.min(0.0));
            ui.label("extinction");
            let mut remark = None;
            let step = (0.01 * before).max(1e-3);
            let (response, extinction) = drag(ui, before, &range, step, false, &mut remark);
            remark.into_iter().for_each(|remark| look.actions.say(remark));
            if by_hand(&response) && extinction != before {
                set("extinction", ParameterValue::Number(extinction));
            }
            response.help("extinction, per unit_distance");
        }
    }

    pub(super) fn set_menu(&mut self, ui: &mut Ui, look: &EditedFunction) {
        ui.menu_button("sets", |ui| {
            ui.set_min_width(210.0);
            for (&digit, list) in look.sets() {
                let text = format!("recall {digit}: {}", widget_count(list.len()));
                // Ctrl+0 is the window's; a file may have a set 0 all the same.
                let key = Some(digit).filter(|digit| *digit > 0).map_or(String::new(), |key| key.to_string());
                if ui.add(Button::new(text).shortcut_text(key)).clicked() {
                    self.recall(digit, look);
                    ui.close();
                }
            }
            let free = (1..10).find(|digit| !look.sets().contains_key(digit));
            if let Some(digit) = free {
                let store = Button::new(format!("store as {digit}")).shortcut_text(format!("Ctrl+{digit}"));
                if ui.add(store).clicked() {
                    self.store(digit, look);
                    ui.close();
                }
            }
        })
        .response
        .help("all widgets, kept in the file under a digit: Ctrl+1 … 9 stores, 1 … 9 recalls");
    }

    pub(super) fn axes_menu(&mut self, ui: &mut Ui, look: &EditedFunction) {
        let [x, y] = look.axes.each_ref().map(axis_name);
        ui.menu_button(format!("axes {x}, {y}"), |ui| {
            if ui.button("s, g").help("the scalar and its gradient magnitude").clicked() {
                self.set_axes(S_AND_G);
                ui.close();
            }
            ui.separator();
            let choices = choices(ui, look);
            ui.horizontal_top(|ui| {
                for (k, title) in ["to the right", "up"].into_iter().enumerate() {
                    ui.vertical(|ui| {
                        ui.set_width(LIST_WIDTH);
                        ui.label(title);
                        self.list_of_axis(ui, k, &choices);
                    });
                }
            });
        })
        .response
        .help("the quantities that the plane is over; widgets of several fields lie on theirs");
    }

    fn list_of_axis(&mut self, ui: &mut Ui, k: usize, choices: &[(ArrayRef, String)]) {
        let (mut axes, mut taken) = (self.axes(), None);
        list_area().id_salt(("axis", k)).show_followed(ui, |ui| {
            for (axis, label) in choices {
                if ui.selectable_label(axes[k] == *axis, label).clicked() {
                    taken = Some(axis.clone());
                }
            }
        });
        let typed = TextEdit::singleline(&mut self.typed_axis[k]).hint_text("another, by its name");
        let response = ui.add(typed.desired_width(LIST_WIDTH - 20.0));
        let enters = ui.input(|input| input.key_pressed(Key::Enter));
        if response.lost_focus() && enters && !self.typed_axis[k].is_empty() {
            taken = Some(ArrayRef::Array(std::mem::take(&mut self.typed_axis[k])));
        }
        if let Some(axis) = taken {
            axes[k] = axis;
            self.set_axes(axes);
            ui.close();
        }
    }
}

/// Choices for an axis, labelled with kind and range where the data have it.
fn choices(ui: &Ui, look: &EditedFunction) -> Vec<(ArrayRef, String)> {
    let scene = look.scene;
    let nodes = &scene.document.pipeline().nodes;
    let source = volume_of(scene, &look.node.name);
    let source = source.as_deref().map(|source| links::source(source, nodes).0);
    let of_data = source
        .map(|node| scene.arrays.given_by(ui.ctx(), scene.document, scene.registry, node))
        .unwrap_or_default();
    let named = look.list.iter().filter_map(LocatedValue::table).flat_map(screen_widget::arrays);
    let mut arrays: BTreeMap<String, String> = named.map(|name| (name.clone(), name)).collect();
    arrays.extend(of_data.choices().into_iter().map(|array| (array.name.clone(), array.label.clone())));
    let named = S_AND_G.into_iter().map(|axis| (axis.clone(), axis_name(&axis)));
    named.chain(arrays.into_iter().map(|(name, label)| (ArrayRef::Array(name), label))).collect()
}
