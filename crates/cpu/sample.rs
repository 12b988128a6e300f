//! A frame ready for the compositor: the projection of one sample of every pixel, and how segments are shaded.

use crate::attribute::Attribute;
use crate::cast::{Cast, Limits};
use crate::cells::Cells;
use crate::fragments::batch::Batch;
use crate::fragments::ends::Ends;
use crate::kept::{Keeping, Kept};
use crate::project::area::Area;
use crate::project::cell64::{Cell64, Crossing64};
use crate::project::part::Input;
use crate::project::record::{AttributeRecord, Record, TILE};
use crate::project::tiles::Tiles;
use crate::project::windows::{Window, Windows};
use crate::shade::shader::Shader;
use crate::spare::Spare;
use crate::view::{Seen, View};
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_simd::prefetch;

/// Windows that hold as many cells as are projected at once.
const WINDOWS_AT_ONCE: usize = 8;

/// Cells that are projected at once for tiles where rays are lost.
pub(crate) const LOST_AT_ONCE: usize = 1 << 17;

/// Cells that a window should hold.
pub(crate) fn cells_of_window(most_at_once: usize) -> usize {
    (most_at_once / WINDOWS_AT_ONCE).max(1)
}

/// The projection of one sample of every pixel.
#[derive(Debug)]
pub(crate) struct Sample {
    pub view: View,
    pub seen: Arc<Vec<Seen>>,
    lanes: voltet_simd::LaneSet,
    pub projected: Projected,
    spare: Arc<Spare>,
    /// See [`Input::densest`].
    densest: f64,
    distance_origin: f64,
    near: Option<[f32; 3]>,
    pub attribute_count: usize,
}

/// Cells as far as they are projected before the compositor begins.
#[derive(Debug)]
pub(crate) enum Projected {
    /// All of them.
    Whole(Tiles),
    /// None: who composites a window projects it.
    InWindows(Windows),
    /// None: rays go from cell to cell.
    Cast(Cast),
}

/// What the compositor reads.
#[derive(Clone, Copy)]
pub(crate) struct Frame<'a> {
    pub view: View,
    pub tiles_wide: usize,
    pub attribute_count: usize,
    /// Attributes that widgets look at.
    pub scalar_count: usize,
    pub shader: &'a Shader,
    /// The lane set the kernels run on.
    pub lanes: voltet_simd::LaneSet,
    /// Whether each pixel's segments are sorted.
    pub sorted: bool,
    pub distance_origin: f64,
    /// See [`crate::fragments::crossing::Group::evaluate`].
    pub near: Option<[f32; 3]>,
    /// Rays from cell to cell, in place of tiles of cells.
    pub cast: Option<&'a Cast>,
    /// Segments kept from a picture of this view: what is drawn in place of cells.
    pub kept: Option<&'a Kept>,
    /// What keeps the segments in place of drawing them.
    pub keeping: Option<&'a Keeping>,
    /// Nothing is left out: rays go on behind what is opaque.
    pub whole: bool,
    /// Where the ray of every pixel ends, row by row: depth along the view direction, world units.
    pub ends: Option<&'a [f32]>,
    /// The tiles of windows that are drawn, ascending; `None`: all.
    pub only: Option<&'a [u32]>,
    sample: &'a Sample,
    /// Those of the picture, or of the window that is at hand.
    tiles: &'a Tiles,
    grid: &'a Grid,
    /// What widgets look at, then the gradient where it is looked at.
    attributes: &'a [Attribute<'a>],
}

impl Projected {
    /// Projects the kept cells for an area, or tells them apart by windows of it where they are more than so many.
    ///
    /// Errors: those of [`Tiles::fill_on_all`].
    fn new(cells: &Cells, input: &Input<'_>, most_at_once: usize) -> Result<Projected> {
        let (kept, lanes, points) = (cells.kept.as_slice(), cells.lanes, &cells.volume.grid.points);
        if most_at_once < kept.len() {
            let wished = cells_of_window(most_at_once);
            return Ok(Projected::InWindows(Windows::of(input, lanes, points, kept, wished)));
        }
        let mut tiles = cells.spare.tiles.take();
        tiles.fill_on_all(input, lanes, points, kept)?;
        Ok(Projected::Whole(tiles))
    }
}

impl Sample {
    /// Projects the kept cells, or casts rays through them where the limits are kept. `densest`: see [`Input::densest`].
    pub fn new(
        cells: &Cells,
        camera: &Camera,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        (densest, limits): (f64, Limits),
        progress: &dyn Progress,
    ) -> Result<Sample> {
        let grid = &cells.volume.grid;
        let view = View::new(camera, cells.length, offset)?;
        // The cull stage saw the points already, unless this is another camera or another sample.
        let seen = match &cells.seen {
            Some((seen_camera, seen)) if seen_camera == camera && offset == [0.0; 2] => seen.clone(),
            _ => Arc::new(view.see(&grid.points).0),
        };
        let nearest = seen.par_iter().with_min_len(1 << 14).map(|s| s.z).reduce(|| f64::INFINITY, f64::min);
        let distance_origin = nearest.max(view.near).max(0.0);
        let input = Input {
            view: &view,
            seen: &seen,
            tetrahedra: &grid.tetrahedra,
            attributes,
            distance_origin,
            densest,
            area: Area::of_picture(view.size),
        };

        let projected = match Cast::of(cells, &view, &seen, attributes, densest, limits) {
            Some(cast) => Projected::Cast(cast),
            None => Projected::new(cells, &input, cells.most_at_once)?,
        };
        if progress.cancelled() {
            return Err(Error::cancelled());
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
            lanes: cells.lanes,
            projected,
            spare: cells.spare.clone(),
            densest,
            distance_origin,
            near,
            attribute_count: attributes.len(),
        })
    }

    /// The same view with cells projected for some tiles, where rays do not serve: few at a time, since what rays go by is there, too.
    ///
    /// Errors: those of [`Tiles::fill_on_all`].
    pub fn by_cells(&self, cells: &Cells, attributes: &[Attribute<'_>], tiles: &[u32]) -> Result<Sample> {
        let grid = &cells.volume.grid;
        let input = self.input(grid, attributes, Area::around(self.view.size, tiles));
        let mut projected = Projected::new(cells, &input, cells.most_at_once.min(LOST_AT_ONCE))?;
        if let Projected::InWindows(windows) = &mut projected {
            windows.retain(tiles, self.view.size[0].div_ceil(TILE));
        }
        Ok(Sample { seen: self.seen.clone(), spare: self.spare.clone(), projected, ..*self })
    }

    /// What projects cells for an area of the picture.
    fn input<'a>(&'a self, grid: &'a Grid, attributes: &'a [Attribute<'a>], area: Area) -> Input<'a> {
        Input {
            view: &self.view,
            seen: &self.seen,
            tetrahedra: &grid.tetrahedra,
            attributes,
            distance_origin: self.distance_origin,
            densest: self.densest,
            area,
        }
    }

    /// Records, and cells drawn in 64 bits; cells that cover a pixel centre, where they are not projected yet; none where rays go from
    /// cell to cell.
    pub fn cell_count(&self) -> Option<u64> {
        match &self.projected {
            Projected::Whole(tiles) => Some(tiles.cell_count()),
            Projected::InWindows(windows) => Some(windows.cell_count),
            Projected::Cast(_) => None,
        }
    }
}

impl Drop for Sample {
    fn drop(&mut self) {
        if let Projected::Whole(tiles) = &mut self.projected {
            self.spare.tiles.put(std::mem::take(tiles));
        }
    }
}

impl<'a> Frame<'a> {
    /// Memory to work in.
    pub fn spare(&self) -> &'a Spare {
        &self.sample.spare
    }

    pub fn new(
        sample: &'a Sample,
        tiles: &'a Tiles,
        grid: &'a Grid,
        attributes: &'a [Attribute<'a>],
        scalar_count: usize,
        shader: &'a Shader,
        sorted: bool,
    ) -> Frame<'a> {
        Frame {
            view: sample.view,
            tiles_wide: sample.view.size[0].div_ceil(TILE),
            attribute_count: sample.attribute_count,
            scalar_count,
            shader,
            lanes: sample.lanes,
            sorted,
            distance_origin: sample.distance_origin,
            near: sample.near,
            cast: match &sample.projected {
                Projected::Cast(cast) => Some(cast),
                Projected::Whole(_) | Projected::InWindows(_) => None,
            },
            kept: None,
            keeping: None,
            whole: false,
            ends: None,
            only: None,
            sample,
            tiles,
            grid,
            attributes,
        }
    }

    /// The same with the tiles of a window.
    pub fn within<'b>(&self, tiles: &'b Tiles) -> Frame<'b>
    where
        'a: 'b,
    {
        Frame { tiles, ..*self }
    }

    /// Projects a window's cells.
    ///
    /// Errors: those of [`Tiles::fill`].
    pub fn project(&self, window: &Window, tiles: &mut Tiles) -> Result<()> {
        let attributes = &self.attributes[..self.attribute_count];
        let input = self.sample.input(self.grid, attributes, window.area);
        tiles.fill(&input, self.lanes, &self.grid.points, &window.pieces)
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

    /// Whether a tile of a window is drawn.
    pub fn draws(&self, tile: u32) -> bool {
        self.only.is_none_or(|tiles| tiles.binary_search(&tile).is_ok())
    }

    #[inline(always)]
    pub fn entries_of(&self, tile: usize) -> &'a [u32] {
        self.tiles.entries_of([tile % self.tiles_wide, tile / self.tiles_wide])
    }

    #[inline(always)]
    pub fn record(&self, entry: u32) -> (&'a Record, &'a [AttributeRecord], [&'a Seen; 4]) {
        let (place, seen) = (self.tiles.at(entry), &self.sample.seen);
        (place.record(), place.attributes(), place.corners().map(|p| &seen[p as usize]))
    }

    /// Asks for a record's cache lines before they are needed: a tile's cells lie scattered over the parts.
    #[inline(always)]
    pub fn prefetch(&self, entry: u32) {
        self.tiles.at(entry).prefetch();
    }

    /// The same for its corners' places in the picture, once its record is near.
    #[inline(always)]
    pub fn prefetch_corners(&self, entry: u32) {
        for corner in self.tiles.at(entry).corners() {
            prefetch(self.sample.seen.as_ptr().wrapping_add(corner as usize));
        }
    }

    pub fn cells64_of(&self, tile: usize) -> impl Iterator<Item = &'a Cell64> + use<'a> {
        self.tiles.cells64_of([tile % self.tiles_wide, tile / self.tiles_wide])
    }

    /// Puts the segment of a cell that was crossed in 64 bits in place `k` of a batch, to be shaded like any other. `stretch`: its
    /// length by its depth.
    pub fn put64(
        &self,
        cell: &Cell64,
        crossing: &Crossing64,
        [i, j]: [usize; 2],
        stretch: f64,
        k: usize,
        batch: &mut Batch,
    ) {
        let corners = self.grid.tetrahedra[cell.id as usize].map(|p| p as usize);
        let [entry, exit] = crossing.depth;
        batch.pixel[k] = ((j % TILE) << 4 | (i % TILE)) as u32;
        batch.length[k] = ((exit - entry) * stretch) as f32;
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
