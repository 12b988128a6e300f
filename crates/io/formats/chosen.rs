//! The reader of a format that comes from outside, as a request chooses it.

use super::source::Source;
use std::path::Path;
use voltet_core::Result;
use voltet_core::parameters::Parameters;
use voltet_core::reading::GridReader;

/// The reader of a format that comes from outside, with what its parameters are set to.
#[derive(Clone)]
pub struct SelectedArrays {
    /// The reader.
    pub reader: &'static dyn GridReader,
    /// Its parameters, and maybe others.
    pub parameters: Parameters,
}

impl SelectedArrays {
    /// With its standard values, for a file of its format; the first of several. `None` where it is of none of theirs.
    ///
    /// Errors: the file cannot be read; a parameter that must be given.
    pub fn for_file(
        path: &Path,
        mut readers: impl Iterator<Item = &'static dyn GridReader>,
    ) -> Result<Option<SelectedArrays>> {
        let mut head = None;
        let meant = readers.find_map(|reader| {
            // Not opened for nobody.
            let head = head.get_or_insert_with(|| Source::open(path).and_then(|source| source.head(256)));
            match head {
                Ok(head) => reader.matches(head, path).then_some(Ok(reader)),
                Err(error) => Some(Err(error.clone())),
            }
        });
        let Some(reader) = meant.transpose()? else { return Ok(None) };
        let parameters = Parameters::from_values(reader.declaration().parameters, [])?;
        Ok(Some(SelectedArrays { reader, parameters }))
    }
}

impl PartialEq for SelectedArrays {
    fn eq(&self, other: &SelectedArrays) -> bool {
        std::ptr::addr_eq(self.reader, other.reader) && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for SelectedArrays {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Chosen").field("reader", &self.reader.declaration().name).finish_non_exhaustive()
    }
}
