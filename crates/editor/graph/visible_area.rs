//! Visible part of the document: pan, zoom, all into view; and the scale below which letters are left out.

use super::GraphView;
use crate::scene::Scene;
use eframe::egui::{Pos2, Rect, TextStyle, Ui, Vec2, pos2, vec2};
use std::collections::BTreeSet;

/// Least and largest scale: the package draws no smaller, and beyond the other nothing else is seen.
const ZOOM: [f32; 2] = [0.2, 2.0];

/// Height of letters, points, below which they are left out.
const FAR_LETTERS: f32 = 6.0;

impl GraphView {
    /// From the document's places to the window's.
    pub(super) fn to_window(&self, rect: Rect) -> impl Fn([f64; 2]) -> Pos2 + use<> {
        let (pan, zoom, origin) = (self.pan, self.zoom, rect.min);
        move |[x, y]| origin + pan + zoom * vec2(x as f32, y as f32)
    }

    /// From the window's places to the document's.
    pub(super) fn to_document(&self, rect: Rect, at: Pos2) -> [f64; 2] {
        let from = (at - rect.min - self.pan) / self.zoom;
        [f64::from(from.x), f64::from(from.y)]
    }

    /// Wheel, middle drag, and bringing all into view.
    pub(super) fn move_view(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene) {
        if self.fits > 0 {
            self.fits -= 1;
            self.bring_into_view(rect, scene);
            ui.ctx().request_repaint();
        }
        let over = ui.rect_contains_pointer(rect) && self.menu.is_none();
        let (scroll, zoom_delta, at, delta, pans) = ui.input(|input| {
            let pans =
                input.pointer.middle_down() || (input.pointer.primary_down() && input.modifiers.command);
            (
                input.smooth_scroll_delta,
                input.zoom_delta(),
                input.pointer.hover_pos(),
                input.pointer.delta(),
                pans,
            )
        });
        if let Some(at) = at.filter(|_| over) {
            let factor = (scroll.y * 0.0025).exp() * zoom_delta;
            let zoom = (self.zoom * factor).clamp(ZOOM[0], ZOOM[1]);
            let from = at - rect.min;
            self.pan = from - (from - self.pan) * (zoom / self.zoom);
            self.zoom = zoom;
            if pans {
                self.pan += delta;
            }
            // The package would zoom about the view's middle by moving the nodes.
            ui.input_mut(|input| input.smooth_scroll_delta = Vec2::ZERO);
        }
    }

    /// True if the letters of nodes are too small to read; then nodes show their names alone, in letters of one size.
    pub(super) fn is_far(&self, ui: &Ui) -> bool {
        let body = TextStyle::Body.resolve(ui.style()).size;
        // On screens of a high density smaller letters can be read, down to a limit.
        let sharp = ui.ctx().pixels_per_point().clamp(1.0, 1.5);
        body * self.zoom * sharp < FAR_LETTERS
    }

    fn bring_into_view(&mut self, rect: Rect, scene: &Scene) {
        let nodes = &scene.document.pipeline().nodes;
        let mut all = Rect::NOTHING;
        for node in nodes {
            all = all.union(self.places.frame(scene, node));
        }
        let corner = |at: [f64; 2]| pos2(at[0] as f32, at[1] as f32);
        let view = scene.document.view();
        for frame in &view.frames {
            let size = vec2(frame.size[0] as f32, frame.size[1] as f32);
            all = all.union(Rect::from_min_size(corner(frame.position), size));
        }
        for note in &view.notes {
            all.extend_with(corner(note.position));
        }
        if !all.is_finite() || all.is_negative() {
            (self.pan, self.zoom) = (vec2(20.0, 20.0), 1.0);
            return;
        }
        let room = rect.size() - vec2(40.0, 40.0);
        self.zoom = (room.x / all.width()).min(room.y / all.height()).clamp(ZOOM[0], 1.0);
        self.pan = rect.size() / 2.0 - self.zoom * all.center().to_vec2();
    }

    /// The names of the nodes in view, and of those that a hand holds.
    pub(super) fn visible(&self, scene: &Scene, rect: Rect) -> BTreeSet<String> {
        let to_window = self.to_window(rect);
        let held = self.wire.as_ref().map(|wire| wire.node.as_str());
        let seen = |node: &&voltet_graph::NodeEntry| {
            let frame = self.places.frame(scene, node);
            let [low, high] = [frame.min, frame.max].map(|at| to_window([f64::from(at.x), f64::from(at.y)]));
            rect.intersects(Rect::from_min_max(low, high).expand(20.0)) || held == Some(&node.name)
        };
        scene.document.pipeline().nodes.iter().filter(seen).map(|node| node.name.clone()).collect()
    }
}
