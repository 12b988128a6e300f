//! The native engine as one of the program's engines, and what it counts.

use crate::draw::densest;
use crate::kept::{Kept, Plan};
use crate::{Cells, Counts, Known, Projection, Sample, Segments, needs_gradient, prepare, project, sort};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_graph::{MayLeaveOut, NodeDiagnostics};
use voltet_optics::engine::{
    self, AdapterRequest, Engine, EngineInfo, PreparedVolume, RenderOptions, RenderOutput, SegmentEvaluator,
    Stage, StageTiming,
};
use voltet_optics::integrators::{self, PreparedScene, ScenePreparation};
use voltet_optics::scene::Scene;
use voltet_optics::shading::VisibilityOrder;
use voltet_simd::LaneSet;

/// The native engine. Its vector units are what is judged one by one.
pub const ENGINE: EngineInfo = EngineInfo {
    name: "cpu",
    summary: "native code on all cores",
    taken: Some("the CPU"),
    unavailable_reason: None,
    on_device: false,
    compositing: &[],
    can_serve: |transfer_function, shading| integrators::can_serve(&shading.integrator, transfer_function),
    adapters: Vec::new,
    open: |_, _| Ok(Arc::new(Native { lanes: LaneSet::detect()? })),
    open_each,
};

fn open_each(_wish: &AdapterRequest) -> Result<Vec<Arc<dyn Engine>>> {
    let sets = LaneSet::ALL.into_iter().rev();
    let native = |lanes| Arc::new(Native { lanes }) as Arc<dyn Engine>;
    Ok(sets.filter(|lanes| lanes.is_supported()).map(native).collect())
}

/// The engine on one lane set.
#[derive(Debug, Clone, Copy)]
struct Native {
    lanes: LaneSet,
}

impl Engine for Native {
    fn adapter(&self) -> String {
        format!("{}, {} threads", self.lanes.name(), rayon::current_num_threads())
    }

    fn label(&self) -> String {
        format!("native engine, {}", self.lanes.name())
    }

    fn forms(&self) -> Option<Box<dyn SegmentEvaluator>> {
        Some(Box::new(Segments { lanes: self.lanes, ordered: false }))
    }

    fn prepare(&self, volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        let known = Known::new(volume)?;
        Ok(Arc::new(OnVolume { lanes: self.lanes, known, prepared: Mutex::new(None) }))
    }
}

/// The engine with what it knows of one volume.
#[derive(Debug)]
struct OnVolume {
    lanes: LaneSet,
    known: Known,
    /// The scene that an integrator prepared last: it serves the next picture, as a table does.
    prepared: Mutex<Option<Arc<Prepared>>>,
}

/// A volume and a transfer function that an integrator prepared ([`ScenePreparation`]).
#[derive(Debug)]
struct Prepared {
    /// The integrator, the volume and the transfer function that they were prepared from.
    source: (&'static str, Arc<Volume>, Arc<TransferFunction>),
    known: Known,
    transfer_function: Arc<TransferFunction>,
}

impl OnVolume {
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
            known: Known::new(&Arc::new(volume))?,
            transfer_function: Arc::new(transfer_function),
        });
        *last = Some(prepared.clone());
        Ok(prepared)
    }
}

impl PreparedVolume for OnVolume {
    fn draw(&self, scene: &Scene, manner: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput> {
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        let preparation = scene.shading.integrator.kind().scene_preparation();
        let prepared = preparation.map(|preparation| self.prepared(scene, preparation)).transpose()?;
        let Scene { volume, transfer_function, camera, shading, order } = scene;
        let mut watch = Watch { last: Instant::now(), stages: Vec::new() };
        let elsewhere = match Arc::ptr_eq(volume, self.known.volume()) || prepared.is_some() {
            true => None,
            false => Some(Known::new(volume)?),
        };
        if manner.passing
            && prepared.is_none()
            && elsewhere.is_none()
            && let Some(kept) = self.kept(scene, manner, &mut watch, progress)?
        {
            return self.draw_kept(&kept, scene, manner, watch, progress);
        }
        let (known, transfer_function) = match &prepared {
            Some(prepared) => (&prepared.known, &prepared.transfer_function),
            None => (elsewhere.as_ref().unwrap_or(&self.known), transfer_function),
        };
        let mut cells = match manner.may_leave_out {
            None => known.keep_all(transfer_function, camera)?,
            Some(_) => known.cull(transfer_function, camera, progress)?,
        };
        cells.lanes = self.lanes;
        watch.end(Stage::Cull);
        let cells = sort(&cells, camera, *order)?;
        watch.end(Stage::Sort);
        // For comparison everything that there is goes along.
        let gradient =
            needs_gradient(shading) || (manner.may_leave_out.is_none() && volume.gradient.is_some());
        let projection = project(&cells, transfer_function, camera, gradient, progress)?;
        watch.end(Stage::Project);
        let ready = prepare(&projection, transfer_function, shading)?;
        watch.end(Stage::SetUp);
        let (picture, counts) = ready.composite(progress)?;
        watch.end(Stage::Composite);
        let mut drawn = RenderOutput::new(picture, watch.stages);
        cells.count(&mut drawn.counts);
        if let Some(leave) = manner.may_leave_out {
            cells.note(leave, &mut drawn.notes);
        }
        cells.note_order(&mut drawn.notes);
        projection.count(&mut drawn.counts);
        projection.note(manner.may_leave_out, &mut drawn.notes);
        counts.count(&mut drawn.counts);
        counts.note(&mut drawn.notes);
        Ok(drawn)
    }
}

impl OnVolume {
    /// The segments to draw a passing picture from, where they were kept or now are: of one sample a pixel in exact order, with values
    /// alone. They are kept at the second change of widgets at one camera (12 bytes each, 20 with g).
    fn kept(
        &self,
        scene: &Scene,
        manner: &RenderOptions,
        watch: &mut Watch,
        progress: &dyn Progress,
    ) -> Result<Option<Arc<Kept>>> {
        let Scene { transfer_function, camera, shading, order, .. } = scene;
        let served = manner.may_leave_out.is_some()
            && matches!(order, VisibilityOrder::Exact | VisibilityOrder::Auto)
            && camera.samples == 1
            // Tables reach as far as the longest of the cells that are drawn.
            && !shading.integrator.has_table_of_lengths()
            && !needs_gradient(shading);
        if !served {
            return Ok(None);
        }
        let densest = densest(transfer_function, self.known.length());
        let views = self.known.views();
        match views.plan(camera, transfer_function, self.known.ranges(), densest) {
            Plan::Cells => Ok(None),
            Plan::Kept(kept) => Ok(Some(kept)),
            Plan::Keep(densest) => {
                let mut cells = self.known.all_in_view(camera)?;
                (cells.lanes, cells.densest_least) = (self.lanes, densest);
                let projection = project(&cells, transfer_function, camera, false, progress)?;
                watch.end(Stage::Project);
                let limit = progress.memory_left().map_or(KEPT_MOST, |left| KEPT_MOST.min(left / 4));
                let ready = prepare(&projection, transfer_function, shading)?;
                let kept = ready.keep(limit, progress)?.map(Arc::new);
                views.keep(camera, kept.clone());
                watch.end(Stage::Sort);
                Ok(kept)
            }
        }
    }

    fn draw_kept(
        &self,
        kept: &Kept,
        scene: &Scene,
        manner: &RenderOptions,
        mut watch: Watch,
        progress: &dyn Progress,
    ) -> Result<RenderOutput> {
        let Scene { transfer_function, camera, shading, .. } = scene;
        let mut cells = self.known.none_in_view(camera)?;
        cells.lanes = self.lanes;
        let projection = project(&cells, transfer_function, camera, false, progress)?;
        let ready = prepare(&projection, transfer_function, shading)?;
        watch.end(Stage::SetUp);
        let (picture, counts) = ready.composite_kept(kept, progress)?;
        watch.end(Stage::Composite);
        let mut drawn = RenderOutput { is_passing: true, ..RenderOutput::new(picture, watch.stages) };
        if let Some(leave) = manner.may_leave_out {
            let why = "the segments of this view were kept when its widgets changed";
            drawn.notes.record_skipped(leave, "culling, projecting and sorting", why, None);
        }
        counts.count(&mut drawn.counts);
        counts.note(&mut drawn.notes);
        Ok(drawn)
    }
}

/// Bytes that are kept of a view at most.
const KEPT_MOST: u64 = 1 << 30;

/// Times stages that follow each other.
struct Watch {
    last: Instant,
    stages: Vec<StageTiming>,
}

impl Watch {
    fn end(&mut self, stage: Stage) {
        let now = Instant::now();
        self.stages.push(StageTiming::whole(stage, (now - self.last).as_secs_f64()));
        self.last = now;
    }
}

impl Cells {
    /// Fills in what was culled.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.culled_by_transfer_function = Some(self.culled_by_transfer_function);
        counts.culled_by_frustum = Some(self.culled_by_frustum);
    }

    /// Notes the widgets that are left out, and culling itself where it is.
    pub fn note(&self, leave: MayLeaveOut, notes: &mut NodeDiagnostics) {
        if let Some(Sample { asked, dropped }) = self.not_worth_asking {
            let share = 100.0 * dropped as f64 / asked as f64;
            let why =
                format!("not worth it: no widget touches {share:.1} % of {asked} cells spread over the grid");
            notes.record_skipped(leave, "culling by values", why, None);
        }
        for widget in &self.untouched {
            notes.record_skipped(leave, format!("widget {}", widget + 1), "no visible cell touches it", None);
        }
    }

    /// Notes the cells that were put in order.
    pub fn note_order(&self, notes: &mut NodeDiagnostics) {
        if self.order == VisibilityOrder::Centroid {
            notes.counts.insert("cells_sorted", self.kept.len() as u64);
        }
    }
}

impl Projection {
    /// Fills in what was projected.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.cells_projected = self.cells_projected();
        counts.under_a_pixel = self
            .cells_projected()
            .map(|projected| (self.cells().kept.len() as u64).saturating_sub(projected));
    }

    /// Notes the cells that rays go through, and what they leave out.
    pub fn note(&self, leave: Option<MayLeaveOut>, notes: &mut NodeDiagnostics) {
        if self.cells_projected().is_none() {
            notes.counts.insert("cells_cast", self.cells().kept.len() as u64);
            if let Some(leave) = leave {
                let why = "rays go from cell to cell through the faces that these share";
                notes.record_skipped(leave, "projecting and sorting", why, None);
            }
        }
    }
}

impl Counts {
    /// Fills in what was composited.
    pub fn count(&self, counts: &mut engine::RenderStats) {
        counts.segments = Some(self.segments);
        counts.segments_exact = Some(self.segments_exact);
        counts.evaluations = Some(self.evaluations);
        counts.pixels_disordered = Some(self.pixels_disordered);
        counts.tiles_stopped = Some(self.tiles_stopped);
        // Nobody counts the cells that rays do not come to.
        counts.cells_hidden = Some(self.cells_hidden).filter(|hidden| 0 < *hidden || self.tiles_stopped == 0);
        counts.tables_built = Some(u64::from(self.table_bytes > 0));
    }

    /// Notes what is this engine's own.
    pub fn note(&self, notes: &mut NodeDiagnostics) {
        notes.counts.insert("tiles_sorted", self.tiles_sorted);
        notes.counts.insert("segments_overlapping", self.segments_overlapping);
        notes.counts.insert("tiles_deep", self.tiles_deep);
        notes.counts.insert("tiles_lost", self.tiles_lost);
    }
}
