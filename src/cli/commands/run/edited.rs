//! The film of a pipeline in the editor, saved or not: drawn and written as by `voltet run --film`, with progress for a window.

use super::film::{self, DrawnFrame, Making};
use super::runner::OneOfSeveral;
use super::task::{Attempt, Outcome, tasks_of};
use super::{jobs, plan};
use crate::Document;
use crate::cli::arguments::Run;
use crate::core::error::ErrorKind;
use crate::core::{Error, Result, counted};
use crate::document::LocatedError;
use crate::graph::{Observer, Registry, Session};
use crate::io::memory::has_room_ahead;
use clap::Parser;
use std::ffi::OsString;
use voltet_editor::FilmRequest;

/// The options of `voltet run`, alone.
#[derive(Debug, Parser)]
struct Words {
    #[command(flatten)]
    run: Run,
}

/// Makes a film; gives a line about it. Pictures that are there, as they would be drawn, are taken.
/// Errors: those of `voltet run`; frames that cannot be drawn: the first of them; the others are drawn, and stay for the next film.
pub fn film_of(request: &FilmRequest, registry: &Registry, observer: &dyn Observer) -> Result<String> {
    made(request, registry, observer).map_err(|failure| failure.error)
}

fn made(request: &FilmRequest, registry: &Registry, observer: &dyn Observer) -> Outcome<String> {
    let command = command_of(request);
    let options = Words::try_parse_from(&command).map_err(|error| refused(&error))?;
    let arguments = options.run;
    let shorts = super::shorts(&arguments);
    let options: Result<Vec<String>> =
        shorts.iter().map(|short| short.spelled_out(&request.path, &request.text)).collect();
    let document = Document::from_text(&request.path, request.text.clone(), &options?, registry)?;
    film::check(&arguments, std::slice::from_ref(&document))?;
    let selection = plan::selection(&arguments)?;
    let Some(plan) = plan::plan(&document, &selection, &arguments, registry)? else {
        return Err(Error::usage("the film has no frame").into());
    };
    let plans = [plan];
    film::refuse_frame(&arguments, plans[0].outputs.iter())?;
    crate::document::refuse_conflicts([&plans[0].first], true, &[])?;
    plan::refuse_conflicts(&plans, &arguments)?;
    let (session, tasks) = (crate::nodes::session(), tasks_of(&plans[0]));
    let quiet = OneOfSeveral(observer);
    let work =
        |session: &mut Session, number: usize| tasks[number].attempt(&arguments, registry, session, &quiet);
    // As the command does it: the error of a step that is read ahead is met when its turn comes.
    let prepare = |number: usize| {
        if number > 1 && has_room_ahead() {
            drop(tasks[number].read_ahead(&arguments, registry, &mut session.beside(), &quiet));
        }
    };
    let (mut pictures, mut warnings) =
        (Vec::new(), document.graph.warnings.iter().map(Error::to_string).collect::<Vec<String>>());
    let mut failures: Vec<(String, Error)> = Vec::new();
    let take = |number: usize, attempt: &mut dyn FnMut() -> Outcome<Attempt>| {
        let stage = format!("frame {} of {}", number + 1, tasks.len());
        observer.progress("", &stage, number as f64 / tasks.len() as f64);
        let Attempt { document: drawn, outcome, .. } = attempt()?;
        let drawn = drawn.as_ref().unwrap_or(&document);
        let label = tasks[number].frame.map(|(frames, number)| frames.frames[number].label());
        let label = label.unwrap_or_default();
        match outcome.map_err(|error| drawn.locate(error)) {
            Ok(report) => {
                let own = drawn.graph.warnings.len();
                for warning in report.iter().flat_map(|report| report.warnings.iter().skip(own)) {
                    if !warnings.contains(warning) {
                        warnings.push(warning.clone());
                    }
                }
                pictures.extend(film::picture_path(drawn).map(|path| DrawnFrame { path, label }));
            }
            Err(error) if error.kind == ErrorKind::Cancelled => return Err(error.into()),
            // The others are drawn, and stay for the next film.
            Err(error) => failures.push((label, error)),
        }
        Ok::<bool, LocatedError>(true)
    };
    jobs::in_order((tasks.len(), 1), || session.beside(), (work, prepare), take)?;
    if let Some((label, error)) = failures.first() {
        let what = format!(
            "{} of {} failed, so that no film is made; {label}: {}",
            failures.len(),
            counted(tasks.len(), "frame"),
            error.what
        );
        return Err(Error { what, ..error.clone() }.into());
    }
    observer.progress("", "film", 1.0);
    let background = film::background(&document);
    // The words without the program's name.
    let words = command.iter().skip(1).map(|word| word.to_string_lossy().into_owned());
    let command = std::iter::once("run".to_string()).chain(words).collect();
    let making = Making { rate: arguments.frames.fps, background, command, observer };
    let mut said = film::write(&request.film, &pictures, &making)?;
    warnings.iter().for_each(|warning| said += &format!("warning: {warning}\n"));
    Ok(said)
}

/// The command that makes the film of a saved pipeline.
fn command_of(request: &FilmRequest) -> Vec<OsString> {
    let mut film = OsString::from("--film=");
    film.push(&request.film);
    let mut words = vec!["voltet".into(), request.path.clone().into_os_string()];
    words.extend(request.steps.iter().map(|steps| format!("--steps={steps}").into()));
    words.extend(request.frames.iter().map(|count| format!("--frames={count}").into()));
    words.extend(request.size.iter().map(|[width, height]| format!("--size={width}x{height}").into()));
    words.extend([film, format!("--fps={}", request.rate).into(), "--resume".into()]);
    words
}

/// The error of words that are no options.
fn refused(error: &clap::Error) -> Error {
    let text = error.to_string();
    let first = text.lines().next().unwrap_or_default();
    Error::usage(first.strip_prefix("error: ").unwrap_or(first))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::commands::shared::DONE;
    use std::path::Path;
    use std::sync::atomic::{AtomicBool, Ordering};

    /// Stops the work once the film is written, if it is to.
    struct Watch {
        stops: bool,
        is_stopped: AtomicBool,
    }

    impl Watch {
        fn new(stops: bool) -> Watch {
            Watch { stops, is_stopped: AtomicBool::new(false) }
        }
    }

    impl Observer for Watch {
        fn progress(&self, _node: &str, stage: &str, _fraction: f64) {
            self.is_stopped.fetch_or(self.stops && stage == "film", Ordering::SeqCst);
        }

        fn cancelled(&self) -> bool {
            self.is_stopped.load(Ordering::SeqCst)
        }
    }

    fn request(folder: &Path, film: &str) -> FilmRequest {
        let text = include_str!("../../../../crates/editor/ui_tests/scene.toml");
        FilmRequest {
            text: text.replace("size = [160, 120]", "size = [32, 24]\norbit = 90.0"),
            path: folder.join("p.toml"),
            steps: None,
            frames: Some(3),
            rate: 10.0,
            size: None,
            film: folder.join(film),
        }
    }

    #[test]
    fn the_film_is_that_of_the_command() {
        let registry = crate::nodes::registry().unwrap();
        let [of_editor, of_command] = [(); 2].map(|()| tempfile::tempdir().unwrap());
        let said = film_of(&request(of_editor.path(), "film.gif"), &registry, &Watch::new(false)).unwrap();
        assert!(said.contains("a film of 3 frames, 0.30 s"), "{said}");
        let request = request(of_command.path(), "film.gif");
        std::fs::write(&request.path, &request.text).unwrap();
        let words = Words::try_parse_from(command_of(&request)).unwrap();
        assert!(matches!(crate::cli::commands::run::run(&words.run, &registry), Ok(DONE)));
        let bytes = |folder: &Path| std::fs::read(folder.join("film.gif")).unwrap();
        assert!(bytes(of_editor.path()) == bytes(of_command.path()));
    }

    #[test]
    fn a_film_that_is_stopped_leaves_the_former_one_and_nothing_else() {
        let registry = crate::nodes::registry().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let request = request(folder.path(), "film.gif");
        std::fs::write(&request.film, "the former").unwrap();
        let error = film_of(&request, &registry, &Watch::new(true)).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Cancelled, "{error}");
        assert_eq!(std::fs::read_to_string(&request.film).unwrap(), "the former");
        let names = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name());
        let names: Vec<String> = names.map(|name| name.to_string_lossy().into_owned()).collect();
        assert!(names.iter().all(|name| name == "film.gif" || name.starts_with("picture")), "{names:?}");
    }
}
