//! What a hand does in the plane: looking elsewhere, taking hold of widgets, nudging them.

use super::form::{Drawn, Region};
use super::plane::{self, Plane};
use super::{Drag, Look, TransferPanel, edit};
use crate::actions::Actions;
use eframe::egui::{self, Key, PointerButton, Pos2, Rect, Ui};

/// How near to a handle a pointer means it, points.
const NEAR: f32 = 9.0;

/// A nudge by an arrow key, as a share of the shown axis.
const NUDGE: f64 = 0.01;

/// Factor of a zoom by one notch of the wheel (50 points).
const NOTCH: f64 = 1.2;

impl TransferPanel {
    /// Wheel and Shift-drag: which part of the plane is shown.
    pub(super) fn move_plane(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        plane: Plane,
        of_data: Option<[[f64; 2]; 2]>,
    ) {
        if let Some(at) = response.hover_pos() {
            let (scroll, alt) = ui.input(|input| {
                let scroll = input.smooth_scroll_delta;
                // Some systems turn the wheel sideways where Alt is held.
                (if scroll.y == 0.0 { scroll.x } else { scroll.y }, input.modifiers.alt)
            });
            if scroll != 0.0 {
                let axis = usize::from(alt);
                let mut shown = plane.shown;
                let factor = NOTCH.powf(f64::from(scroll) / 50.0);
                shown[axis] = plane::zoomed(shown[axis], factor, plane.to_values(at)[axis]);
                self.shown = Some(shown);
            }
        }
        let pans = ui.input(|input| input.modifiers.shift) || response.dragged_by(PointerButton::Middle);
        let delta = response.drag_delta();
        if pans && self.drag.is_none() && delta != egui::Vec2::ZERO {
            let [per_s, per_g] = plane.per_point();
            let by = [-f64::from(delta.x) * per_s, f64::from(delta.y) * per_g];
            let [s, g] = plane.shown;
            self.shown = Some([s.map(|x| x + by[0]), g.map(|x| x + by[1])]);
        }
        if response.double_clicked() && self.drag.is_none() && of_data.is_some() {
            self.shown = None;
        }
    }

    /// Choosing and dragging widgets.
    pub(super) fn hand(
        &mut self,
        ui: &Ui,
        response: &egui::Response,
        plane: Plane,
        look: &Look,
        actions: &mut Actions,
    ) {
        let shift = ui.input(|input| input.modifiers.shift);
        let press = ui.input(|input| input.pointer.press_origin());
        let top = plane.shown[1][1];
        let begins = response.drag_started_by(PointerButton::Primary) && !shift;
        if let Some(at) = press.filter(|_| begins) {
            self.take(at, plane, look, top);
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            self.take(at, plane, look, top);
            self.drag = None;
        }
        let Some(drag) = &self.drag else { return };
        if response.drag_stopped() || !ui.input(|input| input.pointer.primary_down()) {
            self.drag = None;
            return;
        }
        let Some(at) = ui.input(|input| input.pointer.interact_pos()) else { return };
        if response.drag_delta() == egui::Vec2::ZERO {
            return;
        }
        let to = plane.to_values(at);
        let bounds = [top, look.peak];
        let changes = match drag.handle {
            Some(handle) => drag.widget.moved(handle, to, look.extent, bounds),
            None => drag.widget.shifted([to[0] - drag.from[0], to[1] - drag.from[1]], look.extent, bounds),
        };
        edit(look, self.chosen, changes, actions);
    }

    /// What lies under a press: a handle of the widget in hand, another widget, or nothing.
    fn take(&mut self, at: Pos2, plane: Plane, look: &Look, top: f64) {
        let value = plane.to_values(at);
        let nearest = |widget: &Drawn| {
            let handles = widget.handles(top, look.peak).into_iter();
            let by_distance = handles.map(|(handle, place)| (plane.to_window(place).distance(at), handle));
            by_distance
                .filter(|(distance, _)| *distance <= NEAR)
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map(|(_, handle)| handle)
        };
        let hold = |widget: &Drawn, handle| Some(Drag { widget: widget.clone(), handle, from: value });
        if let Some(widget) = look.widgets.get(self.chosen)
            && let Some(handle) = nearest(widget)
        {
            self.drag = hold(widget, Some(handle));
            return;
        }
        // Handles of others come before what others cover; of what covers the place, the strongest.
        let by_handle =
            look.widgets.iter().enumerate().find_map(|(place, widget)| Some((place, nearest(widget)?)));
        if let Some((place, handle)) = by_handle {
            self.chosen = place;
            self.drag = hold(&look.widgets[place], Some(handle));
            return;
        }
        let strengths =
            look.widgets.iter().enumerate().map(|(place, widget)| (place, widget.strength(value)));
        // What is everywhere is taken by its handles alone.
        let local = strengths.filter(|(place, strength)| {
            *strength > 0.13
                && !(matches!(look.widgets[*place].region, Region::Whole)
                    && is_everywhere(&look.widgets[*place], look))
        });
        if let Some((place, _)) = local.max_by(|a, b| a.1.total_cmp(&b.1)) {
            self.chosen = place;
            self.drag = hold(&look.widgets[place], None);
        }
    }

    /// Arrows nudge, digits recall and with Ctrl store a set.
    pub(super) fn keys(&mut self, ui: &Ui, whole: Rect, plane: Plane, look: &Look, actions: &mut Actions) {
        if ui.ctx().wants_keyboard_input() || !ui.rect_contains_pointer(whole) {
            return;
        }
        self.sets.keys(ui, look, actions);
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
        let times = if modifiers.shift {
            5.0
        } else if modifiers.alt {
            0.2
        } else {
            1.0
        };
        let step = [0, 1].map(|k| by[k] * times * NUDGE * (plane.shown[k][1] - plane.shown[k][0]));
        if let Some(widget) = look.widgets.get(self.chosen) {
            edit(
                look,
                self.chosen,
                widget.shifted(step, look.extent, [plane.shown[1][1], look.peak]),
                actions,
            );
        }
    }
}

/// Whether it is as strong at all four corners of the data.
fn is_everywhere(widget: &Drawn, look: &Look) -> bool {
    let Some(histogram) = &look.histogram else { return false };
    let [s, g] = histogram.axes;
    let corners = [[s.low, g.low], [s.high, g.low], [s.low, g.high], [s.high, g.high]];
    corners.iter().all(|at| widget.strength(*at) > 0.13)
}
