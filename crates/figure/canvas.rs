//! Lines, rectangles and text over a picture, in linear light.

use crate::raster::{draw, draw_line, outside, over, visible_share};
use std::collections::BTreeSet;
use std::sync::{Arc, LazyLock};
use ttf_parser::{Face, OutlineBuilder};
use voltet_core::picture::Picture;
use voltet_core::picture_parts::{Annotation, PathStep, Shape, ShapeForm};

pub use voltet_core::picture_parts::Place;

/// The end of a text, or its middle, that stands at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Align {
    /// The text begins there.
    Start,
    /// Its middle is there.
    Middle,
    /// It ends there.
    End,
}

/// Colours of what is written: linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Theme {
    /// Text and lines.
    pub ink: [f32; 3],
    /// A rim around text and lines, so that they are seen over whatever the picture shows there.
    pub rim: [f32; 3],
}

impl Theme {
    /// For dark backgrounds.
    pub const DARK: Theme = Theme { ink: [0.85; 3], rim: [0.0; 3] };
    /// For light backgrounds.
    pub const LIGHT: Theme = Theme { ink: [0.01; 3], rim: [1.0; 3] };
}

/// A rectangle: its upper left and its lower right corner.
pub type Rectangle = [Place; 2];

/// A picture that is written over, and, where they are recorded, the shapes that are written. Parts of it that are taken are not written
/// over again.
#[derive(Debug)]
pub struct Canvas<'a> {
    picture: &'a mut Picture,
    record: Option<Annotation>,
    theme: Theme,
    font: f32,
    taken: Vec<Rectangle>,
    lacking: BTreeSet<char>,
    #[cfg(test)]
    pub(crate) texts: Vec<(String, Rectangle)>,
}

/// DejaVu Sans; its licence is beside it.
static FONT: LazyLock<Face<'static>> = LazyLock::new(|| {
    Face::parse(include_bytes!("font/dejavu-sans.ttf"), 0).expect("the font that is part of the program")
});

/// Width of lines as a share of the font's size.
const LINE: f32 = 0.08;

const RIM: f32 = 0.6;

/// Distance from one line of a text to the next, in font sizes.
pub(crate) const LEADING: f32 = 1.3;

impl<'a> Canvas<'a> {
    /// A canvas with nothing taken. `font`: height of letters, the font's size in pixels.
    pub fn new(picture: &'a mut Picture, theme: Theme, font: f32) -> Canvas<'a> {
        Canvas {
            picture,
            record: None,
            theme,
            font,
            taken: Vec::new(),
            lacking: BTreeSet::new(),
            #[cfg(test)]
            texts: Vec::new(),
        }
    }

    /// Records shapes apart from the picture, behind those of `begun`. What is drawn behind the picture, and colours that are given pixel by
    /// pixel, belong to the picture under the shapes.
    pub fn recording(self, begun: Annotation) -> Canvas<'a> {
        Canvas { record: Some(begun), ..self }
    }

    /// The recorded shapes; none where they are not recorded.
    pub fn into_record(self) -> Option<Annotation> {
        self.record
    }

    /// Width and height of the picture.
    pub fn size(&self) -> [f32; 2] {
        [self.picture.width as f32, self.picture.height as f32]
    }

    /// Height of letters: the font's size, pixels.
    pub fn font(&self) -> f32 {
        self.font
    }

    /// Colours of text and lines.
    pub fn theme(&self) -> Theme {
        self.theme
    }

    /// Letters of what was written that the font lacks: a box stands for each.
    pub fn lacking(&self) -> String {
        self.lacking.iter().collect()
    }

    /// True if a rectangle is within the picture, with a margin, and nothing of it is taken.
    pub fn is_free(&self, [from, to]: Rectangle) -> bool {
        let margin = 0.3 * self.font;
        let size = self.size();
        let is_within = (0..2).all(|k| from[k] >= margin && to[k] <= size[k] - margin);
        is_within
            && self.taken.iter().all(|[low, high]| (0..2).any(|k| to[k] <= low[k] || from[k] >= high[k]))
    }

    /// Takes a rectangle; false where it is not free.
    pub fn take(&mut self, rectangle: Rectangle) -> bool {
        let is_free = self.is_free(rectangle);
        if is_free {
            self.taken.push(rectangle);
        }
        is_free
    }

    /// The rectangle of a text whose digits' middle is at the place's height.
    pub fn place_of(&self, text: &str, at: Place, align: Align) -> Rectangle {
        let width = text_width(text, self.font);
        let left = match align {
            Align::Start => at[0],
            Align::Middle => at[0] - 0.5 * width,
            Align::End => at[0] - width,
        };
        let half = 0.5 * LEADING * self.font;
        [[left, at[1] - half], [left + width, at[1] + half]]
    }

    /// Writes a text, middle of its digits at the place's height.
    pub fn text(&mut self, text: &str, at: Place, align: Align) {
        let rectangle = self.place_of(text, at, align);
        #[cfg(test)]
        self.texts.push((text.into(), rectangle));
        self.lacking.extend(text.chars().filter(|letter| FONT.glyph_index(*letter).is_none()));
        let path = outline(text, [rectangle[0][0], at[1] + 0.36 * self.font], self.font);
        let Theme { ink, rim } = self.theme;
        self.draw(ShapeForm::Outline { path: path.clone(), width: 0.2 * self.font }, rim, RIM);
        self.draw(ShapeForm::Area(path), ink, 1.0);
    }

    /// Writes a title and a text below it in the middle of the upper border, in as many lines as they take. Gives the lower end; `None`
    /// where they take more than a third of the picture.
    pub fn heading(&mut self, title: &str, text: &str) -> Option<f32> {
        let [width, height] = self.size();
        let own = self.font;
        let parts = [(title, 1.25 * own), (text, own)]
            .map(|(text, font)| (lines(text, font, width - 2.0 * own), font));
        let whole: f32 = parts.iter().map(|(lines, font)| lines.len() as f32 * LEADING * font).sum();
        if whole > height / 3.0 {
            return None;
        }
        let mut top = if whole > 0.0 { 0.4 * own } else { 0.0 };
        for (lines, font) in parts {
            self.font = font;
            for line in lines {
                let at = [0.5 * width, top + 0.5 * LEADING * font];
                self.taken.push(self.place_of(&line, at, Align::Middle));
                self.text(&line, at, Align::Middle);
                top += LEADING * font;
            }
        }
        self.font = own;
        Some(top)
    }

    /// Draws a line with a rim.
    pub fn line(&mut self, from: Place, to: Place) {
        self.ink_lines(&[[from, to]]);
    }

    /// Draws a line with a rim where nothing is taken.
    pub fn line_around(&mut self, from: Place, to: Place) {
        self.ink_lines(&outside([from, to], &self.taken));
    }

    /// Draws a line behind what the picture shows, where nothing is taken.
    pub fn line_behind(&mut self, from: Place, to: Place, opacity: f32) {
        let (ink, width) = (self.theme.ink, self.line_width());
        let ground = self.record.as_mut().map(|record| &mut record.ground);
        for picture in ground.into_iter().chain([&mut *self.picture]) {
            for part in outside([from, to], &self.taken) {
                draw_line(picture, part, width, |pixel, share| {
                    let behind = visible_share(ink, share) * opacity;
                    over(pixel, [behind * ink[0], behind * ink[1], behind * ink[2], behind])
                });
            }
        }
    }

    fn ink_lines(&mut self, lines: &[[Place; 2]]) {
        let (width, Theme { ink, rim }) = (self.line_width(), self.theme);
        for (width, color, opacity) in [(2.0 * width + 1.0, rim, 0.5 * RIM), (width, ink, 1.0)] {
            lines.iter().for_each(|ends| self.draw(ShapeForm::Line { ends: *ends, width }, color, opacity));
        }
    }

    /// Draws the border of a rectangle.
    pub fn frame(&mut self, [[left, top], [right, bottom]]: Rectangle) {
        let (width, ink) = (self.line_width(), self.theme.ink);
        let half = 0.5 * width;
        for ends in [
            [[left - half, top], [right + half, top]],
            [[left - half, bottom], [right + half, bottom]],
            [[left, top], [left, bottom]],
            [[right, top], [right, bottom]],
        ] {
            self.draw(ShapeForm::Line { ends, width }, ink, 1.0);
        }
    }

    /// Draws a form in a linear colour.
    pub fn draw(&mut self, form: ShapeForm, color: [f32; 3], opacity: f32) {
        let shape = Shape { form, color, opacity };
        draw(self.picture, &shape);
        if let Some(record) = &mut self.record {
            record.shapes.push(shape);
        }
    }

    fn line_width(&self) -> f32 {
        (LINE * self.font).max(1.0)
    }

    /// Sets the pixels of a rectangle, each to a premultiplied colour over what it shows. `color`: of the pixel's column and row within
    /// the rectangle.
    pub fn pixels(
        &mut self,
        [left, top]: [usize; 2],
        size: [usize; 2],
        color: impl Fn(usize, usize) -> [f32; 4],
    ) {
        let ground = self.record.as_mut().map(|record| &mut record.ground);
        for Picture { width, height, rgba } in ground.into_iter().chain([&mut *self.picture]) {
            for row in 0..size[1].min(height.saturating_sub(top)) {
                for column in 0..size[0].min(width.saturating_sub(left)) {
                    let pixel = &mut rgba[(top + row) * *width + left + column];
                    *pixel = over(color(column, row), *pixel);
                }
            }
        }
    }
}

/// Width of a text at a font's size.
pub fn text_width(text: &str, font: f32) -> f32 {
    let advance = |letter| FONT.glyph_hor_advance(FONT.glyph_index(letter).unwrap_or_default()).unwrap_or(0);
    let units: u32 = text.chars().map(|letter| u32::from(advance(letter))).sum();
    units as f32 * font / f32::from(FONT.units_per_em())
}

/// A text in lines of at most a width, broken at spaces, and within words that are longer.
pub fn lines(text: &str, font: f32, width: f32) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            let with = if line.is_empty() { word.to_string() } else { format!("{line} {word}") };
            if text_width(&with, font) <= width {
                line = with;
                continue;
            }
            if !line.is_empty() {
                lines.push(std::mem::take(&mut line));
            }
            for letter in word.chars() {
                if !line.is_empty() && text_width(&format!("{line}{letter}"), font) > width {
                    lines.push(std::mem::take(&mut line));
                }
                line.push(letter);
            }
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

fn outline(text: &str, [x, y]: Place, font: f32) -> Arc<[PathStep]> {
    let mut pen =
        OutlinePath { path: Vec::new(), origin: [x, y], scale: font / f32::from(FONT.units_per_em()) };
    for letter in text.chars() {
        let glyph = FONT.glyph_index(letter).unwrap_or_default();
        FONT.outline_glyph(glyph, &mut pen);
        pen.origin[0] += f32::from(FONT.glyph_hor_advance(glyph).unwrap_or(0)) * pen.scale;
    }
    pen.path.into()
}

/// Turns outlines of letters, y up, into a path of the picture.
struct OutlinePath {
    path: Vec<PathStep>,
    origin: Place,
    scale: f32,
}

impl OutlinePath {
    fn at(&self, x: f32, y: f32) -> Place {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }
}

impl OutlineBuilder for OutlinePath {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.push(PathStep::Move(self.at(x, y)));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.push(PathStep::Line(self.at(x, y)));
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.push(PathStep::Quadratic(self.at(x1, y1), self.at(x, y)));
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.push(PathStep::Cubic(self.at(x1, y1), self.at(x2, y2), self.at(x, y)));
    }

    fn close(&mut self) {
        self.path.push(PathStep::Close);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str, font: f32) -> Picture {
        let mut picture = Picture::transparent(120, 40);
        Canvas::new(&mut picture, Theme::DARK, font).text(text, [60.0, 20.0], Align::Middle);
        picture
    }

    /// Pixels of ink, with their columns' and rows' ends.
    fn ink(picture: &Picture) -> [usize; 4] {
        let mut ends = [usize::MAX, 0, usize::MAX, 0];
        for (k, _) in picture.rgba.iter().enumerate().filter(|(_, pixel)| pixel[0] > 0.5) {
            let (x, y) = (k % picture.width, k / picture.width);
            ends = [ends[0].min(x), ends[1].max(x), ends[2].min(y), ends[3].max(y)];
        }
        ends
    }

    #[test]
    fn text_stands_where_it_is_told_and_is_as_wide_as_it_says() {
        let [left, right, top, bottom] = ink(&written("10", 20.0));
        let width = text_width("10", 20.0);
        assert!(
            (left as f32 + right as f32 - 119.0).abs() < 4.0 && (right - left) as f32 <= width,
            "{left} {right}"
        );
        assert!((top as f32 + bottom as f32 - 39.0).abs() <= 2.0, "{top} {bottom}");
        // Digits are 0.73 of the font's size high.
        assert!((bottom - top).abs_diff(14) <= 1, "{top} {bottom}");
        assert_eq!(ink(&written("", 20.0))[0], usize::MAX);
    }

    #[test]
    fn letters_that_the_font_lacks_are_named() {
        let mut picture = Picture::transparent(200, 40);
        let mut canvas = Canvas::new(&mut picture, Theme::DARK, 10.0);
        canvas.text("∇T [K/mm] × 10⁻³ µ Ω °C Größe Δx", [0.0, 20.0], Align::Start);
        assert_eq!(canvas.lacking(), "");
        canvas.text("T 温", [0.0, 20.0], Align::Start);
        assert_eq!(canvas.lacking(), "温");
    }

    #[test]
    fn a_line_behind_shows_where_the_picture_is_clear() {
        let mut picture = Picture::transparent(9, 3);
        picture.rgba[9 + 4] = [0.25, 0.0, 0.0, 1.0];
        Canvas::new(&mut picture, Theme::DARK, 12.0).line_behind([0.0, 1.5], [9.0, 1.5], 1.0);
        assert_eq!(picture.pixel(4, 1), [0.25, 0.0, 0.0, 1.0]);
        assert!(picture.pixel(2, 1)[3] > 0.9 && picture.pixel(2, 0)[3] == 0.0, "{:?}", picture.pixel(2, 1));
    }

    /// Shapes over the picture under them are the picture.
    #[test]
    fn recorded_shapes_are_what_is_drawn() {
        let mut picture = Picture { width: 60, height: 40, rgba: vec![[0.1, 0.2, 0.05, 0.4]; 2400] };
        let ground = picture.clone();
        let mut canvas = Canvas::new(&mut picture, Theme::DARK, 12.0)
            .recording(Annotation { ground: ground.clone(), shapes: Vec::new() });
        assert!(canvas.take([[30.0, 4.0], [40.0, 36.0]]));
        canvas.text("12 Ω", [20.0, 10.0], Align::Middle);
        canvas.line_around([2.0, 25.0], [58.0, 35.0]);
        canvas.line_behind([5.0, 2.0], [50.0, 38.0], 0.5);
        canvas.pixels([45, 4], [10, 8], |column, _| [column as f32 / 20.0, 0.0, 0.0, 0.5]);
        canvas.frame([[45.0, 4.0], [55.0, 12.0]]);
        let Annotation { ground: mut drawn, shapes } = canvas.into_record().unwrap();
        // Rim and ink of the text, of two parts of the line, and the frame's four sides.
        assert_eq!(shapes.len(), 2 + 4 + 4);
        assert_ne!(drawn, ground);
        shapes.iter().for_each(|shape| draw(&mut drawn, shape));
        let channels = drawn.rgba.as_flattened().iter().zip(picture.rgba.as_flattened());
        // Coats of paint in another order of brackets.
        assert!(channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max) < 1e-6);
    }

    /// At four times the size, letters have edges as narrow as at one: fewer of their pixels are mixed.
    #[test]
    fn text_is_sharp_at_every_size() {
        let mixed = |scale: usize| {
            let mut picture = Picture::transparent(120 * scale, 40 * scale);
            let (font, at) = (14.0 * scale as f32, [60.0, 20.0].map(|x: f32| x * scale as f32));
            Canvas::new(&mut picture, Theme { rim: Theme::DARK.ink, ..Theme::DARK }, font).text(
                "Ω 12.5",
                at,
                Align::Middle,
            );
            let inked = picture.rgba.iter().filter(|pixel| pixel[3] > 0.0).count();
            picture.rgba.iter().filter(|pixel| pixel[3] > 0.7 && pixel[3] < 0.99).count() as f64
                / inked as f64
        };
        assert!(
            mixed(2) < 0.7 * mixed(1) && mixed(4) < 0.7 * mixed(2),
            "{} {} {}",
            mixed(1),
            mixed(2),
            mixed(4)
        );
    }

    #[test]
    fn lines_break_at_spaces_and_within_long_words() {
        let width = text_width("one two", 10.0);
        assert_eq!(lines("one two three", 10.0, width), ["one two", "three"]);
        assert_eq!(lines("a\n\nb", 10.0, width), ["a", "b"]);
        let long = lines("velocity_magnitude_average", 10.0, width);
        assert!(long.len() > 2 && long.concat() == "velocity_magnitude_average", "{long:?}");
        assert!(long.iter().all(|line| text_width(line, 10.0) <= width));
    }

    #[test]
    fn what_is_taken_is_not_free() {
        let mut picture = Picture::transparent(100, 100);
        let mut canvas = Canvas::new(&mut picture, Theme::DARK, 10.0);
        assert!(canvas.take([[10.0, 10.0], [30.0, 30.0]]) && canvas.take([[30.0, 10.0], [40.0, 30.0]]));
        assert!(!canvas.take([[29.0, 29.0], [50.0, 50.0]]) && !canvas.is_free([[0.0, 50.0], [20.0, 60.0]]));
    }
}
