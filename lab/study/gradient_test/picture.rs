//! The effect on a picture: a scene whose widgets look at the gradient magnitude and whose light looks at the gradient.

use super::fields::{Field, SMOOTH};
use super::meshes::Mesh;
use super::report::PictureError;
use super::subject::Subject;
use crate::work_precision;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::field::magnitude;
use voltet_core::grid::Grid;
use voltet_core::grid::generate::sample;
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::transfer::{OpticalModel, Profile, TransferFunction, Widget};
use voltet_core::volume::Volume;
use voltet_io::encode;
use voltet_nodes::drawing::ENGINES;
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{AdapterRequest, Engine, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};

/// Renderer of the pictures: the engine that draws every scene.
pub(super) struct TestRenderer {
    engine: Arc<dyn Engine>,
    grid: Arc<Grid>,
    exact: Picture,
}

/// Boxes a side: coarse, as data is where boundaries count.
const COUNT: usize = 16;
const SIZE: [u32; 2] = [256, 256];
const FIELD: Field = SMOOTH[1];
const PAPER: [f64; 3] = [1.0; 3];

impl TestRenderer {
    /// Draws with the exact gradient.
    pub fn new(progress: &dyn Progress) -> Result<TestRenderer> {
        let engine = ENGINES[0].open(&AdapterRequest::hardware(None))?;
        let grid = Arc::new(Mesh::Distorted.grid(COUNT).grid);
        let exact = draw(engine.as_ref(), &grid, sample(&grid, FIELD.gradient), progress)?;
        Ok(TestRenderer { engine, grid, exact })
    }

    /// The engine's name.
    pub fn engine(&self) -> String {
        self.engine.label()
    }

    /// The picture with the exact gradient, PNG.
    pub fn exact_png(&self) -> Result<Vec<u8>> {
        encode::png(&self.exact, PAPER, None)
    }

    /// Draws with the filter's gradient and compares.
    pub fn draw(&self, subject: &mut Subject<'_>, progress: &dyn Progress) -> Result<Option<PictureError>> {
        let values = sample(&self.grid, FIELD.value);
        let gradient = subject.gradient(|| "the picture".into(), &self.grid, &values, progress)?;
        let Some(gradient) = gradient else { return Ok(None) };
        let picture = draw(self.engine.as_ref(), &self.grid, gradient, progress)?;
        let errors = work_precision::errors(&picture, &self.exact);
        Ok(Some(PictureError {
            size: SIZE,
            maximum: errors.maximum,
            root_mean_square: errors.root_mean_square,
            pixels_over_step: errors.pixels_over_step,
            png: encode::png(&picture, PAPER, None)?,
        }))
    }
}

fn draw(
    engine: &dyn Engine,
    grid: &Arc<Grid>,
    gradient: Vec<DVec3>,
    progress: &dyn Progress,
) -> Result<Picture> {
    let volume = Arc::new(Volume {
        grid: grid.clone(),
        scalar: SharedSlice::from(sample(grid, FIELD.value)),
        gradient_magnitude: Some(SharedSlice::from(magnitude(&gradient))),
        gradient: Some(SharedSlice::from(gradient)),
    });
    let light = Light { ambient: 0.4, diffuse: 0.6, direction: DVec3::new(-1.0, -1.5, 2.0).normalize() };
    let shading = Shading {
        integrator: Integrator::ANALYTIC,
        overlap: WidgetBlend::Exact,
        silhouette: None,
        light: Some(light),
    };
    let scene = Scene {
        volume: volume.clone(),
        transfer_function: Arc::new(look()),
        camera: camera(),
        shading,
        order: VisibilityOrder::Exact,
    };
    Ok(engine.prepare(&volume)?.draw(&scene, &RenderOptions::default(), &CancelOnly(progress))?.picture)
}

/// The steep flank of the peak, and its summit, which is flat: only g tells them from what has the same s elsewhere.
fn look() -> TransferFunction {
    let gaussian = |centre, widths: [f64; 2], extinction, color| Widget {
        profile: Profile::Gaussian { centre, matrix: [[1.0 / widths[0], 0.0], [0.0, 1.0 / widths[1]]] },
        color,
        extinction,
        region: None,
    };
    let widgets = vec![
        gaussian([0.6, 2.15], [0.06, 0.25], 12.0, [0.15, 0.45, 0.9]),
        gaussian([1.0, 0.0], [0.08, 0.6], 20.0, [0.95, 0.45, 0.1]),
    ];
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 1.0, widgets }
}

fn camera() -> Camera {
    Camera {
        eye: DVec3::new(1.7, -1.3, 1.5),
        target: DVec3::new(0.46, 0.54, 0.55),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 32.0 },
        near: 0.0,
        size: SIZE,
        samples: 1,
    }
}
