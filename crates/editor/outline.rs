//! Outlines that a hand draws over a picture to probe what they enclose: a box, or the hand's own way.

use crate::theme;
use eframe::egui::{PointerButton, Pos2, Rect, Response, Shape, Stroke, Ui, pos2};

/// Shape that a drag draws.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum OutlineShape {
    /// From corner to corner.
    Box,
    /// Along the way of the pointer, from its end to its beginning in a straight line.
    Free,
}

/// Least distance of two corners of a free outline, points.
const SPACING: f32 = 3.0;

/// Outline that is being drawn.
#[derive(Default)]
pub(crate) struct Outline {
    shape: Option<OutlineShape>,
    /// Points of the window.
    corners: Vec<Pos2>,
}

/// Progress of an outline in a frame.
pub(crate) enum Drawing {
    Idle,
    Going,
    /// Its corners, points of the window.
    Done(Vec<Pos2>),
}

impl Outline {
    /// Follows a drag over a picture, within which the outline stays. `shape`: that of an outline that begins; `None`: none does.
    pub fn follow(
        &mut self,
        ui: &Ui,
        response: &Response,
        picture: Rect,
        shape: Option<OutlineShape>,
    ) -> Drawing {
        if response.drag_started_by(PointerButton::Primary) {
            let origin = ui.input(|input| input.pointer.press_origin());
            (self.shape, self.corners) = (shape, origin.map(|at| picture.clamp(at)).into_iter().collect());
        }
        let (Some(shape), Some(&from)) = (self.shape, self.corners.first()) else { return Drawing::Idle };
        if let Some(to) = response.interact_pointer_pos().map(|at| picture.clamp(at)) {
            match shape {
                OutlineShape::Box => self.corners = vec![from, pos2(to.x, from.y), to, pos2(from.x, to.y)],
                OutlineShape::Free if self.corners.last().is_some_and(|at| at.distance(to) < SPACING) => {}
                OutlineShape::Free => self.corners.push(to),
            }
        }
        let stroke = Stroke::new(1.5, theme::accent(true));
        ui.painter()
            .with_clip_rect(picture.expand(1.0))
            .add(Shape::closed_line(self.corners.clone(), stroke));
        if response.dragged() && !response.drag_stopped() {
            return Drawing::Going;
        }
        self.shape = None;
        let corners = std::mem::take(&mut self.corners);
        if response.drag_stopped() { Drawing::Done(corners) } else { Drawing::Idle }
    }
}

/// The points that an outline encloses; where it encloses none, its first corner.
pub(crate) fn enclosed(outline: &[Pos2], points: impl Iterator<Item = Pos2>) -> Vec<Pos2> {
    let enclosed: Vec<Pos2> = points.filter(|point| encloses(outline, *point)).collect();
    if enclosed.is_empty() { outline.first().copied().into_iter().collect() } else { enclosed }
}

/// True if a line from the point to the right crosses the outline an odd number of times.
fn encloses(outline: &[Pos2], point: Pos2) -> bool {
    let ends = outline.iter().zip(outline.iter().cycle().skip(1));
    let crosses = |(a, b): &(&Pos2, &Pos2)| {
        (a.y > point.y) != (b.y > point.y) && point.x < a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    ends.filter(crosses).count() % 2 == 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_encloses_all_between_its_corners_and_a_bay_is_left_out() {
        let middles = || (0..16).map(|k| pos2((k % 4) as f32 + 0.5, (k / 4) as f32 + 0.5));
        let square = [pos2(0.0, 0.0), pos2(4.0, 0.0), pos2(4.0, 4.0), pos2(0.0, 4.0)];
        assert_eq!(enclosed(&square, middles()), middles().collect::<Vec<_>>());
        let reversed: Vec<Pos2> = square.into_iter().rev().collect();
        assert_eq!(enclosed(&reversed, middles()).len(), 16, "whichever way it was drawn");
        // A U: open above in the middle.
        let bay =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 3.0), (3.0, 3.0), (3.0, 0.0), (4.0, 0.0), (4.0, 4.0), (0.0, 4.0)];
        let bay = bay.map(|(x, y)| pos2(x, y));
        let held = enclosed(&bay, middles());
        assert_eq!(held.len(), 10);
        assert!(held.iter().all(|at| at.y > 3.0 || at.x < 1.0 || at.x > 3.0), "{held:?}");
        // Too small for any of the points.
        let small = [pos2(0.1, 0.1), pos2(0.2, 0.1), pos2(0.2, 0.2)];
        assert_eq!(enclosed(&small, middles()), [small[0]]);
    }
}
