//! Textures of pictures.

use crate::worker::Pixels;
use eframe::egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureOptions, Ui, pos2};

/// All of a texture.
pub(crate) const WHOLE: Rect = Rect { min: Pos2::ZERO, max: pos2(1.0, 1.0) };

/// Puts an image into a texture, which is made where there is none yet.
pub(crate) fn set_texture(
    texture: &mut Option<TextureHandle>,
    ui: &Ui,
    name: &str,
    image: ColorImage,
    options: TextureOptions,
) {
    match texture {
        Some(texture) => texture.set(image, options),
        None => *texture = Some(ui.ctx().load_texture(name, image, options)),
    }
}

pub(crate) fn color_image(pixels: &Pixels) -> ColorImage {
    let of = |&[r, g, b, _]: &[u8; 4]| Color32::from_rgb(r, g, b);
    ColorImage::new(pixels.size(), pixels.rgba.iter().map(of).collect())
}
