//! What stands above the plane: the widgets, and what can be done to the one in hand.

use super::form::Drawn;
use super::{Look, TransferPanel, draw};
use crate::actions::Actions;
use crate::theme;
use crate::worker::short;
use eframe::egui::{Color32, DragValue, Rgba, RichText, Sense, Stroke, Ui, vec2};
use voltet_core::graph::{Datum, Field, Setting};
use voltet_core::probing::Histogram;
use voltet_document::{Edit, Path};

/// Deviations of a new Gaussian, as shares of the axes.
const NEW: [f64; 2] = [0.02, 0.05];

/// Least deviations of one on probed values, as a share of the axes.
const LEAST: f64 = 0.01;

/// Extinction of a new widget, per unit distance, where no other shows what is usual.
const EXTINCTION: f64 = 10.0;

impl TransferPanel {
    pub(super) fn head(&mut self, ui: &mut Ui, look: &Look, actions: &mut Actions) {
        let dark = ui.visuals().dark_mode;
        let name = &look.node.name;
        let list = || Path::from("widgets");
        ui.horizontal_wrapped(|ui| {
            ui.strong(name.as_str());
            for (place, widget) in look.widgets.iter().enumerate() {
                self.chip(ui, place, widget);
            }
            ui.separator();
            let peak = ui
                .small_button("+ at peak")
                .on_hover_text("a Gaussian where most of the volume is that no widget holds");
            if peak.clicked() {
                let entry = at_peak(look);
                actions.edit(Edit::Insert {
                    node: name.clone(),
                    list: list(),
                    place: look.widgets.len(),
                    entry,
                });
                self.chosen = look.widgets.len();
            }
            if let Some(moments) = look.probed.as_ref().and_then(|probed| probed.moments()) {
                let found = ui
                    .small_button("+ at probe")
                    .on_hover_text("a Gaussian on the values of the probe: their mean and deviations");
                if found.clicked() {
                    let entry = at_probe(look, moments);
                    actions.edit(Edit::Insert {
                        node: name.clone(),
                        list: list(),
                        place: look.widgets.len(),
                        entry,
                    });
                    self.chosen = look.widgets.len();
                }
            }
            if !self.hidden.is_empty() {
                let text = format!("{} hidden in this window", self.hidden.len());
                ui.label(RichText::new(text).small().color(theme::accent(dark)));
            }
        });
        ui.horizontal(|ui| {
            let Some(widget) = look.widgets.get(self.chosen) else { return };
            let place = self.chosen;
            ui.label(format!("{} {}", place + 1, widget.kind));
            self.color_and_strength(ui, look, widget, actions);
            if ui.small_button("×2").on_hover_text("duplicate the widget").clicked() {
                actions.edit(Edit::Duplicate { node: name.clone(), list: list(), place });
                self.chosen = place + 1;
            }
            if ui.small_button("✖").on_hover_text("take the widget away").clicked() {
                actions.edit(Edit::Unset { node: name.clone(), path: list().with(place) });
            }
            let is_hidden = self.hidden.contains(&place);
            let hide = ui
                .selectable_label(is_hidden, "hide")
                .on_hover_text("leave it out of this window's picture; the file keeps it");
            if hide.clicked() && !self.hidden.remove(&place) {
                self.hidden.insert(place);
            }
            let others: std::collections::BTreeSet<usize> =
                (0..look.widgets.len()).filter(|i| *i != place).collect();
            let is_solo = !others.is_empty() && self.hidden == others;
            if ui
                .selectable_label(is_solo, "solo")
                .on_hover_text("this widget alone in this window's picture")
                .clicked()
            {
                self.hidden = if is_solo { Default::default() } else { others };
            }
            if let Some(held) = look.histogram.as_ref().and_then(|histogram| held(histogram, widget)) {
                ui.label(
                    RichText::new(format!("holds {} % of the volume", short((1e4 * held).round() / 100.0)))
                        .small()
                        .color(theme::weak(dark)),
                )
                .on_hover_text("where the widget is at half of its peak or more");
            }
        });
    }

    /// A widget by its colour; the one in hand has a frame.
    fn chip(&mut self, ui: &mut Ui, place: usize, widget: &Drawn) {
        let dark = ui.visuals().dark_mode;
        let (rect, response) = ui.allocate_exact_size(vec2(18.0, 14.0), Sense::click());
        let color = draw::color(widget.color);
        let color = if self.hidden.contains(&place) { color.gamma_multiply(0.3) } else { color };
        ui.painter().rect_filled(rect.shrink(2.0), 2.0, color);
        if place == self.chosen {
            ui.painter().rect_stroke(rect, 3.0, Stroke::new(1.5, theme::accent(dark)));
        }
        if response.on_hover_text(format!("{} {}", place + 1, widget.kind)).clicked() {
            self.chosen = place;
        }
    }

    fn color_and_strength(&self, ui: &mut Ui, look: &Look, widget: &Drawn, actions: &mut Actions) {
        let fields = look.list.get(self.chosen).and_then(Setting::table).unwrap_or_default();
        let is_stated = |key: &str| fields.iter().any(|field| field.name == key);
        let path = |key: &str| Path::from("widgets").with(self.chosen).with(key);
        if is_stated("color") {
            let brightest = widget.color.iter().copied().fold(1.0, f64::max);
            let mut shown: Color32 = draw::color(widget.color.map(|x| x / brightest));
            if ui.color_edit_button_srgba(&mut shown).changed() {
                let linear = Rgba::from(shown);
                let channel = |x: f32| (f64::from(x) * brightest * 1e4).round() / 1e4;
                let color = [linear.r(), linear.g(), linear.b()].map(channel);
                let value = Datum::List(color.map(|x| Setting::from(Datum::Number(x))).to_vec());
                actions.edit(Edit::Set { node: look.node.name.clone(), path: path("color"), value });
            }
        }
        if is_stated("extinction") {
            let mut extinction = widget.extinction;
            let speed = (extinction * 0.01).max(1e-3);
            let field = DragValue::new(&mut extinction).range(0.0..=f64::MAX).speed(speed).max_decimals(4);
            if ui
                .add(field.update_while_editing(false))
                .on_hover_text("extinction, per unit_distance")
                .changed()
            {
                let value = Datum::Number(format!("{extinction:.5e}").parse().unwrap_or(extinction));
                actions.edit(Edit::Set { node: look.node.name.clone(), path: path("extinction"), value });
            }
        }
    }
}

/// The share of the volume where a widget is at half of its peak or more.
fn held(histogram: &Histogram, widget: &Drawn) -> Option<f64> {
    use super::form::Form;
    if matches!(widget.form, Form::Wave { .. } | Form::Points(_) | Form::Elsewhere) {
        return None;
    }
    let [s, g] = histogram.axes;
    let middle = |axis: voltet_core::probing::Axis, i: usize| 0.5 * (axis.edge(i) + axis.edge(i + 1));
    let mut sum = 0.0;
    for (j, row) in histogram.volumes.chunks(s.bins).enumerate() {
        let at_g = middle(g, j);
        for (i, volume) in row.iter().enumerate().filter(|(_, volume)| **volume > 0.0) {
            if widget.strength([middle(s, i), at_g]) >= 0.5 {
                sum += volume;
            }
        }
    }
    Some(sum / histogram.total)
}

/// A Gaussian at the bin with the most volume that no widget holds.
fn at_peak(look: &Look) -> Datum {
    let (mut centre, mut sigma) = ([0.5, 0.0], [0.1, 0.1]);
    if let Some(histogram) = &look.histogram {
        let [s, g] = histogram.axes;
        let middle = |axis: voltet_core::probing::Axis, i: usize| 0.5 * (axis.edge(i) + axis.edge(i + 1));
        let mut most = -1.0;
        for (k, volume) in histogram.volumes.iter().enumerate() {
            let at = [middle(s, k % s.bins), middle(g, k / s.bins)];
            if *volume > most && look.widgets.iter().all(|widget| widget.strength(at) < 0.1) {
                (most, centre) = (*volume, at);
            }
        }
        sigma = [NEW[0] * (s.high - s.low), NEW[1] * (g.high - g.low)];
    }
    gaussian(look, centre, sigma)
}

/// A Gaussian on values that were found, no narrower than what a hand can take hold of.
fn at_probe(look: &Look, [centre, deviation]: [[f64; 2]; 2]) -> Datum {
    gaussian(look, centre, [0, 1].map(|k| deviation[k].max(LEAST * look.extent[k])))
}

/// A new Gaussian in a colour of its own.
fn gaussian(look: &Look, centre: [f64; 2], sigma: [f64; 2]) -> Datum {
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
    let number = |x: f64| Setting::from(Datum::Number(format!("{x:.5e}").parse().unwrap_or(x)));
    let list = |numbers: &[f64]| Datum::List(numbers.iter().map(|x| number(*x)).collect());
    let field = |name: &str, datum: Datum| Field {
        name: name.into(),
        origin: Default::default(),
        setting: datum.into(),
    };
    Datum::Table(vec![
        field("kind", Datum::Text("gaussian".into())),
        field("color", list(&color)),
        field("extinction", number(extinction).datum),
        field("centre", list(&centre)),
        field("sigma", list(&sigma)),
    ])
}
