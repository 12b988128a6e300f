//! Result of a plug-in's call and its check, and the beginning of messages about it.

use crate::declaration::Declaration;
use crate::ffi::ValidationError;
use crate::host::State;
use crate::interface::{CANCELLED, ERROR, OK};
use crate::sentinel::Overrun;
use crate::wire::{Reader, Writer};
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Plugin};
use voltet_core::{Error, Result};

/// Return code of a plug-in's function, and what it reported to the host.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CallStatus {
    pub code: i32,
    pub error: Option<String>,
    pub fallbacks: Vec<Fallback>,
    pub overrun: Option<Overrun>,
    /// Reason for which the host refused what it was handed.
    pub refusal: Option<ValidationError>,
}

impl CallStatus {
    pub fn new(code: i32, state: &State) -> CallStatus {
        let (error, fallbacks, refusal) = (state.error(), state.fallbacks(), state.refusal());
        CallStatus { code, error, fallbacks, overrun: None, refusal }
    }

    /// Status of a call that the host did not make.
    pub fn not_called(refusal: ValidationError, state: &State) -> CallStatus {
        state.refuse(refusal);
        CallStatus::new(ERROR, state)
    }

    /// Appends to a message.
    pub fn encode(&self, to: &mut Writer) {
        to.number(self.code as u64);
        to.optional(self.overrun.as_ref(), |to, overrun| {
            to.text(&overrun.buffer);
            to.text(&overrun.capacity);
        });
        for text in [&self.refusal, &self.error] {
            to.optional(text.as_ref(), |to, text| to.text(text));
        }
        to.list(&self.fallbacks, |to, fallback| {
            to.text(&fallback.what);
            to.number(fallback.point_count);
        });
    }

    /// Status from a message; `None` where the bytes are none.
    pub fn decode(from: &mut Reader) -> Option<CallStatus> {
        let code = from.number()? as i32;
        let overrun = from.optional(|from| Some(Overrun { buffer: from.text()?, capacity: from.text()? }))?;
        let (refusal, error) = (from.optional(Reader::text)?, from.optional(Reader::text)?);
        let fallbacks =
            from.list(|from| Some(Fallback { what: from.text()?, point_count: from.number()? }))?;
        Some(CallStatus { code, error, fallbacks, overrun, refusal })
    }
}

/// Name of an item and its plug-in, for messages.
#[derive(Clone, Copy)]
pub(crate) struct CallLabel<'a> {
    declaration: &'a Declaration,
    plugin: &'a Plugin,
}

impl<'a> CallLabel<'a> {
    pub fn new(declaration: &'a Declaration, plugin: &'a Plugin) -> CallLabel<'a> {
        CallLabel { declaration, plugin }
    }

    /// "gradient filter 'x'".
    pub fn item(&self) -> String {
        format!("{} '{}'", self.declaration.family.name(), self.declaration.schema.name)
    }

    /// An error that begins "the gradient filter 'x' of the plug-in 'y' (path)" and goes on with `what`.
    pub fn error(&self, what: &str) -> Error {
        Error::run(format!("the {} of the {} {what}", self.item(), self.plugin))
    }

    /// Errors: the plug-in's own check refused the parameters.
    pub fn check_parameters(&self, status: CallStatus) -> Result<()> {
        match status.code {
            OK => Ok(()),
            _ => Err(Error { kind: ErrorKind::Usage, ..self.failure(&status) }),
        }
    }

    /// Errors: the call failed, or was stopped. `cancelled`: the user cancelled it.
    pub fn check_call(&self, status: &CallStatus, cancelled: bool) -> Result<()> {
        if let Some(Overrun { buffer, capacity }) = &status.overrun {
            let what = format!("wrote beyond the end of {buffer}: what else it wrote over is unknown");
            return Err(self.error(&what).expected(capacity));
        }
        if let Some(refusal) = &status.refusal {
            return Err(self.error("is refused").got(refusal));
        }
        match status.code {
            OK => Ok(()),
            _ if cancelled => Err(Error::cancelled()),
            CANCELLED => Err(self.error("stopped, and nobody asked it to")),
            _ => Err(self.failure(status)),
        }
    }

    fn failure(&self, status: &CallStatus) -> Error {
        match &status.error {
            Some(text) => self.error("says").got(text),
            None => self.error("failed and did not say why").got(format!("code {}", status.code)),
        }
    }

    /// Sentences about the points at which the item fell back to something simpler.
    pub fn warnings(&self, status: &CallStatus) -> impl Iterator<Item = String> {
        status.fallbacks.iter().map(|Fallback { what, point_count }| {
            format!("The {} of the {}: {what} at {point_count} points.", self.item(), self.plugin)
        })
    }
}
