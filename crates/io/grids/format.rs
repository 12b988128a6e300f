//! The formats that grids are written in.

use super::contents::Contents;
use super::{vtkhdf, vtu};
use std::io::{self, Write};

/// A format that grids are written in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum GridFormat {
    /// VTK XML.
    Vtu,
    /// VTKHDF.
    Vtkhdf,
}

impl GridFormat {
    /// The formats; the first is that of streams.
    pub const ALL: [GridFormat; 2] = [GridFormat::Vtu, GridFormat::Vtkhdf];

    /// Ending of its files, without the point.
    pub fn ending(self) -> &'static str {
        match self {
            GridFormat::Vtu => "vtu",
            GridFormat::Vtkhdf => "vtkhdf",
        }
    }

    /// True if its arrays may be compressed.
    pub fn can_compress(self) -> bool {
        self == GridFormat::Vtu
    }

    /// Name of an array in the file.
    pub fn array_name(self, name: &str) -> String {
        match self {
            GridFormat::Vtu => name.to_owned(),
            GridFormat::Vtkhdf => vtkhdf::array_name(name),
        }
    }

    /// Writes a file from front to back, an array at a time.
    ///
    /// Errors: those of `out`; in them, as an [`Error`](voltet_core::Error), what the format cannot hold.
    pub fn write(self, contents: &Contents, is_compressed: bool, out: &mut dyn Write) -> io::Result<()> {
        match self {
            GridFormat::Vtu => vtu::write(contents, is_compressed, out),
            GridFormat::Vtkhdf => vtkhdf::write(contents, out),
        }
    }
}
