//! `voltet edit`: the node editor.

use crate::arguments::Edit;
use crate::core::Result;
use crate::core::graph::Registry;

#[cfg(feature = "editor")]
pub fn edit(arguments: &Edit, registry: &Registry) -> Result<u8> {
    voltet_editor::run(arguments.file.as_deref(), registry, std::sync::Arc::new(pipeline_for))?;
    Ok(super::outcome::DONE)
}

/// The text of a pipeline for a file that is none: what a picture carries, or what is found for data. `at`: where it would be
/// saved.
#[cfg(feature = "editor")]
fn pipeline_for(path: &std::path::Path, at: &std::path::Path) -> Result<String> {
    use crate::Source;
    use crate::arguments::Start;
    let is_picture = path.extension().is_some_and(|end| end == "png" || end == "exr");
    if is_picture {
        return Ok(Source::read(path)?.text);
    }
    let (data, output) = (path.to_path_buf(), Some(at.to_path_buf()));
    let arguments = Start { data, output, scalar: None, time_step: None, solution: None, force: false };
    let quiet = crate::present::Bar::new(true);
    super::start::pipeline(&arguments, at, &super::reading::Inspecting(&quiet)).map(|(text, _)| text)
}

#[cfg(not(feature = "editor"))]
pub fn edit(_: &Edit, _: &Registry) -> Result<u8> {
    let error = crate::core::Error::usage("this program was built without the node editor");
    Err(error.accepted("one built by `cargo build --release --features editor`"))
}
