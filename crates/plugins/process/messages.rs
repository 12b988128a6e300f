//! What the two processes say to each other.

use super::declarations::{read_declared, write_declared};
use super::wire::{self, Reader, Writer};
use crate::describe::Declared;
use crate::outcome::{Beyond, Said};
use crate::task::{Outcome, Task};
use std::io::{self, Read, Write};
use voltet_core::field::Fallback;
use voltet_core::{Error, Result};

/// What is asked of the process.
pub(crate) enum Request {
    Describe,
    /// What the piece of that name shall do.
    Do(String, Task),
}

/// What it answers. `Progress` is followed by more, and `Said` by what was made.
pub(crate) enum Answer {
    Progress(f64),
    /// Name and version of the plug-in, and what it offers.
    Described([String; 2], Vec<Declared>),
    /// Why it could not be loaded: what, found, accepted.
    Failed([String; 3]),
    Said(Said),
    Made(Outcome),
}

const DESCRIBE: u8 = b'd';
const DO: u8 = b't';
const PROGRESS: u8 = b'P';
const DESCRIBED: u8 = b'D';
const FAILED: u8 = b'F';
const SAID: u8 = b'S';
const MADE: u8 = b'M';

pub(super) fn garbled() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "a message is not as agreed")
}

impl Request {
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        match self {
            Request::Describe => wire::send(to, DESCRIBE, &[])?,
            Request::Do(name, task) => {
                let mut head = Writer::default();
                head.text(name);
                task.write_head(&mut head);
                wire::send(to, DO, &head.0)?;
                task.write_arrays(to)?;
            }
        }
        to.flush()
    }

    pub fn read(from: &mut impl Read) -> io::Result<Request> {
        let (tag, length) = wire::head(from)?.ok_or_else(garbled)?;
        let bytes = wire::body(from, length)?;
        let mut reader = Reader(&bytes);
        match tag {
            DESCRIBE => Ok(Request::Describe),
            DO => {
                let name = reader.text().ok_or_else(garbled)?;
                Ok(Request::Do(name, Task::read(&mut reader, from)?))
            }
            _ => Err(garbled()),
        }
    }
}

impl Answer {
    pub fn write(&self, to: &mut impl Write) -> io::Result<()> {
        let mut body = Writer::default();
        let tag = match self {
            Answer::Made(outcome) => {
                outcome.write_head(&mut body);
                wire::send(to, MADE, &body.0)?;
                outcome.write_arrays(to)?;
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
                write_said(said, &mut body);
                SAID
            }
        };
        wire::send(to, tag, &body.0)?;
        to.flush()
    }

    /// The next; `None` at the end.
    pub fn read(from: &mut impl Read) -> io::Result<Option<Answer>> {
        let Some((tag, length)) = wire::head(from)? else { return Ok(None) };
        let bytes = wire::body(from, length)?;
        let mut reader = Reader(&bytes);
        if tag == MADE {
            return Outcome::read(&mut reader, from).map(|outcome| Some(Answer::Made(outcome)));
        }
        let mut answer = || match tag {
            PROGRESS => reader.float().map(Answer::Progress),
            DESCRIBED => {
                let plugin = [reader.text()?, reader.text()?];
                Some(Answer::Described(plugin, reader.list(read_declared)?))
            }
            FAILED => Some(Answer::Failed([reader.text()?, reader.text()?, reader.text()?])),
            SAID => read_said(&mut reader).map(Answer::Said),
            _ => None,
        };
        answer().map(Some).ok_or_else(garbled)
    }
}

fn write_said(said: &Said, body: &mut Writer) {
    body.number(said.code as u64);
    body.optional(said.beyond.as_ref(), |body, beyond| {
        body.text(&beyond.what);
        body.text(&beyond.accepted);
    });
    [&said.wrong, &said.error]
        .into_iter()
        .for_each(|text| body.optional(text.as_ref(), |body, text| body.text(text)));
    body.number(said.fallbacks.len() as u64);
    for fallback in &said.fallbacks {
        body.text(&fallback.what);
        body.number(fallback.point_count);
    }
}

fn read_said(reader: &mut Reader) -> Option<Said> {
    let code = reader.number()? as i32;
    let beyond = |reader: &mut Reader| Some(Beyond { what: reader.text()?, accepted: reader.text()? });
    let beyond = reader.optional(beyond)?;
    let (wrong, error) = (reader.optional(Reader::text)?, reader.optional(Reader::text)?);
    let fallback =
        |reader: &mut Reader| Some(Fallback { what: reader.text()?, point_count: reader.number()? });
    Some(Said { code, error, fallbacks: reader.list(fallback)?, beyond, wrong })
}

/// An error as texts.
pub(crate) fn failed(error: &Error) -> Answer {
    let [found, accepted] = [&error.got, &error.expected].map(|text| text.clone().unwrap_or_default());
    Answer::Failed([error.what.clone(), found, accepted])
}

/// The error again.
pub(crate) fn failure<T>([what, found, accepted]: [String; 3]) -> Result<T> {
    let mut error = Error::usage(what);
    error.got = (!found.is_empty()).then_some(found);
    error.expected = (!accepted.is_empty()).then_some(accepted);
    Err(error)
}
