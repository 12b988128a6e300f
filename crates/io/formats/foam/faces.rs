//! Faces of a mesh: lists of points, "4(0 1 2 3)". Text is parsed side by side as long as faces are written so, and word by word from the first
//! one on that is not: comments stand between them, or something is wrong, whose line is said.

use super::file::{FoamFile, is_between};
use crate::formats::text::TextPiece;
use voltet_core::{Error, Result};

impl FoamFile {
    /// Points of all faces, and the ends of the faces' parts.
    pub fn faces(&mut self) -> Result<(Vec<u32>, Vec<u32>)> {
        if self.class == "faceCompactList" {
            let mut ends = self.labels()?;
            let points = self.labels()?;
            if ends.first() != Some(&0) || !ends.is_sorted() || ends.last() != Some(&(points.len() as u32)) {
                let error = self.cursor.error("the faces are damaged");
                return Err(error.expected("ascending offsets from 0 to the number of their points"));
            }
            ends.remove(0);
            return Ok((points, ends));
        }
        if self.binary.is_some() {
            let error = self.cursor.error("faces of this class are not read from bytes").got(&self.class);
            return Err(error.expected("faceCompactList"));
        }
        let (count, _) = self.list_head()?;
        let (mut points, mut ends, mut rest) = (Vec::new(), Vec::<u32>::new(), None);
        let range = self.cursor.rest();
        range.each_piece(
            |rest| rest[0] == b')',
            |piece| Ok(plain_faces(piece)),
            |faces| {
                let is_more = (ends.len() + faces.lengths.len()) as u64 > count;
                if is_more || points.len() + faces.points.len() > u32::MAX as usize {
                    rest = Some((faces.start, false));
                    return Ok(false);
                }
                points.extend_from_slice(&faces.points);
                ends.extend(faces.lengths.iter().scan(ends.last().copied().unwrap_or(0), |end, length| {
                    *end += length;
                    Some(*end)
                }));
                rest = faces.rest;
                Ok(rest.is_none())
            },
        )?;
        let Some((rest, is_end)) = rest else {
            let error = Error::run("a list ends early").got(ends.len());
            return Err(range.locate_end(error.expected(format_args!("{count} faces"))));
        };
        if is_end && ends.len() as u64 == count {
            return Ok((points, ends));
        }
        // What is written in another way is read word by word, and so is what is wrong.
        self.cursor.go_to(rest)?;
        while (ends.len() as u64) < count {
            if self.cursor.peek()? == Some(b')') {
                let error = self.cursor.error("a list ends early").got(ends.len());
                return Err(error.expected(format_args!("{count} faces")));
            }
            self.face(&mut points)?;
            ends.push(u32::try_from(points.len()).map_err(|_| {
                let error = self.cursor.error("the faces have too many points").got(points.len());
                error.expected(format_args!("at most {}", u32::MAX))
            })?);
        }
        self.end_list(count)?;
        Ok((points, ends))
    }

    fn face(&mut self, points: &mut Vec<u32>) -> Result<()> {
        let (count, is_uniform) = self.list_head()?;
        if is_uniform {
            return Err(self.cursor.error("a list of labels holds one value for all").expected("each label"));
        }
        for passed in 0..count {
            if let Some(b'(' | b')') = self.cursor.peek()? {
                let error = self.cursor.error("a list is shorter than its length says").got(passed);
                return Err(error.expected(format_args!("{count} points")));
            }
            points.push(self.number(self.label)?);
        }
        self.end_list(count)
    }
}

struct PlainFaces {
    /// Place in the file.
    start: u64,
    points: Vec<u32>,
    lengths: Vec<u32>,
    /// Place in the file of the first word that begins no face as most are written, and true if it ends the list.
    rest: Option<(u64, bool)>,
}

/// The faces of a piece up to one that is not written as "4(0 1 2 3)".
fn plain_faces(piece: &TextPiece) -> PlainFaces {
    let start = piece.place(piece.bytes);
    let mut faces = PlainFaces { start, points: Vec::new(), lengths: Vec::new(), rest: None };
    let mut text = piece.bytes.trim_ascii_start();
    while !text.is_empty() {
        let known = faces.points.len();
        let Some((length, after)) = plain_face(text, &mut faces.points) else {
            faces.points.truncate(known);
            faces.rest = Some((piece.place(text), text[0] == b')'));
            break;
        };
        faces.lengths.push(length);
        text = after.trim_ascii_start();
    }
    faces
}

/// Adds the points of a face; its length, and what follows it.
fn plain_face<'a>(text: &'a [u8], points: &mut Vec<u32>) -> Option<(u32, &'a [u8])> {
    let (length, text) = plain_label(text)?;
    let mut text = text.trim_ascii_start().strip_prefix(b"(")?.trim_ascii_start();
    for _ in 0..length {
        let (point, after) = plain_label(text)?;
        points.push(point);
        text = after.trim_ascii_start();
    }
    Some((length, text.strip_prefix(b")")?))
}

/// A label of digits alone, and what follows it.
fn plain_label(text: &[u8]) -> Option<(u32, &[u8])> {
    let (mut value, mut at) = (0_u32, 0);
    while let Some(digit) = text.get(at).map(|byte| byte.wrapping_sub(b'0')).filter(|digit| *digit <= 9) {
        value = value.checked_mul(10)?.checked_add(digit.into())?;
        at += 1;
    }
    let is_word = text.get(at).is_none_or(|&byte| is_between(byte));
    (at > 0 && is_word).then_some((value, &text[at..]))
}
