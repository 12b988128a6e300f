//! What is ready to be drawn, and how all threads draw it: the composite stage's work.

use crate::attribute::{Attribute, gradient_attributes};
use crate::cells::Counts;
use crate::composite::hides::Hides;
use crate::composite::sinks::{OPAQUE_DEPTH, TilePicture};
use crate::composite::worker::{Drawn, Work, Worker};
use crate::draw::Projection;
use crate::kept::{Keeping, Kept};
use crate::project::record::TILE;
use crate::project::tiles::Tiles;
use crate::sample::{Frame, Projected, Sample};
use crate::shade::shader::Shader;
use rayon::prelude::*;
use std::sync::atomic::AtomicUsize;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_optics::shading::Ordering;

/// A projection with all that is made once for drawing it: the integrator's tables, the widgets made ready.
pub struct Ready<'a> {
    pub(crate) projection: &'a Projection,
    pub(crate) attributes: Vec<Attribute<'a>>,
    pub(crate) shader: Shader,
    pub(crate) table_bytes: u64,
}

/// Refuses ends of rays that are not those of a picture.
fn check_ends(ends: &[f32], [width, height]: [usize; 2]) -> Result<()> {
    if ends.len() != width * height {
        let error = Error::usage("the rays' ends are not one a pixel").got(ends.len());
        return Err(error.expected(format!("{width} × {height}, the camera's")));
    }
    match ends.iter().position(|end| end.is_nan()) {
        None => Ok(()),
        Some(pixel) => Err(Error::usage("the end of a ray is not a number")
            .got(format!("pixel {} of row {}", pixel % width, pixel / width))
            .expected("depths, infinite where nothing ends a ray")),
    }
}

impl Ready<'_> {
    /// Integrates and composites every pixel's segments. Errors: a stopped run, a segment that the integrator gives up.
    pub fn composite(&self, progress: &dyn Progress) -> Result<(Picture, Counts)> {
        self.composite_until(None, progress)
    }

    /// The same of rays that end, as at opaque surfaces that others draw. `ends`: for each pixel, row by row from the top, the depth
    /// of its ray's end along the view direction, world units; infinite where nothing ends it. Errors: another number of pixels, a
    /// depth that is no number.
    pub fn composite_until(
        &self,
        ends: Option<&[f32]>,
        progress: &dyn Progress,
    ) -> Result<(Picture, Counts)> {
        self.draw(ends, None, progress)
    }

    /// The same of segments that were kept of this view: the projection is one of no cell.
    pub(crate) fn composite_kept(&self, kept: &Kept, progress: &dyn Progress) -> Result<(Picture, Counts)> {
        self.draw(None, Some(kept), progress)
    }

    /// Keeps the segments in place of drawing them: of one sample a pixel. `None` where they take more than `limit` bytes, or a
    /// pixel has too many.
    pub(crate) fn keep(&self, limit: u64, progress: &dyn Progress) -> Result<Option<Kept>> {
        let Ready { projection, attributes, shader, .. } = self;
        let Some(sample) = projection.samples.first() else { return Ok(None) };
        let [width, height] = projection.camera.size.map(|n| n as usize);
        let none = Tiles::default();
        let (tiles, work) = work_of(sample, width, &none);
        let grid = &projection.cells.volume.grid;
        let keeping = Keeping::new(limit);
        let mut frame = Frame::new(sample, tiles, grid, attributes, attributes.len(), shader, true);
        frame.keeping = Some(&keeping);
        let results = self.run(&frame, &work, false, progress)?;
        if keeping.is_given_up() {
            return Ok(None);
        }
        let tiles = results.into_iter().flat_map(|drawn| drawn.kept).collect();
        Ok(Some(Kept::new(tiles, width.div_ceil(TILE) * height.div_ceil(TILE), projection.densest)))
    }

    /// Has all workers do the work. `opaque`: whether anything may be hidden.
    fn run(
        &self,
        frame: &Frame<'_>,
        work: &Work<'_>,
        opaque: bool,
        progress: &dyn Progress,
    ) -> Result<Vec<Drawn>> {
        let hides = Hides::new(opaque, work.tile_count());
        let next = AtomicUsize::new(0);
        let results: Vec<Result<Drawn>> =
            rayon::broadcast(|_| Worker { frame, work, next: &next, hides: &hides, progress }.run());
        let results: Vec<Drawn> = results.into_iter().collect::<Result<_>>()?;
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        match self.shader.failure() {
            Some(error) => Err(error.clone()),
            None => Ok(results),
        }
    }

    fn draw(
        &self,
        ends: Option<&[f32]>,
        kept: Option<&Kept>,
        progress: &dyn Progress,
    ) -> Result<(Picture, Counts)> {
        let Ready { projection, attributes, shader, table_bytes } = self;
        let cells = &projection.cells;
        // The cells may have been ordered for another shading.
        let sorted = match cells.ordering {
            Ordering::Independent | Ordering::PerPixel => shader.one_color.is_none(),
            Ordering::CellCentroid | Ordering::Submission => false,
        };
        let [width, height] = projection.camera.size.map(|n| n as usize);
        if let Some(ends) = ends {
            check_ends(ends, [width, height])?;
        }
        let mut picture = Picture::transparent(width, height);
        let (cells_projected, table_bytes) = (projection.cells_projected().unwrap_or(0), *table_bytes);
        let mut counts = Counts { cells_projected, table_bytes, ..Counts::default() };
        let offsets = projection.camera.sample_offsets();
        let weight = 1.0 / offsets.len() as f32;
        let mut all = attributes.clone();
        if projection.samples.iter().any(|sample| attributes.len() < sample.attribute_count) {
            all.extend(gradient_attributes(cells)?);
        }
        for (k, &offset) in offsets.iter().enumerate() {
            let made;
            let sample = match projection.samples.get(k) {
                Some(sample) => sample,
                None => {
                    made = projection.sample(offset, &all, progress)?;
                    &made
                }
            };
            let none = Tiles::default();
            let (tiles, mut work) = work_of(sample, width, &none);
            // Kept segments are in order.
            let sorted = sorted && kept.is_none();
            let mut frame =
                Frame::new(sample, tiles, &cells.volume.grid, &all, attributes.len(), shader, sorted);
            (frame.ends, frame.kept, frame.whole) = (ends, kept, cells.exhaustive);
            if let Some(kept) = kept {
                work = Work::Tiles(kept.queue.clone());
            }
            // Nothing is hidden where no ray through all of the grid is opaque.
            let opaque = f64::from(OPAQUE_DEPTH) < sample.deepest;
            let hides = opaque && sorted && !cells.exhaustive;
            let mut results = self.run(&frame, &work, hides && frame.cast.is_none(), progress)?;
            let mut lost: Vec<u32> = results.iter().flat_map(|drawn| drawn.lost.iter().copied()).collect();
            lost.sort_unstable();
            let by_cells;
            if !lost.is_empty() {
                by_cells = sample.by_cells(cells, &all[..sample.attribute_count], &lost)?;
                let (tiles, mut work) = work_of(&by_cells, width, &none);
                if let Work::Tiles(queue) = &mut work {
                    queue.clone_from(&lost);
                }
                let mut again =
                    Frame::new(&by_cells, tiles, &cells.volume.grid, &all, attributes.len(), shader, sorted);
                (again.ends, again.only) = (ends, Some(lost.as_slice()));
                counts.tiles_lost += lost.len() as u64;
                results.extend(self.run(&again, &work, hides, progress)?);
            }
            let mut tiles: Vec<Option<&TilePicture>> = vec![None; frame.tiles_wide * height.div_ceil(TILE)];
            for Drawn { tiles: done, counts: worker, .. } in &results {
                worker.add_to(&mut counts);
                for (tile, pixels) in done {
                    tiles[*tile as usize] = Some(pixels);
                }
            }
            add(&mut picture, &tiles, frame.tiles_wide, weight);
        }
        Ok((picture, counts))
    }
}

/// Adds the tiles of a sample, by its weight.
fn add(picture: &mut Picture, tiles: &[Option<&TilePicture>], tiles_wide: usize, weight: f32) {
    let width = picture.width;
    picture.rgba.par_chunks_mut(width).enumerate().for_each(|(j, row)| {
        for (i, pixel) in row.iter_mut().enumerate() {
            if let Some(tile) = tiles[j / TILE * tiles_wide + i / TILE] {
                let value = tile[(j % TILE) * TILE + i % TILE];
                for (sum, value) in pixel.iter_mut().zip(value) {
                    *sum += weight * value;
                }
            }
        }
    });
}

/// The tiles of a sample, and the work that they are; `none` where they are not projected yet.
fn work_of<'a>(sample: &'a Sample, width: usize, none: &'a Tiles) -> (&'a Tiles, Work<'a>) {
    match &sample.projected {
        Projected::Whole(tiles) => (tiles, Work::Tiles(tiles.queue(width.div_ceil(TILE)))),
        Projected::InWindows(windows) => (none, Work::Windows(&windows.list)),
        Projected::Cast(cast) => (none, Work::Tiles(cast.queue())),
    }
}
