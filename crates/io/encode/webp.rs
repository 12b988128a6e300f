//! sRGB WebP without losses.

use super::format::{PictureFormat, encoded};
use image::ExtendedColorType::{Rgb8, Rgba8};
use image::codecs::webp::WebPEncoder;

pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "webp",
    endings: &["webp"],
    summary: "8-bit sRGB over the background or with straight alpha, without losses",
    signature: b"RIFF",
    bits: &[8],
    has_alpha: true,
    has_layers: false,
    has_shapes: false,
    encode: |content, form, _| {
        let color = if form.alpha { Rgba8 } else { Rgb8 };
        encoded("WebP", content, |file, width, height| {
            WebPEncoder::new_lossless(file).encode(&form.bytes(content.picture), width, height, color)
        })
    },
    embedded_texts: None,
};
