//! Marks over the picture: the place that is seen first under the pointer, the cell that was picked, and a length between two points.

use crate::scene::Scene;
use crate::theme;
use crate::view::View;
use crate::worker::{Hit, HitCell, short, short_by};
use eframe::egui::{
    Align2, Color32, FontId, Galley, Painter, Pos2, Rect, Sense, Stroke, Ui, WidgetInfo, WidgetType, vec2,
};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::with_commas;
use voltet_graph::ArrayRef;

/// Corners for the words, the usual one first.
const CORNERS: [Align2; 4] = [Align2::RIGHT_TOP, Align2::RIGHT_BOTTOM, Align2::LEFT_TOP, Align2::LEFT_BOTTOM];

/// Distance of the words from a grip beside them, points.
const GRIP_DISTANCE: f32 = 12.0;

/// The picture in the window, on which marks are drawn.
struct MarkPainter<'a> {
    painter: Painter,
    picture: Rect,
    view: View,
    ui: &'a Ui,
}

/// `measures`: a length is shown; `grips`: places of handles, which words do not cover.
pub(crate) fn show(ui: &Ui, scene: &Scene, picture: Rect, measures: bool, grips: &[Pos2]) {
    let Some(view) = scene.view else { return };
    let marks = MarkPainter {
        painter: ui.painter().with_clip_rect(picture.intersect(ui.clip_rect())),
        picture,
        view,
        ui,
    };
    if let Some(cell) = scene.probed.as_ref().and_then(|probed| probed.hit.as_ref()?.cell.as_ref()) {
        marks.cell(cell);
    }
    if measures {
        marks.length(scene.measured);
    }
    if let Some(hit) = &scene.hovered {
        marks.words(&words(scene, view, hit), grips);
    }
}

/// Values, cell and point of a hit.
fn words(scene: &Scene, view: View, hit: &Hit) -> String {
    let range = |name| {
        let ranges = scene.distribution.as_ref().map(|found| &found.known.ranges)?;
        ranges.get(&ArrayRef::Named(name)).map(|[low, high]| 1e-3 * (high - low))
    };
    let number = |x: f64, name| short_by(x, range(name).unwrap_or(f64::INFINITY));
    let of_cell = |cell: &HitCell| {
        let g = cell.g.map_or(String::new(), |g| format!("g {}   ", number(g, "g")));
        format!("s {}   {g}cell {}   ", number(cell.s, "s"), with_commas(cell.number))
    };
    let point = hit.point.to_array().map(|x| short_by(x, 1e-3 * view.height())).join(", ");
    format!("{}at ({point})", hit.cell.as_ref().map_or(String::new(), of_cell))
}

impl MarkPainter<'_> {
    fn at(&self, point: DVec3) -> Option<Pos2> {
        let [x, y] = self.view.place(point)?;
        Some(self.picture.center() + self.picture.height() * vec2(x as f32, -y as f32))
    }

    /// A line on a rim of black, so that it is seen over whatever the picture shows there.
    fn line(&self, ends: [DVec3; 2], width: f32) {
        if let (Some(from), Some(to)) = (self.at(ends[0]), self.at(ends[1])) {
            let rim = Stroke::new(width + 1.8, Color32::from_black_alpha(110));
            self.painter.line_segment([from, to], rim);
            self.painter.line_segment([from, to], Stroke::new(width, theme::accent(true)));
        }
    }

    fn cell(&self, cell: &HitCell) {
        cell.edges.iter().for_each(|ends| self.line(*ends, 1.2));
    }

    fn length(&self, points: &[DVec3]) {
        if let [from, to] = *points {
            self.line([from, to], 1.6);
            if let Some(middle) = self.at(0.5 * (from + to)) {
                self.text(&short(from.distance(to)), middle, Align2::CENTER_BOTTOM);
            }
        }
        for at in points.iter().filter_map(|point| self.at(*point)) {
            self.painter.circle(at, 4.0, theme::accent(true), Stroke::new(1.2, Color32::BLACK));
        }
    }

    /// Words in the upper right corner, or in another one where they would cover a grip there.
    fn words(&self, words: &str, grips: &[Pos2]) {
        let within = self.painter.clip_rect().shrink2(vec2(10.0, 8.0));
        let size = self.galley(words).size();
        let place = |corner: &Align2| corner.align_size_within_rect(size, within);
        let is_free = |corner: &Align2| {
            let place = place(corner).expand(GRIP_DISTANCE);
            !grips.iter().any(|grip| place.contains(*grip))
        };
        let corner = CORNERS.into_iter().find(is_free).unwrap_or(Align2::RIGHT_TOP);
        self.text(words, corner.pos_in_rect(&within), corner);
    }

    fn galley(&self, text: &str) -> Arc<Galley> {
        let (font, color) = (FontId::proportional(12.0), Color32::from_gray(230));
        self.painter.layout(text.into(), font, color, self.painter.clip_rect().width() - 20.0)
    }

    fn text(&self, text: &str, at: Pos2, align: Align2) {
        let (galley, color) = (self.galley(text), Color32::from_gray(230));
        let place = align.anchor_size(at, galley.size());
        self.painter.rect_filled(place.expand(4.0), 4.0, Color32::from_black_alpha(200));
        let response = self.ui.interact(place, self.ui.id().with(("mark", align)), Sense::empty());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, text));
        self.painter.galley(place.min, galley, color);
    }
}
