//! Requests of the program to the process of a plug-in, and its replies.

use super::declarations::{read_declaration, write_declaration};
use crate::declaration::Declaration;
use crate::gradient_filter::GradientTask;
use crate::grid_filter::GridTask;
use crate::image_filter::ImageTask;
use crate::reader::{InspectTask, ReadTask};
use crate::status::CallStatus;
use crate::task::{CheckTask, DecodeTask, Outcome, Task};
use crate::wire::{self, Reader, Writer, garbled};
use std::io::{self, Read, Write};
use voltet_core::Error;

/// Request to the process.
pub(crate) enum Request {
    Describe,
    /// A task of the item of that name.
    Run(String, Box<dyn Task>),
}

/// Reply of the process. `Progress` is followed by more, and `Status` by `Outcome`.
pub(crate) enum Reply {
    Progress(f64),
    /// Name and version of the plug-in, and its items.
    Described([String; 2], Vec<Declaration>),
    /// Error of loading: what, found, expected.
    Failed([String; 3]),
    Status(CallStatus),
    Outcome(Outcome),
}

const DESCRIBE: u8 = b'd';
const RUN: u8 = b't';
const PROGRESS: u8 = b'P';
const DESCRIBED: u8 = b'D';
const FAILED: u8 = b'F';
const STATUS: u8 = b'S';
const OUTCOME: u8 = b'M';

/// Kinds of tasks by their tags.
const TASKS: [(u64, DecodeTask); 6] = [
    (CheckTask::TAG, CheckTask::decode),
    (GradientTask::TAG, GradientTask::decode),
    (InspectTask::TAG, InspectTask::decode),
    (ReadTask::TAG, ReadTask::decode),
    (GridTask::TAG, GridTask::decode),
    (ImageTask::TAG, ImageTask::decode),
];

impl Request {
    pub fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        match self {
            Request::Describe => wire::send(to, DESCRIBE, &[])?,
            Request::Run(name, task) => {
                let mut head = Writer::default();
                head.text(name);
                head.number(task.tag());
                task.encode(&mut head);
                wire::send(to, RUN, &head.0)?;
                task.send_arrays(to)?;
            }
        }
        to.flush()
    }

    pub fn read(from: &mut dyn Read) -> io::Result<Request> {
        let (tag, length) = wire::head(from)?.ok_or_else(garbled)?;
        let bytes = wire::body(from, length)?;
        let mut head = Reader(&bytes);
        match tag {
            DESCRIBE => Ok(Request::Describe),
            RUN => {
                let (name, kind) = head.text().zip(head.number()).ok_or_else(garbled)?;
                let decode = TASKS.iter().find(|(tag, _)| *tag == kind).ok_or_else(garbled)?.1;
                Ok(Request::Run(name, decode(&mut head, from)?))
            }
            _ => Err(garbled()),
        }
    }
}

impl Reply {
    /// Reply to a request that failed.
    pub fn from_error(error: &Error) -> Reply {
        let [found, expected] = [&error.got, &error.expected].map(|text| text.clone().unwrap_or_default());
        Reply::Failed([error.what.clone(), found, expected])
    }

    pub fn write(&self, to: &mut dyn Write) -> io::Result<()> {
        let mut body = Writer::default();
        let tag = match self {
            Reply::Progress(fraction) => {
                body.float(*fraction);
                PROGRESS
            }
            Reply::Described(plugin, items) => {
                plugin.iter().for_each(|text| body.text(text));
                body.list(items, write_declaration);
                DESCRIBED
            }
            Reply::Failed(texts) => {
                texts.iter().for_each(|text| body.text(text));
                FAILED
            }
            Reply::Status(status) => {
                status.encode(&mut body);
                STATUS
            }
            Reply::Outcome(outcome) => {
                outcome.encode(&mut body);
                OUTCOME
            }
        };
        wire::send(to, tag, &body.0)?;
        if let Reply::Outcome(outcome) = self {
            outcome.send_arrays(to)?;
        }
        to.flush()
    }

    /// The next reply; `None` at the end.
    pub fn read(from: &mut dyn Read) -> io::Result<Option<Reply>> {
        let Some((tag, length)) = wire::head(from)? else { return Ok(None) };
        let bytes = wire::body(from, length)?;
        let mut body = Reader(&bytes);
        if tag == OUTCOME {
            return Outcome::decode(&mut body, from).map(|outcome| Some(Reply::Outcome(outcome)));
        }
        let mut reply = || match tag {
            PROGRESS => body.float().map(Reply::Progress),
            DESCRIBED => Some(Reply::Described([body.text()?, body.text()?], body.list(read_declaration)?)),
            FAILED => Some(Reply::Failed([body.text()?, body.text()?, body.text()?])),
            STATUS => CallStatus::decode(&mut body).map(Reply::Status),
            _ => None,
        };
        reply().map(Some).ok_or_else(garbled)
    }
}

/// The error of [`Reply::from_error`].
pub(crate) fn error_from([what, found, expected]: [String; 3]) -> Error {
    let mut error = Error::usage(what);
    error.got = (!found.is_empty()).then_some(found);
    error.expected = (!expected.is_empty()).then_some(expected);
    error
}
