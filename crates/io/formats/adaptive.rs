//! Adaptive grids of a file, whose cells are boxes of several sizes, as one piece: points that boxes share, values of cells and points.

use super::contents::{CellBlocks, Compute, Dataset, Encoding, Geometry, Meter, Piece, PieceArray, Stored};
use super::lattice::{Axis, Lattice, LatticeBox};
use rayon::prelude::*;
use std::cmp::Reverse;
use std::sync::Arc;
use voltet_core::grid::Association;
use voltet_core::parallel::all_or_first;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::reading::FileArray;
use voltet_core::{Result, counted};

/// A part of an adaptive grid: boxes, and arrays that hold their values.
#[derive(Default)]
pub(super) struct Part {
    pub block: usize,
    pub boxes: Vec<LatticeBox>,
    /// The tuple of each box in the cell arrays.
    pub tuples: Vec<u32>,
    /// Points that point arrays lie on.
    pub points: BoxPoints,
    pub arrays: Vec<PieceArray>,
}

impl Part {
    pub const BYTES_PER_BOX: usize = size_of::<LatticeBox>() + size_of::<u32>();
}

/// Points of an array of equal boxes.
#[derive(Default, Clone, Copy)]
pub(super) struct BoxPoints {
    pub low: [u32; 3],
    pub size: u32,
    pub dimensions: [u32; 3],
}

impl BoxPoints {
    /// Number of a lattice point among its own, the first axis running fastest.
    fn number(&self, point: [u32; 3]) -> usize {
        let [i, j, k] = [0, 1, 2].map(|axis| ((point[axis] - self.low[axis]) / self.size) as usize);
        let [nx, ny, _] = self.dimensions.map(|n| n as usize);
        i + nx * (j + ny * k)
    }
}

/// Boxes of a lattice, and the parts that have their values, in this order.
struct Boxes {
    lattice: Arc<Lattice>,
    parts: Vec<Part>,
}

/// Adds the parts of an adaptive grid as a piece. Arrays that not all parts have are left out with a warning.
pub(super) fn add(dataset: &mut Dataset, axes: [Axis; 3], mut parts: Vec<Part>) -> Result<()> {
    let boxes = parts.iter_mut().flat_map(|part| std::mem::take(&mut part.boxes)).collect();
    let lattice = Arc::new(Lattice::new(axes, boxes)?);
    let runs = parts.iter().map(|part| (part.block, part.tuples.len() as u64)).collect();
    let arrays: Vec<Vec<PieceArray>> =
        parts.iter_mut().map(|part| std::mem::take(&mut part.arrays)).collect();
    let boxes = Arc::new(Boxes { lattice: lattice.clone(), parts });
    let mut kinds: Vec<(FileArray, &PieceArray)> = Vec::new();
    for array in arrays.iter().flatten() {
        let head = array.head();
        if kinds.iter().all(|known| known.0 != head) {
            kinds.push((head, array));
        }
    }
    let mut joined = Vec::new();
    for (head, first) in kinds {
        let same = arrays.iter().filter_map(|own| own.iter().find(|array| array.head() == head));
        let same: Vec<Stored> = same.map(|array| array.stored.clone()).collect();
        if same.len() == arrays.len() {
            joined.push(boxes.array(first, same));
        } else {
            dataset.warnings.push(format!(
                "The array '{}' is left out: not all parts of the adaptive grid have it.",
                head.name
            ));
        }
    }
    let counts = [lattice.point_count() as u64, lattice.boxes.len() as u64];
    let piece = Piece::new(counts, Geometry::Adaptive(lattice), joined);
    dataset.pieces.push(Piece { blocks: CellBlocks::Runs(runs), ..piece });
    Ok(())
}

impl Boxes {
    /// An array of all parts, from those of each.
    fn array(self: &Arc<Self>, first: &PieceArray, own: Vec<Stored>) -> PieceArray {
        let (boxes, n, association) = (self.clone(), first.stored.component_count, first.association);
        let count = match association {
            Association::Cell => self.lattice.boxes.len(),
            Association::Point => self.lattice.point_count(),
        } as u64;
        let compute: Compute = Arc::new(move |meter| {
            let bytes = count.saturating_mul(n as u64).saturating_mul(2 * size_of::<f64>() as u64);
            refuse_beyond_memory(meter.progress(), || counted(count, "value"), bytes)?;
            match association {
                Association::Cell => boxes.cell_values(&own, n, meter),
                Association::Point => boxes.point_values(&own, n, meter),
            }
        });
        let Stored { source, name, number_type, .. } = &first.stored;
        let stored = Stored::of_f64(source, name, n, count, Encoding::Computed(compute));
        let stored = Stored { number_type: *number_type, ..stored };
        PieceArray { component_names: first.component_names.clone(), ..PieceArray::new(association, stored) }
    }

    /// Values of the boxes, part by part.
    fn cell_values(&self, own: &[Stored], n: usize, meter: &Meter) -> Result<Vec<f64>> {
        let of_part = |(stored, part): (&Stored, &Part)| -> Result<Vec<f64>> {
            let values: Vec<f64> = stored.load(meter)?;
            Ok(part.tuples.iter().flat_map(|&tuple| &values[tuple as usize * n..][..n]).copied().collect())
        };
        Ok(all_or_first(own.par_iter().zip(&self.parts).map(of_part))?.concat())
    }

    /// Values at the points: those of the finest box where boxes of several sizes meet.
    fn point_values(&self, own: &[Stored], n: usize, meter: &Meter) -> Result<Vec<f64>> {
        let own: Vec<Vec<f64>> = all_or_first(own.par_iter().map(|stored| stored.load(meter)))?;
        let mut values = vec![f64::NAN; self.lattice.point_count() * n];
        let mut next = 0;
        let mut order: Vec<(&Part, &Vec<f64>, usize)> = Vec::new();
        for (part, own) in self.parts.iter().zip(&own) {
            order.push((part, own, next));
            next += part.tuples.len();
        }
        order.sort_by_key(|(part, ..)| Reverse(part.points.size));
        for (part, own, first) in order {
            for number in first..first + part.tuples.len() {
                for corner in 0..8 {
                    let from = part.points.number(self.lattice.boxes[number].corner(corner));
                    let to = self.lattice.corners[8 * number + corner] as usize;
                    values[to * n..][..n].copy_from_slice(&own[from * n..][..n]);
                }
            }
        }
        Ok(values)
    }
}
