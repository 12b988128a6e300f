//! Runs of pipelines, each for one picture or for frames, in order or several at a time.

use super::jobs;
use super::messages::Messages;
use super::plan::Plan;
use super::task::{Attempt, Outcome, Task, tasks_of};
use crate::cli::arguments::Run;
use crate::cli::commands::shared::FAILED;
use crate::cli::present::Bar;
use crate::cli::ranks::Launch;
use crate::core::Result;
use crate::document::LocatedError;
use crate::graph::{Observer, Registry, Session};
use crate::io::memory::has_room_ahead;

/// One call of the command: what its runs share.
pub(super) struct Runner<'a> {
    arguments: &'a Run,
    registry: &'a Registry,
    bar: Bar,
    session: Session,
    messages: Messages<'a>,
    /// The processes that run together.
    launch: &'a Launch,
}

/// An observer of one of several runs, of which no progress is shown.
pub(super) struct OneOfSeveral<'a>(pub &'a dyn Observer);

impl Observer for OneOfSeveral<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.0.memory_left()
    }
}

impl<'a> Runner<'a> {
    /// A call before its first run. `streams`: a file goes to the standard output; `wrong`: the exit code so far, and the
    /// files that failed. Errors: the report cannot be begun.
    pub fn new(
        arguments: &'a Run,
        registry: &'a Registry,
        streams: bool,
        wrong: (u8, Vec<String>),
        launch: &'a Launch,
    ) -> Result<Self> {
        let is_first = launch.ranks.rank() == 0;
        let messages = Messages::new(arguments, streams, wrong, is_first)?;
        let session = crate::nodes::session().with_ranks(launch.ranks.clone());
        let session = match arguments.memory {
            Some(bytes) => session.with_memory(bytes),
            None => session,
        };
        Ok(Runner {
            arguments,
            registry,
            bar: Bar::new(arguments.quiet || !is_first),
            session,
            messages,
            launch,
        })
    }

    /// Draws the pictures of all plans, several at a time where that is asked for, and writes the report; gives the exit code.
    /// What is said comes in the order of the plans. A picture that fails is named, and the others are drawn.
    pub fn run(mut self, plans: &[Plan]) -> Outcome<u8> {
        let tasks: Vec<Task> = plans.iter().flat_map(tasks_of).collect();
        let single = plans.iter().filter(|plan| plan.frames.is_none());
        self.session.expect(single.map(|plan| &plan.first.graph));
        let Runner { arguments, registry, bar, session, messages, launch } = &mut self;
        let (bar, session, launch) = (&*bar, &*session, *launch);
        let jobs = usize::from(arguments.jobs);
        let several = OneOfSeveral(bar);
        let observer: &dyn Observer = if jobs.min(tasks.len()) > 1 { &several } else { bar };
        let work = |session: &mut Session, number: usize| {
            let attempt = tasks[number].attempt(arguments, registry, session, observer);
            bar.clear();
            attempt
        };
        // The next step is read while one is drawn, where memory is ample. Its errors are met when its turn comes.
        let prepare = |number: usize| {
            if number > 1 && has_room_ahead() {
                drop(tasks[number].read_ahead(arguments, registry, &mut session.beside(), &several));
            }
        };
        let mut goes_on = true;
        let take = |number: usize, attempt: &mut dyn FnMut() -> Outcome<Attempt>| {
            let task = tasks[number];
            messages.begin(task)?;
            let attempt = attempt()?;
            let is_failed = attempt.outcome.is_err();
            if is_failed {
                launch.announce_failure();
            }
            goes_on = messages.take(task, attempt, bar)?;
            if is_failed {
                // The other processes wait for this one.
                launch.end_all(FAILED);
            }
            Ok::<bool, LocatedError>(goes_on)
        };
        jobs::in_order((tasks.len(), jobs), || session.beside(), (work, prepare), take)?;
        Ok(self.messages.finish(goes_on)?)
    }
}
