//! Times of reading and gradients, and what each widget costs.

use crate::SHADING;
use crate::subject::{Subject, Volumes, middle};
use std::sync::Arc;
use std::time::Instant;
use voltet::core::Result;
use voltet::core::field::{LeastSquares, Method};
use voltet::core::probing::{Axis, histogram};
use voltet::core::progress::NoProgress;
use voltet::core::transfer::{Profile, TransferFunction};
use voltet::core::volume::Volume;
use voltet::engine::{composite, cull, project};
use voltet::io::formats::{self, Request};

const FRAME_COUNT: usize = 31;

/// Prints both tables.
pub fn measure(scene: &Subject, volumes: &Volumes) -> Result<()> {
    let Volume { grid, scalar, .. } = &*volumes.plain;
    println!("\n| stage | median ms |\n| --- | ---: |");
    if let Some(path) = &volumes.path {
        let request = Request { scalar: Some(scene.scalar().into()), ..Request::default() };
        let (read_ms, _) = median(9, |_| formats::read(path, &request, &NoProgress))?;
        println!("| read | {read_ms:.1} |");
    }
    let method = Method::with_defaults(Arc::new(LeastSquares))?;
    let (gradient_ms, _) = median(9, |_| method.gradient(grid, scalar, &NoProgress))?;
    println!("| least-squares gradient | {gradient_ms:.1} |");
    if let Some(magnitude) = &volumes.bivariate.gradient_magnitude {
        let axes = [Axis::over(scalar, 256), Axis::over(magnitude, 256)];
        let (histogram_ms, _) = median(9, |_| histogram(grid, [scalar, magnitude], axes, &NoProgress))?;
        println!("| histogram over (s, g), 256 × 256 bins | {histogram_ms:.1} |");
    }
    costs(scene, volumes)
}

/// Cost of widgets: against the one-dimensional picture, and each further one against the first.
fn costs(scene: &Subject, Volumes { plain, bivariate, .. }: &Volumes) -> Result<()> {
    println!(
        "\n| widgets, 512² | whole, median ms | to the 1-D picture | more than the row above, of the first |"
    );
    println!("| --- | ---: | ---: | ---: |");
    let one_dimensional_ms = frame_time(scene, plain, &scene.piecewise_linear(), false)?;
    println!("| piecewise-linear in s | {one_dimensional_ms:.1} | 1 | |");
    let one = scene.gaussians(0, false);
    let mut untouched = scene.gaussians(1, false);
    if let Profile::Gaussian { centre, .. } = &mut untouched.widgets[1].profile {
        *centre = [1e6; 2];
    }
    let first_ms = frame_time(scene, bivariate, &one, false)?;
    let row = |name: &str, ms: f64, more: Option<f64>| {
        let more = more.map_or(String::new(), |more| format!("{more:.2}"));
        println!("| {name} | {ms:.1} | {:.2} | {more} |", ms / one_dimensional_ms);
    };
    row("one Gaussian: one colour, no order", first_ms, None);
    let more = |ms: f64| Some((ms - first_ms) / first_ms);
    let ms = frame_time(scene, bivariate, &untouched, false)?;
    row("and one that no cell touches", ms, more(ms));
    let ms = frame_time(scene, bivariate, &scene.gaussians(1, true), false)?;
    row("or one of the same colour", ms, more(ms));
    let ordered_ms = frame_time(scene, bivariate, &one, true)?;
    row("one Gaussian, in order as the 1-D picture is", ordered_ms, None);
    let mut before = ordered_ms;
    for (count, name) in [(1, "and one of another colour"), (2, "and a third"), (3, "and a fourth")] {
        let ms = frame_time(scene, bivariate, &scene.gaussians(count, false), false)?;
        row(name, ms, Some((ms - before) / ordered_ms));
        before = ms;
    }
    Ok(())
}

/// Median milliseconds of a steady frame at 512²; `exhaustive`: in order although one colour does not need it.
fn frame_time(
    scene: &Subject,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    exhaustive: bool,
) -> Result<f64> {
    median(FRAME_COUNT, |k| {
        let camera = scene.camera(k as f64, 512);
        let mut cells = cull(volume, look, &camera, &NoProgress)?;
        cells.exhaustive = exhaustive;
        let projection = project(&cells, look, &camera, false, &NoProgress)?;
        composite(&projection, look, &SHADING, &NoProgress).map(drop)
    })
    .map(|(ms, ())| ms)
}

/// Runs `work` once to warm up and then `count` times; the median in milliseconds and the last result.
fn median<T>(count: usize, mut work: impl FnMut(usize) -> Result<T>) -> Result<(f64, T)> {
    let mut result = work(0)?;
    let mut times = Vec::with_capacity(count);
    for k in 1..=count {
        let start = Instant::now();
        result = work(k)?;
        times.push(1e3 * start.elapsed().as_secs_f64());
    }
    Ok((middle(times), result))
}
