//! Readers of further file formats: the trait that a format from outside implements. `voltet_nodes::external_formats::reader` makes a node of one.

use crate::Result;
use crate::field::Plugin;
use crate::grid::{Association, Cells};
use crate::parameters::{Parameters, VariantSchema};
use crate::progress::Progress;
use glam::DVec3;
use std::path::Path;

/// Reads grids from files of a format.
pub trait GridReader: Send + Sync {
    /// The type of its node in pipeline files, what it reads in a sentence, and what can be set beside what every reader has.
    fn declaration(&self) -> VariantSchema;

    /// The plug-in that it was loaded from; `None` for one that the program was built with.
    fn plugin(&self) -> Option<&Plugin> {
        None
    }

    /// True if a file is of this format, by its first bytes (at most 256) and its name.
    fn matches(&self, head: &[u8], path: &Path) -> bool;

    /// File names of the format, for help: ".cells".
    fn files(&self) -> String;

    /// Checks what single declarations cannot say (parameters that exclude each other). Touches no file.
    fn check(&self, _parameters: &Parameters) -> Result<()> {
        Ok(())
    }

    /// Reads the headers of a file, for a step of the series that it is (0 where it is none).
    ///
    /// Errors: what is wrong with the file; who calls adds its path.
    fn open(
        &self,
        path: &Path,
        step: usize,
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Box<dyn OpenGrid>>;
}

/// A file whose headers are known.
pub trait OpenGrid: Send + Sync {
    /// Table of contents.
    fn head(&self) -> &GridHead;

    /// Reads points and cells where they are wanted, and the arrays with these places in the head, in that order.
    ///
    /// Errors: what is wrong with the file.
    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead>;
}

/// Table of contents of a file: everything but the numbers.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GridHead {
    /// Format and encoding of the file, for people.
    pub format: String,
    /// Points.
    pub point_count: u64,
    /// Cells of any dimension.
    pub cell_count: u64,
    /// Bytes of the cells in memory.
    pub cell_bytes: u64,
    /// The arrays.
    pub arrays: Vec<FileArray>,
    /// The array that the file marks as the one to draw.
    pub scalar: Option<String>,
    /// Times of the steps of a series; empty where the file is none.
    pub times: Vec<f64>,
}

impl GridHead {
    /// Number of tuples of an array.
    pub fn tuple_count(&self, array: &FileArray) -> u64 {
        match array.association {
            Association::Cell => self.cell_count,
            Association::Point => self.point_count,
        }
    }
}

/// An array of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FileArray {
    /// Its name. No two at points, and no two at cells, share one.
    pub name: String,
    /// Location of the tuples: points or cells.
    pub association: Association,
    /// Numbers of a tuple, at least 1.
    pub component_count: usize,
}

/// Arrays read from a file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct GridRead {
    /// As many as the head says, where they were wanted.
    pub points: Option<Vec<DVec3>>,
    /// Cells; `None` if not requested.
    pub cells: Option<Cells>,
    /// The arrays that were wanted: as many tuples as there are points or cells.
    pub arrays: Vec<Vec<f64>>,
    /// Sentences for the user.
    pub warnings: Vec<String>,
}
