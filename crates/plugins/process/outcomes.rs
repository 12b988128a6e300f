//! What a plug-in made, in messages: a head, then arrays, whose numbers the head says.

use super::messages::garbled;
use super::wire::{self, Reader, Writer, send_array};
use crate::grids::{Buffers, Head, Mixed};
use crate::task::Outcome;
use std::io::{self, Read, Write};

const NOTHING: u64 = 0;
const VECTORS: u64 = 1;
const HEAD: u64 = 2;
const GRID: u64 = 3;
const PIXELS: u64 = 4;

impl Outcome {
    /// What is known before the arrays.
    pub(super) fn write_head(&self, head: &mut Writer) {
        match self {
            Outcome::Nothing => head.number(NOTHING),
            Outcome::Vectors(vectors) => {
                head.number(VECTORS);
                count(head, vectors.len());
            }
            Outcome::Head(described) => {
                head.number(HEAD);
                described.write(head);
            }
            Outcome::Grid(described, buffers) => {
                head.number(GRID);
                described.write(head);
                let Buffers { points, tetrahedra, cells, arrays } = buffers;
                head.optional(points.as_ref().map(Vec::len), count);
                head.optional(tetrahedra.as_ref().map(Vec::len), count);
                head.optional(cells.as_ref(), |head, Mixed { types, offsets, connectivity }| {
                    [types.len(), offsets.len(), connectivity.len()].into_iter().for_each(|n| count(head, n));
                });
                count(head, arrays.len());
                arrays.iter().for_each(|array| head.optional(array.as_ref().map(Vec::len), count));
            }
            Outcome::Pixels(pixels) => {
                head.number(PIXELS);
                count(head, pixels.len());
            }
        }
    }

    /// The arrays.
    pub(super) fn write_arrays(&self, to: &mut impl Write) -> io::Result<()> {
        match self {
            Outcome::Nothing | Outcome::Head(_) => Ok(()),
            Outcome::Vectors(vectors) => send_array(to, vectors),
            Outcome::Pixels(pixels) => send_array(to, pixels),
            Outcome::Grid(_, Buffers { points, tetrahedra, cells, arrays }) => {
                points.iter().try_for_each(|points| send_array(to, points))?;
                tetrahedra.iter().try_for_each(|cells| send_array(to, cells))?;
                if let Some(Mixed { types, offsets, connectivity }) = cells {
                    send_array(to, types)?;
                    send_array(to, offsets)?;
                    send_array(to, connectivity)?;
                }
                arrays.iter().flatten().try_for_each(|array| send_array(to, array))
            }
        }
    }

    /// From a head, and the arrays behind it.
    pub(super) fn read(head: &mut Reader, from: &mut impl Read) -> io::Result<Outcome> {
        match head.number().ok_or_else(garbled)? {
            NOTHING => Ok(Outcome::Nothing),
            VECTORS => Ok(Outcome::Vectors(wire::array(from, length(head).ok_or_else(garbled)?)?)),
            PIXELS => Ok(Outcome::Pixels(wire::array(from, length(head).ok_or_else(garbled)?)?)),
            HEAD => Head::read_message(head).map(Outcome::Head).ok_or_else(garbled),
            GRID => grid(head, from),
            _ => Err(garbled()),
        }
    }
}

fn count(head: &mut Writer, count: usize) {
    head.number(count as u64);
}

fn length(head: &mut Reader) -> Option<usize> {
    usize::try_from(head.number()?).ok()
}

/// Errors: arrays that are not as long as the grid's head says.
fn grid(head: &mut Reader, from: &mut impl Read) -> io::Result<Outcome> {
    let mut stated = || {
        let described = Head::read_message(head)?;
        let (points, tetrahedra) = (head.optional(length)?, head.optional(length)?);
        let cells = head.optional(|head| Some([length(head)?, length(head)?, length(head)?]))?;
        let arrays = head.list(|head| head.optional(length))?;
        Some((described, points, tetrahedra, cells, arrays))
    };
    let (described, points, tetrahedra, cells, arrays) = stated().ok_or_else(garbled)?;
    let [point_count, cell_count] = [described.point_count, described.cell_count];
    let of_cells = [cell_count, cell_count + 1, described.connectivity_count];
    let of_arrays = described.arrays.iter().map(|array| described.numbers(array));
    let fit = points.is_none_or(|n| n == point_count)
        && tetrahedra.is_none_or(|n| n == cell_count)
        && cells.is_none_or(|lengths| lengths == of_cells)
        && (arrays.is_empty() || arrays.len() == described.arrays.len())
        && arrays.iter().zip(of_arrays).all(|(length, wanted)| length.is_none_or(|length| length == wanted));
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
        buffers.cells = Some(Mixed { types, offsets, connectivity: wire::array(from, connectivity)? });
    }
    for length in arrays {
        buffers.arrays.push(length.map(|length| wire::array(from, length)).transpose()?);
    }
    Ok(Outcome::Grid(described, buffers))
}
