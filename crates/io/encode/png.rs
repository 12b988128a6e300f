//! sRGB PNG (docs/src/explanation/optics.md, section 8).

use super::colors::REC_709;
use super::format::{PictureFile, PictureFormat, SampleForm, encoded};
use crate::provenance::{MAX_TEXT, PIPELINE, PROVENANCE, Provenance};
use png::text_metadata::ITXtChunk;
use std::io::Write;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};

/// The declaration. The signature is of PNG, third edition, section 5.2.
pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "png",
    endings: &["png"],
    summary: "8-bit or 16-bit sRGB over the background or with straight alpha",
    signature: b"\x89PNG\r\n\x1a\n",
    bits: &[8, 16],
    has_alpha: true,
    has_layers: false,
    has_shapes: false,
    encode: |content, form, carried| {
        encoded("PNG", content, |file, width, height| {
            let samples = match form.bits {
                8 => form.bytes(content.picture),
                _ => form.samples(content.picture).into_iter().flat_map(u16::to_be_bytes).collect(),
            };
            png_file(file, [width, height], form, &samples, carried)
        })
    },
    embedded_texts: Some(embedded_texts),
};

/// 8-bit sRGB: the premultiplied picture over a linear background, clamped to 0 … 1, with what it was made from.
pub fn png(picture: &Picture, background: [f64; 3], carried: Option<&Provenance>) -> Result<Vec<u8>> {
    (FORMAT.encode)(picture.into(), SampleForm::over(background), carried)
}

/// The file of these samples. It says that it is sRGB, to readers that know gamma and chromaticities only too (PNG, third edition,
/// section 11.3.2.5), and carries what it was made from.
fn png_file(
    file: impl Write,
    [width, height]: [u32; 2],
    form: SampleForm,
    samples: &[u8],
    carried: Option<&Provenance>,
) -> std::result::Result<(), png::EncodingError> {
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(if form.alpha { png::ColorType::Rgba } else { png::ColorType::Rgb });
    encoder.set_depth(if form.bits == 8 { png::BitDepth::Eight } else { png::BitDepth::Sixteen });
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
    writer.write_image_data(samples)?;
    writer.finish()
}

/// Text chunks of a PNG file: names of its specification (section 11.3.3.2) and some of this program's.
fn texts(carried: Option<&Provenance>) -> Vec<(&'static str, String)> {
    let Some((carried, own)) = carried.and_then(|carried| Some((carried, carried.texts()?))) else {
        return Vec::new();
    };
    let title = carried.title.iter().map(|title| ("Title", title.clone()));
    title.chain([("Software", carried.program.clone())]).chain(own).collect()
}

/// The named texts of a PNG file, also where another program compressed them or put them behind the picture.
fn embedded_texts(file: &mut dyn PictureFile) -> Result<Vec<(String, String)>> {
    let damaged = |error| Error::usage("the picture cannot be read as PNG").got(error);
    let mut reader = png::Decoder::new(file).read_info().map_err(damaged)?;
    let found = texts_of(reader.info());
    if !found.is_empty() {
        return Ok(found);
    }
    // What is damaged further on has no text there.
    Ok(reader.finish().map(|()| texts_of(reader.info())).unwrap_or_default())
}

fn texts_of(info: &png::Info) -> Vec<(String, String)> {
    let ours = |keyword: &str| [PIPELINE, PROVENANCE].contains(&keyword);
    let plain = info.uncompressed_latin1_text.iter().filter(|chunk| ours(&chunk.keyword));
    let plain = plain.map(|chunk| (chunk.keyword.clone(), chunk.text.clone()));
    let unicode = info.utf8_text.iter().filter(|chunk| ours(&chunk.keyword)).filter_map(|chunk| {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(MAX_TEXT).ok()?;
        Some((chunk.keyword.clone(), chunk.get_text().ok()?))
    });
    let compressed =
        info.compressed_latin1_text.iter().filter(|chunk| ours(&chunk.keyword)).filter_map(|chunk| {
            let mut chunk = chunk.clone();
            chunk.decompress_text_with_limit(MAX_TEXT).ok()?;
            Some((chunk.keyword.clone(), chunk.get_text().ok()?))
        });
    unicode.chain(plain).chain(compressed).filter(|(_, text)| text.len() <= MAX_TEXT).collect()
}

#[cfg(test)]
mod tests {
    use super::super::colors::srgb_from_linear;
    use super::*;

    /// Two pixels: one over-bright and half covered, one empty.
    fn picture() -> Picture {
        Picture { width: 2, height: 1, rgba: vec![[2.5, 0.25, 1e-20, 0.5], [0.0; 4]] }
    }

    #[test]
    fn a_png_lies_over_its_background() {
        let file = png(&picture(), [0.0, 0.5, 1.0], None).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgb8();
        let half = (srgb_from_linear(0.5) * 255.0).round() as u8;
        let middle = (srgb_from_linear(0.5) * 255.0).round() as u8;
        assert_eq!(read.as_raw()[..], [255, half, middle, 0, half, 255]);
    }
}
