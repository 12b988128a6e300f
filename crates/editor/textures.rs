//! Textures of pictures.

use eframe::egui::{ImageData, Pos2, Rect, TextureHandle, TextureOptions, Ui, pos2};

/// All of a texture.
pub(crate) const WHOLE: Rect = Rect { min: Pos2::ZERO, max: pos2(1.0, 1.0) };

/// Puts an image into a texture, which is made where there is none yet.
pub(crate) fn set_texture(
    texture: &mut Option<TextureHandle>,
    ui: &Ui,
    name: &str,
    image: impl Into<ImageData>,
    options: TextureOptions,
) {
    match texture {
        Some(texture) => texture.set(image, options),
        None => *texture = Some(ui.ctx().load_texture(name, image, options)),
    }
}
