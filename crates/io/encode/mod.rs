//! Pictures to files: sRGB PNG over a background, and linear OpenEXR (docs/src/explanation/optics.md, section 8); colours for numbers.

mod colors;

pub use colors::viridis;

use crate::provenance::Provenance;
use exr::meta::attribute::{AttributeValue, Chromaticities};
use exr::prelude::{
    Blocks, Compression, Encoding, Image, LineOrder, SpecificChannels, Text, Vec2, WritableImage,
};
use png::text_metadata::ITXtChunk;
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

/// 8-bit sRGB of a premultiplied pixel over a linear background, clamped to 0 … 1.
pub fn srgb8(pixel: [f32; 4], background: [f64; 3]) -> [u8; 3] {
    std::array::from_fn(|channel| {
        let linear = pixel[channel] + (1.0 - pixel[3]) * background[channel] as f32;
        (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8
    })
}

/// 8-bit sRGB: the premultiplied picture over a linear background, clamped to 0 … 1. The file says that it is sRGB, to readers
/// that know gamma and chromaticities only too (PNG, third edition, section 11.3.2.5), and carries what it was made from.
pub fn png(picture: &Picture, background: [f64; 3], carried: Option<&Provenance>) -> Result<Vec<u8>> {
    let bytes: Vec<u8> = picture.rgba.iter().flat_map(|pixel| srgb8(*pixel, background)).collect();
    let mut file = Vec::new();
    png_file(&mut file, picture, &bytes, carried)
        .map_err(|error| Error::run("the picture cannot be encoded as PNG").got(error))?;
    Ok(file)
}

/// The file of these pixels, 8-bit RGB.
fn png_file(
    file: &mut Vec<u8>,
    picture: &Picture,
    pixels: &[u8],
    carried: Option<&Provenance>,
) -> std::result::Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(file, picture.width as u32, picture.height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Fast);
    encoder.set_filter(png::Filter::Adaptive);
    let scaled = png::ScaledFloat::from_scaled;
    let [white, red, green, blue] = REC_709.map(|place| place.map(|k| scaled(k * 10)).into());
    encoder.set_source_gamma(scaled(45_455));
    encoder.set_source_chromaticities(png::SourceChromaticities { white, red, green, blue });
    // Figures are read off colours: they are to look alike.
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    let mut writer = encoder.write_header()?;
    for (name, text) in texts(carried) {
        writer.write_text_chunk(&ITXtChunk::new(name, text))?;
    }
    writer.write_image_data(pixels)?;
    writer.finish()
}

/// White, red, green and blue of Rec. 709 and sRGB: x and y of CIE 1931, in ten-thousandths.
const REC_709: [[u32; 2]; 4] = [[3127, 3290], [6400, 3300], [3000, 6000], [1500, 600]];

/// Text chunks of a PNG file: names of its specification (section 11.3.3.2) and some of this program's.
fn texts(carried: Option<&Provenance>) -> Vec<(&'static str, String)> {
    let Some((carried, own)) = carried.and_then(|carried| Some((carried, carried.texts()?))) else {
        return Vec::new();
    };
    let title = carried.title.iter().map(|title| ("Title", title.clone()));
    title.chain([("Software", carried.program.clone())]).chain(own).collect()
}

/// Premultiplied linear 32-bit RGBA, scan lines, ZIP: as every reader of OpenEXR takes it. The file says which primaries its
/// colours have, and carries what it was made from.
pub fn exr(picture: &Picture, carried: Option<&Provenance>) -> Result<Vec<u8>> {
    let pixel = |place: Vec2<usize>| {
        let [r, g, b, a] = picture.pixel(place.x(), place.y());
        (r, g, b, a)
    };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (picture.width, picture.height);
    let mut image = Image::from_encoded_channels(size, encoding, SpecificChannels::rgba(pixel));
    let [white, red, green, blue] = REC_709.map(|[x, y]| Vec2(x as f32 / 1e4, y as f32 / 1e4));
    image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
    if let Some((carried, [pipeline, rest])) = carried.and_then(|carried| Some((carried, carried.texts()?))) {
        // Texts of OpenEXR are bytes, by custom UTF-8.
        let text = |text: &str| Text::from_slice_unchecked(text.as_bytes());
        image.layer_data.attributes.software_name = Some(text(&carried.program));
        image.layer_data.attributes.comments = carried.title.as_deref().map(text);
        // One in each list: a list is written in no certain order.
        let named = |(name, value): (&str, String)| (text(name), AttributeValue::Text(text(&value)));
        image.attributes.other.extend([named(pipeline)]);
        image.layer_data.attributes.other.extend([named(rest)]);
    }
    let mut file = Cursor::new(Vec::new());
    let written = image.write().to_buffered(&mut file);
    written.map_err(|error| Error::run("the picture cannot be encoded as OpenEXR").got(error))?;
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
        let file = png(&picture(), [0.0, 0.5, 1.0], None).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgb8();
        let half = (srgb_from_linear(0.5) * 255.0).round() as u8;
        let middle = (srgb_from_linear(0.5) * 255.0).round() as u8;
        assert_eq!(read.as_raw()[..], [255, half, middle, 0, half, 255]);
    }

    #[test]
    fn an_exr_holds_every_float_as_it_is() {
        let file = exr(&picture(), None).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgba32f();
        assert_eq!(read.as_raw()[..], picture().rgba.concat());
        // Scan lines (version 2, no flags), ZIP of 16 lines: read by the simplest readers.
        assert_eq!(file[4..8], [2, 0, 0, 0]);
        let at = file.windows(12).position(|w| w == b"compression\0").unwrap();
        assert_eq!(file[at + 12 + 12 + 4], 3);
    }
}
