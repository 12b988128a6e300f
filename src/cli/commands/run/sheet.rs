//! Sheet of the pictures of a sweep, each with its values below.

use super::film::DrawnFrame;
use crate::core::picture::Picture;
use crate::core::{Result, counted};
use crate::io::encode::{png, read_picture};
use crate::nodes::files;
use std::path::{Path, PathBuf};
use voltet_figure::canvas::{Align, Canvas, Theme, lines};

/// Largest width of a sheet, pixels: pictures are made smaller by a whole number.
const MAX_WIDTH: usize = 4096;

/// Least height of letters, pixels.
const MIN_FONT: f32 = 11.0;

/// Writes the sheet of pictures; gives a line about it. Errors: pictures that cannot be read, or a file that cannot be written.
pub(super) fn write(path: &Path, pictures: &[DrawnFrame], background: [f64; 3]) -> Result<String> {
    let columns = (pictures.len() as f64).sqrt().ceil() as usize;
    let (first, _) = read_picture(&pictures[0].path)?;
    let scale = (columns * first.width).div_ceil(MAX_WIDTH).max(1);
    let tiles: Vec<Picture> = pictures
        .iter()
        .map(|drawn| Ok(smaller(&read_picture(&drawn.path)?.0, scale)))
        .collect::<Result<_>>()?;
    let size = |side: &dyn Fn(&Picture) -> usize| tiles.iter().map(side).max().unwrap_or(0);
    let [width, height] = [size(&|tile| tile.width), size(&|tile| tile.height)];
    let font = (height as f32 / 24.0).max(MIN_FONT);
    let gap = (0.5 * font) as usize;
    let captions: Vec<Vec<String>> =
        pictures.iter().map(|drawn| lines(&drawn.label, font, width as f32)).collect();
    let line_count = captions.iter().map(Vec::len).max().unwrap_or(0);
    let band = (1.3 * font * line_count as f32) as usize + 2 * gap;
    let rows = pictures.len().div_ceil(columns);
    let mut sheet = Picture::transparent(columns * (width + gap) + gap, rows * (height + band) + gap);
    let corner = |k: usize| [gap + k % columns * (width + gap), gap + k / columns * (height + band)];
    for (k, tile) in tiles.iter().enumerate() {
        lay(&mut sheet, tile, corner(k));
    }
    let luminance = 0.2126 * background[0] + 0.7152 * background[1] + 0.0722 * background[2];
    let theme = if luminance > 0.2 { Theme::LIGHT } else { Theme::DARK };
    let mut canvas = Canvas::new(&mut sheet, theme, font);
    for (k, caption) in captions.iter().enumerate() {
        let [left, top] = corner(k).map(|at| at as f32);
        for (line, text) in caption.iter().enumerate() {
            let y = top + height as f32 + gap as f32 + 1.3 * font * (line as f32 + 0.5);
            canvas.text(text, [left + 0.5 * width as f32, y], Align::Middle);
        }
    }
    files::write_whole(path, &png(&sheet, background, None)?)?;
    let smaller = if scale > 1 { format!(", each {scale} times smaller") } else { String::new() };
    Ok(format!("{}: a sheet of {}{smaller}\n", path.display(), counted(pictures.len(), "picture")))
}

/// The name of the first picture without its number, and with `_sheet`.
pub(super) fn path(first: &Path) -> PathBuf {
    let stem = first.file_stem().unwrap_or_default().to_string_lossy();
    let stem = stem.trim_end_matches(|letter: char| letter.is_ascii_digit()).trim_end_matches('_');
    let stem = if stem.is_empty() { "pictures" } else { stem };
    first.with_file_name(format!("{stem}_sheet.png"))
}

/// A picture of means of `scale` × `scale` pixels.
fn smaller(picture: &Picture, scale: usize) -> Picture {
    let (width, height) = (picture.width.div_ceil(scale), picture.height.div_ceil(scale));
    let mut small = Picture::transparent(width, height);
    for (i, pixel) in small.rgba.iter_mut().enumerate() {
        let [left, top] = [i % width * scale, i / width * scale];
        let (right, bottom) = ((left + scale).min(picture.width), (top + scale).min(picture.height));
        let count = ((right - left) * (bottom - top)) as f32;
        for y in top..bottom {
            for x in left..right {
                let from = picture.rgba[y * picture.width + x];
                pixel.iter_mut().zip(from).for_each(|(sum, part)| *sum += part / count);
            }
        }
    }
    small
}

/// Lays a picture into a larger one.
fn lay(sheet: &mut Picture, tile: &Picture, [left, top]: [usize; 2]) {
    for (y, row) in tile.rgba.chunks_exact(tile.width).enumerate() {
        let start = (top + y) * sheet.width + left;
        sheet.rgba[start..start + tile.width].copy_from_slice(row);
    }
}
