//! Times of frames that differ from the one before in one thing.

use crate::SHADING;
use crate::subject::{Subject, Volumes, middle};
use std::sync::Arc;
use std::time::Instant;
use voltet::core::Result;
use voltet::core::camera::Camera;
use voltet::core::progress::NoProgress;
use voltet::core::transfer::{Profile, TransferFunction};
use voltet::engine::ENGINE;
use voltet::optics::engine::{AdapterRequest, PreparedVolume, RenderOptions, RenderOutput, Stage};
use voltet::optics::scene::Scene;
use voltet::optics::shading::VisibilityOrder;

const FRAME_COUNT: usize = 31;

/// Frames that are not timed: the view's segments are cached once its widgets change.
const UNTIMED: usize = 4;

/// Widths and heights of the pictures.
const SIZES: [[u32; 2]; 2] = [[512, 512], [1024, 768]];

/// Difference from frame to frame.
const CHANGES: [&str; 5] = ["nothing", "camera turned", "widget moved", "colour", "extinction"];

/// Prints a table: the 1-D picture and each Gaussian of the subject, with every change; each frame is drawn in turns with and without the
/// segment cache.
pub fn measure(subject: &Subject, volumes: &Volumes) -> Result<()> {
    let mut looks = vec![("piecewise-linear", &volumes.plain, subject.piecewise_linear())];
    for &(name, centre, sigma, extinction) in subject.gaussians {
        looks.push((name, &volumes.bivariate, subject.gaussian(centre, sigma, extinction)));
    }
    looks.push(("four Gaussians", &volumes.bivariate, subject.gaussians(3, false)));
    println!(
        "\n| look | size | what changes | segments | cull, ms | project, ms | composite, ms | frame, ms | first frame after another, ms | \
         without the segment cache, × |"
    );
    println!("| --- | --- | --- |{}", " ---: |".repeat(7));
    for (name, volume, look) in looks {
        for (size, change) in SIZES.into_iter().flat_map(|size| CHANGES.map(|change| (size, change))) {
            let prepare = || ENGINE.open(&AdapterRequest::default())?.prepare(volume);
            let [cached, uncached] = [prepare()?, prepare()?];
            let (mut stages, mut ratios) = ([const { Vec::new() }; 4], Vec::new());
            let (mut segments, mut slowest) = (0, 0.0f64);
            for k in 0..FRAME_COUNT + UNTIMED {
                let (camera, look) = frame(subject, change, k, &look);
                let scene = Scene {
                    volume: volume.clone(),
                    transfer_function: Arc::new(look),
                    camera: Camera { size, ..camera },
                    shading: SHADING,
                    order: VisibilityOrder::Exact,
                };
                let draw_cached = || timed(&*cached, &scene, &RenderOptions::passing());
                let draw_uncached = || timed(&*uncached, &scene, &RenderOptions::default());
                let [(drawn, whole), (_, without)] = if k % 2 == 0 {
                    [draw_cached()?, draw_uncached()?]
                } else {
                    let uncached = draw_uncached()?;
                    [draw_cached()?, uncached]
                };
                let of = |wanted: Stage| {
                    drawn.stages.iter().filter(|timed| timed.stage == wanted).map(|timed| timed.seconds).sum()
                };
                let times: [f64; 4] = [of(Stage::Cull), of(Stage::Project), of(Stage::Composite), whole];
                // The first one warms up.
                if k < UNTIMED {
                    slowest = if k == 0 { 0.0 } else { slowest.max(whole) };
                } else {
                    stages.iter_mut().zip(times).for_each(|(stage, time)| stage.push(1e3 * time));
                    ratios.push(without / whole);
                }
                segments = drawn.counts.segments.unwrap_or(0);
            }
            let [cull, project, composite, whole] = stages.map(middle);
            let (slowest, ratio) = (1e3 * slowest, middle(ratios));
            let [width, height] = size;
            println!(
                "| {name} | {width} × {height} | {change} | {segments} | {cull:.2} | {project:.1} | {composite:.1} | **{whole:.1}** | \
                 {slowest:.1} | {ratio:.2} |"
            );
        }
    }
    Ok(())
}

/// Picture of a scene, and its seconds.
fn timed(
    prepared: &dyn PreparedVolume,
    scene: &Scene,
    options: &RenderOptions,
) -> Result<(RenderOutput, f64)> {
    let start = Instant::now();
    let drawn = prepared.draw(scene, options, &NoProgress)?;
    Ok((drawn, start.elapsed().as_secs_f64()))
}

/// The k-th frame of a change.
fn frame(subject: &Subject, change: &str, k: usize, look: &TransferFunction) -> (Camera, TransferFunction) {
    let share = k as f64 / FRAME_COUNT as f64;
    let of = |name: &str| if change == name { share } else { 0.0 };
    // A drag over half a deviation, or some of the range; a tenfold extinction.
    let mut look = look.clone();
    let denser = 10f64.powf(of("extinction"));
    let widget = &mut look.widgets[0];
    widget.extinction *= denser;
    widget.color[2] += 0.5 * of("colour");
    match &mut widget.profile {
        Profile::Gaussian { centre, matrix } => {
            for axis in [0, 1] {
                let sigma = std::f64::consts::FRAC_1_SQRT_2 / matrix[axis][axis];
                centre[axis] += 0.5 * of("widget moved") * sigma;
            }
        }
        Profile::PiecewiseLinear { points } => {
            let span = points[points.len() - 1].s - points[0].s;
            for point in points {
                point.s += 0.1 * of("widget moved") * span;
                point.color[2] += 0.5 * of("colour");
                point.extinction *= denser;
            }
        }
        _ => {}
    }
    (subject.camera(FRAME_COUNT as f64 * of("camera turned"), 512), look)
}
