//! The engines that settings are measured on, and one setting, drawn again and again: seconds of every stage, memory, and the
//! picture.

use crate::devices;
use crate::work_precision::settings::settings;
use crate::work_precision::subject::RendererNode;
use crate::work_precision::{Engines, Frames, RenderConfig, RendererVariant, StudyOptions, Subject};
use serde::Serialize;
use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::{Error, Result};
use voltet_introspect::clear_caches;
use voltet_io::memory;
use voltet_nodes::drawing::{ENGINES, NATIVE, is_asked_by};
use voltet_optics::engine::{
    Engine, EngineInfo, PreparedVolume, RenderOptions, RenderOutput, Stage, StageTiming,
};
use voltet_optics::scene::Scene;

/// Engines to measure on.
pub struct Benches {
    benches: Vec<Bench>,
    /// The engines that the file may come to here, in the order in which they are asked; `None`: one that is not measured.
    file_takes: Option<Vec<&'static EngineInfo>>,
    /// Engines that are not measured, with the reason and the remedy.
    pub left_out: Vec<String>,
}

/// An open engine.
struct Bench {
    declared: &'static EngineInfo,
    adapter: Option<String>,
    engine: Arc<dyn Engine>,
}

/// A device that a study is made on.
#[derive(Debug, Clone, PartialEq)]
pub struct Adapter {
    pub engine: &'static EngineInfo,
    /// Its name and kind, for people.
    pub name: String,
    /// Name that requests it, where it is not the one that `auto` takes.
    pub wish: Option<String>,
    /// True if it is a program on the CPU.
    pub is_software: bool,
}

impl Bench {
    fn open(declared: &'static EngineInfo, adapter: Option<&str>) -> Result<Bench> {
        let engine = devices::open(declared, adapter)?;
        Ok(Bench { declared, adapter: adapter.map(str::to_string), engine })
    }
}

impl Benches {
    /// Opens each engine that is asked for, on the adapter that is named, else the one that the file names, else the fastest
    /// that is hardware. Where several are to be looked at, a device that is not there is left out.
    ///
    /// Errors: a device that was named or is all that was asked for, and is not there or cannot draw the pipeline.
    pub fn open(subject: &Subject, wish: &StudyOptions) -> Result<Benches> {
        let (mut benches, mut left_out) = (Vec::new(), Vec::new());
        for engine in wish.engines.each() {
            match open(subject, wish, engine) {
                Ok(bench) => benches.push(bench),
                Err(error) if wish.engines != Engines::All || wish.adapter.is_some() => return Err(error),
                Err(error) => left_out.push(format!("the device: {error}")),
            }
        }
        let file_takes = takes(subject, wish, &benches);
        Ok(Benches { benches, file_takes, left_out })
    }

    pub fn adapters(&self, subject: &Subject, wish: &StudyOptions) -> Vec<Adapter> {
        let on_device = self.benches.iter().filter(|bench| bench.declared.on_device);
        let adapter = |bench: &Bench| Adapter {
            engine: bench.declared,
            name: bench.engine.adapter(),
            wish: wish.adapter.clone().or_else(|| subject.asked.adapter.clone()),
            is_software: bench.engine.is_software(),
        };
        on_device.map(adapter).collect()
    }

    /// Configurations to measure, engine by engine.
    pub fn settings(&self, subject: &Subject, only: &[String]) -> Vec<RenderConfig> {
        let variants = self.benches.iter().flat_map(|bench| RendererVariant::all_of_engine(bench.declared));
        variants.flat_map(|variant| settings(subject, only, variant)).collect()
    }

    pub fn measure(
        &mut self,
        subject: &Subject,
        setting: &RenderConfig,
        frames: &Frames,
        progress: &dyn Progress,
    ) -> Result<(Picture, Cost)> {
        let found = self.benches.iter_mut().find(|bench| bench.declared == setting.variant.engine);
        let Some(bench) = found else {
            return Err(Error::run("there is no such engine to measure on").got(setting.variant.label()));
        };
        if bench.engine.is_lost() {
            bench.engine = devices::open(bench.declared, bench.adapter.as_deref())?;
        }
        measure(bench.engine.as_ref(), subject, setting, frames, progress)
    }

    /// Configuration by which the file draws on this machine. `refused`: configurations that an engine does not draw, where `auto` takes another; `None`: on a
    /// device that is not measured.
    pub(super) fn own(
        &self,
        subject: &Subject,
        refused: &dyn Fn(&RenderConfig) -> bool,
    ) -> Option<RenderConfig> {
        for engine in self.file_takes.as_ref()? {
            let own = RenderConfig::of_file(subject, subject.painter_on(engine)?);
            if !(subject.asked.is_auto() && refused(&own)) {
                return Some(own);
            }
        }
        None
    }
}

/// The engines that the file may come to here, `benches` being what is measured.
fn takes(subject: &Subject, wish: &StudyOptions, benches: &[Bench]) -> Option<Vec<&'static EngineInfo>> {
    let asked = &subject.asked;
    let may = |engine: &&EngineInfo| is_asked_by(engine, &asked.engine);
    let mut taken = Vec::new();
    for engine in ENGINES.iter().rev().filter(may) {
        let bench = benches.iter().find(|bench| bench.declared == engine);
        let same_wish = wish.adapter.is_none() || wish.adapter == asked.adapter;
        if engine.on_device && !(bench.is_some() && same_wish) {
            match (Bench::open(engine, asked.adapter.as_deref()), bench) {
                (Ok(files), Some(bench)) if files.engine.adapter() == bench.engine.adapter() => {}
                (Err(_), _) if asked.is_auto() => continue,
                _ => return None,
            }
        }
        taken.push(engine);
    }
    Some(taken)
}

fn open(subject: &Subject, wish: &StudyOptions, engine: &'static EngineInfo) -> Result<Bench> {
    let asked = &subject.asked;
    if !engine.on_device {
        return Bench::open(engine, None);
    }
    if asked.form == RendererNode::Stages && engine != NATIVE {
        let what =
            "the stages of the pipeline, one by one, are the native engine's: no device stands in for them";
        let accepted = "a pipeline that draws with a node of type \"renderer\"";
        return Err(Error::usage(what)
            .got(format!("'{}' of type \"composite\"", subject.node))
            .expected(accepted));
    }
    let named = wish.adapter.as_ref().or(asked.adapter.as_ref());
    Bench::open(engine, named.map(String::as_str))
}

/// Median and spread of repeated times, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    /// The median; of an even number of times the mean of the middle two.
    pub median_ms: f64,
    pub fastest_ms: f64,
    pub slowest_ms: f64,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    pub frames: usize,
    /// A picture, with all that a run makes anew for each one: the native engine its set-up and the frame, a device, which
    /// keeps what it has set up, the frame.
    pub picture: Times,
    /// Work before a frame that further ones can use: tables, compiled widgets; on a device also uploads and
    /// pipelines.
    pub set_up: Times,
    /// A frame: the stages below together, on a device also what lies between them and the way back.
    pub frame: Times,
    /// Culling; this and the next three are `None` on a device that does not time its passes.
    pub cull: Option<Times>,
    /// Ordering the cells; on a device, sharing them out among tiles too.
    pub sort: Option<Times>,
    pub project: Option<Times>,
    pub composite: Option<Times>,
    /// From one frame to the next of a device, milliseconds, with as many in flight as was asked for.
    pub in_flight_ms: Option<f64>,
    /// The passes of a device that times them.
    pub passes: Vec<Pass>,
    /// Ray segments integrated in a frame; blending hardware does not count them.
    pub segments: Option<u64>,
    /// Number of times the transfer function was asked in a frame: see [`voltet_optics::engine::RenderStats::evaluations`]; `None` where an engine
    /// does not count.
    pub evaluations: Option<u64>,
    /// Segments of these that the engine left to 64 bits.
    pub segments_exact: u64,
    /// Largest resident memory of the process meanwhile; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pass {
    /// Its entry point.
    pub name: &'static str,
    pub times: Times,
}

/// One picture, and its seconds from end to end.
struct TimedPicture {
    drawn: RenderOutput,
    seconds: f64,
}

/// Draws the scene with one setting on its engine.
///
/// An engine on a device sets up before the first frame, which takes longer by that; the others set up each frame
/// anew. Errors: also what the engine does not hold.
pub(super) fn measure(
    engine: &dyn Engine,
    subject: &Subject,
    setting: &RenderConfig,
    frames: &Frames,
    progress: &dyn Progress,
) -> Result<(Picture, Cost)> {
    let scene = setting.scene(subject);
    let manner = RenderOptions { compositing: setting.variant.compositing, ..RenderOptions::default() };
    let keeps = setting.variant.engine.on_device;
    let fresh = memory::forget_peak();
    clear_caches(engine);
    let start = Instant::now();
    let volume = engine.prepare(&scene.volume)?;
    let draw = |scene: &Scene| {
        progress.check_cancelled()?;
        let begun = Instant::now();
        let drawn = volume.draw(scene, &manner, &CancelOnly(progress))?;
        Result::Ok(TimedPicture { drawn, seconds: begun.elapsed().as_secs_f64() })
    };
    let first = draw(&scene)?;
    let set_up = start.elapsed();
    let patience = frames.patience + if keeps { set_up } else { Duration::ZERO };
    let mut taken: Vec<TimedPicture> = Vec::new();
    while taken.len() < frames.count && (start.elapsed() < patience || (keeps && taken.is_empty())) {
        let mut frame = draw(&frames.scene(&scene, taken.len() + 1))?;
        // Its memory serves the next one: fresh memory is slow, and who looks at one picture after the other keeps none either.
        frame.drawn.picture = Picture::transparent(0, 0);
        taken.push(frame);
    }
    let in_flight_ms = match frames.in_flight > 1 && keeps {
        true => Some(in_flight(volume.as_ref(), &scene, &manner, frames, taken.len(), progress)?),
        false => None,
    };
    let (picture, counts) = (first.drawn.picture.clone(), first.drawn.counts);
    if taken.is_empty() {
        taken.push(first);
    }
    let peak_memory_bytes = memory::peak().filter(|_| fresh);
    let whole = spread(taken.iter().map(|frame| frame.seconds).collect());
    let stage = |stage: Stage| timed(&taken, |part| part.stage == stage);
    let (set_up, frame) = match stage(Stage::SetUp) {
        Some(set_up) => {
            let rest = |frame: &TimedPicture| {
                frame.seconds - seconds_of(&frame.drawn, |part| part.stage == Stage::SetUp).unwrap_or(0.0)
            };
            (set_up, spread(taken.iter().map(rest).collect()))
        }
        None => {
            let once = (1e3 * set_up.as_secs_f64() - whole.fastest_ms).max(0.0);
            (Times { median_ms: once, fastest_ms: once, slowest_ms: once }, whole)
        }
    };
    let cost = Cost {
        frames: taken.len(),
        picture: whole,
        set_up,
        frame,
        cull: stage(Stage::Cull),
        sort: stage(Stage::Sort),
        project: stage(Stage::Project),
        composite: stage(Stage::Composite),
        in_flight_ms,
        passes: passes(&taken),
        segments: counts.segments,
        evaluations: counts.evaluations,
        segments_exact: counts.segments_exact.unwrap_or(0),
        peak_memory_bytes,
    };
    Ok((picture, cost))
}

/// Milliseconds from one frame to the next, of so many that follow each other in flight. Errors: those of drawing.
fn in_flight(
    volume: &dyn PreparedVolume,
    scene: &Scene,
    manner: &RenderOptions,
    frames: &Frames,
    count: usize,
    progress: &dyn Progress,
) -> Result<f64> {
    let quiet = CancelOnly(progress);
    let mut under_way = VecDeque::new();
    let begun = Instant::now();
    for number in 0..count {
        progress.check_cancelled()?;
        under_way.push_back(volume.begin(&frames.scene(scene, number + 1), manner, &quiet)?);
        if under_way.len() == frames.in_flight {
            under_way.pop_front().map(|frame| frame.collect(&quiet)).transpose()?;
        }
    }
    for frame in under_way {
        frame.collect(&quiet)?;
    }
    Ok(1e3 * begun.elapsed().as_secs_f64() / count.max(1) as f64)
}

/// Seconds of the parts of one frame that count, together; `None` where nothing timed them.
fn seconds_of(drawn: &RenderOutput, counts: impl Fn(&StageTiming) -> bool) -> Option<f64> {
    let parts: Vec<f64> = drawn.stages.iter().filter(|part| counts(part)).map(|part| part.seconds).collect();
    (!parts.is_empty()).then(|| parts.iter().sum())
}

/// Times of such parts over all frames; `None` where they were not timed in each.
fn timed(taken: &[TimedPicture], counts: impl Fn(&StageTiming) -> bool) -> Option<Times> {
    taken.iter().map(|frame| seconds_of(&frame.drawn, &counts)).collect::<Option<Vec<f64>>>().map(spread)
}

fn passes(taken: &[TimedPicture]) -> Vec<Pass> {
    let mut names: Vec<&'static str> = Vec::new();
    for name in taken.iter().flat_map(|frame| &frame.drawn.stages).filter_map(|part| part.pass) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let pass = |name| Some(Pass { name, times: timed(taken, |part| part.pass == Some(name))? });
    names.into_iter().filter_map(pass).collect()
}

/// Median and ends of seconds, at least one of them, in milliseconds.
pub(super) fn spread(mut seconds: Vec<f64>) -> Times {
    seconds.sort_by(f64::total_cmp);
    let at = |i: usize| 1e3 * seconds[i];
    let count = seconds.len();
    Times {
        median_ms: 0.5 * (at((count - 1) / 2) + at(count / 2)),
        fastest_ms: at(0),
        slowest_ms: at(count - 1),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_of_an_even_number_lies_between_the_middle_two() {
        // Halves and quarters of seconds are exact.
        let of = |seconds: &[f64]| {
            let Times { median_ms, fastest_ms, slowest_ms } = spread(seconds.to_vec());
            [median_ms, fastest_ms, slowest_ms]
        };
        assert_eq!(of(&[4.0, 0.5, 2.0, 1.0]), [1500.0, 500.0, 4000.0]);
        assert_eq!(of(&[4.0, 0.5, 2.0]), [2000.0, 500.0, 4000.0]);
        assert_eq!(of(&[0.25]), [250.0, 250.0, 250.0]);
    }
}
