//! The words and lines of a legacy file, and the places of its arrays, found in one pass without decoding.

use crate::formats::contents::{Encoding, Stored};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Bytes of the file that are kept at a time.
const WINDOW: u64 = 1 << 18;
/// No word or line outside arrays is longer in a sound file.
const LONGEST: usize = 1 << 14;

/// A position in a legacy file.
pub(super) struct Scanner {
    pub source: Arc<Source>,
    /// True if arrays are bytes; else words.
    pub binary: bool,
    window: Vec<u8>,
    window_at: u64,
    at: u64,
    line: usize,
}

impl Scanner {
    /// At the beginning of the file.
    pub fn new(source: Arc<Source>) -> Self {
        Scanner { source, binary: false, window: Vec::new(), window_at: 0, at: 0, line: 1 }
    }

    /// An error at this place.
    pub fn error(&self, what: impl Into<String>) -> Error {
        let error = Error::run(what);
        // Lines mean nothing once bytes that look like line ends have been passed.
        if self.binary { error.at_item(format!("byte {}", self.at)) } else { error.at_line(self.line) }
    }

    fn peek(&mut self) -> Result<Option<u8>> {
        let index = self.at.wrapping_sub(self.window_at);
        if let Some(&byte) = self.window.get(index as usize)
            && self.at >= self.window_at
        {
            return Ok(Some(byte));
        }
        if self.at >= self.source.len() {
            return Ok(None);
        }
        self.window = self.source.read(self.at, (self.source.len() - self.at).min(WINDOW))?;
        self.window_at = self.at;
        Ok(self.window.first().copied())
    }

    fn step(&mut self, byte: u8) {
        self.at += 1;
        self.line += usize::from(byte == b'\n');
    }

    /// The next word; `None` at the end of the file.
    pub fn word(&mut self) -> Result<Option<String>> {
        let mut word = Vec::new();
        while let Some(byte) = self.peek()? {
            if byte.is_ascii_whitespace() {
                if !word.is_empty() {
                    break;
                }
                self.step(byte);
                continue;
            }
            word.push(byte);
            self.step(byte);
            if word.len() > LONGEST {
                return Err(self.error("a word is too long"));
            }
        }
        Ok((!word.is_empty()).then(|| String::from_utf8_lossy(&word).into_owned()))
    }

    /// The next word, which must be there.
    pub fn required(&mut self, what: &str) -> Result<String> {
        self.word()?.ok_or_else(|| self.error("the file ends early").expected(what))
    }

    /// The next word as a number.
    pub fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.required(what)?;
        word.parse()
            .map_err(|_| self.error("a number is damaged").got(format_args!("'{word}'")).expected(what))
    }

    /// The next words as numbers.
    pub fn numbers<T: std::str::FromStr + Copy + Default, const N: usize>(
        &mut self,
        what: &str,
    ) -> Result<[T; N]> {
        let mut numbers = [T::default(); N];
        for number in &mut numbers {
            *number = self.number(what)?;
        }
        Ok(numbers)
    }

    /// The rest of the line, without its end.
    pub fn rest_of_line(&mut self) -> Result<Option<String>> {
        let mut line = Vec::new();
        let mut any = false;
        while let Some(byte) = self.peek()? {
            any = true;
            self.step(byte);
            if byte == b'\n' {
                break;
            }
            line.push(byte);
            if line.len() > LONGEST {
                return Err(self.error("a line is too long"));
            }
        }
        Ok(any.then(|| String::from_utf8_lossy(&line).trim().to_owned()))
    }

    /// The next word in lower case if it is one of `accepted`; else the position stays.
    pub fn word_if(&mut self, accepted: &str) -> Result<bool> {
        let (at, line) = (self.at, self.line);
        // What follows may be the bytes of an array: no error if it is no word.
        if self.word().is_ok_and(|word| word.is_some_and(|word| word.eq_ignore_ascii_case(accepted))) {
            return Ok(true);
        }
        (self.at, self.line) = (at, line);
        Ok(false)
    }

    /// Skips a METADATA block, which ends with an empty line.
    pub fn skip_metadata(&mut self) -> Result<()> {
        self.rest_of_line()?;
        while self.rest_of_line()?.is_some_and(|line| !line.is_empty()) {}
        Ok(())
    }

    /// The type of an array by its legacy name; `None`: text.
    pub fn number_type(&mut self) -> Result<Option<NumberType>> {
        let word = self.required("a type of numbers")?;
        number_type(&word).ok_or_else(|| {
            self.error("the type of an array is not known").got(format_args!("'{word}'")).expected(
                "bit, char, unsigned_char, short, unsigned_short, int, unsigned_int, long, unsigned_long, \
                 vtkIdType, vtktypeint64, float, double",
            )
        })
    }

    /// An array whose values begin after this line (binary) or here (words), and steps over it.
    pub fn array(
        &mut self,
        name: &str,
        number_type: Option<NumberType>,
        component_count: usize,
        tuple_count: u64,
    ) -> Result<Option<Stored>> {
        if self.binary {
            self.rest_of_line()?;
        }
        let count = tuple_count.checked_mul(component_count as u64).ok_or_else(|| {
            self.error(format!("the array '{name}' cannot be that large"))
                .got(format_args!("{tuple_count} tuples of {component_count} components"))
        })?;
        let Some(number_type) = number_type else {
            self.skip_text(count)?;
            return Ok(None);
        };
        let begin = self.at;
        let encoding = if self.binary {
            let len = number_type.byte_count(count).unwrap_or(u64::MAX);
            self.source.check(begin, len).map_err(|error| error.at_item(name))?;
            self.at += len;
            Encoding::Bytes(begin)
        } else {
            self.skip_words(count, name)?;
            Encoding::Text(std::iter::once(begin..self.at).collect())
        };
        Ok(Some(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order: ByteOrder::Big,
            component_count,
            tuple_count: Some(tuple_count),
            encoding,
        }))
    }

    /// Reads an array that cannot be text.
    pub fn numeric(
        &mut self,
        name: &str,
        number_type: Option<NumberType>,
        component_count: usize,
        tuple_count: u64,
    ) -> Result<Stored> {
        self.array(name, number_type, component_count, tuple_count)?
            .ok_or_else(|| self.error(format!("the array '{name}' holds text")).expected("numbers"))
    }

    fn skip_words(&mut self, count: u64, name: &str) -> Result<()> {
        let (mut seen, mut inside) = (0, false);
        while seen < count || inside {
            let Some(_) = self.peek()? else {
                if inside && seen == count {
                    break;
                }
                return Err(self
                    .error(format!("the array '{name}' ends early"))
                    .got(format_args!("{seen} values"))
                    .expected(count));
            };
            // One byte is there; go through all that the window holds.
            let first = (self.at - self.window_at) as usize;
            let mut index = first;
            for &byte in &self.window[first..] {
                let space = byte.is_ascii_whitespace();
                if space && seen == count {
                    inside = false;
                    break;
                }
                seen += u64::from(!space && !inside);
                inside = !space;
                self.line += usize::from(byte == b'\n');
                index += 1;
            }
            self.at = self.window_at + index as u64;
        }
        Ok(())
    }

    /// Skips text values: lines, or bytes with their number before them.
    fn skip_text(&mut self, count: u64) -> Result<()> {
        if !self.binary {
            self.rest_of_line()?;
        }
        for _ in 0..count {
            if self.peek()?.is_none() {
                return Err(self.error("the file ends early").expected(format_args!("{count} texts")));
            }
            if !self.binary {
                self.rest_of_line()?;
                continue;
            }
            // The two highest bits say how many bytes the length takes (vtkDataWriter::WriteArray).
            let lead = self.peek()?.unwrap_or(0);
            let width = [8, 4, 2, 1][usize::from(lead >> 6)];
            let bytes = self.source.read(self.at, width)?;
            let len = bytes[1..].iter().fold(u64::from(lead & 0x3F), |len, &byte| len << 8 | u64::from(byte));
            self.at += width;
            self.source.check(self.at, len)?;
            self.at += len;
        }
        Ok(())
    }
}

/// The number type that legacy files call `name`; `Some(None)` for text.
fn number_type(name: &str) -> Option<Option<NumberType>> {
    Some(Some(match name.to_ascii_lowercase().as_str() {
        "bit" => NumberType::Bit,
        "char" | "signed_char" | "vtktypeint8" => NumberType::I8,
        "unsigned_char" | "vtktypeuint8" => NumberType::U8,
        "short" | "vtktypeint16" => NumberType::I16,
        "unsigned_short" | "vtktypeuint16" => NumberType::U16,
        // Legacy files hold the program's own index type as 32 bits.
        "int" | "vtkidtype" | "vtktypeint32" => NumberType::I32,
        "unsigned_int" | "vtktypeuint32" => NumberType::U32,
        "long" | "long_long" | "vtktypeint64" | "__int64" => NumberType::I64,
        "unsigned_long" | "unsigned_long_long" | "vtktypeuint64" | "unsigned___int64" => NumberType::U64,
        "float" => NumberType::F32,
        "double" => NumberType::F64,
        "string" | "utf8_string" | "unicode_string" | "variant" => return Some(None),
        _ => return None,
    }))
}
