//! The file that a node writes: its path, and the format that the path's ending means; with the crate `voltet-files`.

pub use voltet_files::write_parts as write_whole_in_parts;
pub use voltet_files::*;

use std::io::{self, Write};
use std::path::Path;
use voltet_core::Result;
use voltet_core::progress::Progress;
use voltet_graph::{DefaultValue, Parameter, ParameterType, Parameters, Preparation, RunContext};

/// The word for a format that the path decides.
pub const BY_ENDING: &str = "auto";

/// Path of the output file.
pub const PATH: Parameter = Parameter {
    name: "path",
    parameter_type: ParameterType::OutputPath,
    unit: "",
    default: DefaultValue::Required,
    help: "the file; \"-\": the standard output",
};

/// Format of the output file; names of formats stand in place of none.
pub const FORMAT: Parameter = Parameter {
    name: "format",
    parameter_type: ParameterType::Choice(&[]),
    unit: "",
    default: DefaultValue::Text(BY_ENDING),
    help: "",
};

/// Index of the format: the requested one, or the path's ending, or the first on streams. `formats`: their names, which are endings,
/// too. `what`: the format's subject, for the error.
pub fn format(parameters: &Parameters, what: &str, formats: &[&str]) -> Result<usize> {
    let path = parameters.text(PATH.name)?;
    let ending = Path::new(path).extension().map(|ending| ending.to_string_lossy().to_lowercase());
    let asked = parameters.text(FORMAT.name)?;
    let word = if asked == BY_ENDING { ending.as_deref() } else { Some(asked) };
    match formats.iter().position(|format| word == Some(format)) {
        Some(index) => Ok(index),
        None if ending.is_none() && is_stream(path) => Ok(0),
        None => {
            let (endings, names) = (formats.join(" or ."), formats.join("\" or \""));
            let error = parameters.error(PATH.name, format!("{what} is not known")).got(path);
            Err(error.expected(format!("a path that ends in .{endings}, or format = \"{names}\"")))
        }
    }
}

/// Refuses a path that cannot be written, before anything is computed.
pub fn prepare(preparation: &Preparation) -> Result<()> {
    let path = preparation.path(PATH.name)?;
    refuse_unwritable(&path).map_err(|error| preparation.parameters.locate(PATH.name, error))
}

/// Writes it whole, and notes it. Errors: also a stop, since encoding takes seconds in which one may have been asked for.
pub fn write(call: &mut RunContext, content: &[u8]) -> Result<()> {
    write_parts(call, &mut |_, out| out.write_all(content))
}

/// Like [`write()`], for content that is made while it is written.
pub fn write_parts(
    call: &mut RunContext,
    content: &mut dyn FnMut(&dyn Progress, &mut dyn Write) -> io::Result<()>,
) -> Result<()> {
    call.progress().check_cancelled()?;
    let path = call.path(PATH.name)?;
    let progress = call.progress();
    voltet_files::write_parts(&path, &mut |out| content(progress, out))
        .map_err(|error| call.parameters.locate(PATH.name, error))?;
    call.notes.files.push(display_path(&path));
    Ok(())
}
