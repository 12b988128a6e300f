//! `<DataArray>` elements as arrays of the table of contents.

use super::header::{Appended, Element};
use crate::formats::codec::Codec;
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::piece::PieceArray;
use crate::formats::source::Source;
use crate::formats::stored::{Encoding, Stored};
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Encoding of all arrays of a file, from its root element.
#[derive(Debug, Clone)]
pub(super) struct Context {
    pub source: Arc<Source>,
    pub order: ByteOrder,
    /// 64-bit header words.
    pub wide: bool,
    pub codec: Option<Codec>,
    pub appended: Option<Appended>,
}

impl Context {
    /// Reads the attributes of `<VTKFile>`.
    pub fn new(source: Arc<Source>, root: &Element, appended: Option<Appended>) -> Result<Context> {
        let order = match root.attribute("byte_order") {
            None | Some("LittleEndian") => ByteOrder::Little,
            Some("BigEndian") => ByteOrder::Big,
            Some(_) => return Err(root.wrong("byte_order", "LittleEndian or BigEndian")),
        };
        let wide = match root.attribute("header_type") {
            None | Some("UInt32") => false,
            Some("UInt64") => true,
            Some(_) => return Err(root.wrong("header_type", "UInt32 or UInt64")),
        };
        let codec = Codec::from_name(root.attribute("compressor").unwrap_or(""))?;
        Ok(Context { source, order, wide, codec, appended })
    }

    /// Format and encoding of the file, for people.
    pub fn describe(&self) -> String {
        format!(
            "{}{}, {} headers",
            self.codec.map_or(String::new(), |codec| format!("{}, ", codec.name())),
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.wide { "UInt64" } else { "UInt32" },
        )
    }

    /// An array of `tuple_count` tuples (`None`: only its data tells).
    pub fn stored(&self, element: &Element, tuple_count: Option<u64>) -> Result<Stored> {
        let name = element.attribute("Name").unwrap_or("").to_owned();
        self.stored_inner(element, tuple_count, &name).map_err(|error| error.at_item(&name))
    }

    fn stored_inner(&self, element: &Element, tuple_count: Option<u64>, name: &str) -> Result<Stored> {
        let number_type = NumberType::from_xml(element.required("type")?)
            .ok_or_else(|| element.wrong("type", "Int8 … UInt64, Float32, Float64 or Bit"))?;
        let component_count: usize = element.number("NumberOfComponents")?.unwrap_or(1).max(1);
        let encoding = match element.attribute("format").unwrap_or("ascii") {
            "ascii" => Encoding::Text(element.text.clone()),
            "binary" => {
                let mut parts = element.text.iter();
                let part = match (parts.next(), parts.next()) {
                    (Some(part), None) => part.clone(),
                    (None, _) if tuple_count == Some(0) => 0..0,
                    (None, _) => return Err(Error::run("the array holds no base64 text")),
                    _ => return Err(Error::run("the base64 text is not in one part")),
                };
                Encoding::Xml {
                    at: part.start,
                    end: part.end,
                    base64: true,
                    wide: self.wide,
                    codec: self.codec,
                }
            }
            "appended" => {
                let Some(appended) = self.appended else {
                    return Err(Error::run("the file holds no appended data")
                        .expected("<AppendedData> after the header"));
                };
                let offset: u64 = element.number("offset")?.ok_or_else(|| {
                    Error::run("an appended array does not say where it lies")
                        .expected("the attribute offset")
                })?;
                let at = appended.offset.checked_add(offset).filter(|&at| at <= self.source.len());
                let Some(at) = at else {
                    return Err(Error::run("the array lies beyond the end of the file")
                        .got(format_args!("offset {offset}"))
                        .expected(format_args!("at most {}", self.source.len() - appended.offset)));
                };
                let end = self.source.len();
                Encoding::Xml { at, end, base64: appended.base64, wide: self.wide, codec: self.codec }
            }
            _ => return Err(element.wrong("format", "ascii, binary or appended")),
        };
        let order = self.order;
        Ok(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order,
            component_count,
            tuple_count,
            encoding,
        })
    }

    /// The array of a section (`Cells`, `Coordinates`) that bears a name.
    pub fn named(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Option<Stored>> {
        section
            .children_of("DataArray")
            .find(|array| array.attribute("Name") == Some(name))
            .map(|array| self.stored(array, tuple_count))
            .transpose()
    }

    /// Finds an array that must be there.
    pub fn required(&self, section: &Element, name: &str, tuple_count: Option<u64>) -> Result<Stored> {
        self.named(section, name, tuple_count)?
            .ok_or_else(|| Error::run(format!("<{}> lacks its array '{name}'", section.tag)))
    }

    /// The arrays of `<PointData>` or `<CellData>`; arrays of text are not among them.
    pub fn section(&self, piece: &Element, per_cell: bool, count: u64) -> Result<Vec<PieceArray>> {
        let tag = if per_cell { "CellData" } else { "PointData" };
        let Some(section) = piece.child(tag) else { return Ok(Vec::new()) };
        section
            .children_of("DataArray")
            .filter(|array| array.attribute("type") != Some("String"))
            .map(|array| Ok(PieceArray { per_cell, stored: self.stored(array, Some(count))? }))
            .collect()
    }
}
