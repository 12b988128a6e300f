//! A canvas painted into a picture, two pixels a unit, smoothed by the distance of each pixel from the shapes' edges.

use super::{Anchor, Canvas, Color, Mark, Size};
use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster};
use voltet_core::picture::Picture;
use voltet_io::encode::linear_from_srgb;

/// Pixels a unit.
const SCALE: f64 = 2.0;

/// Pixels being painted: sRGB, 0 … 1, as light adds up on screens that blend so.
struct Paper {
    size: [usize; 2],
    values: Vec<[f64; 3]>,
}

impl Canvas {
    /// The picture, opaque.
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
            write(paper, at.map(|x| x * SCALE), text, *size, *anchor, *upward, *color);
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

/// Text in Noto Sans Mono, as its bitmaps are.
fn write(
    paper: &mut Paper,
    at: [f64; 2],
    text: &str,
    size: Size,
    anchor: Anchor,
    upward: bool,
    color: Color,
) {
    let height = match size {
        Size::Small => RasterHeight::Size24,
        Size::Large => RasterHeight::Size32,
    };
    let letters = || text.chars().filter_map(|c| get_raster(c, FontWeight::Regular, height));
    let width: usize = letters().map(|letter| letter.width()).sum();
    let start = anchor.start(width as f64);
    let mut along = 0;
    for letter in letters() {
        for (row, line) in letter.rows().enumerate() {
            for (column, &cover) in line.iter().enumerate() {
                let (u, v) = (start + (along + column) as f64, row as f64 - 0.5 * height.val() as f64);
                let [x, y] = if upward { [at[0] + v, at[1] - u] } else { [at[0] + u, at[1] + v] };
                paper.blend(x.round() as i64, y.round() as i64, color, f64::from(cover) / 255.0);
            }
        }
        along += letter.width();
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Symbol, WHITE};
    use super::*;

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
