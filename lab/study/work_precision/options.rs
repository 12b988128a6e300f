//! Options of a study.

use std::time::Duration;
use voltet_core::camera::Camera;
use voltet_core::{Error, Result};
use voltet_graph::suggest;
use voltet_nodes::drawing::{ENGINES, NATIVE};
use voltet_optics::engine::{Compositor, EngineInfo};
use voltet_optics::scene::Scene;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Measure {
    #[default]
    Maximum,
    RootMeanSquare,
    /// 99.9th percentile of the pixels' errors.
    Percentile,
    Flip,
}

impl Measure {
    /// Every measure with its name on the command line and a description.
    pub const NAMES: [(Measure, &'static str, &'static str); 4] = [
        (Measure::Maximum, "max", "The largest difference of a channel of premultiplied linear RGBA"),
        (Measure::RootMeanSquare, "rms", "The root of the mean square of these differences"),
        (Measure::Percentile, "p99.9", "The 99.9th percentile of these differences"),
        (Measure::Flip, "flip", "The perceptual difference FLIP, mean over the pixels"),
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        Measure::NAMES[self as usize].1
    }

    pub fn label(self) -> &'static str {
        match self {
            Measure::Maximum => "largest error of premultiplied linear RGBA (1 = full scale)",
            Measure::RootMeanSquare => "root-mean-square error of premultiplied linear RGBA (1 = full scale)",
            Measure::Percentile => {
                "99.9 percentile of the error of premultiplied linear RGBA (1 = full scale)"
            }
            Measure::Flip => "mean FLIP difference (0 = equal, 1 = largest)",
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// Frames that count, at most, ≥ 1. One before them warms up.
    pub count: usize,
    /// No further frame begins once a setting has taken this long. Where the first one already does, it counts.
    pub patience: Duration,
    /// Degrees that the camera turns about its target before each frame, so that nothing of the former one can be used
    /// again; 0: it stands still.
    pub turn: f64,
    /// Frames of a device that are in flight at a time while it is measured how fast they follow each other; below 2 that is not
    /// measured.
    pub in_flight: usize,
}

impl Frames {
    pub(super) fn scene(&self, scene: &Scene, number: usize) -> Scene {
        let mut turned = scene.clone();
        let Camera { eye, target, up, .. } = scene.camera;
        if self.turn != 0.0 {
            let by = glam::DQuat::from_axis_angle(up.normalize(), (self.turn * number as f64).to_radians());
            turned.camera.eye = target + by * (eye - target);
        }
        turned
    }
}

#[derive(Debug, Clone)]
pub struct StudyOptions {
    /// Integrators to look at; none for all.
    pub only: Vec<String>,
    pub engines: Engines,
    /// The adapter, by a part of its name or its kind; none for the file's, or the fastest that is hardware.
    pub adapter: Option<String>,
    /// Number of times each is drawn.
    pub frames: Frames,
    /// Measure of error that decides about the front and the recommendation.
    pub measure: Measure,
    pub max_error: Option<f64>,
    /// Number of times the grid is refined, to tell the integration's error from the data model's; 0: not at all.
    pub refine: u32,
}

impl Default for StudyOptions {
    fn default() -> StudyOptions {
        let frames = Frames { count: 5, patience: Duration::from_secs(10), turn: 0.0, in_flight: 1 };
        StudyOptions {
            only: Vec::new(),
            engines: Engines::All,
            adapter: None,
            frames,
            measure: Measure::Maximum,
            max_error: None,
            refine: 0,
        }
    }
}

impl StudyOptions {
    /// Refuses what cannot be measured. `integrators`: names of those that can be studied; `named`: the option of a name as it was given.
    pub fn check(&self, integrators: &[&str], named: impl Fn(&str) -> String) -> Result<()> {
        if let Some(name) = self.only.iter().find(|name| !integrators.contains(&name.as_str())) {
            let error = Error::usage(format!("{} names no integrator that can be studied", named("only")));
            return Err(error.got(name).expected(suggest(name, integrators.iter().copied())));
        }
        let wrong = |name: &str, found: String, expected: &str| {
            Err(Error::usage(format!("{} is out of range", named(name))).got(found).expected(expected))
        };
        if let Some(bound) = self.max_error.filter(|bound| !(bound.is_finite() && *bound >= 0.0)) {
            return wrong("max_error", bound.to_string(), "a number of at least 0");
        }
        if !self.frames.turn.is_finite() {
            return wrong("turn", self.frames.turn.to_string(), "a number of degrees");
        }
        if self.frames.count == 0 {
            return wrong("frames", "0".into(), "1 or more");
        }
        let no_device = self.engines.each().all(|engine| !engine.on_device);
        match self.adapter.as_ref().filter(|_| no_device) {
            Some(adapter) => {
                let what = format!(
                    "{} names a graphics device, and {} asks for none",
                    named("adapter"),
                    named("engine")
                );
                let without = format!("{} gpu or all, or no {}", named("engine"), named("adapter"));
                Err(Error::usage(what).got(adapter).expected(without))
            }
            None => Ok(()),
        }
    }
}

/// A patience of so many seconds; a year is longer than any, and does not overflow. Errors: a number that is none; `named`: its option.
pub fn patience(seconds: f64, named: &str) -> Result<Duration> {
    match seconds.is_finite() && seconds >= 0.0 {
        true => Ok(Duration::from_secs_f64(seconds.min(3e7))),
        false => {
            let error = Error::usage(format!("{named} is out of range"));
            Err(error.got(seconds).expected("a number of at least 0"))
        }
    }
}

/// Engine and, if it has several, its compositor.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RendererVariant {
    pub engine: &'static EngineInfo,
    /// Its compositor; `None` if it has one only.
    pub compositing: Option<Compositor>,
}

#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Engines {
    /// This one alone.
    One(&'static EngineInfo),
    #[default]
    All,
}

impl RendererVariant {
    pub const NATIVE: RendererVariant = RendererVariant { engine: NATIVE, compositing: None };

    pub fn all_of_engine(engine: &'static EngineInfo) -> impl Iterator<Item = RendererVariant> {
        let only = engine.compositing.is_empty().then_some(None);
        let ways = only.into_iter().chain(engine.compositing.iter().copied().map(Some));
        ways.map(move |compositing| RendererVariant { engine, compositing })
    }

    pub fn all() -> impl Iterator<Item = RendererVariant> {
        ENGINES.iter().flat_map(RendererVariant::all_of_engine)
    }

    /// The compositor's name in pipeline files.
    pub fn compositor(self) -> Option<&'static str> {
        self.compositing.map(Compositor::name)
    }

    /// Both names, for people: "cpu", "gpu tiles".
    pub fn label(self) -> String {
        match self.compositor() {
            None => self.engine.name.into(),
            Some(compositor) => format!("{} {compositor}", self.engine.name),
        }
    }

    /// Its place among all.
    pub fn number(self) -> usize {
        RendererVariant::all().position(|known| known == self).unwrap_or_default()
    }
}

impl Engines {
    pub fn each(self) -> impl Iterator<Item = &'static EngineInfo> {
        ENGINES.iter().filter(move |engine| match self {
            Engines::One(only) => *engine == only,
            Engines::All => true,
        })
    }
}
