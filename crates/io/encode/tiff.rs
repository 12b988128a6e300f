//! sRGB TIFF, compressed without losses.

use super::format::{PictureFormat, encoded};
use std::io::{Seek, Write};
use tiff::TiffResult;
use tiff::encoder::colortype::{ColorType, RGB8, RGB16, RGBA8, RGBA16};
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, TiffValue};
use tiff::tags::{ExtraSamples, Tag};

/// The declaration. The signature is of the byte order of this machine, in which files are written.
pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "tiff",
    endings: &["tif", "tiff"],
    summary: "8-bit or 16-bit sRGB over the background or with straight alpha",
    signature: if cfg!(target_endian = "big") { b"MM\0*" } else { b"II*\0" },
    bits: &[8, 16],
    has_alpha: true,
    has_layers: false,
    has_shapes: false,
    encode: |content, form, _| {
        encoded("TIFF", content, |file, width, height| match (form.bits, form.alpha) {
            (8, false) => write::<RGB8>(file, [width, height], &form.bytes(content.picture)),
            (8, true) => write::<RGBA8>(file, [width, height], &form.bytes(content.picture)),
            (_, false) => write::<RGB16>(file, [width, height], &form.samples(content.picture)),
            (_, true) => write::<RGBA16>(file, [width, height], &form.samples(content.picture)),
        })
    },
    embedded_texts: None,
};

fn write<C: ColorType>(
    file: impl Write + Seek,
    [width, height]: [u32; 2],
    samples: &[C::Inner],
) -> TiffResult<()>
where
    [C::Inner]: TiffValue,
{
    let compression = Compression::Deflate(DeflateLevel::Fast);
    let mut encoder = TiffEncoder::new(file)?.with_compression(compression);
    let mut image = encoder.new_image::<C>(width, height)?;
    if C::BITS_PER_SAMPLE.len() == 4 {
        image.encoder().write_tag(Tag::ExtraSamples, &[ExtraSamples::UnassociatedAlpha][..])?;
    }
    image.write_data(samples)
}
