//! The texts that a picture carries.

use super::block::{MAX_TEXT, PIPELINE, PROVENANCE, Provenance};
use exr::meta::MetaData;
use exr::meta::attribute::AttributeValue;
use std::io::{BufRead, Seek};
use voltet_core::{Error, Result};

/// Signature of PNG files (PNG, third edition, section 5.2).
const PNG: &[u8] = b"\x89PNG\r\n\x1a\n";

/// Signature of OpenEXR files.
const EXR: &[u8] = &[0x76, 0x2f, 0x31, 0x01];

/// True if a file that begins like this is a picture that could carry a pipeline.
pub fn is_picture(head: &[u8]) -> bool {
    head.starts_with(PNG) || head.starts_with(EXR)
}

/// Reads the provenance of a picture; `head`: its first bytes. Errors: it carries no pipeline, or is damaged.
pub fn read(head: &[u8], file: impl BufRead + Seek) -> Result<Provenance> {
    let texts = if head.starts_with(PNG) { of_png(file)? } else { of_exr(file)? };
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

/// The named texts of a PNG file, also where another program compressed them or put them behind the picture.
fn of_png(file: impl BufRead + Seek) -> Result<Vec<(String, String)>> {
    let damaged = |error| Error::usage("the picture cannot be read as PNG").got(error);
    let mut reader = png::Decoder::new(file).read_info().map_err(damaged)?;
    let found = texts_of(reader.info());
    if !found.is_empty() {
        return Ok(found);
    }
    // What is damaged further on has no text there.
    Ok(reader.finish().map(|()| texts_of(reader.info())).unwrap_or_default())
}

fn texts_of(info: &png::Info) -> Vec<(String, String)> {
    let ours = |keyword: &str| [PIPELINE, PROVENANCE].contains(&keyword);
    let plain = info.uncompressed_latin1_text.iter().filter(|chunk| ours(&chunk.keyword));
    let plain = plain.map(|chunk| (chunk.keyword.clone(), chunk.text.clone()));
    let unicode = info.utf8_text.iter().filter(|chunk| ours(&chunk.keyword)).filter_map(|chunk| {
        let mut chunk = chunk.clone();
        chunk.decompress_text_with_limit(MAX_TEXT).ok()?;
        Some((chunk.keyword.clone(), chunk.get_text().ok()?))
    });
    let compressed =
        info.compressed_latin1_text.iter().filter(|chunk| ours(&chunk.keyword)).filter_map(|chunk| {
            let mut chunk = chunk.clone();
            chunk.decompress_text_with_limit(MAX_TEXT).ok()?;
            Some((chunk.keyword.clone(), chunk.get_text().ok()?))
        });
    unicode.chain(plain).chain(compressed).filter(|(_, text)| text.len() <= MAX_TEXT).collect()
}

/// The named texts of an OpenEXR file.
fn of_exr(file: impl BufRead + Seek) -> Result<Vec<(String, String)>> {
    let damaged = |error| Error::usage("the picture cannot be read as OpenEXR").got(error);
    let meta = MetaData::read_from_buffered(file, false).map_err(damaged)?;
    let attributes = meta
        .headers
        .iter()
        .flat_map(|header| header.shared_attributes.other.iter().chain(&header.own_attributes.other));
    let text = |(name, value): (&exr::prelude::Text, &AttributeValue)| match value {
        AttributeValue::Text(text) if text.as_slice().len() <= MAX_TEXT => {
            Some((name.to_string(), String::from_utf8(text.as_slice().to_vec()).ok()?))
        }
        _ => None,
    };
    Ok(attributes.filter_map(text).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use png::text_metadata::{ITXtChunk, TEXtChunk, ZTXtChunk};
    use std::io::Cursor;

    /// One pixel with texts before or behind it.
    fn picture(write: impl FnOnce(&mut png::Writer<&mut Vec<u8>>), behind: bool) -> Vec<u8> {
        let mut file = Vec::new();
        let mut encoder = png::Encoder::new(&mut file, 1, 1);
        encoder.set_color(png::ColorType::Grayscale);
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
        read(&file[..8], Cursor::new(file)).map(|carried| carried.pipeline)
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
        let mut exr = EXR.to_vec();
        exr.extend([2, 0, 0, 0]);
        exr.extend(b"voltet:pipeline\0string\0\xff\xff\xff\x7fshort");
        assert!(pipeline(&exr).unwrap_err().to_string().contains("OpenEXR"));
    }
}
