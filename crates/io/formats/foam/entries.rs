//! Entries about patches: in the file about those of a mesh, and in fields.

use super::file::{FieldValues, FoamFile};
use voltet_core::Result;

/// A patch of a mesh.
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
        let named = |name: &String| entries.iter().find(|entry| !entry.is_pattern && entry.name == *name);
        let fits =
            |entry: &&PatchEntry| entry.is_pattern && fits(entry.name.as_bytes(), self.name.as_bytes());
        let entry = named(&self.name).or_else(|| self.groups.iter().find_map(named));
        entry.or_else(|| entries.iter().rfind(fits))?.values.as_ref()
    }
}

/// True if a text is one of a pattern's, in which `.*` stands for any letters and `(a|b)` for one of several patterns.
fn fits(pattern: &[u8], text: &[u8]) -> bool {
    if let Some(rest) = pattern.strip_prefix(b".*") {
        return (0..=text.len()).any(|start| fits(rest, &text[start..]));
    }
    match (pattern.split_first(), text.split_first()) {
        (None, None) => true,
        (Some((b'(', rest)), _) => {
            let Some(end) = rest.iter().position(|&byte| byte == b')') else { return false };
            let mut parts = rest[..end].split(|&byte| byte == b'|');
            parts.any(|part| fits(&[part, &rest[end + 1..]].concat(), text))
        }
        (Some((letter, rest)), Some((own, after))) => letter == own && fits(rest, after),
        _ => false,
    }
}

/// The entry of a field about a patch, a group of patches, or those whose names fit a pattern.
pub(super) struct PatchEntry {
    pub name: String,
    pub is_pattern: bool,
    /// `None`: no values of its own.
    pub values: Option<PatchValues>,
}

/// Values of a field on a patch.
pub(super) enum PatchValues {
    /// One tuple for all faces.
    Uniform(Vec<f64>),
    /// A tuple for each face.
    List(Vec<f64>),
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
    /// The patches of a mesh.
    pub fn patches(&mut self) -> Result<Vec<MeshPatch>> {
        let patches = self.list_of_patches();
        self.in_file(patches)
    }

    fn list_of_patches(&mut self) -> Result<Vec<MeshPatch>> {
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
        let entries = self.entries_behind(values, component_count);
        self.in_file(entries)
    }

    fn entries_behind(&mut self, values: FieldValues, component_count: usize) -> Result<Vec<PatchEntry>> {
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
                _ => self.expect("{")?,
            }
            let values = self.values_of_patch(component_count)?;
            let name = key.trim_matches('"').to_owned();
            entries.push(PatchEntry { is_pattern: name != key, name, values });
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
                _ => drop(self.entry_of_patch(None)?),
            }
        }
    }

    /// The values of an entry, if it has such; other entries are passed over. `component_count`: of the values that are wanted.
    fn entry_of_patch(&mut self, component_count: Option<usize>) -> Result<Option<PatchValues>> {
        let word = self.required("the value of an entry")?;
        let values = match (word.as_str(), component_count) {
            (";", _) => return Ok(None),
            ("uniform", Some(n)) => {
                let binary = self.binary.take();
                let values = self.numbers(self.scalar, n as u64);
                self.binary = binary;
                PatchValues::Uniform(values?)
            }
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
            // A word, a macro such as $internalField, or code.
            _ => {
                self.skip_entry()?;
                return Ok(None);
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
}

#[cfg(test)]
mod tests {
    use super::fits;

    #[test]
    fn patterns_name_patches() {
        for (pattern, names) in [
            (".*", "a wall1 "),
            ("(wall|inlet).*", "wall1 inlet"),
            ("wall(1|2)", "wall1 wall2"),
            ("w.*l.*", "wall1 wl"),
        ] {
            assert!(
                names.split_whitespace().all(|name| fits(pattern.as_bytes(), name.as_bytes())),
                "{pattern}"
            );
        }
        for (pattern, name) in
            [("wall", "wall1"), ("(a|b)", "ab"), ("wall(1|2)", "wall"), ("(a", "a"), ("w.*2", "wall")]
        {
            assert!(!fits(pattern.as_bytes(), name.as_bytes()), "{pattern} {name}");
        }
    }
}
