//! A plug-in's functions, run in a process of their own.

use super::conversation::{End, hold};
use super::messages::{Answer, Request, failure};
use crate::describe::Declared;
use crate::library::state_of;
use crate::outcome::{Said, Whose};
use crate::runner::{Offered, Runner};
use crate::task::{Outcome, Task};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// How long describing and checking may take.
const PATIENCE: Duration = Duration::from_secs(30);

/// A library that other processes load.
struct Remote {
    program: PathBuf,
    plugin: Plugin,
}

/// The filters of the library at `path`, which run in processes of `program`.
pub(crate) fn load(path: &Path, program: PathBuf) -> Result<Vec<Offered>> {
    let (stated, _) = state_of(path)?;
    let start = Instant::now();
    let broken = |how: String| {
        Error::usage("the plug-in cannot be loaded").got(format!("its process {how}")).in_file(path)
    };
    let end = hold(&program, path, &Request::Describe, |_| start.elapsed() < PATIENCE);
    let answers = match end {
        End::Answered(answers) => answers,
        End::GivenUp => return Err(broken(format!("did not begin within {} s", PATIENCE.as_secs()))),
        End::Broken(how) => return Err(broken(how)),
    };
    let ([name, version], filters) = match answers.into_iter().next() {
        Some(Answer::Described(plugin, filters)) => (plugin, filters),
        Some(Answer::Failed(texts)) => return failure(texts).map_err(|error| error.in_file(path)),
        Some(Answer::Said(_) | Answer::Made(_) | Answer::Progress(_)) | None => {
            return Err(broken("did not describe it".into()));
        }
    };
    let plugin = Plugin { name, version, ..stated };
    let runner: Arc<dyn Runner> = Arc::new(Remote { program, plugin });
    let offered = |declared| Offered { runner: runner.clone(), declared };
    Ok(filters.into_iter().map(offered).collect())
}

impl Runner for Remote {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(&self, of: &Declared, task: Task, progress: &dyn Progress) -> Result<(Said, Outcome)> {
        let whose = Whose::new(of, &self.plugin);
        let (now, _) = state_of(&self.plugin.path)?;
        if now.fingerprint != self.plugin.fingerprint {
            let error = whose.error("is not the one that was described: its file has changed");
            return Err(error.expected("the program begun again"));
        }
        let broken = |how: String| whose.error(&how).expected("a plug-in that answers; the program goes on");
        let (is_check, stage, start) = (matches!(task, Task::Check(_)), task.stage(), Instant::now());
        let request = Request::Do(of.kind.name.into(), task);
        let waits = |fraction| {
            if is_check {
                return start.elapsed() < PATIENCE;
            }
            progress.report(stage, fraction);
            !progress.cancelled()
        };
        let answers = match hold(&self.program, &self.plugin.path, &request, waits) {
            End::Answered(answers) => answers,
            End::GivenUp if is_check => {
                return Err(whose.error("does not come back from checking its parameters"));
            }
            End::GivenUp => return Err(Error::cancelled()),
            End::Broken(how) => return Err(broken(how)),
        };
        let mut answers = answers.into_iter();
        match (answers.next(), answers.next()) {
            (Some(Answer::Said(said)), Some(Answer::Made(outcome))) => Ok((said, outcome)),
            (Some(Answer::Failed(texts)), _) => {
                failure(texts).map_err(|error| error.in_file(&self.plugin.path))
            }
            _ => Err(broken("did not answer".into())),
        }
    }
}
