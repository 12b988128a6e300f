//! The scale of a picture's colours: a bar along s, or the plane of s and g.

use crate::canvas::{Align, Canvas, text_width};
use crate::ticks::{Ticks, ticks};

/// The side of the picture at which a colour bar stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

/// An axis with its name.
#[derive(Debug, Clone)]
pub struct NamedAxis {
    /// Quantity and unit, as a reader shall see them.
    pub name: String,
    /// Its ends, the smaller first.
    pub range: [f64; 2],
}

/// The least distance of two ticks, in font sizes.
const ROOM: f32 = 1.8;

/// Draws a bar whose pixels have the colours of the values that they stand for, with ticks, the axis' name above it. Row k of n stands
/// for the value in its middle. `color`: a value's premultiplied linear colour.
///
/// Gives the rectangle of the colours: its left upper corner and its size.
pub fn colour_bar(
    canvas: &mut Canvas,
    side: Side,
    axis: &NamedAxis,
    color: impl Fn(f64) -> [f32; 4],
) -> [[usize; 2]; 2] {
    let font = canvas.font;
    let length = (0.55 * canvas.height()).round().max(1.0);
    let width = (1.1 * font).round();
    let Ticks { ticks, note } = ticks(axis.range, (length / (ROOM * font)).clamp(2.0, 9.0) as usize);
    let of_labels = ticks.iter().map(|(_, label)| text_width(label, font)).fold(0.0, f32::max);
    let left = match side {
        Side::Left => font,
        Side::Right => canvas.width() - 1.9 * font - of_labels - width,
    };
    let left = left.round().max(0.0);
    let top = (0.5 * (canvas.height() - length) + font).round();
    let rows = length as usize;
    let [low, high] = axis.range;
    let place = |value: f64| top + length * ((high - value) / (high - low)) as f32;
    let value = |row: usize| high - (row as f64 + 0.5) / rows as f64 * (high - low);
    let rectangle = [[left as usize, top as usize], [width as usize, rows]];
    canvas.pixels(rectangle[0], rectangle[1], |_, row| color(value(row)));
    canvas.frame([left, top], [left + width, top + length]);
    for (value, label) in &ticks {
        let y = place(*value);
        canvas.line([left + width, y], [left + width + 0.4 * font, y]);
        canvas.text(label, [left + width + 0.7 * font, y], Align::Start);
    }
    let (at, align) = match side {
        Side::Left => (left, Align::Start),
        Side::Right => (canvas.width() - 0.8 * font, Align::End),
    };
    let above = top - 1.2 * font;
    if let Some(note) = &note {
        canvas.text(note, [at, above], align);
    }
    canvas.text(&axis.name, [at, above - if note.is_some() { 1.4 * font } else { 0.0 }], align);
    rectangle
}

/// Draws the plane of s and g in the lower right corner, s to the right and g upward, with ticks and names of both axes. `color`: a
/// place's premultiplied linear colour, by its shares of the two ranges.
///
/// Gives the rectangle of the colours: its left upper corner and its size.
pub fn plane(
    canvas: &mut Canvas,
    axes: &[NamedAxis; 2],
    color: impl Fn([f64; 2]) -> [f32; 4],
) -> [[usize; 2]; 2] {
    let font = canvas.font;
    let width = (0.3 * canvas.width()).min(0.45 * canvas.height()).round().max(1.0);
    let height = (0.7 * width).round().max(1.0);
    let left = (canvas.width() - width - 1.5 * font).round().max(0.0);
    let top = (canvas.height() - height - 3.6 * font).round().max(0.0);
    let (right, bottom) = (left + width, top + height);
    let rectangle = [[left as usize, top as usize], [width as usize, height as usize]];
    let share = |k: usize, n: f32| (k as f64 + 0.5) / f64::from(n);
    canvas.pixels(rectangle[0], rectangle[1], |column, row| {
        color([share(column, width), 1.0 - share(row, height)])
    });
    canvas.frame([left, top], [right, bottom]);
    let [s, g] = axes;
    let of = |axis: &NamedAxis, most: f32| ticks(axis.range, most.clamp(2.0, 5.0) as usize);
    let share_of =
        |axis: &NamedAxis, value: f64| ((value - axis.range[0]) / (axis.range[1] - axis.range[0])) as f32;
    let name = |axis: &NamedAxis, ticks: &Ticks| match &ticks.note {
        Some(note) => format!("{}  {note}", axis.name),
        None => axis.name.clone(),
    };
    let along_s = of(s, width / (4.0 * font));
    for (value, label) in &along_s.ticks {
        let x = left + width * share_of(s, *value);
        canvas.line([x, bottom], [x, bottom + 0.4 * font]);
        canvas.text(label, [x, bottom + 1.1 * font], Align::Middle);
    }
    canvas.text(&name(s, &along_s), [right, bottom + 2.5 * font], Align::End);
    let along_g = of(g, height / (ROOM * font));
    for (value, label) in &along_g.ticks {
        let y = bottom - height * share_of(g, *value);
        canvas.line([left - 0.4 * font, y], [left, y]);
        canvas.text(label, [left - 0.7 * font, y], Align::End);
    }
    canvas.text(&name(g, &along_g), [left, top - 1.0 * font], Align::Start);
    rectangle
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Theme;
    use voltet_core::picture::Picture;

    fn axis(range: [f64; 2]) -> NamedAxis {
        NamedAxis { name: "Temperature [°C]".into(), range }
    }

    /// Whoever measures a pixel of the bar finds the value that its ticks give it.
    #[test]
    fn a_bars_pixels_are_the_colours_of_their_values() {
        let mut picture = Picture::transparent(400, 300);
        let mut canvas = Canvas { picture: &mut picture, theme: Theme::DARK, font: 11.0 };
        let color = |s: f64| [s as f32 / 80.0, 0.0, 0.5, 1.0];
        let [[left, top], [width, rows]] = colour_bar(&mut canvas, Side::Right, &axis([20.0, 80.0]), color);
        for row in 1..rows - 1 {
            let value = 80.0 - (row as f64 + 0.5) / rows as f64 * 60.0;
            assert_eq!(picture.pixel(left + width / 2, top + row), color(value));
        }
    }

    #[test]
    fn nothing_is_cut_at_the_border() {
        for (width, height) in [(400, 300), (3840, 2160), (300, 400)] {
            let mut picture = Picture::transparent(width, height);
            let font = crate::font_size([width, height]);
            let mut canvas = Canvas { picture: &mut picture, theme: Theme::LIGHT, font };
            colour_bar(&mut canvas, Side::Left, &axis([-1e-7, 2.5e-7]), |_| [1.0; 4]);
            plane(&mut canvas, &[axis([101325.0, 101325.01]), axis([0.0, 3e5])], |_| [0.5, 0.5, 0.5, 1.0]);
            let border =
                |k: usize| k % width == 0 || k % width == width - 1 || k < width || k >= width * (height - 1);
            let cut = picture.rgba.iter().enumerate().find(|(k, pixel)| border(*k) && pixel[3] > 0.0);
            assert_eq!(cut, None, "{width} × {height}");
        }
    }
}
