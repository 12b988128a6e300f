//! Files of OpenFOAM: heads, words, lists of numbers, and the values of fields, in text and in bytes.
//!
//! Source: OpenFOAM user guide, "Mesh description" and "Basic input/output file format"; for bytes `UList` and `CompactIOList` of
//! its sources. Numbers of bytes have the order and the widths that the entry `arch` of the head says.

use crate::formats::cursor::Cursor;
use crate::formats::numbers::{self, ByteOrder, NumberType, Target};
use crate::formats::source::Source;
use crate::formats::text::{has_mark, is_space};
use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::{Error, Result};

/// Bytes of a packed file that are unpacked for its head.
const HEAD_BYTES: u64 = 1 << 16;
/// Class of files that hold those of all processors.
const COLLATED: &str = "decomposedBlockData";

/// A file behind its head.
pub(super) struct FoamFile {
    pub cursor: Cursor,
    pub source: Arc<Source>,
    pub path: PathBuf,
    pub class: String,
    pub note: String,
    /// Exponents of the unit of a field, once its values were found.
    pub dimensions: Option<Vec<f64>>,
    /// Byte order of lists of numbers; `None`: they are text.
    pub binary: Option<ByteOrder>,
    pub label: NumberType,
    pub scalar: NumberType,
    pub is_packed: bool,
}

/// Values of a field within its mesh.
pub(super) enum FieldValues {
    /// One tuple for all.
    Uniform(Vec<f64>),
    /// Number of the tuples that follow.
    List(u64),
}

/// A processor whose files stand in files of all processors, one after the other.
#[derive(Clone)]
pub(super) struct CollatedPart {
    /// Its place in each file.
    pub place: usize,
    pub known: Arc<KnownParts>,
}

/// Places of all parts of the files that were looked at.
pub(super) type KnownParts = Mutex<HashMap<PathBuf, KnownFile>>;

#[derive(Clone)]
pub(super) struct KnownFile {
    pub parts: Arc<Vec<Range<u64>>>,
    /// Contents of a packed file.
    unpacked: Option<Arc<Source>>,
}

/// The file at a path, or the packed one beside it with the ending .gz; `None` where there is neither.
pub(super) fn existing(path: &Path) -> Option<PathBuf> {
    let mut packed = path.as_os_str().to_owned();
    packed.push(".gz");
    [path.to_owned(), packed.into()].into_iter().find(|path| path.is_file())
}

/// Names in a folder, in ascending order.
pub(super) fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort();
    names
}

/// True for a file, or a packed one, that begins as those of OpenFOAM. Errors: a packed one is damaged.
pub(super) fn has_head(path: &Path) -> Result<bool> {
    let Ok(mut source) = Source::open(path) else { return Ok(false) };
    if source.is_packed()? {
        source = source.unpacked(Some(HEAD_BYTES)).map_err(|error| error.in_file(path))?;
    }
    Ok(has_mark(&source.head(4096)?, "FoamFile"))
}

impl FoamFile {
    /// Opens a file, or a part of one, and reads its head; `head_only`: of a packed one no more than the head is unpacked.
    pub fn open(path: &Path, part: Option<&CollatedPart>, head_only: bool) -> Result<FoamFile> {
        FoamFile::of_path(path, part, head_only).map_err(|error| match part {
            Some(part) => error.at_item(format!("part {} of the file", part.place)).in_file(path),
            None => error.in_file(path),
        })
    }

    /// Opens a file, or a part of one, and reads what follows its head.
    pub fn read<T>(
        path: &Path,
        part: Option<&CollatedPart>,
        read: impl FnOnce(&mut FoamFile) -> Result<T>,
    ) -> Result<T> {
        let mut file = FoamFile::open(path, part, false)?;
        read(&mut file).map_err(|error| error.in_file(path))
    }

    fn of_path(path: &Path, part: Option<&CollatedPart>, head_only: bool) -> Result<FoamFile> {
        let known = part.and_then(|part| {
            part.known.lock().unwrap_or_else(PoisonError::into_inner).get(path).cloned()?.unpacked
        });
        let is_known = known.is_some();
        let mut source = known.map_or_else(|| Source::open(path), Ok)?;
        let is_packed = is_known || source.is_packed()?;
        if is_packed && !is_known {
            source = source.unpacked((head_only && part.is_none()).then_some(HEAD_BYTES))?;
        }
        let mut file = FoamFile {
            cursor: Cursor::new(&source),
            source,
            path: path.to_owned(),
            class: String::new(),
            note: String::new(),
            dimensions: None,
            binary: None,
            label: NumberType::I32,
            scalar: NumberType::F64,
            is_packed,
        };
        file.read_head()?;
        if file.class == COLLATED {
            let part = part.ok_or_else(|| {
                let error = file.cursor.error("the file holds those of several processors").got(COLLATED);
                error.expected("a folder processorsN for such files")
            })?;
            file.go_to_part(part)?;
        }
        Ok(file)
    }

    /// Moves into a part; the head of the first is that of all.
    fn go_to_part(&mut self, part: &CollatedPart) -> Result<()> {
        let lock = || part.known.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().get(&self.path).cloned();
        let parts = match known {
            Some(known) => known.parts,
            None => {
                let parts = Arc::new(self.parts()?);
                let unpacked = self.is_packed.then(|| self.source.clone());
                lock().insert(self.path.clone(), KnownFile { parts: parts.clone(), unpacked });
                parts
            }
        };
        let (Some(first), Some(own)) = (parts.first(), parts.get(part.place)) else {
            let error = self.cursor.error("the file has too few parts for its processors").got(parts.len());
            return Err(error.expected(format_args!("{} or more", part.place + 1)));
        };
        self.cursor = Cursor::within(&self.source, first.start, first.end, 1);
        self.note.clear();
        (self.label, self.scalar) = (NumberType::I32, NumberType::F64);
        self.read_head()?;
        if part.place > 0 {
            // The head's note is about the first.
            self.note.clear();
            self.cursor = Cursor::within(&self.source, own.start, own.end, 1);
            self.cursor.binary = self.binary;
        }
        Ok(())
    }

    /// Places of the parts behind the head.
    fn parts(&mut self) -> Result<Vec<Range<u64>>> {
        let mut parts = Vec::new();
        while let Some(word) = self.token()? {
            let count: u64 = word.parse().map_err(|_| {
                let error =
                    self.cursor.error("the length of a part is damaged").got(format_args!("'{word}'"));
                error.expected("a number")
            })?;
            self.expect("(")?;
            let start = self.cursor.position();
            self.cursor.skip(count)?;
            parts.push(start..start + count);
            self.expect(")")?;
        }
        Ok(parts)
    }

    fn read_head(&mut self) -> Result<()> {
        let first = self.required("FoamFile")?;
        if first != "FoamFile" || self.required("{")? != "{" {
            let error = self.cursor.error("this is no file of OpenFOAM").got(format_args!("'{first}'"));
            return Err(error.expected("FoamFile { … }"));
        }
        let (mut format, mut arch) = (String::new(), String::new());
        loop {
            let key = self.required("an entry of the head")?;
            if key == "}" {
                break;
            }
            let mut words = Vec::new();
            loop {
                let word = self.required("';'")?;
                if word == ";" {
                    break;
                }
                words.push(word);
            }
            let text = words.join(" ").trim_matches('"').to_owned();
            match key.as_str() {
                "class" => self.class = text,
                "format" => format = text,
                "arch" => arch = text,
                "note" => self.note = text,
                _ => {}
            }
        }
        let big = arch.contains("MSB");
        self.binary = (format == "binary").then_some(if big { ByteOrder::Big } else { ByteOrder::Little });
        self.cursor.binary = self.binary;
        if arch.contains("label=64") {
            self.label = NumberType::I64;
        }
        if arch.contains("scalar=32") {
            self.scalar = NumberType::F32;
        }
        match format.as_str() {
            "ascii" | "binary" => Ok(()),
            _ => {
                let error = self.cursor.error("the format of the file is not known");
                Err(error.got(format_args!("'{format}'")).expected("ascii or binary"))
            }
        }
    }

    /// The next word, sign of punctuation or text in quotes; `None` at the end.
    pub fn token(&mut self) -> Result<Option<String>> {
        loop {
            match self.cursor.peek()? {
                None => return Ok(None),
                Some(b'"') => {
                    self.cursor.bytes(1)?;
                    let text = String::from_utf8_lossy(self.cursor.until(|byte| byte == b'"')?).into_owned();
                    self.cursor.bytes(1)?;
                    return Ok(Some(format!("\"{text}\"")));
                }
                Some(byte) if is_sign(byte) => {
                    self.cursor.bytes(1)?;
                    return Ok(Some(char::from(byte).to_string()));
                }
                Some(_) => {}
            }
            if self.cursor.starts_with(b"//")? {
                self.cursor.line()?;
            } else if self.cursor.starts_with(b"/*")? {
                self.cursor.bytes(2)?;
                self.cursor.skip_past(b"*/")?;
            } else {
                let is_end = |byte: u8| byte.is_ascii_whitespace() || is_sign(byte) || byte == b'"';
                return Ok(Some(String::from_utf8_lossy(self.cursor.until(is_end)?).into_owned()));
            }
        }
    }

    pub fn required(&mut self, what: &str) -> Result<String> {
        self.token()?.ok_or_else(|| self.cursor.error("the file ends early").expected(what))
    }

    /// Number of entries of a list, and true if one value stands for all.
    pub fn list_head(&mut self) -> Result<(u64, bool)> {
        self.typed_list_head().map(|(_, count, is_uniform)| (count, is_uniform))
    }

    /// Type of a list, if it is noted, number of entries, and true if one value stands for all.
    pub fn typed_list_head(&mut self) -> Result<(Option<String>, u64, bool)> {
        let mut word = self.required("the length of a list")?;
        let mut kind = None;
        if word.starts_with("List<") {
            let length = self.required("the length of a list")?;
            kind = Some(std::mem::replace(&mut word, length));
        }
        let count: u64 = word.parse().map_err(|_| {
            let error = self.cursor.error("the length of a list is damaged").got(format_args!("'{word}'"));
            error.expected("a number")
        })?;
        match self.cursor.peek()? {
            Some(b'(') => self.cursor.bytes(1).map(|_| (kind, count, false)),
            Some(b'{') => self.cursor.bytes(1).map(|_| (kind, count, true)),
            _ if count == 0 => Ok((kind, 0, false)),
            _ => Err(self.cursor.error("a list is damaged").expected("(")),
        }
    }

    /// Numbers of text with parentheses between them, or of bytes.
    pub fn numbers<T: Target>(&mut self, number_type: NumberType, count: u64) -> Result<Vec<T>> {
        let size = number_type.size().unwrap_or(1) as u64;
        let least = if self.binary.is_some() { size } else { 2 };
        if count > self.cursor.left() / least + 1 {
            return Err(self.cursor.error("a list ends early").expected(format_args!("{count} numbers")));
        }
        // Values alone are too few for several threads.
        if count < 16 && self.binary.is_none() {
            return (0..count).map(|_| self.number(number_type)).collect();
        }
        self.cursor.numbers_between(number_type, count, T::ACCEPTED, is_between)
    }

    /// A number of text with parentheses before it.
    pub fn number<T: Target>(&mut self, number_type: NumberType) -> Result<T> {
        while let Some(b'(' | b')') = self.cursor.peek()? {
            self.cursor.bytes(1)?;
        }
        let word = self.cursor.until(|byte| byte.is_ascii_whitespace() || is_sign(byte))?;
        numbers::parse(number_type, word).map_err(|error| error.at_line(self.cursor.line_number()))
    }

    pub fn labels<T: Target>(&mut self) -> Result<Vec<T>> {
        let (count, is_uniform) = self.list_head()?;
        if is_uniform {
            return Err(self.cursor.error("a list of labels holds one value for all").expected("each label"));
        }
        let labels = self.numbers(self.label, count)?;
        self.end_list(count)?;
        Ok(labels)
    }

    pub fn end_list(&mut self, count: u64) -> Result<()> {
        match self.cursor.peek()? {
            Some(b')') => self.cursor.bytes(1).map(|_| ()),
            _ if count == 0 => Ok(()),
            _ => Err(self.cursor.error("a list is longer than its length says").expected(")")),
        }
    }

    /// Coordinates of points.
    pub fn points(&mut self) -> Result<Vec<f64>> {
        let count = self.list_head()?.0.saturating_mul(3);
        self.numbers(self.scalar, count)
    }

    pub fn zones(&mut self) -> Result<Vec<(String, Vec<u32>)>> {
        let (count, _) = self.list_head()?;
        let mut zones = Vec::new();
        for _ in 0..count {
            let name = self.required("the name of a zone")?;
            let brace = self.required("{")?;
            if brace != "{" {
                let error = self.cursor.error("the zones are damaged").got(format_args!("'{brace}'"));
                return Err(error.expected("{"));
            }
            let mut cells = Vec::new();
            loop {
                match self.required("an entry of a zone")?.as_str() {
                    "}" => break,
                    "cellLabels" => cells = self.labels()?,
                    _ => {}
                }
            }
            zones.push((name, cells));
        }
        Ok(zones)
    }

    /// Moves to the values of a field within the mesh; `component_count` numbers make a tuple.
    pub fn field_values(&mut self, component_count: usize) -> Result<FieldValues> {
        loop {
            let key = self.token()?.ok_or_else(|| {
                let error = self.cursor.error("the field has no values within the mesh");
                error.expected("an entry internalField; entries of included files are not read")
            })?;
            match key.as_str() {
                "internalField" | "value" => break,
                ";" => {}
                "dimensions" => self.dimensions = self.exponents()?,
                key if key.starts_with('#') => drop(self.cursor.line()?),
                _ => self.skip_entry()?,
            }
        }
        let word = self.required("uniform or nonuniform")?;
        match word.as_str() {
            "uniform" => {
                let binary = self.binary.take();
                let values = self.numbers(self.scalar, component_count as u64)?;
                self.binary = binary;
                Ok(FieldValues::Uniform(values))
            }
            "nonuniform" => match self.list_head()? {
                (count, false) => Ok(FieldValues::List(count)),
                (_, true) => self.numbers(self.scalar, component_count as u64).map(FieldValues::Uniform),
            },
            _ => {
                let error =
                    self.cursor.error("the values of the field are not read").got(format_args!("'{word}'"));
                Err(error.expected("uniform or nonuniform; macros and code are not evaluated"))
            }
        }
    }

    pub fn expect(&mut self, sign: &str) -> Result<()> {
        let found = self.required(sign)?;
        if found == sign {
            return Ok(());
        }
        Err(self.cursor.error("an entry is damaged").got(format_args!("'{found}'")).expected(sign))
    }

    /// The exponents of a unit, to the end of the entry; `None` where it names units.
    fn exponents(&mut self) -> Result<Option<Vec<f64>>> {
        let mut exponents = Some(Vec::new());
        loop {
            match self.required("';'")?.as_str() {
                ";" => return Ok(exponents),
                "[" | "]" => {}
                word => match (word.parse(), &mut exponents) {
                    (Ok(exponent), Some(own)) => own.push(exponent),
                    _ => exponents = None,
                },
            }
        }
    }

    /// Skips the rest of an entry: to its semicolon, or its dictionary.
    pub fn skip_entry(&mut self) -> Result<()> {
        self.skip_rest(0)
    }

    /// Skips the rest of an entry in which `depth` brackets are open.
    pub fn skip_rest(&mut self, mut depth: u32) -> Result<()> {
        loop {
            match self.required("';'")?.as_str() {
                "{" | "(" | "[" => depth += 1,
                "}" => {
                    depth = depth.saturating_sub(1);
                    if depth == 0 {
                        return Ok(());
                    }
                }
                ")" | "]" => depth = depth.saturating_sub(1),
                ";" if depth == 0 => return Ok(()),
                _ => {}
            }
        }
    }
}

/// True for what stands between the numbers of a list.
pub(super) fn is_between(byte: u8) -> bool {
    is_space(byte) | (byte == b'(') | (byte == b')')
}

fn is_sign(byte: u8) -> bool {
    b"(){}[];".contains(&byte)
}

/// The error about lists whose lengths do not fit.
pub(super) fn misfit(what: &str, found: usize, accepted: impl std::fmt::Display, path: &Path) -> Error {
    Error::run(format!("the mesh has the wrong number of {what}")).got(found).expected(accepted).in_file(path)
}
