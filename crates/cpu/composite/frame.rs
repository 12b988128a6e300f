//! Read-only inputs of the compositor's workers for one sub-pixel view.

use crate::cache::FreeList;
use crate::cast::RayCaster;
use crate::composite::fragment_lists::FragmentLists;
use crate::composite::lane_axes::LaneAxes;
use crate::fragments::batch::{Batch, DepthLimits};
use crate::fragments::crossing::Near;
use crate::project::cells::Input;
use crate::project::precise_cell::{PreciseCell, PreciseCrossing};
use crate::project::regions::{Region, Regions};
use crate::project::tile_bins::TileBins;
use crate::segment_cache::SegmentCache;
use crate::shade::shader::Shader;
use crate::tile::{PIXELS, TILE, TileRect};
use crate::view::View;
use glam::DVec3;
use voltet_core::Result;
use voltet_optics::ray_events::RayEvents;
use voltet_simd::LaneSet;

/// Source of a view's ray segments, as far as it is prepared before the workers begin.
#[derive(Debug)]
pub(crate) enum SegmentSource {
    /// All cells are projected.
    Tiles(TileBins),
    /// No cell is projected: workers project region by region.
    Regions(Regions),
    /// No cell is projected: rays go from cell to cell.
    RayCast(RayCaster),
}

/// Read-only inputs of a compositor worker for one sub-pixel view.
#[derive(Clone, Copy)]
pub(crate) struct FrameContext<'a> {
    pub view: &'a View,
    /// Lane set that the kernels run on.
    pub lanes: LaneSet,
    pub shader: &'a Shader,
    pub source: &'a SegmentSource,
    /// Tiles that are drawn: those with most work first, or of regions ascending, none for all.
    pub tiles: &'a [u32],
    /// Segments cached from a picture of this view, in place of the source.
    pub cache: Option<&'a SegmentCache>,
    /// Input of the projection: attributes are those of the widgets, then the gradient where light or silhouettes read it.
    pub input: Input<'a>,
    pub points: &'a [DVec3],
    /// Near plane, where it cuts cells: see [`crate::fragments::crossing::CellPacket::evaluate`].
    pub near: Near,
    /// Attributes that widgets read.
    pub scalar_count: usize,
    /// True if each pixel's segments are sorted.
    pub sorted: bool,
    /// True if no work is skipped: rays go on behind opaque places.
    pub exhaustive: bool,
    /// Depth at which each pixel's ray ends, row by row: along the view direction (world units).
    pub depth_limit: Option<&'a [f32]>,
    /// Surfaces and clips among the segments.
    pub events: Option<&'a RayEvents>,
    /// Curved axes of s and g, on which segments are cut into straight pieces.
    pub axes: Option<&'a LaneAxes>,
    /// True if the stretches of rays that the cells fill are recorded.
    pub records_stretches: bool,
    pub buffers: &'a BufferPool,
}

impl FrameContext<'_> {
    pub fn attribute_count(&self) -> usize {
        self.input.attributes.len()
    }

    /// True if segments need their pixels, entries and exits.
    pub fn needs_depths(&self) -> bool {
        self.depth_limit.is_some()
            || self.events.is_some()
            || self.shader.surface.is_some()
            || self.records_stretches
    }

    /// Projects a region's cells.
    ///
    /// Errors: those of [`TileBins::fill`].
    pub fn project(&self, region: &Region, bins: &mut TileBins) -> Result<()> {
        bins.fill(&Input { area: region.area, ..self.input }, self.lanes, self.points, &region.pieces)
    }

    /// Finds the depths at which the rays of a tile's pixels end, where they do (scene lengths from the distance origin).
    pub fn depth_limits_of(&self, rect: TileRect, limits: &mut DepthLimits) {
        let (Some(all), [width, height]) = (self.depth_limit, self.view.size) else { return };
        for (pixel, limit) in limits.iter_mut().enumerate() {
            let (i, j) = (rect.left + pixel % TILE, rect.top + pixel / TILE);
            if i < width && j < height {
                let depth = f64::from(all[j * width + i]) / self.view.length;
                *limit = (depth - self.input.distance_origin) as f32;
            }
        }
    }

    /// Ray length per unit of depth of a tile's pixels.
    pub fn lengths_per_depth(&self, rect: TileRect, lengths: &mut [f32; PIXELS]) {
        if self.view.perspective {
            for (pixel, length) in lengths.iter_mut().enumerate() {
                let [i, j] = [rect.left + pixel % TILE, rect.top + pixel / TILE];
                *length = self.view.length_per_depth(i as f64, j as f64) as f32;
            }
        }
    }

    /// Puts the segment of a precise cell in slot `k` of a batch, to be shaded like any other.
    pub fn put_precise(
        &self,
        cell: &PreciseCell,
        crossing: &PreciseCrossing,
        [i, j]: [usize; 2],
        length_per_depth: f64,
        k: usize,
        batch: &mut Batch,
    ) {
        let Input { tetrahedra, attributes, distance_origin, .. } = self.input;
        let corners = tetrahedra[cell.id as usize].map(|p| p as usize);
        let [entry, exit] = crossing.depth;
        batch.pixel[k] = ((j % TILE) << 4 | (i % TILE)) as u32;
        batch.length[k] = ((exit - entry) * length_per_depth) as f32;
        batch.entry[k] = (entry - distance_origin) as f32;
        batch.exit[k] = (exit - distance_origin) as f32;
        for (a, attribute) in attributes.iter().enumerate() {
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

/// Buffer pool: recycles tile bins and fragment lists between frames, so that pages are not faulted in anew.
#[derive(Debug, Default)]
pub(crate) struct BufferPool {
    pub bins: FreeList<TileBins>,
    pub lists: FreeList<FragmentLists>,
}
