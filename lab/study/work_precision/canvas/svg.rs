//! A canvas as SVG.

use super::{Anchor, Canvas, Color, Mark, Size};
use std::fmt::Write;

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
            format!(
                "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{width}\"{dashes}/>\n",
                places(points),
                hex(*color)
            )
        }
        Mark::Shape { corners, fill, outline, hint } => {
            let hint = match hint.is_empty() {
                true => String::new(),
                false => format!("<title>{}</title>", escaped(hint)),
            };
            format!(
                "<polygon points=\"{}\" fill=\"{}\" stroke=\"{}\" stroke-width=\"1.4\">{hint}</polygon>\n",
                places(corners),
                hex(*fill),
                hex(*outline)
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
    let mut text = String::new();
    for [x, y] in points {
        // Writing to a String cannot fail.
        let _ = write!(text, "{x:.2},{y:.2} ");
    }
    text.trim_end().to_string()
}

fn hex([r, g, b]: Color) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text that XML and HTML read as it is.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
