//! OBJ (Wavefront): points `v`, normals `vn`, faces `f`, lines `l` and vertices `p`. Materials, textures, curves and the rest are passed
//! over.

use crate::formats::elements::{ElementKind, Elements};
use crate::formats::numbers::{NumberType, parse, words};
use glam::DVec3;
use std::collections::HashMap;
use voltet_core::{Error, Result};

/// A corner without a normal.
const NONE: u32 = u32::MAX;

/// Reads the elements. A point with several normals becomes several points; without a normal at each corner of a face there are none.
pub(super) fn read(bytes: &[u8]) -> Result<Elements> {
    let (mut points, mut normals) = (Vec::<DVec3>::new(), Vec::<DVec3>::new());
    let mut corners: Vec<[u32; 2]> = Vec::new();
    let (mut elements, mut has_normals) = (Elements::default(), true);
    for (line, text) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let mut words = words(text);
        let of_line = || {
            match words.next() {
                Some(b"v") => points.push(vector(words)?),
                Some(b"vn") => normals.push(vector(words)?),
                Some(word @ (b"f" | b"l" | b"p")) => {
                    let kind = match word {
                        b"f" => ElementKind::Polygon,
                        b"l" => ElementKind::Line,
                        _ => ElementKind::Vertices,
                    };
                    for word in words {
                        let corner = corner(word, [points.len(), normals.len()])?;
                        has_normals &= kind != ElementKind::Polygon || corner[1] != NONE;
                        corners.push(corner);
                    }
                    elements.kinds.push((kind, corners.len()));
                }
                _ => {}
            }
            Ok(())
        };
        of_line().map_err(|error: Error| error.at_line(line + 1))?;
    }
    if points.is_empty() {
        return Err(Error::run("the OBJ file holds no points").expected("lines 'v x y z' and 'f 1 2 3'"));
    }
    if !has_normals || normals.is_empty() {
        (elements.points, elements.corners) = (points, corners.into_iter().map(|[p, _]| p).collect());
        return Ok(elements);
    }
    let mut known = HashMap::new();
    for corner @ [point, normal] in corners {
        let next = known.len() as u32;
        let number = *known.entry(corner).or_insert(next);
        if number == next {
            elements.points.push(points[point as usize]);
            // Lines and vertices have none.
            elements.normals.push(normals.get(normal as usize).copied().unwrap_or(DVec3::Z));
        }
        elements.corners.push(number);
    }
    Ok(elements)
}

/// The first three numbers: some writers add a weight or a colour.
fn vector<'a>(words: impl Iterator<Item = &'a [u8]>) -> Result<DVec3> {
    let numbers: Vec<f64> = words.take(3).map(|word| parse(NumberType::F64, word)).collect::<Result<_>>()?;
    match numbers[..] {
        [x, y, z] => Ok(DVec3::new(x, y, z)),
        _ => Err(Error::run("a point or normal is wrong").got(numbers.len()).expected("three numbers")),
    }
}

/// Numbers of a corner's point and normal from `7`, `7/3`, `7//5` or `7/3/5`: from 1, or from the end where negative.
fn corner(word: &[u8], counts: [usize; 2]) -> Result<[u32; 2]> {
    let mut parts = word.split(|&byte| byte == b'/');
    let mut number = |skipped: usize, count: usize| -> Result<u32> {
        let Some(part) = parts.nth(skipped).filter(|part| !part.is_empty()) else { return Ok(NONE) };
        let from_one: i64 = parse(NumberType::I64, part)?;
        let place = match from_one {
            1.. => from_one.checked_sub(1),
            _ => from_one.checked_add(count as i64).filter(|_| from_one < 0),
        };
        let known = place.filter(|place| (0..count as i64).contains(place));
        known.and_then(|place| u32::try_from(place).ok()).ok_or_else(|| {
            let error = Error::run("an element has a point or normal that does not exist").got(from_one);
            error.expected(format!("1 to {count}, or -{count} to -1"))
        })
    };
    match [number(0, counts[0])?, number(1, counts[1])?] {
        [NONE, _] => {
            Err(Error::run("a corner of an element has no point").got(String::from_utf8_lossy(word)))
        }
        numbers => Ok(numbers),
    }
}
