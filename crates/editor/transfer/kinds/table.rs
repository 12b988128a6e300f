//! Tables: pictures over ranges of s and g, moved and scaled by these.

use super::super::geometry::{Change, Handle, Scale, corners, edges, list};
use super::super::plane::WidgetPainter;
use super::super::region::with_corner;
use super::super::shape::{PlaneContext, Shape};
use crate::picture::WHOLE;
use eframe::egui::{Color32, Rect, TextureId};
use voltet_core::transfer::Table;
use voltet_graph::{Field, LocatedValue, find_setting};

/// The least length of a side, as a share of what is shown: a range that is empty is refused.
const MIN_SIDE: f64 = 1e-3;

/// Opacity of the picture over the histogram.
const COVERS: f32 = 0.85;

#[derive(Debug)]
pub(super) struct Picture {
    /// Ranges of s and g.
    ranges: [[f64; 2]; 2],
    texture: Option<TextureId>,
}

impl Picture {
    pub fn new(table: &Table, numbers: &[Field], on: &PlaneContext) -> Picture {
        let path = find_setting(numbers, "image").and_then(LocatedValue::text);
        Picture { ranges: [table.s, table.g], texture: path.and_then(|path| on.images.texture(path)) }
    }
}

/// The ranges as a file states them, as far as they changed.
fn stated(before: [[f64; 2]; 2], after: [[f64; 2]; 2]) -> Vec<Change> {
    let of = |k: usize| (before[k] != after[k]).then(|| (["s", "g"][k], Some(list(&after[k]))));
    (0..2).filter_map(of).collect()
}

impl Shape for Picture {
    fn handles(&self, scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        let middle = self.ranges.map(|[low, high]| 0.5 * low + 0.5 * high);
        let corners = corners(self.ranges).into_iter().enumerate().map(|(i, at)| (Handle::Rim(i), at));
        let edges = edges(self.ranges, scale).map(|(axis, upper, at)| (Handle::Edge(axis, upper), at));
        std::iter::once((Handle::Centre, middle)).chain(corners).chain(edges).collect()
    }

    fn moved(&self, handle: Handle, to: [f64; 2], scale: &Scale) -> Vec<Change> {
        let mut after = self.ranges;
        match handle {
            Handle::Rim(i) => after = with_corner(self.ranges, i, to),
            Handle::Edge(axis, upper) => {
                after[axis][usize::from(upper)] = to[axis];
                after[axis] = [after[axis][0].min(after[axis][1]), after[axis][0].max(after[axis][1])];
            }
            _ => {
                let by = [0, 1].map(|k: usize| to[k] - (0.5 * self.ranges[k][0] + 0.5 * self.ranges[k][1]));
                return stated(self.ranges, [0, 1].map(|k: usize| self.ranges[k].map(|x| x + by[k])));
            }
        }
        let least = |k: usize| MIN_SIDE * (scale.shown[k][1] - scale.shown[k][0]);
        match (0..2).all(|k| after[k][1] - after[k][0] >= least(k)) {
            true => stated(self.ranges, after),
            false => Vec::new(),
        }
    }

    fn draw(&self, pen: &WidgetPainter) {
        let [s, g] = self.ranges;
        if let Some(texture) = self.texture {
            let place =
                Rect::from_two_pos(pen.plane.to_window([s[0], g[0]]), pen.plane.to_window([s[1], g[1]]));
            let tint = Color32::WHITE.gamma_multiply(if pen.is_hidden { 0.3 * COVERS } else { COVERS });
            pen.painter.image(texture, place, WHOLE, tint);
        }
        pen.rectangle(self.ranges, pen.stroke, Color32::TRANSPARENT);
    }
}
