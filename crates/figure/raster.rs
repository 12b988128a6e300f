//! Shapes to pixels, in linear light.

use voltet_core::picture::Picture;
use voltet_core::picture_parts::{PathStep, Place, Shape, ShapeForm};
use zeno::{Command, Fill, Mask, Stroke, Style};

pub(crate) fn draw(picture: &mut Picture, shape: &Shape) {
    let Shape { form, color, opacity } = shape;
    match form {
        ShapeForm::Line { ends, width } => draw_line(picture, *ends, *width, |pixel, share| {
            paint(pixel, *color, opacity * visible_share(*color, share))
        }),
        ShapeForm::Rectangle(corners) => draw_rectangle(picture, *corners, *color, *opacity),
        ShapeForm::Area(path) => draw_path(picture, path, Fill::NonZero, *color, *opacity),
        ShapeForm::Outline { path, width } => draw_path(picture, path, Stroke::new(*width), *color, *opacity),
    }
}

/// Changes the pixels of a line by the share of each that it covers, found from the distance of the pixel's centre.
pub(crate) fn draw_line(
    picture: &mut Picture,
    [from, to]: [Place; 2],
    width: f32,
    change: impl Fn([f32; 4], f32) -> [f32; 4],
) {
    let (half, size) = (0.5 * width + 0.5, [picture.width as f32, picture.height as f32]);
    let around = [[-half; 2], [size[0] + half, size[1] + half]];
    let Some([from, to]) = within([from, to], around) else { return };
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    if length == 0.0 {
        return;
    }
    let [x, y] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    // Along the axis of its larger extent, and across it as far as it reaches.
    let (major, minor) = if x.abs() > y.abs() { (0, 1) } else { (1, 0) };
    let [slope, reach] = [[x, y][minor] / [x, y][major], half / [x, y][major].abs()];
    let pixels =
        |from: f32, to: f32, k: usize| from.floor().max(0.0) as usize..to.ceil().clamp(0.0, size[k]) as usize;
    let ends = [from[major].min(to[major]) - half, from[major].max(to[major]) + half];
    for i in pixels(ends[0], ends[1], major) {
        let middle = from[minor] + slope * (i as f32 + 0.5 - from[major]);
        for j in pixels(middle - reach, middle + reach, minor) {
            let (column, row) = if major == 0 { (i, j) } else { (j, i) };
            let [dx, dy] = [column as f32 + 0.5 - from[0], row as f32 + 0.5 - from[1]];
            let (along, across) = (dx * x + dy * y, (dx * y - dy * x).abs());
            let share = |depth: f32| (depth + 0.5).clamp(0.0, 1.0);
            let share = share(0.5 * width - across) * share(along) * share(length - along);
            let pixel = &mut picture.rgba[row * picture.width + column];
            *pixel = change(*pixel, share);
        }
    }
}

/// Paints a rectangle along the axes, each pixel by the share that it covers.
fn draw_rectangle(picture: &mut Picture, [from, to]: [Place; 2], color: [f32; 3], opacity: f32) {
    let size = [picture.width, picture.height];
    let shares = |k: usize| {
        let pixels = from[k].floor().max(0.0) as usize..(to[k].ceil().max(0.0) as usize).min(size[k]);
        pixels.map(move |i| (i, to[k].min(i as f32 + 1.0) - from[k].max(i as f32)))
    };
    for (row, down) in shares(1) {
        for (column, across) in shares(0) {
            let pixel = &mut picture.rgba[row * size[0] + column];
            *pixel = paint(*pixel, color, opacity * down * across);
        }
    }
}

/// Paints what a path covers.
fn draw_path<'s>(
    picture: &mut Picture,
    path: &[PathStep],
    style: impl Into<Style<'s>>,
    color: [f32; 3],
    opacity: f32,
) {
    let commands: Vec<Command> = path.iter().map(|step| command(*step)).collect();
    let (shares, place) = Mask::new(&commands).style(style).render();
    let [width, height] = [picture.width as i32, picture.height as i32];
    for (k, share) in shares.into_iter().enumerate().filter(|(_, share)| *share > 0) {
        let (column, row) = (k as i32 % place.width as i32, k as i32 / place.width as i32);
        let (x, y) = (place.left + column, place.top + row);
        if (0..width).contains(&x) && (0..height).contains(&y) {
            let pixel = &mut picture.rgba[(y * width + x) as usize];
            *pixel = paint(*pixel, color, opacity * visible_share(color, f32::from(share) / 255.0));
        }
    }
}

fn command(step: PathStep) -> Command {
    match step {
        PathStep::Move(to) => Command::MoveTo(to.into()),
        PathStep::Line(to) => Command::LineTo(to.into()),
        PathStep::Quadratic(control, to) => Command::QuadTo(control.into(), to.into()),
        PathStep::Cubic(first, second, to) => Command::CurveTo(first.into(), second.into(), to.into()),
        PathStep::Close => Command::Close,
    }
}

/// The opacity of ink that covers a share of a pixel: bright lines are thinned and dark ones thickened, as they are where the share
/// mixes sRGB. In linear light bright letters look bold.
pub(crate) fn visible_share(ink: [f32; 3], share: f32) -> f32 {
    if ink[1] > 0.2 { share.powf(1.5) } else { 1.0 - (1.0 - share).powf(1.5) }
}

fn paint(pixel: [f32; 4], [r, g, b]: [f32; 3], opacity: f32) -> [f32; 4] {
    over([opacity * r, opacity * g, opacity * b, opacity], pixel)
}

/// A premultiplied colour over another.
pub(crate) fn over(front: [f32; 4], back: [f32; 4]) -> [f32; 4] {
    std::array::from_fn(|channel| front[channel] + (1.0 - front[3]) * back[channel])
}

/// Shares of a line's length at which it enters and leaves a rectangle (Liang and Barsky, A new concept and method for line clipping, 1984);
/// `None` where it passes beside.
fn shares_within([from, to]: [[f64; 2]; 2], [low, high]: [Place; 2]) -> Option<[f64; 2]> {
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
    (first < last).then_some([first, last])
}

/// Ends in 64 bits: they may lie far outside.
fn wide(ends: [Place; 2]) -> [[f64; 2]; 2] {
    ends.map(|end| end.map(f64::from))
}

fn part([from, to]: [[f64; 2]; 2], [first, last]: [f64; 2]) -> [Place; 2] {
    [first, last].map(|share| [0, 1].map(|k: usize| (from[k] + share * (to[k] - from[k])) as f32))
}

/// The part of a line within a rectangle.
pub(crate) fn within(ends: [Place; 2], rectangle: [Place; 2]) -> Option<[Place; 2]> {
    let ends = wide(ends);
    shares_within(ends, rectangle).map(|shares| part(ends, shares))
}

/// The parts of a line outside all rectangles, in its order.
pub(crate) fn outside(ends: [Place; 2], rectangles: &[[Place; 2]]) -> Vec<[Place; 2]> {
    let ends = wide(ends);
    let mut inside: Vec<[f64; 2]> = rectangles.iter().filter_map(|one| shares_within(ends, *one)).collect();
    inside.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (mut parts, mut begin) = (Vec::new(), 0.0);
    for [first, last] in inside.into_iter().chain([[1.0, 1.0]]) {
        if begin < first {
            parts.push(part(ends, [begin, first]));
        }
        begin = f64::max(begin, last);
    }
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A line of any slope, however far its ends lie outside, has an area of length × width.
    #[test]
    fn a_line_covers_its_width_and_ends_where_it_is_told() {
        let covered = |from, to| {
            let mut picture = Picture::transparent(60, 60);
            draw_line(&mut picture, [from, to], 2.0, |_, share| [share; 4]);
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

    #[test]
    fn a_rectangle_covers_its_pixels_by_their_shares() {
        let mut picture = Picture::transparent(4, 3);
        let form = ShapeForm::Rectangle([[0.5, 1.0], [2.0, 9.0]]);
        draw(&mut picture, &Shape { form, color: [1.0, 0.5, 0.0], opacity: 0.5 });
        assert_eq!(picture.pixel(0, 1), [0.25, 0.125, 0.0, 0.25]);
        assert_eq!(picture.pixel(1, 2), [0.5, 0.25, 0.0, 0.5]);
        assert_eq!([picture.pixel(2, 1), picture.pixel(1, 0)], [[0.0; 4]; 2]);
    }

    #[test]
    fn a_line_is_cut_where_rectangles_lie_on_it() {
        let line = [[0.0, 5.0], [100.0, 5.0]];
        let rectangles =
            [[[60.0, 0.0], [70.0, 10.0]], [[-5.0, 0.0], [10.0, 10.0]], [[65.0, 0.0], [80.0, 6.0]]];
        assert_eq!(outside(line, &rectangles), [[[10.0, 5.0], [60.0, 5.0]], [[80.0, 5.0], [100.0, 5.0]]]);
        assert_eq!(outside(line, &[[[-1.0, 0.0], [101.0, 10.0]]]), [[[0.0; 2]; 2]; 0]);
        assert_eq!(outside(line, &[[[0.0, 6.0], [101.0, 10.0]]]), [line]);
    }
}
