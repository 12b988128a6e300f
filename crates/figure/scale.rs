//! The scale of a picture's colours: a bar along s, or the plane of s and g.

use crate::canvas::{Align, Canvas, LEADING, Place, Rectangle, lines, text_width};
use crate::ticks::{Ticks, ticks};
use voltet_core::picture_parts::{PathStep, ShapeForm};
use voltet_core::transfer::AxisScale;

/// The side of the picture at which a scale stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Left.
    Left,
    /// Right.
    Right,
}

impl Side {
    /// The side across.
    pub fn opposite(self) -> Side {
        if self == Side::Left { Side::Right } else { Side::Left }
    }

    /// The left end of what is so wide, at this side of the picture.
    pub(crate) fn left(self, canvas: &Canvas, width: f32) -> f32 {
        let margin = 0.8 * canvas.font();
        if self == Side::Left { margin } else { canvas.size()[0] - margin - width }
    }
}

/// The border of the picture along which a level bar stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// Upper.
    Top,
    /// Lower.
    Bottom,
}

/// An axis with its name.
#[derive(Debug, Clone)]
pub struct NamedAxis {
    /// Quantity and unit, as a reader shall see them.
    pub name: String,
    /// Its scale.
    pub scale: AxisScale,
    /// Positions of its ends, the smaller first.
    pub range: [f64; 2],
}

impl NamedAxis {
    fn share(&self, position: f64) -> f32 {
        ((position - self.range[0]) / (self.range[1] - self.range[0])) as f32
    }

    /// As many ticks, at most so many, as have room for their labels along a length; `room`: of a label.
    fn ticks(&self, length: f32, most: usize, room: impl Fn(&str) -> f32) -> Ticks {
        let has_room = |ticks: &Ticks| {
            let widest = ticks.ticks.iter().map(|(_, label)| room(label)).fold(0.0, f32::max);
            ticks
                .ticks
                .windows(2)
                .all(|pair| length * (self.share(pair[1].0) - self.share(pair[0].0)) >= widest)
        };
        (1..=most).rev().map(|most| ticks(self.scale, self.range, most)).find(has_room).unwrap_or_default()
    }
}

/// Look of a range of values: its colour and how dense it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shade {
    /// Linear RGB; `None` where nothing is drawn.
    pub color: Option<[f32; 3]>,
    /// Extinction, in any unit.
    pub extinction: f64,
}

/// The least distance of two ticks of an upright axis, in font sizes.
const ROOM: f32 = 1.8;

/// Extinctions that differ by less, as a share of the largest, are the same.
const EVEN: f64 = 0.01;

/// A bar of colours: cells of a pixel each, from the low end of the axis on, and the curve of the extinction beside them.
struct Bar {
    /// The corner at the low end and away from the ticks: upright the lower left one, else the upper left one.
    origin: Place,
    /// True if values grow upward, false if to the right.
    is_upright: bool,
    /// Number of cells.
    length: usize,
    /// Width across.
    width: f32,
    /// Reach of the curve, away from the ticks; 0 without.
    curve: f32,
    shades: Vec<Shade>,
    max_extinction: f64,
}

impl Bar {
    /// A bar at no place yet. `shade`: look of the values of a cell.
    fn new(axis: &NamedAxis, length: f32, font: f32, shade: impl Fn([f64; 2]) -> Shade) -> Bar {
        let (length, [low, high]) = (length as usize, axis.range);
        let edge = |cell: usize| low + cell as f64 / length as f64 * (high - low);
        let shades: Vec<Shade> = (0..length).map(|cell| shade([edge(cell), edge(cell + 1)])).collect();
        let max_extinction = shades.iter().map(|shade| shade.extinction).fold(0.0, f64::max);
        let is_even = shades.iter().all(|shade| shade.extinction >= (1.0 - EVEN) * max_extinction);
        let curve = if is_even { 0.0 } else { (1.2 * font).round() };
        let width = (1.1 * font).round();
        Bar { origin: [0.0; 2], is_upright: true, length, width, curve, shades, max_extinction }
    }

    /// The place so far along the bar from its low end, and so far across it toward the ticks.
    fn place(&self, along: f32, across: f32) -> Place {
        let [x, y] = self.origin;
        if self.is_upright { [x + across, y - along] } else { [x + along, y + across] }
    }

    /// The rectangle from one length along the bar to another, of its whole width.
    fn rectangle(&self, from: f32, to: f32) -> Rectangle {
        let ([ax, ay], [bx, by]) = (self.place(from, 0.0), self.place(to, self.width));
        [[ax.min(bx), ay.min(by)], [ax.max(bx), ay.max(by)]]
    }

    /// Draws colours, curve and border.
    fn draw(&self, canvas: &mut Canvas) {
        if self.curve > 0.0 {
            let (ink, path) = (canvas.theme().ink, self.curve_path());
            canvas.draw(ShapeForm::Area(path.into()), ink, 0.6);
        }
        for (cell, shade) in self.shades.iter().enumerate() {
            let Some(color) = shade.color else { continue };
            // Under the next cell, too, so that no seam between the two is seen at any size.
            let is_coloured = |shade: &Shade| shade.color.is_some();
            let end = if self.shades.get(cell + 1).is_some_and(is_coloured) { cell + 2 } else { cell + 1 };
            canvas.draw(ShapeForm::Rectangle(self.rectangle(cell as f32, end as f32)), color, 1.0);
        }
        canvas.frame(self.rectangle(0.0, self.length as f32));
    }

    /// The curve of the extinction, from the bar's side outward.
    fn curve_path(&self) -> Vec<PathStep> {
        let mut path = vec![PathStep::Move(self.place(0.0, 0.0))];
        for (cell, shade) in self.shades.iter().enumerate() {
            let across = -self.curve * (shade.extinction / self.max_extinction) as f32;
            path.extend([cell, cell + 1].map(|along| PathStep::Line(self.place(along as f32, across))));
        }
        path.extend([PathStep::Line(self.place(self.length as f32, 0.0)), PathStep::Close]);
        path
    }

    /// Draws the ticks' marks and labels. `align`: of labels at their places, the middle of which are so many font sizes off the bar.
    fn draw_ticks(&self, canvas: &mut Canvas, axis: &NamedAxis, ticks: &Ticks, off: f32, align: Align) {
        let font = canvas.font();
        for (value, label) in &ticks.ticks {
            let along = self.length as f32 * axis.share(*value);
            canvas.line(self.place(along, self.width), self.place(along, self.width + 0.4 * font));
            canvas.text(label, self.place(along, self.width + off * font), align);
        }
    }

    /// The colours' first column and row and their numbers.
    fn pixels(&self) -> [[usize; 2]; 2] {
        let [[left, top], [right, bottom]] = self.rectangle(0.0, self.length as f32);
        [[left as usize, top as usize], [(right - left) as usize, (bottom - top) as usize]]
    }
}

/// Draws an upright bar whose pixels have the colours of the values that they stand for, with ticks, and the axis' name above it. Cell k of
/// n stands for the values from share k/n to share (k + 1)/n of the axis. Where extinctions differ, their curve stands to the left of the
/// bar. `top`: what is above is not for the bar.
///
/// Gives the colours' first column and row and their numbers; `None` where there is no room.
pub fn color_bar(
    canvas: &mut Canvas,
    side: Side,
    top: f32,
    axis: &NamedAxis,
    shade: impl Fn([f64; 2]) -> Shade,
) -> Option<[[usize; 2]; 2]> {
    let (font, [width, height]) = (canvas.font(), canvas.size());
    let name = lines(&axis.name, font, 0.45 * width);
    let room = height - 1.4 * font - top;
    let length = (0.6 * height).min(room - (name.len() + 1) as f32 * LEADING * font - 0.7 * font).floor();
    if length < 4.0 * font {
        return None;
    }
    let ticks = axis.ticks(length, 9, |_| ROOM * font);
    let labels = ticks.ticks.iter().map(|(_, label)| text_width(label, font)).fold(0.0, f32::max);
    let mut bar = Bar::new(axis, length, font, shade);
    let content = bar.curve + bar.width + 0.7 * font + labels;
    let names = name.iter().chain(&ticks.note).map(|line| text_width(line, font)).fold(0.0, f32::max);
    let block = content.max(names);
    let left = side.left(canvas, block);
    let head = (name.len() + usize::from(ticks.note.is_some())) as f32 * LEADING * font + 0.7 * font;
    let above = top + 0.5 * (room - head - length) + 0.3 * font;
    let first = (above + head).round();
    if !canvas.take([[left, above], [left + block, first + length + 0.65 * font]]) {
        return None;
    }
    let (named_at, align, bar_left) = match side {
        Side::Left => (left, Align::Start, (left + bar.curve).round()),
        Side::Right => (left + block, Align::End, (left + block - content + bar.curve).round()),
    };
    for (k, line) in name.iter().chain(&ticks.note).enumerate() {
        canvas.text(line, [named_at, above + (k as f32 + 0.5) * LEADING * font], align);
    }
    bar.origin = [bar_left, first + length];
    bar.draw(canvas);
    bar.draw_ticks(canvas, axis, &ticks, 0.7, Align::Start);
    Some(bar.pixels())
}

/// Draws a level bar in the middle of a border, as [`color_bar`] draws an upright one: values grow to the right, the name is above, the
/// curve of the extinction between the two.
pub fn level_color_bar(
    canvas: &mut Canvas,
    border: Border,
    top: f32,
    axis: &NamedAxis,
    shade: impl Fn([f64; 2]) -> Shade,
) -> Option<[[usize; 2]; 2]> {
    let (font, [width, height]) = (canvas.font(), canvas.size());
    let length = (0.5 * width).floor();
    if length < 4.0 * font {
        return None;
    }
    let ticks = axis.ticks(length, 9, |label| text_width(label, font) + 0.8 * font);
    let widest = ticks.ticks.iter().map(|(_, label)| text_width(label, font)).fold(0.0, f32::max);
    let note = ticks.note.as_ref().map_or(String::new(), |note| format!("  {note}"));
    let name = lines(&format!("{}{note}", axis.name), font, 0.8 * width);
    let mut bar = Bar::new(axis, length, font, shade);
    let head = name.len() as f32 * LEADING * font + 0.3 * font + bar.curve;
    let block_height = head + bar.width + 2.0 * font;
    let above = match border {
        Border::Top => top + 0.4 * font,
        Border::Bottom => height - 0.4 * font - block_height,
    };
    let names = name.iter().map(|line| text_width(line, font)).fold(0.0, f32::max);
    let half = 0.5 * names.max(length + widest);
    let middle = 0.5 * width;
    if above < top || !canvas.take([[middle - half, above], [middle + half, above + block_height]]) {
        return None;
    }
    for (k, line) in name.iter().enumerate() {
        canvas.text(line, [middle, above + (k as f32 + 0.5) * LEADING * font], Align::Middle);
    }
    bar.is_upright = false;
    bar.origin = [(middle - 0.5 * length).round(), (above + head).round()];
    bar.draw(canvas);
    bar.draw_ticks(canvas, axis, &ticks, 1.3, Align::Middle);
    Some(bar.pixels())
}

/// Width and height of the plane of s and g in a picture of a width and height, pixels.
pub fn plane_size([width, height]: [f32; 2]) -> [f32; 2] {
    let length = (0.3 * width).min(0.45 * height).round();
    [length, (0.7 * length).round()]
}

/// Draws the plane of s and g in the lower corner of a side, s to the right and g upward, with ticks and names of both axes. `color`: the
/// premultiplied linear colour of a value of each.
///
/// Gives the colours' first column and row and their numbers; `None` where there is no room.
pub fn plane(
    canvas: &mut Canvas,
    side: Side,
    [s, g]: [&NamedAxis; 2],
    color: impl Fn([f64; 2]) -> [f32; 4],
) -> Option<[[usize; 2]; 2]> {
    let (font, size) = (canvas.font(), canvas.size());
    let [width, height] = plane_size(size);
    if height < 4.0 * font {
        return None;
    }
    let along_s = s.ticks(width, 5, |label| text_width(label, font) + 0.8 * font);
    let along_g = g.ticks(height, 5, |_| ROOM * font);
    let widest =
        |ticks: &Ticks| ticks.ticks.iter().map(|(_, label)| text_width(label, font)).fold(0.0, f32::max);
    // Half of a label may stand out to the right.
    let block = widest(&along_g).max(0.5 * widest(&along_s)) + 0.7 * font + width + 0.5 * widest(&along_s);
    let name = |axis: &NamedAxis, ticks: &Ticks| {
        let note = ticks.note.as_ref().map_or(String::new(), |note| format!("  {note}"));
        lines(&format!("{}{note}", axis.name), font, block)
    };
    let [name_s, name_g] = [name(s, &along_s), name(g, &along_g)];
    let leading = LEADING * font;
    let left = side.left(canvas, block);
    let below = 2.1 * font + name_s.len() as f32 * leading;
    let bottom = (size[1] - 0.6 * font - below).floor();
    let (x, y) = ((left + block - 0.5 * widest(&along_s) - width).floor(), bottom - height);
    let above = y - 0.75 * font - name_g.len() as f32 * leading;
    let around: Rectangle = [[left, above], [left + block, bottom + below]];
    if !canvas.take(around) {
        return None;
    }
    let value = |axis: &NamedAxis, share: f64| axis.range[0] + share * (axis.range[1] - axis.range[0]);
    let share = |k: usize, n: f32| (k as f64 + 0.5) / f64::from(n);
    let place = [[x as usize, y as usize], [width as usize, height as usize]];
    canvas.pixels(place[0], place[1], |column, row| {
        color([value(s, share(column, width)), value(g, 1.0 - share(row, height))])
    });
    canvas.frame([[x, y], [x + width, bottom]]);
    for (value, label) in &along_s.ticks {
        let at = x + width * s.share(*value);
        canvas.line([at, bottom], [at, bottom + 0.4 * font]);
        canvas.text(label, [at, bottom + 1.35 * font], Align::Middle);
    }
    for (value, label) in &along_g.ticks {
        let at = bottom - height * g.share(*value);
        canvas.line([x - 0.4 * font, at], [x, at]);
        canvas.text(label, [x - 0.7 * font, at], Align::End);
    }
    for (k, line) in name_s.iter().enumerate() {
        canvas.text(line, [left + block, bottom + 2.1 * font + (k as f32 + 0.5) * leading], Align::End);
    }
    for (k, line) in name_g.iter().enumerate() {
        canvas.text(line, [left, above + (k as f32 + 0.5) * leading], Align::Start);
    }
    Some(place)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Theme;
    use voltet_core::picture::Picture;

    fn axis(range: [f64; 2]) -> NamedAxis {
        NamedAxis { name: "Temperature [°C]".into(), scale: AxisScale::Linear, range }
    }

    /// A measured pixel of the bar has the colour of the value that the ticks give it.
    #[test]
    fn a_bars_pixels_are_the_colours_of_their_values() {
        let mut picture = Picture::transparent(400, 300);
        let mut canvas = Canvas::new(&mut picture, Theme::DARK, 11.0);
        let color = |s: f64| [s as f32 / 80.0, 0.0, 0.5];
        let shade = |[low, high]: [f64; 2]| Shade { color: Some(color(0.5 * (low + high))), extinction: 1.0 };
        let place = color_bar(&mut canvas, Side::Right, 20.0, &axis([20.0, 80.0]), shade);
        let [[left, top], [width, rows]] = place.unwrap();
        for row in 1..rows - 1 {
            let [r, g, b] = color(80.0 - (row as f64 + 0.5) / rows as f64 * 60.0);
            let found = picture.pixel(left + width / 2, top + row);
            assert!(found.iter().zip([r, g, b, 1.0]).all(|(a, b)| (a - b).abs() < 1e-6), "{row} {found:?}");
        }
    }

    /// As [`a_bars_pixels_are_the_colours_of_their_values`], from left to right; columns without colour stay clear.
    #[test]
    fn a_level_bars_pixels_are_the_colours_of_their_values() {
        for (border, above) in [(Border::Top, true), (Border::Bottom, false)] {
            let mut picture = Picture::transparent(400, 300);
            let mut canvas = Canvas::new(&mut picture, Theme::DARK, 11.0);
            let color = |s: f64| [s as f32 / 80.0, 0.0, 0.5];
            let shade = |[low, high]: [f64; 2]| Shade {
                color: (low >= 50.0).then(|| color(0.5 * (low + high))),
                extinction: 1.0,
            };
            let place = level_color_bar(&mut canvas, border, 20.0, &axis([20.0, 80.0]), shade);
            let [[left, top], [columns, rows]] = place.unwrap();
            assert_eq!((columns, top < 150), (200, above));
            for column in 2..columns - 2 {
                let value = 20.0 + (column as f64 + 0.5) / columns as f64 * 60.0;
                let [r, g, b] = color(value);
                let wanted = if value > 50.0 { [r, g, b, 1.0] } else { [0.0; 4] };
                let found = picture.pixel(left + column, top + rows / 2);
                assert!(found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6), "{column} {found:?}");
            }
        }
    }

    /// The curve beside the bar is as wide as the extinction is high; an even one has none.
    #[test]
    fn extinction_stands_beside_the_bar() {
        let drawn = |extinction: fn(f64) -> f64| {
            let mut picture = Picture::transparent(400, 300);
            let mut canvas = Canvas::new(&mut picture, Theme::DARK, 10.0);
            let shade = |[low, _]: [f64; 2]| Shade { color: Some([1.0; 3]), extinction: extinction(low) };
            let place = color_bar(&mut canvas, Side::Right, 0.0, &axis([0.0, 1.0]), shade).unwrap();
            let [[left, top], [_, rows]] = place;
            let width =
                |row: usize| (left - 14..left - 1).map(|i| picture.pixel(i, top + row)[3]).sum::<f32>() / 0.6;
            [width(rows / 4), width(3 * rows / 4)]
        };
        let [high, low] = drawn(|s| s);
        assert!((high - 8.0).abs() < 1.0 && (low - 2.0).abs() < 1.0, "{high} {low}");
        assert_eq!(drawn(|_| 3.0), [0.0; 2]);
    }
}
