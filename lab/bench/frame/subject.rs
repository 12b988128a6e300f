//! Grids, where they are seen from, and the transfer functions they are drawn with.

use crate::options::LOOKS;
use glam::DVec3;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet::Document;
use voltet::core::camera::{Camera, Projection};
use voltet::core::field::{self, LeastSquares, Method};
use voltet::core::grid::Grid;
use voltet::core::progress::NoProgress;
use voltet::core::transfer::{ControlPoint, OpticalModel, Profile, TransferFunction, Widget};
use voltet::core::volume::Volume;
use voltet::core::{Error, Result};
use voltet::graph::NoObserver;
use voltet::io::formats::{self, Request};
use voltet_study::work_precision::Subject as Studied;

/// A grid, where it is seen from, and the transfer functions it is drawn with.
pub struct Subject {
    /// The file, for grids that are read.
    file: &'static str,
    scalar: &'static str,
    eye: DVec3,
    target: DVec3,
    unit_distance: f64,
    /// s, red, green, blue, extinction.
    piecewise: &'static [[f64; 5]],
    /// Name, centre, sigma, extinction.
    pub gaussians: &'static [(&'static str, [f64; 2], [f64; 2], f64)],
    /// Centres of further Gaussians, as wide as the first and each of a colour of its own.
    pub further: [[f64; 2]; 3],
}

const SUBJECTS: [Subject; 4] = [
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
    Subject {
        file: "post.vtu",
        scalar: "pressure",
        eye: DVec3::new(-28.0, -40.0, 30.0),
        target: DVec3::new(0.0, 0.0, 2.4),
        unit_distance: 4.0,
        piecewise: &[
            [-0.22, 0.1, 0.2, 0.9, 0.4],
            [0.0, 0.1, 0.8, 0.9, 0.1],
            [0.4, 0.2, 0.8, 0.2, 0.3],
            [1.0, 0.9, 0.8, 0.1, 0.5],
            [1.76, 0.9, 0.1, 0.1, 1.5],
        ],
        gaussians: &[("wide", [0.2, 0.1], [0.5, 1.0], 0.5)],
        further: [[0.9, 0.5], [-0.1, 0.3], [1.5, 0.8]],
    },
    Subject {
        file: GENERATED,
        scalar: "wavelet",
        eye: DVec3::new(-28.0, -38.0, 24.0),
        target: DVec3::ZERO,
        unit_distance: 4.0,
        piecewise: &[
            [40.0, 0.1, 0.2, 0.9, 0.0],
            [100.0, 0.1, 0.8, 0.9, 0.1],
            [160.0, 0.2, 0.8, 0.2, 0.3],
            [220.0, 0.9, 0.8, 0.1, 0.2],
            [277.0, 0.9, 0.1, 0.1, 1.5],
        ],
        gaussians: &[("wide", [150.0, 20.0], [60.0, 40.0], 0.5)],
        further: [[220.0, 30.0], [90.0, 30.0], [120.0, 60.0]],
    },
];

/// In place of a file.
const GENERATED: &str = "wavelet";

/// Hexahedra a side of a generated grid, six tetrahedra each: 0.98, 4.1 and 16.1 million.
const SIDES: [(&str, u32); 3] = [("1M", 55), ("4M", 88), ("16M", 139)];

/// A grid for looks of the scalar alone, and with the gradient magnitude.
pub struct Volumes {
    pub plain: Arc<Volume>,
    pub bivariate: Arc<Volume>,
    /// File that it was read from.
    pub path: Option<PathBuf>,
}

impl Subject {
    /// The grid of a name of the command line; `None`: there is no such file.
    pub fn named(name: &str) -> Result<Option<(&'static Subject, Volumes)>> {
        let side = SIDES.iter().find(|(known, _)| *known == name).map(|(_, side)| *side);
        let stem = if side.is_some() { GENERATED } else { name };
        let subject = SUBJECTS.iter().find(|subject| subject.file.trim_end_matches(".vtu") == stem);
        let subject = subject.ok_or_else(|| Error::usage("there is no such grid").got(name))?;
        let (grid, path) = match side {
            Some(side) => (generated(side)?, None),
            None => {
                let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
                let further = std::env::var_os("VOLTET_TEST_DATA").map(PathBuf::from);
                let mut paths =
                    [Some(shipped), further].into_iter().flatten().map(|folder| folder.join(subject.file));
                let Some(path) = paths.find(|path| path.is_file()) else { return Ok(None) };
                let request = Request { scalar: Some(subject.scalar.into()), ..Request::default() };
                (Arc::new(formats::read(&path, &request, &NoProgress)?), Some(path))
            }
        };
        let scalar = grid.scalar.clone().ok_or_else(|| Error::run("the grid has no scalar"))?;
        let gradient =
            Method::with_defaults(Arc::new(LeastSquares))?.gradient(&grid, &scalar, &NoProgress)?;
        let magnitude = field::magnitude(&gradient.vectors);
        let plain = Volume { grid, scalar, gradient: None, gradient_magnitude: None };
        let bivariate = Arc::new(Volume { gradient_magnitude: Some(magnitude.into()), ..plain.clone() });
        Ok(Some((subject, Volumes { plain: Arc::new(plain), bivariate, path })))
    }

    /// The name of the array that is drawn.
    pub fn scalar(&self) -> &'static str {
        self.scalar
    }

    /// A look of the command line, with the volume that it needs.
    pub fn drawn<'a>(&self, name: &str, volumes: &'a Volumes) -> (&'a Arc<Volume>, TransferFunction) {
        if name == LOOKS[0] {
            return (&volumes.plain, self.piecewise_linear());
        }
        let further = if name == LOOKS[1] { 0 } else { self.further.len() };
        (&volumes.bivariate, self.gaussians(further, false))
    }

    /// The first Gaussian with so many further ones, of the same colour or each of its own.
    pub fn gaussians(&self, further: usize, same_color: bool) -> TransferFunction {
        let (_, centre, sigma, extinction) = self.gaussians[0];
        let mut look = self.gaussian(centre, sigma, extinction);
        let first = look.widgets[0].color;
        for (centre, color) in
            self.further[..further].iter().zip([[0.1, 0.6, 1.0], [0.1, 1.0, 0.2], [1.0, 0.1, 0.8]])
        {
            let mut widget = self.gaussian(*centre, sigma, extinction).widgets.remove(0);
            widget.color = if same_color { first } else { color };
            look.widgets.push(widget);
        }
        look
    }
}

/// The field by formula, by the node that makes it.
fn generated(side: u32) -> Result<Arc<Grid>> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/wavelet.toml");
    let options = [format!("grid.resolution=[{side},{side},{side}]")];
    let document = Document::open(&file, &options, &voltet::nodes::registry()?)?;
    let mut session = voltet::nodes::session();
    let studied = Studied::gather(&document.graph, Some("scalar_alone"), false, &mut session, &NoObserver)?;
    let mut grid = Grid::clone(&studied.scene.volume.grid);
    grid.scalar = Some(studied.scene.volume.scalar.clone());
    Ok(Arc::new(grid))
}

impl Subject {
    /// Seen from its place, turned so far about the z axis.
    pub fn camera(&self, degrees: f64, size: u32) -> Camera {
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

    /// Transfer function of the scalar alone.
    pub fn piecewise_linear(&self) -> TransferFunction {
        let point = |&[s, r, g, b, extinction]: &[f64; 5]| ControlPoint { s, color: [r, g, b], extinction };
        self.look(Profile::PiecewiseLinear { points: self.piecewise.iter().map(point).collect() }, 0.0)
    }

    /// One Gaussian.
    pub fn gaussian(&self, centre: [f64; 2], sigma: [f64; 2], extinction: f64) -> TransferFunction {
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

/// The median.
pub fn middle(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}
