//! Lines, rectangles and text over a picture, in linear light.

use std::collections::BTreeSet;
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

/// A rectangle: its upper left and its lower right corner.
pub type Rectangle = [Place; 2];

/// A picture that is written over. Parts of it that are taken are not written over again.
#[derive(Debug)]
pub struct Canvas<'a> {
    picture: &'a mut Picture,
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

/// Opacity of the rim.
const RIM: f32 = 0.6;

/// Distance from one line of a text to the next, in font sizes.
pub(crate) const LEADING: f32 = 1.3;

impl<'a> Canvas<'a> {
    /// A canvas with nothing taken. `font`: height of letters, the font's size in pixels.
    pub fn new(picture: &'a mut Picture, theme: Theme, font: f32) -> Canvas<'a> {
        Canvas {
            picture,
            theme,
            font,
            taken: Vec::new(),
            lacking: BTreeSet::new(),
            #[cfg(test)]
            texts: Vec::new(),
        }
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
        let outline = outline(text, [rectangle[0][0], at[1] + 0.36 * self.font], self.font);
        let Theme { ink, rim } = self.theme;
        self.paint(&outline, Stroke::new(0.2 * self.font), rim, RIM);
        self.paint(&outline, Fill::NonZero, ink, 1.0);
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
        self.ink(from, to, |_| false);
    }

    /// Draws a line with a rim where nothing is taken.
    pub fn line_around(&mut self, from: Place, to: Place) {
        let taken = self.taken.clone();
        self.ink(from, to, |at| holds(&taken, at));
    }

    /// Draws a line behind what the picture shows, where nothing is taken.
    pub fn line_behind(&mut self, from: Place, to: Place, opacity: f32) {
        let (taken, ink) = (self.taken.clone(), self.theme.ink);
        self.stroke(from, to, self.line_width(), |pixel, share, at| {
            let behind = if holds(&taken, at) { 0.0 } else { seen(ink, share) * opacity };
            over(pixel, [behind * ink[0], behind * ink[1], behind * ink[2], behind])
        });
    }

    fn ink(&mut self, from: Place, to: Place, is_left_out: impl Fn(Place) -> bool) {
        let (width, Theme { ink, rim }) = (self.line_width(), self.theme);
        for (width, color, opacity) in [(2.0 * width + 1.0, rim, 0.5 * RIM), (width, ink, 1.0)] {
            self.stroke(from, to, width, |pixel, share, at| match is_left_out(at) {
                true => pixel,
                false => paint(pixel, color, opacity * seen(color, share)),
            });
        }
    }

    /// Draws the border of a rectangle.
    pub fn frame(&mut self, [[left, top], [right, bottom]]: Rectangle) {
        let (width, ink) = (self.line_width(), self.theme.ink);
        let half = 0.5 * width;
        for [from, to] in [
            [[left - half, top], [right + half, top]],
            [[left - half, bottom], [right + half, bottom]],
            [[left, top], [left, bottom]],
            [[right, top], [right, bottom]],
        ] {
            self.stroke(from, to, width, |pixel, share, _| paint(pixel, ink, seen(ink, share)));
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
        let Picture { width, height, rgba } = &mut *self.picture;
        for row in 0..size[1].min(height.saturating_sub(top)) {
            for column in 0..size[0].min(width.saturating_sub(left)) {
                let pixel = &mut rgba[(top + row) * *width + left + column];
                *pixel = over(color(column, row), *pixel);
            }
        }
    }

    /// Changes the pixels of a line by the share of each that it covers, found from the distance of the pixel's centre.
    fn stroke(
        &mut self,
        from: Place,
        to: Place,
        width: f32,
        change: impl Fn([f32; 4], f32, Place) -> [f32; 4],
    ) {
        let (half, size) = (0.5 * width + 0.5, self.size());
        let around = [[-half; 2], [size[0] + half, size[1] + half]];
        let Some([from, to]) = clipped([from, to], around) else { return };
        let length = (to[0] - from[0]).hypot(to[1] - from[1]);
        if length == 0.0 {
            return;
        }
        let [x, y] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
        // Along the axis of its larger extent, and across it as far as it reaches.
        let (major, minor) = if x.abs() > y.abs() { (0, 1) } else { (1, 0) };
        let [slope, reach] = [[x, y][minor] / [x, y][major], half / [x, y][major].abs()];
        let pixels = |from: f32, to: f32, k: usize| {
            from.floor().max(0.0) as usize..to.ceil().clamp(0.0, size[k]) as usize
        };
        let ends = [from[major].min(to[major]) - half, from[major].max(to[major]) + half];
        for i in pixels(ends[0], ends[1], major) {
            let middle = from[minor] + slope * (i as f32 + 0.5 - from[major]);
            for j in pixels(middle - reach, middle + reach, minor) {
                let (column, row) = if major == 0 { (i, j) } else { (j, i) };
                let centre = [column as f32 + 0.5, row as f32 + 0.5];
                let [dx, dy] = [centre[0] - from[0], centre[1] - from[1]];
                let (along, across) = (dx * x + dy * y, (dx * y - dy * x).abs());
                let share = |depth: f32| (depth + 0.5).clamp(0.0, 1.0);
                let share = share(0.5 * width - across) * share(along) * share(length - along);
                let pixel = &mut self.picture.rgba[row * self.picture.width + column];
                *pixel = change(*pixel, share, centre);
            }
        }
    }

    /// Paints what a path covers.
    fn paint<'s>(&mut self, path: &[Command], style: impl Into<Style<'s>>, color: [f32; 3], opacity: f32) {
        let (shares, place) = Mask::new(path).style(style).render();
        let [width, height] = [self.picture.width as i32, self.picture.height as i32];
        for (k, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0) {
            let (column, row) = (k as i32 % place.width as i32, k as i32 / place.width as i32);
            let (x, y) = (place.left + column, place.top + row);
            if (0..width).contains(&x) && (0..height).contains(&y) {
                let pixel = &mut self.picture.rgba[(y * width + x) as usize];
                *pixel = paint(*pixel, color, opacity * seen(color, f32::from(share) / 255.0));
            }
        }
    }
}

/// True if a place lies in one of several rectangles.
fn holds(rectangles: &[Rectangle], at: Place) -> bool {
    rectangles.iter().any(|[low, high]| (0..2).all(|k| low[k] <= at[k] && at[k] < high[k]))
}

/// The opacity of ink that covers a share of a pixel: bright lines are thinned and dark ones thickened, as they are where the share
/// mixes sRGB. In linear light bright letters look bold.
fn seen(ink: [f32; 3], share: f32) -> f32 {
    if ink[1] > 0.2 { share.powf(1.5) } else { 1.0 - (1.0 - share).powf(1.5) }
}

fn paint(pixel: [f32; 4], [r, g, b]: [f32; 3], opacity: f32) -> [f32; 4] {
    over([opacity * r, opacity * g, opacity * b, opacity], pixel)
}

/// The part of a line within a rectangle (Liang and Barsky, A new concept and method for line clipping, 1984).
fn clipped(ends: [Place; 2], [low, high]: Rectangle) -> Option<[Place; 2]> {
    // An end may lie far outside.
    let [from, to] = ends.map(|end| end.map(f64::from));
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for k in 0..2 {
        let (by, low, high) = (to[k] - from[k], f64::from(low[k]), f64::from(high[k]));
        if by != 0.0 {
            let ends = [(low - from[k]) / by, (high - from[k]) / by];
            first = first.max(ends[0].min(ends[1]));
            last = last.min(ends[0].max(ends[1]));
        } else if !(low..=high).contains(&from[k]) {
            return None;
        }
    }
    let at = |share: f64| [0, 1].map(|k: usize| (from[k] + share * (to[k] - from[k])) as f32);
    (first < last).then(|| [at(first), at(last)])
}

fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|channel| front[channel] + (1.0 - front[3]) * back[channel])
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

fn outline(text: &str, [x, y]: Place, font: f32) -> Vec<Command> {
    let mut pen =
        OutlinePath { path: Vec::new(), origin: [x, y], scale: font / f32::from(FONT.units_per_em()) };
    for letter in text.chars() {
        let glyph = FONT.glyph_index(letter).unwrap_or_default();
        FONT.outline_glyph(glyph, &mut pen);
        pen.origin[0] += f32::from(FONT.glyph_hor_advance(glyph).unwrap_or(0)) * pen.scale;
    }
    pen.path
}

/// Turns outlines of letters, y up, into a path of the picture.
struct OutlinePath {
    path: Vec<Command>,
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

    /// A line of any slope, however far its ends lie outside, has an area of length × width.
    #[test]
    fn a_line_covers_its_width_and_ends_where_it_is_told() {
        let covered = |from, to| {
            let mut picture = Picture::transparent(60, 60);
            Canvas::new(&mut picture, Theme::LIGHT, 10.0).stroke(from, to, 2.0, |_, share, _| [share; 4]);
            picture
        };
        for to in [[50.0, 20.5], [20.5, 50.0], [48.0, 37.0], [41.0, 55.0]] {
            let from: Place = [20.5, 20.5];
            let area: f32 = covered(from, to).rgba.iter().map(|pixel| pixel[3]).sum();
            let length = (to[0] - from[0]).hypot(to[1] - from[1]);
            // A pixel's share is found from its distance alone, which is a few percent off for slanted edges.
            assert!((area / (2.0 * length) - 1.0).abs() < 0.06, "{to:?}: {area} of {}", 2.0 * length);
        }
        let far = covered([-1e8, 30.0], [1e8, 30.0]);
        assert!(far.rgba[29 * 60..31 * 60].iter().all(|pixel| pixel[3] == 1.0));
        assert!(far.rgba[..29 * 60].iter().all(|pixel| pixel[3] == 0.0));
        assert_eq!(covered([-5.0, -5.0], [70.0, -5.0]), Picture::transparent(60, 60));
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
