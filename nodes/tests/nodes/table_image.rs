//! Pictures of table widgets.

use png::{BitDepth, ColorType};
use voltet_io::encode::linear_from_srgb;
use voltet_nodes::table_image;

/// The bytes of a PNG file of three texels by two.
fn picture(color: ColorType, depth: BitDepth) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 3, 2);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == ColorType::Indexed {
        encoder.set_palette(vec![9, 8, 7, 250, 128, 0]);
        encoder.set_trns(vec![255, 17]);
    }
    let row = (3 * color.samples() * depth as usize).div_ceil(8);
    // Of a palette the first two colours alone.
    let byte = |i: usize| if color == ColorType::Indexed { 0b0100_0000 } else { (37 * i + 11) as u8 };
    let bytes: Vec<u8> = (0..2 * row).map(byte).collect();
    encoder.write_header().unwrap().write_image_data(&bytes).unwrap();
    file
}

#[test]
fn every_form_of_png_is_read_as_the_crate_image_reads_it() {
    use {BitDepth::*, ColorType::*};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("table.png");
    let bytes = [Grayscale, GrayscaleAlpha, Rgb, Rgba].map(|color| [(color, Eight), (color, Sixteen)]);
    let bits = [(Grayscale, One), (Grayscale, Four), (Indexed, One), (Indexed, Two)];
    for (color, depth) in bytes.into_iter().flatten().chain(bits) {
        let file = picture(color, depth);
        std::fs::write(&path, &file).unwrap();
        let (width, height, texels) = table_image(&path).unwrap();
        let expected = image::load_from_memory(&file).unwrap().into_rgba16();
        let part = |value: u16| f32::from(value) / 65535.0;
        let texel = |[r, g, b, alpha]: [u16; 4]| {
            [linear_from_srgb(part(r)), linear_from_srgb(part(g)), linear_from_srgb(part(b)), part(alpha)]
        };
        assert_eq!([width, height], [3, 2]);
        assert!(expected.pixels().map(|p| texel(p.0)).eq(texels), "{color:?} {depth:?}");
    }
}

#[test]
fn a_picture_of_too_many_texels_a_side_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("wide.png");
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, 8193, 1);
    encoder.set_color(ColorType::Grayscale);
    encoder.write_header().unwrap().write_image_data(&[0; 8193]).unwrap();
    std::fs::write(&path, &file).unwrap();
    let error = table_image(&path).unwrap_err().to_string();
    assert!(error.contains("table widget") && error.contains("8193 × 1"), "{error}");
}
