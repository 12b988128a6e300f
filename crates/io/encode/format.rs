//! The declaration of a format of pictures, and the samples of a file of whole numbers.

use super::colors::{over, straight};
use crate::provenance::Provenance;
use std::io::{BufRead, Cursor, Seek};
use voltet_core::picture::Picture;
use voltet_core::picture_parts::{Annotation, PictureLayers, PictureParts, Shape};
use voltet_core::{Error, Result, agreeing, counted};

/// A format of picture files.
pub struct PictureFormat {
    /// Its name in pipelines.
    pub name: &'static str,
    /// Endings of its files.
    pub endings: &'static [&'static str],
    /// Contents of its files, for help.
    pub summary: &'static str,
    /// First bytes of its files, at most 8.
    pub(super) signature: &'static [u8],
    /// Bits of a channel that its whole numbers may have; none in a format of floats, which holds everything.
    pub(super) bits: &'static [u8],
    /// True if its files may have alpha.
    pub(super) has_alpha: bool,
    /// True if its files hold the layers of a picture.
    pub has_layers: bool,
    /// True if its files hold an annotation as shapes. Then they are drawings, which are not read as pictures.
    pub has_shapes: bool,
    /// The file of a picture. One that carries texts carries the provenance.
    pub(super) encode: EncodePicture,
    /// The named texts that a file carries; `None`: the format carries none.
    pub(super) embedded_texts: Option<ReadTexts>,
}

/// Form of the whole numbers in a file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SampleForm {
    /// True: straight alpha, and no background.
    pub alpha: bool,
    /// Linear RGB behind the picture.
    pub background: [f64; 3],
    /// Bits of a channel, 8 or 16.
    pub bits: u8,
}

impl SampleForm {
    /// 8 bits over a background.
    pub fn over(background: [f64; 3]) -> Self {
        SampleForm { alpha: false, background, bits: 8 }
    }
}

/// A picture with what belongs to it, for its file.
#[derive(Debug, Clone, Copy)]
pub struct PictureContent<'a> {
    /// The whole picture.
    pub picture: &'a Picture,
    /// Numbers of each pixel, for formats that hold them.
    pub layers: Option<&'a PictureLayers>,
    /// The annotation apart from the picture, for formats that hold it.
    pub annotation: Option<&'a Annotation>,
}

impl<'a> PictureContent<'a> {
    /// The picture under the shapes, and the shapes; of a picture without annotation itself and none.
    pub(super) fn drawing(&self) -> (&'a Picture, &'a [Shape]) {
        match self.annotation {
            Some(Annotation { ground, shapes }) => (ground, shapes),
            None => (self.picture, &[]),
        }
    }
}

impl<'a> From<&'a Picture> for PictureContent<'a> {
    fn from(picture: &'a Picture) -> Self {
        PictureContent { picture, layers: None, annotation: None }
    }
}

impl<'a> From<&'a PictureParts> for PictureContent<'a> {
    fn from(parts: &'a PictureParts) -> Self {
        PictureContent {
            picture: &parts.picture,
            layers: parts.layers.as_deref(),
            annotation: parts.annotation.as_deref(),
        }
    }
}

/// Function that makes the bytes of a file: of a picture, in a form, with provenance.
pub(super) type EncodePicture = fn(PictureContent, SampleForm, Option<&Provenance>) -> Result<Vec<u8>>;

impl PictureFormat {
    /// True if its files carry the provenance.
    pub fn carries_provenance(&self) -> bool {
        self.embedded_texts.is_some()
    }

    /// The file of a picture, with a sentence for each thing that the format cannot hold.
    ///
    /// # Errors
    /// - a picture that the format cannot hold at all, as one that is too large.
    pub fn file<'a>(
        &self,
        content: impl Into<PictureContent<'a>>,
        form: SampleForm,
        carried: Option<&Provenance>,
    ) -> Result<(Vec<u8>, Vec<String>)> {
        let (content, name, mut unheld) = (content.into(), self.name, Vec::new());
        let mut held = form;
        if form.alpha && !self.has_alpha {
            held.alpha = false;
            unheld.push(format!("{name} holds no alpha: the picture lies over the background"));
        }
        if !self.bits.is_empty() && !self.bits.contains(&form.bits) {
            held.bits = 8;
            unheld.push(format!("{name} holds no {} bits a channel: it has 8", form.bits));
        }
        if carried.is_some() && self.embedded_texts.is_none() {
            unheld.push(format!("{name} holds no texts: the picture does not carry its pipeline"));
        }
        if held.alpha && !self.bits.is_empty() {
            let cut = content.picture.rgba.iter().filter(|pixel| straight(**pixel, held.largest()).1).count();
            if cut > 0 {
                let verb = agreeing(&cut, "is", "are");
                unheld.push(format!(
                    "{} {verb} brighter than straight alpha holds, and darker in the file: exr or a background holds them",
                    counted(cut, "pixel")
                ));
            }
        }
        Ok(((self.encode)(content, held, carried)?, unheld))
    }
}

impl SampleForm {
    /// The whole number for 1.
    fn largest(self) -> f32 {
        f32::from(u16::MAX >> (16 - self.bits))
    }

    /// Samples of a picture, row by row: red, green, blue and, where the form has it, alpha.
    pub(super) fn samples(self, picture: &Picture) -> Vec<u16> {
        let largest = self.largest();
        let pixels = picture.rgba.iter();
        match self.alpha {
            false => pixels.flat_map(|pixel| over(*pixel, self.background, largest)).collect(),
            true => pixels.flat_map(|pixel| straight(*pixel, largest).0).collect(),
        }
    }

    /// Samples of 8 bits.
    pub(super) fn bytes(self, picture: &Picture) -> Vec<u8> {
        self.samples(picture).into_iter().map(|sample| sample as u8).collect()
    }
}

/// The file that `encode` makes of a picture with its width and height. `format`: its name, for errors.
pub(super) fn encoded<E: std::fmt::Display>(
    format: &str,
    PictureContent { picture, .. }: PictureContent,
    encode: impl FnOnce(&mut Cursor<Vec<u8>>, u32, u32) -> std::result::Result<(), E>,
) -> Result<Vec<u8>> {
    let mut file = Cursor::new(Vec::new());
    // Within what a camera may have.
    let written = encode(&mut file, picture.width as u32, picture.height as u32);
    written.map_err(|error| Error::run(format!("the picture cannot be encoded as {format}")).got(error))?;
    Ok(file.into_inner())
}

pub(super) type ReadTexts = fn(&mut dyn PictureFile) -> Result<Vec<(String, String)>>;

/// A file that is read by parts.
pub(super) trait PictureFile: BufRead + Seek {}

impl<F: BufRead + Seek> PictureFile for F {}

#[cfg(test)]
mod tests {
    use super::super::{FORMATS, format_by_ending, read_picture};
    use super::*;
    use crate::provenance::Provenance;

    /// Pixels of all opacities whose colours are at most those, and light far below.
    fn picture() -> Picture {
        let pixel = |i: usize| {
            let part = |k: usize| (i * k % 97) as f32 / 96.0;
            let opacity = part(1);
            [part(5), part(7), part(11) * 1e-3, 1.0].map(|share| share * opacity)
        };
        Picture { width: 16, height: 8, rgba: (0..128).map(pixel).collect() }
    }

    fn form(alpha: bool, bits: u8) -> SampleForm {
        SampleForm { alpha, background: [0.25, 0.5, 1.0], bits }
    }

    fn largest_difference(a: &Picture, b: &Picture) -> f32 {
        let channels = a.rgba.as_flattened().iter().zip(b.rgba.as_flattened());
        channels.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
    }

    /// Files are as exact as their whole numbers, over black, over what they are put over, and where alpha is read back.
    #[test]
    fn what_is_read_back_is_the_picture_over_any_background() {
        let folder = tempfile::tempdir().unwrap();
        let picture = picture();
        for format in FORMATS.iter().filter(|format| format.name != "jpeg" && !format.has_shapes) {
            for (alpha, bits) in [(false, 8), (true, 8), (false, 16), (true, 16)] {
                let bits = if format.bits.is_empty() || format.bits.contains(&bits) { bits } else { 8 };
                let (file, unheld) = format.file(&picture, form(alpha, bits), None).unwrap();
                assert_eq!(unheld, [""; 0], "{}", format.name);
                let path = folder.path().join(format!("a.{}", format.endings[0]));
                std::fs::write(&path, file).unwrap();
                let (read, has_alpha) = read_picture(&path).unwrap();
                assert_eq!(has_alpha, alpha || format.bits.is_empty(), "{} {bits}", format.name);
                // Half a step of the code of a colour, whose slope is 2.4/1.055 at most, and of alpha, which also may cut a colour.
                let step = if format.bits.is_empty() { 0.0 } else { form(alpha, bits).largest().recip() };
                let tolerance = (0.5 * 2.4 / 1.055 + 1.0) * step + 1e-6;
                let backgrounds =
                    if has_alpha { &[[0.0; 3], [0.2, 0.7, 1.0], [1.0; 3]][..] } else { &[[0.25, 0.5, 1.0]] };
                for background in backgrounds {
                    let difference = largest_difference(&read.over(*background), &picture.over(*background));
                    assert!(difference < tolerance, "{} {alpha} {bits}: {difference}", format.name);
                }
                if has_alpha {
                    assert!(largest_difference(&read, &picture) < tolerance, "{}", format.name);
                }
            }
        }
    }

    #[test]
    fn a_jpeg_is_near_the_picture() {
        let even = Picture { rgba: vec![[0.1, 0.2, 0.4, 0.5]; 128], ..picture() };
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.jpeg");
        let format = format_by_ending(&path).unwrap();
        std::fs::write(&path, format.file(&even, form(false, 8), None).unwrap().0).unwrap();
        let read = read_picture(&path).unwrap().0;
        // Two codes of 255 for the conversion to YCbCr and back, each rounded.
        assert!(largest_difference(&read, &even.over([0.25, 0.5, 1.0])) < 2.0 * 2.4 / 1.055 / 255.0);
    }

    #[test]
    fn what_a_format_cannot_hold_is_named() {
        let mut glowing = picture();
        glowing.rgba[3] = [0.5, 0.0, 0.0, 0.25];
        let carried = Provenance { pipeline: "a = 1".into(), ..Provenance::default() };
        let unheld = |name: &str, form| {
            let format = FORMATS.iter().find(|format| format.name == name).unwrap();
            format.file(&glowing, form, Some(&carried)).unwrap().1
        };
        let cut = "1 pixel is brighter than straight alpha holds";
        for (name, form, wanted) in [
            ("jpeg", form(true, 16), &["no alpha", "no 16 bits", "no texts"][..]),
            ("webp", form(true, 16), &["no 16 bits", "no texts", cut]),
            ("tiff", form(false, 16), &["no texts"]),
            ("png", form(true, 16), &[cut]),
            ("png", form(false, 16), &[]),
            ("exr", form(true, 16), &[]),
        ] {
            let found = unheld(name, form);
            assert_eq!(found.len(), wanted.len(), "{found:?}");
            assert!(found.iter().zip(wanted).all(|(found, wanted)| found.contains(wanted)), "{found:?}");
        }
    }

    /// Without the tag readers take alpha as anything.
    #[test]
    fn a_tiff_says_that_its_alpha_is_straight() {
        let format = FORMATS.iter().find(|format| format.name == "tiff").unwrap();
        for bits in [8, 16] {
            let file = format.file(&picture(), form(true, bits), None).unwrap().0;
            let mut decoder = tiff::decoder::Decoder::new(Cursor::new(file)).unwrap();
            assert_eq!(decoder.get_tag_u32_vec(tiff::tags::Tag::ExtraSamples).unwrap(), [2]);
        }
    }
}
