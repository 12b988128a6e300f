//! Settings measured on a graphics device.
//!
//! A frame is a picture with the grid, the pipelines and the tables on the device, read back; set-up is what the first
//! picture takes longer: uploads, compiling, tables. A run keeps all of that between its pictures.

use super::measure::{Cost, Frames, Pass, Times, forget_peak_memory, peak_memory, spread};
use super::{Engine, Scene, Setting};
use crate::devices;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::shading::{Order, Shading};
use voltet_core::{Error, Result};
use voltet_gpu::{Device, Drawn, Renderer};
use voltet_nodes::drawing;

/// The device that settings are measured on.
pub struct Bench {
    device: Arc<Device>,
    adapter: Option<String>,
}

/// The stage that a pass of the device is part of; `None` for one that is shown under its own name alone.
fn stage(pass: &str) -> Option<Stage> {
    Some(match pass {
        "see_points" | "place_attribute" => Stage::Project,
        "bound_cells" => Stage::Cull,
        "start_lists" | "fill_lists" | "sort_lists" => Stage::Sort,
        "count_digits" | "place_digits" | "move_digits" | "aim_runs" => Stage::Sort,
        "blend_cell" | "take_blended" => Stage::Composite,
        name if name.starts_with("composite_") => Stage::Composite,
        _ => return None,
    })
}

#[derive(Clone, Copy, PartialEq)]
enum Stage {
    Cull,
    Sort,
    Project,
    Composite,
}

/// Seconds of one frame, and those of its passes.
struct Taken {
    whole: f64,
    passes: Vec<(&'static str, f64)>,
}

impl Bench {
    /// Opens the adapter that is named, or the fastest that is hardware. Errors: there is none.
    pub fn open(adapter: Option<&str>) -> Result<Bench> {
        let device = Arc::new(devices::open(adapter)?);
        Ok(Bench { device, adapter: adapter.map(str::to_string) })
    }

    /// Name and kind of the adapter.
    pub fn name(&self) -> &str {
        &self.device.name
    }

    /// Whether it is a program on the CPU.
    pub fn is_software(&self) -> bool {
        self.device.is_software
    }

    /// 32-bit multiply-adds a second, measured. Errors: a lost device.
    pub fn multiply_adds_per_second(&self) -> Result<f64> {
        self.device.multiply_adds_per_second()
    }

    /// Draws the scene with one setting. Errors: also what the device does not hold.
    pub fn measure(
        &mut self,
        scene: &Scene,
        setting: &Setting,
        frames: &Frames,
        progress: &dyn Progress,
    ) -> Result<(Picture, Cost)> {
        if self.device.is_lost() {
            self.device = Arc::new(devices::open(self.adapter.as_deref())?);
        }
        let fresh = forget_peak_memory();
        self.device.forget_pipelines();
        let start = Instant::now();
        let renderer = Renderer::new(self.device.clone(), &scene.volume)?;
        draw(&renderer, scene, setting, progress)?;
        let first = start.elapsed();
        let (mut drawn, once) = draw(&renderer, &frames.scene(scene, 1), setting, progress)?;
        let mut taken = vec![once];
        while taken.len() < frames.count && start.elapsed() < first + frames.patience {
            let scene = frames.scene(scene, taken.len() + 1);
            let (further, once) = draw(&renderer, &scene, setting, progress)?;
            drawn = further;
            taken.push(once);
        }
        let peak_memory_bytes = peak_memory().filter(|_| fresh);
        let operations = drawn.compositor_operations()?;
        let cost = Cost { operations, peak_memory_bytes, ..cost(&taken, first.as_secs_f64(), &drawn) };
        Ok((drawn.picture, cost))
    }
}

fn cost(taken: &[Taken], first: f64, drawn: &Drawn) -> Cost {
    let frame = spread(taken.iter().map(|frame| frame.whole).collect());
    let set_up = (1e3 * first - frame.fastest_ms).max(0.0);
    let of = |wanted: &dyn Fn(&str) -> bool| -> Option<Times> {
        let sum = |frame: &Taken| -> Option<f64> {
            let chosen: Vec<f64> =
                frame.passes.iter().filter(|pass| wanted(pass.0)).map(|pass| pass.1).collect();
            (!chosen.is_empty()).then(|| chosen.iter().sum())
        };
        taken.iter().map(sum).collect::<Option<Vec<f64>>>().map(spread)
    };
    let mut passes: Vec<Pass> = Vec::new();
    for (name, _) in taken.iter().flat_map(|frame| &frame.passes) {
        if !passes.iter().any(|known| known.name == *name)
            && let Some(times) = of(&|pass| pass == *name)
        {
            passes.push(Pass { name, times });
        }
    }
    let part = |wanted: Stage| of(&|pass| stage(pass) == Some(wanted));
    Cost {
        frames: taken.len(),
        picture: frame,
        set_up: Times { median_ms: set_up, fastest_ms: set_up, slowest_ms: set_up },
        frame,
        cull: part(Stage::Cull),
        sort: part(Stage::Sort),
        project: part(Stage::Project),
        composite: part(Stage::Composite),
        passes,
        segments: drawn.counts.segments,
        segments_exact: 0,
        operations: None,
        peak_memory_bytes: None,
    }
}

/// One picture, and what it took.
fn draw(
    renderer: &Renderer,
    scene: &Scene,
    setting: &Setting,
    progress: &dyn Progress,
) -> Result<(Drawn, Taken)> {
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let Engine::Gpu { compositor } = setting.engine else {
        return Err(Error::run("the native engine's setting came to the device"));
    };
    let order = if scene.needs_order { setting.order } else { Order::Auto };
    let wanted = drawing::Scene {
        volume: scene.volume.clone(),
        transfer_function: Arc::new(scene.transfer_function.clone()),
        camera: Arc::new(scene.camera),
        shading: Shading { integrator: setting.integrator, overlap: setting.overlap, ..scene.shading },
        order,
    };
    let start = Instant::now();
    let drawn = drawing::draw_by(renderer, &wanted, compositor, progress)?;
    let taken = Taken { whole: start.elapsed().as_secs_f64(), passes: drawn.seconds.clone() };
    Ok((drawn, taken))
}
