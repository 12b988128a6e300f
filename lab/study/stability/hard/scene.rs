//! A scene that is hard to draw, and what most of them are made of.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::grid::{Array, Grid};
use voltet_core::transfer::{OpticalModel, Profile, Region, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_optics::WidgetBlend;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};

/// A scene that is hard to draw.
pub(crate) struct Hard {
    pub(crate) category: &'static str,
    pub(crate) name: String,
    pub(super) grid: Grid,
    /// Positions in the unit cube, where the fields are taken.
    pub(super) places: Vec<DVec3>,
    pub(super) camera: Camera,
    pub(super) look: TransferFunction,
    pub(super) shading: Shading,
}

impl Hard {
    /// As engines take it. Both fields are smooth, of order 1, with gradients of order 1.
    pub(crate) fn scene(&self) -> Scene {
        let s = |p: &DVec3| 0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos();
        let g = |p: &DVec3| 0.4 + p.x + 0.5 * p.y * p.z;
        let gradient = |p: &DVec3| {
            let (wave, other) = ((4.0 * p.x + p.y).cos(), (3.0 * p.z - 2.0 * p.y).sin());
            DVec3::new(wave, 0.25 * wave + 0.5 * other, -0.75 * other)
        };
        let shaded = self.shading.light.is_some() || self.shading.silhouette.is_some();
        let further: [fn(&DVec3) -> f64; 2] =
            [|p| (3.0 * p.x - p.z).sin(), |p| (2.0 * p.y + 2.0 * p.z).cos()];
        let mut grid = self.grid.clone();
        for (name, field) in FIELDS.iter().zip(further) {
            let values = self.places.iter().map(field).collect();
            grid.point_arrays.insert(name.to_string(), Arc::new(Array { component_count: 1, values }));
        }
        let volume = Arc::new(Volume {
            grid: Arc::new(grid),
            scalar: SharedSlice::from(self.places.iter().map(s).collect::<Vec<_>>()),
            gradient: shaded.then(|| self.places.iter().map(gradient).collect()),
            gradient_magnitude: Some(SharedSlice::from(self.places.iter().map(g).collect::<Vec<_>>())),
        });
        let transfer_function = Arc::new(self.look.clone());
        Scene {
            volume,
            transfer_function,
            camera: self.camera,
            shading: self.shading,
            order: VisibilityOrder::Exact,
        }
    }
}

/// Names of the further fields of every scene.
pub(super) const FIELDS: [&str; 2] = ["a", "b"];

/// By closed forms, in the order of widgets that overlap, without light.
pub(super) const PLAIN: Shading =
    Shading { integrator: Integrator::ANALYTIC, overlap: WidgetBlend::Exact, silhouette: None, light: None };

/// Two Gaussians, one of them tilted and one cut by a region, that overlap.
pub(super) fn look() -> TransferFunction {
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

pub(super) fn cube(counts: [usize; 3], jitter: f64) -> Grid {
    box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], jitter)
}

/// The grid with its points moved; the field stays with the points.
pub(super) fn moved(
    name: String,
    category: &'static str,
    base: &Grid,
    place: impl Fn(DVec3) -> DVec3,
) -> Hard {
    let places = base.points.to_vec();
    let grid = Grid { points: SharedSlice::from(sample(base, place)), ..base.clone() };
    Hard { category, name, grid, places, camera: outside(), look: look(), shading: PLAIN }
}

pub(super) const SIZE: [u32; 2] = [24, 24];

pub(super) fn outside() -> Camera {
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
