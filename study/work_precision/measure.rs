//! One setting, drawn again and again: seconds of every stage, memory, and the picture.

use super::{Scene, Setting};
use serde::Serialize;
use std::time::{Duration, Instant};
use voltet_core::camera::Camera;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::shading::{Order, Shading};
use voltet_core::{Error, Result};
use voltet_engine as engine;

/// How often a setting is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frames {
    /// Frames that count, at most, ≥ 1. One before them warms up.
    pub count: usize,
    /// No further frame begins once a setting has taken this long. Where the first one already does, it counts.
    pub patience: Duration,
    /// Degrees that the camera turns about its target before each frame, so that nothing of the former one can be used
    /// again; 0: it stands still.
    pub turn: f64,
}

impl Frames {
    /// The scene of frame `number`.
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

/// Median and spread of repeated times, milliseconds.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Times {
    /// The median; of an even number of times the mean of the middle two.
    pub median_ms: f64,
    /// The fastest.
    pub fastest_ms: f64,
    /// The slowest.
    pub slowest_ms: f64,
}

/// What drawing with one setting costs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Cost {
    /// Frames that were measured.
    pub frames: usize,
    /// A picture, with all that a run makes anew for each one: the native engine its set-up and the frame, a device, which
    /// keeps what it has set up, the frame.
    pub picture: Times,
    /// What is made before a frame and would serve further ones: tables, widgets made ready; on a device also uploads and
    /// pipelines.
    pub set_up: Times,
    /// A frame: the stages below together, on a device also what lies between them and the way back.
    pub frame: Times,
    /// Culling; this and the next three are `None` on a device that does not time its passes.
    pub cull: Option<Times>,
    /// Ordering the cells; on a device, sharing them out among tiles too.
    pub sort: Option<Times>,
    /// Projecting.
    pub project: Option<Times>,
    /// Integrating and compositing.
    pub composite: Option<Times>,
    /// The passes of a device that times them.
    pub passes: Vec<Pass>,
    /// Ray segments integrated in a frame; blending hardware does not count them.
    pub segments: Option<u64>,
    /// Segments of these that the engine left to 64 bits.
    pub segments_exact: u64,
    /// Floating-point operations of a device's compositor in a frame, counted in the shader's text with every loop run
    /// once; `None` where they are not known.
    pub operations: Option<u64>,
    /// Largest resident memory of the process meanwhile; `None` where the system does not tell.
    pub peak_memory_bytes: Option<u64>,
}

/// What one pass of a device takes in a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Pass {
    /// Its entry point.
    pub name: &'static str,
    /// Its times.
    pub times: Times,
}

/// Seconds of one frame: cull, sort, project, set-up, composite.
type Seconds = [f64; 5];

/// Draws the scene with one setting on the native engine.
pub fn measure(
    scene: &Scene,
    setting: &Setting,
    frames: &Frames,
    progress: &dyn Progress,
) -> Result<(Picture, Cost)> {
    let shading = Shading { integrator: setting.integrator, overlap: setting.overlap, ..scene.shading };
    // The same picture without the work.
    let order = if scene.needs_order { setting.order } else { Order::Auto };
    let fresh = forget_peak_memory();
    let start = Instant::now();
    let (picture, counts, first) = frame(scene, &shading, order, progress)?;
    let mut times: Vec<Seconds> = Vec::new();
    while times.len() < frames.count && start.elapsed() < frames.patience {
        let scene = frames.scene(scene, times.len() + 1);
        times.push(frame(&scene, &shading, order, progress)?.2);
    }
    if times.is_empty() {
        times.push(first);
    }
    let of = |f: &dyn Fn(&Seconds) -> f64| spread(times.iter().map(f).collect());
    let stage = |k: usize| of(&|seconds: &Seconds| seconds[k]);
    let cost = Cost {
        frames: times.len(),
        picture: of(&|seconds| seconds.iter().sum()),
        set_up: stage(3),
        frame: of(&|seconds| seconds.iter().sum::<f64>() - seconds[3]),
        cull: Some(stage(0)),
        sort: Some(stage(1)),
        project: Some(stage(2)),
        composite: Some(stage(4)),
        passes: Vec::new(),
        segments: Some(counts.segments),
        segments_exact: counts.segments_exact,
        operations: None,
        peak_memory_bytes: peak_memory().filter(|_| fresh),
    };
    Ok((picture, cost))
}

/// Draws once, from culling on.
fn frame(
    scene: &Scene,
    shading: &Shading,
    order: Order,
    progress: &dyn Progress,
) -> Result<(Picture, engine::Counts, Seconds)> {
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let Scene { volume, transfer_function, camera, .. } = scene;
    let gradient = engine::needs_gradient(shading);
    let mut ends = [Instant::now(); 6];
    let cells = engine::cull(volume, transfer_function, camera, progress)?;
    ends[1] = Instant::now();
    let cells = engine::sort(&cells, camera, order)?;
    ends[2] = Instant::now();
    let projection = engine::project(&cells, transfer_function, camera, gradient, progress)?;
    ends[3] = Instant::now();
    let ready = engine::prepare(&projection, transfer_function, shading)?;
    ends[4] = Instant::now();
    let (picture, counts) = ready.composite(progress)?;
    ends[5] = Instant::now();
    Ok((picture, counts, std::array::from_fn(|k| (ends[k + 1] - ends[k]).as_secs_f64())))
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

/// Lets the system's count of the largest memory begin anew (Linux: proc(5), clear_refs); whether it does.
pub(super) fn forget_peak_memory() -> bool {
    std::fs::write("/proc/self/clear_refs", "5").is_ok()
}

/// Largest resident memory of the process since then.
pub(super) fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kibibytes: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kibibytes * 1024)
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

    #[test]
    #[cfg(target_os = "linux")]
    fn the_peak_of_memory_is_forgotten_and_found_again() {
        if !forget_peak_memory() {
            eprintln!("skipped: this system does not let a process forget its peak");
            return;
        }
        let touched = |mebibytes: usize| std::hint::black_box(vec![1u8; mebibytes << 20]).len();
        touched(256);
        let high = peak_memory().unwrap();
        assert!(forget_peak_memory());
        touched(16);
        let low = peak_memory().unwrap();
        // Other tests of this process may hold some memory.
        assert!(high > low + (64 << 20), "{high} {low}");
    }
}
