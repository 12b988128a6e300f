//! Panes of the window, which keep their shares of it when it gets another size.

use eframe::egui::{Context, Id, PanelState, Rect, Vec2};
use std::path::Path;
use voltet_nodes::files::write_whole;

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
    /// Share before it was ever shown, unless one is known.
    pub fn share_or(&self, usual: f32) -> f32 {
        if self.share > 0.0 { self.share } else { usual }
    }

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

/// The window's size, points, and the shares of its panes, which the next window takes over.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct WindowLayout {
    pub size: [f32; 2],
    shares: [f32; 3],
}

impl WindowLayout {
    pub fn from_panes(size: Vec2, panes: &[Pane; 3]) -> WindowLayout {
        WindowLayout { size: size.into(), shares: panes.each_ref().map(|pane| pane.share) }
    }

    /// The layout in a file; `None` where there is none that is sound.
    pub fn read(file: &Path) -> Option<WindowLayout> {
        let text = std::fs::read_to_string(file).ok()?;
        let numbers: Vec<f32> = text.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let [width, height, shares @ ..] = <[f32; 5]>::try_from(numbers).ok()?;
        let is_sound = (100.0..1e5).contains(&width) && (100.0..1e5).contains(&height);
        let is_sound = is_sound && shares.iter().all(|share| (0.0..1.0).contains(share));
        is_sound.then_some(WindowLayout { size: [width, height], shares })
    }

    /// Writes it; where it cannot be kept, the next window does without.
    pub fn write(&self, file: &Path) {
        let numbers = self.size.iter().chain(&self.shares).map(f32::to_string).collect::<Vec<_>>();
        let made = file.parent().map(std::fs::create_dir_all);
        let _ = made.map(|_| write_whole(file, (numbers.join(" ") + "\n").as_bytes()));
    }

    pub fn panes(&self) -> [Pane; 3] {
        self.shares.map(|share| Pane { share, ..Pane::default() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_layout_is_read_as_it_was_written_and_what_is_not_sound_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("state/window");
        assert_eq!(WindowLayout::read(&file), None);
        let layout = WindowLayout { size: [900.0, 600.5], shares: [0.4, 0.0, 0.3] };
        layout.write(&file);
        assert_eq!(WindowLayout::read(&file), Some(layout));
        for text in ["", "900 600 0.4 0.3", "900 600 0.4 0.3 2", "900 NaN 0.4 0.3 0.2", "x"] {
            std::fs::write(&file, text).unwrap();
            assert_eq!(WindowLayout::read(&file), None, "{text}");
        }
    }
}
