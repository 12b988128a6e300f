//! Projection: cells prepared for the compositor, once for each sample of a pixel.

use crate::attribute::Attribute;
use crate::cast::ray_caster;
use crate::cast::{RayCastPolicy, RayCaster, ScreenExtent};
use crate::cells::Cells;
use crate::composite::frame::{BufferPool, SegmentSource};
use crate::fragments::crossing::Near;
use crate::project::cells::Input;
use crate::project::regions::Regions;
use crate::tile::{Area, TILE};
use crate::view::{ScreenVertex, View};
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::progress::Progress;
use voltet_optics::scene_parts::PartTally;

/// Cells prepared for the compositor: one projection for each sample of a pixel. Of more cells than are resident at once
/// ([`crate::CellSelection::max_resident_cells`]) it holds the region of the picture that each touches; the compositor projects them region
/// by region.
#[derive(Debug)]
pub struct Projection {
    pub(crate) cells: Cells,
    pub(crate) camera: Camera,
    /// First samples of a pixel, at least one; further ones are projected when they are composited.
    pub(crate) samples: Vec<SubpixelView>,
    /// Upper bound of the optical depth, or colour, that all widgets together give over a scene length.
    pub(crate) max_optical_depth: f64,
    pub(crate) policy: RayCastPolicy,
}

impl Projection {
    /// The volume's cells that were projected, and their order.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Cells that cover a pixel centre (of the first sample). `None` where no cell is projected, since rays go from cell to cell.
    pub fn cells_projected(&self) -> Option<u64> {
        self.samples.first().map_or(Some(0), SubpixelView::cell_count)
    }

    /// Figures of the cells, as a part of a grid ([`ray_caster::tally`]).
    pub(crate) fn tally(&self, finds_boundary: bool) -> PartTally {
        let Some(sample) = self.samples.first() else { return PartTally::default() };
        let SubpixelView { view, screen_vertices, extent, source, attribute_count, .. } = sample;
        let caster = match source {
            SegmentSource::RayCast(caster) => Some(caster),
            _ => None,
        };
        ray_caster::tally(
            &self.cells,
            self.cells.faces.as_ref(),
            (view, screen_vertices),
            (extent, self.policy),
            (*attribute_count, self.max_optical_depth),
            (caster, finds_boundary),
        )
    }

    /// Projects the cells for one more sample of every pixel. `attributes`: at least those that the first was projected with.
    pub(crate) fn sample(
        &self,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        progress: &dyn Progress,
    ) -> Result<SubpixelView> {
        let count = self.samples.first().map_or(attributes.len(), |first| first.attribute_count);
        let bounds = (self.max_optical_depth, self.policy);
        SubpixelView::new(&self.cells, &self.camera, offset, &attributes[..count], bounds, progress)
    }
}

/// Regions that hold as many cells together as are resident at once.
const RESIDENT_REGIONS: usize = 8;

/// Cells that are resident at once for tiles in which rays were mistracked.
pub(crate) const MAX_RESIDENT_CELLS_OF_FALLBACK: usize = 1 << 17;

/// Cells that a region should hold.
pub(crate) fn cells_of_region(max_resident_cells: usize) -> usize {
    (max_resident_cells / RESIDENT_REGIONS).max(1)
}

/// Cells prepared for one sample of every pixel.
#[derive(Debug)]
pub(crate) struct SubpixelView {
    pub view: View,
    extent: ScreenExtent,
    screen_vertices: Arc<Vec<ScreenVertex>>,
    pub source: SegmentSource,
    buffers: Arc<BufferPool>,
    /// See [`Input::max_optical_depth`].
    max_optical_depth: f64,
    distance_origin: f64,
    pub near: Near,
    pub attribute_count: usize,
}

impl SegmentSource {
    /// Projects the selected cells for an area, or bins them by regions of it where they are more than `max_resident_cells`.
    ///
    /// Errors: those of [`crate::project::tile_bins::TileBins::fill_on_all`].
    fn new(cells: &Cells, input: &Input<'_>, max_resident_cells: usize) -> Result<SegmentSource> {
        let (ids, lanes, points) = (cells.ids.as_slice(), cells.lanes, &cells.volume.grid.points);
        if max_resident_cells < ids.len() {
            let count = cells_of_region(max_resident_cells);
            return Ok(SegmentSource::Regions(Regions::new(input, lanes, points, ids, count)));
        }
        let mut bins = cells.buffers.bins.take();
        bins.fill_on_all(input, lanes, points, ids)?;
        Ok(SegmentSource::Tiles(bins))
    }
}

impl SubpixelView {
    /// Projects the selected cells, or prepares rays through them where the policy is met. `max_optical_depth`: see
    /// [`Input::max_optical_depth`].
    pub fn new(
        cells: &Cells,
        camera: &Camera,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        (max_optical_depth, policy): (f64, RayCastPolicy),
        progress: &dyn Progress,
    ) -> Result<SubpixelView> {
        let grid = &cells.volume.grid;
        let view = View::new(camera, cells.length, offset)?;
        // The cull stage projected the points already, unless this is another camera or another sample.
        let vertices = match &cells.screen_vertices {
            Some((of_camera, vertices)) if of_camera == camera && offset == [0.0; 2] => vertices.clone(),
            _ => Arc::new(view.project(&grid.points).0),
        };
        let extent = match &cells.whole {
            Some(whole) => ScreenExtent::of_whole(whole.view, &view),
            None => ScreenExtent::new(&vertices[..grid.drawn_points().min(vertices.len())]),
        };
        let nearest = extent.near;
        let distance_origin = nearest.max(view.near).max(0.0);
        let input = Input {
            view: &view,
            screen_vertices: &vertices,
            tetrahedra: &grid.tetrahedra,
            attributes,
            distance_origin,
            max_optical_depth,
            area: Area::of_picture(view.size),
        };

        let faces = cells.faces.as_ref();
        let source = match faces.and_then(|faces| RayCaster::new(cells, faces, &input, (&extent, policy))) {
            Some(caster) => SegmentSource::RayCast(caster),
            None => SegmentSource::new(cells, &input, cells.max_resident_cells)?,
        };
        progress.check_cancelled()?;
        let near = (nearest < view.near && (!view.perspective || view.near > 0.0)).then(|| {
            // From the distance, not the depth: far from the eye, depth / near − 1 has no digits left in 32 bits.
            let scale = if view.perspective { 1.0 / view.near } else { 1.0 };
            let past = distance_origin - view.near;
            [scale as f32, (past * scale) as f32, -past as f32]
        });
        Ok(SubpixelView {
            view,
            extent,
            screen_vertices: vertices,
            source,
            buffers: cells.buffers.clone(),
            max_optical_depth,
            distance_origin,
            near,
            attribute_count: attributes.len(),
        })
    }

    /// The view with cells projected for some tiles, where rays were mistracked: few at a time, since the ray caster's memory is in use,
    /// too.
    ///
    /// Errors: those of [`crate::project::tile_bins::TileBins::fill_on_all`].
    pub fn projected(
        &self,
        cells: &Cells,
        attributes: &[Attribute<'_>],
        tiles: &[u32],
    ) -> Result<SubpixelView> {
        let input =
            Input { area: Area::around(self.view.size, tiles), ..self.input(&cells.volume.grid, attributes) };
        let max_resident_cells = cells.max_resident_cells.min(MAX_RESIDENT_CELLS_OF_FALLBACK);
        let mut source = SegmentSource::new(cells, &input, max_resident_cells)?;
        if let SegmentSource::Regions(regions) = &mut source {
            regions.retain(tiles, self.view.size[0].div_ceil(TILE));
        }
        let (screen_vertices, buffers) = (self.screen_vertices.clone(), self.buffers.clone());
        Ok(SubpixelView { screen_vertices, buffers, source, ..*self })
    }

    /// Input of the projection, for all of the picture. `attributes`: at least those that the cells were projected with.
    pub fn input<'a>(&'a self, grid: &'a Grid, attributes: &'a [Attribute<'a>]) -> Input<'a> {
        Input {
            view: &self.view,
            screen_vertices: &self.screen_vertices,
            tetrahedra: &grid.tetrahedra,
            attributes: &attributes[..self.attribute_count],
            distance_origin: self.distance_origin,
            max_optical_depth: self.max_optical_depth,
            area: Area::of_picture(self.view.size),
        }
    }

    /// Cells that cover a pixel centre. `None` where no cell is projected, since rays go from cell to cell.
    pub fn cell_count(&self) -> Option<u64> {
        match &self.source {
            SegmentSource::Tiles(bins) => Some(bins.cell_count()),
            SegmentSource::Regions(regions) => Some(regions.cell_count),
            SegmentSource::RayCast(_) => None,
        }
    }
}

impl Drop for SubpixelView {
    fn drop(&mut self) {
        if let SegmentSource::Tiles(bins) = &mut self.source {
            self.buffers.bins.put(std::mem::take(bins));
        }
    }
}
