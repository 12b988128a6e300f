//! Keys over the plane: nudging, choosing, ordering, points, sets.

use super::edited_function::EditedFunction;
use super::plane::Plane;
use super::pointer::FINE;
use super::{TransferPanel, edit};
use crate::actions::Actions;
use eframe::egui::{Key, Modifiers, Ui};

/// A nudge by an arrow key, as a share of the shown axis.
const NUDGE: f64 = 0.01;

impl TransferPanel {
    /// Handles keys while the pointer is over the panel.
    pub(super) fn keys(&mut self, ui: &Ui, plane: Plane, look: &EditedFunction, actions: &mut Actions) {
        if ui.ctx().wants_keyboard_input() || !self.takes_keys() {
            return;
        }
        self.set_keys(ui, look, actions);
        let pressed =
            |modifiers: Modifiers, key: Key| ui.input_mut(|input| input.consume_key(modifiers, key));
        let count = look.widgets.len();
        if count == 0 {
            return;
        }
        if pressed(Modifiers::SHIFT, Key::PageUp) {
            self.reorder(look, self.chosen.saturating_sub(1), actions);
        }
        if pressed(Modifiers::SHIFT, Key::PageDown) {
            self.reorder(look, (self.chosen + 1).min(count - 1), actions);
        }
        if pressed(Modifiers::NONE, Key::PageUp) {
            self.choose((self.chosen + count - 1) % count, look);
        }
        if pressed(Modifiers::NONE, Key::PageDown) {
            self.choose((self.chosen + 1) % count, look);
        }
        if pressed(Modifiers::NONE, Key::V) {
            self.hide(self.chosen);
        }
        if pressed(Modifiers::NONE, Key::S) {
            self.solo(self.chosen, count);
        }
        if pressed(Modifiers::NONE, Key::P) {
            self.add_at_peak(look, actions);
        }
        if pressed(Modifiers::COMMAND, Key::D) {
            self.duplicate(look, actions);
        }
        if [Key::Delete, Key::Backspace].into_iter().any(|key| pressed(Modifiers::NONE, key)) {
            self.take_away(look, actions);
        }
        self.nudge(ui, plane, look, actions);
    }

    /// The point in hand, else the widget.
    fn take_away(&mut self, look: &EditedFunction, actions: &mut Actions) {
        let Some(widget) = look.widgets.get(self.chosen) else { return };
        match self.held.take().and_then(|handle| widget.without_point(handle)) {
            Some(changes) => edit(look, self.chosen, widget, changes, actions),
            None => self.remove(look, actions),
        }
    }

    /// Arrows move the point in hand, else the widget.
    fn nudge(&mut self, ui: &Ui, plane: Plane, look: &EditedFunction, actions: &mut Actions) {
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
        let scale = look.scale(plane.shown);
        let point = self.held.filter(|handle| widget.without_point(*handle).is_some());
        let held =
            point.and_then(|point| widget.handles(&scale).into_iter().find(|(known, _)| *known == point));
        let changes = match held {
            Some((handle, at)) => widget.moved(handle, [at[0] + step[0], at[1] + step[1]], &scale),
            None => widget.shifted(step),
        };
        edit(look, self.chosen, widget, changes, actions);
    }
}
