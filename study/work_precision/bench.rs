//! The engines that settings are measured on: the native one, and a device where it is asked for and there.

use super::device::Bench;
use super::measure::{Cost, Frames, measure};
use super::scene::Form;
use super::{Engine, Scene, Setting, Wish, settings};
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result};

/// What there is to measure on.
pub struct Benches {
    cpu: bool,
    device: Option<Bench>,
    file_takes: Takes,
    /// What is not measured, why, and how to have it.
    pub left_out: Vec<String>,
}

/// What the file is drawn on here.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Takes {
    Native,
    /// The device that is measured.
    ThisDevice,
    /// One that is not measured, or not there.
    Another,
}

/// The device of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Adapter {
    /// Its name and kind, for people.
    pub name: String,
    /// What it is asked for by, where it is not the one that `auto` takes.
    pub wish: Option<String>,
    /// Whether it is a program on the CPU.
    pub is_software: bool,
}

impl Benches {
    /// Opens the device where it is asked for: the one that is named, else the one that the file names, else the fastest
    /// that is hardware. Where the native engine is to be looked at too, a device that is not there is left out.
    ///
    /// Errors: a device that was named or is all that was asked for, and is not there or cannot draw the pipeline.
    pub fn open(scene: &Scene, wish: &Wish) -> Result<Benches> {
        let mut left_out = Vec::new();
        let device = match wish.engines.gpu().then(|| open(scene, wish)) {
            None => None,
            Some(Ok(device)) => Some(device),
            Some(Err(error)) if !wish.engines.cpu() || wish.adapter.is_some() => return Err(error),
            Some(Err(error)) => {
                left_out.push(format!("the device: {error}"));
                None
            }
        };
        let file_takes = takes(scene, wish, device.as_ref());
        Ok(Benches { cpu: wish.engines.cpu(), device, file_takes, left_out })
    }

    /// The device.
    pub fn adapter(&self, scene: &Scene, wish: &Wish) -> Option<Adapter> {
        let device = self.device.as_ref()?;
        let wish = wish.adapter.clone().or_else(|| scene.asked.adapter.clone());
        Some(Adapter { name: device.name().into(), wish, is_software: device.is_software() })
    }

    /// The device's 32-bit multiply-adds a second, measured; `None` without one. Errors: a lost device.
    pub fn multiply_adds_per_second(&self) -> Result<Option<f64>> {
        self.device.as_ref().map(Bench::multiply_adds_per_second).transpose()
    }

    /// What is tried, engine by engine.
    pub fn settings(&self, scene: &Scene, only: &[String]) -> Vec<Setting> {
        let native = self.cpu.then_some(Engine::Cpu);
        let device = Engine::of_device().filter(|_| self.device.is_some());
        native.into_iter().chain(device).flat_map(|engine| settings(scene, only, engine)).collect()
    }

    /// Draws the scene with one setting, on its engine.
    pub fn measure(
        &mut self,
        scene: &Scene,
        setting: &Setting,
        frames: &Frames,
        progress: &dyn Progress,
    ) -> Result<(Picture, Cost)> {
        match (setting.engine, &mut self.device) {
            (Engine::Gpu { .. }, Some(device)) => device.measure(scene, setting, frames, progress),
            (Engine::Gpu { .. }, None) => Err(Error::run("there is no device to measure on")),
            (Engine::Cpu, _) => measure(scene, setting, frames, progress),
        }
    }

    /// How the file draws on this machine. `refused`: what the device does not draw, where `auto` takes the native engine;
    /// `None`: on a device that is not measured.
    pub(super) fn own(&self, scene: &Scene, refused: &dyn Fn(&Setting) -> bool) -> Option<Setting> {
        let native = scene.setting(Engine::Cpu);
        match self.file_takes {
            Takes::Native => Some(native),
            Takes::Another => None,
            Takes::ThisDevice => {
                let own = scene.setting(scene.on_device()?);
                Some(if scene.asked.engine == "auto" && refused(&own) { native } else { own })
            }
        }
    }
}

/// What the file is drawn on here, `device` being what is measured.
fn takes(scene: &Scene, wish: &Wish, device: Option<&Bench>) -> Takes {
    let asked = &scene.asked;
    if asked.engine == "cpu" {
        return Takes::Native;
    }
    if device.is_some() && (wish.adapter.is_none() || wish.adapter == asked.adapter) {
        return Takes::ThisDevice;
    }
    match (Bench::open(asked.adapter.as_deref()), device) {
        (Ok(files), Some(device)) if files.name() == device.name() => Takes::ThisDevice,
        (Err(_), _) if asked.engine == "auto" => Takes::Native,
        _ => Takes::Another,
    }
}

/// The device to measure.
fn open(scene: &Scene, wish: &Wish) -> Result<Bench> {
    let asked = &scene.asked;
    if asked.form == Form::Stages {
        let what =
            "the stages of the pipeline, one by one, are the native engine's: no device stands in for them";
        let accepted = "a pipeline that draws with a node of type \"renderer\"";
        return Err(Error::usage(what)
            .found(format!("'{}' of type \"composite\"", scene.node))
            .accepted(accepted));
    }
    let named = wish.adapter.as_ref().or(asked.adapter.as_ref());
    Bench::open(named.map(String::as_str))
}
