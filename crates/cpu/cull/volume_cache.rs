//! Volume cache: data derived from a volume that pictures share.

use super::contributing::{
    Block, ContributingCells, CornerValues, CullQuery, MIN_CELLS_TO_SAMPLE, MIN_CULLED_FRACTION,
    SAMPLE_STRIDE,
};
use crate::attribute::attributes_of;
use crate::cache::get_or_compute;
use crate::cast::FaceCache;
use crate::cells::Cells;
use crate::composite::frame::BufferPool;
use crate::segment_cache::ViewCache;
use crate::selection::{CellSelection, MAX_RESIDENT_CELLS, Traversal};
use crate::tolerances::CULLED_DEPTH;
use crate::view::{ScreenVertex, View};
use rayon::prelude::*;
use std::sync::{Arc, Mutex};
use voltet_core::camera::Camera;
use voltet_core::grid::extent;
use voltet_core::progress::Progress;
use voltet_core::transfer::{Support, TransferFunction};
use voltet_core::volume::{Volume, VolumeExtent};
use voltet_core::{Error, Result};
use voltet_optics::scene_parts::SceneExtent;
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;

/// Cells that one thread takes at a time.
const CHUNK: usize = 1 << 14;

/// Cache of a volume: its bounds, the ranges of its values, also over blocks of cells, the last culling result, and the points projected
/// for the last camera. A picture computes anew only data that depend on the change: where only the camera changed, the cells in widgets'
/// supports stay; where only colours did, or extinctions by less than a factor of two, all data do. The cache takes at most 5 bytes a
/// cell and 25 a point, where rays are cast 85 more a cell, and the buffers of the last picture.
#[derive(Debug)]
pub struct VolumeCache {
    volume: Arc<Volume>,
    /// Scene length (world units).
    pub(crate) length: f64,
    /// Ranges of s and g.
    pub(crate) ranges: [[f64; 2]; 2],
    max_gradient: f64,
    /// Extent of the whole grid, of which the volume is a part.
    whole: Option<Arc<SceneExtent>>,
    blocks: Mutex<Option<Arc<Vec<Block>>>>,
    contributing: Mutex<Option<Arc<ContributingCells>>>,
    points: Mutex<Option<Arc<ProjectedPoints>>>,
    buffers: Arc<BufferPool>,
    pub(crate) views: ViewCache,
    faces: FaceCache,
}

#[derive(Debug)]
struct ProjectedPoints {
    camera: Camera,
    vertices: Arc<Vec<ScreenVertex>>,
    /// Planes of the view that each point lies outside of (outcodes).
    outcodes: Vec<u8>,
    /// True if any point lies outside.
    any_outside: bool,
}

impl ProjectedPoints {
    /// True if no plane of the view has all corners of a cell outside.
    fn is_in_view(&self, corners: &[u32; 4]) -> bool {
        corners.iter().fold(u8::MAX, |all, &p| all & self.outcodes[p as usize]) == 0
    }
}

impl VolumeCache {
    /// Errors: an extent beyond 64-bit floats.
    pub fn new(volume: &Arc<Volume>) -> Result<VolumeCache> {
        VolumeCache::with_extent(volume, &VolumeExtent::from_volume(volume), None)
    }

    /// Cache of a part of the grid that has this extent: lengths and values are rounded as in the whole.
    ///
    /// Errors: an extent beyond 64-bit floats.
    pub fn of_part(volume: &Arc<Volume>, whole: &SceneExtent) -> Result<VolumeCache> {
        VolumeCache::with_extent(volume, &whole.volume, Some(Arc::new(whole.clone())))
    }

    fn with_extent(
        volume: &Arc<Volume>,
        extent: &VolumeExtent,
        whole: Option<Arc<SceneExtent>>,
    ) -> Result<VolumeCache> {
        Ok(VolumeCache {
            length: extent::scene_length(extent.bounds)?,
            ranges: extent.ranges,
            max_gradient: extent.max_gradient,
            whole,
            volume: volume.clone(),
            blocks: Mutex::default(),
            contributing: Mutex::default(),
            points: Mutex::default(),
            buffers: Arc::default(),
            views: ViewCache::default(),
            faces: FaceCache::empty(),
        })
    }

    /// The volume.
    pub fn volume(&self) -> &Arc<Volume> {
        &self.volume
    }

    /// Selects each tetrahedron that could contribute to the picture. Culling changes no pixel by more than 1e-6.
    ///
    /// Errors: a camera out of range, a transfer function that reads quantities the volume does not have.
    pub fn cull(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        self.cull_by(transfer_function, camera, false, progress)
    }

    /// Like [`VolumeCache::cull`], without the cost heuristic: every cell is tested, also where the picture gains nothing by it.
    ///
    /// Errors: those of [`VolumeCache::cull`].
    pub fn cull_exact(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        self.cull_by(transfer_function, camera, true, progress)
    }

    fn cull_by(
        &self,
        transfer_function: &TransferFunction,
        camera: &Camera,
        exact: bool,
        progress: &dyn Progress,
    ) -> Result<Cells> {
        let empty = self.empty()?;
        let points = self.points(camera)?;
        progress.report("cull", 0.3);
        // A cell whose density is nowhere above this adds less than CULLED_DEPTH over the whole diagonal.
        let min_density = CULLED_DEPTH / self.length;
        let attributes = attributes_of(&empty, transfer_function)?;
        let query = CullQuery {
            support: &Support::new(transfer_function)?.in_steps(min_density),
            min_density,
            tetrahedra: &self.volume.grid.tetrahedra,
            values: CornerValues::new(&attributes, transfer_function),
            blocks: &|| get_or_compute(&self.blocks, |_| true, || Block::every(&self.volume)),
            ranges: self.ranges,
            axes: transfer_function.axes_read(),
        };
        let contributing = self.contributing(&query, transfer_function.fields(), exact);
        progress.check_cancelled()?;
        let in_view = |id: u32| points.is_in_view(&self.volume.grid.tetrahedra[id as usize]);
        let cells = &contributing.cells;
        let ids = match points.any_outside && (exact || is_worth_testing(cells, in_view)) {
            true => Arc::new(filter_ids(cells, in_view)),
            false => cells.clone(),
        };
        let is_inactive = |&widget: &usize| match contributing.examples[widget] {
            Some(id) if !points.any_outside || in_view(id) => false,
            Some(_) => query.example(widget, &ids).is_none(),
            None => true,
        };
        let selection = CellSelection {
            culled_by_transfer_function: (query.tetrahedra.len() - cells.len()) as u64,
            culled_by_frustum: (cells.len() - ids.len()) as u64,
            inactive_widgets: (0..contributing.examples.len()).filter(is_inactive).collect(),
            culling_skipped: contributing.culling_skipped,
            culled_for: Some(transfer_function.clone()),
            ids,
            ..empty
        };
        Ok(Cells {
            faces: Some(self.faces.with(cells)),
            screen_vertices: Some((*camera, points.vertices.clone())),
            ..self.cells(selection)
        })
    }

    /// Selects every tetrahedron and every widget, for comparison with [`VolumeCache::cull`]: the picture is the same, by more work. No
    /// projected point or face is reused.
    ///
    /// Errors: those of [`VolumeCache::cull`].
    pub fn all(&self, transfer_function: &TransferFunction, camera: &Camera) -> Result<Cells> {
        let empty = self.empty()?;
        View::new(camera, empty.length, [0.0; 2])?;
        attributes_of(&empty, transfer_function)?;
        let count = u32::try_from(self.volume.grid.tetrahedra.len()).map_err(|_| {
            Error::run("the grid has too many tetrahedra").expected(format!("at most {}", u32::MAX))
        })?;
        let ids = Arc::new((0..count).collect());
        let faces = Some(FaceCache::empty().with(&ids));
        Ok(Cells { faces, ..self.cells(CellSelection { ids, exhaustive: true, ..empty }) })
    }

    /// Selects every cell in view, whatever the widgets, with values counted from the centre of their ranges.
    pub(crate) fn all_in_view(&self, camera: &Camera) -> Result<Cells> {
        let points = self.points(camera)?;
        let tetrahedra = &self.volume.grid.tetrahedra;
        let count = u32::try_from(tetrahedra.len()).unwrap_or(u32::MAX);
        let in_view = |id: &u32| !points.any_outside || points.is_in_view(&tetrahedra[*id as usize]);
        let ids: Vec<u32> = (0..count).into_par_iter().filter(in_view).collect();
        let mut cells = self.empty_in_view(camera)?;
        cells.culled_by_frustum = u64::from(count) - ids.len() as u64;
        cells.ids = Arc::new(ids);
        Ok(cells)
    }

    /// Selects no cell, with values counted from the centre of their ranges: for pictures from cached segments.
    pub(crate) fn empty_in_view(&self, camera: &Camera) -> Result<Cells> {
        let screen_vertices = Some((*camera, self.points(camera)?.vertices.clone()));
        let selection = CellSelection { centered_ranges: true, ..self.empty()? };
        Ok(Cells { screen_vertices, ..self.cells(selection) })
    }

    pub(crate) fn empty(&self) -> Result<CellSelection> {
        Ok(CellSelection {
            volume: self.volume.clone(),
            ids: Arc::default(),
            ordering: Ordering::PerPixel,
            culled_by_transfer_function: 0,
            culled_by_frustum: 0,
            culling_skipped: None,
            inactive_widgets: Vec::new(),
            exhaustive: false,
            lanes: LaneSet::detect()?,
            traversal: Traversal::Auto,
            max_resident_cells: MAX_RESIDENT_CELLS,
            centered_ranges: false,
            optical_depth_floor: 0.0,
            culled_for: None,
            length: self.length,
            ranges: self.ranges,
            max_gradient: self.max_gradient,
            casts_rays: false,
            whole: self.whole.clone(),
        })
    }

    /// A selection with the volume's buffers.
    fn cells(&self, selection: CellSelection) -> Cells {
        Cells { selection, buffers: self.buffers.clone(), faces: None, screen_vertices: None }
    }

    fn points(&self, camera: &Camera) -> Result<Arc<ProjectedPoints>> {
        let view = View::new(camera, self.length, [0.0; 2])?;
        let is_valid = |points: &ProjectedPoints| points.camera == *camera;
        Ok(get_or_compute(&self.points, is_valid, || {
            let (vertices, outcodes) = view.project(&self.volume.grid.points);
            let any_outside = outcodes.par_iter().with_min_len(CHUNK).any(|&planes| planes != 0);
            ProjectedPoints { camera: *camera, vertices: Arc::new(vertices), outcodes, any_outside }
        }))
    }

    /// Cells in the widgets' supports. `fields`: those that the supports number; `exact`: every cell is tested.
    fn contributing(&self, query: &CullQuery, fields: Vec<&str>, exact: bool) -> Arc<ContributingCells> {
        let is_exact = |cells: &ContributingCells| !exact || cells.culling_skipped.is_none();
        let is_valid = |cells: &ContributingCells| cells.matches(query, &fields) && is_exact(cells);
        get_or_compute(&self.contributing, is_valid, || ContributingCells::find(query, &fields, exact))
    }
}

/// True if enough cells lie out of view: the further stages soon drop a cell that does, too.
fn is_worth_testing(ids: &[u32], in_view: impl Fn(u32) -> bool + Sync) -> bool {
    if ids.len() < MIN_CELLS_TO_SAMPLE {
        return true;
    }
    let sample = ids.par_iter().step_by(SAMPLE_STRIDE).with_min_len(256);
    let (count, outside) = (sample.len(), sample.filter(|&&id| !in_view(id)).count());
    outside as f64 >= MIN_CULLED_FRACTION * count as f64
}

/// Parallel filter of a list, in its order.
fn filter_ids(ids: &[u32], is_selected: impl Fn(u32) -> bool + Sync) -> Vec<u32> {
    let mut selected = vec![0; ids.len()];
    // Those of each chunk at its beginning, without branches that could not be predicted; then the chunks side by side.
    let filter_chunk = |(selected, ids): (&mut [u32], &[u32])| {
        let mut count = 0;
        for &id in ids {
            selected[count] = id;
            count += usize::from(is_selected(id));
        }
        count
    };
    let chunks = selected.par_chunks_mut(CHUNK).zip(ids.par_chunks(CHUNK));
    let counts: Vec<usize> = chunks.map(filter_chunk).collect();
    let mut end = 0;
    for (chunk, &count) in counts.iter().enumerate() {
        selected.copy_within(chunk * CHUNK..chunk * CHUNK + count, end);
        end += count;
    }
    selected.truncate(end);
    selected
}
