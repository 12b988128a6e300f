//! A plug-in's functions, run in a process of their own.

use super::exchange::{End, exchange};
use super::messages::{Reply, Request, error_from};
use crate::declaration::Declaration;
use crate::library::read_file;
use crate::runner::{PluginItem, Runner};
use crate::status::{CallLabel, CallStatus};
use crate::task::{CheckTask, Outcome, Task};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::field::Plugin;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Longest time of a description or a check.
const START_TIME_LIMIT: Duration = Duration::from_secs(30);

/// Runner of a library in processes of `program`.
struct Remote {
    program: PathBuf,
    plugin: Plugin,
}

/// The items of the library at `path`, which run in processes of `program`.
pub(crate) fn load(path: &Path, program: PathBuf) -> Result<Vec<PluginItem>> {
    let (plugin, _) = read_file(path)?;
    let start = Instant::now();
    let broken = |how: String| {
        Error::usage("the plug-in cannot be loaded").got(format!("its process {how}")).in_file(path)
    };
    let end = exchange(&program, path, &Request::Describe, |_| start.elapsed() < START_TIME_LIMIT);
    let replies = match end {
        End::Replied(replies) => replies,
        End::GivenUp => return Err(broken(format!("did not begin within {} s", START_TIME_LIMIT.as_secs()))),
        End::Broken(how) => return Err(broken(how)),
    };
    let ([name, version], declarations) = match replies.into_iter().next() {
        Some(Reply::Described(names, declarations)) => (names, declarations),
        Some(Reply::Failed(texts)) => return Err(error_from(texts).in_file(path)),
        Some(Reply::Status(_) | Reply::Outcome(_) | Reply::Progress(_)) | None => {
            return Err(broken("did not describe it".into()));
        }
    };
    let plugin = Plugin { name, version, ..plugin };
    Ok(PluginItem::list(Arc::new(Remote { program, plugin }), declarations))
}

impl Runner for Remote {
    fn plugin(&self) -> &Plugin {
        &self.plugin
    }

    fn run(
        &self,
        declaration: &Declaration,
        task: Box<dyn Task>,
        progress: &dyn Progress,
    ) -> Result<(CallStatus, Outcome)> {
        let label = CallLabel::new(declaration, &self.plugin);
        let (now, _) = read_file(&self.plugin.path)?;
        if now.fingerprint != self.plugin.fingerprint {
            let error = label.error("is not the one that was described: its file has changed");
            return Err(error.expected("the program begun again"));
        }
        let broken = |how: String| label.error(&how).expected("a plug-in that answers; the program goes on");
        let (is_check, stage, start) = (task.tag() == CheckTask::TAG, task.stage(), Instant::now());
        let request = Request::Run(declaration.schema.name.into(), task);
        let may_go_on = |fraction| {
            if is_check {
                return start.elapsed() < START_TIME_LIMIT;
            }
            progress.report(stage, fraction);
            !progress.cancelled()
        };
        let replies = match exchange(&self.program, &self.plugin.path, &request, may_go_on) {
            End::Replied(replies) => replies,
            End::GivenUp if is_check => {
                return Err(label.error("does not come back from checking its parameters"));
            }
            End::GivenUp => return Err(Error::cancelled()),
            End::Broken(how) => return Err(broken(how)),
        };
        let mut replies = replies.into_iter();
        match (replies.next(), replies.next()) {
            (Some(Reply::Status(status)), Some(Reply::Outcome(outcome))) => Ok((status, outcome)),
            (Some(Reply::Failed(texts)), _) => Err(error_from(texts).in_file(&self.plugin.path)),
            _ => Err(broken("did not answer".into())),
        }
    }
}
