//! Legacy VTK files (.vtk), versions 1.0 to 5.1, ASCII and binary (big-endian).
//!
//! Source: "VTK File Formats" (docs.vtk.org), section "Simple Legacy Formats", and for 5.x and what the text leaves open
//! vtkDataReader.cxx and its kin. Read word by word, as VTK does, so line ends carry meaning only before
//! the bytes of an array.

use super::contents::{
    CellBlocks, Dataset, Encoding, Geometry, Piece, PieceArray, Stored, StoredCells, StoredFaces, TIME,
    extent_dimensions, structured_counts, tuples,
};
use super::numbers::{ByteOrder, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use super::text::{is_space, line_ends, word_starts};
use super::xml::is_before;
use glam::{DMat3, DVec3};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

/// Bytes of the file that are kept at a time.
const WINDOW: u64 = 1 << 18;
/// No word or line outside arrays is longer in a sound file.
const LONGEST: usize = 1 << 14;
/// Bytes whose words are counted at once.
const BLOCK: usize = 254;

/// First words of every legacy file.
const MAGIC: &str = "# vtk DataFile Version";

/// The kinds of data sets with a volume.
const KINDS: [&str; 4] = ["UNSTRUCTURED_GRID", "STRUCTURED_GRID", "RECTILINEAR_GRID", "STRUCTURED_POINTS"];

/// The declaration.
pub(super) const FORMAT: Format = Format {
    files: "a legacy VTK file (.vtk)",
    matches: |head, _, _| head.starts_with(MAGIC.as_bytes()),
    open,
    has_solution: false,
};

/// Reads the table of contents.
fn open(source: Arc<Source>, _: &Request) -> Result<Dataset> {
    let mut scanner = Scanner::new(source);
    let first = scanner.rest_of_line()?.unwrap_or_default();
    let version = first.get(MAGIC.len()..).unwrap_or("").trim().to_owned();
    scanner.rest_of_line()?;
    let mode = scanner.required("ASCII or BINARY")?;
    scanner.binary = match mode.to_ascii_uppercase().as_str() {
        "ASCII" => false,
        "BINARY" => true,
        _ => {
            let found = format!("'{mode}'");
            return Err(scanner.error("the third line is wrong").got(found).expected("ASCII or BINARY"));
        }
    };
    let mut word = scanner.required("DATASET")?;
    let mut fields = Vec::new();
    // Fields of the whole file may stand first.
    while word.eq_ignore_ascii_case("FIELD") {
        fields.extend(field(&mut scanner)?);
        word = scanner.required("DATASET")?;
    }
    if !word.eq_ignore_ascii_case("DATASET") {
        return Err(scanner
            .error("the file does not say what it holds")
            .got(format_args!("'{word}'"))
            .expected("DATASET"));
    }
    let kind = scanner.required("a kind of data set")?.to_ascii_uppercase();
    if !KINDS.contains(&kind.as_str()) {
        let error = scanner.error("this kind of VTK file holds no volume grid");
        return Err(error.got(format_args!("'{kind}'")).expected(KINDS.join(", ")));
    }
    let mut contents = Contents::default();
    let mut arrays = Vec::new();
    let mut dataset = Dataset { file_bytes: scanner.source.len(), ..Dataset::default() };
    // Location and number of the tuples of attributes, which are the rest of the file.
    let mut section = None;
    while let Some(word) = scanner.word()? {
        let keyword = word.to_ascii_uppercase();
        let found = match (keyword.as_str(), section) {
            ("METADATA", _) => {
                scanner.skip_metadata()?;
                Vec::new()
            }
            ("FIELD", _) => field(&mut scanner)?,
            ("POINT_DATA" | "CELL_DATA", _) => {
                let (point_count, cell_count) = contents.counts(&kind, &scanner)?;
                let (association, accepted) = match keyword.as_str() {
                    "POINT_DATA" => (Association::Point, point_count),
                    _ => (Association::Cell, cell_count),
                };
                let count = scanner.number("the number of tuples")?;
                if count != accepted {
                    let what = format!("the number of {keyword} does not fit the grid");
                    return Err(scanner.error(what).got(count).expected(accepted));
                }
                section = Some((association, count));
                Vec::new()
            }
            (_, None) => {
                contents.read(&keyword, &mut scanner)?;
                Vec::new()
            }
            (_, Some((_, count))) => {
                let found = attribute(&mut scanner, &keyword, count)?;
                if keyword == "SCALARS" && dataset.active_scalars.is_none() {
                    dataset.active_scalars = found.as_ref().map(|array| array.name.clone());
                }
                found.into_iter().collect()
            }
        };
        match section {
            Some((association, _)) => {
                arrays.extend(found.into_iter().map(|stored| PieceArray::new(association, stored)));
            }
            None => fields.extend(found),
        }
    }
    let of_time = |name: &&str| fields.iter().find(|field| field.name == **name)?.first();
    dataset.time = TIME.iter().find_map(of_time);
    let (point_count, cell_count) = contents.counts(&kind, &scanner)?;
    if let Some(blanking) = contents.blanking.take() {
        let stored = blanking.hidden_where_zero();
        arrays.push(PieceArray::new(Association::Point, stored));
    }
    let geometry = contents.geometry(&kind)?;
    // "Version 4.2".
    let is_old_order = version.split(' ').next_back().is_some_and(|version| is_before(version, [5, 0]));
    let blocks = CellBlocks::default();
    dataset.pieces.push(Piece { point_count, cell_count, geometry, arrays, blocks, is_old_order });
    let mode = if scanner.binary { "binary" } else { "ASCII" };
    dataset.format = format!("legacy VTK {version} {kind}, {mode}");
    Ok(dataset)
}

/// Parts of a data set's geometry, in whatever order the file has them.
#[derive(Default)]
struct Contents {
    points: Option<Stored>,
    cells: Option<CellList>,
    types: Option<Stored>,
    dimensions: Option<[u64; 3]>,
    axes: [Option<Stored>; 3],
    blanking: Option<Stored>,
    origin: DVec3,
    spacing: Option<DVec3>,
    direction: Option<DMat3>,
    first: DVec3,
}

/// The cells of an unstructured grid: in the old form a list of counts and points, else the connectivity with offsets.
struct CellList {
    count: u64,
    list: Stored,
    offsets: Option<Stored>,
}

impl Contents {
    /// Reads what follows a keyword.
    fn read(&mut self, keyword: &str, scanner: &mut Scanner) -> Result<()> {
        match keyword {
            "POINTS" => {
                self.points = Some(scanner.counted(keyword, "the number of points", 3)?);
            }
            "CELLS" => self.cells = Some(cells(scanner)?),
            "CELL_TYPES" => {
                let count = scanner.number("the number of cells")?;
                self.types = Some(scanner.numeric("CELL_TYPES", Some(NumberType::I32), 1, count)?);
            }
            "DIMENSIONS" => self.dimensions = Some(scanner.numbers("three numbers of points")?),
            "EXTENT" => {
                let extent: [i64; 6] = scanner.numbers("six indices")?;
                self.dimensions = Some(extent_dimensions(extent));
                self.first = DVec3::new(extent[0] as f64, extent[2] as f64, extent[4] as f64);
            }
            "ORIGIN" => self.origin = DVec3::from_array(scanner.numbers("three coordinates")?),
            "SPACING" | "ASPECT_RATIO" => {
                self.spacing = Some(DVec3::from_array(scanner.numbers("three distances")?));
            }
            "DIRECTION" => {
                let rows: [f64; 9] = scanner.numbers("nine numbers")?;
                self.direction = Some(DMat3::from_cols_array(&rows).transpose());
            }
            "X_COORDINATES" | "Y_COORDINATES" | "Z_COORDINATES" => {
                let axis = usize::from(keyword.as_bytes()[0] - b'X');
                self.axes[axis] = Some(scanner.counted(keyword, "the number of coordinates", 1)?);
            }
            "BLANKING" => {
                self.blanking = Some(scanner.counted(keyword, "the number of points", 1)?);
            }
            _ => {
                let found = format!("'{keyword}'");
                return Err(scanner.error("an unknown keyword").got(found).expected(
                    "POINTS, CELLS, CELL_TYPES, DIMENSIONS, ORIGIN, SPACING, X_COORDINATES, FIELD, METADATA, \
                     POINT_DATA or CELL_DATA",
                ));
            }
        }
        Ok(())
    }

    /// Numbers of points and cells.
    fn counts(&self, kind: &str, scanner: &Scanner) -> Result<(u64, u64)> {
        let point_count = self.points.as_ref().and_then(|points| points.tuple_count).unwrap_or(0);
        if kind == "UNSTRUCTURED_GRID" {
            return Ok((point_count, self.cells.as_ref().map_or(0, |cells| cells.count)));
        }
        let dimensions = self.dimensions.unwrap_or([0; 3]);
        let counts = structured_counts(dimensions).map_err(|error| scanner.locate(error))?;
        let wrong = |what: &str, found: u64, accepted: u64| {
            Err(Error::run(format!("the number of {what} does not fit DIMENSIONS"))
                .got(found)
                .expected(accepted))
        };
        if self.points.is_some() && point_count != counts.0 {
            return wrong("points", point_count, counts.0);
        }
        for (axis, count) in self.axes.iter().zip(dimensions) {
            if let Some(found) =
                axis.as_ref().and_then(|axis| axis.tuple_count).filter(|&found| found != count)
            {
                return wrong("coordinates", found, count);
            }
        }
        Ok(counts)
    }

    /// Geometry of the data set, or an error that names the missing part.
    fn geometry(self, kind: &str) -> Result<Geometry> {
        let lacks = |what: &str| Error::run(format!("the {kind} lacks {what}"));
        let dimensions = self.dimensions.ok_or_else(|| lacks("DIMENSIONS"));
        match kind {
            "UNSTRUCTURED_GRID" => {
                let points = self.points.ok_or_else(|| lacks("POINTS"))?;
                let types = self.types.ok_or_else(|| lacks("CELL_TYPES"))?;
                let CellList { count, list, offsets } = self.cells.ok_or_else(|| lacks("CELLS"))?;
                if let Some(found) = types.tuple_count.filter(|&found| found != count) {
                    return Err(Error::run("the number of CELL_TYPES is wrong").got(found).expected(count));
                }
                let cells = match offsets {
                    None => StoredCells::Counted { list, types },
                    Some(offsets) => {
                        let faces = StoredFaces::InConnectivity;
                        StoredCells::Offsets { connectivity: list, offsets, types, faces }
                    }
                };
                Ok(Geometry::Unstructured { points, cells: Box::new(cells) })
            }
            "STRUCTURED_GRID" => Ok(Geometry::Curvilinear {
                dimensions: dimensions?,
                points: self.points.ok_or_else(|| lacks("POINTS"))?,
            }),
            "RECTILINEAR_GRID" => {
                let [Some(x), Some(y), Some(z)] = self.axes else {
                    return Err(lacks("X_COORDINATES, Y_COORDINATES or Z_COORDINATES"));
                };
                Ok(Geometry::Rectilinear { dimensions: dimensions?, axes: Box::new([x, y, z]) })
            }
            _ => Ok(Geometry::Uniform {
                dimensions: dimensions?,
                first: self.first,
                origin: self.origin,
                spacing: self.spacing.unwrap_or(DVec3::ONE),
                direction: self.direction.unwrap_or(DMat3::IDENTITY),
            }),
        }
    }
}

/// CELLS in the old form (counts among the point numbers) or, since 5.0, as offsets and connectivity.
fn cells(scanner: &mut Scanner) -> Result<CellList> {
    let count: u64 = scanner.number("the number of cells")?;
    let size = scanner.number("the length of the list")?;
    if scanner.word_if("OFFSETS")? {
        let number_type = scanner.number_type()?;
        let offsets = scanner.numeric("OFFSETS", number_type, 1, count)?;
        let word = scanner.required("CONNECTIVITY")?;
        if !word.eq_ignore_ascii_case("CONNECTIVITY") {
            return Err(scanner
                .error("the connectivity is missing")
                .got(format_args!("'{word}'"))
                .expected("CONNECTIVITY"));
        }
        let number_type = scanner.number_type()?;
        let list = scanner.numeric("CONNECTIVITY", number_type, 1, size)?;
        return Ok(CellList { count: count.saturating_sub(1), list, offsets: Some(offsets) });
    }
    let list = scanner.numeric("CELLS", Some(NumberType::I32), 1, size)?;
    Ok(CellList { count, list, offsets: None })
}

/// Attributes by their keywords, with the components of a tuple; 0: a number after the name states them.
const ATTRIBUTES: [(&str, usize); 10] = [
    ("COLOR_SCALARS", 0),
    ("TEXTURE_COORDINATES", 0),
    ("VECTORS", 3),
    ("NORMALS", 3),
    ("TANGENTS", 3),
    ("TENSORS", 9),
    ("TENSORS6", 6),
    ("GLOBAL_IDS", 1),
    ("PEDIGREE_IDS", 1),
    ("EDGE_FLAGS", 1),
];

/// Reads the attribute of a keyword with `count` tuples; `None` for text and for colours.
fn attribute(scanner: &mut Scanner, keyword: &str, count: u64) -> Result<Option<Stored>> {
    if keyword == "LOOKUP_TABLE" {
        let name = name(scanner)?;
        let size = scanner.number("the number of colours")?;
        return scanner.array(&name, Some(scanner.color_type()), 4, size).map(|_| None);
    }
    if keyword == "SCALARS" {
        let name = name(scanner)?;
        let number_type = scanner.number_type()?;
        let rest = scanner.rest_of_line()?.unwrap_or_default();
        let component_count = match rest.as_str() {
            "" => 1,
            rest => rest.parse().ok().filter(|n| (1..=1 << 16).contains(n)).ok_or_else(|| {
                scanner
                    .error(format!("the number of components of '{name}' is wrong"))
                    .got(format_args!("'{rest}'"))
                    .expected("1 to 65536")
            })?,
        };
        if !scanner.word_if("LOOKUP_TABLE")? {
            let what = format!("the scalars '{name}' do not name their look-up table");
            return Err(scanner.error(what).expected("LOOKUP_TABLE default"));
        }
        scanner.required("the name of a look-up table")?;
        return scanner.array(&name, number_type, component_count, count);
    }
    let Some(&(_, component_count)) = ATTRIBUTES.iter().find(|attribute| attribute.0 == keyword) else {
        let found = format!("'{}'", keyword.escape_default());
        return Err(scanner.error("an unknown keyword").got(found).expected(
            "SCALARS, VECTORS, NORMALS, TENSORS, TEXTURE_COORDINATES, COLOR_SCALARS, LOOKUP_TABLE, FIELD, \
             GLOBAL_IDS, METADATA, POINT_DATA or CELL_DATA",
        ));
    };
    let name = name(scanner)?;
    let component_count = match component_count {
        0 => scanner.number("the number of components")?,
        count => count,
    };
    let number_type = match keyword {
        "COLOR_SCALARS" => Some(scanner.color_type()),
        _ => scanner.number_type()?,
    };
    scanner.array(&name, number_type, component_count, count)
}

/// The arrays of a FIELD, without those of text.
fn field(scanner: &mut Scanner) -> Result<Vec<Stored>> {
    scanner.required("the name of the field")?;
    let array_count: u64 = scanner.number("the number of arrays")?;
    let mut arrays = Vec::new();
    let mut seen = 0;
    while seen < array_count {
        let name = name(scanner)?;
        match name.as_str() {
            "METADATA" => {
                scanner.skip_metadata()?;
                continue;
            }
            "NULL_ARRAY" => {}
            _ => {
                let component_count: usize = scanner.number("the number of components")?;
                let tuple_count = scanner.number("the number of tuples")?;
                let number_type = scanner.number_type()?;
                arrays.extend(scanner.array(&name, number_type, component_count.max(1), tuple_count)?);
            }
        }
        seen += 1;
    }
    Ok(arrays)
}

/// A name, whose special characters are written as `%20`.
fn name(scanner: &mut Scanner) -> Result<String> {
    let word = scanner.required("a name")?;
    let mut bytes = Vec::with_capacity(word.len());
    let mut rest = word.as_bytes();
    while let [first, after @ ..] = rest {
        let code =
            after.get(..2).filter(|_| *first == b'%').and_then(|digits| std::str::from_utf8(digits).ok());
        match code.and_then(|digits| u8::from_str_radix(digits, 16).ok()) {
            Some(byte) => {
                bytes.push(byte);
                rest = &after[2..];
            }
            None => {
                bytes.push(*first);
                rest = after;
            }
        }
    }
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// A position in a legacy file.
struct Scanner {
    source: Arc<Source>,
    /// True if arrays are bytes; else words.
    binary: bool,
    window: Vec<u8>,
    window_at: u64,
    at: u64,
    line: usize,
    /// Components of the last array.
    component_count: usize,
}

impl Scanner {
    /// At the beginning of the file.
    fn new(source: Arc<Source>) -> Self {
        Scanner {
            source,
            binary: false,
            window: Vec::new(),
            window_at: 0,
            at: 0,
            line: 1,
            component_count: 0,
        }
    }

    /// An error at this place.
    fn error(&self, what: impl Into<String>) -> Error {
        self.locate(Error::run(what))
    }

    fn locate(&self, error: Error) -> Error {
        // Lines mean nothing once bytes that look like line ends have been passed.
        if self.binary { error.at_item(format!("byte {}", self.at)) } else { error.at_line(self.line) }
    }

    fn peek(&mut self) -> Result<Option<u8>> {
        let index = self.at.wrapping_sub(self.window_at);
        if let Some(&byte) = self.window.get(index as usize)
            && self.at >= self.window_at
        {
            return Ok(Some(byte));
        }
        if self.at >= self.source.len() {
            return Ok(None);
        }
        self.window = self.source.read(self.at, (self.source.len() - self.at).min(WINDOW))?;
        self.window_at = self.at;
        Ok(self.window.first().copied())
    }

    fn step(&mut self, byte: u8) {
        self.at += 1;
        self.line += usize::from(byte == b'\n');
    }

    /// The next word; `None` at the end of the file.
    fn word(&mut self) -> Result<Option<String>> {
        let mut word = Vec::new();
        while let Some(byte) = self.peek()? {
            if byte.is_ascii_whitespace() {
                if !word.is_empty() {
                    break;
                }
                self.step(byte);
                continue;
            }
            word.push(byte);
            self.step(byte);
            if word.len() > LONGEST {
                return Err(self.error("a word is too long"));
            }
        }
        Ok((!word.is_empty()).then(|| String::from_utf8_lossy(&word).into_owned()))
    }

    /// The next word, which must be there.
    fn required(&mut self, what: &str) -> Result<String> {
        self.word()?.ok_or_else(|| self.error("the file ends early").expected(what))
    }

    /// The next word as a number.
    fn number<T: std::str::FromStr>(&mut self, what: &str) -> Result<T> {
        let word = self.required(what)?;
        word.parse()
            .map_err(|_| self.error("a number is damaged").got(format_args!("'{word}'")).expected(what))
    }

    /// The next words as numbers.
    fn numbers<T: std::str::FromStr + Copy + Default, const N: usize>(
        &mut self,
        what: &str,
    ) -> Result<[T; N]> {
        let mut numbers = [T::default(); N];
        for number in &mut numbers {
            *number = self.number(what)?;
        }
        Ok(numbers)
    }

    /// The rest of the line, without its end.
    fn rest_of_line(&mut self) -> Result<Option<String>> {
        let mut line = Vec::new();
        let mut any = false;
        while let Some(byte) = self.peek()? {
            any = true;
            self.step(byte);
            if byte == b'\n' {
                break;
            }
            line.push(byte);
            if line.len() > LONGEST {
                return Err(self.error("a line is too long"));
            }
        }
        Ok(any.then(|| String::from_utf8_lossy(&line).trim().to_owned()))
    }

    /// The next word in lower case if it is one of `accepted`; else the position stays.
    fn word_if(&mut self, accepted: &str) -> Result<bool> {
        let (at, line) = (self.at, self.line);
        // What follows may be the bytes of an array: no error if it is no word.
        if self.word().is_ok_and(|word| word.is_some_and(|word| word.eq_ignore_ascii_case(accepted))) {
            return Ok(true);
        }
        (self.at, self.line) = (at, line);
        Ok(false)
    }

    /// Skips a METADATA block of the last array, which ends with an empty line; the line of a component without a name is empty, too.
    fn skip_metadata(&mut self) -> Result<()> {
        self.rest_of_line()?;
        while let Some(line) = self.rest_of_line()?.filter(|line| !line.is_empty()) {
            if line == "COMPONENT_NAMES" {
                for _ in 0..self.component_count {
                    self.rest_of_line()?;
                }
            }
        }
        Ok(())
    }

    /// The type of an array by its legacy name; `None`: text.
    fn number_type(&mut self) -> Result<Option<NumberType>> {
        let word = self.required("a type of numbers")?;
        if ["string", "utf8_string", "unicode_string", "variant"]
            .contains(&word.to_ascii_lowercase().as_str())
        {
            return Ok(None);
        }
        NumberType::from_legacy(&word).map(Some).ok_or_else(|| {
            self.error("the type of an array is not known").got(format_args!("'{word}'")).expected(
                "bit, char, unsigned_char, short, unsigned_short, int, unsigned_int, long, unsigned_long, \
                 vtkIdType, vtktypeint64, float, double",
            )
        })
    }

    /// The type of colours.
    fn color_type(&self) -> NumberType {
        if self.binary { NumberType::U8 } else { NumberType::F32 }
    }

    /// An array whose values begin after this line (binary) or here (words), and steps over it.
    fn array(
        &mut self,
        name: &str,
        number_type: Option<NumberType>,
        component_count: usize,
        tuple_count: u64,
    ) -> Result<Option<Stored>> {
        self.component_count = component_count;
        if self.binary {
            self.rest_of_line()?;
        }
        let count = tuple_count.checked_mul(component_count as u64).ok_or_else(|| {
            self.error(format!("the array '{name}' cannot be that large"))
                .got(tuples(tuple_count, component_count))
        })?;
        let Some(number_type) = number_type else {
            self.skip_text(count)?;
            return Ok(None);
        };
        let begin = self.at;
        let encoding = if self.binary {
            let len = number_type.byte_count(count).unwrap_or(u64::MAX);
            self.source.check(begin, len).map_err(|error| error.at_item(name))?;
            self.at += len;
            Encoding::Bytes(begin)
        } else {
            self.skip_words(count, name)?;
            Encoding::Text(std::iter::once(begin..self.at).collect())
        };
        Ok(Some(Stored {
            source: self.source.clone(),
            name: name.to_owned(),
            number_type,
            order: ByteOrder::Big,
            component_count,
            tuple_count: Some(tuple_count),
            encoding,
        }))
    }

    /// Reads an array that cannot be text.
    fn numeric(
        &mut self,
        name: &str,
        number_type: Option<NumberType>,
        component_count: usize,
        tuple_count: u64,
    ) -> Result<Stored> {
        self.array(name, number_type, component_count, tuple_count)?
            .ok_or_else(|| self.error(format!("the array '{name}' holds text")).expected("numbers"))
    }

    /// Reads the number of tuples, their type, and an array that cannot be text.
    fn counted(&mut self, name: &str, what: &str, component_count: usize) -> Result<Stored> {
        let count = self.number(what)?;
        let number_type = self.number_type()?;
        self.numeric(name, number_type, component_count, count)
    }

    fn skip_words(&mut self, count: u64, name: &str) -> Result<()> {
        let (mut seen, mut inside) = (0, false);
        while seen < count || inside {
            let Some(_) = self.peek()? else {
                if inside && seen == count {
                    break;
                }
                return Err(self
                    .error(format!("the array '{name}' ends early"))
                    .got(counted(seen, "value"))
                    .expected(count));
            };
            // One byte is there; go through all that the window holds, in blocks while they hold too few words.
            let mut index = (self.at - self.window_at) as usize;
            while let Some(block) = self.window.get(index..index + BLOCK) {
                let starts = u64::from(word_starts(block, !inside, is_space));
                if seen + starts >= count {
                    break;
                }
                seen += starts;
                inside = block.last().is_some_and(|&last| !is_space(last));
                self.line += line_ends(block);
                index += BLOCK;
            }
            for &byte in &self.window[index..] {
                let space = is_space(byte);
                if space && seen == count {
                    inside = false;
                    break;
                }
                seen += u64::from(!space && !inside);
                inside = !space;
                self.line += usize::from(byte == b'\n');
                index += 1;
            }
            self.at = self.window_at + index as u64;
        }
        Ok(())
    }

    /// Skips text values: lines, or bytes with their number before them.
    fn skip_text(&mut self, count: u64) -> Result<()> {
        if !self.binary {
            self.rest_of_line()?;
        }
        for _ in 0..count {
            if self.peek()?.is_none() {
                return Err(self.error("the file ends early").expected(format_args!("{count} texts")));
            }
            if !self.binary {
                self.rest_of_line()?;
                continue;
            }
            // The two highest bits say how many bytes the length takes (vtkDataWriter::WriteArray).
            let lead = self.peek()?.unwrap_or(0);
            let width = [8, 4, 2, 1][usize::from(lead >> 6)];
            let bytes = self.source.read(self.at, width)?;
            let len = bytes[1..].iter().fold(u64::from(lead & 0x3F), |len, &byte| len << 8 | u64::from(byte));
            self.at += width;
            self.source.check(self.at, len)?;
            self.at += len;
        }
        Ok(())
    }
}
