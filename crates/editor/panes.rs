//! Panes of the window, which keep their shares of it when it gets another size.

use eframe::egui::{Context, Id, PanelState, Rect, Vec2};

/// Share of a pane in what it divides, along the direction in which its border moves.
#[derive(Default)]
pub(crate) struct Pane {
    share: f32,
    /// Its length before a hand took hold of its border, or since it moved it last, points.
    length: f32,
    /// Length of what is divided in the last frame, points.
    whole: f32,
}

impl Pane {
    /// Called before a panel is shown, which divides so many points: brings it to its share where these are others than in the last frame.
    pub fn fit(&mut self, ctx: &Context, name: &str, whole: f32) {
        let id = Id::new(name);
        if whole == self.whole || self.share == 0.0 {
            return;
        }
        if let Some(mut state) = PanelState::load(ctx, id) {
            state.outer_rect = Rect::from_min_size(state.outer_rect.min, Vec2::splat(self.share * whole));
            ctx.data_mut(|data| data.insert_persisted(id, state));
        }
    }

    /// Called after the panel was shown with a length: a border that a hand moves is another share.
    pub fn keep(&mut self, ctx: &Context, length: f32, whole: f32) {
        let is_down = ctx.input(|input| input.pointer.any_down());
        let is_moved = is_down && whole == self.whole && (length - self.length).abs() > 0.5;
        if is_moved || self.share == 0.0 {
            self.share = length / whole.max(1.0);
        }
        if is_moved || !is_down || whole != self.whole {
            self.length = length;
        }
        self.whole = whole;
    }
}
