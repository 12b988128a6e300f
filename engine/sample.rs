//! A frame ready for the compositor: the projection of one sample of every pixel, and how segments are shaded.

use crate::attribute::Attribute;
use crate::cells::Cells;
use crate::fragments::batch::Batch;
use crate::fragments::ends::Ends;
use crate::project::cell64::{Cell64, Crossing64};
use crate::project::part::{Input, ProjectPart, ProjectedPart};
use crate::project::record::{AttributeRecord, Record, TILE};
use crate::shade::shader::Shader;
use crate::view::{Seen, View};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};
use voltet_core::camera::Camera;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// Bits of a record's number within its part; the part's number stands above.
const INDEX_BITS: u32 = 24;

/// The projection of one sample of every pixel.
#[derive(Debug)]
pub(crate) struct Sample {
    pub view: View,
    pub seen: std::sync::Arc<Vec<Seen>>,
    lanes: voltet_lanes::LaneSet,
    parts: Vec<ProjectedPart>,
    tiles_wide: usize,
    /// `tile_starts[t] .. tile_starts[t + 1]` are tile t's entries.
    tile_starts: Vec<u32>,
    /// Records by tile, in grid order.
    entries: Vec<u32>,
    cells64: Vec<Cell64>,
    /// Their numbers by tile.
    tiles64: Vec<Vec<u32>>,
    distance_origin: f64,
    near: Option<[f32; 3]>,
    /// Most optical depth of a ray through all of the grid.
    pub deepest: f64,
    pub attribute_count: usize,
}

/// What the compositor reads.
pub(crate) struct Frame<'a> {
    pub view: View,
    pub tiles_wide: usize,
    pub attribute_count: usize,
    /// Attributes that widgets look at.
    pub scalar_count: usize,
    pub shader: &'a Shader,
    /// The lane set the kernels run on.
    pub lanes: voltet_lanes::LaneSet,
    /// Whether each pixel's segments are sorted.
    pub sorted: bool,
    pub distance_origin: f64,
    /// See [`crate::fragments::crossing::Group::evaluate`].
    pub near: Option<[f32; 3]>,
    /// Where the ray of every pixel ends, row by row: depth along the view direction, world units.
    pub ends: Option<&'a [f32]>,
    sample: &'a Sample,
    tetrahedra: &'a [[u32; 4]],
    /// What widgets look at, then the gradient where it is looked at.
    attributes: &'a [Attribute<'a>],
}

impl Sample {
    /// Projects the kept cells. `densest`: see [`Input::densest`].
    pub fn new(
        cells: &Cells,
        camera: &Camera,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        densest: f64,
        progress: &dyn Progress,
    ) -> Result<Sample> {
        let grid = &cells.volume.grid;
        let view = View::new(camera, cells.length, offset)?;
        // The cull stage saw the points already, unless this is another camera or another sample.
        let seen = match &cells.seen {
            Some((seen_camera, seen)) if seen_camera == camera && offset == [0.0; 2] => seen.clone(),
            _ => std::sync::Arc::new(view.see(&grid.points).0),
        };
        let (tiles_wide, tiles_high) = (view.size[0].div_ceil(TILE), view.size[1].div_ceil(TILE));
        let nearest = seen.par_iter().with_min_len(1 << 14).map(|s| s.z).reduce(|| f64::INFINITY, f64::min);
        let distance_origin = nearest.max(view.near).max(0.0);
        let input = Input {
            view: &view,
            seen: &seen,
            tetrahedra: &grid.tetrahedra,
            attributes,
            distance_origin,
            densest,
            tiles_wide,
            tiles_high,
        };

        let kept = cells.kept.as_slice();
        let wished = (rayon::current_num_threads() * 4).max(kept.len().div_ceil(1 << INDEX_BITS)).min(256);
        let part_length = kept.len().div_ceil(wished).max(1);
        if part_length > 1 << INDEX_BITS {
            return Err(Error::run("too many cells for one picture")
                .found(kept.len())
                .accepted("4 thousand million"));
        }
        let lane_set = cells.lanes;
        let mut parts: Vec<ProjectedPart> = Vec::new();
        kept.par_chunks(part_length)
            .map(|cells| {
                let mut part = ProjectedPart::default();
                voltet_lanes::dispatch(lane_set, ProjectPart { input, cells, part: &mut part });
                part
            })
            .collect_into_vec(&mut parts);
        if progress.cancelled() {
            return Err(Error::cancelled());
        }

        // Where each part's entries of each tile go: grid order within a tile.
        let tile_count = tiles_wide * tiles_high;
        let mut tile_starts = Vec::with_capacity(tile_count + 1);
        let mut next: Vec<Vec<u32>> = parts.iter().map(|_| Vec::with_capacity(tile_count)).collect();
        let mut sum = 0u64;
        for tile in 0..tile_count {
            tile_starts.push(sum as u32);
            for (part, next) in parts.iter().zip(&mut next) {
                next.push(sum as u32);
                sum += u64::from(part.tile_counts[tile]);
            }
        }
        if sum > u64::from(u32::MAX) {
            return Err(Error::run("the picture has too many cells in its tiles")
                .found(sum)
                .accepted("at most 4 thousand million; draw a part of the grid or a smaller picture"));
        }
        tile_starts.push(sum as u32);
        let mut entries = vec![0u32; sum as usize];
        let out = shared(&mut entries);
        parts.par_iter().zip(next.par_iter_mut()).enumerate().for_each(|(number, (part, next))| {
            for (index, rectangle) in part.tiles.iter().enumerate() {
                let entry = (number << INDEX_BITS | index) as u32;
                for ty in rectangle[1]..rectangle[3] {
                    for tx in rectangle[0]..rectangle[2] {
                        let place = &mut next[ty as usize * tiles_wide + tx as usize];
                        out[*place as usize].store(entry, Ordering::Relaxed);
                        *place += 1;
                    }
                }
            }
        });

        let cells64: Vec<Cell64> = parts
            .iter()
            .flat_map(|part| &part.cells64)
            .filter_map(|&id| {
                let corners = grid.tetrahedra[id as usize].map(|p| grid.points[p as usize]);
                Cell64::new(&view, id, corners)
            })
            .collect();
        let mut tiles64 = vec![Vec::new(); if cells64.is_empty() { 0 } else { tile_count }];
        for (k, cell) in cells64.iter().enumerate() {
            let [x0, y0, x1, y1] = cell.bounds;
            for ty in y0 / TILE..y1.div_ceil(TILE) {
                for tx in x0 / TILE..x1.div_ceil(TILE) {
                    tiles64[ty * tiles_wide + tx].push(k as u32);
                }
            }
        }
        let near = (nearest < view.near && (!view.perspective || view.near > 0.0)).then(|| {
            // From the distance, not the depth: far from the eye, depth / near − 1 has no digits left in 32 bits.
            let scale = if view.perspective { 1.0 / view.near } else { 1.0 };
            let past = distance_origin - view.near;
            [scale as f32, (past * scale) as f32, -past as f32]
        });
        Ok(Sample {
            view,
            seen,
            lanes: lane_set,
            parts,
            tiles_wide,
            tile_starts,
            entries,
            cells64,
            tiles64,
            distance_origin,
            near,
            deepest: densest * f64::sqrt(3.0),
            attribute_count: attributes.len(),
        })
    }

    /// Records, and cells drawn in 64 bits.
    pub fn cell_count(&self) -> u64 {
        (self.parts.iter().map(|part| part.records.len()).sum::<usize>() + self.cells64.len()) as u64
    }

    /// Tiles that hold anything, fullest first.
    pub fn queue(&self) -> Vec<u32> {
        let fill = |tile: usize| {
            let cells64 = self.tiles64.get(tile).map_or(0, Vec::len);
            (self.tile_starts[tile + 1] - self.tile_starts[tile]) as usize + 16 * cells64
        };
        let mut queue: Vec<u32> =
            (0..self.tile_starts.len() - 1).filter(|&t| fill(t) > 0).map(|t| t as u32).collect();
        queue.sort_by_key(|&t| std::cmp::Reverse(fill(t as usize)));
        queue
    }
}

/// Numbers that several threads write, each at places of its own.
fn shared(values: &mut [u32]) -> &[AtomicU32] {
    // SAFETY: an atomic has the size, the alignment and the bits of its number, and nobody else holds the slice meanwhile.
    unsafe { &*(std::ptr::from_mut(values) as *const [AtomicU32]) }
}

impl<'a> Frame<'a> {
    pub fn new(
        sample: &'a Sample,
        tetrahedra: &'a [[u32; 4]],
        attributes: &'a [Attribute<'a>],
        scalar_count: usize,
        shader: &'a Shader,
        sorted: bool,
    ) -> Frame<'a> {
        Frame {
            view: sample.view,
            tiles_wide: sample.tiles_wide,
            attribute_count: sample.attribute_count,
            scalar_count,
            shader,
            lanes: sample.lanes,
            sorted,
            distance_origin: sample.distance_origin,
            near: sample.near,
            ends: None,
            sample,
            tetrahedra,
            attributes,
        }
    }

    /// Where the rays of a tile's pixels end, for [`crate::fragments::ends::cut`]; nothing where none does.
    pub fn ends_of(&self, left: usize, top: usize, ends: &mut Ends) {
        let (Some(all), [width, height]) = (self.ends, self.view.size) else { return };
        for (pixel, end) in ends.iter_mut().enumerate() {
            let (i, j) = (left + pixel % TILE, top + pixel / TILE);
            if i < width && j < height {
                *end = (f64::from(all[j * width + i]) / self.view.length - self.distance_origin) as f32;
            }
        }
    }

    #[inline(always)]
    pub fn entries_of(&self, tile: usize) -> &'a [u32] {
        &self.sample.entries
            [self.sample.tile_starts[tile] as usize..self.sample.tile_starts[tile + 1] as usize]
    }

    #[inline(always)]
    pub fn record(&self, entry: u32) -> (&'a Record, &'a [AttributeRecord], [&'a Seen; 4]) {
        let part = &self.sample.parts[(entry >> INDEX_BITS) as usize];
        let index = (entry & ((1 << INDEX_BITS) - 1)) as usize;
        let n = self.attribute_count;
        let corners = part.corners[index];
        let seen = &self.sample.seen;
        (&part.records[index], &part.attributes[index * n..][..n], corners.map(|p| &seen[p as usize]))
    }

    /// Nearest depth of a record's cell, from the distance origin.
    #[inline(always)]
    pub fn nearest(&self, entry: u32) -> f32 {
        let part = &self.sample.parts[(entry >> INDEX_BITS) as usize];
        part.nearest[(entry & ((1 << INDEX_BITS) - 1)) as usize]
    }

    /// Asks for a record's cache lines before they are needed: a tile's cells lie scattered over the parts.
    #[inline(always)]
    pub fn prefetch(&self, entry: u32) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            let part = &self.sample.parts[(entry >> INDEX_BITS) as usize];
            let index = (entry & ((1 << INDEX_BITS) - 1)) as usize;
            // SAFETY: a prefetch reads nothing; any address is allowed.
            unsafe {
                _mm_prefetch::<_MM_HINT_T0>(part.records.as_ptr().wrapping_add(index).cast());
                _mm_prefetch::<_MM_HINT_T0>(part.corners.as_ptr().wrapping_add(index).cast());
                let attributes = part.attributes.as_ptr().wrapping_add(index * self.attribute_count);
                _mm_prefetch::<_MM_HINT_T0>(attributes.cast());
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = entry;
    }

    /// The same for its corners' places in the picture, once its record is near.
    #[inline(always)]
    pub fn prefetch_corners(&self, entry: u32) {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
            let part = &self.sample.parts[(entry >> INDEX_BITS) as usize];
            for corner in part.corners[(entry & ((1 << INDEX_BITS) - 1)) as usize] {
                // SAFETY: a prefetch reads nothing; any address is allowed.
                unsafe {
                    _mm_prefetch::<_MM_HINT_T0>(
                        self.sample.seen.as_ptr().wrapping_add(corner as usize).cast(),
                    );
                }
            }
        }
        #[cfg(not(target_arch = "x86_64"))]
        let _ = entry;
    }

    pub fn cells64_of(&self, tile: usize) -> impl Iterator<Item = &'a Cell64> {
        let numbers = self.sample.tiles64.get(tile).map_or(&[][..], Vec::as_slice);
        numbers.iter().map(|&k| &self.sample.cells64[k as usize])
    }

    /// Puts the segment of a cell that was crossed in 64 bits in place `k` of a batch, to be shaded like any other.
    pub fn put64(
        &self,
        cell: &Cell64,
        crossing: &Crossing64,
        [i, j]: [usize; 2],
        k: usize,
        batch: &mut Batch,
    ) {
        let corners = self.tetrahedra[cell.id as usize].map(|p| p as usize);
        let [entry, exit] = crossing.depth;
        batch.pixel[k] = ((j % TILE) << 4 | (i % TILE)) as u32;
        batch.length[k] = ((exit - entry) * self.view.stretch(i as f64, j as f64)) as f32;
        batch.entry[k] = (entry - self.distance_origin) as f32;
        batch.exit[k] = (exit - self.distance_origin) as f32;
        for (a, attribute) in self.attributes.iter().enumerate() {
            // Relative to one corner, so that values near 1e8 keep their differences.
            let base = attribute.at(corners[0]);
            let [front, back] = crossing.weights.map(|weights| {
                let above =
                    weights.iter().zip(corners).map(|(w, p)| w * (attribute.at(p) - base)).sum::<f64>();
                (((base - attribute.offset) + above) / attribute.scale) as f32
            });
            (batch.front[a][k], batch.back[a][k]) = (front, back);
        }
    }
}
