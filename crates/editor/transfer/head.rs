//! Lines above the plane: the widgets, and commands for the selected one.

use super::edited_function::EditedFunction;
use super::quantities::axis_name;
use super::screen_widget::ScreenWidget;
use super::{TransferPanel, new, widget_painter};
use crate::actions::Actions;
use crate::parameters::{channels_value, edited_color};
use crate::scene::Scene;
use crate::theme;
use crate::worker::{grouped, short};
use eframe::egui::{DragValue, RichText, Sense, Stroke, Ui, vec2};
use voltet_document::{Edit, Path};
use voltet_graph::{ArrayRef, LocatedValue, ParameterValue};

impl TransferPanel {
    pub(super) fn head(&mut self, ui: &mut Ui, scene: &Scene, look: &EditedFunction, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        ui.horizontal_wrapped(|ui| {
            ui.strong(look.node.name.as_str());
            for (place, widget) in look.widgets.iter().enumerate() {
                self.chip(ui, place, widget, look);
            }
            let peak = eframe::egui::Button::new("+ at peak").small();
            let fits =
                look.is_of_s_and_g() || look.axes.iter().all(|axis| matches!(axis, ArrayRef::Array(_)));
            let peak = ui
                .add_enabled(fits, peak)
                .on_hover_text("a Gaussian where most of the volume is that no widget holds (P)")
                .on_disabled_hover_text("a widget is over s and g, or over arrays");
            if peak.clicked() {
                self.add_at_peak(look, actions);
            }
            if let Some(entry) = look.probed.as_ref().and_then(|probed| new::at_probe(look, probed)) {
                let found = ui
                    .small_button("+ at probe")
                    .on_hover_text("a Gaussian on the values of the probe: their mean and covariance");
                if found.clicked() {
                    self.add(look, entry, actions);
                }
            }
            if self.shown.is_some()
                && ui.small_button("all").on_hover_text("all of the data into view").clicked()
            {
                self.shown = None;
            }
            self.set_menu(ui, look, actions);
            self.axes_menu(ui, scene, look);
            if !self.hidden.is_empty() {
                let text = format!("{} hidden in this window", self.hidden.len());
                ui.label(RichText::new(text).small().color(theme::accent(dark)));
            }
        });
        ui.horizontal_wrapped(|ui| {
            let Some(widget) = look.widgets.get(self.chosen) else { return };
            self.of_widget(ui, look, widget, actions);
        });
        self.figures(ui, look);
    }

    /// Commands for the selected widget.
    fn of_widget(
        &mut self,
        ui: &mut Ui,
        look: &EditedFunction,
        widget: &ScreenWidget,
        actions: &mut Actions,
    ) {
        let (place, count) = (self.chosen, look.widgets.len());
        ui.label(format!("{} {}", place + 1, widget.kind));
        self.color_and_strength(ui, look, widget, actions);
        if ui.small_button("×2").on_hover_text("duplicate the widget (Ctrl+D over the plane)").clicked() {
            self.duplicate(look, actions);
        }
        if ui.small_button("✖").on_hover_text("take the widget away (Delete over the plane)").clicked() {
            self.remove(look, actions);
        }
        for (text, to, help) in [
            ("◀", place.saturating_sub(1), "earlier in the list (Shift+PageUp)"),
            ("▶", (place + 1).min(count - 1), "later in the list (Shift+PageDown)"),
        ] {
            let button = eframe::egui::Button::new(text).small();
            if ui.add_enabled(to != place, button).on_hover_text(help).clicked() {
                self.reorder(look, to, actions);
            }
        }
        let hide = ui
            .selectable_label(self.hidden.contains(&place), "hide")
            .on_hover_text("leave it out of this window's picture; the file keeps it (V)");
        if hide.clicked() {
            self.hide(place);
        }
        let solo = ui
            .selectable_label(self.is_solo(place, count), "solo")
            .on_hover_text("this widget alone in this window's picture (S)");
        if solo.clicked() {
            self.solo(place, count);
        }
    }

    /// Share of the data in the selected widget, and its contribution to the picture.
    fn figures(&self, ui: &mut Ui, look: &EditedFunction) {
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
        if let Some(held) = look.histogram().and_then(|histogram| widget.held(histogram)) {
            let text = format!("holds {} % of the volume", percent(held));
            texts.push((text, "where the widget is at half of its peak or more".into()));
        }
        match &look.share {
            _ if self.hidden.contains(&self.chosen) => {}
            None => {}
            Some(Err(error)) => texts.push((error.to_string(), "its share of the picture".into())),
            Some(Ok(share)) => {
                let cells = share.cells.map(|cells| {
                    let [own, all] = cells.map(|count| grouped(count as usize));
                    format!("in {own} of {all} cells, ")
                });
                let text = format!(
                    "{}{} % of the picture's opacity, {} % of its light",
                    cells.unwrap_or_default(),
                    percent(share.opacity),
                    percent(share.light)
                );
                let help = format!(
                    "what a picture of {} pixels loses without the widget; what it hides comes to light instead",
                    grouped(share.pixels)
                );
                texts.push((text, help));
            }
        }
        ui.horizontal_wrapped(|ui| {
            for (i, (text, help)) in texts.into_iter().enumerate() {
                let text = if i > 0 { format!("· {text}") } else { text };
                ui.label(weak(text)).on_hover_text(help);
            }
        });
    }

    /// A widget by its colour; the one in hand has a frame.
    fn chip(&mut self, ui: &mut Ui, place: usize, widget: &ScreenWidget, look: &EditedFunction) {
        let dark = ui.visuals().dark_mode;
        let (rect, response) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::click());
        let color = widget_painter::color(widget.color);
        let color = if self.hidden.contains(&place) { color.gamma_multiply(0.3) } else { color };
        ui.painter().rect_filled(rect.shrink(2.0), 2.0, color);
        if place == self.chosen {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.5, theme::accent(dark)));
        }
        if response.on_hover_text(format!("{} {}", place + 1, widget.kind)).clicked() {
            self.choose(place, look);
        }
    }

    fn color_and_strength(
        &self,
        ui: &mut Ui,
        look: &EditedFunction,
        widget: &ScreenWidget,
        actions: &mut Actions,
    ) {
        let fields = look.list.get(self.chosen).and_then(LocatedValue::table).unwrap_or_default();
        let is_stated = |key: &str| fields.iter().any(|field| field.name == key);
        let path = |key: &str| Path::from("widgets").with(self.chosen).with(key);
        let mut set = |key: &str, value: ParameterValue| {
            actions.edit(Edit::Set { node: look.node.name.clone(), path: path(key), value });
        };
        if is_stated("color") {
            if let Some(color) = edited_color(ui, widget.color) {
                set("color", channels_value(color));
            }
        }
        if is_stated("extinction") {
            let mut extinction = widget.extinction;
            let speed = (extinction * 0.01).max(1e-3);
            // What a file states stays until a hand changes it, however wrong.
            let least = extinction.min(0.0);
            let field = DragValue::new(&mut extinction).range(least..=f64::MAX);
            let field = field.speed(speed).max_decimals(4);
            let response = ui.add(field.update_while_editing(false));
            if response.on_hover_text("extinction, per unit_distance").changed() {
                set("extinction", ParameterValue::Number(super::numbers::rounded(extinction)));
            }
        }
    }
}
