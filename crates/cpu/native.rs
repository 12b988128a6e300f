//! The native engine as one of the program's engines, with its counts.

use crate::cast::RayCastPolicy;
use crate::cells::Cells;
use crate::counts::Counts;
use crate::cull::VolumeCache;
use crate::draw::{max_optical_depth, needs_gradient, prepare, prepare_in_order, project, sort};
use crate::frame_renderer::{DrawnFrame, RayInputs};
use crate::projection::Projection;
use crate::segment_cache::{Plan, SegmentCache};
use crate::selection::{CullSample, Traversal, without};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use voltet_core::diagnostics::Diagnostics;
use voltet_core::grid::extent;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Result, counted};
use voltet_optics::engine::{
    self, Engine, EngineInfo, PreparedPart, PreparedVolume, RenderOptions, RenderOutput, SelectedPart, Stage,
    StageTiming,
};
use voltet_optics::integrators::{self, PreparedScene, ScenePreparation};
use voltet_optics::scene::Scene;
use voltet_optics::scene_parts::{PartTally, SceneChoices, SceneExtent};
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;

/// The native engine.
pub const ENGINE: EngineInfo = EngineInfo {
    name: "cpu",
    summary: "native code on all cores",
    taken: Some("the CPU"),
    unavailable_reason: None,
    on_device: false,
    draws_parts: true,
    compositing: &[],
    can_serve: |transfer_function, shading| integrators::can_serve(&shading.integrator, transfer_function),
    adapters: Vec::new,
    open: |_| Ok(Arc::new(Native { lanes: LaneSet::detect()? })),
};

/// The engine on one lane set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Native {
    pub lanes: LaneSet,
}

impl Engine for Native {
    fn adapter(&self) -> String {
        format!("{}, {}", self.lanes.name(), counted(rayon::current_num_threads(), "thread"))
    }

    fn label(&self) -> String {
        format!("native engine, {}", self.lanes.name())
    }

    fn prepare(&self, volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        Ok(Arc::new(self.volume(VolumeCache::new(volume)?)))
    }

    fn prepare_part(&self, volume: &Arc<Volume>, whole: &SceneExtent) -> Result<Arc<dyn PreparedPart>> {
        Ok(Arc::new(self.volume(VolumeCache::of_part(volume, whole)?)))
    }

    fn choices(
        &self,
        whole: &SceneExtent,
        transfer_function: &TransferFunction,
        tally: &PartTally,
    ) -> Result<SceneChoices> {
        let length = extent::scene_length(whole.volume.bounds)?;
        let policy = RayCastPolicy::new(transfer_function, max_optical_depth(transfer_function, length));
        // Where it is not known, the caller asks again with it.
        let casts_rays = policy.pays(tally.covered_pixels / tally.cells.max(1.0))
            && (tally.lacks_boundary || policy.allows_boundary(tally.outer_faces, tally.cells));
        let is_active = |widget: usize| tally.active_widgets.get(widget).copied().unwrap_or(true);
        let inactive: Vec<usize> =
            (0..transfer_function.widgets.len()).filter(|&widget| !is_active(widget)).collect();
        let rounding = |function: &TransferFunction| {
            let origins = (0..2 + transfer_function.fields().len()).map(|axis| function.axis_origin(axis));
            let has_edges = function.widgets.iter().any(|widget| widget.region.is_some());
            (origins.collect::<Vec<_>>(), has_edges)
        };
        let is_same = rounding(&without(transfer_function, &inactive)) == rounding(transfer_function);
        let inactive_widgets = if is_same { Vec::new() } else { inactive };
        Ok(SceneChoices { casts_rays: Some(casts_rays), inactive_widgets })
    }
}

impl Native {
    fn volume(&self, cache: VolumeCache) -> NativeVolume {
        NativeVolume { lanes: self.lanes, cache, prepared: Mutex::new(None) }
    }
}

/// The engine with the cache of one volume.
#[derive(Debug)]
struct NativeVolume {
    lanes: LaneSet,
    cache: VolumeCache,
    /// The scene that an integrator prepared last: it serves the next picture, as a table does.
    prepared: Mutex<Option<Arc<Prepared>>>,
}

/// A volume and a transfer function that an integrator prepared ([`ScenePreparation`]).
#[derive(Debug)]
struct Prepared {
    /// The integrator, the volume and the transfer function that they were prepared from.
    source: (&'static str, Arc<Volume>, Arc<TransferFunction>),
    cache: VolumeCache,
    transfer_function: Arc<TransferFunction>,
}

impl NativeVolume {
    fn prepared(&self, scene: &Scene, preparation: &dyn ScenePreparation) -> Result<Arc<Prepared>> {
        let mut last = self.prepared.lock().unwrap_or_else(PoisonError::into_inner);
        let name = scene.shading.integrator.name();
        let serves = |prepared: &&Arc<Prepared>| {
            let (integrator, volume, transfer_function) = &prepared.source;
            *integrator == name
                && Arc::ptr_eq(volume, &scene.volume)
                && *transfer_function == scene.transfer_function
        };
        if let Some(prepared) = last.as_ref().filter(serves) {
            return Ok(prepared.clone());
        }
        let PreparedScene { volume, transfer_function } =
            preparation.prepare(&scene.volume, &scene.transfer_function)?;
        let prepared = Arc::new(Prepared {
            source: (name, scene.volume.clone(), scene.transfer_function.clone()),
            cache: VolumeCache::new(&Arc::new(volume))?,
            transfer_function: Arc::new(transfer_function),
        });
        *last = Some(prepared.clone());
        Ok(prepared)
    }
}

impl PreparedVolume for NativeVolume {
    fn draw(&self, scene: &Scene, manner: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput> {
        progress.check_cancelled()?;
        let mut timer = StageTimer::start();
        if manner.preview
            && scene.shading.integrator.kind().scene_preparation().is_none()
            && Arc::ptr_eq(&scene.volume, self.cache.volume())
            && let Some(segments) = self.cached_segments(scene, manner, &mut timer, progress)?
        {
            return self.draw_cached(&segments, scene, timer, progress);
        }
        self.draw_projected(self.project(scene, manner, None, progress)?, scene, manner, progress)
    }
}

impl PreparedPart for NativeVolume {
    fn select(
        self: Arc<Self>,
        scene: &Scene,
        choices: &SceneChoices,
        manner: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<Box<dyn SelectedPart>> {
        progress.check_cancelled()?;
        let projected = self.project(scene, manner, Some(choices), progress)?;
        Ok(Box::new(NativePart { volume: self, scene: scene.clone(), manner: *manner, projected }))
    }
}

/// A part of a grid with the cells that a scene selects, projected.
struct NativePart {
    volume: Arc<NativeVolume>,
    scene: Scene,
    manner: RenderOptions,
    projected: ProjectedScene,
}

impl SelectedPart for NativePart {
    fn tally(&self, finds_boundary: bool) -> PartTally {
        let active_widgets = self.projected.active_widgets.clone();
        PartTally { active_widgets, ..self.projected.projection.tally(finds_boundary) }
    }

    fn draw(self: Box<Self>, progress: &dyn Progress) -> Result<RenderOutput> {
        let NativePart { volume, scene, manner, projected } = *self;
        volume.draw_projected(projected, &scene, &manner, progress)
    }
}

/// Cells that are selected for a scene and projected.
struct ProjectedScene {
    /// The scene's transfer function, or that of the integrator for it.
    transfer_function: Arc<TransferFunction>,
    projection: Projection,
    /// For each widget, true if a cell in view touches it.
    active_widgets: Vec<bool>,
    is_part: bool,
    stages: Vec<StageTiming>,
}

impl NativeVolume {
    /// Selects a scene's cells and projects them. `choices`: of the grid that the volume is a part of.
    fn project(
        &self,
        scene: &Scene,
        manner: &RenderOptions,
        choices: Option<&SceneChoices>,
        progress: &dyn Progress,
    ) -> Result<ProjectedScene> {
        let preparation = scene.shading.integrator.kind().scene_preparation();
        let prepared = preparation.map(|preparation| self.prepared(scene, preparation)).transpose()?;
        let Scene { volume, transfer_function, camera, shading, .. } = scene;
        let mut timer = StageTimer::start();
        let other_volume = match Arc::ptr_eq(volume, self.cache.volume()) || prepared.is_some() {
            true => None,
            false => Some(VolumeCache::new(volume)?),
        };
        let (cache, transfer_function) = match &prepared {
            Some(prepared) => (&prepared.cache, &prepared.transfer_function),
            None => (other_volume.as_ref().unwrap_or(&self.cache), transfer_function),
        };
        let mut cells = match manner.exhaustive {
            true => cache.all(transfer_function, camera)?,
            false => cache.cull(transfer_function, camera, progress)?,
        };
        cells.lanes = self.lanes;
        let mut active_widgets = vec![true; transfer_function.widgets.len()];
        if let Some(choices) = choices {
            cells.inactive_widgets.iter().for_each(|&widget| active_widgets[widget] = false);
            // A part may lack the cells of a widget that the whole grid has.
            cells.inactive_widgets.clone_from(&choices.inactive_widgets);
            cells.casts_rays = choices.casts_rays == Some(true);
            if choices.casts_rays == Some(false) {
                cells.traversal = Traversal::Project;
            }
        }
        timer.end(Stage::Cull);
        let cells = sort(&cells, camera, scene.ordering(manner.exhaustive))?;
        timer.end(Stage::Sort);
        // For comparison segments carry all attributes.
        let gradient = needs_gradient(shading) || (manner.exhaustive && volume.gradient.is_some());
        let projection = project(&cells, transfer_function, camera, gradient, progress)?;
        timer.end(Stage::Project);
        Ok(ProjectedScene {
            transfer_function: transfer_function.clone(),
            projection,
            active_widgets,
            is_part: choices.is_some(),
            stages: timer.stages,
        })
    }

    fn draw_projected(
        &self,
        projected: ProjectedScene,
        scene: &Scene,
        manner: &RenderOptions,
        progress: &dyn Progress,
    ) -> Result<RenderOutput> {
        let ProjectedScene { transfer_function, projection, is_part, stages, .. } = projected;
        let (cells, mut timer) = (projection.cells(), StageTimer { stages, ..StageTimer::start() });
        let renderer = prepare_in_order(
            &projection,
            &transfer_function,
            &scene.shading,
            // A part may have fewer colours than the whole grid.
            manner.exhaustive || scene.has_events() || (is_part && scene.needs_order()),
        )?;
        timer.end(Stage::SetUp);
        let inputs = RayInputs { records_stretches: is_part, ..RayInputs::default() };
        let DrawnFrame { picture, counts, depth_image } = renderer.draw(inputs, Some(scene), progress)?;
        timer.end(Stage::Composite);
        let mut drawn = RenderOutput { part: depth_image, ..RenderOutput::new(picture, timer.stages) };
        drawn.notes = Diagnostics::new(manner.exhaustive);
        cells.count(&mut drawn.counts);
        cells.note(&mut drawn.notes);
        cells.note_order(&mut drawn.notes);
        projection.count(&mut drawn.counts);
        projection.note(&mut drawn.notes);
        counts.count(&mut drawn.counts);
        counts.note(&mut drawn.notes);
        Ok(drawn)
    }

    /// Cached segments to draw a preview from: of one sample a pixel in exact order, with values alone. They are recorded at the second
    /// change of widgets at one camera (12 bytes each, 20 with g).
    fn cached_segments(
        &self,
        scene: &Scene,
        manner: &RenderOptions,
        timer: &mut StageTimer,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<SegmentCache>>> {
        let Scene { transfer_function, camera, shading, .. } = scene;
        let is_cacheable = !manner.exhaustive
            && matches!(scene.ordering(false), Ordering::Independent | Ordering::PerPixel)
            && camera.samples == 1
            && !scene.has_events()
            && !transfer_function.has_curved_axes()
            // Tables extend to the longest of the drawn cells.
            && !shading.integrator.has_table_of_lengths()
            && !needs_gradient(shading);
        if !is_cacheable {
            return Ok(None);
        }
        let max_optical_depth = max_optical_depth(transfer_function, self.cache.length);
        let views = &self.cache.views;
        match views.plan(camera, transfer_function, self.cache.ranges, max_optical_depth) {
            Plan::Cells => Ok(None),
            Plan::Cached(segments) => Ok(Some(segments)),
            Plan::Record(max_optical_depth) => {
                let mut cells = self.cache.all_in_view(camera)?;
                (cells.lanes, cells.optical_depth_floor) = (self.lanes, max_optical_depth);
                let projection = project(&cells, transfer_function, camera, false, progress)?;
                timer.end(Stage::Project);
                let limit =
                    progress.memory_left().map_or(MAX_CACHE_BYTES, |left| MAX_CACHE_BYTES.min(left / 4));
                let renderer = prepare(&projection, transfer_function, shading)?;
                let segments = renderer.record(limit, progress)?.map(Arc::new);
                views.store(camera, segments.clone());
                timer.end(Stage::Sort);
                Ok(segments)
            }
        }
    }

    fn draw_cached(
        &self,
        segments: &SegmentCache,
        scene: &Scene,
        mut timer: StageTimer,
        progress: &dyn Progress,
    ) -> Result<RenderOutput> {
        let Scene { transfer_function, camera, shading, .. } = scene;
        let mut cells = self.cache.empty_in_view(camera)?;
        cells.lanes = self.lanes;
        let projection = project(&cells, transfer_function, camera, false, progress)?;
        let renderer = prepare(&projection, transfer_function, shading)?;
        timer.end(Stage::SetUp);
        let inputs = RayInputs { cache: Some(segments), ..RayInputs::default() };
        let DrawnFrame { picture, counts, .. } = renderer.draw(inputs, None, progress)?;
        timer.end(Stage::Composite);
        let mut drawn = RenderOutput { is_preview: true, ..RenderOutput::new(picture, timer.stages) };
        let why = "the segments of this view were kept when its widgets changed";
        drawn.notes.record_skipped("culling, projecting and sorting", why, None);
        counts.count(&mut drawn.counts);
        counts.note(&mut drawn.notes);
        Ok(drawn)
    }
}

/// Bytes of a view's cached segments at most.
const MAX_CACHE_BYTES: u64 = 1 << 30;

struct StageTimer {
    last: Instant,
    stages: Vec<StageTiming>,
}

impl StageTimer {
    fn start() -> StageTimer {
        StageTimer { last: Instant::now(), stages: Vec::new() }
    }

    fn end(&mut self, stage: Stage) {
        let now = Instant::now();
        self.stages.push(StageTiming::whole(stage, (now - self.last).as_secs_f64()));
        self.last = now;
    }
}

impl Cells {
    /// Fills in the counts of culling.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.culled_by_transfer_function = Some(self.culled_by_transfer_function);
        counts.culled_by_frustum = Some(self.culled_by_frustum);
    }

    /// Notes the widgets that are left out, and culling itself where it was skipped.
    pub fn note(&self, notes: &mut Diagnostics) {
        if let Some(CullSample { tested, dropped }) = self.culling_skipped {
            let percent = 100.0 * dropped as f64 / tested as f64;
            let why = format!(
                "not worth it: no widget touches {percent:.1} % of {tested} cells spread over the grid"
            );
            notes.record_skipped("culling by values", why, None);
        }
        for widget in &self.inactive_widgets {
            notes.record_skipped(format!("widget {}", widget + 1), "no visible cell touches it", None);
        }
    }

    /// Notes the cells that were sorted.
    pub fn note_order(&self, notes: &mut Diagnostics) {
        if self.ordering == Ordering::CellCentroid {
            notes.counts.insert("cells_sorted", self.ids.len() as u64);
        }
    }
}

impl Projection {
    /// Fills in the counts of the projection.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.cells_projected = self.cells_projected();
        counts.under_a_pixel =
            self.cells_projected().map(|projected| (self.cells().ids.len() as u64).saturating_sub(projected));
    }

    /// Notes the cells that rays are cast through, and the stages that this skips.
    pub fn note(&self, notes: &mut Diagnostics) {
        if self.cells_projected().is_none() {
            notes.counts.insert("cells_cast", self.cells().ids.len() as u64);
            let why = "rays go from cell to cell through the faces that these share";
            notes.record_skipped("projecting and sorting", why, None);
        }
    }
}

impl Counts {
    /// Fills in the counts of the compositor.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.segments = Some(self.segments);
        counts.segments_exact = Some(self.segments_exact);
        counts.evaluations = Some(self.evaluations);
        counts.pixels_disordered = Some(self.pixels_disordered);
        counts.tiles_stopped = Some(self.tiles_stopped);
        // Cells that no ray comes to are not counted.
        counts.cells_hidden = Some(self.cells_hidden).filter(|hidden| 0 < *hidden || self.tiles_stopped == 0);
        counts.tables_built = Some(u64::from(self.table_bytes > 0));
    }

    /// Notes the counts of this engine alone.
    pub fn note(&self, notes: &mut Diagnostics) {
        notes.counts.insert("tiles_sorted", self.tiles_sorted);
        notes.counts.insert("segments_overlapping", self.segments_overlapping);
        notes.counts.insert("tiles_deep", self.tiles_deep);
        notes.counts.insert("tiles_lost", self.tiles_lost);
    }
}
