//! One call of a plug-in with its inputs, and its outputs: alike in this process, in one of its own, and in a sandbox.

use crate::declaration::LibraryItem;
use crate::grids::{Buffers, Head};
use crate::host::State;
use crate::status::CallStatus;
use crate::values::ParameterValues;
use crate::wire::{Wire, wire};
use std::any::Any;
use std::io::{self, Read, Write};
use voltet_core::glam::DVec3;

/// Kind of tasks.
pub(crate) struct TaskKind {
    /// Number in messages.
    pub tag: u8,
    /// Stage of the progress reports.
    pub stage: &'static str,
    /// Receives a task of this kind.
    pub receive: fn(&mut dyn Read) -> io::Result<Box<dyn Task>>,
}

impl TaskKind {
    pub const fn new<T: Task + Wire>(tag: u8, stage: &'static str) -> TaskKind {
        TaskKind { tag, stage, receive: |from| Ok(Box::new(T::receive(from)?)) }
    }
}

/// One call with its inputs. These are owned or shared, so that a call that never returns harms nothing.
pub(crate) trait Task: SendContents + Any + Send + Sync {
    fn kind(&self) -> &'static TaskKind;

    /// Calls the function of a loaded library. An item of another family gives no output.
    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome);
}

/// [`Wire::send`] of a task whose type is not known.
pub(crate) trait SendContents {
    fn send_contents(&self, to: &mut dyn Write) -> io::Result<()>;
}

impl<T: Wire> SendContents for T {
    fn send_contents(&self, to: &mut dyn Write) -> io::Result<()> {
        self.send(to)
    }
}

/// Check of parameter values by the plug-in.
pub(crate) struct CheckTask {
    pub values: ParameterValues,
}

wire!(fields of CheckTask { values });

impl CheckTask {
    pub const KIND: TaskKind = TaskKind::new::<CheckTask>(0, "check");
}

impl Task for CheckTask {
    fn kind(&self) -> &'static TaskKind {
        &CheckTask::KIND
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        let Some(check) = item.check else { return Default::default() };
        let pointers = self.values.pointers();
        // SAFETY: the plug-in's own function; all that it is given lives through the call.
        let code = unsafe { check(&self.values.header_values(&pointers), &state.host()) };
        (CallStatus::new(code, state), Outcome::Nothing)
    }
}

/// Output of a call.
#[derive(Default)]
pub(crate) enum Outcome {
    /// Only the status.
    #[default]
    Nothing,
    /// Vectors of the gradient.
    Vectors(Vec<DVec3>),
    /// Contents of a file.
    Head(Head),
    /// A grid, or parts of it. The counts of a grid filter are those of the whole grid, whatever it shares with the input.
    Grid(Head, Buffers),
    /// Pixels of a picture.
    Pixels(Vec<[f32; 4]>),
}

wire!(variants of Outcome { 0 = Nothing, 1 = Vectors(vectors), 2 = Head(head), 3 = Grid(head, buffers), 4 = Pixels(pixels) });

impl Outcome {
    pub fn vectors(self) -> Option<Vec<DVec3>> {
        if let Outcome::Vectors(vectors) = self { Some(vectors) } else { None }
    }

    pub fn head(self) -> Option<Head> {
        if let Outcome::Head(head) = self { Some(head) } else { None }
    }

    pub fn grid(self) -> Option<(Head, Buffers)> {
        if let Outcome::Grid(head, buffers) = self { Some((head, buffers)) } else { None }
    }

    pub fn pixels(self) -> Option<Vec<[f32; 4]>> {
        if let Outcome::Pixels(pixels) = self { Some(pixels) } else { None }
    }

    /// True if the counts of a grid are within their limits, and its arrays as long as they say: a damaged process may send any.
    pub fn is_consistent(&self) -> bool {
        match self {
            Outcome::Head(head) => head.is_within_limits(),
            Outcome::Grid(head, buffers) => head.is_within_limits() && buffers.fit(head),
            Outcome::Nothing | Outcome::Vectors(_) | Outcome::Pixels(_) => true,
        }
    }
}
