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
    /// files that failed.
    ///
    /// # Errors
    /// - the report cannot be begun.
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
        let several = OneOfSeveral(bar);
        let is_alone = arguments.jobs == 1 || tasks.len() == 1;
        let observer: &dyn Observer = if is_alone { bar } else { &several };
        let mut goes_on = true;
        attempt_all(&tasks, (arguments, registry), session, observer, |task, attempt| {
            messages.begin(task)?;
            let attempt = attempt();
            bar.clear();
            let attempt = attempt?;
            let is_failed = attempt.outcome.is_err();
            if is_failed {
                launch.announce_failure();
            }
            goes_on = messages.take(task, attempt, bar)?;
            if is_failed {
                // The other processes wait for this one.
                launch.end_all(FAILED);
            }
            Ok(goes_on)
        })?;
        Ok(self.messages.finish(goes_on)?)
    }
}

/// Attempts to draw pictures, several at a time where that is asked for. `take` has each in turn with a function that waits for its
/// attempt, and gives false to stop. While one is drawn alone, the next step is read where memory is ample; its errors are met when
/// its turn comes.
pub(super) fn attempt_all(
    tasks: &[Task],
    (arguments, registry): (&Run, &Registry),
    session: &Session,
    observer: &dyn Observer,
    mut take: impl FnMut(Task, &mut dyn FnMut() -> Outcome<Attempt>) -> Outcome<bool>,
) -> Outcome<()> {
    let work =
        |session: &mut Session, number: usize| tasks[number].attempt(arguments, registry, session, observer);
    let prepare = |number: usize| {
        if number > 1 && has_room_ahead() {
            let mut session = session.beside();
            drop(tasks[number].read_ahead(arguments, registry, &mut session, &OneOfSeveral(observer)));
        }
    };
    let counts = (tasks.len(), usize::from(arguments.jobs));
    jobs::in_order(
        counts,
        || session.beside(),
        (work, prepare),
        |number, attempt| take(tasks[number], attempt),
    )
}
