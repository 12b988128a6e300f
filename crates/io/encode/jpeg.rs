//! sRGB JPEG over a background.

use super::format::{PictureFormat, encoded};
use image::ExtendedColorType::Rgb8;
use image::codecs::jpeg::JpegEncoder;

/// Quality on the scale of libjpeg, 1 to 100, at which edges of figures stay clean.
const QUALITY: u8 = 95;

pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "jpeg",
    endings: &["jpg", "jpeg"],
    summary: "8-bit sRGB over the background, with losses (quality 95)",
    signature: b"\xff\xd8\xff",
    bits: &[8],
    has_alpha: false,
    has_layers: false,
    has_shapes: false,
    encode: |content, form, _| {
        encoded("JPEG", content, |file, width, height| {
            JpegEncoder::new_with_quality(file, QUALITY).encode(
                &form.bytes(content.picture),
                width,
                height,
                Rgb8,
            )
        })
    },
    embedded_texts: None,
};
