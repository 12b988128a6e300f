//! Pictures to files, and what files of pictures carry; colour spaces, and colours for numbers. A format is a file here and an entry of
//! [`FORMATS`].

mod colors;
mod exr;
pub mod film;
mod format;
mod jpeg;
mod pdf;
mod png;
mod read;
mod svg;
mod tiff;
mod webp;
mod xml;

pub use colors::{linear_from_srgb, srgb_from_linear, srgb8, viridis};
pub use format::{PictureContent, PictureFormat, SampleForm};
pub use png::png;
pub use read::{read_image, read_picture};

use crate::formats::is_data;
use crate::provenance::{PIPELINE, PROVENANCE, Provenance};
use format::PictureFile;
use std::fs::File;
use std::io::{BufReader, Read, Seek};
use std::path::Path;
use voltet_core::{Error, Result};
use voltet_files::{argument, names_beside};

/// All formats; the first is written to streams.
pub const FORMATS: &[PictureFormat] =
    &[png::FORMAT, exr::FORMAT, tiff::FORMAT, webp::FORMAT, jpeg::FORMAT, svg::FORMAT, pdf::FORMAT];

/// Endings of all formats.
pub fn all_endings() -> impl Iterator<Item = &'static str> {
    FORMATS.iter().flat_map(|format| format.endings).copied()
}

/// Endings of all formats in one phrase: ".png or .exr or …".
pub fn endings() -> String {
    phrase(all_endings())
}

fn phrase(endings: impl Iterator<Item = &'static str>) -> String {
    endings.map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(" or ")
}

/// The format that a path's ending states.
///
/// # Errors
/// An ending of no known format.
pub fn format_by_ending(path: &Path) -> Result<&'static PictureFormat> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    FORMATS.iter().find(|format| format.endings.iter().any(|own| ending.as_deref() == Some(own))).ok_or_else(
        || {
            let error = Error::usage("the picture's format is not known").got(path.display());
            error.expected(format!("a path that ends in {}", endings()))
        },
    )
}

/// The format of a picture that begins like this (8 bytes are enough).
pub fn format_of(head: &[u8]) -> Option<&'static PictureFormat> {
    FORMATS.iter().find(|format| head.starts_with(format.signature))
}

/// The text of a pipeline, and where it comes from.
#[derive(Debug, Clone)]
pub struct Source {
    /// The text.
    pub text: String,
    /// Provenance of the picture that the pipeline comes from.
    pub embedded: Option<Provenance>,
}

impl Source {
    /// Reads a pipeline file, or what a picture carries.
    pub fn read(path: &Path) -> Result<Source> {
        let unreadable = |error| unreadable(path, error);
        let mut file = File::open(path).map_err(unreadable)?;
        let mut bytes = Vec::new();
        // A pipe can be read once.
        file.by_ref().take(8).read_to_end(&mut bytes).map_err(unreadable)?;
        if let Some(format) = format_of(&bytes) {
            file.rewind().map_err(unreadable)?;
            let carried = read(format, BufReader::new(file)).map_err(|error| error.in_file(path))?;
            return Ok(Source { text: carried.pipeline.clone(), embedded: Some(carried) });
        }
        if is_data(path) {
            let start = format!("`voltet start {}`, which writes a pipeline that draws it", argument(path));
            return Err(Error::usage("this is a data file, not a pipeline").expected(start).in_file(path));
        }
        file.read_to_end(&mut bytes).map_err(unreadable)?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let found = format!("byte {} is no UTF-8", error.utf8_error().valid_up_to());
            let error = Error::usage("the file is no pipeline file").got(found);
            let expected = format!("TOML text, or a picture ({}) that carries it", endings());
            error.expected(expected).in_file(path)
        })?;
        Ok(Source { text, embedded: None })
    }
}

/// The error where a pipeline file cannot be read.
fn unreadable(path: &Path, error: std::io::Error) -> Error {
    let names = names_beside(path);
    let pipelines = names.iter().map(String::as_str).filter(|name| name.ends_with(".toml"));
    let wanted = path.file_name().unwrap_or_default().to_string_lossy();
    let error = Error::usage("the pipeline file cannot be read").got(error).in_file(path);
    match pipelines.clone().next() {
        Some(_) => error.not_among(&wanted, pipelines),
        None => error.expected("the path of a pipeline file (.toml)"),
    }
}

/// Reads the provenance of a picture. Errors: it carries no pipeline, or is damaged.
fn read(format: &PictureFormat, mut file: impl PictureFile) -> Result<Provenance> {
    let texts = format.embedded_texts.map_or(Ok(Vec::new()), |texts| texts(&mut file))?;
    let text = |name: &str| texts.iter().find(|(known, _)| known == name).map(|(_, text)| text.as_str());
    let pipeline = text(PIPELINE).ok_or_else(|| {
        Error::usage("the picture carries no pipeline").expected(
            "a pipeline file (.toml), or a picture that an image-writer with provenance = true wrote",
        )
    })?;
    // What another version wrote may lack something; the pipeline is what is drawn.
    let rest: Provenance =
        text(PROVENANCE).and_then(|text| serde_json::from_str(text).ok()).unwrap_or_default();
    Ok(Provenance { pipeline: pipeline.into(), ..rest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::provenance::MAX_TEXT;
    use ::png::text_metadata::{ITXtChunk, TEXtChunk, ZTXtChunk};
    use std::io::Cursor;

    /// One pixel with texts before or behind it.
    fn picture(write: impl FnOnce(&mut ::png::Writer<&mut Vec<u8>>), behind: bool) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = ::png::Encoder::new(&mut file, 1, 1);
        encoder.set_color(::png::ColorType::Grayscale);
        let mut writer = encoder.write_header().unwrap();
        if behind {
            writer.write_image_data(&[7]).unwrap();
            write(&mut writer);
        } else {
            write(&mut writer);
            writer.write_image_data(&[7]).unwrap();
        }
        writer.finish().unwrap();
        file
    }

    fn pipeline(file: &[u8]) -> Result<String> {
        read(format_of(&file[..8]).unwrap(), Cursor::new(file)).map(|carried| carried.pipeline)
    }

    #[test]
    fn texts_are_found_wherever_another_program_put_them() {
        let mut compressed = ITXtChunk::new(PIPELINE, "a = \"ü\"");
        compressed.compressed = true;
        for behind in [false, true] {
            let unicode = picture(|writer| writer.write_text_chunk(&compressed).unwrap(), behind);
            assert_eq!(pipeline(&unicode).unwrap(), "a = \"ü\"");
            let latin = picture(|w| w.write_text_chunk(&ZTXtChunk::new(PIPELINE, "a = 1")).unwrap(), behind);
            assert_eq!(pipeline(&latin).unwrap(), "a = 1");
        }
        let other = picture(|w| w.write_text_chunk(&TEXtChunk::new("Comment", "a = 1")).unwrap(), true);
        assert!(pipeline(&other).unwrap_err().to_string().contains("carries no pipeline"));
    }

    /// A compressed text reveals its length only while it is read.
    #[test]
    fn what_is_too_long_or_damaged_is_no_pipeline() {
        let mut bomb = ITXtChunk::new(PIPELINE, " ".repeat(64 * MAX_TEXT));
        bomb.compressed = true;
        let file = picture(|writer| writer.write_text_chunk(&bomb).unwrap(), false);
        assert!(file.len() < MAX_TEXT);
        assert!(pipeline(&file).unwrap_err().to_string().contains("carries no pipeline"));
        let whole = picture(|w| w.write_text_chunk(&ITXtChunk::new(PIPELINE, "a = 1")).unwrap(), false);
        for length in 8..whole.len() {
            // Never a panic; a text before the damage is found.
            let _ = pipeline(&whole[..length]);
        }
        let mut exr = FORMATS[1].signature.to_vec();
        exr.extend([2, 0, 0, 0]);
        exr.extend(b"voltet:pipeline\0string\0\xff\xff\xff\x7fshort");
        assert!(pipeline(&exr).unwrap_err().to_string().contains("OpenEXR"));
    }
}
