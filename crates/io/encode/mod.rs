//! Pictures to files, and what files of pictures carry; colour spaces, and colours for numbers. A format is a file here and an entry of
//! [`FORMATS`].

mod colors;
mod exr;
mod format;
mod png;
mod source;

pub use self::png::png;
pub use colors::{linear_from_srgb, srgb_from_linear, srgb8, viridis};
pub use format::PictureFormat;
pub use source::Source;

use std::path::Path;
use voltet_core::{Error, Result};

/// All formats; the first is written to streams.
pub const FORMATS: &[PictureFormat] = &[png::FORMAT, exr::FORMAT];

/// Endings of the formats' names in one phrase: ".png or .exr".
pub fn endings() -> String {
    FORMATS.iter().map(|format| format!(".{}", format.name)).collect::<Vec<_>>().join(" or ")
}

/// The format that a path's ending states.
///
/// # Errors
/// An ending of no known format.
pub fn format_by_ending(path: &Path) -> Result<&'static PictureFormat> {
    let ending = path.extension().map(|ending| ending.to_string_lossy().to_lowercase());
    FORMATS.iter().find(|format| ending.as_deref() == Some(format.name)).ok_or_else(|| {
        let error = Error::usage("the picture's format is not known").got(path.display());
        error.expected(format!("a path that ends in {}", endings()))
    })
}

/// The format of a picture that begins like this (8 bytes are enough).
pub fn format_of(head: &[u8]) -> Option<&'static PictureFormat> {
    FORMATS.iter().find(|format| head.starts_with(format.signature))
}
