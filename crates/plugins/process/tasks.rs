//! What is asked of a plug-in, in messages: a head, then arrays, whose numbers the head says.

use super::messages::garbled;
use super::wire::{self, Reader, Writer, send_array};
use crate::grid_filter::GivenGrid;
use crate::grids::Head;
use crate::image_filter::GivenImage;
use crate::reader::{OfFile, Wanted};
use crate::task::Task;
use crate::values::Owned;
use crate::work::Given;
use std::ffi::CString;
use std::io::{self, Read, Write};
use std::sync::Arc;
use voltet_core::glam::DVec3;
use voltet_core::grid::{Array, Grid};
use voltet_core::picture::Picture;

const CHECK: u64 = 0;
const GRADIENT: u64 = 1;
const INSPECT: u64 = 2;
const READ: u64 = 3;
const GRID: u64 = 4;
const IMAGE: u64 = 5;

impl Task {
    /// What is known before the arrays.
    pub(super) fn write_head(&self, head: &mut Writer) {
        match self {
            Task::Check(values) => {
                head.number(CHECK);
                values.write(head);
            }
            Task::Gradient(given) => {
                head.number(GRADIENT);
                given.values.write(head);
                write_counts(&given.grid, &given.arrays, head);
            }
            Task::Inspect(file) => {
                head.number(INSPECT);
                write_file(file, head);
            }
            Task::Read(file, wanted) => {
                head.number(READ);
                write_file(file, head);
                wanted.head.write(head);
                head.number(u64::from(wanted.geometry));
                head.number(wanted.arrays.len() as u64);
                wanted.arrays.iter().for_each(|&wanted| head.number(u64::from(wanted)));
                head.optional(wanted.memory_left, Writer::number);
            }
            Task::Grid(given) => {
                head.number(GRID);
                given.values.write(head);
                write_counts(&given.grid, &given.arrays, head);
                head.number(given.carried.len() as u64);
                for (name, array) in &given.carried {
                    head.bytes(name.as_bytes());
                    head.number(array.component_count as u64);
                }
                head.number(u64::from(given.has_scalar));
                head.optional(given.memory_left, Writer::number);
            }
            Task::Image(given) => {
                head.number(IMAGE);
                given.values.write(head);
                [given.picture.width, given.picture.height]
                    .into_iter()
                    .for_each(|count| head.number(count as u64));
            }
        }
    }

    /// The arrays.
    pub(super) fn write_arrays(&self, to: &mut impl Write) -> io::Result<()> {
        match self {
            Task::Check(_) | Task::Inspect(_) | Task::Read(..) => Ok(()),
            Task::Gradient(given) => {
                write_geometry(&given.grid, to)?;
                send_array(to, &given.scalar)?;
                given.arrays.iter().flatten().try_for_each(|array| send_array(to, &array.values))
            }
            Task::Grid(given) => {
                write_geometry(&given.grid, to)?;
                given.carried.iter().try_for_each(|(_, array)| send_array(to, &array.values))?;
                given.arrays.iter().flatten().try_for_each(|array| send_array(to, &array.values))
            }
            Task::Image(given) => send_array(to, &given.picture.rgba),
        }
    }

    /// From a head, and the arrays behind it.
    pub(super) fn read(head: &mut Reader, from: &mut impl Read) -> io::Result<Task> {
        let kind = head.number().ok_or_else(garbled)?;
        match kind {
            CHECK => Owned::read(head).map(Task::Check).ok_or_else(garbled),
            GRADIENT => gradient(head, from),
            INSPECT => file(head).map(|file| Task::Inspect(Box::new(file))).ok_or_else(garbled),
            READ => reading(head).ok_or_else(garbled),
            GRID => grid(head, from),
            IMAGE => image(head, from),
            _ => Err(garbled()),
        }
    }
}

type Named = [Option<Arc<Array>>];

fn write_counts(grid: &Grid, arrays: &Named, head: &mut Writer) {
    [grid.points.len(), grid.tetrahedra.len(), arrays.len()]
        .into_iter()
        .for_each(|count| head.number(count as u64));
    for array in arrays {
        head.optional(array.as_ref(), |head, array| head.number(array.component_count as u64));
    }
}

fn write_geometry(grid: &Grid, to: &mut impl Write) -> io::Result<()> {
    send_array(to, &grid.points)?;
    send_array(to, &grid.tetrahedra)
}

fn write_file(file: &OfFile, head: &mut Writer) {
    head.bytes(file.path.as_bytes());
    head.number(file.step);
    file.values.write(head);
}

fn file(head: &mut Reader) -> Option<OfFile> {
    let path = CString::new(head.bytes()?).ok()?;
    Some(OfFile { path, step: head.number()?, values: Owned::read(head)? })
}

fn reading(head: &mut Reader) -> Option<Task> {
    let file = file(head)?;
    let described = Head::read_message(head)?;
    let geometry = head.number()? == 1;
    let arrays: Vec<bool> = head.list(Reader::number)?.into_iter().map(|wanted| wanted == 1).collect();
    let memory_left = head.optional(Reader::number)?;
    let fits = arrays.len() == described.arrays.len();
    let wanted = Wanted { head: described, geometry, arrays, memory_left };
    fits.then(|| Task::Read(Box::new(file), Box::new(wanted)))
}

/// Numbers of points and cells, and for each parameter the components of the array that it names.
fn counts(head: &mut Reader) -> Option<(usize, usize, Vec<Option<usize>>)> {
    let mut count = || usize::try_from(head.number()?).ok();
    let (points, cells) = (count()?, count()?);
    let components = head.list(|head| head.optional(Reader::number))?;
    Some((points, cells, components.into_iter().map(|n| n.map(|n| n as usize)).collect()))
}

fn geometry(from: &mut impl Read, points: usize, cells: usize) -> io::Result<Grid> {
    let points = wire::array::<DVec3>(from, points)?.into();
    let tetrahedra = wire::array::<[u32; 4]>(from, cells)?.into();
    Ok(Grid { points, tetrahedra, ..Grid::default() })
}

fn array(from: &mut impl Read, points: usize, component_count: usize) -> io::Result<Array> {
    let values = wire::array::<f64>(from, component_count.saturating_mul(points))?.into();
    Ok(Array { component_count, values })
}

fn named(
    from: &mut impl Read,
    points: usize,
    components: Vec<Option<usize>>,
) -> io::Result<Vec<Option<Arc<Array>>>> {
    let one = |n: Option<usize>| n.map(|n| array(from, points, n).map(Arc::new)).transpose();
    components.into_iter().map(one).collect()
}

fn gradient(head: &mut Reader, from: &mut impl Read) -> io::Result<Task> {
    let stated = Owned::read(head).zip(counts(head));
    let (values, (points, cells, components)) = stated.ok_or_else(garbled)?;
    let grid = geometry(from, points, cells)?;
    let scalar = wire::array::<f64>(from, points)?;
    let arrays = named(from, points, components)?;
    Ok(Task::Gradient(Box::new(Given { grid, scalar, values, arrays })))
}

fn grid(head: &mut Reader, from: &mut impl Read) -> io::Result<Task> {
    let mut stated = || {
        let (values, counts) = (Owned::read(head)?, counts(head)?);
        let carried = head.list(|head| Some((CString::new(head.bytes()?).ok()?, head.number()? as usize)))?;
        Some((values, counts, carried, head.number()? == 1, head.optional(Reader::number)?))
    };
    let (values, (points, cells, components), carried, has_scalar, memory_left) =
        stated().ok_or_else(garbled)?;
    let grid = geometry(from, points, cells)?;
    let carried = carried.into_iter().map(|(name, n)| Ok((name, array(from, points, n)?)));
    let carried = carried.collect::<io::Result<_>>()?;
    let arrays = named(from, points, components)?;
    Ok(Task::Grid(Box::new(GivenGrid { grid, carried, has_scalar, arrays, values, memory_left })))
}

fn image(head: &mut Reader, from: &mut impl Read) -> io::Result<Task> {
    let mut stated = || {
        let values = Owned::read(head)?;
        let mut count = || usize::try_from(head.number()?).ok();
        let (width, height) = (count()?, count()?);
        Some((values, width, height, width.checked_mul(height)?))
    };
    let (values, width, height, count) = stated().ok_or_else(garbled)?;
    let rgba = wire::array(from, count)?;
    Ok(Task::Image(Box::new(GivenImage { picture: Arc::new(Picture { width, height, rgba }), values })))
}
