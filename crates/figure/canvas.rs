//! Lines, rectangles and text over a picture, in linear light.

use std::sync::LazyLock;
use ttf_parser::{Face, OutlineBuilder};
use voltet_core::picture::Picture;
use zeno::{Command, Fill, Mask, PathBuilder, Stroke, Style};

/// Place in the picture, pixels from its upper left corner.
pub type Place = [f32; 2];

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

/// A picture that is written over.
#[derive(Debug)]
pub struct Canvas<'a> {
    /// The picture.
    pub picture: &'a mut Picture,
    /// Its colours.
    pub theme: Theme,
    /// Height of letters: the font's size, pixels.
    pub font: f32,
}

/// DejaVu Sans; its licence is beside it.
static FONT: LazyLock<Face<'static>> = LazyLock::new(|| {
    Face::parse(include_bytes!("font/dejavu-sans.ttf"), 0).expect("the font that is part of the program")
});

/// Width of lines as a share of the font's size.
const LINE: f32 = 0.08;

/// Opacity of the rim.
const RIM: f32 = 0.6;

impl Canvas<'_> {
    /// Width of the picture.
    pub fn width(&self) -> f32 {
        self.picture.width as f32
    }

    /// Height of the picture.
    pub fn height(&self) -> f32 {
        self.picture.height as f32
    }

    /// Width of a line.
    pub fn line_width(&self) -> f32 {
        (LINE * self.font).max(1.0)
    }

    /// Writes a text, middle of its digits at the place's height. Gives the part [left, right] that it takes.
    pub fn text(&mut self, text: &str, at: Place, align: Align) -> [f32; 2] {
        let width = text_width(text, self.font);
        let left = match align {
            Align::Start => at[0],
            Align::Middle => at[0] - 0.5 * width,
            Align::End => at[0] - width,
        };
        let outline = outline(text, [left, at[1] + 0.36 * self.font], self.font);
        let Theme { ink, rim } = self.theme;
        self.paint(&outline, Stroke::new(0.2 * self.font), rim, RIM);
        self.paint(&outline, Fill::NonZero, ink, 1.0);
        [left, left + width]
    }

    /// Draws a line with a rim.
    pub fn line(&mut self, from: Place, to: Place) {
        let (path, width) = (path(&[from, to]), self.line_width());
        self.paint(&path, Stroke::new(2.0 * width + 1.0), self.theme.rim, 0.5 * RIM);
        self.paint(&path, Stroke::new(width), self.theme.ink, 1.0);
    }

    /// Draws the border of a rectangle.
    pub fn frame(&mut self, [left, top]: Place, [right, bottom]: Place) {
        let mut border = path(&[[left, top], [right, top], [right, bottom], [left, bottom]]);
        border.push(Command::Close);
        let width = self.line_width();
        self.paint(&border, Stroke::new(width), self.theme.ink, 1.0);
    }

    /// Draws lines behind whatever the picture shows.
    pub fn line_behind(&mut self, from: Place, to: Place, opacity: f32) {
        let (path, width, ink) = (path(&[from, to]), self.line_width(), self.theme.ink);
        self.cover(&path, Stroke::new(width), ink, |pixel, [r, g, b], share| {
            let behind = share * opacity * (1.0 - pixel[3]);
            [pixel[0] + behind * r, pixel[1] + behind * g, pixel[2] + behind * b, pixel[3] + behind]
        });
    }

    /// Sets the pixels of a rectangle, each to a premultiplied colour over what it shows. `color`: of the pixel's column and row within
    /// the rectangle.
    pub fn pixels(
        &mut self,
        [left, top]: [usize; 2],
        size: [usize; 2],
        color: impl Fn(usize, usize) -> [f32; 4],
    ) {
        let Picture { width, height, rgba } = &mut *self.picture;
        for row in 0..size[1].min(height.saturating_sub(top)) {
            for column in 0..size[0].min(width.saturating_sub(left)) {
                let pixel = &mut rgba[(top + row) * *width + left + column];
                *pixel = over(color(column, row), *pixel);
            }
        }
    }

    fn paint<'s>(&mut self, path: &[Command], style: impl Into<Style<'s>>, color: [f32; 3], opacity: f32) {
        self.cover(path, style, color, |pixel, [r, g, b], share| {
            let share = share * opacity;
            over([share * r, share * g, share * b, share], pixel)
        });
    }

    /// Changes every pixel that a path covers by a share. Bright lines are thinned and dark ones thickened, as they are where the share
    /// mixes sRGB: in linear light bright letters look bold.
    fn cover<'s>(
        &mut self,
        path: &[Command],
        style: impl Into<Style<'s>>,
        color: [f32; 3],
        change: impl Fn([f32; 4], [f32; 3], f32) -> [f32; 4],
    ) {
        let (shares, place) = Mask::new(path).style(style).render();
        let is_bright = color[1] > 0.2;
        let [width, height] = [self.picture.width as i32, self.picture.height as i32];
        for (k, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0) {
            let (column, row) = (k as i32 % place.width as i32, k as i32 / place.width as i32);
            let (x, y) = (place.left + column, place.top + row);
            if (0..width).contains(&x) && (0..height).contains(&y) {
                let share = f32::from(share) / 255.0;
                let share = if is_bright { share.powf(1.5) } else { 1.0 - (1.0 - share).powf(1.5) };
                let pixel = &mut self.picture.rgba[(y * width + x) as usize];
                *pixel = change(*pixel, color, share);
            }
        }
    }
}

fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|channel| front[channel] + (1.0 - front[3]) * back[channel])
}

fn path(places: &[Place]) -> Vec<Command> {
    let mut path = Vec::new();
    for (k, &[x, y]) in places.iter().enumerate() {
        if k == 0 {
            path.move_to([x, y])
        } else {
            path.line_to([x, y])
        };
    }
    path
}

/// Width of a text at a font's size.
pub fn text_width(text: &str, font: f32) -> f32 {
    let advance = |letter| FONT.glyph_hor_advance(FONT.glyph_index(letter).unwrap_or_default()).unwrap_or(0);
    let units: u32 = text.chars().map(|letter| u32::from(advance(letter))).sum();
    units as f32 * font / f32::from(FONT.units_per_em())
}

/// The first letter of a text that the font lacks: a box stands for it.
pub fn lacking(text: &str) -> Option<char> {
    text.chars().find(|letter| FONT.glyph_index(*letter).is_none())
}

fn outline(text: &str, [x, y]: Place, font: f32) -> Vec<Command> {
    let mut pen = Pen { path: Vec::new(), origin: [x, y], scale: font / f32::from(FONT.units_per_em()) };
    for letter in text.chars() {
        let glyph = FONT.glyph_index(letter).unwrap_or_default();
        FONT.outline_glyph(glyph, &mut pen);
        pen.origin[0] += f32::from(FONT.glyph_hor_advance(glyph).unwrap_or(0)) * pen.scale;
    }
    pen.path
}

/// Turns outlines of letters, y up, into a path of the picture.
struct Pen {
    path: Vec<Command>,
    origin: Place,
    scale: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> Place {
        [self.origin[0] + self.scale * x, self.origin[1] - self.scale * y]
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.move_to(to);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.line_to(to);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (control, to) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(control, to);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (first, second, to) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.curve_to(first, second, to);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn written(text: &str, font: f32) -> Picture {
        let mut picture = Picture::transparent(120, 40);
        Canvas { picture: &mut picture, theme: Theme::DARK, font }.text(text, [60.0, 20.0], Align::Middle);
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
        assert_eq!(lacking("∇T [K/mm] × 10⁻³ µ Ω °C Größe Δx"), None);
        assert_eq!(lacking("T 温"), Some('温'));
    }

    #[test]
    fn a_line_behind_shows_where_the_picture_is_clear() {
        let mut picture = Picture::transparent(9, 3);
        picture.rgba[9 + 4] = [0.25, 0.0, 0.0, 1.0];
        Canvas { picture: &mut picture, theme: Theme::DARK, font: 12.0 }.line_behind(
            [0.0, 1.5],
            [9.0, 1.5],
            1.0,
        );
        assert_eq!(picture.pixel(4, 1), [0.25, 0.0, 0.0, 1.0]);
        assert!(picture.pixel(2, 1)[3] > 0.9 && picture.pixel(2, 0)[3] == 0.0, "{:?}", picture.pixel(2, 1));
    }
}
