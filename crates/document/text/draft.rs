//! A text that is being changed.

use super::lines;
use super::syntax::Syntax;
use crate::delta::Delta;
use crate::path::Path;
use std::ops::Range;
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_graph::ParameterValue;

/// A text that is being changed: where everything stands in it, and what is to be replaced.
///
/// Changes that follow each other without [`Draft::settle`] are all of the text as it was: they may not touch the same bytes, and
/// do not see each other.
pub struct Draft {
    pub(super) text: Arc<str>,
    pub(super) syntax: Arc<Syntax>,
    replaced: Vec<(Range<usize>, String)>,
    so_far: Delta,
}

impl Draft {
    /// Draft of a text that is valid TOML, with its syntax tree.
    pub fn new(text: Arc<str>, syntax: Arc<Syntax>) -> Draft {
        Draft { text, syntax, replaced: Vec::new(), so_far: Delta::default() }
    }

    /// Replaces bytes. Line ends are written as the text has them.
    pub(super) fn replace(&mut self, range: Range<usize>, new: &str) {
        let new = match lines::line_end(&self.text) {
            "\n" => new.to_string(),
            line_end => new.replace("\r\n", "\n").replace('\n', line_end),
        };
        self.replaced.push((range, new));
    }

    /// Carries out what was asked for so far, so that what follows sees it.
    pub fn reparse(&mut self) -> Result<()> {
        if self.replaced.is_empty() {
            return Ok(());
        }
        let delta = Delta::new(&self.text, std::mem::take(&mut self.replaced))?;
        self.text = delta.applied(&self.text)?.into();
        self.syntax = Arc::new(Syntax::read(&self.text));
        self.so_far = self.so_far.then(&delta);
        Ok(())
    }

    /// All changes, and the text that they make.
    pub fn into_delta(mut self) -> Result<(Delta, Arc<str>, Arc<Syntax>)> {
        self.reparse()?;
        Ok((self.so_far, self.text, self.syntax))
    }

    /// The text as of the last settling.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Value at a range; none where it spans lines.
    pub(super) fn datum(&self, place: &Range<usize>) -> Option<ParameterValue> {
        voltet_graph::pipeline::value(&self.text[place.clone()]).map(|setting| setting.datum)
    }
}

/// The error where a path leads nowhere.
pub(super) fn nothing_at(path: &Path) -> Error {
    Error::usage("there is nothing at this place of the file").got(path)
}
