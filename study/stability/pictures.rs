//! Small pictures of cells that are hard to draw, by every engine, held against the 64-bit referee.

use super::subjects::Painter;
use glam::DVec3;
use serde::Serialize;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::engine::Manner;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::optics::Overlap;
use voltet_core::picture::Picture;
use voltet_core::progress::{Progress, Unreported};
use voltet_core::scene::Scene;
use voltet_core::shading::{Integrator, Order, Shading};
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, reference};

/// Largest error of a channel of premultiplied linear RGBA, on either engine: what 32-bit segments leave on ordinary scenes,
/// with room for their condition.
const BOUND: f64 = 2e-4;

/// One picture.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Drawn {
    /// What is hard about it.
    pub category: &'static str,
    /// Which one.
    pub scene: String,
    /// What drew it.
    pub engine: String,
    /// Why it was not drawn: what a device refuses, `auto` leaves to the native engine.
    pub refused: Option<String>,
    /// Largest error of a channel; ∞ where one is not finite.
    pub worst_error: f64,
    /// The pixel that has it.
    pub worst_pixel: [usize; 2],
    /// The error that is allowed.
    pub bound: f64,
}

impl Drawn {
    /// Whether it kept its bound.
    pub fn passed(&self) -> bool {
        self.worst_error <= self.bound
    }
}

/// A scene that is hard to draw.
struct Hard {
    category: &'static str,
    name: String,
    grid: Grid,
    /// Positions in the unit cube, where the field is taken.
    places: Vec<DVec3>,
    camera: Camera,
    unit_distance: f64,
}

/// Draws every picture with all of them. Errors: a stopped run, and those of drawing.
pub(super) fn pictures(painters: &[Painter], progress: &dyn Progress) -> Result<Vec<Drawn>> {
    let scenes: Vec<Hard> =
        flat().into_iter().chain(without_volume()).chain(far()).chain([needles(), deep()]).collect();
    let mut all = Vec::new();
    for (k, scene) in scenes.iter().enumerate() {
        progress.report(scene.category, k as f64 / scenes.len() as f64);
        if progress.cancelled() {
            return Err(Error::cancelled());
        }
        all.extend(drawn(scene, painters, progress)?);
    }
    Ok(all)
}

fn drawn(hard: &Hard, painters: &[Painter], progress: &dyn Progress) -> Result<Vec<Drawn>> {
    let s = |p: &DVec3| 0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos();
    let g = |p: &DVec3| 0.4 + p.x + 0.5 * p.y * p.z;
    let volume = Arc::new(Volume {
        grid: Arc::new(hard.grid.clone()),
        scalar: Arc::new(hard.places.iter().map(s).collect()),
        gradient: None,
        gradient_magnitude: Some(Arc::new(hard.places.iter().map(g).collect())),
    });
    let transfer_function = Arc::new(TransferFunction { unit_distance: hard.unit_distance, ..look() });
    let (integrator, overlap) = (Integrator::Analytic, Overlap::Exact);
    let shading = Shading { integrator, overlap, silhouette: None, light: None };
    let scene = Scene { volume, transfer_function, camera: hard.camera, shading, order: Order::Exact };
    let exact = reference::draw(&scene, &Unreported(progress))?;
    let draw = |painter: &Painter| {
        let ((worst_error, worst_pixel), refused) = match picture(painter, &scene, progress) {
            Ok(found) => (worst(&found, &exact), None),
            // What a device does not hold `auto` leaves to the native engine.
            Err(error) if may_refuse(painter, progress) => ((0.0, [0; 2]), Some(error.to_string())),
            Err(error) => return Err(error),
        };
        let (category, scene, engine) = (hard.category, hard.name.clone(), painter.engine.label());
        Ok(Drawn { category, scene, engine, refused, worst_error, worst_pixel, bound: BOUND })
    };
    painters.iter().map(draw).collect()
}

fn picture(painter: &Painter, scene: &Scene, progress: &dyn Progress) -> Result<Picture> {
    let volume = painter.engine.prepare(&scene.volume)?;
    Ok(volume.draw(scene, &Manner::default(), &Unreported(progress))?.picture)
}

/// Whether what went wrong is that a device does not hold the scene.
fn may_refuse(painter: &Painter, progress: &dyn Progress) -> bool {
    painter.declared.on_device && !painter.engine.is_lost() && !progress.cancelled()
}

fn worst(found: &Picture, exact: &Picture) -> (f64, [usize; 2]) {
    let mut worst = (0.0, 0);
    for (k, (found, exact)) in found.rgba.iter().zip(&exact.rgba).enumerate() {
        for (found, exact) in found.iter().zip(exact) {
            let error = (f64::from(*found) - f64::from(*exact)).abs();
            let error = if error.is_nan() { f64::INFINITY } else { error };
            if error > worst.0 {
                worst = (error, k);
            }
        }
    }
    (worst.0, [worst.1 % exact.width, worst.1 / exact.width])
}

/// Two Gaussians, one of them tilted and one cut by a region, that overlap.
fn look() -> TransferFunction {
    let widget = |centre, matrix, extinction, color, region| Widget {
        profile: Profile::Gaussian { centre, matrix },
        color,
        extinction,
        region,
    };
    let rectangle = Region { corners: vec![[0.35, 0.2], [0.75, 0.2], [0.75, 1.4], [0.35, 1.4]] };
    let widgets = vec![
        widget([0.55, 0.9], [[4.0, 1.5], [-1.0, 1.6]], 3.0, [0.2, 0.5, 1.1], None),
        widget([0.5, 0.7], [[4.7, 0.0], [0.0, 1.2]], 5.0, [0.9, 0.3, 0.2], Some(rectangle)),
    ];
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets }
}

fn cube(counts: [usize; 3], jitter: f64) -> Grid {
    box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], jitter)
}

/// The grid with its points moved; the field stays with the points.
fn moved(name: String, category: &'static str, base: &Grid, place: impl Fn(DVec3) -> DVec3) -> Hard {
    let places = base.points.to_vec();
    let grid = Grid { points: Arc::new(sample(base, place)), ..base.clone() };
    Hard { category, name, grid, places, camera: outside(), unit_distance: 1.0 }
}

const SIZE: [u32; 2] = [24, 24];

fn outside() -> Camera {
    Camera {
        eye: DVec3::new(-0.9, -1.1, 1.4),
        target: DVec3::splat(0.5),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 45.0 },
        near: 0.0,
        size: SIZE,
        samples: 1,
    }
}

/// Cells squeezed to a layer.
fn flat() -> Vec<Hard> {
    let base = cube([3, 3, 3], 0.0);
    let layer = |thickness: f64| {
        let place = move |p: DVec3| {
            let x = [0.0, 0.5, 0.5 + thickness, 1.0][(p.x * 3.0).round() as usize];
            DVec3::new(x, p.y, p.z)
        };
        moved(format!("a layer of thickness {thickness:e}"), "degenerate cells", &base, place)
    };
    [1e-3, 1e-6, 1e-9, 1e-12, 0.0].map(layer).into()
}

/// Cells with four points in a plane, on a line or in one place, among others.
fn without_volume() -> Vec<Hard> {
    let base = cube([3, 3, 3], 0.0);
    // Points 0 to 3 lie on an edge, 0, 21, 42, 63 on the diagonal, 0, 1, 4, 5 in a face.
    let kinds: [(&str, &[[u32; 4]]); 3] = [
        ("cells in a plane", &[[0, 1, 4, 5], [0, 3, 12, 15]]),
        ("cells on a line", &[[0, 1, 2, 3], [0, 21, 42, 63]]),
        ("cells with equal points", &[[5, 5, 9, 11], [7, 7, 7, 7], [3, 3, 3, 30]]),
    ];
    let scene = |(name, cells): (&str, &[[u32; 4]])| {
        let mut all = base.tetrahedra.to_vec();
        all.extend(cells.iter().map(|cell| {
            let mut cell = *cell;
            cell.sort_unstable();
            cell
        }));
        let grid = Grid { tetrahedra: Arc::new(all), ..base.clone() };
        moved(name.into(), "degenerate cells", &grid, |p| p)
    };
    kinds.map(scene).into()
}

/// Cells a hundred thousand times as long as wide, seen across.
fn needles() -> Hard {
    let base = cube([3, 3, 3], 0.2);
    let narrow = |p: DVec3| DVec3::new(p.x, 0.5 + 1e-5 * (p.y - 0.5), p.z);
    let scene = moved("needles of 1 : 100,000".into(), "degenerate cells", &base, narrow);
    let camera = Camera {
        eye: DVec3::new(0.503, -2.0, 0.507),
        target: DVec3::new(0.503, 0.0, 0.507),
        projection: Projection::Orthographic { height: 0.9 },
        ..outside()
    };
    // So that 1e-5 of length is seen.
    Hard { camera, unit_distance: 1e-5, ..scene }
}

/// The cube at other scales, and far from the origin.
fn far() -> Vec<Hard> {
    let base = cube([4, 4, 4], 0.2);
    let scene = |(scale, offset): (f64, DVec3)| {
        let place = move |p: DVec3| offset + scale * p;
        let name = format!("lengths of {scale:.0e} at {:.1e} from the origin", offset.length());
        let view = outside();
        let camera = Camera { eye: place(view.eye), target: place(view.target), ..view };
        Hard { camera, unit_distance: scale, ..moved(name, "extreme coordinates", &base, place) }
    };
    [
        (1e-30, DVec3::ZERO),
        (1e-20, DVec3::ZERO),
        (1e20, DVec3::ZERO),
        (1e30, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
        (1e-3, DVec3::new(1e3, 1e3, -1e3)),
        (1e20, DVec3::new(1e26, 0.0, -1e26)),
    ]
    .map(scene)
    .into()
}

/// Thousands of segments on a pixel.
fn deep() -> Hard {
    let base = cube([1, 600, 1], 0.0);
    let scene = moved("over 1,200 cells along a ray".into(), "long compositing chains", &base, |p| {
        DVec3::new(p.x, 3.0 * p.y, p.z)
    });
    let projection = Projection::Perspective { fov_y: 18.0 };
    let (eye, target) = (DVec3::new(0.45, -3.0, 0.55), DVec3::new(0.5, 0.0, 0.5));
    Hard { camera: Camera { eye, target, projection, size: [8, 8], ..outside() }, ..scene }
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::*;
    use crate::stability::subjects;
    use voltet_core::progress::Silent;

    /// Each of the pictures on the software driver, within the bound of the native engine's; skipped without one, loudly.
    #[test]
    fn hard_cells_on_a_device_keep_their_bound() {
        let found = match subjects(Some("software")) {
            Ok(found) => found,
            Err(why) => {
                assert!(!std::env::var("VOLTET_REQUIRE_GPU").is_ok_and(|value| value == "1"), "{why}");
                eprintln!("\n*** SKIPPED: {why}; scripts/install-software-vulkan.sh ***\n");
                return;
            }
        };
        let device = found.painters.last().expect("the device paints").engine.label();
        let all = pictures(&found.painters, &Silent).expect("drawn");
        let on_device: Vec<&Drawn> = all.iter().filter(|drawn| drawn.engine == device).collect();
        assert_eq!((on_device.len(), all.len()), (17, 17 * found.painters.len()));
        for drawn in all {
            assert!(drawn.passed() && drawn.refused.is_none(), "{drawn:?}");
        }
    }
}
