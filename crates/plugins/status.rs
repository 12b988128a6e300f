//! Result of a plug-in's call and its check, and the beginning of messages about it.

use crate::declaration::Declaration;
use crate::ffi::{Overrun, ValidationError};
use crate::host::{Reports, State};
use crate::interface::{CANCELLED, ERROR, OK};
use crate::wire::wire;
use voltet_core::error::ErrorKind;
use voltet_core::field::{Fallback, Plugin};
use voltet_core::{Error, Result};

/// Return code of a plug-in's function, and what it reported to the host.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct CallStatus {
    pub code: i32,
    pub overrun: Option<Overrun>,
    pub reports: Reports,
}

wire!(fields of CallStatus { code, overrun, reports });
wire!(fields of Reports { error, refusal, fallbacks });
wire!(fields of Fallback { what, point_count });

impl CallStatus {
    pub fn new(code: i32, state: &State) -> CallStatus {
        CallStatus { code, overrun: None, reports: state.reports().clone() }
    }

    /// Status of a call that the host did not make.
    pub fn not_called(refusal: ValidationError, state: &State) -> CallStatus {
        state.refuse(refusal);
        CallStatus::new(ERROR, state)
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
        if let Some(refusal) = &status.reports.refusal {
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
        match &status.reports.error {
            Some(text) => self.error("says").got(text),
            None => self.error("failed and did not say why").got(format!("code {}", status.code)),
        }
    }

    /// Sentences about the points at which the item fell back to something simpler.
    pub fn warnings(&self, status: &CallStatus) -> impl Iterator<Item = String> {
        status.reports.fallbacks.iter().map(|Fallback { what, point_count }| {
            format!("The {} of the {}: {what} at {point_count} points.", self.item(), self.plugin)
        })
    }
}
