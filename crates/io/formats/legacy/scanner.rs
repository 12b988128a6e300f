//! A position in a legacy file, from which words, numbers and the places of arrays are taken.

use crate::formats::contents::{Encoding, Stored, tuples};
use crate::formats::numbers::{ByteOrder, NumberType};
use crate::formats::source::Source;
use crate::formats::text::{is_space, line_ends, word_starts};
use std::sync::Arc;
use voltet_core::{Error, Result, counted};

/// Bytes of the file that are kept at a time.
const WINDOW: u64 = 1 << 18;
/// No word or line outside arrays is longer in a sound file.
const LONGEST: usize = 1 << 14;
/// Bytes whose words are counted at once.
const BLOCK: usize = 254;

/// A position in a legacy file.
pub(super) struct Scanner {
    pub source: Arc<Source>,
    /// True if arrays are bytes; else words.
    pub binary: bool,
    window: Vec<u8>,
    window_at: u64,
    at: u64,
    line: usize,
    /// Components of the last array.
    component_count: usize,
}

impl Scanner {
    /// At the beginning of the file.
    pub fn new(source: Arc<Source>) -> Self {
        Scanner {
            source,
            binary: false,
            window: Vec::new(),
            window_at: 0,
            at: 0,
            line: 1,
            component_count: 0,
        }
    }

    /// An error at this place.
    pub fn error(&self, what: impl Into<String>) -> Error {
        self.locate(Error::run(what))
    }

    pub fn locate(&self, error: Error) -> Error {
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

    /// The type of colours.
    pub fn color_type(&self) -> NumberType {
        if self.binary { NumberType::U8 } else { NumberType::F32 }
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
        if self.binary {
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

    /// Reads the number of tuples, their type, and an array that cannot be text.
    pub fn counted(&mut self, name: &str, what: &str, component_count: usize) -> Result<Stored> {
        let count = self.number(what)?;
        let number_type = self.number_type()?;
        self.numeric(name, number_type, component_count, count)
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
                    .got(counted(seen, "value"))
                    .expected(count));
            };
            // One byte is there; go through all that the window holds, in blocks while they hold too few words.
            let mut index = (self.at - self.window_at) as usize;
            while let Some(block) = self.window.get(index..index + BLOCK) {
                let starts = u64::from(word_starts(block, !inside, is_space));
                if seen + starts >= count {
                    break;
                }
                seen += starts;
                inside = block.last().is_some_and(|&last| !is_space(last));
                self.line += line_ends(block);
                index += BLOCK;
            }
            for &byte in &self.window[index..] {
                let space = is_space(byte);
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
