//! `voltet edit`: the node editor.

use crate::cli::arguments::Edit;
use crate::core::Result;
#[cfg(feature = "editor")]
use crate::core::{graph::Observer, progress::Progress};
use crate::graph::Registry;
#[cfg(feature = "editor")]
use voltet_editor::{Studied, StudiedRow, StudyRequest};

#[cfg(feature = "editor")]
pub fn edit(arguments: &Edit, registry: &Registry) -> Result<u8> {
    use std::sync::Arc;
    let (own, of_start) = (registry.clone(), registry.clone());
    let study = Arc::new(move |of: &StudyRequest, progress: &dyn Progress| study_of(of, &own, progress));
    let start = move |path: &std::path::Path, at: &std::path::Path| pipeline_for(path, at, &of_start);
    voltet_editor::run(arguments.file.as_deref(), registry, Arc::new(start), study)?;
    Ok(super::exit_status::DONE)
}

/// `voltet study` without options, of a pipeline that need not be saved.
#[cfg(feature = "editor")]
fn study_of(of: &StudyRequest, registry: &Registry, progress: &dyn Progress) -> Result<Studied> {
    use crate::Document;
    use crate::document::{self, OptionFile};
    use voltet_study::work_precision as study;
    let document = Document::from_text(&of.path, of.text.clone(), &[], registry)?;
    document.refuse_missing_data()?;
    let folder = super::study::beside(&of.path);
    let outputs: Vec<OptionFile> =
        study::written(&folder).iter().map(|path| OptionFile::written("the study", path)).collect();
    document::refuse_conflicts([&document], false, &outputs).map_err(|(error, _)| error)?;
    super::study::refuse_unwritable(&folder)?;
    let wish = super::study::wish(&crate::cli::arguments::Study::for_file(&of.path)?, registry)?;
    let followed = (&Gathering(progress) as &dyn Observer, progress);
    let node = of.node.as_deref();
    let folders = [folder.as_path(), &study::cache_folder()];
    let (found, written) = super::study::make(&document, node, wish, folders, followed, &|| {})?;
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

/// Follows the run of what feeds the picture.
#[cfg(feature = "editor")]
struct Gathering<'a>(&'a dyn Progress);

#[cfg(feature = "editor")]
impl Observer for Gathering<'_> {
    fn progress(&self, node: &str, stage: &str, fraction: f64) {
        self.0.report(&format!("{node}: {stage}"), fraction);
    }

    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }

    fn memory_left(&self) -> Option<u64> {
        self.0.memory_left()
    }
}

/// The text of a pipeline for a file that is none: what a picture carries, or what is found for data. `at`: where it would be
/// saved.
#[cfg(feature = "editor")]
fn pipeline_for(path: &std::path::Path, at: &std::path::Path, registry: &Registry) -> Result<String> {
    use crate::Source;
    use crate::cli::arguments::Start;
    if crate::cli::commands::info::is_picture(path) {
        return Ok(Source::read(path)?.text);
    }
    let (data, output) = (path.to_path_buf(), Some(at.to_path_buf()));
    let arguments = Start { data, output, ..Start::default() };
    let quiet = crate::cli::present::Bar::new(true);
    super::start::pipeline(&arguments, registry, at, &super::array_choice::bar_progress(&quiet))
        .map(|(text, _)| text)
}

#[cfg(not(feature = "editor"))]
pub fn edit(_: &Edit, _: &Registry) -> Result<u8> {
    let error = crate::core::Error::usage("this program was built without the node editor");
    Err(error.expected("one built by `cargo build --release --features editor`"))
}
