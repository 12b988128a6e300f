//! Times of reading, of gradients and of steady frames, as Markdown tables of medians.
//!
//! `cargo bench --bench frame`. A steady frame runs all stages; the camera turns by one degree before each, so that
//! nothing of the former frame can be used again. The heat sink that ships is always measured; further grids are where
//! the folder named by VOLTET_TEST_DATA has them. `voltet time` measures frames of any pipeline, also on a device.

use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;
use voltet::core::camera::{Camera, Projection};
use voltet::core::field::{self, LeastSquares, Method};
use voltet::core::optics::Overlap;
use voltet::core::probing::{Axis, histogram};
use voltet::core::progress::Silent;
use voltet::core::shading::{Integrator, Shading};
use voltet::core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet::core::volume::Volume;
use voltet::core::{Error, Result};
use voltet::engine::{composite, cull, project};
use voltet::nodes::formats::{self, Request};

/// A grid, where it is seen from, and the transfer functions it is drawn with.
struct Subject {
    file: &'static str,
    scalar: &'static str,
    eye: DVec3,
    target: DVec3,
    unit_distance: f64,
    /// s, red, green, blue, extinction.
    piecewise: &'static [[f64; 5]],
    /// Name, centre, sigma, extinction.
    gaussians: &'static [(&'static str, [f64; 2], [f64; 2], f64)],
    /// Centres of further Gaussians, as wide as the first and each of a colour of its own.
    further: [[f64; 2]; 3],
}

const SUBJECTS: [Subject; 2] = [
    Subject {
        file: "heat_sink.vtu",
        scalar: "Temperature",
        eye: DVec3::new(-70.0, -130.0, 75.0),
        target: DVec3::new(0.0, -1.0, 9.5),
        unit_distance: 10.0,
        piecewise: &[
            [25.0, 0.1, 0.2, 0.9, 0.0],
            [50.0, 0.1, 0.8, 0.9, 0.1],
            [60.0, 0.2, 0.8, 0.2, 0.5],
            [107.0, 0.9, 0.1, 0.1, 1.5],
        ],
        gaussians: &[("wide", [60.0, 0.0], [20.0, 20.0], 1.0), ("narrow", [60.8, 0.0], [0.35, 0.025], 60.0)],
        further: [[90.0, 0.5], [40.0, 1.0], [75.0, 2.0]],
    },
    Subject {
        file: "bluntfin.vtu",
        scalar: "density",
        eye: DVec3::new(-12.0314, -30.8182, 24.7259),
        target: DVec3::new(3.2732, 4.1638, 2.8621),
        unit_distance: 1.0,
        piecewise: &[
            [0.2, 0.1, 0.2, 0.9, 0.0],
            [1.4, 0.1, 0.8, 0.9, 0.1],
            [2.6, 0.2, 0.8, 0.2, 0.5],
            [3.8, 0.9, 0.8, 0.1, 0.2],
            [4.97, 0.9, 0.1, 0.1, 1.5],
        ],
        gaussians: &[("wide", [1.2, 2.0], [1.5, 10.0], 0.5), ("narrow", [1.2, 2.0], [0.03, 2.5], 2.0)],
        further: [[2.2, 5.0], [0.6, 5.0], [3.4, 8.0]],
    },
];

const SIZES: [u32; 2] = [512, 1024];
const FRAME_COUNT: usize = 31;

const SHADING: Shading =
    Shading { integrator: Integrator::Analytic, overlap: Overlap::Exact, silhouette: None, light: None };

fn main() -> Result<()> {
    println!(
        "{} threads, {} {}",
        std::thread::available_parallelism().map_or(1, |n| n.get()),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("data");
    let further = std::env::var_os("VOLTET_TEST_DATA").map(PathBuf::from);
    for scene in &SUBJECTS {
        let folders = std::iter::once(&shipped).chain(&further);
        match folders.map(|folder| folder.join(scene.file)).find(|path| path.is_file()) {
            Some(path) => measure(scene, &path)?,
            None => println!("\nskipped: {} (VOLTET_TEST_DATA names no folder that has it)", scene.file),
        }
    }
    Ok(())
}

fn measure(scene: &Subject, path: &Path) -> Result<()> {
    let request = Request { scalar: Some(scene.scalar.into()), ..Request::default() };
    let (read_ms, grid) = median(9, |_| formats::read(path, &request, &Silent))?;
    let scalar = grid.scalar.clone().ok_or_else(|| Error::run("the grid has no scalar"))?;
    let method = Method::standard(Arc::new(LeastSquares))?;
    let (gradient_ms, gradient) = median(9, |_| method.gradient(&grid, &scalar, &Silent))?;
    println!("\n{}: {} tetrahedra, {} points", scene.file, grid.tetrahedra.len(), grid.points.len());
    println!("\n| stage | median ms |\n| --- | ---: |");
    println!("| read | {read_ms:.1} |\n| least-squares gradient | {gradient_ms:.1} |");

    let magnitude = Arc::new(field::magnitude(&gradient.vectors));
    let axes = [Axis::over(&scalar, 256), Axis::over(&magnitude, 256)];
    let (histogram_ms, _) = median(9, |_| histogram(&grid, [&scalar, &magnitude], axes, &Silent))?;
    println!("| histogram over (s, g), 256 × 256 bins | {histogram_ms:.1} |");
    let plain = Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None };
    let bivariate = Arc::new(Volume { gradient_magnitude: Some(magnitude.into()), ..plain.clone() });
    let plain = Arc::new(plain);
    println!("\n| steady frame | size | cull | project | composite | whole, median ms | segments |");
    println!("| --- | --- | ---: | ---: | ---: | ---: | ---: |");
    for size in SIZES {
        frames(scene, "piecewise-linear in s", size, &plain, scene.piecewise_linear())?;
        for &(name, centre, sigma, extinction) in scene.gaussians {
            let look = scene.gaussian(centre, sigma, extinction);
            frames(scene, &format!("one Gaussian, {name}"), size, &bivariate, look)?;
        }
    }
    costs(scene, &plain, &bivariate)?;
    Ok(())
}

/// What widgets cost: against the one-dimensional picture, and each further one against the first.
fn costs(scene: &Subject, plain: &Arc<Volume>, bivariate: &Arc<Volume>) -> Result<()> {
    println!(
        "\n| widgets, 512² | whole, median ms | to the 1-D picture | more than the row above, of the first |"
    );
    println!("| --- | ---: | ---: | ---: |");
    let one_dimensional_ms = frame_time(scene, plain, &scene.piecewise_linear(), false)?;
    println!("| piecewise-linear in s | {one_dimensional_ms:.1} | 1 | |");
    let &(_, centre, sigma, extinction) = &scene.gaussians[0];
    let one = scene.gaussian(centre, sigma, extinction);
    let with = |centres: &[[f64; 2]], same_color: bool| {
        let mut look = one.clone();
        for (centre, color) in centres.iter().zip([[0.1, 0.6, 1.0], [0.1, 1.0, 0.2], [1.0, 0.1, 0.8]]) {
            let mut widget = scene.gaussian(*centre, sigma, extinction).widgets.remove(0);
            widget.color = if same_color { one.widgets[0].color } else { color };
            look.widgets.push(widget);
        }
        look
    };
    let untouched = [[1e6, 1e6]];
    let first_ms = frame_time(scene, bivariate, &one, false)?;
    let row = |name: &str, ms: f64, more: Option<f64>| {
        let more = more.map_or(String::new(), |more| format!("{more:.2}"));
        println!("| {name} | {ms:.1} | {:.2} | {more} |", ms / one_dimensional_ms);
    };
    row("one Gaussian: one colour, no order", first_ms, None);
    let more = |ms: f64| Some((ms - first_ms) / first_ms);
    let ms = frame_time(scene, bivariate, &with(&untouched, false), false)?;
    row("and one that no cell touches", ms, more(ms));
    let ms = frame_time(scene, bivariate, &with(&scene.further[..1], true), false)?;
    row("or one of the same colour", ms, more(ms));
    let ordered_ms = frame_time(scene, bivariate, &one, true)?;
    row("one Gaussian, in order as the 1-D picture is", ordered_ms, None);
    let mut before = ordered_ms;
    for (count, name) in [(1, "and one of another colour"), (2, "and a third"), (3, "and a fourth")] {
        let ms = frame_time(scene, bivariate, &with(&scene.further[..count], false), false)?;
        row(name, ms, Some((ms - before) / ordered_ms));
        before = ms;
    }
    Ok(())
}

/// Median milliseconds of a steady frame at 512²; `no_leave_out`: in order although one colour does not need it.
fn frame_time(
    scene: &Subject,
    volume: &Arc<Volume>,
    look: &TransferFunction,
    no_leave_out: bool,
) -> Result<f64> {
    median(FRAME_COUNT, |k| {
        let camera = scene.camera(k as f64, 512);
        let mut cells = cull(volume, look, &camera, &Silent)?;
        cells.no_leave_out = no_leave_out;
        let projection = project(&cells, look, &camera, false, &Silent)?;
        composite(&projection, look, &SHADING, &Silent).map(drop)
    })
    .map(|(ms, ())| ms)
}

/// Draws frames from a camera that turns, and prints a row.
fn frames(
    scene: &Subject,
    name: &str,
    size: u32,
    volume: &Arc<Volume>,
    look: TransferFunction,
) -> Result<()> {
    let mut stages = [const { Vec::new() }; 3];
    let (whole_ms, counts) = median(FRAME_COUNT, |k| {
        let camera = scene.camera(k as f64, size);
        let start = Instant::now();
        let cells = cull(volume, &look, &camera, &Silent)?;
        let culled = Instant::now();
        let projection = project(&cells, &look, &camera, false, &Silent)?;
        let projected = Instant::now();
        let (_, counts) = composite(&projection, &look, &SHADING, &Silent)?;
        for (stage, time) in stages.iter_mut().zip([culled - start, projected - culled, projected.elapsed()])
        {
            stage.push(1e3 * time.as_secs_f64());
        }
        Ok(counts)
    })?;
    let [cull_ms, project_ms, composite_ms] = stages.map(middle);
    println!(
        "| {name} | {size}² | {cull_ms:.1} | {project_ms:.1} | {composite_ms:.1} | **{whole_ms:.1}** | {} |",
        counts.segments
    );
    Ok(())
}

impl Subject {
    fn camera(&self, degrees: f64, size: u32) -> Camera {
        let turned = glam::DQuat::from_rotation_z(degrees.to_radians()) * (self.eye - self.target);
        Camera {
            eye: self.target + turned,
            target: self.target,
            up: DVec3::Z,
            projection: Projection::Perspective { fov_y: 30.0 },
            near: 0.0,
            size: [size; 2],
            samples: 1,
        }
    }

    fn piecewise_linear(&self) -> TransferFunction {
        let point = |&[s, r, g, b, extinction]: &[f64; 5]| ControlPoint { s, color: [r, g, b], extinction };
        self.look(Profile::PiecewiseLinear { points: self.piecewise.iter().map(point).collect() }, 0.0)
    }

    fn gaussian(&self, centre: [f64; 2], sigma: [f64; 2], extinction: f64) -> TransferFunction {
        let [ks, kg] = sigma.map(|sigma| std::f64::consts::FRAC_1_SQRT_2 / sigma);
        self.look(Profile::Gaussian { centre, matrix: [[ks, 0.0], [0.0, kg]] }, extinction)
    }

    fn look(&self, profile: Profile, extinction: f64) -> TransferFunction {
        TransferFunction {
            model: OpticalModel::DensityEmitter,
            unit_distance: self.unit_distance,
            widgets: vec![Widget { profile, color: [1.0, 0.5, 0.15], extinction, region: None }],
        }
    }
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

fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
