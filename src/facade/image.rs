//! Rendered pictures: their pixels, and files of them.

use std::path::Path;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_io::encode;
use voltet_nodes::files::write_whole;

/// A picture: premultiplied linear RGBA in 32-bit floats over transparent black, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Image(Arc<Picture>);

impl Image {
    /// Width (pixels).
    pub fn width(&self) -> usize {
        self.0.width
    }

    /// Height (pixels).
    pub fn height(&self) -> usize {
        self.0.height
    }

    /// Pixels in row-major order: premultiplied linear red, green and blue, and opacity.
    pub fn pixels(&self) -> &[[f32; 4]] {
        &self.0.rgba
    }

    /// 8-bit sRGB of every pixel over a background in linear RGB.
    pub fn srgb8(&self, background: [f64; 3]) -> Vec<[u8; 3]> {
        self.0.rgba.iter().map(|&pixel| encode::srgb8(pixel, background)).collect()
    }

    /// Writes a file whose format its ending states, such as .png (8-bit sRGB over black) or .exr (linear 32-bit RGBA). An existing
    /// file is replaced in one step.
    ///
    /// # Errors
    /// - an ending of no known format;
    /// - a path that cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        self.save_over(path, [0.0; 3])
    }

    /// Like [`Image::save`], with a background in linear RGB for formats without opacity.
    ///
    /// # Errors
    /// As of [`Image::save`].
    pub fn save_over(&self, path: impl AsRef<Path>, background: [f64; 3]) -> Result<()> {
        let path = path.as_ref();
        let format = encode::format_by_ending(path)?;
        write_whole(path, &(format.encode)(&self.0, background, None)?)
    }
}

impl From<Arc<Picture>> for Image {
    fn from(picture: Arc<Picture>) -> Self {
        Image(picture)
    }
}

impl From<Image> for Arc<Picture> {
    fn from(image: Image) -> Self {
        image.0
    }
}
