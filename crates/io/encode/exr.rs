//! Linear OpenEXR (docs/src/explanation/optics.md, section 8).

use super::colors::REC_709;
use super::format::{PictureContent, PictureFile, PictureFormat};
use crate::provenance::{MAX_TEXT, Provenance};
use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, LineOrder, Text, Vec2,
    WritableImage,
};
use std::io::Cursor;
use voltet_core::picture_parts::LayerValues;
use voltet_core::{Error, Result};

pub(super) const FORMAT: PictureFormat = PictureFormat {
    name: "exr",
    endings: &["exr"],
    summary: "premultiplied linear 32-bit RGBA, and layers",
    signature: &[0x76, 0x2f, 0x31, 0x01],
    bits: &[],
    has_alpha: true,
    has_layers: true,
    has_shapes: false,
    encode: |content, _, carried| exr(content, carried),
    embedded_texts: Some(embedded_texts),
};

/// Premultiplied linear 32-bit RGBA, scan lines, ZIP: as every reader of OpenEXR takes it. Layers are further channels by their names,
/// numbers of cells as whole numbers without a sign. The file says which primaries its colours have, and carries what it was made from.
fn exr(
    PictureContent { picture, layers, .. }: PictureContent,
    carried: Option<&Provenance>,
) -> Result<Vec<u8>> {
    let channel = |k: usize| FlatSamples::F32(picture.rgba.iter().map(|pixel| pixel[k]).collect());
    let colors = ["R", "G", "B", "A"].into_iter().enumerate().map(|(k, name)| (name, channel(k)));
    let numbers = layers.into_iter().flatten().map(|(layer, values)| match values {
        LayerValues::Numbers(numbers) => (layer.name(), FlatSamples::F32(numbers.clone())),
        LayerValues::Cells(cells) => (layer.name(), FlatSamples::U32(cells.clone())),
    });
    let channels = colors.chain(numbers).map(|(name, samples)| AnyChannel::new(name, samples));
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let size = (picture.width, picture.height);
    let channels = AnyChannels::sort(channels.collect());
    let mut image = Image::from_encoded_channels(size, encoding, channels);
    let [white, red, green, blue] = REC_709.map(|[x, y]| Vec2(x as f32 / 1e4, y as f32 / 1e4));
    image.attributes.chromaticities = Some(Chromaticities { red, green, blue, white });
    if let Some((carried, [pipeline, rest])) = carried.and_then(|carried| Some((carried, carried.texts()?))) {
        // Texts of OpenEXR are bytes, by custom UTF-8.
        let text = |text: &str| Text::from_slice_unchecked(text.as_bytes());
        image.layer_data.attributes.software_name = Some(text(&carried.program));
        image.layer_data.attributes.comments = carried.title.as_deref().map(text);
        // One in each list: a list is written in no certain order.
        let named = |(name, value): (&str, String)| (text(name), AttributeValue::Text(text(&value)));
        image.attributes.other.extend([named(pipeline)]);
        image.layer_data.attributes.other.extend([named(rest)]);
    }
    let mut file = Cursor::new(Vec::new());
    let written = image.write().to_buffered(&mut file);
    written.map_err(|error| Error::run("the picture cannot be encoded as OpenEXR").got(error))?;
    Ok(file.into_inner())
}

fn embedded_texts(file: &mut dyn PictureFile) -> Result<Vec<(String, String)>> {
    let damaged = |error| Error::usage("the picture cannot be read as OpenEXR").got(error);
    let meta = MetaData::read_from_buffered(file, false).map_err(damaged)?;
    let attributes = meta
        .headers
        .iter()
        .flat_map(|header| header.shared_attributes.other.iter().chain(&header.own_attributes.other));
    let text = |(name, value): (&Text, &AttributeValue)| match value {
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
    use ::exr::prelude::{ReadChannels, ReadLayers};
    use voltet_core::picture::Picture;
    use voltet_core::picture_parts::{NO_CELL, PictureLayer, PictureLayers};

    /// Read back by the names of the channels; the colours stay those of a file without layers.
    #[test]
    fn an_exr_holds_layers_beside_the_colours() {
        let picture = Picture { width: 2, height: 1, rgba: vec![[2.5, 0.25, 1e-20, 0.5], [0.0; 4]] };
        let depth = vec![3.5, f32::INFINITY];
        let layers = PictureLayers::from([
            (PictureLayer::Depth, LayerValues::Numbers(depth.clone())),
            (PictureLayer::Cell, LayerValues::Cells(vec![1 << 25 | 1, NO_CELL])),
        ]);
        let content = PictureContent { picture: &picture, layers: Some(&layers), annotation: None };
        let file = exr(content, None).unwrap();
        let read = exr::prelude::read().no_deep_data().largest_resolution_level().all_channels();
        let read = read.first_valid_layer().all_attributes().from_buffered(Cursor::new(&file)).unwrap();
        let channels = &read.layer_data.channel_data.list;
        let names: Vec<String> = channels.iter().map(|channel| channel.name.to_string()).collect();
        assert_eq!(names, ["A", "B", "G", "R", "cell", "depth"]);
        assert!(
            matches!(&channels[4].sample_data, FlatSamples::U32(cells) if cells[..] == [(1 << 25) + 1, NO_CELL])
        );
        assert!(matches!(&channels[5].sample_data, FlatSamples::F32(found) if *found == depth));
        let colors = image::load_from_memory(&file).unwrap().into_rgba32f();
        assert_eq!(colors.as_raw()[..], picture.rgba.concat());
    }

    #[test]
    fn an_exr_holds_every_float_as_it_is() {
        // One over-bright and half covered, one empty.
        let picture = Picture { width: 2, height: 1, rgba: vec![[2.5, 0.25, 1e-20, 0.5], [0.0; 4]] };
        let file = exr((&picture).into(), None).unwrap();
        let read = image::load_from_memory(&file).unwrap().into_rgba32f();
        assert_eq!(read.as_raw()[..], picture.rgba.concat());
        // Scan lines (version 2, no flags), ZIP of 16 lines: read by the simplest readers.
        assert_eq!(file[4..8], [2, 0, 0, 0]);
        let at = file.windows(12).position(|w| w == b"compression\0").unwrap();
        assert_eq!(file[at + 12 + 12 + 4], 3);
    }
}
