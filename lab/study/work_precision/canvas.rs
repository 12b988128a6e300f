//! A drawing of lines, symbols and text in SVG, and the axes of plots.
//!
//! Coordinates: x to the right, y downward, in units of an SVG pixel.

/// A drawing; what comes later lies on top.
#[derive(Debug, Clone)]
pub struct Canvas {
    /// Width and height.
    size: [f64; 2],
    /// Description for screen readers.
    title: String,
    /// SVG elements, the first at the bottom.
    elements: String,
}

/// 8-bit sRGB.
pub type Color = [u8; 3];

pub const WHITE: Color = [255; 3];

/// Black, of text and outlines.
pub const BLACK: Color = [20, 20, 20];

/// Grey of grid lines.
const FAINT: Color = [225, 225, 225];

#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Size {
    Small,
    Large,
}

impl Size {
    /// Width of a character of labels and height of a line; the font is monospaced.
    pub const SMALL: [f64; 2] = [6.5, 12.0];
}

/// Part of a text at its anchor position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
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
        Canvas { size, title: escaped(title), elements: String::new() }
    }

    /// The SVG document; it names no file and no script.
    pub fn svg(&self) -> String {
        let Canvas { size: [width, height], title, elements } = self;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
             height=\"{height}\" role=\"img\" aria-label=\"{title}\" font-family=\"'Noto Sans Mono', 'DejaVu Sans Mono', \
             Menlo, Consolas, monospace\">\n<title>{title}</title>\n<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
             {elements}</svg>\n"
        )
    }

    /// A chain of straight lines. `dashes`: lengths of dashes and gaps, in turn; none for a whole line.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, color: Color, dashes: &[f64]) {
        let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
        let dashes = match dashes.is_empty() {
            true => String::new(),
            false => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
        };
        let (points, color) = (places(points), hex(color));
        self.elements += &format!(
            "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"{dashes}/>\n"
        );
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
    pub fn shape(&mut self, corners: &[[f64; 2]], fill: Color, outline: Color, hint: &str) {
        let hint = match hint.is_empty() {
            true => String::new(),
            false => format!("<title>{}</title>", escaped(hint)),
        };
        let (points, fill, stroke) = (places(corners), hex(fill), hex(outline));
        self.elements += &format!(
            "<polygon points=\"{points}\" fill=\"{fill}\" stroke=\"{stroke}\" stroke-width=\"1.4\">{hint}</polygon>\n"
        );
    }

    /// A line of text with this part of it, on its middle line, at a place.
    pub fn text(&mut self, at: [f64; 2], text: &str, size: Size, anchor: Anchor, color: Color) {
        self.turned_text(at, text, size, anchor, color, "");
    }

    /// A label that reads upward, its middle at a place.
    pub fn upward_text(&mut self, at: [f64; 2], text: &str) {
        let turn = format!(" transform=\"rotate(-90 {:.2} {:.2})\"", at[0], at[1]);
        self.turned_text(at, text, Size::Small, Anchor::Middle, BLACK, &turn);
    }

    fn turned_text(
        &mut self,
        [x, y]: [f64; 2],
        text: &str,
        size: Size,
        anchor: Anchor,
        color: Color,
        turn: &str,
    ) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let size = match size {
            Size::Small => 10.8,
            Size::Large => 14.2,
        };
        let (color, text) = (hex(color), escaped(text));
        self.elements += &format!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
             fill=\"{color}\"{turn}>{text}</text>\n"
        );
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

/// Text cut to this many characters.
pub fn shown(text: &str, most: usize) -> String {
    text.chars().take(most).collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_short() {
        assert_eq!(number(2, 3), "2000");
        assert_eq!(number(5, -1), "0.5");
        assert_eq!(number(1, -4), "1e-4");
        assert_eq!(shown("52 °C → 1", 8), "52 °C → ");
    }

    #[test]
    fn what_is_drawn_stands_in_its_order_with_its_place_and_look() {
        let mut canvas = Canvas::new([40.0, 20.0], "a < b");
        canvas.line(&[[2.0, 2.5], [12.0, 2.5]], 1.5, [1, 2, 3], &[3.0, 2.5]);
        canvas.shape(&Symbol::Diamond.corners([30.0, 10.0], 6.0), WHITE, BLACK, "at & about");
        canvas.upward_text([4.0, 14.0], "I");
        let svg = canvas.svg();
        assert!(svg.contains("viewBox=\"0 0 40 20\"") && svg.contains("<title>a &lt; b</title>"), "{svg}");
        let elements: Vec<&str> = svg.lines().skip(3).collect();
        assert_eq!(
            elements,
            [
                "<polyline points=\"2.00,2.50 12.00,2.50\" fill=\"none\" stroke=\"#010203\" stroke-width=\"1.5\" \
                 stroke-dasharray=\"3 2.5\"/>",
                "<polygon points=\"36.00,10.00 30.00,16.00 24.00,10.00 30.00,4.00\" fill=\"#ffffff\" stroke=\"#141414\" \
                 stroke-width=\"1.4\"><title>at &amp; about</title></polygon>",
                "<text x=\"4.00\" y=\"14.00\" dy=\"0.35em\" font-size=\"10.8\" text-anchor=\"middle\" fill=\"#141414\" \
                 transform=\"rotate(-90 4.00 14.00)\">I</text>",
                "</svg>",
            ]
        );
    }
}
