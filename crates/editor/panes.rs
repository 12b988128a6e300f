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

/// Sizes of the window for which the shares of its panes are kept.
const MAX_SIZES: usize = 8;

/// A size of the window, points, and the shares of its panes there.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Layout {
    size: [f32; 2],
    shares: [f32; 3],
}

impl Layout {
    fn parse(line: &str) -> Option<Layout> {
        let numbers: Vec<f32> = line.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let [width, height, shares @ ..] = <[f32; 5]>::try_from(numbers).ok()?;
        let is_sound = (100.0..1e5).contains(&width) && (100.0..1e5).contains(&height);
        let is_sound = is_sound && shares.iter().all(|share| (0.0..1.0).contains(share));
        is_sound.then_some(Layout { size: [width, height], shares })
    }
}

/// Shares of the panes by the window's size, which the next window takes over; the last size first.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Layouts(Vec<Layout>);

impl Layouts {
    /// The layouts in a file, as far as they are sound.
    pub fn read(file: &Path) -> Layouts {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        Layouts(text.lines().filter_map(Layout::parse).collect())
    }

    /// Writes them; where they cannot be kept, the next window does without.
    pub fn write(&self, file: &Path) {
        let line = |Layout { size, shares }: &Layout| {
            let numbers = size.iter().chain(shares).map(f32::to_string).collect::<Vec<_>>();
            numbers.join(" ") + "\n"
        };
        let made = file.parent().map(std::fs::create_dir_all);
        let _ = made.map(|_| write_whole(file, self.0.iter().map(line).collect::<String>().as_bytes()));
    }

    /// The last size of the window.
    pub fn last_size(&self) -> Option<[f32; 2]> {
        self.0.first().map(|layout| layout.size)
    }

    /// Keeps the shares that panes have in a window of a size.
    pub fn keep(&mut self, size: Vec2, panes: &[Pane; 3]) {
        let (size, shares) = (size.into(), panes.each_ref().map(|pane| pane.share));
        self.0.retain(|layout| layout.size != size);
        self.0.insert(0, Layout { size, shares });
        self.0.truncate(MAX_SIZES);
    }

    /// Gives panes the shares that they had in a window of a size, if it was kept.
    pub fn take_up(&self, size: Vec2, panes: &mut [Pane; 3]) {
        let Some(known) = self.0.iter().find(|layout| Vec2::from(layout.size) == size) else { return };
        for (pane, share) in panes.iter_mut().zip(known.shares) {
            *pane = Pane { share, ..Pane::default() };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn layouts_are_read_as_they_were_written_and_what_is_not_sound_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("state/window");
        assert_eq!(Layouts::read(&file), Layouts::default());
        let panes = |shares: [f32; 3]| shares.map(|share| Pane { share, ..Pane::default() });
        let mut layouts = Layouts::default();
        for k in 1..=MAX_SIZES as u16 + 1 {
            layouts.keep(vec2(900.0 + f32::from(k), 600.5), &panes([0.4, 0.0, 0.01 * f32::from(k)]));
        }
        layouts.write(&file);
        let read = Layouts::read(&file);
        assert_eq!((&read, read.0.len()), (&layouts, MAX_SIZES));
        assert_eq!(read.last_size(), Some([909.0, 600.5]));
        let mut taken = panes([0.5; 3]);
        read.take_up(vec2(903.0, 600.5), &mut taken);
        assert_eq!(taken.map(|pane| pane.share), [0.4, 0.0, 0.03]);
        for text in ["", "900 600 0.4 0.3", "900 600 0.4 0.3 2", "900 NaN 0.4 0.3 0.2", "x"] {
            std::fs::write(&file, text).unwrap();
            assert_eq!(Layouts::read(&file), Layouts::default(), "{text}");
        }
    }
}
