//! The graph without a pointer: the node beside the selected one, and the view that follows it.

use super::GraphView;
use crate::scene::{Action, Scene};
use eframe::egui::{Context, FocusDirection, Key, Modifiers, Rect, Ui, Vec2, vec2};
use std::collections::BTreeSet;
use voltet_document::links;

/// Weight of a way aside, beside one in the direction of the key.
const ASIDE: f32 = 2.0;

/// Weight of a way to a node that is wired to the selected one.
const WIRED: f32 = 0.3;

impl GraphView {
    /// The nearest node in a direction (x to the right, y down) from the selected one, those first that are wired to it; without a
    /// selection, the one that is uppermost at the left.
    pub fn beside<'a>(&self, scene: &Scene<'a>, way: [f32; 2]) -> Option<&'a str> {
        let nodes = scene.document.pipeline().nodes.iter();
        let places = nodes.map(|node| (node.name.as_str(), self.places.frame(scene, node).center()));
        let way = Vec2::from(way);
        let from = places.clone().find(|(name, _)| scene.selection.contains(*name));
        let Some((own, from)) = from else {
            let first = places.min_by(|a, b| (a.1.x + a.1.y).total_cmp(&(b.1.x + b.1.y)));
            return first.map(|(name, _)| name);
        };
        let feeds = |from: &str, to: &str| {
            let inputs = scene.entry(to).into_iter().flat_map(|entry| &entry.inputs);
            let nodes = &scene.document.pipeline().nodes;
            inputs.flat_map(links::sources).any(|source| links::source(source, nodes).0 == from)
        };
        let ahead = places.filter(|(name, _)| *name != own).filter_map(|(name, at)| {
            let along = (at - from).dot(way);
            let aside = (at - from - along * way).length();
            let is_wired = feeds(own, name) || feeds(name, own);
            // In the wedge ahead, however far; what lies beside it is ahead of another arrow.
            let is_ahead = along > 0.0 && aside <= ASIDE * along;
            is_ahead.then_some((name, (along + ASIDE * aside) * if is_wired { WIRED } else { 1.0 }))
        });
        ahead.min_by(|a, b| a.1.total_cmp(&b.1)).map(|(name, _)| name)
    }

    /// Goes by Tab from a node to the next one in the file, or the one before; at their end to what follows them in the window, and from
    /// none to the first or the last one.
    pub(super) fn follow_tab(&mut self, ui: &Ui, scene: &Scene, node: Option<&str>) {
        let mut pressed = |held: Modifiers| ui.input_mut(|input| input.consume_key(held, Key::Tab));
        let [back, on] = [Modifiers::SHIFT, Modifiers::NONE].map(&mut pressed);
        if !back && !on {
            return;
        }
        let nodes = &scene.document.pipeline().nodes;
        let at = node.and_then(|node| nodes.iter().position(|entry| entry.name == node));
        let next = match (at, back) {
            (Some(at), false) => Some(at + 1),
            (Some(at), true) => at.checked_sub(1),
            (None, false) => Some(0),
            (None, true) => nodes.len().checked_sub(1),
        };
        match next.and_then(|at| nodes.get(at)) {
            Some(next) => self.choose(scene, &next.name),
            None => {
                self.leaves = Some(if back { FocusDirection::Previous } else { FocusDirection::Next });
                ui.ctx().request_repaint();
            }
        }
    }

    /// Selects a node, which is then in view.
    pub(super) fn choose(&mut self, scene: &Scene, node: &str) {
        self.revealed = Some(node.to_string());
        scene.actions.push(Action::Select(BTreeSet::from([node.to_string()])));
    }

    /// True if a node has the focus, so that the keys are for the graph.
    pub fn has_focus(&self) -> bool {
        self.focused.is_some()
    }

    /// Has a node brought into view in the next frame, if it is not there.
    pub fn reveal(&mut self, node: &str) {
        self.revealed = Some(node.to_string());
    }

    /// Moves the view until the node to be revealed is in it; all of it, once it was drawn.
    pub(super) fn show_revealed(&mut self, ctx: &Context, scene: &Scene) {
        let Some(entry) = self.revealed.take().and_then(|name| scene.entry(&name)) else { return };
        let (frame, is_known) = self.places.known_frame(scene, entry);
        if !is_known {
            self.revealed = Some(entry.name.clone());
            ctx.request_repaint();
        }
        let corner = |x: f32, y: f32| self.to_window()([f64::from(x), f64::from(y)]);
        let frame =
            Rect::from_min_max(corner(frame.left(), frame.top()), corner(frame.right(), frame.bottom()));
        let room = self.view.clip_rect.shrink(12.0);
        let by = |low: f32, high: f32, from: f32, to: f32| (from - low).max((to - high).min(0.0));
        let step = vec2(
            by(frame.left(), frame.right(), room.left(), room.right()),
            by(frame.top(), frame.bottom(), room.top(), room.bottom()),
        );
        if !room.contains_rect(frame) {
            self.view.pan += step;
        }
    }
}
