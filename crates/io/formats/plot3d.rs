//! PLOT3D: a file of curvilinear grids and, beside it, a file of the flow's solution (q) on them.
//!
//! The format has no magic and no version: a grid count that may be missing, dimensions, then planes of numbers in
//! single or double precision, of either byte order, with or without the length marks that Fortran puts round each
//! record, or as text. Each choice gives another length for the same dimensions, so the length of the file tells.
//! Source: PLOT3D User's Manual (Walatka, Buning, Pierce, Elson; NASA TM 101067, 1990), chapter 8; choices as in
//! vtkMultiBlockPLOT3DReader. Quantities that follow from a solution: chapter 4, as that reader evaluates them (its defaults for γ and
//! R). Symbols, in PLOT3D's dimensionless form: density ρ, momentum ρ**u**, energy e per volume, v² = |**u**|², ratio of specific heats
//! γ = 1.4, gas constant R = 1.

use self::Formula::{Scalar, Vector};
use super::blocks;
use super::contents::{
    CellBlocks, Dataset, Encoding, Geometry, Meter, Piece, PieceArray, Stored, structured_counts,
};
use super::numbers::{self, ByteOrder, NumberType};
use super::request::{Format, Request};
use super::source::Source;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::{Error, Result, counted};

pub(super) const FORMAT: Format = Format { files: "a PLOT3D grid", matches, open, has_solution: true };

/// True if a file is to be read as PLOT3D: its name says so or a solution was named with it.
fn matches(_: &[u8], path: &Path, request: &Request) -> bool {
    let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
    let extension = extension.as_deref().and_then(|extension| extension.to_str()).unwrap_or("");
    request.solution.is_some() || ["xyz", "x", "p3d", "g", "grd", "grid"].contains(&extension)
}

/// The solution file: the one named, or the grid's name with the ending `.q` if there is one.
fn solution(path: &Path, request: &Request) -> Option<PathBuf> {
    request.solution.clone().or_else(|| Some(path.with_extension("q")).filter(|path| path.is_file()))
}

/// The solution that is read with a grid though nobody named it.
pub(super) fn solution_beside(path: &Path, request: &Request) -> Option<PathBuf> {
    let meant = matches(&[], path, request) && request.solution.is_none();
    solution(path, request).filter(|solution| meant && solution != path)
}

/// Reads the tables of contents of a grid file and its solution.
fn open(source: Arc<Source>, request: &Request) -> Result<Dataset> {
    let (grids, format) = blocks(&source, &GRID)?;
    let format = format!("PLOT3D, {format}");
    let mut dataset = Dataset { format, file_bytes: source.len(), has_blocks: true, ..Dataset::default() };
    let mut solutions = Vec::new();
    if let Some(path) = solution(source.path(), request) {
        let mut inner = || -> Result<Vec<Block>> {
            let source = Source::open(&path)?;
            let (blocks, format) = blocks(&source, &SOLUTION)?;
            let sizes = |blocks: &[Block]| blocks.iter().map(|block| block.dimensions).collect::<Vec<_>>();
            if sizes(&blocks) != sizes(&grids) {
                return Err(Error::run("the solution does not fit the grid")
                    .got(format_args!("dimensions {:?}", sizes(&blocks)))
                    .expected(format_args!("{:?}", sizes(&grids))));
            }
            dataset.format = format!("{}; solution {format}", dataset.format);
            dataset.file_bytes += source.len();
            Ok(blocks)
        };
        solutions = inner().map_err(|error| error.in_file(&path))?;
    } else if !grids.iter().any(|grid| grid.has_blanking) {
        dataset.warnings.push("The PLOT3D grid has no solution file, so it holds no quantity.".to_owned());
    }
    let mut solutions = solutions.into_iter();
    let names: Vec<String> = (1..=grids.len()).map(|number| format!("grid {number}")).collect();
    let selected = blocks::selected(if names.len() > 1 { &names } else { &[] }, request)?;
    for (block, grid) in grids.into_iter().enumerate() {
        let solution = solutions.next();
        if selected.get(block) != Some(&false) {
            dataset.pieces.push(piece(&source, block, grid, solution, request)?);
        }
    }
    dataset.blocks = if names.len() > 1 { names } else { Vec::new() };
    Ok(dataset)
}

fn piece(
    source: &Arc<Source>,
    block: usize,
    grid: Block,
    solution: Option<Block>,
    request: &Request,
) -> Result<Piece> {
    let (point_count, cell_count) = structured_counts(grid.dimensions)?;
    let mut arrays = Vec::new();
    let mut add = |stored: Stored| arrays.push(PieceArray::new(Association::Point, stored));
    let [x, y, z, rest @ ..] = &grid.planes[..] else {
        return Err(Error::run("a PLOT3D grid lacks coordinates"));
    };
    let coordinates = [x.clone(), y.clone(), z.clone()];
    let points = Stored::joined("coordinates", coordinates);
    if let Some(flags) = rest.first() {
        let flags = Stored { name: "iblank".to_owned(), ..flags.clone() };
        // 0 marks a point outside the flow; other values say what kind of point it is.
        let hidden = flags.hidden_where_zero();
        add(flags);
        add(hidden);
    }
    if let Some(solution) = solution {
        let planes: Arc<[Stored]> = solution.planes.into();
        for quantity in QUANTITIES {
            // The quantity bears the name that the request uses, so that it is found however it is spelled.
            let wanted = request.scalar.iter().chain(&request.point_arrays);
            let stem = |name: &'_ String| name.split(':').next().unwrap_or("").to_owned();
            let DerivedQuantity(name, _, formula) = quantity;
            let name = wanted.map(stem).find(|name| quantity.is_called(name)).unwrap_or(name.to_string());
            let component_count = if matches!(formula, Vector(_)) { 3 } else { 1 };
            let planes = planes.clone();
            let compute = move |meter: &Meter| derive(&planes, formula, meter);
            add(Stored::computed(source, &name, component_count, point_count, compute));
        }
    }
    let geometry = Geometry::Curvilinear { dimensions: grid.dimensions, points };
    Ok(Piece::new([point_count, cell_count], geometry, arrays).with_blocks(CellBlocks::One(block)))
}

/// A quantity from the planes of a solution.
fn derive(planes: &[Stored], formula: &Formula, meter: &Meter) -> Result<Vec<f64>> {
    let [density, mx, my, mz, energy] = planes else {
        return Err(Error::run("a PLOT3D solution lacks planes"));
    };
    let (density, energy) = (density.load(meter)?, energy.load(meter)?);
    let momentum = [mx.load(meter)?, my.load(meter)?, mz.load(meter)?];
    let points = (0..density.len()).into_par_iter();
    let momentum = |i: usize| [momentum[0][i], momentum[1][i], momentum[2][i]];
    Ok(match formula {
        Scalar(formula) => points.map(|i| formula(density[i], momentum(i), energy[i])).collect(),
        Vector(formula) => points.flat_map_iter(|i| formula(density[i], momentum(i), energy[i])).collect(),
    })
}

/// Ratio of specific heats.
const GAMMA: f64 = 1.4;

/// A quantity: its name, another one that is understood (without capitals, spaces, hyphens and underscores), formula of (ρ, ρu, e).
struct DerivedQuantity(&'static str, Option<&'static str>, Formula);

/// Formula of a quantity from density, momentum and energy.
enum Formula {
    /// One value a point.
    Scalar(fn(f64, [f64; 3], f64) -> f64),
    /// Three values a point.
    Vector(fn(f64, [f64; 3], f64) -> [f64; 3]),
}

fn speed_squared(density: f64, momentum: [f64; 3]) -> f64 {
    momentum.iter().map(|m| (m / density).powi(2)).sum()
}

/// p = (γ − 1) (e − ρ v² / 2)
fn pressure(density: f64, momentum: [f64; 3], energy: f64) -> f64 {
    (GAMMA - 1.0) * (energy - 0.5 * density * speed_squared(density, momentum))
}

/// c = √(γ p / ρ)
fn sound_speed(density: f64, momentum: [f64; 3], energy: f64) -> f64 {
    (GAMMA * pressure(density, momentum, energy) / density).sqrt()
}

/// s = R / (γ − 1) · ln((p / p∞) / (ρ / ρ∞)^γ) with ρ∞ = 1, p∞ = 1 / γ
fn entropy(density: f64, momentum: [f64; 3], energy: f64) -> f64 {
    (pressure(density, momentum, energy) * GAMMA / density.powf(GAMMA)).ln() / (GAMMA - 1.0)
}

/// All quantities, those of the file first.
const QUANTITIES: &[DerivedQuantity] = &[
    DerivedQuantity("density", None, Scalar(|d, _, _| d)),
    DerivedQuantity("momentum", None, Vector(|_, m, _| m)),
    DerivedQuantity("energy", Some("stagnationenergy"), Scalar(|_, _, e| e)),
    DerivedQuantity("pressure", None, Scalar(pressure)),
    // T = p / (ρ R)
    DerivedQuantity("temperature", None, Scalar(|d, m, e| pressure(d, m, e) / d)),
    // h = γ (e/ρ − v² / 2)
    DerivedQuantity("enthalpy", None, Scalar(|d, m, e| GAMMA * (e / d - 0.5 * speed_squared(d, m)))),
    DerivedQuantity("internal_energy", None, Scalar(|d, m, e| e / d - 0.5 * speed_squared(d, m))),
    DerivedQuantity("kinetic_energy", None, Scalar(|d, m, _| 0.5 * speed_squared(d, m))),
    DerivedQuantity("velocity", None, Vector(|d, m, _| m.map(|m| m / d))),
    DerivedQuantity("velocity_magnitude", Some("speed"), Scalar(|d, m, _| speed_squared(d, m).sqrt())),
    DerivedQuantity("entropy", None, Scalar(entropy)),
    DerivedQuantity("sound_speed", None, Scalar(sound_speed)),
    DerivedQuantity(
        "mach",
        Some("machnumber"),
        Scalar(|d, m, e| speed_squared(d, m).sqrt() / sound_speed(d, m, e)),
    ),
];

impl DerivedQuantity {
    /// True if a person means this quantity by `word`, however it is capitalised and joined.
    fn is_called(&self, word: &str) -> bool {
        let letters = |text: &str| text.chars().filter(char::is_ascii_alphanumeric).collect::<String>();
        let plain = letters(word).to_ascii_lowercase();
        plain == letters(self.0) || self.1 == Some(plain.as_str())
    }
}

/// More grids than any file holds.
const GREATEST_GRID_COUNT: u64 = 1 << 16;

/// A kind of file: its name, the numbers that stand before the planes of a grid, and the planes.
struct Role {
    name: &'static str,
    head_count: u64,
    plane_count: u64,
}

/// x, y, z and perhaps the blanking flags.
const GRID: Role = Role { name: "grid", head_count: 0, plane_count: 3 };
/// Four numbers on the flow, then density, three momenta, energy.
const SOLUTION: Role = Role { name: "solution", head_count: 4, plane_count: 5 };

/// A grid of the file: dimensions and planes.
struct Block {
    dimensions: [u64; 3],
    /// Components, one value a point.
    planes: Vec<Stored>,
    /// The last plane holds blanking flags.
    has_blanking: bool,
}

/// One way to write a file.
struct Layout {
    /// All numbers of a text; `None`: the file is binary.
    text: Option<Arc<Vec<f64>>>,
    order: ByteOrder,
    /// Fortran's length marks.
    marks: bool,
    /// A count of grids stands first.
    counted: bool,
    double: bool,
    blanking: bool,
}

/// Reads the dimensions and finds the planes; also how the file is written, for people.
fn blocks(source: &Arc<Source>, role: &Role) -> Result<(Vec<Block>, String)> {
    let head = source.head(4096)?;
    let is_in_text = |b: &u8| b.is_ascii_whitespace() || b.is_ascii_digit() || b"+-.,eEdD".contains(b);
    let mut text = None;
    if head.iter().all(is_in_text) {
        let mut bytes = source.read(0, source.len())?;
        bytes.iter_mut().filter(|byte| **byte == b',').for_each(|byte| *byte = b' ');
        text = Some(Arc::new(numbers::numbers(NumberType::F64, &bytes)?));
    }
    // Of a text only the count of grids and the blanking are open.
    for bits in (0..32).filter(|bits| text.is_none() || bits & 0b11010 == 0b10000) {
        let layout = Layout {
            text: text.clone(),
            marks: bits & 16 == 0,
            order: if bits & 8 == 0 { ByteOrder::Little } else { ByteOrder::Big },
            counted: bits & 4 != 0,
            double: bits & 2 != 0,
            blanking: bits & 1 != 0,
        };
        if layout.blanking && role.head_count > 0 {
            continue;
        }
        if let Some(blocks) = layout.read(source, role) {
            return Ok((blocks, layout.describe()));
        }
    }
    let (found, accepted) = match text {
        Some(values) => (counted(values.len(), "number"), "three-dimensional grids as text"),
        None => (
            format!("a length of {} bytes", source.len()),
            "three-dimensional grids, single or double precision, either byte order, with or without record marks",
        ),
    };
    Err(Error::run("this is no PLOT3D file, or a damaged one")
        .got(format!("{found}, which fits no way of writing one"))
        .expected(accepted))
}

impl Layout {
    fn describe(&self) -> String {
        let blanking = if self.blanking { ", blanking" } else { "" };
        if self.text.is_some() {
            return format!("ASCII{blanking}");
        }
        format!(
            "{}, {} precision{}{blanking}",
            if self.order == ByteOrder::Little { "little-endian" } else { "big-endian" },
            if self.double { "double" } else { "single" },
            if self.marks { ", record marks" } else { "" },
        )
    }

    /// Lengths of the file, of a 32-bit word and of a number: bytes, or of a text numbers.
    fn lengths(&self, source: &Source) -> [u64; 3] {
        match &self.text {
            Some(values) => [values.len() as u64, 1, 1],
            None => [source.len(), 4, if self.double { 8 } else { 4 }],
        }
    }

    fn words(&self, source: &Source, at: u64, count: u64) -> Option<Vec<u64>> {
        if let Some(values) = &self.text {
            let words = values.get(at as usize..at.checked_add(count)? as usize)?;
            let word =
                |&v: &f64| (v >= 0.0 && v <= f64::from(u32::MAX) && v.fract() == 0.0).then_some(v as u64);
            return words.iter().map(word).collect();
        }
        let bytes = source.check(at, count * 4).ok().and_then(|()| source.read(at, count * 4).ok())?;
        let mut words = vec![0_u64; count as usize];
        numbers::convert(NumberType::U32, self.order, &bytes, &mut words).ok()?;
        Some(words)
    }

    /// The planes, if the file is written in this way.
    fn read(&self, source: &Arc<Source>, role: &Role) -> Option<Vec<Block>> {
        let mut at = 0;
        let mut grid_count = 1;
        if self.counted {
            let [count] = self.record(source, &mut at, 1)?[..] else { return None };
            grid_count = count;
        }
        if !(1..=GREATEST_GRID_COUNT).contains(&grid_count) {
            return None;
        }
        let dimensions = self.record(source, &mut at, 3 * grid_count)?;
        let mut blocks = Vec::new();
        for &dimensions in dimensions.as_chunks::<3>().0 {
            blocks.push(self.block(source, role, dimensions, &mut at)?);
        }
        (at == self.lengths(source)[0]).then_some(blocks)
    }

    /// Reads a record of 32-bit words.
    fn record(&self, source: &Source, at: &mut u64, count: u64) -> Option<Vec<u64>> {
        let len = count * self.lengths(source)[1];
        self.mark(source, at, len)?;
        let words = self.words(source, *at, count)?;
        *at += len;
        self.mark(source, at, len)?;
        Some(words)
    }

    /// Steps over a mark, which must hold the length of the record.
    fn mark(&self, source: &Source, at: &mut u64, len: u64) -> Option<()> {
        if self.marks {
            let [found] = self.words(source, *at, 1)?[..] else { return None };
            // Records of 4 GB and more have marks that cannot hold their length.
            if found != len && len <= u64::from(u32::MAX / 2) {
                return None;
            }
            *at += 4;
        }
        Some(())
    }

    fn block(&self, source: &Arc<Source>, role: &Role, dimensions: [u64; 3], at: &mut u64) -> Option<Block> {
        if dimensions.iter().any(|n| !(1..=1 << 31).contains(n)) {
            return None;
        }
        let [file_len, word_len, number_len] = self.lengths(source);
        let count = dimensions[0].checked_mul(dimensions[1])?.checked_mul(dimensions[2])?;
        let plane_len = count.checked_mul(number_len).filter(|&len| len <= file_len)?;
        if role.head_count > 0 {
            let len = role.head_count * number_len;
            self.mark(source, at, len)?;
            *at += len;
            self.mark(source, at, len)?;
        }
        let len = plane_len * role.plane_count + if self.blanking { count * word_len } else { 0 };
        self.mark(source, at, len)?;
        let begin = *at;
        *at += len;
        if *at > file_len {
            return None;
        }
        self.mark(source, at, len)?;
        let plane = |index: u64| {
            let first = begin + index * plane_len;
            let encoding = match self.text.clone() {
                None => Encoding::Bytes(first),
                Some(values) => {
                    let own = first as usize..(first + count) as usize;
                    Encoding::Computed(Arc::new(move |_| Ok(values[own.clone()].to_vec())))
                }
            };
            let number_type = match () {
                () if index == role.plane_count => NumberType::I32,
                () if self.double => NumberType::F64,
                () => NumberType::F32,
            };
            Stored { number_type, order: self.order, ..Stored::of_f64(source, role.name, 1, count, encoding) }
        };
        let planes = (0..role.plane_count + u64::from(self.blanking)).map(plane).collect();
        Some(Block { dimensions, planes, has_blanking: self.blanking })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// ρ = 2, u = (3, 0, 4), p = 5: v² = 25, e = p / 0.4 + ρ v² / 2 = 37.5.
    #[test]
    fn quantities_follow_from_density_momentum_and_energy() {
        let value = |name: &str| match &QUANTITIES.iter().find(|q| q.is_called(name)).unwrap().2 {
            Scalar(formula) => formula(2.0, [6.0, 0.0, 8.0], 37.5),
            Vector(formula) => formula(2.0, [6.0, 0.0, 8.0], 37.5)[2],
        };
        // Rounding of a handful of operations on numbers below 100.
        let same = |a: f64, b: f64| assert!((a - b).abs() < 1e-13 * b.abs().max(1.0), "{a} {b}");
        same(value("Density"), 2.0);
        same(value("StagnationEnergy"), 37.5);
        same(value("pressure"), 5.0);
        same(value("temperature"), 2.5);
        same(value("enthalpy"), 8.75);
        same(value("InternalEnergy"), 6.25);
        same(value("kinetic energy"), 12.5);
        same(value("velocity"), 4.0);
        same(value("velocity-magnitude"), 5.0);
        same(value("SoundSpeed"), 3.5_f64.sqrt());
        same(value("MachNumber"), 5.0 / 3.5_f64.sqrt());
        same(value("entropy"), (7.0 / 2.0_f64.powf(1.4)).ln() / 0.4);
    }
}
