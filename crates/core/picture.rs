//! A picture: premultiplied linear RGBA in 32-bit floats, row 0 at the top.

/// Premultiplied linear (C, A) over transparent black, row-major, row 0 at the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// `width × height` pixels, `[C_r, C_g, C_b, A]`.
    pub rgba: Vec<[f32; 4]>,
}

impl Picture {
    /// Transparent black.
    pub fn transparent(width: usize, height: usize) -> Self {
        Picture { width, height, rgba: vec![[0.0; 4]; width * height] }
    }

    /// The picture over a background, opaque.
    pub fn over(&self, background: [f64; 3]) -> Self {
        let over = |pixel: &[f32; 4]| -> [f32; 4] {
            std::array::from_fn(|k| match background.get(k) {
                Some(&behind) => pixel[k] + (1.0 - pixel[3]) * behind as f32,
                None => 1.0,
            })
        };
        Picture { rgba: self.rgba.iter().map(over).collect(), ..*self }
    }

    /// The pixel in column `i` of row `j`.
    pub fn pixel(&self, i: usize, j: usize) -> [f32; 4] {
        self.rgba[j * self.width + i]
    }
}
