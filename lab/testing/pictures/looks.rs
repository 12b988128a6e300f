//! Transfer functions and cameras of the scenes.

use glam::DVec3;
use voltet_core::camera::{Camera, Projection};
use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Region, TransferFunction, Widget};

const INFINITE: [f64; 2] = [f64::NEG_INFINITY, f64::INFINITY];

/// Density-emitter, unit distance 1.
pub fn look(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets,
        axes: Default::default(),
    }
}

/// An axis-aligned Gaussian; `sigma[1]` may be infinite.
pub fn gaussian(centre: [f64; 2], sigma: [f64; 2], extinction: f64, color: [f64; 3]) -> Widget {
    let k = sigma.map(|x| 1.0 / (std::f64::consts::SQRT_2 * x));
    let profile = Profile::Gaussian { centre, matrix: [[k[0], 0.0], [0.0, k[1]]] };
    Widget { profile, color, extinction, region: None }
}

/// A uniform widget in a polygon.
pub fn polygon(corners: &[[f64; 2]], extinction: f64, color: [f64; 3]) -> Widget {
    let region = Some(Region { corners: corners.to_vec() });
    Widget { profile: Profile::Uniform, color, extinction, region }
}

/// Widget of equal extinction everywhere.
pub fn everywhere(extinction: f64, color: [f64; 3]) -> Widget {
    let region = Some(Region::rectangle(INFINITE, INFINITE));
    Widget { profile: Profile::Uniform, color, extinction, region }
}

/// Control points [s, r, g, b, extinction].
pub fn points(rows: &[[f64; 5]]) -> Widget {
    let point = |&[s, r, g, b, extinction]: &[f64; 5]| ControlPoint { s, color: [r, g, b], extinction };
    let profile = Profile::PiecewiseLinear { points: rows.iter().map(point).collect() };
    Widget { profile, color: [0.0; 3], extinction: 0.0, region: None }
}

/// One-dimensional control points over [0, 1].
pub fn ramp() -> TransferFunction {
    look(vec![points(&[
        [0.0, 0.1, 0.2, 0.9, 0.0],
        [0.3, 0.1, 0.8, 0.9, 1.0],
        [0.55, 0.9, 0.7, 0.1, 0.3],
        [0.9, 1.5, 0.1, 0.1, 6.0],
    ])])
}

/// One Gaussian in s and g.
pub fn one_gaussian() -> TransferFunction {
    look(vec![gaussian([0.6, 0.8], [0.1, 0.5], 4.0, [1.0, 0.5, 0.15])])
}

/// Two Gaussians, one of them tilted, one cut by a rectangle, and a polygon, all overlapping.
pub fn overlapping() -> TransferFunction {
    let tilted = Widget {
        profile: Profile::Gaussian { centre: [0.55, 0.9], matrix: [[4.0, 1.5], [-1.0, 1.6]] },
        ..gaussian([0.0; 2], [1.0; 2], 3.0, [0.2, 0.5, 1.1])
    };
    let cut = Widget {
        region: Some(Region::rectangle([0.35, 0.75], [0.2, 1.4])),
        ..gaussian([0.5, 0.7], [0.15, 0.6], 5.0, [0.9, 0.3, 0.2])
    };
    let corners = [[0.2, 0.0], [0.8, 0.1], [0.7, 1.0], [0.3, 1.3]];
    look(vec![tilted, cut, polygon(&corners, 1.5, [0.3, 0.9, 0.4])])
}

/// A perspective camera with z up.
pub fn perspective(eye: [f64; 3], target: [f64; 3], fov_y: f64, size: [u32; 2]) -> Camera {
    Camera {
        eye: eye.into(),
        target: target.into(),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y },
        near: 0.0,
        size,
        samples: 1,
    }
}

/// An orthographic camera with z up.
pub fn orthographic(eye: [f64; 3], target: [f64; 3], height: f64, size: [u32; 2]) -> Camera {
    Camera { projection: Projection::Orthographic { height }, ..perspective(eye, target, 1.0, size) }
}

/// The unit cube from outside, near enough for strong perspective.
pub fn outside(size: [u32; 2]) -> Camera {
    perspective([-0.9, -1.1, 1.4], [0.5, 0.5, 0.5], 45.0, size)
}
