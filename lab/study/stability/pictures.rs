//! Small pictures of scenes that are hard to draw, by every engine, held against the 64-bit referee.

use super::hard::{self, HardScene};
use crate::devices;
use crate::work_precision::pixel_errors;
use serde::Serialize;
use std::sync::Arc;
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::{Error, Result};
use voltet_introspect::MeasuredEngine;
use voltet_judge::{Evaluator64, SegmentEvaluator};
use voltet_nodes::drawing::ENGINES;
use voltet_optics::engine::{Compositor, Engine, EngineInfo, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_reference as reference;

/// Largest error of a channel of premultiplied linear RGBA, on either engine: what 32-bit segments leave on ordinary scenes,
/// with room for their condition.
pub(super) const BOUND: f64 = 2e-4;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HardPicture {
    pub category: &'static str,
    pub scene: String,
    pub engine: String,
    /// Reason why it was not drawn: a scene that a device refuses goes to the CPU engine by `auto`.
    pub refused: Option<String>,
    /// Largest error of a channel; ∞ where one is not finite.
    pub worst_error: f64,
    pub worst_pixel: [usize; 2],
    pub bound: f64,
}

impl HardPicture {
    pub fn passed(&self) -> bool {
        self.worst_error <= self.bound
    }
}

/// Draws every picture with all of them. Errors: a stopped run, and those of drawing.
pub(super) fn pictures(renderers: &[OpenRenderer], progress: &dyn Progress) -> Result<Vec<HardPicture>> {
    let scenes = hard::all();
    let mut all = Vec::new();
    for (k, scene) in scenes.iter().enumerate() {
        progress.report(scene.category, k as f64 / scenes.len() as f64);
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        all.extend(drawn(scene, renderers, progress)?);
    }
    Ok(all)
}

fn drawn(hard: &HardScene, renderers: &[OpenRenderer], progress: &dyn Progress) -> Result<Vec<HardPicture>> {
    let exact = reference::draw(&hard.scene, &CancelOnly(progress))?;
    let draw = |renderer: &OpenRenderer| {
        let ((worst_error, worst_pixel), refused) = match picture(renderer, None, &hard.scene, progress) {
            Ok(found) => (worst(&found, &exact), None),
            // What a device does not hold `auto` leaves to the native engine.
            Err(error) if may_refuse(renderer, progress) => ((0.0, [0; 2]), Some(error.to_string())),
            Err(error) => return Err(error),
        };
        let (category, scene, engine) = (hard.category, hard.name.clone(), renderer.engine.label());
        Ok(HardPicture { category, scene, engine, refused, worst_error, worst_pixel, bound: BOUND })
    };
    renderers.iter().map(draw).collect()
}

/// Draws it. `way`: how a device composites; an order that hardware blends is not held against tiles, so that what is wrong shows.
pub(super) fn picture(
    renderer: &OpenRenderer,
    way: Option<Compositor>,
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<Picture> {
    let volume = renderer.engine.prepare(&scene.volume)?;
    let manner = RenderOptions { compositing: way, ..RenderOptions::default() };
    Ok(volume.draw(scene, &manner, &CancelOnly(progress))?.picture)
}

/// True if what went wrong is that a device does not hold the scene.
pub(super) fn may_refuse(renderer: &OpenRenderer, progress: &dyn Progress) -> bool {
    renderer.declared.on_device && !renderer.engine.is_lost() && !progress.cancelled()
}

fn worst(found: &Picture, exact: &Picture) -> (f64, [usize; 2]) {
    let errors = pixel_errors(found, exact).enumerate();
    let (at, error) = errors.fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
    (error, [at % exact.width, at / exact.width])
}

/// The sets of forms and the engines that this build and this machine have.
pub struct Subjects {
    /// The 64-bit ones, then those of every engine that has any.
    pub forms: Vec<Box<dyn SegmentEvaluator>>,
    /// Engines that are not judged, with the reason and the remedy.
    pub left_out: Vec<String>,
    pub(super) renderers: Vec<OpenRenderer>,
}

pub(super) struct OpenRenderer {
    pub declared: &'static EngineInfo,
    pub engine: Arc<dyn Engine>,
}

impl OpenRenderer {
    /// Its ways of compositing; the one that it has, where it has no choice.
    pub fn ways(&self) -> Vec<Option<Compositor>> {
        match self.declared.compositing {
            [] => vec![None],
            several => several.iter().copied().map(Some).collect(),
        }
    }
}

/// Everything that can be judged here. `adapter`: a device by its kind or a part of its name; without it the fastest that is
/// hardware, and what is left out where there is none.
///
/// Errors: a device that is named and not there.
pub fn subjects(adapter: Option<&str>) -> Result<Subjects> {
    let mut subjects =
        Subjects { forms: vec![Box::new(Evaluator64)], left_out: Vec::new(), renderers: Vec::new() };
    for declared in ENGINES {
        match devices::open_variants_of(declared, adapter.filter(|_| declared.on_device)) {
            Ok(each) => {
                subjects.forms.extend(each.iter().filter_map(|engine| engine.evaluator()));
                subjects.renderers.extend(each.into_iter().map(|engine| OpenRenderer { declared, engine }));
            }
            Err(error) if adapter.is_some() => return Err(error),
            Err(error) => subjects.left_out.push(format!("the engine {}: {error}", declared.name)),
        }
    }
    Ok(subjects)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stability::subjects;
    use voltet_core::progress::NoProgress;
    use voltet_nodes::drawing::ENGINES;

    /// Each of the pictures on the software driver, within the bound of the native engine's; skipped without one, loudly.
    #[test]
    fn hard_scenes_keep_their_bound_on_every_engine() {
        let Some(declared) =
            ENGINES.iter().find(|engine| engine.on_device && engine.unavailable_reason.is_none())
        else {
            return;
        };
        let found = match subjects(Some("software")) {
            Ok(found) => found,
            Err(why) => {
                voltet_testing::skipped_without_device(why);
                return;
            }
        };
        let on_device = found.renderers.iter().find(|renderer| renderer.declared == declared);
        let device = on_device.expect("the device paints").engine.label();
        let all = pictures(&found.renderers, &NoProgress).expect("drawn");
        let on_device: Vec<&HardPicture> = all.iter().filter(|drawn| drawn.engine == device).collect();
        assert_eq!(
            (on_device.len(), all.len()),
            (hard::all().len(), hard::all().len() * found.renderers.len())
        );
        // What 32 bits do not hold; `auto` leaves it to the native engine, which refuses nothing.
        let refused: Vec<&str> =
            all.iter().filter(|drawn| drawn.refused.is_some()).map(|drawn| drawn.scene.as_str()).collect();
        let beyond = [
            "extinction times 1e9",
            "extinction times 1e12",
            "widths of 1e-6",
            "to 1e6 over 1e-6",
            "a period of 1e-3",
            "a pixel of 1e-6",
        ];
        assert_eq!(refused, beyond);
        let wrong: Vec<&HardPicture> = all.iter().filter(|drawn| !drawn.passed()).collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
