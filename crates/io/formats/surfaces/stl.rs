//! STL: triangles by the coordinates of their corners, in ASCII or binary.
//!
//! A file is binary where its length is what its number of triangles takes, whatever its header says: "solid" begins some of them.

use crate::formats::elements::Elements;
use crate::formats::numbers::{NumberType, parse, words};
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use voltet_core::{Error, Result, counted};

/// Bytes before the triangles of a binary file: a header, and their number.
const HEAD: usize = 84;
/// Bytes of one: a normal, three corners, two bytes of attributes.
const TRIANGLE: usize = 50;

/// Reads the triangles; corners at one place are one point.
pub(super) fn read(bytes: &[u8]) -> Result<Elements> {
    let mut corners = Corners::default();
    let count = bytes.get(HEAD - 4..HEAD).and_then(|count| count.try_into().ok()).map(u32::from_le_bytes);
    let needed = count.map(|count| HEAD as u64 + TRIANGLE as u64 * u64::from(count));
    let is_text = bytes.trim_ascii_start().to_ascii_lowercase().starts_with(b"solid");
    match needed {
        Some(needed) if needed == bytes.len() as u64 || !is_text && needed < bytes.len() as u64 => {
            let triangles = bytes[HEAD..needed as usize].as_chunks::<TRIANGLE>().0;
            triangles.iter().for_each(|triangle| corners.add_binary(triangle));
        }
        _ if is_text => corners.add_text(bytes)?,
        Some(needed) => {
            let error = Error::run("the STL file ends early").got(counted(bytes.len(), "byte"));
            return Err(error.expected(counted(needed, "byte")));
        }
        None => {
            let error = Error::run("this is no STL file").got(counted(bytes.len(), "byte"));
            return Err(error.expected("'solid …', or 84 bytes and 50 for each triangle"));
        }
    }
    Ok(corners.elements)
}

#[derive(Default)]
struct Corners {
    elements: Elements,
    known: HashMap<[u64; 3], u32>,
}

impl Corners {
    /// The number of the point at a place.
    fn number(&mut self, at: DVec3) -> u32 {
        let points = &mut self.elements.points;
        // Zero and minus zero are one place.
        *self.known.entry((at + 0.0).to_array().map(f64::to_bits)).or_insert_with(|| {
            points.push(at);
            (points.len() - 1) as u32
        })
    }

    fn add_binary(&mut self, triangle: &[u8; TRIANGLE]) {
        let numbers: Vec<f32> =
            triangle.as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)).collect();
        let corners = [3, 6, 9].map(|k| self.number(Vec3::from_slice(&numbers[k..]).into()));
        self.elements.add_polygon(corners);
    }

    fn add_text(&mut self, bytes: &[u8]) -> Result<()> {
        let (mut loop_corners, mut is_open) = (Vec::new(), false);
        for (line, text) in bytes.split(|&byte| byte == b'\n').enumerate() {
            let mut words = words(text);
            let Some(keyword) = words.next() else { continue };
            let wrong = |what: &str, accepted: &str| {
                Error::run(what)
                    .got(format!("'{}'", String::from_utf8_lossy(&keyword[..keyword.len().min(40)])))
                    .expected(accepted)
                    .at_line(line + 1)
            };
            match keyword.to_ascii_lowercase().as_slice() {
                b"solid" if !is_open => is_open = true,
                b"endsolid" if is_open => is_open = false,
                b"facet" | b"outer" | b"endfacet" if is_open => {}
                b"vertex" if is_open => {
                    let at: Vec<f64> = words
                        .map(|word| parse(NumberType::F64, word))
                        .collect::<Result<_>>()
                        .map_err(|error| error.at_line(line + 1))?;
                    let at: [f64; 3] =
                        at.try_into().map_err(|_| wrong("a corner is wrong", "vertex and three numbers"))?;
                    loop_corners.push(self.number(at.into()));
                }
                b"endloop" if is_open && loop_corners.len() >= 3 => {
                    self.elements.add_polygon(loop_corners.drain(..))
                }
                b"endloop" => {
                    return Err(wrong("a loop has fewer than three corners", "three lines 'vertex x y z'"));
                }
                _ => {
                    return Err(wrong(
                        "a line of the STL file is out of place",
                        "solid, facet, outer loop, vertex, endloop, endfacet, endsolid",
                    ));
                }
            }
        }
        match is_open || !loop_corners.is_empty() {
            true => Err(Error::run("the STL file ends early").expected("endsolid")),
            false => Ok(()),
        }
    }
}
