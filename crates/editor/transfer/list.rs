//! Commands of the list of widgets, and their keys over the plane: adding, removing, ordering, hiding, selecting, nudging, sets that
//! digits recall and, with Ctrl, store; kept in the file under `[editor]`, which runs ignore.

use super::edited_function::EditedFunction;
use super::plane::Plane;
use super::pointer::FINE;
use super::{TransferPanel, edit, new};
use crate::actions::{Action, Actions};
use eframe::egui::{Key, Modifiers, Ui};
use std::collections::BTreeSet;
use voltet_document::{Edit, Path};
use voltet_graph::{ArrayRef, ParameterValue};

/// A nudge by an arrow key, as a share of the shown axis.
const NUDGE: f64 = 0.01;

const DIGITS: [Key; 10] = [
    Key::Num0,
    Key::Num1,
    Key::Num2,
    Key::Num3,
    Key::Num4,
    Key::Num5,
    Key::Num6,
    Key::Num7,
    Key::Num8,
    Key::Num9,
];

impl TransferPanel {
    pub(super) fn add_at_peak(&mut self, look: &EditedFunction, actions: &mut Actions) {
        if let Some(entry) = new::at_peak(look) {
            self.add(look, entry, actions);
        }
    }

    /// A widget more, which is then in hand.
    pub(super) fn add(&mut self, look: &EditedFunction, entry: ParameterValue, actions: &mut Actions) {
        let (node, place) = (look.node.name.clone(), look.widgets.len());
        actions.edit(Edit::Insert { node, list: "widgets".into(), place, entry });
        (self.chosen, self.held) = (place, None);
    }

    /// A copy of the widget in hand, which is then in hand.
    pub(super) fn duplicate(&mut self, look: &EditedFunction, actions: &mut Actions) {
        let (node, place) = (look.node.name.clone(), self.chosen);
        actions.edit(Edit::Duplicate { node, list: "widgets".into(), place });
        self.hidden = self.hidden.iter().map(|known| known + usize::from(*known > place)).collect();
        (self.chosen, self.held) = (place + 1, None);
    }

    /// The widget in hand goes.
    pub(super) fn remove(&mut self, look: &EditedFunction, actions: &mut Actions) {
        let place = self.chosen;
        actions.edit(Edit::Unset { node: look.node.name.clone(), path: Path::from("widgets").with(place) });
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
        self.hidden = match self.is_solo(place, count) {
            true => BTreeSet::new(),
            false => (0..count).filter(|i| *i != place).collect(),
        };
    }

    /// Takes a widget in hand, on axes where it can be seen.
    pub(super) fn choose(&mut self, place: usize, look: &EditedFunction) {
        (self.chosen, self.held) = (place, None);
        let Some(widget) = look.widgets.get(place) else { return };
        if widget.shape.is_none()
            && let Some(axes) = widget.natural_axes()
        {
            self.set_axes(axes);
        }
    }

    /// Another plane, all of it shown.
    pub(super) fn set_axes(&mut self, axes: [ArrayRef; 2]) {
        if self.axes != axes {
            (self.axes, self.shown, self.drag) = (axes, None, None);
        }
    }

    /// The widget in hand gets another number.
    pub(super) fn reorder(&mut self, look: &EditedFunction, to: usize, actions: &mut Actions) {
        let from = self.chosen;
        if from == to || to >= look.widgets.len() {
            return;
        }
        let (node, list) = (look.node.name.clone(), Path::from("widgets"));
        actions.edit(Edit::MoveEntry { node, list, from, to });
        let moved = |place: usize| match place {
            place if place == from => to,
            place if from < place && place <= to => place - 1,
            place if to <= place && place < from => place + 1,
            place => place,
        };
        self.hidden = self.hidden.iter().map(|place| moved(*place)).collect();
        self.chosen = to;
    }

    pub(super) fn store(&mut self, digit: u8, look: &EditedFunction, actions: &mut Actions) {
        actions.edit(Edit::StoreSet(digit, look.list.to_vec()));
        actions.push(Action::Say(format!("{} stored as {digit}, in the file", count(look.list.len()))));
    }

    pub(super) fn recall(&mut self, digit: u8, look: &EditedFunction, actions: &mut Actions) {
        match look.sets().get(&digit) {
            Some(list) => {
                let edit = Edit::set(&look.node.name, "widgets", ParameterValue::List(list.clone()));
                actions.edits(format!("recall the widgets {digit}"), vec![edit]);
                self.hidden.clear();
            }
            None => actions
                .push(Action::Say(format!("no widgets are stored as {digit}: Ctrl+{digit} stores these"))),
        }
    }

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
            None => widget.shifted(step, &scale),
        };
        edit(look, self.chosen, widget, changes, actions);
    }

    fn set_keys(&mut self, ui: &Ui, look: &EditedFunction, actions: &mut Actions) {
        for (digit, key) in (0..).zip(DIGITS) {
            let (store, recall) = ui.input_mut(|input| {
                (input.consume_key(Modifiers::COMMAND, key), input.consume_key(Modifiers::NONE, key))
            });
            if store {
                self.store(digit, look, actions);
            } else if recall {
                self.recall(digit, look, actions);
            }
        }
    }
}

/// Number of widgets in words.
pub(super) fn count(count: usize) -> String {
    if count == 1 { "1 widget".into() } else { format!("{count} widgets") }
}
