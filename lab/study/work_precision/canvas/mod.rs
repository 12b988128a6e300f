//! A drawing of lines, symbols and text, written as SVG or painted into a picture: the same from one description.
//!
//! Coordinates: x to the right, y downward, in units of an SVG pixel.

mod axis;
mod raster;
mod svg;

pub use axis::{Axis, shown};
pub(crate) use svg::escaped;

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

/// White, the paper.
pub const WHITE: Color = [255; 3];

/// Black, of text and outlines.
pub const BLACK: Color = [20, 20, 20];

/// Grey of grid lines.
const FAINT: Color = [225, 225, 225];

/// Something drawn.
#[derive(Debug, Clone)]
pub enum Mark {
    /// Straight lines from point to point.
    Line {
        /// The points.
        points: Vec<[f64; 2]>,
        /// Its width.
        width: f64,
        /// Its colour.
        color: Color,
        /// Lengths of dashes and gaps, in turn; none for a whole line.
        dashes: &'static [f64],
    },
    /// A closed shape.
    Shape {
        /// Its corners.
        corners: Vec<[f64; 2]>,
        /// The colour within.
        fill: Color,
        /// The colour of its outline.
        outline: Color,
        /// Tooltip in viewers of SVG.
        hint: String,
    },
    /// A line of text, Latin-1.
    Text {
        /// Anchor position, on its middle line.
        at: [f64; 2],
        /// The text.
        text: String,
        /// Its size.
        size: Size,
        /// Part of it at that position.
        anchor: Anchor,
        /// True if it runs upward.
        upward: bool,
        /// Its colour.
        color: Color,
    },
}

/// Size of text.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    /// Labels.
    Small,
    /// Titles.
    Large,
}

/// Part of a text at its anchor position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anchor {
    /// Its start.
    Start,
    /// Its middle.
    Middle,
    /// Its end.
    End,
}

impl Size {
    /// Width of a character; both fonts are monospaced.
    pub fn advance(self) -> f64 {
        match self {
            Size::Small => 6.5,
            Size::Large => 8.5,
        }
    }

    /// Height of a line.
    pub fn height(self) -> f64 {
        match self {
            Size::Small => 12.0,
            Size::Large => 16.0,
        }
    }
}

impl Anchor {
    /// Offset of the start of a text of this width from its anchor.
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
    /// A circle.
    Circle,
    /// A square.
    Square,
    /// A square on its corner.
    Diamond,
    /// A triangle, its corner up.
    TriangleUp,
    /// A triangle, its corner down.
    TriangleDown,
    /// A plus sign.
    Plus,
    /// A cross.
    Cross,
    /// A star of five points, one up.
    Star,
    /// A bar that lies.
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
        const PLUS: [[f64; 2]; 12] = [
            [-B, -1.0],
            [B, -1.0],
            [B, -B],
            [1.0, -B],
            [1.0, B],
            [B, B],
            [B, 1.0],
            [-B, 1.0],
            [-B, B],
            [-1.0, B],
            [-1.0, -B],
            [-B, -B],
        ];
        match self {
            Symbol::Circle => regular(24, 0.0),
            Symbol::Square => regular(4, 45.0),
            Symbol::Diamond => regular(4, 0.0),
            Symbol::TriangleUp => regular(3, -90.0),
            Symbol::TriangleDown => regular(3, 90.0),
            Symbol::Plus => turned(&PLUS, 0.0),
            Symbol::Cross => turned(&PLUS, 45.0),
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
    /// An empty one.
    pub fn new(size: [f64; 2], title: &str) -> Canvas {
        Canvas { size, marks: Vec::new(), title: title.into() }
    }

    /// A line.
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
        let ring = [[left, top], [right, top], [right, bottom], [left, bottom], [left, top]];
        self.line(&ring, 1.0, BLACK, &[]);
    }

    /// A line of text.
    pub fn text(&mut self, at: [f64; 2], text: &str, size: Size, anchor: Anchor, color: Color) {
        self.marks.push(Mark::Text { at, text: text.into(), size, anchor, upward: false, color });
    }
}
