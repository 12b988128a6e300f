//! Code that commands share: documents, errors and exit codes, progress, files that options name, and the choice of an array.

use crate::cli::arguments::{DataOptions, File, Files};
use crate::cli::present::{self, Bar, Level, print, say};
use crate::core::error::ErrorKind;
use crate::core::progress::Progress;
use crate::core::{Error, Result};
use crate::document::{self, LocatedError};
use crate::graph::pipeline::{Pipeline, locate};
use crate::graph::{NodeProgress, ParameterValue, Registry};
use crate::io::formats::{ArrayChoice, Association};
use crate::nodes::files;
use crate::{Document, Source};
use std::path::{Path, PathBuf};

/// Exit code of a command, or its error.
pub(super) type Outcome = std::result::Result<u8, LocatedError>;

/// Exit code of success.
pub(super) const DONE: u8 = 0;

/// Exit code of a run that failed or was cancelled, and of a bound that is broken.
pub(super) const FAILED: u8 = 1;

/// Exit code of a wrong command line or pipeline file.
pub(super) const WRONG: u8 = 2;

/// Shows an error, once, and returns its exit code.
pub(super) fn show(failure: &LocatedError) -> u8 {
    say(&present::shown(&failure.error, failure.text.as_deref(), Level::ERROR));
    match failure.error.kind {
        ErrorKind::Usage => WRONG,
        _ => FAILED,
    }
}

/// Shows the graph's warnings, and those about data and plug-ins that have changed since the picture was drawn.
pub(super) fn warn(document: &Document) {
    let changed = document.changed_data().into_iter().chain(document.changed_plugins());
    for warning in document.graph.warnings.iter().cloned().chain(changed) {
        let located = document.locate(warning);
        say(&present::shown(&located, Some(&document.text), Level::WARNING));
    }
}

/// Opens every file, showing each error; with the exit code, which is not [`DONE`] where any is wrong.
pub(super) fn open_all(files: &Files, shorts: &[ShortOption], registry: &Registry) -> (Vec<Document>, u8) {
    let mut documents = Vec::new();
    let mut worst = DONE;
    for path in &files.files {
        match open(path, &files.set.options, shorts, registry) {
            Ok(document) => documents.push(document),
            Err(failure) => worst = worst.max(show(&failure)),
        }
    }
    (documents, worst)
}

pub(super) fn open(
    path: &Path,
    options: &[String],
    shorts: &[ShortOption],
    registry: &Registry,
) -> std::result::Result<Document, LocatedError> {
    let source = Source::read(path)?;
    let text = source.text.clone();
    let spelled_out: Result<Vec<String>> =
        shorts.iter().map(|short| short.spelled_out(path, &text)).collect();
    let opened = spelled_out.and_then(|mut all| {
        all.extend_from_slice(options);
        Document::from_source(path, source, &all, registry)
    });
    opened.map_err(|error| LocatedError { error, text: Some(text) })
}

/// An option that is short for `--set` of a parameter of the only node of a type.
pub(super) struct ShortOption {
    pub name: &'static str,
    pub node_type: &'static str,
    pub parameter: &'static str,
    /// Its value; a text is a path, relative to the working folder.
    pub value: ParameterValue,
}

impl ShortOption {
    /// The option `node.param=value` that it stands for in a pipeline file.
    pub fn spelled_out(&self, path: &Path, text: &str) -> Result<String> {
        let ShortOption { name, node_type, parameter, value } = self;
        let nodes = Pipeline::parse(text).map_err(|error| locate(error, text, path))?.nodes;
        let names = nodes.iter().filter(|node| node.node_type.text() == Some(*node_type));
        let names: Vec<&str> = names.map(|node| node.name.as_str()).collect();
        let value = match value {
            ParameterValue::Text(output) if !files::is_standard_output(Path::new(output)) => {
                let output = files::relative_to(Path::new(output), files::folder(path));
                ParameterValue::Text(output.to_string_lossy().into_owned())
            }
            other => other.clone(),
        };
        let error = match names[..] {
            [node] => return Ok(format!("{node}.{parameter}={value}")),
            [] => Error::usage(format!("{name} is given, and the pipeline has no {node_type}"))
                .expected(format!("a node of type \"{node_type}\"")),
            [first, ..] => Error::usage(format!(
                "{name} is given, and the pipeline has several nodes of type {node_type}"
            ))
            .got(names.join(", "))
            .expected(format!("--set {first}.{parameter}=…, and alike for the others")),
        };
        Err(error.in_file(path))
    }
}

/// Opens the file of a command, and shows its warnings unless `quiet`.
pub(super) fn open_file(
    file: &File,
    registry: &Registry,
    quiet: bool,
) -> std::result::Result<Document, LocatedError> {
    let document = open(&file.file, &file.set.options, &[], registry)?;
    if !quiet {
        warn(&document);
    }
    Ok(document)
}

/// Carries out work with a progress bar, which is gone when it ends.
pub(super) fn with_bar<T>(quiet: bool, work: impl FnOnce(&Bar, &dyn Progress) -> T) -> T {
    let bar = Bar::new(quiet);
    let done = work(&bar, &NodeProgress { observer: &bar, node: "" });
    bar.clear();
    done
}

/// Shows text on the standard output; beside it where content of a file goes there, which stands there alone.
pub(super) fn tell(text: &str, is_taken: bool) -> Result<()> {
    match is_taken {
        true => say(text),
        false => drop(print(text)?),
    }
    Ok(())
}

/// Files that options of a command name to be written.
pub(super) struct Outputs<'a>(Vec<(&'static str, &'a Path)>);

impl<'a> Outputs<'a> {
    /// Checks the files of these options, before any work; the option `--plot` among them. `document`: the pipeline that is read.
    ///
    /// # Errors
    /// - a file that is an input or another output, that cannot be written, or a plot of no known format;
    /// - data of the pipeline that are missing.
    pub fn check(
        options: [(&'static str, &'a Option<PathBuf>); 3],
        document: Option<&Document>,
    ) -> std::result::Result<Self, LocatedError> {
        let named = options.into_iter().filter_map(|(option, path)| Some((option, path.as_deref()?)));
        let outputs = Outputs(named.collect());
        document::refuse_conflicts(document, false, &outputs.0)?;
        document.map_or(Ok(()), Document::refuse_missing_data)?;
        for (option, path) in &outputs.0 {
            if *option == "--plot" {
                refuse_other_plots(path)?;
            }
        }
        outputs.0.iter().try_for_each(|(_, path)| files::refuse_unwritable(path))?;
        Ok(outputs)
    }

    /// Writes the files, and shows a text for people.
    pub fn write(&self, content: impl Fn(&str) -> Result<String>, text: &str) -> Result<()> {
        for (option, path) in &self.0 {
            files::write_whole(path, content(option)?.as_bytes())?;
        }
        tell(text, self.0.iter().any(|(_, path)| files::is_standard_output(path)))
    }
}

/// Refuses a path of a plot that does not end in .svg.
fn refuse_other_plots(path: &Path) -> Result<()> {
    let is_svg = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("svg"));
    if is_svg || path.extension().is_none() && files::is_stream(&path.to_string_lossy()) {
        return Ok(());
    }
    Err(Error::usage("the format of the plot is not known")
        .got(format!("--plot {}", path.display()))
        .expected("a path that ends in .svg"))
}

/// Keys of a `reader` node that reads an array from the file `data`.
pub(super) fn reader_keys(choice: &ArrayChoice, data: &Path, options: &DataOptions) -> String {
    let text = |text: &str| ParameterValue::Text(text.into());
    let mut keys = format!("path = {}\nscalar = {}\n", text(&data.to_string_lossy()), text(&choice.scalar));
    if choice.association == Some(Association::Cell) {
        keys += "association = \"cell\"\n";
    }
    keys.extend(options.time_step.map(|step| format!("time_step = {step}\n")));
    let solution = options.solution.as_ref();
    keys.extend(solution.map(|path| format!("solution = {}\n", text(&path.to_string_lossy()))));
    keys
}
