//! The engines that settings are measured on: those that are asked for and there.

use super::measure::{Cost, measure};
use super::settings::settings;
use super::subject::RendererNode;
use super::{Engines, Frames, RenderConfig, RendererVariant, StudyOptions, Subject};
use crate::devices;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};
use voltet_introspect::MeasuredEngine;
use voltet_nodes::drawing::{ENGINES, NATIVE, is_asked_by};
use voltet_optics::engine::{Engine, EngineInfo};

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

    /// Each device's name and its 32-bit multiply-adds a second, measured. Errors: a lost device.
    pub fn multiply_adds_per_second(&self) -> Result<Vec<(String, f64)>> {
        let rate = |bench: &Bench| {
            let rate = bench.engine.multiply_adds_per_second().transpose()?;
            Some(rate.map(|rate| (bench.engine.adapter(), rate)))
        };
        self.benches.iter().filter_map(rate).collect()
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
