//! One call of a plug-in with its inputs, and its outputs: alike in this process, in one of its own, and in a sandbox.

use crate::declaration::LibraryItem;
use crate::grids::{Buffers, Head, MixedCells};
use crate::host::State;
use crate::status::CallStatus;
use crate::values::ParameterValues;
use crate::wire::{self, Reader, Writer, garbled};
use std::any::Any;
use std::io::{self, Read, Write};
use voltet_core::glam::DVec3;

/// One call with its inputs. These are owned or shared, so that a call that never returns harms nothing.
///
/// In a message a task is a tag, a head, and arrays, whose lengths the head has.
pub(crate) trait Task: Any + Send + Sync {
    /// Number of the kind in messages.
    fn tag(&self) -> u64;

    /// Stage of the progress reports.
    fn stage(&self) -> &'static str;

    /// Calls the function of a loaded library. An item of another family gives no output.
    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome);

    /// Appends the head.
    fn encode(&self, head: &mut Writer);

    /// Sends the arrays.
    fn send_arrays(&self, _to: &mut dyn Write) -> io::Result<()> {
        Ok(())
    }
}

/// Task from a head and the arrays behind it.
pub(crate) type DecodeTask = fn(&mut Reader, &mut dyn Read) -> io::Result<Box<dyn Task>>;

/// Check of parameter values by the plug-in.
pub(crate) struct CheckTask(pub ParameterValues);

impl CheckTask {
    pub const TAG: u64 = 0;

    pub fn decode(head: &mut Reader, _: &mut dyn Read) -> io::Result<Box<dyn Task>> {
        Ok(Box::new(CheckTask(ParameterValues::decode(head).ok_or_else(garbled)?)))
    }
}

impl Task for CheckTask {
    fn tag(&self) -> u64 {
        CheckTask::TAG
    }

    fn stage(&self) -> &'static str {
        "check"
    }

    fn run(self: Box<Self>, item: &LibraryItem, state: &State) -> (CallStatus, Outcome) {
        let Some(check) = item.check else { return Default::default() };
        let pointers = self.0.pointers();
        // SAFETY: the plug-in's own function; all that it is given lives through the call.
        let code = unsafe { check(&self.0.header_values(&pointers), &state.host()) };
        (CallStatus::new(code, state), Outcome::Nothing)
    }

    fn encode(&self, head: &mut Writer) {
        self.0.encode(head);
    }
}

/// Output of a call.
#[derive(Default)]
pub(crate) enum Outcome {
    /// Only the status.
    #[default]
    Nothing,
    /// Vectors of the gradient.
    Vectors(Vec<DVec3>),
    /// Contents of a file.
    Head(Head),
    /// A grid, or parts of it. The counts of a grid filter are those of the whole grid, whatever it shares with the input.
    Grid(Head, Buffers),
    /// Pixels of a picture.
    Pixels(Vec<[f32; 4]>),
}

/// Numbers of the kinds in messages.
const NOTHING: u64 = 0;
const VECTORS: u64 = 1;
const HEAD: u64 = 2;
const GRID: u64 = 3;
const PIXELS: u64 = 4;

impl Outcome {
    pub fn vectors(self) -> Option<Vec<DVec3>> {
        if let Outcome::Vectors(vectors) = self { Some(vectors) } else { None }
    }

    pub fn head(self) -> Option<Head> {
        if let Outcome::Head(head) = self { Some(head) } else { None }
    }

    pub fn grid(self) -> Option<(Head, Buffers)> {
        if let Outcome::Grid(head, buffers) = self { Some((head, buffers)) } else { None }
    }

    pub fn pixels(self) -> Option<Vec<[f32; 4]>> {
        if let Outcome::Pixels(pixels) = self { Some(pixels) } else { None }
    }

    /// Appends the head: lengths of the arrays.
    pub fn encode(&self, head: &mut Writer) {
        match self {
            Outcome::Nothing => head.number(NOTHING),
            Outcome::Vectors(vectors) => {
                head.number(VECTORS);
                head.count(vectors.len());
            }
            Outcome::Head(described) => {
                head.number(HEAD);
                described.encode(head);
            }
            Outcome::Grid(described, Buffers { points, tetrahedra, cells, arrays }) => {
                head.number(GRID);
                described.encode(head);
                head.optional(points.as_ref().map(Vec::len), Writer::count);
                head.optional(tetrahedra.as_ref().map(Vec::len), Writer::count);
                head.optional(cells.as_ref(), |head, MixedCells { types, offsets, connectivity }| {
                    for count in [types.len(), offsets.len(), connectivity.len()] {
                        head.count(count);
                    }
                });
                head.list(arrays, |head, array| head.optional(array.as_ref().map(Vec::len), Writer::count));
            }
            Outcome::Pixels(pixels) => {
                head.number(PIXELS);
                head.count(pixels.len());
            }
        }
    }

    /// Sends the arrays.
    pub fn send_arrays(&self, to: &mut dyn Write) -> io::Result<()> {
        match self {
            Outcome::Nothing | Outcome::Head(_) => Ok(()),
            Outcome::Vectors(vectors) => wire::send_array(to, vectors),
            Outcome::Pixels(pixels) => wire::send_array(to, pixels),
            Outcome::Grid(_, Buffers { points, tetrahedra, cells, arrays }) => {
                points.iter().try_for_each(|points| wire::send_array(to, points))?;
                tetrahedra.iter().try_for_each(|cells| wire::send_array(to, cells))?;
                if let Some(MixedCells { types, offsets, connectivity }) = cells {
                    wire::send_array(to, types)?;
                    wire::send_array(to, offsets)?;
                    wire::send_array(to, connectivity)?;
                }
                arrays.iter().flatten().try_for_each(|array| wire::send_array(to, array))
            }
        }
    }

    /// Output from a head and the arrays behind it.
    pub fn decode(head: &mut Reader, from: &mut dyn Read) -> io::Result<Outcome> {
        match head.number().ok_or_else(garbled)? {
            NOTHING => Ok(Outcome::Nothing),
            VECTORS => Ok(Outcome::Vectors(wire::array(from, head.length().ok_or_else(garbled)?)?)),
            PIXELS => Ok(Outcome::Pixels(wire::array(from, head.length().ok_or_else(garbled)?)?)),
            HEAD => Head::decode(head).map(Outcome::Head).ok_or_else(garbled),
            GRID => decode_grid(head, from),
            _ => Err(garbled()),
        }
    }
}

/// Errors: arrays that are not as long as the grid's head says.
fn decode_grid(head: &mut Reader, from: &mut dyn Read) -> io::Result<Outcome> {
    let mut lengths = || {
        let described = Head::decode(head)?;
        let (points, tetrahedra) = (head.optional(Reader::length)?, head.optional(Reader::length)?);
        let cells = head.optional(|head| Some([head.length()?, head.length()?, head.length()?]))?;
        Some((described, points, tetrahedra, cells, head.list(|head| head.optional(Reader::length))?))
    };
    let (described, points, tetrahedra, cells, arrays) = lengths().ok_or_else(garbled)?;
    let [point_count, cell_count] = [described.point_count, described.cell_count];
    let cell_lengths = [cell_count, cell_count + 1, described.connectivity_count];
    let array_lengths = described.arrays.iter().map(|array| described.numbers(array));
    let fit = points.is_none_or(|n| n == point_count)
        && tetrahedra.is_none_or(|n| n == cell_count)
        && cells.is_none_or(|lengths| lengths == cell_lengths)
        && (arrays.is_empty() || arrays.len() == described.arrays.len())
        && arrays.iter().zip(array_lengths).all(|(length, expected)| length.is_none_or(|n| n == expected));
    if !fit {
        return Err(garbled());
    }
    let mut buffers = Buffers {
        points: points.map(|count| wire::array(from, count)).transpose()?,
        tetrahedra: tetrahedra.map(|count| wire::array(from, count)).transpose()?,
        ..Buffers::default()
    };
    if let Some([types, offsets, connectivity]) = cells {
        let (types, offsets) = (wire::array(from, types)?, wire::array(from, offsets)?);
        buffers.cells = Some(MixedCells { types, offsets, connectivity: wire::array(from, connectivity)? });
    }
    for length in arrays {
        buffers.arrays.push(length.map(|length| wire::array(from, length)).transpose()?);
    }
    Ok(Outcome::Grid(described, buffers))
}
