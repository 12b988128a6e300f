//! Pictures of a call, and attempts to draw them.

use super::plan::{Frames, Plan};
use super::resume;
use crate::cli::arguments::Run;
use crate::core::{Error, Result};
use crate::document::{Document, LocatedError};
use crate::graph::{Observer, Registry, RunReport, Session};
use voltet_study::ExhaustiveComparison;

/// Result of a step of the call, or what stops all of it.
pub(super) type Outcome<T> = std::result::Result<T, LocatedError>;

/// A picture of a call.
#[derive(Clone, Copy)]
pub(super) struct Task<'a> {
    pub plan: &'a Plan,
    /// Its frame with the number; `None`: it is the only picture.
    pub frame: Option<(&'a Frames, usize)>,
}

/// A picture that was drawn, or was not.
pub(super) struct Attempt {
    pub document: Option<Document>,
    /// `None`: it was there already.
    pub outcome: Result<Option<RunReport>>,
    pub exhaustive: Option<ExhaustiveComparison>,
}

pub(super) fn tasks_of(plan: &Plan) -> Vec<Task<'_>> {
    match &plan.frames {
        None => vec![Task { plan, frame: None }],
        Some(frames) => {
            (0..frames.frames.len()).map(|number| Task { plan, frame: Some((frames, number)) }).collect()
        }
    }
}

impl Task<'_> {
    /// Reads what a frame will be drawn from.
    pub fn read_ahead(
        &self,
        arguments: &Run,
        registry: &Registry,
        session: &mut Session,
        observer: &dyn Observer,
    ) -> Outcome<()> {
        let Some((frames, number)) = self.frame else { return Ok(()) };
        let changed = frames.document.changed(&frames.frames[number].changes, registry)?;
        if !(arguments.frames.resume && resume::is_drawn(&changed, session)) {
            session.read_ahead(&changed.graph, observer)?;
        }
        Ok(())
    }

    /// Draws the picture, unless it is there and is kept.
    pub fn attempt(
        &self,
        arguments: &Run,
        registry: &Registry,
        session: &mut Session,
        observer: &dyn Observer,
    ) -> Outcome<Attempt> {
        // Pictures are in their files: none waits for its turn to be named.
        let without_pictures = |report: RunReport| RunReport { pictures: Vec::new(), ..report };
        let Some((frames, number)) = self.frame else {
            let document = &self.plan.first;
            let ran = match arguments.exhaustive {
                true => compared(document, observer),
                false => session.run(&document.graph, observer).map(|report| (report, None)),
            };
            let (outcome, exhaustive) = match ran {
                Ok((report, exhaustive)) => (Ok(Some(without_pictures(report))), exhaustive),
                Err(error) => (Err(error), None),
            };
            return Ok(Attempt { document: None, outcome, exhaustive });
        };
        let changed = frames.document.changed(&frames.frames[number].changes, registry);
        let changed = changed.map_err(|error| frames.document.failure(error))?;
        let is_kept = arguments.frames.resume && resume::is_drawn(&changed, session);
        let run =
            |session: &mut Session| session.run(&changed.graph, observer).map(without_pictures).map(Some);
        let outcome = if is_kept { Ok(None) } else { run(session) };
        Ok(Attempt { document: Some(changed), outcome, exhaustive: None })
    }
}

/// Modes in which a file is run in turn, true for exhaustive ones. The first run finds cold caches and is not counted.
const TURNS: [bool; 5] = [false, true, false, true, false];

/// The file's exhaustive run, compared with the usual one: the fastest of each, every run from a
/// fresh start.
fn compared(
    document: &Document,
    observer: &dyn Observer,
) -> Result<(RunReport, Option<ExhaustiveComparison>)> {
    let mut runs: [Option<RunReport>; 2] = [None, None];
    for (turn, exhaustive) in TURNS.into_iter().enumerate() {
        let session = crate::nodes::session();
        let mut session = if exhaustive { session.exhaustive() } else { session };
        let report = session.run(&document.graph, observer)?;
        let fastest = &mut runs[usize::from(exhaustive)];
        if turn > 0 && fastest.as_ref().is_none_or(|fastest| report.seconds < fastest.seconds) {
            *fastest = Some(report);
        }
    }
    match runs {
        [Some(usual), Some(exhaustive)] => {
            let comparison = ExhaustiveComparison::compare(&usual, &exhaustive);
            Ok((exhaustive, Some(comparison)))
        }
        _ => Err(Error::run("the file was not run")),
    }
}
