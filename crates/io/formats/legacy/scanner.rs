//! A position in a legacy file, from which words, numbers and the places of arrays are taken.

use crate::formats::contents::{Encoding, Stored, tuples};
use crate::formats::cursor::Cursor;
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use std::sync::Arc;
use voltet_core::{Error, Result, counted};

/// No word or line outside arrays is longer in a sound file.
const LONGEST: usize = 1 << 14;

/// A position in a legacy file. Arrays are bytes where the cursor has a byte order; else words.
pub(super) struct Scanner {
    pub source: Arc<Source>,
    pub cursor: Cursor,
    /// Components of the last array.
    component_count: usize,
}

impl Scanner {
    /// At the beginning of the file.
    pub fn new(source: Arc<Source>) -> Self {
        Scanner { cursor: Cursor::new(&source), source, component_count: 0 }
    }

    pub fn error(&self, what: impl Into<String>) -> Error {
        self.cursor.error(what)
    }

    pub fn is_binary(&self) -> bool {
        self.cursor.binary.is_some()
    }

    /// The next word; `None` at the end of the file.
    pub fn word(&mut self) -> Result<Option<String>> {
        let word = self.cursor.word()?.map(text);
        self.short(word, "word")
    }

    /// The next word, which must be there.
    pub fn required(&mut self, what: &str) -> Result<String> {
        self.word()?.ok_or_else(|| self.error("the file ends early").expected(what))
    }

    pub fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.required(what)?;
        word.parse()
            .map_err(|_| self.error("a number is damaged").got(format_args!("'{word}'")).expected(what))
    }

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
        let line = self.cursor.line()?.map(text);
        Ok(self.short(line, "line")?.map(|line| line.trim().to_owned()))
    }

    /// A word or line that is not too long.
    fn short(&self, found: Option<Option<String>>, what: &str) -> Result<Option<String>> {
        match found {
            Some(None) => Err(self.error(format!("a {what} is too long"))),
            found => Ok(found.flatten()),
        }
    }

    /// Skips a METADATA block of the last array, which ends with an empty line; the line of a component without a name is empty, too.
    pub fn skip_metadata(&mut self) -> Result<()> {
        self.rest_of_line()?;
        while let Some(line) = self.rest_of_line()?.filter(|line| !line.is_empty()) {
            if line == "COMPONENT_NAMES" {
                for _ in 0..self.component_count {
                    self.rest_of_line()?;
                }
            }
        }
        Ok(())
    }

    /// The type of an array by its legacy name; `None`: text.
    pub fn number_type(&mut self) -> Result<Option<NumberType>> {
        let word = self.required("a type of numbers")?;
        if ["string", "utf8_string", "unicode_string", "variant"]
            .contains(&word.to_ascii_lowercase().as_str())
        {
            return Ok(None);
        }
        NumberType::from_legacy(&word).map(Some).ok_or_else(|| {
            self.error("the type of an array is not known").got(format_args!("'{word}'")).expected(
                "bit, char, unsigned_char, short, unsigned_short, int, unsigned_int, long, unsigned_long, \
                 vtkIdType, vtktypeint64, float, double",
            )
        })
    }

    pub fn color_type(&self) -> NumberType {
        if self.is_binary() { NumberType::U8 } else { NumberType::F32 }
    }

    /// An array whose values begin after this line (binary) or here (words), and steps over it.
    pub fn array(
        &mut self,
        name: &str,
        number_type: Option<NumberType>,
        component_count: usize,
        tuple_count: u64,
    ) -> Result<Option<Stored>> {
        self.component_count = component_count;
        if self.is_binary() {
            self.rest_of_line()?;
        }
        let count = tuple_count.checked_mul(component_count as u64).ok_or_else(|| {
            self.error(format!("the array '{name}' cannot be that large"))
                .got(tuples(tuple_count, component_count))
        })?;
        let Some(number_type) = number_type else {
            self.skip_text(count)?;
            return Ok(None);
        };
        let begin = self.cursor.position();
        let encoding = if self.is_binary() {
            let len = number_type.byte_count(count).unwrap_or(u64::MAX);
            self.source.check(begin, len).map_err(|error| error.at_item(name))?;
            self.cursor.skip(len)?;
            Encoding::Bytes(begin)
        } else {
            self.skip_words(count, name)?;
            Encoding::Text(std::iter::once(begin..self.cursor.position()).collect())
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

    /// Reads the number of tuples, their type, and an array that cannot be text.
    pub fn counted(&mut self, name: &str, what: &str, component_count: usize) -> Result<Stored> {
        let count = self.number(what)?;
        let number_type = self.number_type()?;
        self.numeric(name, number_type, component_count, count)
    }

    fn skip_words(&mut self, count: u64, name: &str) -> Result<()> {
        let start = self.cursor.clone();
        self.cursor.skip_numbers(count, 0).or_else(|error| {
            if self.cursor.left() > 0 {
                return Err(error);
            }
            let found = counted(start.range_to(&self.cursor).word_count()?, "value");
            Err(self.error(format!("the array '{name}' ends early")).got(found).expected(count))
        })
    }

    /// Skips text values: lines, or bytes with their number before them.
    fn skip_text(&mut self, count: u64) -> Result<()> {
        if !self.is_binary() {
            self.rest_of_line()?;
        }
        for _ in 0..count {
            if self.cursor.left() == 0 {
                return Err(self.error("the file ends early").expected(format_args!("{count} texts")));
            }
            if !self.is_binary() {
                self.rest_of_line()?;
                continue;
            }
            // The two highest bits say how many bytes the length takes (vtkDataWriter::WriteArray).
            let lead = self.cursor.bytes(1)?[0];
            let rest = self.cursor.bytes([7, 3, 1, 0][usize::from(lead >> 6)])?;
            let len = rest.iter().fold(u64::from(lead & 0x3F), |len, &byte| len << 8 | u64::from(byte));
            self.cursor.skip(len)?;
        }
        Ok(())
    }
}

/// The text of a word or line; `None` of one that is too long.
fn text(bytes: &[u8]) -> Option<String> {
    (bytes.len() <= LONGEST).then(|| String::from_utf8_lossy(bytes).into_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_that_cannot_be_read_is_not_said_to_end_early() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.vtk");
        let message = |text: &str, count: u64, left: Option<u64>| {
            std::fs::write(&path, text).unwrap();
            let mut scanner = Scanner::new(Source::open(&path).unwrap());
            if let Some(left) = left {
                std::fs::OpenOptions::new().write(true).open(&path).unwrap().set_len(left).unwrap();
            }
            scanner.array("f", Some(NumberType::F32), 1, count).err().map(|error| error.to_string())
        };
        let numbers = "1.5\n".repeat(200_000);
        assert_eq!(message(&numbers, 200_000, None), None);
        let short = message(&numbers, 200_001, None).unwrap();
        assert!(short.contains("'f' ends early") && short.contains("found 200000 values"), "{short}");
        let unread = message(&numbers, 200_000, Some(500_000)).unwrap();
        assert!(unread.contains("cannot be read"), "{unread}");
        let long = message(&("1 ".to_owned() + &"x".repeat(5 << 20) + " 2"), 2, None).unwrap();
        assert!(long.contains("too long"), "{long}");
    }
}
