//! Quadrature of segments behind the traits of integrators, of the ray tracer and of engines.

use crate::curved_axes::CurvedQuadrature;
use crate::segment::{Integrand, PICTURE_TOLERANCE, Workspace};
use std::any::Any;
use std::cell::RefCell;
use std::sync::{Arc, OnceLock};
use std::time::Instant;
use voltet_core::parameters::VariantSchema;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_optics::engine::{
    Engine, EngineInfo, PreparedVolume, RenderOptions, RenderOutput, Stage, StageTiming,
};
use voltet_optics::integrators::{Extent, Integrator, IntegratorKind, SegmentIntegrator};
use voltet_optics::scene::Scene;
use voltet_optics::trace::tiles::Tiles;
use voltet_optics::trace::{SegmentIntegral, Tracer};
use voltet_optics::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};

/// Kind of the integrator `reference`, which has an engine of its own.
pub(crate) struct ReferenceKind;

impl IntegratorKind for ReferenceKind {
    fn schema(&self) -> VariantSchema {
        VariantSchema { name: NAME, summary: "64-bit adaptive quadrature, slow", parameters: &[] }
    }

    fn compile(
        &self,
        _: &Integrator,
        blend: WidgetBlend,
        transfer_function: &TransferFunction,
        _: &Extent,
    ) -> Result<Box<dyn SegmentIntegrator>> {
        Ok(Box::new(Reference::new(transfer_function, blend)?))
    }

    fn extensions(&self) -> &'static [&'static (dyn Any + Send + Sync)] {
        &[&ENGINE]
    }
}

/// Adaptive quadrature to a relative 1e-11.
pub struct Reference {
    integrand: Integrand,
    /// Closed forms, for values that are not finite, which contribute nothing.
    prepared: CompiledTransferFunction,
    overlap: WidgetBlend,
    failure: OnceLock<Error>,
}

impl Reference {
    /// Quadrature of a transfer function. Errors: a number out of range.
    pub fn new(transfer_function: &TransferFunction, overlap: WidgetBlend) -> Result<Self> {
        Ok(Reference {
            prepared: CompiledTransferFunction::new(transfer_function)?,
            integrand: Integrand::new(transfer_function, overlap, PICTURE_TOLERANCE)?,
            overlap,
            failure: OnceLock::new(),
        })
    }
}

thread_local! {
    static WORK: RefCell<(Workspace, Vec<f64>, Vec<f64>)> = RefCell::default();
}

impl SegmentIntegrator for Reference {
    fn integrate(&self, segment: &Segment) -> Contribution {
        let ends = [segment.front, segment.back];
        let fields = segment.fields_front.iter().chain(segment.fields_back);
        if !ends.iter().flatten().chain(fields).all(|x| x.is_finite()) {
            return self.prepared.integrate(segment, self.overlap);
        }
        WORK.with_borrow_mut(|(work, front, back)| {
            let fill = |values: &mut Vec<f64>, pair: [f64; 2], fields: &[f64]| {
                values.clear();
                values.extend(pair);
                values.extend(fields);
            };
            fill(front, segment.front, segment.fields_front);
            fill(back, segment.back, segment.fields_back);
            self.integrand.integrate(segment.length, front, back, work).unwrap_or_else(|error| {
                // Of several failures one is enough.
                let _ = self.failure.set(error);
                Contribution::default()
            })
        })
    }

    fn failure(&self) -> Option<&Error> {
        self.failure.get()
    }
}

impl SegmentIntegral for Integrand {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        WORK.with_borrow_mut(|(work, ..)| self.integrate(length, front, back, work))
    }

    fn max_color(&self, length: f64) -> f64 {
        self.brightest(length)
    }
}

/// Name of the engine and of its integrator.
pub(crate) const NAME: &str = "reference";

/// Reference renderer. It draws every scene by quadrature, whatever the integrator, and serves that of its name.
pub const ENGINE: EngineInfo = EngineInfo {
    name: NAME,
    summary: "64-bit adaptive quadrature, slow",
    taken: None,
    unavailable_reason: None,
    on_device: false,
    draws_parts: false,
    compositing: &[],
    can_serve: |_, shading| match shading.integrator.name() == NAME {
        true => Ok(()),
        false => Err(Error::usage("the 64-bit reference has one integrator")
            .got(shading.integrator.name())
            .expected(NAME)),
    },
    adapters: Vec::new,
    open: |_| Ok(Arc::new(ReferenceRenderer)),
};

#[derive(Debug, Clone, Copy)]
struct ReferenceRenderer;

impl Engine for ReferenceRenderer {
    fn adapter(&self) -> String {
        format!("64 bits, {} threads", rayon::current_num_threads())
    }

    fn reason(&self) -> Option<&str> {
        Some("the integrator is the 64-bit reference")
    }

    fn prepare(&self, _volume: &Arc<Volume>) -> Result<Arc<dyn PreparedVolume>> {
        Ok(Arc::new(ReferenceRenderer))
    }
}

impl PreparedVolume for ReferenceRenderer {
    fn draw(&self, scene: &Scene, _manner: &RenderOptions, progress: &dyn Progress) -> Result<RenderOutput> {
        let start = Instant::now();
        let picture = draw(scene, progress)?;
        let seconds = start.elapsed().as_secs_f64();
        Ok(RenderOutput::new(
            picture,
            vec![StageTiming { stage: Stage::Composite, pass: Some("reference"), seconds }],
        ))
    }
}

/// Ray tracer of a scene. Errors: arrays that are missing, numbers out of range.
pub fn tracer(scene: &Scene) -> Result<Tracer<'_>> {
    if scene.transfer_function.has_curved_axes() {
        return Tracer::new(scene, Box::new(CurvedQuadrature::new(&scene.transfer_function)?));
    }
    let integrand = Integrand::new(&scene.transfer_function, scene.shading.overlap, PICTURE_TOLERANCE)?;
    Tracer::new(scene, Box::new(integrand))
}

/// Draws the scene in 64 bits. Errors: arrays that are missing, numbers out of range, a stopped run.
pub fn draw(scene: &Scene, progress: &dyn Progress) -> Result<Picture> {
    tracer(scene)?.draw(progress)
}

/// Like [`draw`], from the tiles that are there already; where it ends early, `tiles` holds those that are drawn.
pub fn draw_further(scene: &Scene, tiles: &mut Tiles, progress: &dyn Progress) -> Result<Picture> {
    tracer(scene)?.draw_further(tiles, progress)
}
