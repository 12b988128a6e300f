//! Parts of formats whose points and cells are made by code: geometry that is read when it is asked for, numbers by tags, cells
//! gathered one by one.

use super::contents::{Geometry, OpenPiece};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use voltet_core::grid::code::TETRA;
use voltet_core::grid::{CellSet, Cells};
use voltet_core::progress::Progress;
use voltet_core::reading::{GridHead, GridRead, OpenGrid};
use voltet_core::{Error, Result};

use glam::DVec3;

type ReadGeometry = Box<dyn Fn(&dyn Progress) -> Result<(Vec<DVec3>, Cells)> + Send + Sync>;

/// Points and cells that a function reads when they are asked for.
struct LazyGrid {
    head: GridHead,
    read: ReadGeometry,
}

impl OpenGrid for LazyGrid {
    fn head(&self) -> &GridHead {
        &self.head
    }

    fn read(&self, geometry: bool, _: &[usize], progress: &dyn Progress) -> Result<GridRead> {
        let (points, cells) = if geometry { Some((self.read)(progress)?).unzip() } else { (None, None) };
        Ok(GridRead { points, cells, ..GridRead::default() })
    }
}

/// Geometry that a function reads, of so many points, cells, and points of cells.
pub(super) fn geometry(
    counts: [u64; 3],
    read: impl Fn(&dyn Progress) -> Result<(Vec<DVec3>, Cells)> + Send + Sync + 'static,
) -> Geometry {
    let open = LazyGrid { head: mesh_head(counts), read: Box::new(read) };
    Geometry::Open(Arc::new(OpenPiece::new(Arc::new(open))))
}

/// The head of so many points, cells, and points of cells.
pub(super) fn mesh_head([point_count, cell_count, corner_count]: [u64; 3]) -> GridHead {
    // A type, an offset and the points.
    let cell_bytes = cell_count.saturating_mul(9).saturating_add(corner_count.saturating_mul(4));
    GridHead { point_count, cell_count, cell_bytes, ..GridHead::default() }
}

/// Numbers from 0 of things that a file numbers in its own way.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Tags {
    /// Tags in ascending order.
    sorted: Vec<u64>,
    /// Their numbers; empty where these ascend, too.
    numbers: Vec<u32>,
    /// True if the tags ascend by one and so do their numbers.
    is_without_gaps: bool,
}

impl Tags {
    /// By the tags in their order in the file; `own_number` of a tag is what the file says. Errors: `what` is there twice, or too often.
    pub fn new(tags: Vec<u64>, what: &str, own_number: impl Fn(u64) -> u64) -> Result<Tags> {
        let count = u32::try_from(tags.len())
            .map_err(|_| Error::run(format!("the file holds too many {what}s")).got(tags.len()))?;
        let ascends = |from: usize| {
            let part = &tags[from..tags.len().min(from + PART + 1)];
            part.windows(2).fold(true, |all, pair| all & (pair[0] < pair[1]))
        };
        if (0..tags.len().div_ceil(PART)).into_par_iter().all(|part| ascends(part * PART)) {
            let span = tags.last().zip(tags.first()).map_or(0, |(last, first)| last - first);
            let is_without_gaps = span < u64::from(count);
            return Ok(Tags { sorted: tags, numbers: Vec::new(), is_without_gaps });
        }
        let mut numbers: Vec<u32> = (0..count).collect();
        numbers.par_sort_by_key(|&number| tags[number as usize]);
        let sorted = numbers.iter().map(|&number| tags[number as usize]).collect();
        let tags = Tags { sorted, numbers, is_without_gaps: false };
        match tags.sorted.windows(2).find(|pair| pair[0] == pair[1]) {
            None => Ok(tags),
            Some(pair) => Err(Error::run(format!("the file holds a {what} twice"))
                .got(format_args!("{what} {}", own_number(pair[0])))
                .expected(format_args!("each {what} once"))),
        }
    }

    pub fn len(&self) -> usize {
        self.sorted.len()
    }

    pub fn find(&self, tag: u64) -> Option<usize> {
        // Most files number without gaps.
        let first = self.sorted.first()?;
        let guess = usize::try_from(tag.checked_sub(*first)?).ok()?;
        if self.is_without_gaps {
            return (guess < self.sorted.len()).then_some(guess);
        }
        let place = match self.sorted.get(guess) {
            Some(&found) if found == tag => guess,
            _ => self.sorted.binary_search(&tag).ok()?,
        };
        Some(self.numbers.get(place).map_or(place, |&number| number as usize))
    }
}

/// Tags of the nodes (0) and of the selected elements (1) of a mesh, once they were read.
#[derive(Default)]
pub(super) struct MeshTags(Mutex<[Option<Arc<Tags>>; 2]>);

impl MeshTags {
    pub fn keep(&self, kind: usize, tags: Tags) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)[kind] = Some(Arc::new(tags));
    }

    /// Tags of a kind; where there are none yet, `read` reads and keeps them.
    pub fn get(&self, kind: usize, read: impl FnOnce() -> Result<()>) -> Result<Arc<Tags>> {
        let kept = || self.0.lock().unwrap_or_else(PoisonError::into_inner)[kind].clone();
        if let Some(tags) = kept() {
            return Ok(tags);
        }
        read()?;
        kept().ok_or_else(|| Error::run("the numbers of the mesh were not kept"))
    }
}

pub(super) fn missing_node(element: u64, node: u64) -> Error {
    let error = Error::run(format!("element {element} names a node that does not exist"));
    error.got(node).expected("the number of a node of the file")
}

/// Numbers that one task looks at.
const PART: usize = 1 << 14;

/// Makes numbers of 1 to `count` such from 0 on; notes if some are none of these, which are then not below `count`.
pub(super) fn count_from_zero(numbers: &mut [u32], count: u64, is_wrong: &AtomicBool) {
    let is_some_wrong = numbers.iter_mut().fold(false, |is_wrong, number| {
        *number = number.wrapping_sub(1);
        is_wrong | (u64::from(*number) >= count)
    });
    is_wrong.fetch_or(is_some_wrong, Ordering::Relaxed);
}

pub(super) fn tetrahedra(corners: Vec<u32>) -> Cells {
    let copied = |(_, corners): (_, Vec<u32>)| corners.as_chunks().0.to_vec();
    let tetrahedra: Vec<[u32; 4]> = bytemuck::try_cast_vec(corners).unwrap_or_else(copied);
    Cells::Tetrahedra(tetrahedra.into())
}

/// The cells of parts, one part after the other.
pub(super) fn joined(parts: Vec<CellSet>) -> Cells {
    let corner_count = parts.iter().map(|part| part.connectivity.len()).sum();
    if corner_count == 0 || !parts.iter().all(are_tetrahedra) {
        let mut all = CellSet::default();
        parts.into_iter().for_each(|part| all.append(part, |point| point));
        return into_cells(all);
    }
    let mut corners = vec![0; corner_count];
    let (mut rest, mut places) = (&mut corners[..], Vec::new());
    for part in &parts {
        let (own, after) = rest.split_at_mut(part.connectivity.len());
        places.push(own);
        rest = after;
    }
    let copies = places.into_par_iter().zip(&parts);
    copies.for_each(|(to, part)| to.copy_from_slice(&part.connectivity));
    tetrahedra(corners)
}

/// All cells of a set; as tetrahedra where they are nothing else.
pub(super) fn into_cells(set: CellSet) -> Cells {
    if set.types.is_empty() || !are_tetrahedra(&set) {
        return Cells::Mixed(set);
    }
    tetrahedra(set.connectivity)
}

/// True if none is anything else.
fn are_tetrahedra(CellSet { types, connectivity, .. }: &CellSet) -> bool {
    let is_part = |part: &[u8]| part.iter().fold(true, |all, &code| all & (code == TETRA));
    types.par_chunks(PART).all(is_part) && connectivity.len() == 4 * types.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_that_ascend_are_numbered_as_others() {
        let count = 3 * PART as u64 + 1;
        let plain: Vec<u64> = (7..7 + count).collect();
        for (gap, swapped) in [(None, false), (Some(PART), false), (Some(2 * PART - 1), true)] {
            let mut tags = plain.clone();
            gap.into_iter().for_each(|gap| tags[gap..].iter_mut().for_each(|tag| *tag += 5));
            if swapped {
                tags.swap(PART - 1, PART);
            }
            let found = Tags::new(tags.clone(), "node", |tag| tag).unwrap();
            assert_eq!(found.is_without_gaps, gap.is_none());
            assert!((0..tags.len()).all(|number| found.find(tags[number]) == Some(number)));
            let last = tags[tags.len() - 1];
            assert_eq!([6, last + 1].map(|tag| found.find(tag)), [None; 2]);
            if let Some(gap) = gap {
                assert_eq!(found.find(tags[gap] - 1), None);
            }
        }
        // The second one of two that are the same begins a part.
        for place in [1, PART, 2 * PART] {
            let mut tags = plain.clone();
            tags[place] = tags[place - 1];
            let found = Tags::new(tags.clone(), "node", |tag| tag).unwrap_err().to_string();
            let words = ["holds a node twice".to_owned(), format!("node {}", tags[place])];
            assert!(words.iter().all(|word| found.contains(word)), "{found}");
        }
    }
}
