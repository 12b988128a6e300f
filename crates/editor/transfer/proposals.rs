//! Widgets that are proposed for the values of a probe, each with a button: a Gaussian of their mean and covariance, and the range that holds
//! most of them. While the pointer is at its button, one is shown in the picture.

use super::TransferPanel;
use super::edited_function::{EditedFunction, at_probe, range_at_probe};
use super::screen_widget;
use crate::theme::Help;
use eframe::egui::Ui;
use voltet_graph::ParameterValue;

impl TransferPanel {
    /// The widget that the pointer is about to add, and its transfer function: the picture is drawn with it.
    pub fn proposed(&self) -> Option<(&str, &ParameterValue)> {
        self.of.as_deref().zip(self.proposed.as_ref())
    }

    /// Buttons that add what is proposed.
    pub(super) fn proposal_buttons(&mut self, ui: &mut Ui, look: &EditedFunction) {
        self.proposed = None;
        let was_added = self.was_added.take();
        let Some(probed) = &look.scene.probed else { return };
        for (title, help, entry) in [
            (
                "+ at probe",
                "a Gaussian on the values of the probe: their mean and covariance",
                at_probe(look, probed),
            ),
            (
                "+ range",
                "the ranges of s and g that hold nine tenths of the values",
                range_at_probe(look, probed),
            ),
        ] {
            let Some(entry) = entry else { continue };
            let button = ui.small_button(title);
            let is_at = button.hovered() || button.has_focus();
            if button.clicked() {
                self.add(look, entry);
                (self.proposed, self.was_added) = (None, Some(title));
                return;
            }
            // What was added is in the picture already, until the pointer comes anew.
            match is_at {
                true if was_added == Some(title) => self.was_added = was_added,
                true => self.proposed = Some(entry),
                false => {}
            }
            button.help(help);
        }
    }

    /// Shows the proposal in the plane: the one at the pointer, else the Gaussian.
    pub(super) fn draw_proposal(&self, ui: &Ui, look: &EditedFunction) {
        let Some(probed) = look.scene.probed.as_ref().filter(|_| look.is_of_s_and_g()) else { return };
        let entry = self.proposed.clone().or_else(|| at_probe(look, probed));
        if let Some(ParameterValue::Table(fields)) = entry {
            screen_widget::draw(ui, look.plane, &look.on_plane(&fields), None, false);
        }
    }
}
