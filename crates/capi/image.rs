//! A picture into a caller's memory.

use crate::structs::Image;
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};
use voltet_io::encode::srgb8;

/// Memory for a picture: rows of floats, rows of bytes, or both.
pub(crate) struct Target {
    image: Image,
    rgba_stride: usize,
    srgb_stride: usize,
}

impl Target {
    /// Checks a caller's image against the size of the picture to come.
    pub fn check(image: Image, [width, height]: [usize; 2]) -> Result<Target> {
        if [image.width, image.height] != [width, height] {
            return Err(Error::usage("the image has another size than the picture")
                .got(format!("{} × {}", image.width, image.height))
                .expected(format!("{width} × {height}, the camera's")));
        }
        if image.rgba.is_null() && image.srgb.is_null() {
            return Err(Error::usage("the image has no memory").expected("rgba, srgb, or both"));
        }
        if image.background.iter().any(|channel| !channel.is_finite()) {
            let found = format!("{:?}", image.background);
            return Err(Error::usage("the background is not finite").got(found).expected("linear RGB"));
        }
        let stride = |given: usize, min: usize, unit: usize, name: &str| {
            let stride = if given == 0 { min } else { given };
            let fits = stride.checked_mul(height).is_some_and(|bytes| bytes <= isize::MAX as usize);
            if stride < min || !stride.is_multiple_of(unit) || !fits {
                let multiple = if unit > 1 { format!(", a multiple of {unit}") } else { String::new() };
                return Err(Error::usage(format!("{name} is out of range"))
                    .got(format!("{given} bytes"))
                    .expected(format!("0, or at least {min} bytes from row to row{multiple}")));
            }
            Ok(stride)
        };
        if !image.rgba.is_null() && !image.rgba.is_aligned() {
            let error = Error::usage("rgba is at an odd address").got(format!("{:p}", image.rgba));
            return Err(error.expected("a multiple of 4"));
        }
        let rgba_stride = stride(image.rgba_stride, width * 16, 4, "rgba_stride")?;
        let srgb_stride = stride(image.srgb_stride, width * 3, 1, "srgb_stride")?;
        Ok(Target { image, rgba_stride, srgb_stride })
    }

    /// Writes the picture.
    ///
    /// # Safety
    /// The image's memory holds as many rows as it says.
    pub unsafe fn write(&self, picture: &Picture) -> Result<()> {
        let image = &self.image;
        if [picture.width, picture.height] != [image.width, image.height] {
            return Err(Error::run("the picture has another size than its camera")
                .got(format!("{} × {}", picture.width, picture.height)));
        }
        for (j, row) in picture.rgba.chunks_exact(picture.width).enumerate() {
            if !image.rgba.is_null() {
                // SAFETY: the caller's promise, for each row.
                let to = unsafe { image.rgba.byte_add(j * self.rgba_stride) };
                // SAFETY: as before; aligned, as the address and the stride are.
                unsafe { std::slice::from_raw_parts_mut(to, 4 * row.len()) }
                    .copy_from_slice(row.as_flattened());
            }
            if !image.srgb.is_null() {
                // SAFETY: the caller's promise, for each row.
                let to = unsafe {
                    std::slice::from_raw_parts_mut(image.srgb.byte_add(j * self.srgb_stride), 3 * row.len())
                };
                for (to, pixel) in to.as_chunks_mut::<3>().0.iter_mut().zip(row) {
                    *to = srgb8(*pixel, image.background);
                }
            }
        }
        Ok(())
    }
}
