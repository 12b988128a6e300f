//! `voltet study`: error against time of every integrator on one scene.

use super::shared::{DONE, FAILED, Outcome, open_file, show, with_bar};
use crate::Document;
use crate::cli::arguments;
use crate::cli::present::{print, say, warnings};
use crate::core::progress::Progress;
use crate::core::{Error, Result, counted};
use crate::document;
use crate::graph::{Observer, Registry};
use crate::nodes::files;
use crate::optics::integrators::Integrator;
use std::path::{Path, PathBuf};
use voltet_study::work_precision::{self as study, Frames, Study, StudyOptions};

pub fn study(arguments: &arguments::Study, registry: &Registry) -> Outcome {
    let wish = StudyOptions {
        engines: arguments.engine,
        adapter: arguments.adapter.clone(),
        only: arguments.only.clone(),
        frames: Frames {
            count: arguments.frames,
            patience: study::patience(arguments.patience, "--patience")?,
            turn: 0.0,
            in_flight: 1,
        },
        measure: arguments.measure,
        max_error: arguments.max_error,
        refine: arguments.refine,
    };
    let integrators: Vec<&str> = study::studied(registry).iter().map(Integrator::name).collect();
    wish.check(&integrators, option)?;
    let document = open_file(&arguments.file, registry, arguments.quiet)?;
    document.refuse_missing_data().map_err(|error| document.failure(error))?;
    if arguments.apply && document.carried.is_some() {
        let error = Error::usage("--apply writes into a pipeline file, and this is a picture");
        return Err(error
            .expected("a pipeline file (.toml); `voltet info` of the picture prints it")
            .in_file(&document.path)
            .into());
    }
    let folder = arguments.output.clone().unwrap_or_else(|| beside(&document.path));
    let outputs = study::files_to_overwrite(&folder);
    let outputs: Vec<_> = outputs.iter().map(|path| ("--output", path.as_path())).collect();
    document::refuse_conflicts([&document], false, &outputs)?;
    refuse_unwritable(&folder)?;
    if arguments.apply {
        files::refuse_unwritable(&document.path)?;
    }
    let cache = arguments.cache.clone().unwrap_or_else(study::cache_folder);
    let node = arguments.node.as_deref();
    let made = with_bar(arguments.quiet, |bar, progress| {
        make(&document, node, wish, [&folder, &cache], (bar, progress))
    });
    let (study, written) = made.map_err(|error| document.failure(error))?;
    if !arguments.quiet {
        say(&warnings(&study.subject.warnings, document.graph.warnings.len()));
        print(&summary(&study, &written, &folder))?;
    }
    conclude(arguments, &document, registry, &study).map_err(|error| document.failure(error))
}

/// Option of a name, as it is given on the command line.
pub(super) fn option(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// Measures the picture of a node of a document. `folders`: that of the study, and the one that keeps reference pictures.
pub(super) fn make(
    document: &Document,
    node: Option<&str>,
    wish: StudyOptions,
    [folder, cache]: [&Path; 2],
    followed: (&dyn Observer, &dyn Progress),
) -> Result<(Study, Vec<PathBuf>)> {
    let title = document.pipeline.title.clone().unwrap_or_else(|| document.path.display().to_string());
    study::measure((&document.graph, node, &title), wish, Some(folder), cache, followed)
}

/// Finds out, before the work, whether the folder is there or can be made, and can be written to.
pub(super) fn refuse_unwritable(folder: &Path) -> Result<()> {
    let there = folder.ancestors().find(|path| path.exists()).unwrap_or(Path::new("."));
    if !there.is_dir() {
        let error = Error::run("the folder for the study cannot be made: a file is in its place");
        return Err(error.got(there.display()).expected("--output with the path of a folder"));
    }
    files::refuse_unwritable(&there.join("study.html"))
}

/// `scene.toml` is studied in `scene.study`.
pub(super) fn beside(file: &Path) -> PathBuf {
    file.with_extension("study")
}

fn summary(study: &Study, written: &[PathBuf], folder: &Path) -> String {
    let reference = &study.reference;
    let origin = if reference.cached { "kept from before" } else { "drawn" };
    let mut text = format!("reference: {origin} ({:.1} s)\n", reference.seconds);
    if !study.rows.is_empty() {
        text += &study::text(study);
    }
    text.extend(study::recommendation(study).filter(|_| !study.rows.is_empty()).map(|line| line + "\n"));
    if !written.is_empty() {
        text += &format!("{}: {}\n", folder.display(), counted(written.len(), "file"));
    }
    text
}

/// Writes the recommendation back where that is requested, and returns the exit code.
fn conclude(
    arguments: &arguments::Study,
    document: &Document,
    registry: &Registry,
    study: &Study,
) -> Result<u8> {
    if study.stopped() {
        let error = Error::cancelled();
        let mut done = format!("{} of {} settings are measured", study.rows.len(), study.setting_count);
        if study.wish.refine > 0 {
            done += ", the grid was not refined";
        }
        show(&error.got(done).into());
        return Ok(FAILED);
    }
    let Some(bound) = study.wish.max_error else { return Ok(DONE) };
    let Some(row) = study.recommended.map(|i| &study.rows[i]) else {
        let least = study.rows.iter().map(|row| row.error(study.wish.measure)).fold(f64::INFINITY, f64::min);
        let error = Error::run("no setting keeps the error allowed").got(format!("{least:.1e} at best"));
        return Ok(show(&error.expected(format!("at most {bound}")).into()));
    };
    if arguments.apply {
        let text = study::apply(&document.text, study, &row.setting)?;
        // What is written must be readable, also without the options of this call.
        Document::from_text(&document.path, text.clone(), &[], registry)?;
        if text == document.text {
            print(&format!("{}: has it already\n", document.path.display()))?;
        } else {
            files::write_whole(&document.path, text.as_bytes())?;
            print(&format!("{}: now draws with {}\n", document.path.display(), row.setting.label()))?;
        }
    }
    Ok(DONE)
}
