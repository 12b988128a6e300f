//! Entries about patches: in the file about those of a mesh, and in fields.

use super::file::{FieldValues, FoamFile};
use super::patterns::Pattern;
use voltet_core::Result;

#[derive(Default)]
pub(super) struct MeshPatch {
    pub name: String,
    pub kind: String,
    pub groups: Vec<String>,
    pub first_face: usize,
    pub face_count: usize,
}

impl MeshPatch {
    /// Values that a field states there.
    pub fn values<'a>(&self, entries: &'a [PatchEntry]) -> Option<&'a PatchValues> {
        let fits = |entry: &&PatchEntry| entry.pattern.as_ref().is_some_and(|own| own.fits(&self.name));
        let named = || entries.iter().filter(|entry| entry.pattern.is_none());
        let own = named().find(|entry| entry.name == self.name);
        let entry = own.or_else(|| named().rfind(|entry| self.groups.contains(&entry.name)));
        entry.or_else(|| entries.iter().rfind(fits))?.values.as_ref()
    }
}

/// The entry of a field about a patch, a group of patches, or those whose names fit a pattern.
pub(super) struct PatchEntry {
    pub name: String,
    pub pattern: Option<Pattern>,
    /// `None`: no values of its own.
    pub values: Option<PatchValues>,
}

pub(super) enum PatchValues {
    /// One tuple for all faces.
    Uniform(Vec<f64>),
    /// A tuple for each face.
    List(Vec<f64>),
    /// A macro, code or a pattern that is not understood.
    Unread(String),
}

/// Numbers of the types that lists have in binary files, and whether they are labels.
const LIST_TYPES: [(&str, u64, bool); 6] = [
    ("List<scalar>", 1, false),
    ("List<vector>", 3, false),
    ("List<sphericalTensor>", 1, false),
    ("List<symmTensor>", 6, false),
    ("List<tensor>", 9, false),
    ("List<label>", 1, true),
];

impl FoamFile {
    pub fn patches(&mut self) -> Result<Vec<MeshPatch>> {
        let (count, _) = self.list_head()?;
        let mut patches = Vec::new();
        for _ in 0..count {
            let mut patch = MeshPatch { name: self.required("the name of a patch")?, ..MeshPatch::default() };
            self.expect("{")?;
            loop {
                let key = self.required("an entry of a patch")?;
                if key == "}" {
                    break;
                }
                let mut words = Vec::new();
                loop {
                    match self.required("';'")? {
                        word if word == ";" => break,
                        // A dictionary, which has no semicolon.
                        word if word == "{" && key != "inGroups" => {
                            self.skip_rest(1)?;
                            break;
                        }
                        word => words.push(word),
                    }
                }
                let number = || words.first().and_then(|word| word.parse().ok()).unwrap_or(0);
                match key.as_str() {
                    "type" => patch.kind = words.concat(),
                    "nFaces" => patch.face_count = number(),
                    "startFace" => patch.first_face = number(),
                    "inGroups" => patch.groups = words,
                    _ => {}
                }
            }
            patches.push(patch);
        }
        Ok(patches)
    }

    /// The entries of a field about patches; none of a field that has none.
    pub fn patch_entries(&mut self, component_count: usize) -> Result<Vec<PatchEntry>> {
        let values = self.field_values(component_count)?;
        if let (FieldValues::List(count), true) = (values, self.binary.is_some()) {
            let size = self.scalar.size().unwrap_or(1) * component_count;
            self.cursor.skip(count.saturating_mul(size as u64))?;
        }
        let mut entries = Vec::new();
        if self.cursor.skip_past(b"boundaryField")?.is_none() {
            return Ok(entries);
        }
        self.expect("{")?;
        loop {
            let key = self.required("the name of a patch")?;
            match key.as_str() {
                "}" => return Ok(entries),
                key if key.starts_with('#') => {
                    self.cursor.line()?;
                    continue;
                }
                _ => {}
            }
            let name = key.trim_matches('"').to_owned();
            let pattern = Some(name.as_str()).filter(|name| *name != key);
            let (pattern, is_known) = match pattern.map(Pattern::new) {
                Some(None) => (Some(Pattern::any()), false),
                pattern => (pattern.flatten(), true),
            };
            let word = self.required("{")?;
            if key.starts_with('$') {
                if word != ";" {
                    self.skip_entry()?;
                }
                // Entries from elsewhere, of any patches that have no other.
                let values = Some(PatchValues::Unread(key));
                entries.insert(0, PatchEntry { name, pattern: Some(Pattern::any()), values });
                continue;
            }
            let values = if word.starts_with('$') {
                self.skip_entry()?;
                Some(PatchValues::Unread(word))
            } else if word == "{" {
                self.values_of_patch(component_count)?
            } else {
                let error = self.cursor.error("an entry is damaged").got(format_args!("'{word}'"));
                return Err(error.expected("{"));
            };
            let values = if is_known { values } else { Some(PatchValues::Unread(key)) };
            entries.push(PatchEntry { name, pattern, values });
        }
    }

    /// Values among the entries about a patch, to their end.
    fn values_of_patch(&mut self, component_count: usize) -> Result<Option<PatchValues>> {
        let mut values = None;
        loop {
            let key = self.required("an entry of a patch")?;
            match key.as_str() {
                "}" => return Ok(values),
                ";" => {}
                key if key.starts_with('#') => drop(self.cursor.line()?),
                "value" => values = self.entry_of_patch(Some(component_count))?,
                key if key.starts_with('$') => {
                    self.skip_entry()?;
                    values = values.or(Some(PatchValues::Unread(key.to_owned())));
                }
                _ => drop(self.entry_of_patch(None)?),
            }
        }
    }

    /// The values of an entry, if it has such; other entries are passed over. `component_count`: of the values that are wanted.
    fn entry_of_patch(&mut self, component_count: Option<usize>) -> Result<Option<PatchValues>> {
        let word = self.required("the value of an entry")?;
        let values = match (word.as_str(), component_count) {
            (";", _) => return Ok(None),
            ("uniform", Some(n)) => match self.uniform_tuple(n)? {
                PatchValues::Unread(word) => return Ok(Some(PatchValues::Unread(word))),
                values => values,
            },
            ("nonuniform", None) if self.binary.is_none() => {
                self.skip_entry()?;
                return Ok(None);
            }
            ("nonuniform", _) => {
                let (kind, count, is_uniform) = self.typed_list_head()?;
                let known = LIST_TYPES.iter().find(|known| Some(known.0) == kind.as_deref());
                let number_type = if known.is_some_and(|known| known.2) { self.label } else { self.scalar };
                let n = component_count.map_or(known.map_or(1, |known| known.1), |n| n as u64);
                let count = if is_uniform { 1 } else { count };
                let numbers = self.numbers(number_type, count.saturating_mul(n))?;
                if is_uniform {
                    // The last parenthesis of a tuple in text.
                    if self.binary.is_none() && self.cursor.peek()? == Some(b')') {
                        self.cursor.bytes(1)?;
                    }
                    self.expect("}")?;
                    PatchValues::Uniform(numbers)
                } else {
                    self.end_list(count)?;
                    PatchValues::List(numbers)
                }
            }
            ("{", _) => {
                self.skip_rest(1)?;
                return Ok(None);
            }
            // A word, a macro or code; values of the cells are those that serve where none are stated.
            (word, wanted) => {
                self.skip_entry()?;
                let is_unread = wanted.is_some() && word != "$internalField";
                return Ok(is_unread.then(|| PatchValues::Unread(word.to_owned())));
            }
        };
        match self.token()?.as_deref() {
            Some(";") => Ok(Some(values)),
            // The last parenthesis of a uniform vector.
            Some(")") => self.expect(";").map(|()| Some(values)),
            found => {
                let error = self.cursor.error("an entry of a patch is damaged");
                Err(error.got(format_args!("'{}'", found.unwrap_or_default())).expected(";"))
            }
        }
    }

    /// The numbers of a tuple in text; the entry is passed over where there are others than numbers.
    fn uniform_tuple(&mut self, component_count: usize) -> Result<PatchValues> {
        let (mut tuple, mut depth) = (Vec::new(), 0);
        while tuple.len() < component_count {
            let word = self.required("a number")?;
            match (word.as_str(), word.parse()) {
                ("(", _) => depth += 1,
                (_, Ok(number)) => tuple.push(number),
                (";", _) => return Ok(PatchValues::Unread(word)),
                _ => {
                    self.skip_rest(depth)?;
                    return Ok(PatchValues::Unread(word));
                }
            }
        }
        Ok(PatchValues::Uniform(tuple))
    }
}
