//! A scene drawn in one way, and two ways in equal time.

use super::options::{OpenPipeline, PapersOptions};
use crate::work_precision::{
    self as work, Benches, Engines, Errors, Measure, Reference, RenderConfig, RendererVariant, Subject,
};
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_nodes::drawing::NATIVE;
use voltet_optics::WidgetBlend;
use voltet_optics::engine::Accumulation;
use voltet_optics::shading::{Integrator, VisibilityOrder};

/// Renderer of the papers' scenes.
pub(super) struct Bench<'a> {
    pub wish: &'a PapersOptions,
    open: &'a OpenPipeline<'a>,
    pub progress: &'a dyn Progress,
}

/// A picture with its time and what it is off by.
#[derive(Debug, Clone)]
pub(super) struct TimedRender {
    pub picture: Picture,
    /// Median milliseconds of a picture, without what serves further ones.
    pub ms: f64,
    /// Milliseconds of that: tables.
    pub set_up_ms: f64,
    pub errors: Errors,
}

/// A scene with its reference picture.
pub(super) struct Scene {
    pub subject: Subject,
    pub reference: Picture,
}

impl<'a> Bench<'a> {
    pub fn new(wish: &'a PapersOptions, open: &'a OpenPipeline<'a>, progress: &'a dyn Progress) -> Self {
        Bench { wish, open, progress }
    }

    /// One of the pipelines, as it is but for these options.
    pub fn subject(&self, file: &str, options: &[String]) -> Result<Subject> {
        (self.open)(file, options)
    }

    /// One of the pipelines in the figures' size, with its reference picture.
    pub fn scene(&self, file: &str) -> Result<Scene> {
        let [width, height] = self.wish.size;
        self.referred(self.subject(file, &[format!("view.size=[{width},{height}]")])?)
    }

    /// A scene with its reference picture.
    pub fn referred(&self, subject: Subject) -> Result<Scene> {
        let Reference { picture, .. } = work::reference(&subject, &self.wish.cache, self.progress)?;
        Ok(Scene { subject, reference: picture })
    }

    /// A scene drawn on the CPU.
    pub fn shot(&self, scene: &Scene, integrator: Integrator, overlap: WidgetBlend) -> Result<TimedRender> {
        let Scene { subject, reference } = scene;
        let (picture, cost) = self.measured(subject, integrator, overlap)?;
        let errors = work::errors(&picture, reference);
        Ok(TimedRender { picture, ms: cost.frame.median_ms, set_up_ms: cost.set_up.median_ms, errors })
    }

    /// Draws a scene on the CPU without a reference.
    pub fn measured(
        &self,
        subject: &Subject,
        integrator: Integrator,
        overlap: WidgetBlend,
    ) -> Result<(Picture, work::Cost)> {
        let wish = work::StudyOptions {
            only: Vec::new(),
            engines: Engines::One(NATIVE),
            adapter: None,
            frames: self.wish.frames,
            measure: Measure::Maximum,
            max_error: None,
            refine: 0,
        };
        let (variant, order, accumulation) =
            (RendererVariant::NATIVE, VisibilityOrder::Exact, Accumulation::Float);
        let setting = RenderConfig { variant, integrator, overlap, order, accumulation };
        Benches::open(subject, &wish)?.measure(subject, &setting, &wish.frames, self.progress)
    }

    /// As many samples a segment as take no longer than `ms`, at least one, at most 1024; and the picture.
    pub fn in_equal_time(
        &self,
        scene: &Scene,
        ms: f64,
        with: impl Fn(usize) -> Integrator,
    ) -> Result<(usize, TimedRender)> {
        let mut best = (1, self.shot(scene, with(1), WidgetBlend::Exact)?);
        let mut last = best.1.ms;
        while best.1.ms < ms && best.0 < 1024 {
            let count = 2 * best.0;
            let shot = self.shot(scene, with(count), WidgetBlend::Exact)?;
            last = shot.ms;
            if shot.ms > ms {
                break;
            }
            best = (count, shot);
        }
        // Between two powers of two the time is about linear.
        let share = (ms - best.1.ms) / (last - best.1.ms);
        if last > ms && share.is_finite() && share > 0.0 {
            let count = best.0 + (share.min(1.0) * best.0 as f64) as usize;
            if count > best.0 {
                return Ok((count, self.shot(scene, with(count), WidgetBlend::Exact)?));
            }
        }
        Ok(best)
    }
}

impl TimedRender {
    /// Time and errors as cells of a table: ms, with those of tables behind a plus; rms, largest, pixels over a step of 8 bits.
    pub fn cells(&self) -> [String; 4] {
        let Errors { root_mean_square, maximum, pixels_over_step, .. } = self.errors;
        let tables = if self.set_up_ms < 1.0 { String::new() } else { format!(" + {:.1}", self.set_up_ms) };
        [
            format!("{:.1}{tables}", self.ms),
            format!("{root_mean_square:.1e}"),
            format!("{maximum:.1e}"),
            pixels_over_step.to_string(),
        ]
    }
}
