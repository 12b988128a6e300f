//! OBJ (Wavefront): points `v`, normals `vn` and faces `f`. Materials, textures, curves and the rest are passed over.

use crate::formats::numbers::{NumberType, parse, words};
use crate::formats::polygons::Polygons;
use glam::DVec3;
use std::collections::HashMap;
use voltet_core::{Error, Result};

/// A corner without a normal.
const NONE: u32 = u32::MAX;

/// Reads the faces. A point with several normals becomes several points; without a normal at each corner there are none.
pub(super) fn read(bytes: &[u8]) -> Result<Polygons> {
    let (mut points, mut normals) = (Vec::<DVec3>::new(), Vec::<DVec3>::new());
    let mut corners: Vec<[u32; 2]> = Vec::new();
    let mut polygons = Polygons::default();
    for (line, text) in bytes.split(|&byte| byte == b'\n').enumerate() {
        let mut words = words(text);
        let of_line = || {
            match words.next() {
                Some(b"v") => points.push(vector(words)?),
                Some(b"vn") => normals.push(vector(words)?),
                Some(b"f") => {
                    for word in words {
                        corners.push(corner(word, [points.len(), normals.len()])?);
                    }
                    polygons.ends.push(corners.len());
                }
                Some(b"p" | b"l") => polygons.left_out += 1,
                _ => {}
            }
            Ok(())
        };
        of_line().map_err(|error: Error| error.at_line(line + 1))?;
    }
    if points.is_empty() {
        return Err(Error::run("the OBJ file holds no points").expected("lines 'v x y z' and 'f 1 2 3'"));
    }
    if corners.iter().any(|corner| corner[1] == NONE) {
        (polygons.points, polygons.corners) = (points, corners.into_iter().map(|[p, _]| p).collect());
        return Ok(polygons);
    }
    let mut known = HashMap::new();
    for corner in corners {
        let next = known.len() as u32;
        let number = *known.entry(corner).or_insert(next);
        if number == next {
            polygons.points.push(points[corner[0] as usize]);
            polygons.normals.push(normals[corner[1] as usize]);
        }
        polygons.corners.push(number);
    }
    Ok(polygons)
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
            let error = Error::run("a face has a point or normal that does not exist").got(from_one);
            error.expected(format!("1 to {count}, or -{count} to -1"))
        })
    };
    match [number(0, counts[0])?, number(1, counts[1])?] {
        [NONE, _] => Err(Error::run("a corner of a face has no point").got(String::from_utf8_lossy(word))),
        numbers => Ok(numbers),
    }
}
