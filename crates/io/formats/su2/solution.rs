//! Solutions of SU2: the variables of a mesh's points, a row a point, as text (`restart_flow.csv`; `.dat` of versions before 7) or as bytes
//! (`restart_flow.dat`).
//!
//! Source: SU2 documentation, "Solution files"; the bytes as SU2 7 writes them: five 32-bit numbers, of which the first is 535532, the
//! second the count of variables and the third that of points; their names in 33 characters each; rows of 64-bit numbers.

use super::super::cursor::Cursor;
use super::super::numbers::{self, NumberType};
use super::super::source::{Source, quoted};
use super::super::tagged::{ArrayColumns, VisitValues};
use super::super::text::{TextRange, is_space};
use super::super::vectors::{Joined, joined};
use std::path::Path;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::reading::FileArray;
use voltet_core::{Error, Result};

const MAGIC: [u8; 4] = 535_532_u32.to_le_bytes();
/// Bytes of the counts before the names.
const HEAD: u64 = 20;
/// Bytes of a name.
const NAME: u64 = 33;
/// Number of columns that SU2 counts in 16 bits.
const MAX_COLUMNS: u64 = 0xffff;
/// Rows that are read at once.
const ROWS: u64 = 1 << 12;
/// Columns that are no quantities: numbers of points, and where these are.
const PLACES: [&str; 4] = ["PointID", "x", "y", "z"];

/// A table of the variables of all points.
pub(super) struct Solution {
    source: Arc<Source>,
    columns: Vec<String>,
    rows: Rows,
    point_count: u64,
}

enum Rows {
    Text(TextRange),
    /// From this place on.
    Bytes(u64),
}

impl Solution {
    /// The table in a file for a mesh of so many points, and its arrays.
    pub fn open(path: &Path, point_count: u64) -> Result<(Solution, Vec<ArrayColumns>)> {
        let source = Source::open(path)?;
        let (columns, rows) = match source.head(MAGIC.len() as u64)? == MAGIC {
            true => binary_head(&source, point_count)?,
            false => text_head(&source)?,
        };
        let quantities: Vec<usize> =
            (0..columns.len()).filter(|&place| !PLACES.contains(&columns[place].as_str())).collect();
        let names: Vec<String> = quantities.iter().map(|&place| columns[place].clone()).collect();
        let array = |Joined { name, places, .. }| {
            let columns: Vec<usize> = places.iter().map(|&place| quantities[place]).collect();
            (FileArray { name, association: Association::Point, component_count: columns.len() }, columns)
        };
        let arrays = joined(&names).into_iter().map(array).collect();
        Ok((Solution { source, columns, rows, point_count }, arrays))
    }

    pub fn bytes(&self) -> u64 {
        self.source.len()
    }

    pub fn path(&self) -> &Path {
        self.source.path()
    }

    /// Hands out the values in these columns, each row with the number of its point.
    ///
    /// # Errors
    /// Rows that are damaged, of points that do not exist or were there, or not as many as points.
    pub fn each_row(&self, columns: &[usize], visit: VisitValues) -> Result<()> {
        let mut is_there = vec![false; self.point_count as usize];
        let mut count = 0_u64;
        let mut take = |point: Option<f64>, tuple: &[f64]| {
            // Without numbers rows are in the points' order.
            let point = point.unwrap_or(count as f64);
            let place = point as usize;
            match is_there.get_mut(place).filter(|is_there| place as f64 == point && !**is_there) {
                Some(is_there) => *is_there = true,
                None => {
                    let error = Error::run("the solution does not fit the mesh")
                        .got(format_args!("a row of point {point}"));
                    return Err(error.expected(format_args!(
                        "one of each of the points 0 to {}",
                        self.point_count.saturating_sub(1)
                    )));
                }
            }
            count += 1;
            visit(place as u64, tuple)
        };
        match &self.rows {
            Rows::Text(rows) => self.each_line(rows, columns, &mut take)?,
            Rows::Bytes(start) => self.each_row_of_bytes(*start, columns, &mut take)?,
        }
        match count == self.point_count {
            true => Ok(()),
            false => {
                let error =
                    Error::run("the solution does not fit the mesh").got(format_args!("{count} rows"));
                Err(error.expected(format_args!("the {} of the mesh's points", self.point_count)))
            }
        }
    }

    fn each_line(&self, rows: &TextRange, columns: &[usize], take: TakeRow) -> Result<()> {
        let of_points = self.columns.iter().position(|name| name == PLACES[0]);
        let width = self.columns.len();
        let parse = |line: &[u8], found: &mut (Vec<f64>, Vec<f64>)| {
            // Behind the rows older versions write settings.
            if line.iter().all(|&byte| is_space(byte)) || line.contains(&b'=') {
                return Ok(());
            }
            let has_commas = line.contains(&b',');
            let is_between = |&byte: &u8| if has_commas { byte == b',' } else { is_space(byte) };
            let words = line.split(is_between).map(<[u8]>::trim_ascii);
            let mut words = words.filter(|word| has_commas || !word.is_empty());
            let mut row: Vec<f64> = Vec::with_capacity(width);
            for name in &self.columns {
                let value = numbers::parse(NumberType::F64, words.next().unwrap_or_default());
                row.push(value.map_err(|error| error.expected(format_args!("a value of '{name}'")))?);
            }
            if let Some(word) = words.find(|word| !word.is_empty()) {
                let error = Error::run("a row has further values").got(quoted(word));
                return Err(error.expected(format_args!("{width}, one of each variable of the first line")));
            }
            found.0.extend(of_points.map(|place| row[place]));
            found.1.extend(columns.iter().map(|&place| row[place]));
            Ok(())
        };
        rows.lines(parse, |(points, values)| {
            let tuples = values.chunks(columns.len()).enumerate();
            tuples.into_iter().try_for_each(|(row, tuple)| take(points.get(row).copied(), tuple))
        })
    }

    fn each_row_of_bytes(&self, start: u64, columns: &[usize], take: TakeRow) -> Result<()> {
        let width = self.columns.len();
        let row_bytes = 8 * width as u64;
        let mut tuple = vec![0.0; columns.len()];
        let mut first = 0;
        while first < self.point_count {
            let count = ROWS.min(self.point_count - first);
            let bytes = self.source.read(start + first * row_bytes, count * row_bytes)?;
            let (values, _) = bytes.as_chunks::<8>();
            for row in values.chunks(width) {
                tuple
                    .iter_mut()
                    .zip(columns)
                    .for_each(|(value, &place)| *value = f64::from_le_bytes(row[place]));
                take(None, &tuple)?;
            }
            first += count;
        }
        Ok(())
    }
}

/// Called with the number of a row's point, where it is stated, and its values.
type TakeRow<'a> = &'a mut dyn FnMut(Option<f64>, &[f64]) -> Result<()>;

/// Columns of a file of bytes, and where its rows begin.
fn binary_head(source: &Arc<Source>, point_count: u64) -> Result<(Vec<String>, Rows)> {
    let head = source.read(0, HEAD)?;
    let (counts, _) = head.as_chunks::<4>();
    let [column_count, row_count] = [1, 2].map(|place| u64::from(u32::from_le_bytes(counts[place])));
    if row_count != point_count {
        let error = Error::run("the solution does not fit the mesh").got(format_args!("{row_count} points"));
        return Err(error.expected(format_args!("the {point_count} of the mesh")));
    }
    checked_count(column_count)?;
    let start = HEAD + column_count * NAME;
    source.check(start, row_count.saturating_mul(8 * column_count))?;
    let names = source.read(HEAD, column_count * NAME)?;
    let (names, _) = names.as_chunks::<{ NAME as usize }>();
    let name = |bytes: &[u8; NAME as usize]| {
        let text = bytes.split(|&byte| byte == 0).next().unwrap_or_default();
        String::from_utf8_lossy(text).trim().to_owned()
    };
    Ok((names.iter().map(name).collect(), Rows::Bytes(start)))
}

/// Columns of a file of text, and its rows.
fn text_head(source: &Arc<Source>) -> Result<(Vec<String>, Rows)> {
    let mut cursor = Cursor::new(source);
    let line = cursor.text_line("names of variables")?;
    if !line.starts_with('"') {
        let found: String = line.chars().take(60).collect();
        let error = cursor.error("this is no solution of SU2").got(format_args!("'{found}'"));
        return Err(error.expected("names in quotes, as \"PointID\",\"x\",\"y\",\"z\",\"Density\", or a file of bytes that begins with the number 535532"));
    }
    // Names are in quotes, and between them commas or tabs.
    let names: Vec<String> = line.split('"').skip(1).step_by(2).map(|name| name.trim().to_owned()).collect();
    checked_count(names.len() as u64)?;
    Ok((names, Rows::Text(cursor.rest())))
}

/// # Errors
/// No variables, or more than SU2 counts.
fn checked_count(count: u64) -> Result<()> {
    match count {
        0 => Err(Error::run("the solution holds no variables")),
        1..=MAX_COLUMNS => Ok(()),
        _ => Err(Error::run("the solution is damaged")
            .got(format_args!("{count} variables"))
            .expected(format_args!("at most {MAX_COLUMNS}"))),
    }
}
