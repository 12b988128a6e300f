//! Comparison of the picture with one that was remembered: of another step, integrator, camera or anything else that was changed since.
//! Over each other with a line between them that is dragged, beside each other, or their difference.

use crate::jobs::Job;
use crate::scene::{Scene, milliseconds};
use crate::textures::{WHOLE, set_texture};
use crate::theme::{self, Help};
use crate::ways_out::{AGAIN, buttons, ways_out};
use crate::worker::{Pixels, difference, short};
use eframe::egui::{
    Align, Align2, Button, Color32, ColorImage, CursorIcon, FontId, Galley, Layout, Rect, Sense, Shape,
    Stroke, TextureHandle, TextureOptions, Ui, UiBuilder, WidgetInfo, WidgetType, pos2, vec2,
};
use std::sync::Arc;
use voltet_core::Error;
use voltet_core::picture::Picture;

/// Way of showing both.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Mode {
    Swipe,
    Beside,
    Difference,
}

/// Modes, with their names and what they show.
const MODES: [(Mode, &str, &str); 3] = [
    (Mode::Swipe, "swipe", "the remembered picture at the left of a line that is dragged"),
    (Mode::Beside, "beside", "the remembered picture beside the present one"),
    (Mode::Difference, "difference", "where they differ, ten times as bright"),
];

/// Factor of a difference that is shown.
const GAIN: f32 = 10.0;

/// Most width of the ways of showing both, points.
const MODES_WIDTH: f32 = 280.0;

/// Colours of text over the pictures, and of its ground.
const TEXT: Color32 = Color32::from_gray(230);
const GROUND: Color32 = Color32::BLACK;

/// Width within which the line is taken hold of, points.
const GRIP: f32 = 10.0;

/// The picture that was remembered.
struct Remembered {
    pixels: Pixels,
    texture: TextureHandle,
    seconds: Option<f64>,
}

/// Difference of the remembered picture and another, found on a thread of its own.
struct Difference {
    of: Arc<Picture>,
    job: Option<Job<Comparison>>,
    /// True if its image is found, too.
    has_image: bool,
    texture: Option<TextureHandle>,
    /// Figures in words.
    text: String,
    /// Reason why there are none.
    error: Option<Error>,
}

/// Figures of the difference of two pictures of one size, and its image where that is shown.
struct Comparison {
    /// Largest difference of a premultiplied channel, and root of the mean square.
    figures: [f64; 2],
    image: Option<ColorImage>,
}

pub(crate) struct Compare {
    remembered: Option<Remembered>,
    found: Option<Difference>,
    mode: Mode,
    /// Place of the line, share of the picture's width.
    line: f32,
}

impl Default for Compare {
    fn default() -> Self {
        Compare { remembered: None, found: None, mode: Mode::Swipe, line: 0.5 }
    }
}

impl Compare {
    /// Button that remembers the picture.
    pub fn button(&mut self, ui: &mut Ui, scene: &Scene) {
        let present = scene.pixels.as_ref().filter(|pixels| pixels.is_full());
        let help =
            "keeps this picture, which later ones are compared with: of another step, integrator or camera";
        let button = ui.add_enabled(present.is_some(), Button::new("remember").small());
        if let (true, Some(pixels)) = (button.help(help).clicked(), present) {
            let texture = ui.ctx().load_texture("remembered", pixels.image.clone(), TextureOptions::LINEAR);
            self.remembered = Some(Remembered { pixels: pixels.clone(), texture, seconds: scene.seconds });
            self.found = None;
        }
    }

    /// Ways of showing both, in the lower right corner of a place: there they leave the picture its size.
    fn modes(&mut self, ui: &mut Ui, scene: &Scene, place: Rect) {
        let size = vec2(MODES_WIDTH.min(place.width() - 16.0), 24.0);
        let corner = Align2::RIGHT_BOTTOM.anchor_size(place.right_bottom() - vec2(8.0, 6.0), size);
        let layout = Layout::right_to_left(Align::Center);
        let ground = ui.painter().add(Shape::Noop);
        let shown = ui.scope_builder(UiBuilder::new().max_rect(corner).layout(layout), |ui| {
            ui.visuals_mut().override_text_color = Some(TEXT);
            if theme::button(ui, "✖", "forget the remembered picture", "no comparison any more").clicked() {
                *self = Compare::default();
            }
            for (mode, name, help) in MODES.into_iter().rev() {
                if ui.add(Button::selectable(self.mode == mode, name)).help(help).clicked() {
                    self.mode = mode;
                }
            }
            if let Some(error) = self.found.as_ref().and_then(|found| found.error.as_ref()) {
                buttons(ui, scene, &ways_out(scene, error));
                if ui.small_button(AGAIN).clicked() {
                    self.found = None;
                }
            }
        });
        let rect = shown.response.rect.expand(2.0).intersect(place);
        ui.painter().set(ground, Shape::rect_filled(rect, 4.0, GROUND));
    }

    /// Part of the room for the picture that the present one has.
    pub fn room(&self, whole: Rect) -> Rect {
        match self.remembered.is_some() && self.mode == Mode::Beside {
            true => whole.split_left_right_at_fraction(0.5).1,
            false => whole,
        }
    }

    /// Has the comparison fail.
    #[cfg(test)]
    pub fn fail(&mut self, error: Error) {
        self.found = self.found.take().map(|found| found.failed(error));
    }

    /// Shows the remembered picture with the present one, which lies in `picture`, part of `room`.
    pub fn over(&mut self, ui: &mut Ui, scene: &Scene, whole: Rect, picture: Rect) {
        let (Some(remembered), Some(present)) = (&self.remembered, &scene.pixels) else { return };
        let has_image = self.mode == Mode::Difference;
        if let Some(found) = &mut self.found {
            found.take(ui);
        }
        let is_found = |found: &Difference| {
            let is_it = Arc::ptr_eq(&found.of, &present.picture) && (found.has_image || !has_image);
            is_it || found.job.is_some()
        };
        if present.is_full() && !self.found.as_ref().is_some_and(is_found) {
            let before = &remembered.pixels.picture;
            self.found = Some(Difference::begin(ui, before, &present.picture, has_image));
        }
        match self.mode {
            Mode::Swipe => self.swipe(ui, picture),
            Mode::Beside => {
                let place = remembered.within(picture.translate(vec2(-0.5 * whole.width(), 0.0)));
                ui.painter().image(remembered.texture.id(), place, WHOLE, Color32::WHITE);
            }
            Mode::Difference => {
                if let Some(texture) = self.found.as_ref().and_then(|found| found.texture.as_ref()) {
                    ui.painter().image(texture.id(), picture, WHOLE, Color32::WHITE);
                }
            }
        }
    }

    /// Shows over the pictures and their grips what they are, the figures, and the ways of showing both, in what is seen of their room.
    pub fn controls(&mut self, ui: &mut Ui, scene: &Scene, whole: Rect, picture: Rect) {
        if self.remembered.is_none() || scene.pixels.is_none() {
            return;
        }
        let seen = whole.intersect(ui.clip_rect());
        let line = match self.mode {
            Mode::Swipe => Some(picture.left() + self.line * picture.width()),
            Mode::Beside => Some(whole.center().x),
            Mode::Difference => None,
        };
        if let Some(x) = line {
            for (text, align, aside) in
                [("remembered", Align2::RIGHT_TOP, -10.0), ("present", Align2::LEFT_TOP, 10.0)]
            {
                let at = pos2(x + aside, seen.top() + 8.0);
                let galley = galley(ui, text, f32::INFINITY);
                let place = align.anchor_size(at, galley.size());
                // A side without room for the word is hardly seen.
                if seen.x_range().contains(place.left()) && seen.x_range().contains(place.right()) {
                    on_ground(ui, place, galley);
                }
            }
        }
        self.say(ui, scene, seen);
        self.modes(ui, scene, seen);
    }

    /// Ends the comparison; false if there was none.
    pub fn end(&mut self) -> bool {
        std::mem::take(self).remembered.is_some()
    }

    fn swipe(&mut self, ui: &mut Ui, picture: Rect) {
        let Some(remembered) = &self.remembered else { return };
        let x = picture.left() + self.line * picture.width();
        let place = remembered.within(picture);
        let share = ((x - place.left()) / place.width().max(1.0)).clamp(0.0, 1.0);
        ui.painter().rect_filled(picture.with_max_x(x), 0.0, Color32::BLACK);
        let left = place.with_max_x(place.left() + share * place.width());
        ui.painter().image(remembered.texture.id(), left, WHOLE.with_max_x(share), Color32::WHITE);
        let line = Stroke::new(2.0, theme::accent(true));
        ui.painter().line_segment([pos2(x, picture.top()), pos2(x, picture.bottom())], line);
        let grip = Rect::from_center_size(pos2(x, picture.center().y), vec2(GRIP, picture.height()));
        let response = ui.interact(grip, ui.id().with("line of comparison"), Sense::drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "line of comparison"));
        if response.dragged() {
            let x = response.interact_pointer_pos().map_or(x, |at| at.x);
            self.line = ((x - picture.left()) / picture.width().max(1.0)).clamp(0.0, 1.0);
        }
        response.on_hover_cursor(CursorIcon::ResizeHorizontal);
    }

    /// Figures of the difference, and the time of both, above the ways of showing both: in the upper corners stand other words.
    fn say(&self, ui: &Ui, scene: &Scene, whole: Rect) {
        let Some(found) = &self.found else { return };
        let before = self.remembered.as_ref().and_then(|remembered| remembered.seconds);
        let text = found.words(scene.pixels.as_ref().map(|now| &now.picture), [before, scene.seconds]);
        let galley = galley(ui, &text, whole.width() - 20.0);
        let place = Align2::RIGHT_BOTTOM.anchor_size(whole.right_bottom() - vec2(10.0, 38.0), galley.size());
        on_ground(ui, place, galley);
    }
}

/// Words over the pictures in lines of a width, points.
fn galley(ui: &Ui, text: &str, width: f32) -> Arc<Galley> {
    ui.painter().layout(text.into(), FontId::proportional(12.0), TEXT, width)
}

/// Draws words on a ground of their own, through which neither lines nor the pictures are seen.
fn on_ground(ui: &Ui, place: Rect, galley: Arc<Galley>) {
    ui.painter().rect_filled(place.expand(4.0), 4.0, GROUND);
    ui.painter().galley(place.min, galley, TEXT);
}

impl Remembered {
    /// Its place within one, in its own shape.
    fn within(&self, place: Rect) -> Rect {
        let [width, height] = self.pixels.size().map(|side| side as f32);
        let scale = (place.width() / width).min(place.height() / height);
        Rect::from_center_size(place.center(), vec2(width, height) * scale)
    }
}

impl Difference {
    fn begin(ui: &Ui, before: &Arc<Picture>, now: &Arc<Picture>, has_image: bool) -> Difference {
        let text = "is being compared".to_string();
        let begun = Difference { of: now.clone(), job: None, has_image, texture: None, text, error: None };
        if [before.width, before.height] != [now.width, now.height] {
            return Difference { text: "not compared, for the sizes differ".into(), ..begun };
        }
        let (a, b) = (before.clone(), now.clone());
        match Job::start("comparison", ui.ctx(), move |_| Ok(differ(&a, &b, has_image))) {
            Ok(job) => Difference { job: Some(job), ..begun },
            Err(error) => begun.failed(error),
        }
    }

    fn failed(self, error: Error) -> Difference {
        Difference { text: error.to_string(), error: Some(error), ..self }
    }

    /// Figures with the seconds of both pictures; where another picture is shown than they are of, what is waited for.
    fn words(&self, shown: Option<&Arc<Picture>>, seconds: [Option<f64>; 2]) -> String {
        let [then, now] = seconds.map(|seconds| seconds.map_or("?".into(), milliseconds));
        match shown.is_some_and(|shown| Arc::ptr_eq(&self.of, shown)) {
            true => format!("{}; {then} then, {now} now", self.text),
            false => format!("compared once the full picture is drawn; {then} then"),
        }
    }

    /// Takes over what was found meanwhile.
    fn take(&mut self, ui: &Ui) {
        let Some(found) = self.job.as_ref().and_then(Job::result) else { return };
        self.job = None;
        match found {
            Ok(Comparison { figures, image }) => {
                self.text = message(figures);
                if let Some(image) = image {
                    set_texture(&mut self.texture, ui, "difference", image, TextureOptions::LINEAR);
                }
            }
            Err(error) => (self.text, self.error) = (error.to_string(), Some(error)),
        }
    }
}

/// Largest difference and root of the mean square in words.
fn message(figures: [f64; 2]) -> String {
    match figures {
        [0.0, 0.0] => "no difference".into(),
        [most, rms] => format!("largest difference {}, root mean square {}", short(most), short(rms)),
    }
}

/// The difference of two pictures of one size.
fn differ(before: &Picture, now: &Picture, has_image: bool) -> Comparison {
    let of_pixel = |(a, b): (&[f32; 4], &[f32; 4])| {
        let [r, g, b] = [0, 1, 2].map(|k| {
            // Opacity that differs counts as light of white.
            let by = (a[k] - b[k]).abs().max((a[3] - b[3]).abs());
            (255.0 * (GAIN * by).min(1.0)) as u8
        });
        Color32::from_rgb(r, g, b)
    };
    let pixels = || before.rgba.iter().zip(&now.rgba).map(of_pixel).collect();
    let image = has_image.then(|| ColorImage::new([now.width, now.height], pixels()));
    Comparison { figures: difference(before, now), image }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_difference_has_its_figures_and_its_image() {
        let of = |rgba: Vec<[f32; 4]>| Picture { width: 2, height: 1, rgba };
        let before = of(vec![[0.5, 0.25, 0.0, 1.0]; 2]);
        let now = of(vec![[0.5, 0.25, 0.0, 1.0], [0.5, 0.375, 0.03125, 1.0]]);
        let found = differ(&before, &now, true);
        assert_eq!(found.figures[0], 0.125);
        assert!(found.figures[1] > 0.0 && found.figures[1] < 0.125);
        let image = found.image.unwrap();
        assert_eq!(image.pixels, [Color32::BLACK, Color32::from_rgb(0, 255, 79)]);
        assert!(differ(&before, &now, false).image.is_none());
        assert_eq!(message(differ(&now, &now, false).figures), "no difference");
        assert_eq!(message([0.99, 3e-5]), "largest difference 0.99, root mean square 3e-5");
        for pixels in [[[f32::NAN; 4], [0.0; 4]], [[0.0; 4], [f32::NAN; 4]]] {
            let figures = differ(&before, &of(pixels.to_vec()), false).figures;
            assert_eq!(message(figures), "largest difference NaN, root mean square NaN");
        }
    }

    #[test]
    fn figures_are_said_of_the_picture_that_they_are_of() {
        let picture = || Arc::new(Picture { width: 1, height: 1, rgba: vec![[0.0; 4]] });
        let (of, other) = (picture(), picture());
        let found = Difference {
            of: of.clone(),
            job: None,
            has_image: false,
            texture: None,
            text: "no difference".into(),
            error: None,
        };
        let seconds = [Some(0.2), Some(3.0)];
        assert_eq!(found.words(Some(&of), seconds), "no difference; 200 ms then, 3.0 s now");
        for shown in [Some(&other), None] {
            assert_eq!(found.words(shown, seconds), "compared once the full picture is drawn; 200 ms then");
        }
    }
}
