//! Options of the page; a scene drawn in one way, and two ways in equal time.

use super::page::Paper;
use crate::work_precision::{
    self as work, Benches, Engines, Errors, Frames, RenderConfig, RendererVariant, StudyOptions, Subject,
};
use std::path::PathBuf;
use voltet_core::Result;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_nodes::drawing::NATIVE;
use voltet_optics::WidgetBlend;
use voltet_optics::engine::Accumulation;
use voltet_optics::shading::{Integrator, VisibilityOrder};

#[derive(Debug, Clone)]
pub struct PapersOptions {
    pub papers: Vec<Paper>,
    /// Pixels of the figures.
    pub size: [u32; 2],
    pub frames: Frames,
    /// The largest grid of Song's Table 1 that is generated.
    pub max_cells: u64,
    /// A folder that may hold `bluntfin.vtu`.
    pub data: Option<PathBuf>,
    /// Folder of the reference pictures.
    pub cache: PathBuf,
}

/// Opens one of the pipelines, by the path from the folder of the papers', with options as `--set` takes them.
pub type OpenPipeline<'a> = dyn Fn(&str, &[String]) -> Result<Subject> + 'a;

pub(super) struct Bench<'a> {
    pub wish: &'a PapersOptions,
    pub open: &'a OpenPipeline<'a>,
    pub progress: &'a dyn Progress,
}

#[derive(Debug, Clone)]
pub(super) struct TimedRender {
    pub picture: Picture,
    /// Median milliseconds of a picture, without what serves further ones.
    pub ms: f64,
    /// Milliseconds of that: tables.
    pub set_up_ms: f64,
    pub errors: Errors,
}

pub(super) struct Scene {
    pub subject: Subject,
    pub reference: Picture,
}

impl Bench<'_> {
    /// One of the pipelines, as it is but for these options.
    pub fn subject(&self, file: &str, options: &[String]) -> Result<Subject> {
        (self.open)(file, options)
    }

    pub fn sized(&self, file: &str) -> Result<Subject> {
        let [width, height] = self.wish.size;
        self.subject(file, &[format!("view.size=[{width},{height}]")])
    }

    /// One of the pipelines in the figures' size, with its reference picture.
    pub fn scene(&self, file: &str) -> Result<Scene> {
        self.referred(self.sized(file)?)
    }

    pub fn referred(&self, subject: Subject) -> Result<Scene> {
        let reference = work::reference(&subject, &self.wish.cache, self.progress)?.picture;
        Ok(Scene { subject, reference })
    }

    pub fn shot(&self, scene: &Scene, integrator: Integrator) -> Result<TimedRender> {
        let (picture, cost) = self.measured(&scene.subject, integrator)?;
        let errors = work::errors(&picture, &scene.reference);
        Ok(TimedRender { picture, ms: cost.frame.median_ms, set_up_ms: cost.set_up.median_ms, errors })
    }

    /// Draws a scene on the CPU without a reference.
    pub fn measured(&self, subject: &Subject, integrator: Integrator) -> Result<(Picture, work::Cost)> {
        let wish = StudyOptions {
            engines: Engines::One(NATIVE),
            frames: self.wish.frames,
            ..StudyOptions::default()
        };
        let setting = RenderConfig {
            variant: RendererVariant::NATIVE,
            integrator,
            overlap: WidgetBlend::Exact,
            order: VisibilityOrder::Exact,
            accumulation: Accumulation::Float,
        };
        Benches::open(subject, &wish)?.measure(subject, &setting, &wish.frames, self.progress)
    }

    /// As many samples a segment as take no longer than `ms`, at least one, at most 1024; and the picture.
    pub fn in_equal_time(
        &self,
        scene: &Scene,
        ms: f64,
        with: impl Fn(usize) -> Integrator,
    ) -> Result<(usize, TimedRender)> {
        let mut best = (1, self.shot(scene, with(1))?);
        let mut last = best.1.ms;
        while best.1.ms < ms && best.0 < 1024 {
            let count = 2 * best.0;
            let shot = self.shot(scene, with(count))?;
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
                return Ok((count, self.shot(scene, with(count))?));
            }
        }
        Ok(best)
    }
}

impl TimedRender {
    pub fn row(&self, names: &[&str]) -> Vec<String> {
        names.iter().map(|name| name.to_string()).chain(self.cells()).collect()
    }

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
