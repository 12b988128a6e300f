//! Plots in SVG: lines, symbols, text and axes.
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

/// Width of a character of labels and height of a line; the font is monospaced.
pub const CHARACTER: [f64; 2] = [6.5, 12.0];

/// Part of a text at its anchor position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// Style of a series of points. Symbols and dashes tell them apart without colour; the colours (Okabe and Ito 2008) differ for the
/// colour-blind too.
#[derive(Debug, Clone, Copy)]
pub struct Style {
    /// Outline about 0 within a radius of 1, as SVG writes paths.
    pub symbol: &'static str,
    pub color: Color,
    /// Lengths of dashes and gaps of its line, in turn; none for a whole line.
    pub dashes: &'static [f64],
}

pub const CIRCLE: &str = "M1,0 A1,1 0 1 1 -1,0 A1,1 0 1 1 1,0 Z";
const DIAMOND: &str = "M0,-1 L1,0 L0,1 L-1,0 Z";
const TRIANGLE_UP: &str = "M0,-1 L0.87,0.5 H-0.87 Z";
const TRIANGLE_DOWN: &str = "M0,1 L-0.87,-0.5 H0.87 Z";
const PLUS: &str = "M-0.33,-0.33 V-1 H0.33 V-0.33 H1 V0.33 H0.33 V1 H-0.33 V0.33 H-1 V-0.33 Z";
const CROSS: &str = "M0,-0.47 L0.47,-0.94 L0.94,-0.47 L0.47,0 L0.94,0.47 L0.47,0.94 L0,0.47 L-0.47,0.94 L-0.94,0.47 L-0.47,0 \
                     L-0.94,-0.47 L-0.47,-0.94 Z";
const STAR: &str = "M0,-1 L0.24,-0.32 L0.95,-0.31 L0.38,0.12 L0.59,0.81 L0,0.4 L-0.59,0.81 L-0.38,0.12 L-0.95,-0.31 L-0.24,-0.32 Z";
const BAR: &str = "M-1,-0.33 H1 V0.33 H-1 Z";
const SQUARE: &str = "M-0.71,-0.71 H0.71 V0.71 H-0.71 Z";

/// Styles in the order of the series; those beyond begin again.
pub const STYLES: [Style; 9] = [
    Style { symbol: CIRCLE, color: [0, 0, 0], dashes: &[] },
    Style { symbol: DIAMOND, color: [0, 114, 178], dashes: &[] },
    Style { symbol: TRIANGLE_UP, color: [213, 94, 0], dashes: &[7.0, 3.0] },
    Style { symbol: TRIANGLE_DOWN, color: [0, 158, 115], dashes: &[2.0, 2.5] },
    Style { symbol: PLUS, color: [86, 180, 233], dashes: &[10.0, 3.0, 2.0, 3.0] },
    Style { symbol: CROSS, color: [190, 140, 0], dashes: &[4.0, 4.0] },
    Style { symbol: STAR, color: [150, 60, 60], dashes: &[] },
    Style { symbol: BAR, color: [90, 90, 160], dashes: &[6.0, 2.0] },
    Style { symbol: SQUARE, color: [204, 121, 167], dashes: &[] },
];

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

    /// A path as SVG writes it. `further`: attributes; `hint`: tooltip in viewers.
    fn path(&mut self, path: &str, fill: Option<Color>, line: (f64, Color), further: &str, hint: &str) {
        let fill = fill.map_or("none".into(), hex);
        let (width, color) = (line.0, hex(line.1));
        let hint = match hint.is_empty() {
            true => String::new(),
            false => format!("<title>{}</title>", escaped(hint)),
        };
        self.elements += &format!(
            "<path d=\"{path}\" fill=\"{fill}\" stroke=\"{color}\" stroke-width=\"{width:.2}\"{further}>{hint}</path>\n"
        );
    }

    /// A chain of straight lines. `dashes`: lengths of dashes and gaps, in turn; none for a whole line.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, color: Color, dashes: &[f64]) {
        let points: Vec<String> = points.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        let dashes: Vec<String> = dashes.iter().map(f64::to_string).collect();
        let dashes = match dashes.is_empty() {
            true => String::new(),
            false => format!(" stroke-dasharray=\"{}\"", dashes.join(" ")),
        };
        self.path(&format!("M{}", points.join(" L")), None, (width, color), &dashes, "");
    }

    /// A rectangle from left and top to right and bottom. `hint`: tooltip in viewers.
    pub fn rectangle(
        &mut self,
        [left, top, right, bottom]: [f64; 4],
        fill: Option<Color>,
        outline: Color,
        hint: &str,
    ) {
        let path = format!("M{left:.2},{top:.2} H{right:.2} V{bottom:.2} H{left:.2} Z");
        self.path(&path, fill, (1.0, outline), "", hint);
    }

    /// The symbol of a style, filled. `hint`: tooltip in viewers.
    pub fn symbol(&mut self, at: [f64; 2], radius: f64, style: &Style, fill: Color, hint: &str) {
        self.scaled(at, radius, style.symbol, Some(fill), (1.4, style.color), hint);
    }

    /// The outline of a symbol.
    pub fn ring(&mut self, at: [f64; 2], radius: f64, symbol: &str, width: f64, color: Color) {
        self.scaled(at, radius, symbol, None, (width, color), "");
    }

    fn scaled(
        &mut self,
        [x, y]: [f64; 2],
        radius: f64,
        symbol: &str,
        fill: Option<Color>,
        (width, color): (f64, Color),
        hint: &str,
    ) {
        let place = format!(" transform=\"translate({x:.2} {y:.2}) scale({radius})\"");
        self.path(symbol, fill, (width / radius, color), &place, hint);
    }

    /// A line of text with this part of it, on its middle line, at a place.
    pub fn text(&mut self, at: [f64; 2], text: &str, anchor: Anchor) {
        self.sized_text(at, text, 10.8, anchor, "");
    }

    /// A title that begins at a place.
    pub fn heading(&mut self, at: [f64; 2], text: &str) {
        self.sized_text(at, text, 14.2, Anchor::Start, "");
    }

    /// A label that reads upward, its middle at a place.
    pub fn upward_text(&mut self, at: [f64; 2], text: &str) {
        let turn = format!(" transform=\"rotate(-90 {:.2} {:.2})\"", at[0], at[1]);
        self.sized_text(at, text, 10.8, Anchor::Middle, &turn);
    }

    fn sized_text(&mut self, [x, y]: [f64; 2], text: &str, size: f64, anchor: Anchor, turn: &str) {
        let anchor = ["start", "middle", "end"][anchor as usize];
        let (color, text) = (hex(BLACK), escaped(text));
        self.elements += &format!(
            "<text x=\"{x:.2}\" y=\"{y:.2}\" dy=\"0.35em\" font-size=\"{size}\" text-anchor=\"{anchor}\" \
             fill=\"{color}\"{turn}>{text}</text>\n"
        );
    }

    /// Draws a plane within two axes: lines and labels at their ticks, and its outline. `plane`: left, top, right, bottom.
    pub fn plane(&mut self, [x, y]: [&Axis; 2], [left, top, right, bottom]: [f64; 4]) {
        for (value, label) in x.ticks() {
            let place = x.place(value);
            if let Some(label) = label {
                self.line(&[[place, top], [place, bottom]], 1.0, FAINT, &[]);
                self.text([place, bottom + 16.0], &label, Anchor::Middle);
            }
            self.line(&[[place, bottom], [place, bottom + 4.0]], 1.0, BLACK, &[]);
        }
        for (value, label) in y.ticks() {
            let place = y.place(value);
            if let Some(label) = label {
                self.line(&[[left, place], [right, place]], 1.0, FAINT, &[]);
                self.text([left - 8.0, place], &label, Anchor::End);
            }
            self.line(&[[left - 4.0, place], [left, place]], 1.0, BLACK, &[]);
        }
        self.rectangle([left, top, right, bottom], None, BLACK, "");
    }

    /// An entry of a legend: the symbol, on its line where it has one, and the name of a series.
    pub fn entry(&mut self, [x, y]: [f64; 2], style: &Style, has_line: bool, name: &str) {
        if has_line {
            self.line(&[[x, y], [x + 28.0, y]], 1.4, style.color, style.dashes);
        }
        self.symbol([x + 14.0, y], 5.0, style, WHITE, "");
        self.text([x + 34.0, y], name, Anchor::Start);
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
    fn series_are_told_apart_without_colour() {
        for (k, style) in STYLES.iter().enumerate() {
            assert!(STYLES[..k].iter().all(|other| other.symbol != style.symbol), "{}", style.symbol);
        }
    }

    #[test]
    fn what_is_drawn_stands_in_its_order_with_its_place_and_look() {
        let mut canvas = Canvas::new([40.0, 20.0], "a < b");
        canvas.line(&[[2.0, 2.5], [12.0, 2.5]], 1.5, [1, 2, 3], &[3.0, 2.5]);
        canvas.symbol([30.0, 10.0], 2.0, &STYLES[7], WHITE, "at & about");
        canvas.upward_text([4.0, 14.0], "I");
        let svg = canvas.svg();
        assert!(svg.contains("viewBox=\"0 0 40 20\"") && svg.contains("<title>a &lt; b</title>"), "{svg}");
        let elements: Vec<&str> = svg.lines().skip(3).collect();
        assert_eq!(
            elements,
            [
                "<path d=\"M2.00,2.50 L12.00,2.50\" fill=\"none\" stroke=\"#010203\" stroke-width=\"1.50\" \
                 stroke-dasharray=\"3 2.5\"></path>",
                "<path d=\"M-1,-0.33 H1 V0.33 H-1 Z\" fill=\"#ffffff\" stroke=\"#5a5aa0\" stroke-width=\"0.70\" \
                 transform=\"translate(30.00 10.00) scale(2)\"><title>at &amp; about</title></path>",
                "<text x=\"4.00\" y=\"14.00\" dy=\"0.35em\" font-size=\"10.8\" text-anchor=\"middle\" fill=\"#141414\" \
                 transform=\"rotate(-90 4.00 14.00)\">I</text>",
                "</svg>",
            ]
        );
    }
}
