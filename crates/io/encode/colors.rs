//! Colour spaces, and colours for numbers.

use std::sync::LazyLock;
use voltet_core::color;
use voltet_core::colormap::{ColorCurve, Colormap};
use voltet_core::picture_parts::Shape;

/// White, red, green and blue of Rec. 709 and sRGB: x and y of CIE 1931, in ten-thousandths.
pub(super) const REC_709: [[u32; 2]; 4] = [[3127, 3290], [6400, 3300], [3000, 6000], [1500, 600]];

/// sRGB to linear (IEC 61966-2-1), both 0 … 1.
pub fn linear_from_srgb(v: f32) -> f32 {
    color::linear_from_srgb(f64::from(v)) as f32
}

/// Linear to sRGB (IEC 61966-2-1), both 0 … 1.
pub fn srgb_from_linear(v: f32) -> f32 {
    if v <= 0.003_130_8 { v * 12.92 } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
}

/// 8-bit sRGB of a premultiplied pixel over a linear background, clamped to 0 … 1.
pub fn srgb8(pixel: [f32; 4], background: [f64; 3]) -> [u8; 3] {
    over(pixel, background, 255.0).map(|code| code as u8)
}

/// sRGB of a premultiplied pixel over a linear background, in whole numbers up to `largest`.
pub(super) fn over(pixel: [f32; 4], background: [f64; 3], largest: f32) -> [u16; 3] {
    let linear = |channel: usize| pixel[channel] + (1.0 - pixel[3]) * background[channel] as f32;
    [0, 1, 2].map(|channel| code(linear(channel), largest))
}

/// Straight sRGB and alpha of a premultiplied pixel, in whole numbers up to `largest`; and true if the colour is brighter than such a
/// pixel can be. The colour is divided by the alpha that is written, so that over black it is as exact as without alpha.
pub(super) fn straight([r, g, b, opacity]: [f32; 4], largest: f32) -> ([u16; 4], bool) {
    let alpha = (opacity.clamp(0.0, 1.0) * largest).round();
    let opacity = alpha / largest;
    let color = [r, g, b].map(|linear| if alpha > 0.0 { code(linear / opacity, largest) } else { 0 });
    // Rounding of the alpha is no loss.
    let is_cut = [r, g, b].iter().any(|linear| *linear > opacity + 1.0 / largest);
    ([color[0], color[1], color[2], alpha as u16], is_cut)
}

/// sRGB of linear light, clamped to 0 … 1, in whole numbers up to `largest`.
pub(super) fn code(linear: f32, largest: f32) -> u16 {
    (srgb_from_linear(linear.clamp(0.0, 1.0)) * largest).round() as u16
}

/// The opacity with which sRGB is mixed, as viewers do, to the colour that linear light mixes, over a ground from which the shape stands
/// out: white under dark shapes, black under bright ones.
pub(super) fn srgb_opacity(Shape { color, opacity, .. }: &Shape) -> f32 {
    let ground = if color[1] > 0.2 { 0.0 } else { 1.0 };
    let mixed = srgb_from_linear(opacity * color[1] + (1.0 - opacity) * ground);
    (mixed - ground) / (srgb_from_linear(color[1]) - ground)
}

/// The colour of a level from 0 (dark violet) to 1 (yellow) of the map viridis; linear, opaque.
pub fn viridis(level: f32) -> [f32; 4] {
    static VIRIDIS: LazyLock<ColorCurve> = LazyLock::new(|| Colormap::Viridis.curve());
    let [red, green, blue] = VIRIDIS.at(f64::from(level)).map(|v| v as f32);
    [red, green, blue, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn srgb_and_linear_are_inverse_and_anchored() {
        // Known value: 18 % grey is 118 of 255.
        assert_eq!((srgb_from_linear(0.18) * 255.0).round(), 118.0);
        for v in [0.0, 0.001, 0.04, 0.05, 0.5, 1.0] {
            // The standard's two pieces meet to 1e-7 only.
            assert!((srgb_from_linear(linear_from_srgb(v)) - v).abs() < 1e-6);
        }
    }
}
