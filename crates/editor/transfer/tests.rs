//! Positions in the plane, for tests of the window.

use super::TransferPanel;
use super::edited_function::{EditedFunction, at_probe, edited_node};
use crate::scene::Scene;
use eframe::egui::Pos2;
use voltet_graph::{ArrayRef, ParameterValue};

impl TransferPanel {
    pub fn place_of(&self, value: [f64; 2]) -> Option<Pos2> {
        self.plane.map(|plane| plane.to_window(value))
    }

    pub fn shown_axes(&self) -> [[f64; 2]; 2] {
        self.plane.map_or([[0.0; 2]; 2], |plane| plane.shown)
    }

    pub fn value_at(&self, place: Pos2) -> Option<[f64; 2]> {
        self.plane.map(|plane| plane.to_values(place))
    }

    pub fn choose_for_tests(&mut self, axes: [ArrayRef; 2]) {
        self.set_axes(axes);
    }

    pub fn at_probe_for_tests(&self, scene: &Scene) -> Option<ParameterValue> {
        let look =
            EditedFunction::new(scene, edited_node(scene)?, self.axes(), self.plane, None, &self.images);
        at_probe(&look, scene.probed.as_ref()?)
    }
}
