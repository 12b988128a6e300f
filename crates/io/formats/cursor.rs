//! A position in a file of text, or of text and bytes, that is read from front to back through a window.

use super::contents::{Encoding, Meter, Stored};
use super::decode::join;
use super::lazy::count_from_zero;
use super::numbers::{self, ByteOrder, NumberType, Target, convert};
use super::source::Source;
use super::text::{BLOCK, TextRange, is_space, line_ends, word_starts};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use voltet_core::progress::NoProgress;
use voltet_core::{Error, Result, counted};

/// Bytes of the file that are read at a time.
const WINDOW: usize = 1 << 18;
/// No word or line of a sound file is longer.
const LONGEST: usize = 1 << 22;
/// Numbers that are too few for several threads.
const FEW: u64 = 64;
/// Numbers of text that one task changes.
const PART: usize = 1 << 14;

#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    at: u64,
    line: usize,
}

pub(super) struct Cursor {
    source: Arc<Source>,
    /// Bytes from `start` on.
    window: Vec<u8>,
    start: u64,
    at: usize,
    /// The end of the part that is read.
    end: u64,
    line: usize,
    /// Line in which the last word or line began.
    last_line: usize,
    /// The byte order of numbers; `None`: they are text.
    pub binary: Option<ByteOrder>,
}

impl Clone for Cursor {
    /// A cursor at this position without the bytes of the window: such are kept for each part of a file.
    fn clone(&self) -> Cursor {
        let cursor = Cursor::within(&self.source, self.position(), self.end, self.line);
        Cursor { last_line: self.last_line, binary: self.binary, ..cursor }
    }
}

impl Cursor {
    /// At the beginning of a file of text.
    pub fn new(source: &Arc<Source>) -> Cursor {
        Cursor::within(source, 0, source.len(), 1)
    }

    /// At the beginning of a part of a file that begins in this line.
    pub fn within(source: &Arc<Source>, start: u64, end: u64, line: usize) -> Cursor {
        let end = end.min(source.len());
        Cursor {
            source: source.clone(),
            window: Vec::new(),
            start,
            at: 0,
            end,
            line,
            last_line: line,
            binary: None,
        }
    }

    /// At a place in a file of text.
    pub fn at(source: &Arc<Source>, place: Place) -> Cursor {
        Cursor::within(source, place.at, source.len(), place.line)
    }

    /// The place, to come back to.
    pub fn place(&self) -> Place {
        Place { at: self.position(), line: self.line }
    }

    /// Bytes before the position.
    pub fn position(&self) -> u64 {
        self.start + self.at as u64
    }

    /// Number of the line, from 1; means nothing once bytes were passed.
    pub fn line_number(&self) -> usize {
        self.line
    }

    /// Number of the line in which the last word or line began.
    pub fn last_line(&self) -> usize {
        self.last_line
    }

    /// Bytes that are left.
    pub fn left(&self) -> u64 {
        self.end.saturating_sub(self.position())
    }

    /// An error at this place.
    pub fn error(&self, what: impl Into<String>) -> Error {
        self.locate(Error::run(what))
    }

    /// An error with this place.
    pub fn locate(&self, error: Error) -> Error {
        match self.binary {
            Some(_) => error.at_item(format!("byte {}", self.position())),
            None => error.at_line(self.last_line),
        }
    }

    /// Reads on; false at the end.
    fn fill(&mut self) -> Result<bool> {
        self.window.drain(..self.at);
        self.start += self.at as u64;
        self.at = 0;
        let next = self.start + self.window.len() as u64;
        let count = self.end.saturating_sub(next).min(WINDOW as u64) as usize;
        let old = self.window.len();
        self.window.resize(old + count, 0);
        self.source.read_at(next, &mut self.window[old..])?;
        Ok(count > 0)
    }

    /// Length from here to the first byte for which `is_end` is true, or to the end of the file.
    fn length(&mut self, is_end: impl Fn(u8) -> bool, what: &str) -> Result<usize> {
        let mut from = 0;
        loop {
            let rest = &self.window[self.at..];
            if let Some(found) = rest[from..].iter().position(|&byte| is_end(byte)) {
                return Ok(from + found);
            }
            from = rest.len();
            if from > LONGEST {
                return Err(self.error(format!("a {what} is too long")));
            }
            if !self.fill()? {
                return Ok(from);
            }
        }
    }

    /// The next line without its end; `None` at the end of the file.
    pub fn line(&mut self) -> Result<Option<&[u8]>> {
        let length = self.length(|byte| byte == b'\n', "line")?;
        let begin = self.at;
        let has_end = self.window.len() > begin + length;
        if length == 0 && !has_end {
            return Ok(None);
        }
        self.at += length + usize::from(has_end);
        self.last_line = self.line;
        self.line += usize::from(has_end);
        let line = &self.window[begin..begin + length];
        Ok(Some(line.strip_suffix(b"\r").unwrap_or(line)))
    }

    /// Passes over so many lines that `is_row` tells from others, and gives their range. Errors: the file ends before.
    pub fn skip_rows(
        &mut self,
        count: u64,
        is_row: impl Fn(&[u8]) -> bool,
        expected: &str,
    ) -> Result<TextRange> {
        let start = self.clone();
        let mut passed = 0;
        while passed < count {
            let Some(line) = self.line()? else {
                return Err(self.error("the file ends early").got(passed).expected(expected));
            };
            passed += u64::from(is_row(line));
        }
        Ok(start.range_to(self))
    }

    /// The next line as text without white space round it; an error at the end.
    pub fn text_line(&mut self, what: &str) -> Result<String> {
        match self.line()? {
            Some(line) => Ok(String::from_utf8_lossy(line.trim_ascii()).into_owned()),
            None => Err(self.error("the file ends early").expected(what)),
        }
    }

    pub fn skip_space(&mut self) -> Result<()> {
        loop {
            while let Some(byte) = self.window.get(self.at).filter(|byte| is_space(**byte)) {
                self.line += usize::from(*byte == b'\n');
                self.at += 1;
            }
            if self.at < self.window.len() || !self.fill()? {
                return Ok(());
            }
        }
    }

    /// Passes over empty lines, and lines that begin with #.
    pub fn skip_comments(&mut self) -> Result<()> {
        while self.peek()? == Some(b'#') {
            self.line()?;
        }
        Ok(())
    }

    /// The next word; `None` at the end.
    pub fn word(&mut self) -> Result<Option<&[u8]>> {
        self.skip_space()?;
        self.last_line = self.line;
        let length = self.length(is_space, "word")?;
        let begin = self.at;
        self.at += length;
        Ok((length > 0).then(|| &self.window[begin..begin + length]))
    }

    /// The next byte that is no white space, which stays; `None` at the end.
    pub fn peek(&mut self) -> Result<Option<u8>> {
        self.skip_space()?;
        Ok(self.window.get(self.at).copied())
    }

    /// Passes over the next word if it is this one, in any case of letters; else the position stays.
    pub fn word_if(&mut self, accepted: &str) -> Result<bool> {
        let (start, line) = (self.position(), self.line);
        self.skip_space()?;
        while self.window.len() - self.at <= accepted.len() && self.fill()? {}
        let (word, rest) = self.window[self.at..].split_at_checked(accepted.len()).unwrap_or_default();
        if word.eq_ignore_ascii_case(accepted.as_bytes()) && rest.first().is_none_or(|&byte| is_space(byte)) {
            (self.at, self.last_line) = (self.at + word.len(), self.line);
            return Ok(true);
        }
        if start < self.start {
            self.window.clear();
            self.start = start;
        }
        (self.at, self.line) = ((start - self.start) as usize, line);
        Ok(false)
    }

    /// True if the file goes on with these bytes, which stay.
    pub fn starts_with(&mut self, bytes: &[u8]) -> Result<bool> {
        while self.window.len() - self.at < bytes.len() && self.fill()? {}
        Ok(self.window[self.at..].starts_with(bytes))
    }

    /// Bytes up to one for which `is_end` is true, or to the end; no white space is skipped.
    pub fn until(&mut self, is_end: impl Fn(u8) -> bool) -> Result<&[u8]> {
        self.last_line = self.line;
        let length = self.length(is_end, "word")?;
        let begin = self.at;
        self.at += length;
        let bytes = &self.window[begin..begin + length];
        self.line += bytes.iter().filter(|&&byte| byte == b'\n').count();
        Ok(bytes)
    }

    /// That so many bytes are left.
    fn check(&self, count: u64) -> Result<()> {
        if count <= self.left() {
            return Ok(());
        }
        let error = self.error("the file ends early").got(counted(self.left(), "byte"));
        Err(error.expected(counted(count, "byte")))
    }

    /// The next `count` bytes, which the file must hold.
    pub fn bytes(&mut self, count: usize) -> Result<&[u8]> {
        self.check(count as u64)?;
        while self.window.len() - self.at < count {
            self.fill()?;
        }
        self.at += count;
        Ok(&self.window[self.at - count..self.at])
    }

    /// Moves on by `count` bytes, which the file must hold.
    pub fn skip(&mut self, count: u64) -> Result<()> {
        self.check(count)?;
        let inside = (self.window.len() - self.at) as u64;
        if count <= inside {
            self.at += count as usize;
        } else {
            self.start = self.position() + count;
            self.window.clear();
            self.at = 0;
        }
        Ok(())
    }

    /// Moves on to a place in the file; the lines up to it are counted.
    pub fn go_to(&mut self, place: u64) -> Result<()> {
        while self.position() < place {
            if self.at == self.window.len() && !self.fill()? {
                break;
            }
            let count = (place - self.position()).min((self.window.len() - self.at) as u64) as usize;
            self.line += line_ends(&self.window[self.at..self.at + count]);
            self.at += count;
        }
        Ok(())
    }

    /// Passes over numbers, which are not parsed: words of text, or places of `size` bytes.
    pub fn skip_numbers(&mut self, count: u64, size: u64) -> Result<()> {
        if self.binary.is_some() {
            return self.skip(count.saturating_mul(size));
        }
        self.skip_words(count, is_space)
    }

    /// Passes over words with such bytes between them.
    fn skip_words(&mut self, count: u64, is_between: impl Fn(u8) -> bool + Copy) -> Result<()> {
        for _ in self.pass_words(count, is_between)?..count {
            self.until(|byte| !is_between(byte))?;
            if self.until(is_between)?.is_empty() {
                return Err(self.error("the file ends early").expected(format_args!("{count} numbers")));
            }
        }
        Ok(())
    }

    /// Passes over words while fewer than `count` begin in what is passed at once; gives their number.
    fn pass_words(&mut self, count: u64, is_between: impl Fn(u8) -> bool + Copy) -> Result<u64> {
        let (mut passed, mut may_begin) = (0, true);
        loop {
            if self.at == self.window.len() && !self.fill()? {
                break;
            }
            let rest = &self.window[self.at..];
            let block = &rest[..rest.len().min(BLOCK)];
            let starts = u64::from(word_starts(block, may_begin, is_between));
            let Some(&last) = block.last().filter(|_| passed + starts < count) else { break };
            may_begin = is_between(last);
            self.line += line_ends(block);
            self.at += block.len();
            passed += starts;
        }
        if !may_begin {
            self.until(is_between)?;
        }
        Ok(passed)
    }

    /// The next numbers, of text or of this type, in parts that are parsed side by side.
    pub fn numbers<T: Target>(&mut self, number_type: NumberType, count: u64, what: &str) -> Result<Vec<T>> {
        if count < FEW {
            return (0..count).map(|_| self.number(number_type, what)).collect();
        }
        self.numbers_between(number_type, count, what, is_space)
    }

    /// The next numbers, of text with such bytes between them or of this type.
    pub fn numbers_between<T: Target>(
        &mut self,
        number_type: NumberType,
        count: u64,
        what: &str,
        is_between: impl Fn(u8) -> bool + Sync + Copy,
    ) -> Result<Vec<T>> {
        self.changed_numbers(number_type, count, what, is_between, |_| ())
    }

    /// As [`Cursor::numbers_between`], changed part by part side by side: bytes while a part is in the cache, text once all is parsed.
    fn changed_numbers<T: Target>(
        &mut self,
        number_type: NumberType,
        count: u64,
        what: &str,
        is_between: impl Fn(u8) -> bool + Sync + Copy,
        change: impl Fn(&mut [T]) + Sync + Send,
    ) -> Result<Vec<T>> {
        let start = self.position();
        let Some(order) = self.binary else {
            let passed = self.skip_words(count, is_between);
            let mut numbers = Vec::with_capacity(if passed.is_ok() { count as usize } else { 0 });
            let range = TextRange::new(&self.source, start..self.position());
            // A damaged word comes before a table that is too short.
            let parsed = range.numbers(number_type, is_between, &mut numbers, |_| Ok(()));
            parsed.map_err(|error| error.expected(what)).and(passed)?;
            numbers.par_chunks_mut(PART).for_each(change);
            return Ok(numbers);
        };
        let first = self.clone();
        self.skip(number_type.byte_count(count).unwrap_or(u64::MAX))?;
        let stored = Stored {
            number_type,
            order,
            ..Stored::of_f64(&self.source, what, 1, count, Encoding::Bytes(start))
        };
        stored.load_changed(&Meter::new(&NoProgress, 1), change).or_else(|error| {
            // One by one they tell the place of the wrong one.
            *self = first;
            (0..count).try_for_each(|_| self.number::<T>(number_type, what).map(|_| ()))?;
            Err(error)
        })
    }

    /// The next numbers, all of the first component, then of the next, as tuples.
    pub fn tuples(&mut self, number_type: NumberType, count: u64, n: usize, what: &str) -> Result<Vec<f64>> {
        let begin = self.position();
        let Some((order, bytes)) = self.binary.zip(number_type.byte_count(count)) else {
            let numbers: Vec<f64> = self.numbers(number_type, count.saturating_mul(n as u64), what)?;
            let count = count as usize;
            let of_tuple = |i: usize| numbers[i..].iter().step_by(count).copied();
            return Ok((0..count).flat_map(of_tuple).collect());
        };
        self.skip(bytes.saturating_mul(n as u64))?;
        let plane = |component: u64| {
            let place = Encoding::Bytes(begin + component * bytes);
            Stored { number_type, order, ..Stored::of_f64(&self.source, what, 1, count, place) }
        };
        join(&(0..n as u64).map(plane).collect::<Vec<_>>(), &Meter::new(&NoProgress, 1))
    }

    /// The next numbers of nodes of `what`, which are 1 to `node_count`, from 0.
    pub fn node_numbers(&mut self, count: u64, node_count: u64, what: &str) -> Result<Vec<u32>> {
        let start = self.clone();
        let is_wrong = AtomicBool::new(false);
        let change = |part: &mut [u32]| count_from_zero(part, node_count, &is_wrong);
        let node = "the number of a node";
        let mut numbers: Vec<u32>;
        if count < FEW {
            numbers = self.numbers(NumberType::I32, count, node)?;
            change(&mut numbers);
        } else {
            numbers = self.changed_numbers(NumberType::I32, count, node, is_space, change)?;
        }
        if is_wrong.into_inner() {
            let wrong = numbers.iter().position(|&number| u64::from(number) >= node_count).unwrap_or(0);
            *self = start;
            self.skip_numbers(wrong as u64, 4)?;
            let found: u32 = self.number(NumberType::I32, node)?;
            let error = self.error(format!("{what} names a node that does not exist")).got(found);
            return Err(error.expected(format_args!("1 to {node_count}")));
        }
        Ok(numbers)
    }

    /// The part of the file from here to another position.
    pub fn range_to(&self, end: &Cursor) -> TextRange {
        TextRange::new(&self.source, self.position()..end.position())
    }

    /// The rest of this part of the file.
    pub fn rest(&self) -> TextRange {
        TextRange::new(&self.source, self.position()..self.end)
    }

    /// Moves behind the next occurrence of a mark, and returns the place where it begins; `None` where there is none.
    pub fn skip_past(&mut self, mark: &[u8]) -> Result<Option<u64>> {
        let first = mark.first().copied().unwrap_or(0);
        loop {
            let length = {
                let rest = &self.window[self.at..];
                // Blocks without the byte are passed at once.
                let has_first =
                    |block: &&[u8]| block.iter().fold(false, |found, &byte| found | (byte == first));
                let before: usize =
                    rest.chunks(BLOCK).take_while(|block| !has_first(block)).map(<[u8]>::len).sum();
                before + rest[before..].iter().take_while(|&&byte| byte != first).count()
            };
            self.line += line_ends(&self.window[self.at..self.at + length]);
            self.at += length;
            if self.left() < mark.len() as u64 {
                return Ok(None);
            }
            while self.window.len() - self.at < mark.len() {
                self.fill()?;
            }
            if self.window[self.at..].starts_with(mark) {
                let place = self.position();
                self.at += mark.len();
                return Ok(Some(place));
            }
            self.at += usize::from(self.window[self.at] == first);
        }
    }

    /// A number of text, or one of this type in the byte order of the file.
    pub fn number<T: Target>(&mut self, number_type: NumberType, what: &str) -> Result<T> {
        let mut value = [T::default()];
        let failed = match self.binary {
            Some(order) => {
                let size = number_type.size().unwrap_or(1);
                convert(number_type, order, self.bytes(size)?, &mut value).err().map(|_| Error::run(""))
            }
            None => {
                let Some(word) = self.word()? else {
                    return Err(self.error("the file ends early").expected(what));
                };
                match numbers::parse(number_type, word) {
                    Ok(parsed) => {
                        value = [parsed];
                        None
                    }
                    Err(error) => Some(error),
                }
            }
        };
        match failed {
            None => Ok(value[0]),
            Some(error) => {
                let found = error.got.unwrap_or_else(|| "a number out of range".to_owned());
                Err(self.error("a number is damaged").got(found).expected(what))
            }
        }
    }
}

#[cfg(test)]
#[path = "cursor_tests.rs"]
mod tests;
