//! Tables of text that several threads parse. A range of a file is cut between words or behind lines; the pieces are parsed side by side,
//! and what they give comes in the order of the file. The line of an error is counted once there is one.

use super::numbers::{self, NumberType, Target};
use super::source::Source;
use rayon::prelude::*;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use voltet_core::{Error, Result};

/// Bytes of a piece.
const PIECE: u64 = 1 << 18;
/// Pieces of a thread that are parsed while those before them are taken.
const PIECES_OF_THREAD: usize = 4;
/// Bytes behind a piece that are read with it, for the end of its last word or line.
const AHEAD: u64 = 1 << 9;
/// Bytes behind an end that tell it.
const LOOK_AHEAD: usize = 16;
/// No word or line of a sound file is longer.
const LONGEST: usize = 1 << 22;

/// Bytes whose words are counted at once.
pub(super) const BLOCK: usize = 254;

/// White space of text.
#[inline]
pub(super) fn is_space(byte: u8) -> bool {
    // Without branches, so that many bytes are compared at once.
    (byte == b' ') | (byte == b'\n') | (byte == b'\t') | (byte == b'\r') | (byte == b'\x0c')
}

pub(super) fn has_mark(head: &[u8], mark: &str) -> bool {
    head.windows(mark.len()).any(|window| window == mark.as_bytes())
}

pub(super) fn line_ends(bytes: &[u8]) -> usize {
    let of_part = |part: &[u8]| part.iter().map(|&byte| u8::from(byte == b'\n')).sum::<u8>();
    bytes.chunks(255).map(|part| usize::from(of_part(part))).sum()
}

/// Number of words that begin in these bytes, at most 255 of them; `before`: true if a word may begin with the first.
#[inline]
pub(super) fn word_starts(bytes: &[u8], before: bool, is_between: impl Fn(u8) -> bool) -> u8 {
    let first = bytes.first().is_some_and(|&byte| before && !is_between(byte));
    let pairs = bytes.iter().zip(bytes.get(1..).unwrap_or(&[]));
    u8::from(first) + pairs.map(|(&a, &b)| u8::from(is_between(a) & !is_between(b))).sum::<u8>()
}

/// The next word of these bytes, and what follows it; an empty one at the end.
#[inline]
pub(super) fn next_word(bytes: &[u8], is_between: impl Fn(u8) -> bool) -> (&[u8], &[u8]) {
    let begin = bytes.iter().position(|&byte| !is_between(byte)).unwrap_or(bytes.len());
    let word = &bytes[begin..];
    word.split_at(word.iter().position(|&byte| is_between(byte)).unwrap_or(word.len()))
}

#[derive(Clone)]
pub(super) struct TextRange {
    source: Arc<Source>,
    start: u64,
    end: u64,
}

/// A piece of a range: whole words, or whole lines.
pub(super) struct TextPiece<'a> {
    range: &'a TextRange,
    start: u64,
    pub bytes: &'a [u8],
}

/// Progress of who takes the numbers of a stream: how many of those that were shown are used up; `None`: no more are needed.
/// Errors: the place of the wrong one among those shown.
pub(super) type Consumption = std::result::Result<Option<usize>, (usize, Error)>;

/// True if a cut follows the first of some bytes.
type IsEnd<'a> = dyn Fn(&[u8]) -> bool + Sync + 'a;

impl TextPiece<'_> {
    /// The lines with their ends cut off.
    pub fn lines(&self) -> impl Iterator<Item = &[u8]> {
        let lines = self.bytes.split_inclusive(|&byte| byte == b'\n');
        lines.map(|line| match line {
            [line @ .., b'\r', b'\n'] | [line @ .., b'\n' | b'\r'] | line => line,
        })
    }

    /// Place in the file of a word or line of this piece.
    pub fn place(&self, part: &[u8]) -> u64 {
        let place = part.as_ptr().addr().saturating_sub(self.bytes.as_ptr().addr()).min(self.bytes.len());
        self.start + place as u64
    }

    /// An error about a word or line of this piece.
    pub fn locate(&self, error: Error, part: &[u8]) -> Error {
        self.range.locate(error, self.place(part))
    }
}

impl TextRange {
    /// The bytes of a file from one place to another, which must lie in it.
    pub fn new(source: &Arc<Source>, bytes: Range<u64>) -> TextRange {
        TextRange { source: source.clone(), start: bytes.start, end: bytes.end.min(source.len()) }
    }

    pub fn len(&self) -> u64 {
        self.end.saturating_sub(self.start)
    }

    pub fn path(&self) -> &Path {
        self.source.path()
    }

    /// The part from a place in the file on.
    pub fn from(&self, start: u64) -> TextRange {
        TextRange { start: self.start.max(start), ..self.clone() }
    }

    /// The part before a place in the file.
    pub fn until(&self, end: u64) -> TextRange {
        TextRange { end: self.end.min(end), ..self.clone() }
    }

    pub fn locate_end(&self, error: Error) -> Error {
        self.locate(error, self.end)
    }

    /// An error with the line of a place in the file.
    pub fn locate(&self, error: Error, place: u64) -> Error {
        let (mut at, mut line, mut buffer) = (0, 1, Vec::new());
        while at < place {
            buffer.resize((place - at).min(PIECE) as usize, 0);
            if self.source.read_at(at, &mut buffer).is_err() {
                return error;
            }
            at += buffer.len() as u64;
            line += line_ends(&buffer);
        }
        error.at_line(line)
    }

    /// Parses all pieces; `is_end`: true where a cut follows the first of the bytes, which are of one piece and maybe of the next. `take`
    /// gets what they give, in order, while the next are parsed; it gives false if it needs no more.
    pub fn each_piece<R: Send>(
        &self,
        is_end: impl Fn(&[u8]) -> bool + Sync,
        parse: impl Fn(&TextPiece) -> Result<R> + Sync,
        mut take: impl FnMut(R) -> Result<bool>,
    ) -> Result<()> {
        self.each_piece_of(&is_end, &parse, &mut take)
    }

    /// As [`TextRange::each_piece`], compiled once for all that parse to the same.
    fn each_piece_of<R: Send>(
        &self,
        is_end: &IsEnd,
        parse: &(dyn Fn(&TextPiece) -> Result<R> + Sync),
        take: &mut dyn FnMut(R) -> Result<bool>,
    ) -> Result<()> {
        let count = self.len().div_ceil(PIECE) as usize;
        let step = rayon::current_num_threads().max(1) * PIECES_OF_THREAD;
        let parsed = |first: usize| -> Vec<Result<R>> {
            let pieces = first..count.min(first.saturating_add(step));
            let of_piece = |buffer: &mut Vec<u8>, index| {
                let (start, bytes) = self.piece(index, is_end, buffer)?;
                parse(&TextPiece { range: self, start, bytes })
            };
            pieces.into_par_iter().map_init(Vec::new, of_piece).collect()
        };
        let (mut first, mut ready) = (0, parsed(0));
        while !ready.is_empty() {
            first += step;
            let mut next = Vec::new();
            let goes_on = rayon::in_place_scope(|scope| -> Result<bool> {
                if first < count {
                    scope.spawn(|_| next = parsed(first));
                }
                for result in std::mem::take(&mut ready) {
                    if !take(result?)? {
                        return Ok(false);
                    }
                }
                Ok(true)
            })?;
            ready = if goes_on { next } else { Vec::new() };
        }
        Ok(())
    }

    /// Place and bytes of a piece.
    fn piece<'b>(&self, index: usize, is_end: &IsEnd, buffer: &'b mut Vec<u8>) -> Result<(u64, &'b [u8])> {
        let first = self.start + index as u64 * PIECE;
        let last = self.end.min(first + PIECE);
        // The byte before tells whether the first is a beginning.
        let from = first - u64::from(index > 0);
        buffer.resize((self.end.min(last + AHEAD) - from) as usize, 0);
        self.source.read_at(from, buffer)?;
        let begin = match index {
            0 => 0,
            // A piece without a cut belongs to the one before.
            _ => match (0..(last - from) as usize).find(|&place| is_end(&buffer[place..])) {
                Some(found) => found + 1,
                None => return Ok((last, &[])),
            },
        };
        let end = match last == self.end {
            true => buffer.len(),
            false => self.cut(from, (last - from) as usize - 1, is_end, buffer)?,
        };
        Ok((from + begin as u64, &buffer[begin..end.max(begin)]))
    }

    /// Place behind the first cut in the buffer, which begins at `from` of the file, from a place on; more is read if there is none.
    fn cut(&self, from: u64, at: usize, is_end: &IsEnd, buffer: &mut Vec<u8>) -> Result<usize> {
        let (mut place, mut line) = (at, at);
        loop {
            if let Some(found) = (place..buffer.len()).find(|&place| is_end(&buffer[place..])) {
                return Ok(found + 1);
            }
            line = buffer[place..].iter().rposition(|&byte| byte == b'\n').map_or(line, |end| place + end);
            place = buffer.len();
            let more = (self.end - from - place as u64).min(PIECE);
            if more == 0 {
                return Ok(place);
            }
            if place - line > LONGEST {
                return Err(self.locate(Error::run("a word or line is too long"), from + line as u64));
            }
            buffer.resize(place + more as usize, 0);
            self.source.read_at(from + place as u64, &mut buffer[place..])?;
            // The last bytes may be an end once those after them are there.
            place = place.saturating_sub(LOOK_AHEAD).max(at);
        }
    }

    /// All numbers of the range, added to others; `advance` hears of the bytes that were parsed.
    pub fn numbers<T: Target>(
        &self,
        number_type: NumberType,
        is_between: impl Fn(u8) -> bool + Sync + Copy,
        to: &mut Vec<T>,
        mut advance: impl FnMut(u64) -> Result<()>,
    ) -> Result<()> {
        let parse = |piece: &TextPiece| {
            let (values, damage) = parsed_numbers(piece, number_type, is_between);
            damage.map_or(Ok((values, piece.bytes.len() as u64)), Err)
        };
        self.each_piece(
            |rest| is_between(rest[0]),
            parse,
            |(values, bytes)| {
                to.extend_from_slice(&values);
                advance(bytes).map(|()| true)
            },
        )
    }

    /// Parses lines without their ends, each into what a piece gives; `take` gets that in order.
    pub fn lines<R: Default + Send>(
        &self,
        parse: impl Fn(&[u8], &mut R) -> Result<()> + Sync,
        mut take: impl FnMut(R) -> Result<()>,
    ) -> Result<()> {
        let parse = |piece: &TextPiece| {
            let mut rows = R::default();
            for line in piece.lines() {
                parse(line, &mut rows).map_err(|error| piece.locate(error, line))?;
            }
            Ok(rows)
        };
        self.each_piece(|rest| rest[0] == b'\n', parse, |rows| take(rows).map(|()| true))
    }

    /// Parses lines without their ends; `take` gets the rows that they give, in order.
    pub fn rows<T: Send>(
        &self,
        parse: impl Fn(&[u8], &mut Vec<T>) -> Result<()> + Sync,
        mut take: impl FnMut(T) -> Result<()>,
    ) -> Result<()> {
        self.lines(parse, |rows: Vec<T>| rows.into_iter().try_for_each(&mut take))
    }

    /// Shows numbers in their order to `take`; those that it does not use up it is shown again before the next. A word that is no number
    /// is an error once all before it were shown and more are needed. Gives false if the range ends before `take` has enough.
    pub fn stream<T: Target>(
        &self,
        number_type: NumberType,
        is_between: impl Fn(u8) -> bool + Sync + Copy,
        mut take: impl FnMut(&[T]) -> Consumption,
    ) -> Result<bool> {
        let (mut left, mut used): (Vec<T>, u64) = (Vec::new(), 0);
        let mut has_enough = false;
        self.each_piece(
            |rest| is_between(rest[0]),
            |piece| Ok(parsed_numbers(piece, number_type, is_between)),
            |(values, damage)| {
                match left.is_empty() {
                    true => left = values,
                    false => left.extend_from_slice(&values),
                }
                let Some(count) = take(&left).map_err(|(place, error)| {
                    self.locate(error, self.place_of_word(used + place as u64, is_between))
                })?
                else {
                    has_enough = true;
                    return Ok(false);
                };
                used += count as u64;
                left.drain(..count);
                damage.map_or(Ok(true), Err)
            },
        )?;
        Ok(has_enough)
    }

    pub fn word_count(&self) -> Result<u64> {
        let mut count = 0;
        let of_piece = |piece: &TextPiece| {
            let blocks = piece.bytes.chunks(BLOCK).scan(true, |may_begin, block| {
                let starts = word_starts(block, *may_begin, is_space);
                *may_begin = block.last().is_some_and(|&last| is_space(last));
                Some(u64::from(starts))
            });
            Ok(blocks.sum::<u64>())
        };
        self.each_piece(
            |rest| is_space(rest[0]),
            of_piece,
            |words| {
                count += words;
                Ok(true)
            },
        )?;
        Ok(count)
    }

    /// True if a byte stands somewhere in the range.
    pub fn contains(&self, byte: u8) -> Result<bool> {
        let mut is_found = false;
        let has_byte = |part: &[u8]| part.iter().fold(false, |found, &own| found | (own == byte));
        let of_piece = |piece: &TextPiece| Ok(piece.bytes.chunks(255).any(has_byte));
        self.each_piece(
            |rest| is_space(rest[0]),
            of_piece,
            |found| {
                is_found |= found;
                Ok(!is_found)
            },
        )?;
        Ok(is_found)
    }

    /// Place in the file of a word by its number in the range.
    fn place_of_word(&self, number: u64, is_between: impl Fn(u8) -> bool + Sync + Copy) -> u64 {
        let (mut before, mut found) = (0, self.end);
        let starts = |piece: &TextPiece| {
            let (mut starts, mut rest) = (Vec::new(), piece.bytes);
            loop {
                let (word, after) = next_word(rest, is_between);
                if word.is_empty() {
                    return Ok(starts);
                }
                starts.push(piece.start + (piece.bytes.len() - after.len() - word.len()) as u64);
                rest = after;
            }
        };
        // What cannot be read any more was read before: the place stays at the end.
        let _ = self.each_piece(
            |rest| is_between(rest[0]),
            starts,
            |starts: Vec<u64>| {
                let place = usize::try_from(number - before).ok().and_then(|place| starts.get(place));
                before += starts.len() as u64;
                found = place.copied().unwrap_or(found);
                Ok(place.is_none())
            },
        );
        found
    }
}

/// Numbers of a piece up to its end, or to a word that is none.
fn parsed_numbers<T: Target>(
    piece: &TextPiece,
    number_type: NumberType,
    is_between: impl Fn(u8) -> bool + Copy,
) -> (Vec<T>, Option<Error>) {
    let mut values = Vec::with_capacity(piece.bytes.len() / 8 + 1);
    let mut rest = piece.bytes;
    loop {
        // Bytes with a sign may be written without.
        if number_type.is_integer() && number_type != NumberType::I8 {
            rest = whole_numbers(rest, is_between, &mut values);
        }
        let (word, after) = next_word(rest, is_between);
        if word.is_empty() {
            return (values, None);
        }
        match numbers::parse(number_type, word) {
            Ok(value) => values.push(value),
            Err(error) => return (values, Some(piece.locate(error, word))),
        }
        rest = after;
    }
}

/// Adds whole numbers of digits alone, while the target holds them; gives the bytes from the first other word on.
fn whole_numbers<'a, T: Target>(
    bytes: &'a [u8],
    is_between: impl Fn(u8) -> bool,
    to: &mut Vec<T>,
) -> &'a [u8] {
    let mut at = 0;
    loop {
        while bytes.get(at).is_some_and(|&byte| is_between(byte)) {
            at += 1;
        }
        let (begin, mut value) = (at, 0_i64);
        while let Some(digit) = bytes.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit <= 9)
        {
            value = value.wrapping_mul(10).wrapping_add(i64::from(digit));
            at += 1;
        }
        let is_word = bytes.get(at).is_none_or(|&byte| is_between(byte));
        // So many digits stay within 64 bits.
        let is_short = (1..=18).contains(&(at - begin));
        match T::from_i64(value) {
            (own, true) if is_word && is_short => to.push(own),
            _ => return &bytes[begin..],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file_of(text: &[u8]) -> (tempfile::TempDir, TextRange) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a");
        std::fs::write(&path, text).unwrap();
        let source = Source::open(&path).unwrap();
        let range = TextRange::new(&source, 0..source.len());
        (folder, range)
    }

    fn all(range: &TextRange) -> Result<Vec<u64>> {
        let mut to = Vec::new();
        range.numbers(NumberType::U64, is_space, &mut to, |_| Ok(())).map(|()| to)
    }

    #[test]
    fn numbers_come_in_order_whatever_the_cuts() {
        let count = 3 * PIECE / 8 * PIECES_OF_THREAD as u64;
        for shift in [0, 1, 7, AHEAD as usize + 3] {
            let text = " ".repeat(shift) + &(0..count).map(|i| format!("{i}\n")).collect::<String>();
            let (_folder, range) = file_of(text.trim_end().as_bytes());
            assert!(all(&range).unwrap().into_iter().eq(0..count));
        }
    }

    #[test]
    fn lines_longer_than_pieces_stay_whole() {
        let lengths = [5, PIECE as usize * 3, 1, 0, PIECE as usize - 1, 2 * PIECE as usize, 7];
        let text: String = lengths.iter().map(|&length| "x".repeat(length) + "\r\n").collect();
        let (_folder, range) = file_of(text.as_bytes());
        let mut found = Vec::new();
        let parse = |piece: &TextPiece| Ok(piece.lines().map(<[u8]>::len).collect::<Vec<_>>());
        range
            .each_piece(
                |rest| rest[0] == b'\n',
                parse,
                |own| {
                    found.extend(own);
                    Ok(true)
                },
            )
            .unwrap();
        assert_eq!(found, lengths);
        let (_folder, range) = file_of(&vec![b'x'; LONGEST + 3 * PIECE as usize]);
        let long = range.each_piece(|rest| rest[0] == b'\n', |_| Ok(()), |()| Ok(true)).unwrap_err();
        assert!(long.to_string().contains("too long"), "{long}");
    }

    #[test]
    fn many_lines_without_a_cut_stay_whole() {
        let comments = "$ a comment\n".repeat(LONGEST / 12 + 4 * PIECE as usize / 12);
        let (_folder, range) = file_of(format!("b\n{comments}a\n{comments}").as_bytes());
        let mut lengths = Vec::new();
        let read = range.each_piece(
            |rest| rest[0] == b'\n' && rest.get(1).is_some_and(u8::is_ascii_alphabetic),
            |piece| Ok(piece.bytes.len()),
            |length| {
                lengths.extend((length > 0).then_some(length));
                Ok(true)
            },
        );
        read.unwrap();
        assert_eq!(lengths, [2 + comments.len(), 2 + comments.len()]);
    }

    #[test]
    fn whole_numbers_end_before_other_words() {
        for (text, count) in [("1 23  4\n", 3), ("1 -2 3", 1), ("1 4294967296 2", 1), ("", 0), ("1 2x 3", 1)]
        {
            let mut found: Vec<u32> = Vec::new();
            let rest = whole_numbers(text.as_bytes(), is_space, &mut found);
            assert_eq!(found.len(), count, "{text}");
            assert_eq!(rest.first(), text.as_bytes().get(2).filter(|_| count == 1), "{text}");
        }
        let (_folder, range) = file_of(b"7 +8 009 -0 1234567890123456789");
        assert_eq!(all(&range).unwrap(), [7, 8, 9, 0, 1234567890123456789]);
    }

    #[test]
    fn errors_name_the_line_of_the_first_damaged_word() {
        let line = |number: usize| match number {
            70_000 | 150_000 => "x\n",
            _ => "1234567\n",
        };
        let text: String = (1..200_000).map(line).collect();
        let (_folder, range) = file_of(text.as_bytes());
        let error = all(&range).unwrap_err();
        assert_eq!(error.location.line_column, Some((70_000, 1)), "{error}");
    }

    #[test]
    fn a_stream_shows_what_is_left_again_and_stops_before_a_damaged_word() {
        let rows = 100_000_u64;
        let text: String = (0..rows).map(|i| format!("{i} 7 8\n")).collect::<String>() + "# 1";
        let (_folder, range) = file_of(text.as_bytes());
        let read = |limit: u64, wrong: u64| {
            let mut next = 0;
            let took = range.stream(NumberType::U64, is_space, |shown: &[u64]| {
                for (place, row) in shown.as_chunks::<3>().0.iter().enumerate() {
                    assert_eq!(*row, [next, 7, 8]);
                    if next == wrong {
                        return Err((3 * place + 1, Error::run("wrong")));
                    }
                    next += 1;
                    if next == limit {
                        return Ok(None);
                    }
                }
                Ok(Some(shown.len() / 3 * 3))
            });
            took.map(|took| (took, next))
        };
        assert_eq!(read(rows, rows).unwrap(), (true, rows));
        let line = |error: Error| error.location.line_column.map(|place| place.0 as u64);
        assert_eq!(line(read(rows + 1, rows).unwrap_err()), Some(rows + 1));
        assert_eq!(line(read(rows, 54_321).unwrap_err()), Some(54_322));
    }

    #[test]
    fn word_starts_are_counted_as_words_are_split() {
        let text = b"  a bc\t\td\r\ne f\x0cg ";
        for from in 0..text.len() {
            let words = text[from..].split(|&byte| is_space(byte)).filter(|word| !word.is_empty()).count();
            assert_eq!(usize::from(word_starts(&text[from..], true, is_space)), words, "{from}");
        }
        assert_eq!((word_starts(b"ab c", false, is_space), line_ends(&[b'\n'; 600])), (1, 600));
    }
}
