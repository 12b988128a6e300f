//! Positions in the graph view, for tests of the window.

use super::GraphView;
use super::package::Port;
use eframe::egui::{Pos2, Rect};

impl GraphView {
    pub fn port_at(&self, node: &str, name: &str, is_input: bool) -> Option<Pos2> {
        let is_it =
            |port: &Port| port.node == node && port.declared.name == name && port.is_input == is_input;
        self.places.seen.iter().find(|(port, _)| is_it(port)).map(|(_, at)| *at)
    }

    pub fn shows_port_at(&self, at: Pos2) -> bool {
        self.places.port_at(at, 1.0).is_some()
    }

    pub fn frame_of(&self, node: &str) -> Option<Rect> {
        self.places.drawn.iter().find(|(name, _)| name == node).map(|(_, frame)| *frame)
    }
}
