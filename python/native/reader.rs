//! Readers of file formats that are Python functions.

use crate::filter::{Called, attached, keywords, plugin, register_node, schema};
use crate::grid::piece_of;
use crate::memory::Lent;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use voltet_core::field::Plugin;
use voltet_core::grid::{Association, Cells};
use voltet_core::parameters::{Parameters, VariantSchema};
use voltet_core::progress::Progress;
use voltet_core::reading::{FileArray, GridHead, GridRead, GridReader, OpenGrid};
use voltet_core::{Error, Result};

/// A Python function that reads files.
struct FileReader {
    kind: VariantSchema,
    plugin: Plugin,
    /// Ends of file names, in lower case and without the dot.
    extensions: Vec<String>,
    /// First bytes of its files; empty: the names decide.
    magic: Vec<u8>,
    /// `voltet._readers._Reader`.
    call: Py<PyAny>,
}

/// A file, as `voltet._readers._Contents` holds it.
struct Contents {
    subject: String,
    head: GridHead,
    contents: Py<PyAny>,
    warnings: Vec<String>,
}

/// Registers a function as a reader, in place of a former one of this name.
#[pyfunction]
#[allow(clippy::too_many_arguments)]
pub fn register_reader(
    py: Python<'_>,
    name: String,
    summary: String,
    parameters: Vec<Bound<'_, PyDict>>,
    file: PathBuf,
    source: String,
    extensions: Vec<String>,
    magic: Vec<u8>,
    call: Py<PyAny>,
) -> PyResult<()> {
    let kind = schema(name, summary, &parameters)?;
    let function = FileReader { kind, plugin: plugin(file, &source), extensions, magic, call };
    // It lives as long as the program.
    let node = voltet_nodes::external_formats::reader(Box::leak(Box::new(function)));
    crate::error::guarded(py, || register_node(node))
}

impl FileReader {
    fn subject(&self) -> String {
        format!("the reader '{}'", self.kind.name)
    }
}

impl GridReader for FileReader {
    fn declaration(&self) -> VariantSchema {
        self.kind
    }

    fn plugin(&self) -> Option<&Plugin> {
        Some(&self.plugin)
    }

    fn matches(&self, head: &[u8], path: &Path) -> bool {
        if !self.magic.is_empty() {
            return head.starts_with(&self.magic);
        }
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        let has = |end: &String| name.strip_suffix(end.as_str()).is_some_and(|stem| stem.ends_with('.'));
        self.extensions.iter().any(has)
    }

    fn files(&self) -> String {
        match self.extensions.is_empty() {
            true => format!("a file for {}", self.subject()),
            false => self.extensions.iter().map(|end| format!(".{end}")).collect::<Vec<_>>().join(" "),
        }
    }

    fn open(
        &self,
        path: &Path,
        step: usize,
        parameters: &Parameters,
        progress: &dyn Progress,
    ) -> Result<Box<dyn OpenGrid>> {
        progress.report("read", 0.0);
        let subject = self.subject();
        let (head, contents, warnings) = attached(&subject, |py| {
            let contents = {
                let set = keywords(py, self.kind, parameters)?;
                let _called = Called::new(py)?;
                self.call.bind(py).call1((path.as_os_str(), step, set))?
            };
            let warnings = contents.getattr("warnings")?.extract()?;
            Ok((head(&contents, self.kind.name)?, contents.unbind(), warnings))
        })?;
        match &head.scalar {
            Some(name) if !head.arrays.iter().any(|array| array.name == *name) => {
                let error = Error::run(format!("{subject} marks a scalar that is none of its arrays"));
                Err(error.got(format!("'{name}'")))
            }
            _ => Ok(Box::new(Contents { subject, head, contents, warnings })),
        }
    }
}

/// Table of contents of `voltet._readers._Contents`.
fn head(contents: &Bound<'_, PyAny>, name: &str) -> PyResult<GridHead> {
    let arrays: Vec<(String, bool, usize)> = contents.getattr("arrays")?.extract()?;
    let array = |(name, on_cells, component_count)| FileArray {
        name,
        association: if on_cells { Association::Cell } else { Association::Point },
        component_count,
    };
    Ok(GridHead {
        format: contents.getattr("format")?.extract::<Option<String>>()?.unwrap_or_else(|| name.to_string()),
        point_count: contents.getattr("point_count")?.extract()?,
        cell_count: contents.getattr("cell_count")?.extract()?,
        cell_bytes: contents.getattr("cell_bytes")?.extract()?,
        arrays: arrays.into_iter().map(array).collect(),
        scalar: contents.getattr("scalar")?.extract()?,
        times: contents.getattr("times")?.extract()?,
    })
}

impl OpenGrid for Contents {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, arrays: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        progress.report("read", 0.5);
        let read = attached(&self.subject, |py| {
            let given = {
                let _called = Called::new(py)?;
                self.contents.bind(py).call_method1("read", (geometry, arrays.to_vec()))?
            };
            let (piece, values): (Option<Bound<'_, PyDict>>, Vec<Bound<'_, PyAny>>) = given.extract()?;
            let mut read = GridRead {
                points: None,
                cells: None,
                arrays: values.iter().map(numbers).collect::<PyResult<_>>()?,
                warnings: self.warnings.clone(),
            };
            if let Some(piece) = piece {
                let raw = piece_of(&piece)?;
                // Copied: the function may write its arrays again.
                read.points = Some(raw.points.to_vec());
                read.cells = Some(match raw.cells {
                    Cells::Tetrahedra(lent) => Cells::Tetrahedra(lent.to_vec().into()),
                    cells => cells,
                });
            }
            Ok(read)
        })?;
        self.refuse_changed(arrays, &read.arrays)?;
        Ok(read)
    }
}

impl Contents {
    /// Errors: an array is not as large as its shape was.
    fn refuse_changed(&self, places: &[usize], arrays: &[Vec<f64>]) -> Result<()> {
        for (&place, values) in places.iter().zip(arrays) {
            let array = &self.head.arrays[place];
            let expected = self.head.tuple_count(array) * array.component_count as u64;
            if values.len() as u64 != expected {
                let what = format!("{} gave an array of another size than its shape", self.subject);
                return Err(Error::run(what).got(values.len()).expected(expected).at_item(&array.name));
            }
        }
        Ok(())
    }
}

fn numbers(values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    Lent::<f64>::borrow("an array of the reader", values).map(|lent| lent.values().to_vec())
}
