//! Adaptive mesh refinement in patches: boxes of equal cells, of several levels, of which the finer ones lie over the coarser.
//!
//! The size of its cells tells the level of a box. Cells of a box that lie under a finer box are left out, so that each place belongs to
//! one cell. Finer boxes begin and end with cells of the coarser levels.

use super::adaptive::{self, BoxPoints, Part};
use super::contents::{Compute, Dataset, Encoding, GHOST_TYPE, Meter, PieceArray, Stored};
use super::lattice::{Axis, HeaderProgress, LatticeBox, refuse_too_many};
use glam::DVec3;
use rayon::prelude::*;
use std::collections::HashMap;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use voltet_core::grid::Association;
use voltet_core::parallel::all_or_first;
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::{Error, Result, counted};

/// A box of equal cells.
pub(super) struct Patch {
    /// Number and name of its block.
    pub block: usize,
    pub name: String,
    /// Low corner, world units.
    pub origin: DVec3,
    pub spacing: DVec3,
    /// Cells along each axis.
    pub cells: [u64; 3],
    pub arrays: Vec<PieceArray>,
}

impl Patch {
    /// Errors: it has no volume, is of a damaged size, or larger than its file can hold.
    pub fn checked(self) -> Result<Patch> {
        self.check().map_err(|error| error.at_item(&self.name))?;
        Ok(self)
    }

    fn cells_along(&self) -> DVec3 {
        DVec3::from_array(self.cells.map(|n| n as f64))
    }

    /// First cell along each axis that is no ghost, and the end of those; none where all are ghosts.
    fn own_cells(&self) -> Result<Option<[[u32; 3]; 2]>> {
        let cells = self.cells.map(|n| n as u32);
        let Some(flags) = self.arrays.iter().find(|array| is_flags(array)) else {
            return Ok(Some([[0; 3], cells]));
        };
        let flags: Vec<u8> = flags.stored.load(&Meter::new(&HeaderProgress, 1))?;
        let own = (0_u32..).zip(&flags).filter(|(_, flags)| **flags & DUPLICATE_CELL == 0);
        let [nx, ny, _] = cells;
        let bounds = own.fold([[u32::MAX; 3], [0; 3]], |[low, end], (cell, _)| {
            let at = [cell % nx, cell / nx % ny, cell / nx / ny];
            let of = |axis: usize| (low[axis].min(at[axis]), end[axis].max(at[axis] + 1));
            let [(a, d), (b, e), (c, f)] = [of(0), of(1), of(2)];
            [[a, b, c], [d, e, f]]
        });
        Ok((bounds[1][0] > 0).then_some(bounds))
    }

    fn has_flags(&self) -> bool {
        self.arrays.iter().any(is_flags)
    }

    fn check(&self) -> Result<()> {
        let Patch { origin, spacing, cells, arrays, .. } = self;
        if cells.contains(&0) {
            let error =
                Error::run("the file holds no three-dimensional cells, so there is no volume to draw");
            return Err(error.got("a patch without thickness").expected("patches of cells with a volume"));
        }
        if !(spacing.is_finite() && spacing.min_element() > 0.0 && origin.is_finite()) {
            let error = Error::run("the place or the size of the cells is damaged");
            return Err(error
                .got(format_args!("origin {origin}, spacing {spacing}"))
                .expected("a positive spacing"));
        }
        let count = cells.iter().try_fold(1_u64, |product, &n| product.checked_mul(n));
        if count.is_none_or(|count| count > u64::from(u32::MAX / 8)) {
            return Err(Error::run("the patch cannot be that large").got(format_args!("{cells:?} cells")));
        }
        // The cells are believed once an array may have values for them.
        if arrays.is_empty() {
            return Err(Error::run("the patch holds no arrays").expected("values of its cells or points"));
        }
        arrays.iter().try_for_each(|array| array.stored.check_backing())
    }
}

/// A patch on the lattice of the finest cells.
struct LatticePatch {
    low: [u32; 3],
    end: [u32; 3],
    size: u32,
    /// Low and high corner of what it covers: its cells but the ghosts around them; none where all are ghosts.
    covers: Option<[[u32; 3]; 2]>,
}

/// Part of a cell by which the cells of patches may differ in place or size: positions of 32 bits, over thousands of cells.
const MAX_OFFSET: f64 = 1e-3;

/// Cell flags of ghosts, of cells under finer ones, and of hidden cells (vtkDataSetAttributes).
const DUPLICATE_CELL: u8 = 1;
const REFINED_CELL: u8 = 8;
const HIDDEN_CELL: u8 = 32;

#[derive(Clone, Copy)]
struct FlagOptions {
    /// True if all patches of the file are read.
    is_whole: bool,
    has_flags: bool,
}

/// Adds the cells of patches as a piece. `is_whole`: the patches are all of the file; else its flags of cells under finer ones, which may
/// not be read, are passed over.
pub(super) fn add(dataset: &mut Dataset, patches: Vec<Patch>, is_whole: bool) -> Result<()> {
    let all: u64 =
        patches.iter().map(|patch| patch.cells.iter().product::<u64>()).fold(0, u64::saturating_add);
    // A mark of each, and before it the flags of a patch.
    refuse_beyond_memory(&HeaderProgress, || counted(all, "cell"), all.saturating_mul(2))?;
    let (placed, axes) = place(&patches)?;
    let finer = FinerPatches::new(&placed);
    let named =
        |(own, patch): (&LatticePatch, &Patch)| finer.over(own).map_err(|error| error.at_item(&patch.name));
    let covered: Vec<Vec<bool>> = all_or_first(placed.par_iter().zip(&patches).map(named))?;
    let covered_count: u64 = covered.iter().flatten().map(|&is_covered| u64::from(is_covered)).sum();
    refuse_too_many(all - covered_count, Part::BYTES_PER_BOX)?;
    let options = FlagOptions { is_whole, has_flags: patches.iter().any(Patch::has_flags) };
    let parts = patches.iter().zip(&placed).zip(&covered);
    let parts = parts.filter_map(|((patch, own), covered)| part(patch, own, covered, options)).collect();
    if covered_count > 0 {
        dataset.notes.push(format!("{} under finer ones, left out", counted(covered_count, "cell")));
    }
    adaptive::add(dataset, axes, parts)
}

/// Places patches on the lattice of the finest cells, and makes its axes.
fn place(patches: &[Patch]) -> Result<(Vec<LatticePatch>, [Axis; 3])> {
    let by_size = |a: &&Patch, b: &&Patch| a.spacing.x.total_cmp(&b.spacing.x);
    let (finest, coarsest) = (patches.iter().min_by(by_size), patches.iter().max_by(by_size));
    let Some((finest, coarsest)) = finest.zip(coarsest) else {
        return Err(Error::run("the adaptive grid holds no patches"));
    };
    let step = finest.spacing;
    // Low corner in lattice cells from that of a coarsest patch, and the size of the cells.
    let on_lattice = |patch: &Patch| -> Option<([i64; 3], i64)> {
        let (size, low) = (patch.spacing / step, (patch.origin - coarsest.origin) / step);
        let is_near = |exact: DVec3| (exact - exact.round()).abs().max_element() < MAX_OFFSET * size.x;
        let fits = is_near(size) && is_near(low) && low.abs().max_element() < f64::from(u32::MAX);
        let size = size.round();
        let low = low.round();
        // The high corner lies as many cells on: a size that is off a little would move it.
        let high = (patch.origin + patch.spacing * patch.cells_along() - coarsest.origin) / step;
        let is_whole = (high - (low + size * patch.cells_along())).abs().max_element() < MAX_OFFSET * size.x;
        let is_level = is_whole && size == DVec3::splat(size.x) && (low / size).fract() == DVec3::ZERO;
        (fits && size.x < f64::from(u32::MAX) && is_level)
            .then_some((low.to_array().map(|low| low as i64), size.x as i64))
    };
    let mut lows = Vec::new();
    for patch in patches {
        let off = || {
            let error = Error::run("the patches do not lie on one lattice").at_item(&patch.name);
            error
                .got(format_args!("a corner at {} and cells of {}", patch.origin, patch.spacing))
                .expected(format_args!(
                    "whole multiples of the finest cells, {step}, and of its own, from the corner {} of '{}' on",
                    coarsest.origin, coarsest.name
                ))
        };
        lows.push(on_lattice(patch).ok_or_else(off)?);
    }
    let greatest = lows.iter().map(|own| own.1).max().unwrap_or(1);
    let first: [i64; 3] = std::array::from_fn(|axis| {
        let low = lows.iter().map(|own| own.0[axis]).min().unwrap_or(0);
        low.div_euclid(greatest) * greatest
    });
    let mut placed = Vec::new();
    for (patch, (low, size)) in patches.iter().zip(&lows) {
        let low: [i64; 3] = std::array::from_fn(|axis| low[axis] - first[axis]);
        let end =
            |axis: usize| i64::try_from(patch.cells[axis]).ok()?.checked_mul(*size)?.checked_add(low[axis]);
        let end = [end(0), end(1), end(2)].map(|end| end.and_then(|end| u32::try_from(end).ok()));
        let ([Some(x), Some(y), Some(z)], Ok(size)) = (end, u32::try_from(*size)) else {
            let error =
                Error::run("the lattice of the finest cells cannot be that large").at_item(&patch.name);
            return Err(error.expected(format_args!("at most {} along an axis", u32::MAX)));
        };
        let low = low.map(|low| low as u32);
        let own = patch.own_cells().map_err(|error| error.at_item(&patch.name))?;
        let covers = own.map(|ends| ends.map(|at| std::array::from_fn(|axis| low[axis] + size * at[axis])));
        placed.push(LatticePatch { low, end: [x, y, z], size, covers });
    }
    let axis = |axis: usize| {
        let parts = placed.iter().map(|own| own.end[axis]).max().unwrap_or(1);
        let at = |index: i64| coarsest.origin[axis] + step[axis] * index as f64;
        Axis { coordinates: vec![at(first[axis]), at(first[axis] + i64::from(parts))], parts }
    };
    let axes = [axis(0), axis(1), axis(2)];
    Ok((placed, axes))
}

/// Patches by the size of their cells, the finest first, and of one size by their low end along z.
struct FinerPatches<'a> {
    patches: Vec<&'a LatticePatch>,
    /// Each size, the end of its patches, and the greatest extent of one along z.
    sizes: Vec<(u32, usize, u32)>,
    /// Cells of which a finer patch covers a part, so far.
    parts: AtomicU64,
}

/// Bytes of such a cell: its entry in a map and the first boxes of its list.
const BYTES_PER_COVERED_PART: u64 = 160;

impl<'a> FinerPatches<'a> {
    fn new(all: &'a [LatticePatch]) -> FinerPatches<'a> {
        let mut patches: Vec<&LatticePatch> = all.iter().filter(|patch| patch.covers.is_some()).collect();
        patches.sort_by_key(|patch| (patch.size, patch.low[2]));
        let mut sizes: Vec<(u32, usize, u32)> = Vec::new();
        for (end, patch) in (1..).zip(&patches) {
            let extent = patch.end[2] - patch.low[2];
            match sizes.last_mut().filter(|last| last.0 == patch.size) {
                Some(last) => (last.1, last.2) = (end, last.2.max(extent)),
                None => sizes.push((patch.size, end, extent)),
            }
        }
        FinerPatches { patches, sizes, parts: AtomicU64::new(0) }
    }

    /// For each cell of a patch: true where finer patches lie over it; empty where none does.
    ///
    /// Errors: a finer patch begins or ends within a cell of which others do not cover the rest; memory would end.
    fn over(&self, own: &LatticePatch) -> Result<Vec<bool>> {
        let cells: [usize; 3] =
            std::array::from_fn(|axis| ((own.end[axis] - own.low[axis]) / own.size) as usize);
        let mut covered = Vec::new();
        // Cells of which a finer patch covers a part, and what it covers.
        let mut parts: HashMap<[usize; 3], Vec<LatticeRange>> = HashMap::new();
        // The coarsest first: what lies under one is covered once.
        let finer = self.sizes.partition_point(|(size, ..)| *size < own.size);
        for (index, &(size, end, extent)) in self.sizes[..finer].iter().enumerate().rev() {
            let first = index.checked_sub(1).map_or(0, |before| self.sizes[before].1);
            let same = &self.patches[first..end];
            debug_assert!(same.iter().all(|patch| patch.size == size));
            let from = same.partition_point(|finer| {
                u64::from(finer.low[2]) + u64::from(extent) <= u64::from(own.low[2])
            });
            for finer in same[from..].iter().take_while(|finer| finer.low[2] < own.end[2]) {
                let Some([low, end]) = finer.covers else { continue };
                let low: [u32; 3] = std::array::from_fn(|axis| low[axis].max(own.low[axis]) - own.low[axis]);
                let end: [u32; 3] =
                    std::array::from_fn(|axis| end[axis].min(own.end[axis]).saturating_sub(own.low[axis]));
                if (0..3).any(|axis| low[axis] >= end[axis]) {
                    continue;
                }
                covered.resize(cells.iter().product(), false);
                let outer =
                    |axis: usize| (low[axis] / own.size) as usize..end[axis].div_ceil(own.size) as usize;
                let inner =
                    |axis: usize| low[axis].div_ceil(own.size) as usize..(end[axis] / own.size) as usize;
                let [outer, inner] = [[outer(0), outer(1), outer(2)], [inner(0), inner(1), inner(2)]];
                fill(&mut covered, cells, inner.clone());
                if outer != inner {
                    let count = |ranges: &[Range<usize>; 3]| ranges.iter().map(Range::len).product::<usize>();
                    let shell = (count(&outer) - count(&inner)) as u64;
                    let all = self.parts.fetch_add(shell, Ordering::Relaxed).saturating_add(shell);
                    refuse_beyond_memory(
                        &HeaderProgress,
                        || format!("the look at {} that finer patches cover in part", counted(all, "cell")),
                        all.saturating_mul(BYTES_PER_COVERED_PART),
                    )?;
                    let [x, y, z] = outer;
                    let row = |[j, k]: [usize; 2]| x.clone().map(move |i| [i, j, k]);
                    let rows = z.flat_map(|k| y.clone().map(move |j| [j, k]));
                    let is_part = |cell: &[usize; 3]| !(0..3).all(|axis| inner[axis].contains(&cell[axis]));
                    for cell in rows.flat_map(row).filter(is_part) {
                        let at = cell.map(|at| at as u32 * own.size);
                        let low: [u32; 3] = std::array::from_fn(|axis| low[axis].max(at[axis]));
                        let end: [u32; 3] = std::array::from_fn(|axis| end[axis].min(at[axis] + own.size));
                        let holds = |[first, last]: &LatticeRange| {
                            (0..3).all(|axis| first[axis] <= low[axis] && end[axis] <= last[axis])
                        };
                        let is_whole = covered[cell[0] + cells[0] * (cell[1] + cells[1] * cell[2])];
                        let boxes = (!is_whole).then(|| parts.entry(cell).or_default());
                        if let Some(boxes) = boxes.filter(|boxes| !boxes.iter().any(holds)) {
                            boxes.push([low, end]);
                        }
                    }
                }
            }
        }
        for ([i, j, k], boxes) in parts {
            let is_covered = &mut covered[i + cells[0] * (j + cells[1] * k)];
            let low = [i, j, k].map(|at| at as u32 * own.size);
            if !*is_covered && !cover(&boxes, [low, low.map(|low| low + own.size)]) {
                let error = Error::run("a finer patch begins or ends within a cell of a coarser one");
                return Err(error.expected("finer patches that cover whole cells together"));
            }
            *is_covered = true;
        }
        Ok(covered)
    }
}

/// Low corner of a box on the lattice, and its end.
type LatticeRange = [[u32; 3]; 2];

fn cover(boxes: &[LatticeRange], [low, end]: LatticeRange) -> bool {
    // Between these planes lies what is in a box as a whole or not at all.
    let planes: [Vec<u32>; 3] = std::array::from_fn(|axis| {
        let ends = boxes.iter().flatten().map(|corner| corner[axis]).filter(|at| *at < end[axis]);
        let mut planes: Vec<u32> = ends.map(|at| at.max(low[axis])).chain([low[axis]]).collect();
        planes.sort_unstable();
        planes.dedup();
        planes
    });
    let is_in = |at: [u32; 3]| {
        let holds = |[low, end]: &LatticeRange| (0..3).all(|axis| (low[axis]..end[axis]).contains(&at[axis]));
        boxes.iter().any(holds)
    };
    let [x, y, z] = &planes;
    x.iter().all(|&x| y.iter().all(|&y| z.iter().all(|&z| is_in([x, y, z]))))
}

fn fill(marks: &mut [bool], cells: [usize; 3], [x, y, z]: [Range<usize>; 3]) {
    if x.start >= x.end {
        return;
    }
    for k in z {
        for j in y.clone() {
            marks[cells[0] * (j + cells[1] * k)..][x.clone()].fill(true);
        }
    }
}

/// The cells of a patch that are not covered; `None` where all are.
fn part(patch: &Patch, own: &LatticePatch, covered: &[bool], options: FlagOptions) -> Option<Part> {
    let [nx, ny, nz] = patch.cells.map(|n| n as u32);
    let count = nx * ny * nz;
    let is_own = |&cell: &u32| covered.get(cell as usize) != Some(&true);
    let tuples: Vec<u32> = (0..count).filter(is_own).collect();
    if tuples.is_empty() {
        return None;
    }
    let lattice_box = |&cell: &u32| {
        let index = [cell % nx, cell / nx % ny, cell / nx / ny];
        LatticeBox { low: std::array::from_fn(|axis| own.low[axis] + own.size * index[axis]), size: own.size }
    };
    let mut arrays: Vec<PieceArray> =
        patch.arrays.iter().map(|array| shown(array, options.is_whole)).collect();
    if options.has_flags && !patch.has_flags() {
        arrays.extend(patch.arrays.first().map(|array| no_flags(&array.stored, count as usize)));
    }
    Some(Part {
        block: patch.block,
        boxes: tuples.iter().map(lattice_box).collect(),
        tuples,
        points: BoxPoints { low: own.low, size: own.size, dimensions: [nx + 1, ny + 1, nz + 1] },
        arrays,
    })
}

fn is_flags(array: &PieceArray) -> bool {
    array.association == Association::Cell && array.stored.name == GHOST_TYPE
}

/// Flags of a patch of a file in which others have some; `other`: an array of the patch.
fn no_flags(other: &Stored, count: usize) -> PieceArray {
    let none = move |_: &Meter| Ok(vec![0.0; count]);
    let stored = Stored::computed(&other.source, GHOST_TYPE, 1, count as u64, none);
    PieceArray::new(Association::Cell, stored)
}

/// An array; flags of cells as they hold for patches: ghosts are hidden: other patches have their places, of the same level or of a coarser one.
fn shown(array: &PieceArray, is_whole: bool) -> PieceArray {
    if !is_flags(array) {
        return array.clone();
    }
    let (stored, flags) = (array.stored.clone(), array.stored.clone());
    let compute: Compute = Arc::new(move |meter| {
        let flag = |flags: u8| {
            let hidden = if flags & DUPLICATE_CELL != 0 { HIDDEN_CELL } else { 0 };
            f64::from(hidden | flags & if is_whole { u8::MAX } else { !REFINED_CELL })
        };
        Ok(flags.load::<u8>(meter)?.into_iter().map(flag).collect())
    });
    PieceArray::new(Association::Cell, Stored { encoding: Encoding::Computed(compute), ..stored })
}
