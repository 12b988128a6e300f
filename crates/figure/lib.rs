//! voltet-figure: what makes a picture a figure of a report. Text, lines and colours over a picture, round ticks, colour bars and axes.
//!
//! | module | what |
//! | --- | --- |
//! | [`canvas`] | lines, rectangles and text over a picture, in linear light |
//! | [`ticks`] | round numbers along an axis, and their labels |
//! | [`scale`] | a colour bar along s; the plane of s and g |
//! | [`space`] | box, axes and scale bar of a view |
//!
//! Lengths are in pixels, from the upper left corner of the picture. A size that is not stated follows from the height of the letters.

pub mod canvas;
pub mod scale;
pub mod space;
pub mod ticks;

/// Height of letters that is read well in a picture of this size, pixels.
pub fn font_size([width, height]: [usize; 2]) -> f32 {
    (width.min(height) as f32 / 32.0).max(10.0)
}
