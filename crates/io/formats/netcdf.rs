//! netCDF in its own form (versions 1, 2 and 5: CDF-1, CDF-2, CDF-5): the header, and the places of variables.
//!
//! A variable lies in one part, or one part for each record (time step), big-endian, so an array is read in parallel straight from
//! the file. Source: NetCDF Users Guide, "NetcdfFile Format Specifications". The crate netcdf-reader decodes into arrays of its own and
//! brings date and unit conversions along; the header is small enough to be read here.

use super::contents::{Encoding, Stored};
use super::cursor::Cursor;
use super::numbers::{ByteOrder, NumberType};
use super::source::Source;
use std::collections::HashMap;
use std::sync::Arc;
use voltet_core::{Error, Result};

pub(super) fn is_netcdf(head: &[u8]) -> bool {
    matches!(head, [b'C', b'D', b'F', 1 | 2 | 5, ..])
}

pub(super) struct NetcdfFile {
    pub source: Arc<Source>,
    variables: HashMap<String, Variable>,
    /// Bytes from one record to the next.
    record_len: u64,
}

pub(super) struct Variable {
    /// Numbers along each axis; the first of a variable with records counts these.
    pub shape: Vec<u64>,
    number_type: NumberType,
    has_records: bool,
    begin: u64,
    /// Attributes of text; others are passed over.
    attributes: Vec<(String, String)>,
}

impl Variable {
    /// An attribute of text.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|attribute| attribute.0 == name).map(|attribute| attribute.1.as_str())
    }

    /// Bytes of a record, or of all of it where it has none; `None` beyond 64 bits.
    fn len(&self) -> Option<u64> {
        let axes = &self.shape[usize::from(self.has_records)..];
        let count = axes.iter().try_fold(1_u64, |product, &n| product.checked_mul(n))?;
        self.number_type.byte_count(count)
    }
}

/// Tags of the lists in a header.
const DIMENSIONS: u64 = 10;
const VARIABLES: u64 = 11;
const ATTRIBUTES: u64 = 12;
/// Code of the type of text.
const TEXT: u64 = 2;
/// Count of records where the writer did not know it.
const STREAMING: u64 = u32::MAX as u64;

/// Types by their codes from 1.
const TYPES: [NumberType; 11] = [
    NumberType::I8,
    NumberType::U8,
    NumberType::I16,
    NumberType::I32,
    NumberType::F32,
    NumberType::F64,
    NumberType::U8,
    NumberType::U16,
    NumberType::U32,
    NumberType::I64,
    NumberType::U64,
];

fn damaged(what: &str) -> Error {
    Error::run(format!("the header of the netCDF file is damaged: {what}"))
}

impl NetcdfFile {
    pub fn open(source: Arc<Source>) -> Result<NetcdfFile> {
        let mut header = Header { cursor: Cursor::new(&source), version: 1 };
        header.cursor.binary = Some(ByteOrder::Big);
        header.version = header.cursor.bytes(4)?[3];
        let record_count = header.count()?;
        let dimensions = header.list(DIMENSIONS, |header| {
            header.name()?;
            header.count()
        })?;
        header.attributes()?;
        let variables = header.list(VARIABLES, |header| header.variable(&dimensions))?;
        let record_len = record_len(&variables).ok_or_else(|| damaged("records of too many bytes"))?;
        let first = variables.iter().filter(|(_, own)| own.has_records).map(|(_, own)| own.begin).min();
        // A program that died, or wrote into a pipe, left the count out.
        let record_count = match (record_count == STREAMING || record_count == u64::MAX, first) {
            (true, Some(first)) => source.len().saturating_sub(first) / record_len.max(1),
            _ => record_count,
        };
        let with_records = |(name, mut variable): (String, Variable)| {
            if variable.has_records {
                variable.shape[0] = record_count;
            }
            (name, variable)
        };
        let variables = variables.into_iter().map(with_records).collect();
        Ok(NetcdfFile { source, variables, record_len })
    }

    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.variables.keys().map(String::as_str)
    }

    pub fn variable(&self, name: &str) -> Option<&Variable> {
        self.variables.get(name)
    }

    /// True if the records of a variable do not lie side by side.
    pub fn lies_apart(&self, variable: &Variable) -> bool {
        variable.has_records && variable.shape[0] > 1 && Some(self.record_len) != variable.len()
    }

    /// Part of a variable as an array of tuples: the numbers at these places along its first axes.
    pub fn part(
        &self,
        variable: &Variable,
        places: &[u64],
        name: &str,
        component_count: usize,
    ) -> Result<Stored> {
        let wrong = |what: &str| Error::run(what).got(format_args!("{:?}", variable.shape)).at_item(name);
        let rest =
            variable.shape.get(places.len()..).ok_or_else(|| wrong("the variable has too few axes"))?;
        if places.iter().zip(&variable.shape).any(|(place, n)| place >= n) {
            return Err(wrong("the variable is too small").expected(format_args!("one at {places:?}")));
        }
        let product = |axes: &[u64]| axes.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
        let (mut begin, mut offset) = (Some(variable.begin), Some(0_u64));
        for (axis, place) in places.iter().enumerate() {
            if axis == 0 && variable.has_records {
                begin = begin
                    .zip(self.record_len.checked_mul(*place))
                    .and_then(|(begin, n)| begin.checked_add(n));
                continue;
            }
            let stride = product(&variable.shape[axis + 1..]);
            offset = offset
                .zip(stride.and_then(|n| n.checked_mul(*place)))
                .and_then(|(sum, n)| sum.checked_add(n));
        }
        let bytes = offset.and_then(|offset| variable.number_type.byte_count(offset));
        let begin = begin.zip(bytes).and_then(|(begin, bytes)| begin.checked_add(bytes));
        let (Some(begin), Some(count)) = (begin, product(rest)) else {
            return Err(wrong("the variable cannot be that large"));
        };
        if places.is_empty() && self.lies_apart(variable) {
            return Err(wrong("the records of the variable do not lie side by side"));
        }
        if !count.is_multiple_of(component_count as u64) {
            return Err(wrong("the variable has the wrong number of values")
                .expected(format_args!("tuples of {component_count}")));
        }
        Ok(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type: variable.number_type,
            order: ByteOrder::Big,
            component_count,
            tuple_count: Some(count / component_count as u64),
            encoding: Encoding::Bytes(begin),
        })
    }
}

/// Bytes from one record to the next: those of all variables with records, each filled up to 4 but where there is one alone.
fn record_len(variables: &[(String, Variable)]) -> Option<u64> {
    let lens: Option<Vec<u64>> =
        variables.iter().filter(|(_, own)| own.has_records).map(|(_, own)| own.len()).collect();
    match lens?.as_slice() {
        [only] => Some(*only),
        lens => lens.iter().try_fold(0_u64, |sum, len| sum.checked_add(len.checked_next_multiple_of(4)?)),
    }
}

struct Header {
    cursor: Cursor,
    version: u8,
}

impl Header {
    /// A whole number of so many bytes.
    fn number(&mut self, len: usize) -> Result<u64> {
        Ok(self.cursor.bytes(len)?.iter().fold(0, |number, &byte| number << 8 | u64::from(byte)))
    }

    /// A count or length, which is longer in version 5.
    fn count(&mut self) -> Result<u64> {
        self.number(if self.version == 5 { 8 } else { 4 })
    }

    /// Bytes that are filled up to 4.
    fn padded(&mut self, len: u64) -> Result<&[u8]> {
        let padded = len.checked_next_multiple_of(4).ok_or_else(|| damaged("a length"))?;
        let padded = usize::try_from(padded).map_err(|_| damaged("a length"))?;
        Ok(&self.cursor.bytes(padded)?[..len as usize])
    }

    fn name(&mut self) -> Result<String> {
        let len = self.count()?;
        Ok(String::from_utf8_lossy(self.padded(len)?).into_owned())
    }

    /// The elements of a list. Each takes bytes of the file, so no more are made than there are.
    fn list<T>(&mut self, tag: u64, element: impl Fn(&mut Self) -> Result<T>) -> Result<Vec<T>> {
        let (found, count) = (self.number(4)?, self.count()?);
        if found != tag && (found, count) != (0, 0) {
            return Err(damaged("a list").got(found).expected(tag));
        }
        (0..count).map(|_| element(self)).collect()
    }

    fn attributes(&mut self) -> Result<Vec<(String, String)>> {
        let attributes = self.list(ATTRIBUTES, |header| {
            let (name, code) = (header.name()?, header.number(4)?);
            let (count, number_type) = (header.count()?, type_of(code)?);
            let bytes =
                header.padded(number_type.byte_count(count).ok_or_else(|| damaged("an attribute"))?)?;
            let text = (code == TEXT).then(|| text(bytes));
            Ok(text.map(|text| (name, text)))
        })?;
        Ok(attributes.into_iter().flatten().collect())
    }

    fn variable(&mut self, dimensions: &[u64]) -> Result<(String, Variable)> {
        let (name, axis_count) = (self.name()?, self.count()?);
        let mut shape = Vec::new();
        for _ in 0..axis_count {
            let number = self.count()?;
            let len = usize::try_from(number).ok().and_then(|number| dimensions.get(number));
            shape.push(*len.ok_or_else(|| damaged("an axis").got(number).at_item(&name))?);
        }
        let attributes = self.attributes()?;
        let number_type = type_of(self.number(4)?)?;
        // The length follows from the axes; that of large ones does not fit its field.
        self.count()?;
        let begin = self.number(if self.version == 1 { 4 } else { 8 })?;
        let has_records = shape.first() == Some(&0);
        // A variable of no size would have any number of values.
        if shape.iter().skip(1).any(|&n| n == 0) {
            return Err(damaged("an axis of records is not the first").at_item(name));
        }
        Ok((name, Variable { shape, number_type, has_records, begin, attributes }))
    }
}

fn type_of(code: u64) -> Result<NumberType> {
    let number_type = usize::try_from(code).ok().and_then(|code| TYPES.get(code.checked_sub(1)?));
    number_type.copied().ok_or_else(|| damaged("a type").got(code).expected("1 to 11"))
}

/// Text up to the first byte of zero, without space around it.
pub(super) fn text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|&byte| byte == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim().to_owned()
}
