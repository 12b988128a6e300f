//! Films of pictures of one size, frame by frame: GIF and animated PNG. Bytes are sRGB without opacity.

use image::codecs::gif::{GifEncoder, Repeat};
use image::{Delay, Frame, ImageError, RgbImage};
use std::io::{self, Write};
use voltet_core::{Error, Result};

/// Largest number of frames a second.
const MAX_RATE: f64 = 1000.0;

/// One picture of a film.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FilmFrame {
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Red, green and blue of each pixel, by rows.
    pub rgb: Vec<u8>,
}

/// Frames of a film, each made when it is written.
pub type Frames<'a> = &'a mut dyn Iterator<Item = Result<FilmFrame>>;

/// Writes an animated GIF that is repeated without end: 256 colours a frame, times in hundredths of a second.
///
/// # Errors
/// - those of the frames and of writing.
pub fn gif(out: &mut dyn Write, frames: Frames, rate: f64) -> io::Result<()> {
    let mut encoder = GifEncoder::new_with_speed(out, GIF_SPEED);
    encoder.set_repeat(Repeat::Infinite).map_err(other)?;
    if rate > MAX_GIF_RATE {
        return Err(io::Error::other(format!("a GIF shows no more than {MAX_GIF_RATE} frames a second")));
    }
    let mut begin = 0;
    for (frame, number) in frames.zip(1..) {
        // Each frame ends at the hundredth next to its time, so that the film as a whole is as long as it should be.
        let end = (100.0 * f64::from(number) / rate).round() as u32;
        let delay = Delay::from_numer_denom_ms(10 * (end - begin), 1);
        begin = end;
        let FilmFrame { size: [width, height], rgb } = frame.map_err(io::Error::other)?;
        let image =
            RgbImage::from_raw(width, height, rgb).ok_or_else(|| io::Error::other("the frame is cut off"))?;
        let image = image::DynamicImage::ImageRgb8(image).into_rgba8();
        encoder.encode_frame(Frame::from_parts(image, 0, 0, delay)).map_err(other)?;
    }
    Ok(())
}

/// Largest number of frames a second of a GIF: viewers take hundredths below 2 for 10.
pub const MAX_GIF_RATE: f64 = 50.0;

/// Effort for the colours of a GIF, 1 to 30, less for greater numbers: 10 is what its authors call good.
const GIF_SPEED: i32 = 10;

/// Writes an animated PNG that is repeated without end. `count`: number of frames; `size`: that of each.
///
/// # Errors
/// - those of the frames and of writing.
pub fn apng(out: &mut dyn Write, frames: Frames, count: u32, size: [u32; 2], rate: f64) -> io::Result<()> {
    let mut encoder = png::Encoder::new(out, size[0], size[1]);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::RelativeColorimetric);
    encoder.set_animated(count, 0)?;
    // Both are of 16 bits.
    let (over, under) =
        if rate > 60.0 { (1, rate.round() as u16) } else { (1000, (1000.0 * rate).round() as u16) };
    encoder.set_frame_delay(over, under.max(1))?;
    let mut writer = encoder.write_header()?;
    for frame in frames {
        writer.write_image_data(&frame.map_err(io::Error::other)?.rgb)?;
    }
    Ok(writer.finish()?)
}

fn other(error: ImageError) -> io::Error {
    match error {
        ImageError::IoError(error) => error,
        error => io::Error::other(error),
    }
}

/// Frames a second from a text. Errors: no number above 0, or too many.
pub fn rate(text: &str) -> std::result::Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|rate| (MIN_RATE..=MAX_RATE).contains(rate));
    number.ok_or_else(|| format!("frames a second are a number from {MIN_RATE} to {MAX_RATE}"))
}

/// Least number of frames a second.
const MIN_RATE: f64 = 0.02;

/// The error where frames of a film are of different sizes.
pub fn unequal_sizes(first: [u32; 2], other: [u32; 2], name: &str) -> Error {
    let [[width, height], [other_width, other_height]] = [first, other];
    Error::run("the frames of a film are of different sizes")
        .got(format!("{other_width} × {other_height} of {name}"))
        .expected(format!("{width} × {height}, as the first"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::AnimationDecoder;
    use image::codecs::gif::GifDecoder;
    use image::codecs::png::PngDecoder;
    use std::io::Cursor;

    fn frames(levels: [u8; 3]) -> Vec<FilmFrame> {
        levels.map(|level| FilmFrame { size: [3, 2], rgb: vec![level; 18] }).to_vec()
    }

    /// The level of each frame and its time in milliseconds.
    fn decoded<'a>(decoder: impl AnimationDecoder<'a>) -> Vec<(u8, u32)> {
        let frames = decoder.into_frames().collect_frames().unwrap();
        let level = |frame: &Frame| {
            let (over, under) = frame.delay().numer_denom_ms();
            (frame.buffer().get_pixel(2, 1).0[0], over / under)
        };
        frames.iter().map(level).collect()
    }

    #[test]
    fn films_hold_their_frames_and_times() {
        let levels = [0, 120, 255];
        let wanted: Vec<(u8, u32)> = levels.map(|level| (level, 40)).to_vec();
        let mut file = Vec::new();
        gif(&mut file, &mut frames(levels).into_iter().map(Ok), 25.0).unwrap();
        assert_eq!(decoded(GifDecoder::new(Cursor::new(&file)).unwrap()), wanted);
        let mut file = Vec::new();
        apng(&mut file, &mut frames(levels).into_iter().map(Ok), 3, [3, 2], 25.0).unwrap();
        let decoder = PngDecoder::new(Cursor::new(&file)).unwrap();
        assert_eq!(decoded(decoder.apng().unwrap()), wanted);
    }

    #[test]
    fn times_of_a_gif_add_up_to_those_of_the_rate() {
        let many: Vec<FilmFrame> = (0..20).flat_map(|_| frames([0, 120, 255])).collect();
        for rate in [30.0, 24.0, 50.0, 0.7] {
            let mut file = Vec::new();
            gif(&mut file, &mut many.clone().into_iter().map(Ok), rate).unwrap();
            let times = decoded(GifDecoder::new(Cursor::new(&file)).unwrap());
            let sum: u32 = times.iter().map(|(_, time)| time).sum();
            assert_eq!(sum, 10 * (6000.0 / rate).round() as u32, "{rate} frames a second");
        }
        assert!(gif(&mut Vec::new(), &mut many.into_iter().map(Ok), 60.0).is_err());
    }

    #[test]
    fn rates_are_numbers_above_zero() {
        assert_eq!(rate("24"), Ok(24.0));
        assert_eq!(rate("0.5"), Ok(0.5));
        for text in ["0", "-1", "a", "nan", "inf", "1e9"] {
            assert!(rate(text).is_err(), "{text}");
        }
    }
}
