//! What the two processes say to each other.

use super::declarations::{read_declared, write_declared};
use super::wire::{self, Reader, Writer};
use crate::describe::Declared;
use crate::outcome::Said;
use crate::values::Owned;
use crate::work::Given;
use std::io::{self, Read, Write};
use std::sync::Arc;
use voltet_core::field::Fallback;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Grid};
use voltet_core::{Error, Result};

/// What is asked of the process.
pub(crate) enum Request {
    Describe,
    /// Check these values for the filter of that name.
    Check(String, Owned),
    /// Compute the gradient.
    Gradient(String, Box<Given>),
}

/// What it answers. Only `Progress` is followed by more; `Said` of a gradient by `Vectors`.
pub(crate) enum Answer {
    Progress(f64),
    /// Name and version of the plug-in, and its filters.
    Described([String; 2], Vec<Declared>),
    /// Why it could not be loaded: what, found, accepted.
    Failed([String; 3]),
    Said(Said),
    Vectors(Vec<DVec3>),
}

const DESCRIBE: u8 = b'd';
const CHECK: u8 = b'c';
const GRADIENT: u8 = b'g';
const PROGRESS: u8 = b'P';
const DESCRIBED: u8 = b'D';
const FAILED: u8 = b'F';
const SAID: u8 = b'S';
const VECTORS: u8 = b'V';

fn garbled() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a message is not as agreed")
}

impl Request {
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        let mut head = Writer::default();
        let tag = match self {
            Request::Describe => DESCRIBE,
            Request::Check(name, values) => {
                head.text(name);
                values.write(&mut head);
                CHECK
            }
            Request::Gradient(name, given) => {
                head.text(name);
                given.values.write(&mut head);
                head.number(given.grid.points.len() as u64);
                head.number(given.grid.tetrahedra.len() as u64);
                head.number(given.arrays.len() as u64);
                for array in &given.arrays {
                    head.optional(array.as_ref(), |head, array| head.number(array.component_count as u64));
                }
                GRADIENT
            }
        };
        wire::send(to, tag, &head.0)?;
        if let Request::Gradient(_, given) = self {
            to.write_all(bytemuck::cast_slice(&given.grid.points[..]))?;
            to.write_all(bytemuck::cast_slice(&given.grid.tetrahedra[..]))?;
            to.write_all(bytemuck::cast_slice(&given.scalar))?;
            for array in given.arrays.iter().flatten() {
                to.write_all(bytemuck::cast_slice(&array.values))?;
            }
        }
        to.flush()
    }

    pub fn read(from: &mut impl Read) -> io::Result<Request> {
        let (tag, length) = wire::head(from)?.ok_or_else(garbled)?;
        let bytes = wire::body(from, length)?;
        let mut reader = Reader(&bytes);
        let request = match tag {
            DESCRIBE => Some(Request::Describe),
            CHECK => {
                reader.text().zip(Owned::read(&mut reader)).map(|(name, values)| Request::Check(name, values))
            }
            GRADIENT => {
                let name = reader.text().ok_or_else(garbled)?;
                return Ok(Request::Gradient(name, Box::new(given(reader, from)?)));
            }
            _ => None,
        };
        request.ok_or_else(garbled)
    }
}

fn given(mut head: Reader, from: &mut impl Read) -> io::Result<Given> {
    let mut stated = || {
        let values = Owned::read(&mut head)?;
        let points = usize::try_from(head.number()?).ok()?;
        let cells = usize::try_from(head.number()?).ok()?;
        let arrays = head.list(|head| head.optional(Reader::number))?;
        Some((values, points, cells, arrays))
    };
    let (values, point_count, cell_count, components) = stated().ok_or_else(garbled)?;
    let points = wire::array::<DVec3>(from, point_count)?.into();
    let tetrahedra = wire::array::<[u32; 4]>(from, cell_count)?.into();
    let scalar = wire::array::<f64>(from, point_count)?;
    let arrays = components.into_iter().map(|components| {
        let Some(components) = components.map(|n| n as usize) else { return Ok(None) };
        let values = wire::array::<f64>(from, components * point_count)?.into();
        Ok(Some(Arc::new(Array { component_count: components, values })))
    });
    let arrays = arrays.collect::<io::Result<_>>()?;
    Ok(Given { grid: Grid { points, tetrahedra, ..Grid::default() }, scalar, values, arrays })
}

impl Answer {
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        let mut body = Writer::default();
        let tag = match self {
            Answer::Vectors(vectors) => {
                wire::send(to, VECTORS, bytemuck::cast_slice(vectors))?;
                return to.flush();
            }
            Answer::Progress(fraction) => {
                body.float(*fraction);
                PROGRESS
            }
            Answer::Described(plugin, filters) => {
                plugin.iter().for_each(|text| body.text(text));
                body.number(filters.len() as u64);
                filters.iter().for_each(|filter| write_declared(&mut body, filter));
                DESCRIBED
            }
            Answer::Failed(texts) => {
                texts.iter().for_each(|text| body.text(text));
                FAILED
            }
            Answer::Said(said) => {
                body.number(said.code as u64);
                body.number(u64::from(said.overran));
                body.optional(said.error.as_ref(), |body, text| body.text(text));
                body.number(said.fallbacks.len() as u64);
                for fallback in &said.fallbacks {
                    body.text(&fallback.what);
                    body.number(fallback.point_count);
                }
                SAID
            }
        };
        wire::send(to, tag, &body.0)?;
        to.flush()
    }

    /// The next; `None` at the end. `point_count`: of the vectors.
    pub fn read(from: &mut impl Read, point_count: usize) -> io::Result<Option<Answer>> {
        let Some((tag, length)) = wire::head(from)? else { return Ok(None) };
        if tag == VECTORS {
            if length != 24 * point_count as u64 {
                return Err(garbled());
            }
            return wire::array(from, point_count).map(|vectors| Some(Answer::Vectors(vectors)));
        }
        let bytes = wire::body(from, length)?;
        let mut reader = Reader(&bytes);
        let mut answer = || match tag {
            PROGRESS => reader.float().map(Answer::Progress),
            DESCRIBED => {
                let plugin = [reader.text()?, reader.text()?];
                Some(Answer::Described(plugin, reader.list(read_declared)?))
            }
            FAILED => Some(Answer::Failed([reader.text()?, reader.text()?, reader.text()?])),
            SAID => {
                let code = reader.number()? as i32;
                let overran = reader.number()? == 1;
                let error = reader.optional(Reader::text)?;
                let fallback = |reader: &mut Reader| {
                    Some(Fallback { what: reader.text()?, point_count: reader.number()? })
                };
                Some(Answer::Said(Said { code, error, fallbacks: reader.list(fallback)?, overran }))
            }
            _ => None,
        };
        answer().map(Some).ok_or_else(garbled)
    }
}

/// An error as texts.
pub(crate) fn failed(error: &Error) -> Answer {
    let [found, accepted] = [&error.found, &error.accepted].map(|text| text.clone().unwrap_or_default());
    Answer::Failed([error.what.clone(), found, accepted])
}

/// The error again.
pub(crate) fn failure<T>([what, found, accepted]: [String; 3]) -> Result<T> {
    let mut error = Error::usage(what);
    error.found = (!found.is_empty()).then_some(found);
    error.accepted = (!accepted.is_empty()).then_some(accepted);
    Err(error)
}
