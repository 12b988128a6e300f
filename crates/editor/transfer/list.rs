//! Commands of the list of widgets: adding, removing, ordering, hiding, selecting.

use super::edited_function::EditedFunction;
use super::{TransferPanel, new};
use crate::actions::Actions;
use std::collections::BTreeSet;
use voltet_document::{Edit, Path};
use voltet_graph::{ArrayRef, ParameterValue};

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
}
