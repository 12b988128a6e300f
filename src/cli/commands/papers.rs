//! `voltet papers`: the tables and figures of the papers, made anew.

use super::shared::{DONE, Outcome, with_bar};
use super::study::refuse_unwritable;
use crate::Document;
use crate::cli::arguments;
use crate::cli::present::print;
use crate::core::{Error, Result, counted};
use crate::graph::{NoObserver, Registry};
use crate::nodes::files;
use std::path::{Path, PathBuf};
use std::time::Duration;
use voltet_study::papers::{self, Paper, PapersOptions, Section};
use voltet_study::work_precision::{self as study, Frames, Subject};

/// No further frame of a picture begins after so many seconds.
const TIME_LIMIT: Duration = Duration::from_secs(3);

/// The page, and the folder of its figures.
const PAGE: &str = "papers.md";

pub fn papers(arguments: &arguments::Papers, registry: &Registry) -> Outcome {
    if arguments.frames == 0 {
        return Err(Error::usage("--frames is out of range").got(0).expected("1 or more").into());
    }
    let papers = if arguments.only.is_empty() { Paper::ALL.to_vec() } else { arguments.only.clone() };
    refuse_unwritable(&arguments.output)?;
    let options = PapersOptions {
        papers,
        size: arguments.size,
        frames: Frames { count: arguments.frames, patience: TIME_LIMIT, turn: 0.0, in_flight: 1 },
        max_cells: arguments.max_cells,
        data: arguments.data.clone(),
        cache: arguments.cache.clone().unwrap_or_else(study::cache_folder),
    };
    let open = |file: &str, options: &[String]| open(&arguments.pipelines, file, options, registry);
    let sections = with_bar(arguments.quiet, |_, progress| papers::papers(&options, &open, progress))?;
    let written = write(&sections, &arguments.output)?;
    print(&format!("{}: {}\n", arguments.output.display(), counted(written.len(), "file")))?;
    Ok(DONE)
}

/// The scene of one of the pipelines.
fn open(folder: &Path, file: &str, options: &[String], registry: &Registry) -> Result<Subject> {
    let path = folder.join(file);
    if !path.is_file() {
        return Err(Error::usage("the pipelines of the papers are not there")
            .got(path.display())
            .expected("--pipelines with the folder lab/pipelines/papers of the program's repository"));
    }
    let document = Document::open(&path, options, registry)?;
    let mut session = crate::nodes::session();
    Subject::gather(&document.graph, None, false, &mut session, &NoObserver)
        .map_err(|error| document.locate(error))
}

/// Writes the page and the figures, and gives the paths.
fn write(sections: &[Section], folder: &Path) -> Result<Vec<PathBuf>> {
    let figures = folder.join(papers::FOLDER);
    std::fs::create_dir_all(&figures).map_err(|error| {
        let what = format!("the folder '{}' cannot be made", figures.display());
        Error::run(what).got(error).expected("--output with a folder that can be written to")
    })?;
    let each = sections.iter().flat_map(|section| &section.figures);
    let mut outputs: Vec<(PathBuf, Vec<u8>)> =
        each.map(|figure| (figures.join(&figure.name), figure.png.clone())).collect();
    outputs.push((folder.join(PAGE), papers::page(sections)?.into_bytes()));
    for (path, content) in &outputs {
        files::write_whole(path, content)?;
    }
    Ok(outputs.into_iter().map(|(path, _)| path).collect())
}
