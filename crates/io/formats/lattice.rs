//! Boxes of several sizes on one lattice, as adaptive grids have them: their points, cells and hanging points.
//!
//! Coordinates divide each axis into intervals, and each interval is divided into equal parts: the finest boxes. A box is a cube of
//! lattice cells that begins at a multiple of its size. Boxes that touch share their corners; a corner within a face or an edge of a
//! larger box hangs there.

use glam::DVec3;
use rayon::prelude::*;
use std::cmp::Reverse;
use voltet_core::grid::{CellSet, Cells, HangingPoint, code};
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_core::{Error, Result, counted};

pub(super) struct Axis {
    /// Ends of the intervals, two at least.
    pub coordinates: Vec<f64>,
    /// Parts of each interval.
    pub parts: u32,
}

impl Axis {
    fn position(&self, index: u32) -> f64 {
        let (interval, part) = ((index / self.parts) as usize, index % self.parts);
        let from = self.coordinates[interval];
        if part == 0 {
            return from;
        }
        from + (self.coordinates[interval + 1] - from) * (f64::from(part) / f64::from(self.parts))
    }

    /// Greatest index of a point. Errors: it leaves 32 bits.
    fn last(&self) -> Result<u32> {
        let intervals = self.coordinates.len().saturating_sub(1);
        let last = u32::try_from(intervals).ok().and_then(|intervals| intervals.checked_mul(self.parts));
        last.filter(|&last| last > 0).ok_or_else(|| {
            let error = Error::run("the lattice of the finest cells cannot be that large");
            error.got(format_args!("{intervals} × {} along an axis", self.parts)).expected(u32::MAX)
        })
    }
}

/// A box: the lattice point at its low corner, and lattice cells along an edge.
#[derive(Debug, Clone, Copy)]
pub(super) struct LatticeBox {
    pub low: [u32; 3],
    pub size: u32,
}

impl LatticeBox {
    /// Lattice point at a corner, numbered as a voxel's.
    pub fn corner(&self, corner: usize) -> [u32; 3] {
        std::array::from_fn(|axis| self.low[axis] + self.size * (corner as u32 >> axis & 1))
    }
}

pub(super) struct Lattice {
    axes: [Axis; 3],
    pub boxes: Vec<LatticeBox>,
    /// Lattice points that are corners of boxes, z first: in the order of a structured grid's points.
    points: Vec<[u32; 3]>,
    /// Numbers of the eight corners of each box.
    pub corners: Vec<u32>,
}

/// Bytes of a box while its corners are numbered: itself, each corner twice with its place, then its number and at most one point.
const BYTES_PER_BOX: u64 = size_of::<LatticeBox>() as u64 + 8 * (16 + 4) + 12;

/// Memory that the process may take while headers are read.
pub(in crate::formats) struct HeaderProgress;

impl Progress for HeaderProgress {
    fn report(&self, _: &str, _: f64) {}

    fn memory_left(&self) -> Option<u64> {
        crate::memory::available()
    }
}

/// Refuses more boxes than 32 bits number the corners of, or than memory holds. `bytes`: what a box takes beside its corners.
pub(super) fn refuse_too_many(count: u64, bytes: usize) -> Result<()> {
    if count > u64::from(u32::MAX / 8) {
        let error = Error::run("the grid has too many cells").got(count);
        return Err(error.expected(format_args!("at most {}", u32::MAX / 8)));
    }
    refuse_beyond_memory(&HeaderProgress, || counted(count, "cell"), count * (BYTES_PER_BOX + bytes as u64))
}

impl Lattice {
    /// Numbers the corners of boxes.
    ///
    /// Errors: there are none, more than 32 bits number, or more than memory holds; a box ends beyond the lattice.
    pub fn new(axes: [Axis; 3], boxes: Vec<LatticeBox>) -> Result<Lattice> {
        let last = [axes[0].last()?, axes[1].last()?, axes[2].last()?];
        let fits_axis = |own: &LatticeBox, axis: usize| {
            let (low, end) = (own.low[axis], own.low[axis].checked_add(own.size));
            own.size > 0 && low.is_multiple_of(own.size) && end.is_some_and(|end| end <= last[axis])
        };
        if boxes.is_empty() {
            return Err(Error::run("the adaptive grid holds no cells"));
        }
        if let Some(wrong) = boxes.par_iter().find_first(|own| !(0..3).all(|axis| fits_axis(own, axis))) {
            let error = Error::run("a cell of the adaptive grid lies off its lattice");
            return Err(
                error.got(format_args!("a cell of size {} at {:?} of {last:?}", wrong.size, wrong.low))
            );
        }
        let count = boxes.len() as u64;
        refuse_too_many(count, 0)?;
        let corner = |slot: u32| {
            let [x, y, z] = boxes[slot as usize / 8].corner(slot as usize % 8);
            ([z, y, x], slot)
        };
        let mut sorted: Vec<([u32; 3], u32)> = (0..8 * count as u32).into_par_iter().map(corner).collect();
        sorted.par_sort_unstable();
        let (mut points, mut corners) = (Vec::new(), vec![0; sorted.len()]);
        for same in sorted.chunk_by(|a, b| a.0 == b.0) {
            same.iter().for_each(|&(_, slot)| corners[slot as usize] = points.len() as u32);
            points.push(same[0].0);
        }
        Ok(Lattice { axes, boxes, points, corners })
    }

    pub fn point_count(&self) -> usize {
        self.points.len()
    }

    pub fn positions(&self) -> Vec<DVec3> {
        let [x, y, z] = &self.axes;
        let position = |&[k, j, i]: &[u32; 3]| DVec3::new(x.position(i), y.position(j), z.position(k));
        self.points.par_iter().map(position).collect()
    }

    pub fn cells(&self) -> Cells {
        Cells::Mixed(CellSet::of_type(code::VOXEL, 8, self.corners.clone()))
    }

    /// Points within faces and edges of larger boxes, those of the largest first.
    pub fn hanging(&self) -> Vec<HangingPoint> {
        // Octants by the signs of their axes: the box of which a point is corner c fills that opposite to c.
        let mut filled = vec![0_u8; self.points.len()];
        self.corners.iter().enumerate().for_each(|(slot, &p)| filled[p as usize] |= 1 << (7 - slot % 8));
        let finest = self.boxes.iter().map(|own| own.size).min().unwrap_or(1);
        let numbered = self.boxes.iter().zip(0..).filter(|(own, _)| own.size > finest);
        let mut larger: Vec<(LatticeKey, usize)> = numbered.map(|(own, number)| (key(own), number)).collect();
        larger.par_sort_unstable();
        let mut sizes: Vec<u32> = larger.iter().map(|entry| entry.0.0).collect();
        sizes.dedup();
        // The largest box, if any, that fills an octant of a point.
        let host = |[z, y, x]: [u32; 3], octant: u32| {
            let cell = |index: u32, axis: u32| index.checked_sub(u32::from(octant >> axis & 1 == 0));
            let cell = [cell(z, 2)?, cell(y, 1)?, cell(x, 0)?];
            sizes.iter().rev().find_map(|&size| {
                let wanted = (size, cell.map(|index| index - index % size));
                larger.binary_search_by_key(&wanted, |entry| entry.0).ok().map(|place| larger[place].1)
            })
        };
        let of_point = |(number, (&point, &filled)): (usize, (&[u32; 3], &u8))| {
            let open = (0..8).filter(|octant| filled >> octant & 1 == 0);
            let host =
                open.filter_map(|octant| host(point, octant)).max_by_key(|&host| self.boxes[host].size)?;
            Some((self.boxes[host].size, self.within(number as u32, host)))
        };
        let mut hanging: Vec<(u32, HangingPoint)> =
            self.points.par_iter().zip(&filled).enumerate().filter_map(of_point).collect();
        hanging.par_sort_by_key(|&(size, _)| Reverse(size));
        hanging.into_iter().map(|(_, own)| own).collect()
    }

    /// A point in the tetrahedra of a box, which lie around the diagonal from its lowest corner to the highest: along the axes in the
    /// order of the coordinates there (H. W. Kuhn, "Some combinatorial lemmas in topology", 1960).
    fn within(&self, point: u32, host: usize) -> HangingPoint {
        let own = &self.boxes[host];
        let [z, y, x] = self.points[point as usize];
        let share = |index: u32, low: u32| f64::from(index - low) / f64::from(own.size);
        let mut axes = [(share(x, own.low[0]), 1), (share(y, own.low[1]), 2), (share(z, own.low[2]), 4)];
        axes.sort_by(|a, b| b.0.total_cmp(&a.0));
        let [(a, first), (b, second), (c, _)] = axes;
        let weights = [1.0 - a, a - b, b - c, c];
        let corners = [0, first, first | second, 7].map(|corner| self.corners[8 * host + corner]);
        let used = (0..4).find(|&k| weights[k] > 0.0).unwrap_or(0);
        let corners = std::array::from_fn(|k| corners[if weights[k] > 0.0 { k } else { used }]);
        HangingPoint { point, corners, weights }
    }
}

/// Size and low corner of a box, z first.
type LatticeKey = (u32, [u32; 3]);

fn key(own: &LatticeBox) -> LatticeKey {
    let [x, y, z] = own.low;
    (own.size, [z, y, x])
}
