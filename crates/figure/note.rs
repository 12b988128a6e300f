//! Texts of one's own in a picture: in its corners, at its borders, at points.

use crate::canvas::{Align, Canvas, LEADING, Place, Rectangle, lines, text_width};

/// Position of a note.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Anchor {
    /// A corner or the middle of a border.
    Border {
        /// Start: left, end: right.
        across: Align,
        /// Start: top, end: bottom.
        down: Align,
        /// Least distance from the border, in font sizes.
        margin: f32,
    },
    /// A point of the picture.
    Point {
        /// Shares of its width, from the left, and of its height, from the top.
        share: [f32; 2],
        /// The end of each line, or its middle, that stands there.
        align: Align,
    },
}

/// Step by which a note moves away from its border where that is taken, in font sizes.
const STEP: f32 = 0.25;

/// Writes a text in as many lines as it has, and as have room in a half of the picture's width. At a border it moves up or down
/// where another thing stands there; at a point it stays. False where there is no room.
pub fn note(canvas: &mut Canvas, text: &str, anchor: Anchor) -> bool {
    let (font, [width, height]) = (canvas.font(), canvas.size());
    let text = lines(text, font, 0.5 * width - 2.0 * font);
    let size = [
        text.iter().map(|line| text_width(line, font)).fold(0.0, f32::max),
        text.len() as f32 * LEADING * font,
    ];
    let corner = |from: Align, room: f32, size: f32, margin: f32| match from {
        Align::Start => margin,
        Align::Middle => 0.5 * (room - size),
        Align::End => room - margin - size,
    };
    let (align, corners): (Align, Vec<Place>) = match anchor {
        Anchor::Point { share, align } => {
            let at = [share[0] * width, share[1] * height];
            let left = match align {
                Align::Start => at[0],
                Align::Middle => at[0] - 0.5 * size[0],
                Align::End => at[0] - size[0],
            };
            (align, vec![[left, at[1] - 0.5 * size[1]]])
        }
        Anchor::Border { across, down, margin } => {
            let margin = margin * font;
            let first = [corner(across, width, size[0], margin), corner(down, height, size[1], margin)];
            let steps = (0..(height / (STEP * font)) as usize).map(|k| k as f32 * STEP * font);
            let moves: Vec<f32> = match down {
                Align::Start => steps.collect(),
                Align::Middle => steps.flat_map(|step| [-step, step]).collect(),
                Align::End => steps.map(|step| -step).collect(),
            };
            (across, moves.into_iter().map(|by| [first[0], first[1] + by]).collect())
        }
    };
    let around = |[left, top]: Place| -> Rectangle { [[left, top], [left + size[0], top + size[1]]] };
    let Some([left, top]) = corners.into_iter().find(|corner| canvas.take(around(*corner))) else {
        return false;
    };
    let x = match align {
        Align::Start => left,
        Align::Middle => left + 0.5 * size[0],
        Align::End => left + size[0],
    };
    for (k, line) in text.iter().enumerate() {
        canvas.text(line, [x, top + (k as f32 + 0.5) * LEADING * font], align);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::canvas::Theme;
    use voltet_core::picture::Picture;

    #[test]
    fn notes_stand_where_they_are_told_and_give_way_at_borders_alone() {
        let mut picture = Picture::transparent(400, 300);
        let mut canvas = Canvas::new(&mut picture, Theme::DARK, 10.0);
        let corner = Anchor::Border { across: Align::End, down: Align::End, margin: 1.0 };
        assert!(note(&mut canvas, "first", corner) && note(&mut canvas, "second", corner));
        let point = Anchor::Point { share: [0.25, 0.5], align: Align::Start };
        assert!(note(&mut canvas, "point", point) && !note(&mut canvas, "again", point));
        assert!(!note(&mut canvas, "cut", Anchor::Point { share: [0.99, 0.5], align: Align::Start }));
        let texts = &canvas.texts;
        assert_eq!(
            texts.iter().map(|(text, _)| text.as_str()).collect::<Vec<_>>(),
            ["first", "second", "point"]
        );
        let [first, second, point] = [0, 1, 2].map(|k| texts[k].1);
        assert!(first[1].iter().zip([390.0, 290.0]).all(|(a, b)| (a - b).abs() < 1e-3), "{first:?}");
        assert!((second[1][0] - 390.0).abs() < 1e-3 && second[1][1] <= first[0][1], "{second:?}");
        assert_eq!([point[0][0], 0.5 * (point[0][1] + point[1][1])], [100.0, 150.0]);
    }
}
