//! `voltet edit`: the node editor.

use super::shared::{DONE, Outcome};
use super::{plugins, run::film_of, start, study as measured};
use crate::cli::arguments::{Edit, Start};
use crate::core::Result;
use crate::core::progress::Progress;
use crate::document;
use crate::graph::{NodeProgress, Observer, Registry};
use crate::{Document, Source};
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use voltet_editor::{FilmRequest, Services, Studied, StudiedRow, StudyRequest};
use voltet_study::work_precision::{self as study, StudyOptions};

pub fn edit(arguments: &Edit, registry: &Registry) -> Outcome {
    // With the plug-ins that are loaded meanwhile.
    let known = Arc::new(Mutex::new(registry.clone()));
    let [start, study, film, plugin] = [(); 4].map(|()| known.clone());
    let services = Services {
        start: Arc::new(move |path: &Path, at: &Path, progress: &dyn Progress| {
            pipeline_for(path, at, &current(&start), progress)
        }),
        study: Arc::new(move |of: &StudyRequest, observer: &dyn Observer| {
            studied(of, &current(&study), observer)
        }),
        film: Arc::new(move |of: &FilmRequest, observer: &dyn Observer| {
            film_of(of, &current(&film), observer)
        }),
        plugin: Arc::new(move |path: &Path| {
            let (more, words) = plugins::with_dropped(&current(&plugin), path)?;
            *plugin.lock().unwrap_or_else(PoisonError::into_inner) = more.clone();
            Ok((more, words))
        }),
    };
    voltet_editor::run(arguments.file.as_deref(), registry, services)?;
    Ok(DONE)
}

fn current(known: &Mutex<Registry>) -> Registry {
    known.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// `voltet study` without options, of a pipeline that need not be saved.
fn studied(of: &StudyRequest, registry: &Registry, observer: &dyn Observer) -> Result<Studied> {
    let document = Document::from_text(&of.path, of.text.clone(), &[], registry)?;
    document.refuse_missing_data()?;
    let folder = measured::beside(&of.path);
    let outputs = study::files_to_overwrite(&folder);
    let outputs: Vec<_> = outputs.iter().map(|path| ("the study", path.as_path())).collect();
    document::refuse_conflicts([&document], false, &outputs).map_err(|failure| failure.error)?;
    measured::refuse_unwritable(&folder)?;
    let followed: (_, &dyn Progress) = (observer, &NodeProgress { observer, node: "" });
    let node = of.node.as_deref();
    let folders = [folder.as_path(), &study::cache_folder()];
    let (found, written) = measured::make(&document, node, StudyOptions::default(), folders, followed)?;
    let mut rows: Vec<StudiedRow> = found
        .rows
        .iter()
        .map(|row| StudiedRow {
            label: row.setting.label(),
            seconds: 1e-3 * row.cost.picture.median_ms,
            max: row.errors.maximum,
            rms: row.errors.root_mean_square,
            on_front: row.on_front,
            of_file: row.of_file,
        })
        .collect();
    rows.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let mut notes: Vec<String> = study::recommendation(&found).into_iter().collect();
    notes.extend(found.left_out.iter().map(|left| format!("not measured: {left}")));
    if found.stopped() {
        notes.push(format!("stopped: {} of {} settings are measured", rows.len(), found.setting_count));
    }
    Ok(Studied { rows, notes, folder: (!written.is_empty()).then_some(folder) })
}

/// The text of a pipeline for a file that is none: what a picture carries, or what is found for data. `at`: where it would be
/// saved.
fn pipeline_for(path: &Path, at: &Path, registry: &Registry, progress: &dyn Progress) -> Result<String> {
    if super::info::is_picture(path) {
        return Ok(Source::read(path)?.text);
    }
    let (data, output) = (path.to_path_buf(), Some(at.to_path_buf()));
    let arguments = Start { data, output, ..Start::default() };
    start::pipeline(&arguments, registry, at, progress).map(|(text, _)| text)
}
