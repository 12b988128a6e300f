//! What the engine leaves out or takes as equal, by numbers that its sources state: each is crossed here.

mod pictures;
mod segments;
mod views;
mod volume_cache;

use glam::DVec3;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::grid::Grid;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{Profile, Region, TransferFunction, Wave, Widget};
use voltet_core::volume::Volume;
use voltet_optics::integrators::{self, Extent};
use voltet_optics::scene::Scene;
use voltet_optics::shading::VisibilityOrder;
use voltet_optics::{Contribution, Segment};
use voltet_reference as reference;
use voltet_testing::pictures::compare::SHADING;
use voltet_testing::pictures::grids::cube;
use voltet_testing::pictures::looks::{look, orthographic};

/// The unit square seen along an axis, 16 pixels a side: one tile.
fn along(axis: DVec3) -> Camera {
    let centre = DVec3::splat(0.5);
    let up = if axis.z == 0.0 { DVec3::Z } else { DVec3::Y };
    Camera { up, ..orthographic((centre - 5.0 * axis).into(), centre.into(), 0.99, [16, 16]) }
}

/// Where s lies in a range: one density, one colour.
fn uniform(range: [f64; 2], extinction: f64, color: [f64; 3]) -> Widget {
    let region = Some(Region::rectangle(range, [f64::NEG_INFINITY, f64::INFINITY]));
    Widget { profile: Profile::Uniform, color, extinction, region }
}

fn volume(grid: Grid, s: impl Fn(&DVec3) -> f64) -> Arc<Volume> {
    let scalar = grid.points.iter().map(s).collect();
    Arc::new(Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None })
}

fn unit_cube(counts: [usize; 3]) -> Arc<Volume> {
    volume(cube(counts, 0.0), |p| p.x)
}

fn largest_difference(a: &Picture, b: &Picture) -> f32 {
    let pairs = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max)
}

/// Exact integrals of segments of one length unit, with two widgets in front of each other.
fn exact_of(look: &TransferFunction, segment: &Segment) -> Contribution {
    let extent = Extent { scalar: [0.0, 1.0], longest: 1.0 };
    let exact = integrators::new(&SHADING.integrator, SHADING.overlap, look, &extent).expect("serves it");
    exact.integrate(segment)
}

fn segment(front: [f64; 2], back: [f64; 2]) -> Segment<'static> {
    Segment { length: 1.0, front, back, fields_front: &[], fields_back: &[] }
}

/// The scene of a volume as the referee sees it.
fn scene(volume: Arc<Volume>, look: TransferFunction, camera: Camera) -> Scene {
    Scene::new(volume, Arc::new(look), camera, SHADING, VisibilityOrder::Exact)
}

fn drawn_exactly(volume: Arc<Volume>, look: TransferFunction, camera: Camera) -> Picture {
    reference::draw(&scene(volume, look, camera), &NoProgress).expect("draws")
}
