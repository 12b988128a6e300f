//! Pictures to files: sRGB PNG over a background, and linear OpenEXR (docs/optics.md, section 8); colours for numbers.

mod colors;

pub use colors::viridis;

use exr::prelude::{Blocks, Compression, Encoding, Image, LineOrder, SpecificChannels, WritableImage};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use std::io::Cursor;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};

/// sRGB to linear (IEC 61966-2-1), both 0 … 1.
pub fn linear_from_srgb(v: f32) -> f32 {
    if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
}

/// Linear to sRGB (IEC 61966-2-1), both 0 … 1.
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// 8-bit sRGB: the premultiplied picture over a linear background, clamped to 0 … 1.
pub fn png(picture: &Picture, background: [f64; 3]) -> Result<Vec<u8>> {
    let mut bytes = Vec::with_capacity(picture.rgba.len() * 3);
    for pixel in &picture.rgba {
        for (channel, behind) in background.iter().enumerate() {
            let linear = pixel[channel] + (1.0 - pixel[3]) * *behind as f32;
            bytes.push((srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8);
        }
    }
    let mut file = Vec::new();
    let (width, height) = (picture.width as u32, picture.height as u32);
    let written = PngEncoder::new(&mut file).write_image(&bytes, width, height, ExtendedColorType::Rgb8);
    written.map_err(|error| Error::run("the picture cannot be encoded as PNG").found(error))?;
    Ok(file)
}

/// Premultiplied linear 32-bit RGBA, scan lines, ZIP: as every reader of OpenEXR takes it.
pub fn exr(picture: &Picture) -> Result<Vec<u8>> {
    let pixel = |place: exr::math::Vec2<usize>| {
        let [r, g, b, a] = picture.pixel(place.x(), place.y());
        (r, g, b, a)
    };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (picture.width, picture.height);
    let image = Image::from_encoded_channels(size, encoding, SpecificChannels::rgba(pixel));
    let mut file = Cursor::new(Vec::new());
    let written = image.write().to_buffered(&mut file);
    written.map_err(|error| Error::run("the picture cannot be encoded as OpenEXR").found(error))?;
    Ok(file.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two pixels: one over-bright and half covered, one empty.
    fn picture() -> Picture {
        Picture { width: 2, height: 1, rgba: vec![[2.5, 0.25, 1e-20, 0.5], [0.0; 4]] }
    }

    #[test]
    fn srgb_and_linear_are_inverse_and_anchored() {
        // Known value: 18 % grey is 118 of 255.
        assert_eq!((srgb_from_linear(0.18) * 255.0).round(), 118.0);
        for v in [0.0, 0.001, 0.04, 0.05, 0.5, 1.0] {
            // The standard's two pieces meet to 1e-7 only.
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-6);
        }
    }

    #[test]
    fn a_png_lies_over_its_background() {
        let file = png(&picture(), [0.0, 0.5, 1.0]).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgb8();
        let half = (srgb_from_linear(0.5) * 255.0).round() as u8;
        let middle = (srgb_from_linear(0.5) * 255.0).round() as u8;
        assert_eq!(read.as_raw()[..], [255, half, middle, 0, half, 255]);
    }

    #[test]
    fn an_exr_holds_every_float_as_it_is() {
        let file = exr(&picture()).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgba32f();
        assert_eq!(read.as_raw()[..], picture().rgba.concat());
        // Scan lines (version 2, no flags), ZIP of 16 lines: read by the simplest readers.
        assert_eq!(file[4..8], [2, 0, 0, 0]);
        let at = file.windows(12).position(|w| w == b"compression\0").unwrap();
        assert_eq!(file[at + 12 + 12 + 4], 3);
    }
}
