//! Requests of the program to the process of a plug-in, and its replies.

use crate::declaration::{Declaration, Family};
use crate::gradient_filter::GradientTask;
use crate::grid_filter::GridTask;
use crate::image_filter::ImageTask;
use crate::reader::{InspectTask, ReadTask};
use crate::status::CallStatus;
use crate::task::{CheckTask, Outcome, Task, TaskKind};
use crate::wire::{Wire, garbled, wire};
use std::io::{self, BufRead, Read, Write};
use voltet_core::Error;
use voltet_core::parameters::{DefaultValue, Parameter, ParameterType, Range, VariantSchema};

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
    Described((String, String), Vec<Declaration>),
    /// Error of loading: what, found, expected.
    Failed(String, Option<String>, Option<String>),
    Status(CallStatus),
    Outcome(Outcome),
}

wire!(variants of Request { 0 = Describe, 1 = Run(name, task) });

wire!(variants of Reply {
    0 = Progress(fraction),
    1 = Described(plugin, items),
    2 = Failed(what, found, expected),
    3 = Status(status),
    4 = Outcome(outcome)
});

wire!(fields of Declaration { schema, family, checks, components });
wire!(variants of Family {
    0 = GradientFilter { needs },
    1 = Reader { extensions, magic },
    2 = GridFilter { made },
    3 = ImageFilter
});
wire!(fields of VariantSchema { name, summary, parameters });
wire!(fields of Parameter { name, parameter_type, unit, default, help });
wire!(fields of Range { min, max, above_min, below_max, infinite });

// Types and defaults of the parameters that a plug-in can declare.
wire!(variants of ParameterType {
    0 = Boolean,
    1 = Integer(range),
    2 = Number(range),
    3 = Choice(words),
    4 = Numbers(count, range),
    5 = Text
});
wire!(variants of DefaultValue {
    0 = Required,
    1 = Unset(meaning),
    2 = Boolean(flag),
    3 = Integer(number),
    4 = Number(number),
    5 = Text(text),
    6 = Numbers(numbers)
});

/// Kinds of tasks by their tags.
const TASKS: [&TaskKind; 6] = [
    &CheckTask::KIND,
    &GradientTask::KIND,
    &InspectTask::KIND,
    &ReadTask::KIND,
    &GridTask::KIND,
    &ImageTask::KIND,
];

impl Wire for Box<dyn Task> {
    fn send(&self, to: &mut dyn Write) -> io::Result<()> {
        self.kind().tag.send(to)?;
        self.send_contents(to)
    }

    fn receive(from: &mut dyn Read) -> io::Result<Self> {
        let tag = u8::receive(from)?;
        let kind = TASKS.iter().find(|kind| kind.tag == tag).ok_or_else(garbled)?;
        (kind.receive)(from)
    }
}

impl Reply {
    /// Reply to a request that failed.
    pub fn from_error(error: &Error) -> Reply {
        Reply::Failed(error.what.clone(), error.got.clone(), error.expected.clone())
    }

    /// Sends it at once.
    pub fn reply(&self, to: &mut dyn Write) -> io::Result<()> {
        self.send(to)?;
        to.flush()
    }

    /// The next reply; `None` at the end.
    pub fn receive_next(from: &mut impl BufRead) -> io::Result<Option<Reply>> {
        if from.fill_buf()?.is_empty() {
            return Ok(None);
        }
        match Reply::receive(from)? {
            Reply::Outcome(outcome) if !outcome.is_consistent() => Err(garbled()),
            reply => Ok(Some(reply)),
        }
    }
}
