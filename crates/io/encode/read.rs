//! Pictures from files.

use super::colors::linear_from_srgb;
use image::{DynamicImage, ImageReader, Limits};
use std::path::Path;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};

/// Most memory that a picture file may ask for, bytes: the floats of the largest picture that a camera has.
const MAX_BYTES: u64 = 1 << 32;

/// Largest side of a picture that the program writes, pixels.
const MAX_SIDE: u32 = 1 << 15;

/// Reads a picture file of a format that the program writes, with sides of at most `max_side` pixels, as it is.
pub fn read_image(path: &Path, max_side: u32) -> std::result::Result<DynamicImage, image::ImageError> {
    let mut reader = ImageReader::open(path)?.with_guessed_format()?;
    let mut limits = Limits::default();
    (limits.max_image_width, limits.max_image_height) = (Some(max_side), Some(max_side));
    limits.max_alloc = Some(MAX_BYTES);
    reader.limits(limits);
    reader.decode()
}

/// The premultiplied linear picture of a file, and whether the file has opacity: floats as they are, integers as straight sRGB.
///
/// # Errors
/// - a file that cannot be read, or holds no picture.
pub fn read_picture(path: &Path) -> Result<(Picture, bool)> {
    let image = read_image(path, MAX_SIDE).map_err(|error| {
        let readable = super::FORMATS.iter().filter(|format| !format.has_shapes);
        let endings = readable.flat_map(|format| format.endings).copied();
        let expected = format!("a picture ({})", super::phrase(endings));
        Error::usage("the picture cannot be read").got(error).expected(expected).in_file(path)
    })?;
    let has_opacity = image.color().has_alpha();
    let (width, height) = (image.width() as usize, image.height() as usize);
    let rgba = match image {
        DynamicImage::ImageRgb32F(_) | DynamicImage::ImageRgba32F(_) => {
            image.into_rgba32f().pixels().map(|pixel| pixel.0).collect()
        }
        _ => {
            let straight = |&image::Rgba([r, g, b, a])| {
                let opacity = f32::from(a) / 65535.0;
                let [r, g, b] = [r, g, b].map(|v| opacity * linear_from_srgb(f32::from(v) / 65535.0));
                [r, g, b, opacity]
            };
            image.into_rgba16().pixels().map(straight).collect()
        }
    };
    Ok((Picture { width, height, rgba }, has_opacity))
}
