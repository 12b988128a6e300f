//! A drawing of lines, symbols and text, written as SVG or painted into a picture.
//!
//! Coordinates: x to the right, y downward, in units of an SVG pixel. The picture has two pixels a unit, smoothed by the distance of each
//! pixel from the shapes' edges.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster};
use voltet_core::picture::Picture;
use voltet_io::encode::linear_from_srgb;

/// A drawing; what comes later lies on top.
#[derive(Debug, Clone)]
pub struct Canvas {
    /// Width and height.
    pub size: [f64; 2],
    /// Marks, the first at the bottom.
    pub marks: Vec<Mark>,
    /// Description for screen readers.
    pub title: String,
}

/// 8-bit sRGB.
pub type Color = [u8; 3];

pub const WHITE: Color = [255; 3];

/// Black, of text and outlines.
pub const BLACK: Color = [20, 20, 20];

/// Grey of grid lines.
const FAINT: Color = [225, 225, 225];

#[derive(Debug, Clone)]
pub enum Mark {
    Line {
        points: Vec<[f64; 2]>,
        width: f64,
        color: Color,
        /// Lengths of dashes and gaps, in turn; none for a whole line.
        dashes: &'static [f64],
    },
    Shape {
        corners: Vec<[f64; 2]>,
        fill: Color,
        outline: Color,
        /// Tooltip in viewers of SVG.
        hint: String,
    },
    /// A line of text, Latin-1.
    Text {
        /// Anchor position, on its middle line.
        at: [f64; 2],
        text: String,
        size: Size,
        /// Part of it at that position.
        anchor: Anchor,
        upward: bool,
        color: Color,
    },
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    Small,
    Large,
}

impl Size {
    /// Width of a character of labels and height of a line; both fonts are monospaced.
    pub const SMALL: [f64; 2] = [6.5, 12.0];
}

/// Part of a text at its anchor position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn start(self, width: f64) -> f64 {
        match self {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        }
    }
}

/// Shapes that can be told apart without colour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Symbol {
    Circle,
    Square,
    /// A square on its corner.
    Diamond,
    TriangleUp,
    TriangleDown,
    Plus,
    Cross,
    /// A star of five points, one up.
    Star,
    Bar,
}

impl Symbol {
    /// Its corners around a place.
    pub fn corners(self, at: [f64; 2], radius: f64) -> Vec<[f64; 2]> {
        let turned = |points: &[[f64; 2]], degrees: f64| -> Vec<[f64; 2]> {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let turn = |p: &[f64; 2]| {
                [at[0] + radius * (p[0] * cos - p[1] * sin), at[1] + radius * (p[0] * sin + p[1] * cos)]
            };
            points.iter().map(turn).collect()
        };
        let regular = |count: usize, first: f64| -> Vec<[f64; 2]> {
            let corner = |k: usize| {
                let (sin, cos) = (first + 360.0 * k as f64 / count as f64).to_radians().sin_cos();
                [at[0] + radius * cos, at[1] + radius * sin]
            };
            (0..count).map(corner).collect()
        };
        const B: f64 = 0.33;
        // One arm of a plus, the others by quarter turns.
        let plus = |degrees: f64| -> Vec<[f64; 2]> {
            let arm = [[-B, -B], [-B, -1.0], [B, -1.0]];
            (0..4).flat_map(|quarter| turned(&arm, degrees + 90.0 * f64::from(quarter))).collect()
        };
        match self {
            Symbol::Circle => regular(24, 0.0),
            Symbol::Square => regular(4, 45.0),
            Symbol::Diamond => regular(4, 0.0),
            Symbol::TriangleUp => regular(3, -90.0),
            Symbol::TriangleDown => regular(3, 90.0),
            Symbol::Plus => plus(0.0),
            Symbol::Cross => plus(45.0),
            Symbol::Star => {
                let (out, inner) = (regular(5, -90.0), regular(5, -54.0));
                let nearer = |p: &[f64; 2]| [0, 1].map(|i| at[i] + 0.4 * (p[i] - at[i]));
                out.iter().zip(&inner).flat_map(|(point, notch)| [*point, nearer(notch)]).collect()
            }
            Symbol::Bar => turned(&[[-1.0, -B], [1.0, -B], [1.0, B], [-1.0, B]], 0.0),
        }
    }
}

impl Canvas {
    pub fn new(size: [f64; 2], title: &str) -> Canvas {
        Canvas { size, marks: Vec::new(), title: title.into() }
    }

    pub fn line(&mut self, points: &[[f64; 2]], width: f64, color: Color, dashes: &'static [f64]) {
        self.marks.push(Mark::Line { points: points.to_vec(), width, color, dashes });
    }

    /// Draws a plane within two axes: lines and labels at their ticks, and its outline. `plane`: left, top, right, bottom.
    pub fn plane(&mut self, [x, y]: [&Axis; 2], [left, top, right, bottom]: [f64; 4]) {
        for (value, label) in x.ticks() {
            let place = x.place(value);
            if let Some(label) = label {
                self.line(&[[place, top], [place, bottom]], 1.0, FAINT, &[]);
                self.text([place, bottom + 16.0], &label, Size::Small, Anchor::Middle, BLACK);
            }
            self.line(&[[place, bottom], [place, bottom + 4.0]], 1.0, BLACK, &[]);
        }
        for (value, label) in y.ticks() {
            let place = y.place(value);
            if let Some(label) = label {
                self.line(&[[left, place], [right, place]], 1.0, FAINT, &[]);
                self.text([left - 8.0, place], &label, Size::Small, Anchor::End, BLACK);
            }
            self.line(&[[left - 4.0, place], [left, place]], 1.0, BLACK, &[]);
        }
        self.ring(vec![[left, top], [right, top], [right, bottom], [left, bottom]], 1.0, BLACK);
    }

    pub fn ring(&mut self, mut corners: Vec<[f64; 2]>, width: f64, color: Color) {
        corners.extend(corners.first().copied());
        self.line(&corners, width, color, &[]);
    }

    /// A filled shape. `hint`: tooltip in viewers of SVG.
    pub fn shape(&mut self, corners: Vec<[f64; 2]>, fill: Color, outline: Color, hint: String) {
        self.marks.push(Mark::Shape { corners, fill, outline, hint });
    }

    pub fn text(&mut self, at: [f64; 2], text: &str, size: Size, anchor: Anchor, color: Color) {
        self.marks.push(Mark::Text { at, text: text.into(), size, anchor, upward: false, color });
    }
}

/// An axis, linear or in powers of ten.
pub struct Axis {
    /// Its least value, or the decadic logarithm of it.
    pub low: f64,
    /// Its largest value, or the decadic logarithm of it.
    pub high: f64,
    start: f64,
    end: f64,
    scale: fn(f64) -> f64,
}

impl Axis {
    /// Linear between two values, whose places are given.
    pub fn linear([low, high]: [f64; 2], [start, end]: [f64; 2]) -> Axis {
        Axis { low, high, start, end, scale: |value| value }
    }

    /// Powers of ten: covers the values with some room, one power at least.
    pub fn over(values: impl Iterator<Item = f64>, start: f64, end: f64) -> Axis {
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for value in values.filter(|v| v.is_finite() && *v > 0.0) {
            (low, high) = (low.min(value.log10()), high.max(value.log10()));
        }
        if low > high {
            (low, high) = (-0.5, 0.5);
        }
        let room = (0.06 * (high - low)).max(0.5 * (1.0 - (high - low))).max(0.05);
        Axis { low: low - room, high: high + room, start, end, scale: f64::log10 }
    }

    pub fn place(&self, value: f64) -> f64 {
        let Axis { low, high, start, end, scale } = *self;
        let share = if high > low { (scale(value) - low) / (high - low) } else { 0.5 };
        start + share * (end - start)
    }

    /// Ticks with their labels: the powers of ten, between them 2 … 9, labelled where there is room.
    pub fn ticks(&self) -> Vec<(f64, Option<String>)> {
        let span = self.high - self.low;
        let mut ticks = Vec::new();
        for power in self.low.floor() as i32..=self.high.ceil() as i32 {
            for digit in 1..10 {
                let value = f64::from(digit) * 10f64.powi(power);
                if (self.low..=self.high).contains(&value.log10()) {
                    let labelled = digit == 1 || span < 2.2 && matches!(digit, 2 | 5);
                    ticks.push((value, labelled.then(|| number(digit, power))));
                }
            }
        }
        ticks
    }
}

/// digit × 10^power, as short as can be.
fn number(digit: i32, power: i32) -> String {
    match power {
        0..=4 => (i64::from(digit) * 10i64.pow(power as u32)).to_string(),
        -2..=-1 => format!("{:.*}", (-power) as usize, f64::from(digit) * 10f64.powi(power)),
        _ => format!("{digit}e{power}"),
    }
}

/// Text cut to this length, without characters that the font lacks (beyond Latin-1).
pub fn shown(text: &str, most: usize) -> String {
    let known = |c: char| matches!(c, ' '..='~' | '\u{a0}'..='\u{ff}');
    text.chars().map(|c| if known(c) { c } else { '?' }).take(most).collect()
}

impl Canvas {
    /// The SVG document; it names no file and no script.
    pub fn svg(&self) -> String {
        let [width, height] = self.size;
        let title = escaped(&self.title);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" role=\"img\" aria-label=\"{title}\" font-family=\"'Noto Sans Mono', 'DejaVu Sans Mono', \
             Menlo, Consolas, monospace\">\n<title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n"
        );
        self.marks.iter().for_each(|mark| svg += &element(mark));
        svg + "</svg>\n"
    }
}

fn element(mark: &Mark) -> String {
    match mark {
        Mark::Line { points, width, color, dashes } => {
            let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
            let dashes = match dashes.is_empty() {
                true => String::new(),
                false => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
            };
            let (points, color) = (places(points), hex(*color));
            format!(
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}/>\n"
            )
        }
        Mark::Shape { corners, fill, outline, hint } => {
            let hint = match hint.is_empty() {
                true => String::new(),
                false => format!("<title>{}</title>", escaped(hint)),
            };
            let (points, fill, stroke) = (places(corners), hex(*fill), hex(*outline));
            format!(
                "<polygon points=\"{points}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.4\">{hint}</polygon>\n"
            )
        }
        Mark::Text { at: [x, y], text, size, anchor, upward, color } => {
            let anchor = match anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let turn =
                if *upward { format!(" transform=\"rotate(-90 {x:.2} {y:.2})\"") } else { String::new() };
            let size = match size {
                Size::Small => 10.8,
                Size::Large => 14.2,
            };
            format!(
                "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
                 fill=\"{}\"{turn}>{}</text>\n",
                hex(*color),
                escaped(text)
            )
        }
    }
}

fn places(points: &[[f64; 2]]) -> String {
    points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

/// A colour as HTML writes it.
pub(crate) fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text that XML and HTML read as it is.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Pixels a unit.
const SCALE: f64 = 2.0;

/// Pixels being painted: sRGB, 0 … 1, as light adds up on screens that blend so.
struct Paper {
    size: [usize; 2],
    values: Vec<[f64; 3]>,
}

impl Canvas {
    pub fn picture(&self) -> Picture {
        let size = self.size.map(|x| (x * SCALE).ceil() as usize);
        let mut paper = Paper { size, values: vec![[1.0; 3]; size[0] * size[1]] };
        self.marks.iter().for_each(|mark| paint(&mut paper, mark));
        let linear = |v: &[f64; 3]| {
            let [r, g, b] = v.map(|x| linear_from_srgb(x as f32));
            [r, g, b, 1.0]
        };
        Picture { width: size[0], height: size[1], rgba: paper.values.iter().map(linear).collect() }
    }
}

fn paint(paper: &mut Paper, mark: &Mark) {
    let scaled =
        |points: &[[f64; 2]]| -> Vec<[f64; 2]> { points.iter().map(|p| p.map(|x| x * SCALE)).collect() };
    match mark {
        Mark::Line { points, width, color, dashes } => {
            let half = 0.5 * width * SCALE;
            for piece in dashed(&scaled(points), dashes) {
                paper.cover(&piece, half + 1.0, *color, |p| half - distance(p, &piece));
            }
        }
        Mark::Shape { corners, fill, outline, .. } => {
            let mut ring = scaled(corners);
            ring.extend(ring.first().copied());
            paper.cover(&ring, 1.0, *fill, |p| {
                if inside(p, &ring) { distance(p, &ring) } else { -distance(p, &ring) }
            });
            paper.cover(&ring, 3.0, *outline, |p| 0.7 * SCALE - distance(p, &ring));
        }
        Mark::Text { at, text, size, anchor, upward, color } => {
            // Noto Sans Mono, as its bitmaps are.
            let at = at.map(|x| x * SCALE);
            let height = match size {
                Size::Small => RasterHeight::Size24,
                Size::Large => RasterHeight::Size32,
            };
            let letters = || text.chars().filter_map(|c| get_raster(c, FontWeight::Regular, height));
            let width: usize = letters().map(|letter| letter.width()).sum();
            let mut along = anchor.start(width as f64);
            for letter in letters() {
                for (row, line) in letter.rows().enumerate() {
                    for (column, &cover) in line.iter().enumerate() {
                        let (u, v) = (along + column as f64, row as f64 - 0.5 * height.val() as f64);
                        let [x, y] = if *upward { [at[0] + v, at[1] - u] } else { [at[0] + u, at[1] + v] };
                        paper.blend(x.round() as i64, y.round() as i64, *color, f64::from(cover) / 255.0);
                    }
                }
                along += letter.width() as f64;
            }
        }
    }
}

impl Paper {
    fn blend(&mut self, x: i64, y: i64, color: Color, cover: f64) {
        let [width, height] = self.size.map(|n| n as i64);
        if (0..width).contains(&x) && (0..height).contains(&y) && cover > 0.0 {
            let value = &mut self.values[(y * width + x) as usize];
            for (v, c) in value.iter_mut().zip(color) {
                *v += cover.min(1.0) * (f64::from(c) / 255.0 - *v);
            }
        }
    }

    /// Paints the pixels around the points; `depth`: how far within the shape a place is, in pixels.
    fn cover(&mut self, points: &[[f64; 2]], margin: f64, color: Color, depth: impl Fn([f64; 2]) -> f64) {
        let end = |k: usize, f: fn(f64, f64) -> f64, start: f64| points.iter().map(|p| p[k]).fold(start, f);
        let low = |k: usize| (end(k, f64::min, f64::INFINITY) - margin).floor() as i64;
        let high = |k: usize| (end(k, f64::max, f64::NEG_INFINITY) + margin).ceil() as i64;
        for y in low(1)..=high(1) {
            for x in low(0)..=high(0) {
                let cover = depth([x as f64 + 0.5, y as f64 + 0.5]) + 0.5;
                self.blend(x, y, color, cover.clamp(0.0, 1.0));
            }
        }
    }
}

/// Distance of a place from a chain of straight lines.
fn distance([x, y]: [f64; 2], chain: &[[f64; 2]]) -> f64 {
    let to = |a: &[f64; 2], b: &[f64; 2]| {
        let (dx, dy) = (b[0] - a[0], b[1] - a[1]);
        let length = dx * dx + dy * dy;
        let t =
            if length > 0.0 { (((x - a[0]) * dx + (y - a[1]) * dy) / length).clamp(0.0, 1.0) } else { 0.0 };
        (x - a[0] - t * dx).hypot(y - a[1] - t * dy)
    };
    chain.windows(2).map(|pair| to(&pair[0], &pair[1])).fold(f64::INFINITY, f64::min)
}

/// True if a place is inside a closed chain: an odd number of its lines lies to the right.
fn inside([x, y]: [f64; 2], ring: &[[f64; 2]]) -> bool {
    let crosses = |a: &[f64; 2], b: &[f64; 2]| {
        (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0])
    };
    ring.windows(2).filter(|pair| crosses(&pair[0], &pair[1])).count() % 2 == 1
}

/// The straight pieces of a line: all of them, or its dashes.
fn dashed(points: &[[f64; 2]], dashes: &[f64]) -> Vec<[[f64; 2]; 2]> {
    let mut pieces = Vec::new();
    let (mut number, mut left) = (0, dashes.first().map_or(f64::INFINITY, |d| d * SCALE));
    for pair in points.windows(2) {
        let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
        let length = (bx - ax).hypot(by - ay);
        let mut done = 0.0;
        while done < length {
            let step = left.min(length - done);
            let at = |t: f64| [ax + (bx - ax) * t / length, ay + (by - ay) * t / length];
            if number % 2 == 0 {
                pieces.push([at(done), at(done + step)]);
            }
            done += step;
            left -= step;
            if left <= 0.0 {
                number += 1;
                left = dashes[number % dashes.len()] * SCALE;
            }
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short() {
        assert_eq!(number(2, 3), "2000");
        assert_eq!(number(5, -1), "0.5");
        assert_eq!(number(1, -4), "1e-4");
        assert_eq!(shown("52 °C → 1", 8), "52 °C ? ");
    }

    #[test]
    fn shapes_lines_and_text_fall_where_they_are_put() {
        let mut canvas = Canvas::new([40.0, 20.0], "");
        let black = [0; 3];
        canvas.line(&[[2.0, 2.5], [12.0, 2.5]], 1.0, black, &[]);
        let corners = Symbol::Square.corners([30.0, 10.0], 6.0);
        canvas.marks.push(Mark::Shape { corners, fill: [255, 0, 0], outline: black, hint: String::new() });
        canvas.text([4.0, 14.0], "I", Size::Small, Anchor::Start, black);
        let picture = canvas.picture();
        assert_eq!((picture.width, picture.height), (80, 40));
        assert_eq!(picture.pixel(60, 20), [1.0, 0.0, 0.0, 1.0]);
        // Two rows of pixels, and none beside them.
        assert_eq!([3, 4, 5, 6].map(|j| picture.pixel(15, j)[0]), [1.0, 0.0, 0.0, 1.0]);
        let dark = |i: usize, j: usize| picture.pixel(i, j)[0] < 0.5;
        assert!((8..24).any(|i| dark(i, 28)) && !(30..40).any(|i| dark(i, 28)));
        assert_eq!(WHITE, [255; 3]);
    }

    #[test]
    fn dashes_keep_their_share_around_corners() {
        let pieces = dashed(&[[0.0, 0.0], [30.0, 0.0], [30.0, 30.0]], &[3.0, 2.0]);
        let length: f64 = pieces.iter().map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum();
        // Whole periods of 10 pixels, of which 6 are drawn.
        assert!((length - 36.0).abs() < 1e-9, "{length}");
    }
}
