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

/// Sizes of the window for which the shares of its panes are kept as a hand left them.
const MAX_SIZES: usize = 8;

/// A size of the window, points, and the shares of its panes there; 0 of those that were never shown.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Layout {
    size: [f32; 2],
    shares: [f32; 3],
}

impl Layout {
    fn of_panes(size: Vec2, panes: &[Pane; 3]) -> Layout {
        Layout { size: size.into(), shares: panes.each_ref().map(|pane| pane.share) }
    }

    fn parse(line: &str) -> Option<Layout> {
        let numbers: Vec<f32> = line.split_whitespace().map_while(|word| word.parse().ok()).collect();
        let [width, height, shares @ ..] = <[f32; 5]>::try_from(numbers).ok()?;
        let is_sound = (100.0..1e5).contains(&width) && (100.0..1e5).contains(&height);
        let is_sound = is_sound && shares.iter().all(|share| (0.0..1.0).contains(share));
        is_sound.then_some(Layout { size: [width, height], shares })
    }
}

/// Shares of the panes, which the next window takes over.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Layouts {
    /// At the end of the last window.
    last: Option<Layout>,
    /// By the window's size, where a hand moved borders; the last one first.
    by_hand: Vec<Layout>,
}

impl Layouts {
    /// The layouts in a file, as far as they are sound.
    pub fn read(file: &Path) -> Layouts {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let mut sound = text.lines().filter_map(Layout::parse);
        Layouts { last: sound.next(), by_hand: sound.take(MAX_SIZES).collect() }
    }

    /// Writes them at the end of a window of a size; where they cannot be kept, the next window does without.
    pub fn write(&mut self, file: &Path, size: Vec2, panes: &[Pane; 3]) {
        self.last = Some(Layout::of_panes(size, panes));
        let line = |Layout { size, shares }: &Layout| {
            let numbers = size.iter().chain(shares).map(f32::to_string).collect::<Vec<_>>();
            numbers.join(" ") + "\n"
        };
        let made = file.parent().map(std::fs::create_dir_all);
        let text: String = self.last.iter().chain(&self.by_hand).map(line).collect();
        let _ = made.map(|_| write_whole(file, text.as_bytes()));
    }

    pub fn last_size(&self) -> Option<[f32; 2]> {
        self.last.map(|layout| layout.size)
    }

    /// Panes with the shares of the last window.
    pub fn last_panes(&self) -> [Pane; 3] {
        let shares = self.last.map_or([0.0; 3], |layout| layout.shares);
        shares.map(|share| Pane { share, ..Pane::default() })
    }

    /// Keeps the shares of panes, of which a hand moved one in a window of a size.
    pub fn keep(&mut self, size: Vec2, panes: &[Pane; 3]) {
        self.by_hand.retain(|layout| Vec2::from(layout.size) != size);
        self.by_hand.insert(0, Layout::of_panes(size, panes));
        self.by_hand.truncate(MAX_SIZES);
    }

    /// Gives panes the shares that they had in a window of a size, as far as a hand left them so.
    pub fn take_up(&self, size: Vec2, panes: &mut [Pane; 3]) {
        let Some(known) = self.by_hand.iter().find(|layout| Vec2::from(layout.size) == size) else { return };
        for (pane, share) in panes.iter_mut().zip(known.shares).filter(|(_, share)| *share > 0.0) {
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
        let shares = |panes: [Pane; 3]| panes.map(|pane| pane.share);
        let mut layouts = Layouts::default();
        for k in 1..=MAX_SIZES as u16 + 1 {
            layouts.keep(vec2(900.0 + f32::from(k), 600.5), &panes([0.4, 0.0, 0.01 * f32::from(k)]));
        }
        layouts.write(&file, vec2(700.0, 500.0), &panes([0.1, 0.2, 0.0]));
        let read = Layouts::read(&file);
        assert_eq!((&read, read.by_hand.len()), (&layouts, MAX_SIZES));
        assert_eq!((read.last_size(), shares(read.last_panes())), (Some([700.0, 500.0]), [0.1, 0.2, 0.0]));
        // A pane that was not shown then has the share that it has now, and another size those of now.
        for (width, wanted) in [(903.0, [0.4, 0.5, 0.03]), (700.0, [0.5; 3])] {
            let mut taken = panes([0.5; 3]);
            read.take_up(vec2(width, 600.5), &mut taken);
            assert_eq!(shares(taken), wanted);
        }
        for text in ["", "900 600 0.4 0.3", "900 600 0.4 0.3 2", "900 NaN 0.4 0.3 0.2", "x"] {
            std::fs::write(&file, text).unwrap();
            assert_eq!(Layouts::read(&file), Layouts::default(), "{text}");
        }
    }
}
