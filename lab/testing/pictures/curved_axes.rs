//! Logarithmic axes of s and g, against the 64-bit referee. Tests of all engines that draw them.

use super::compare::SHADING;
use super::grids::*;
use super::surfaces::{Draw, cameras, compare, scene};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::clip::{Clip, ClipShape};
use voltet_core::colormap::Colormap;
use voltet_core::grid::Grid;
use voltet_core::transfer::{
    AxisScale, ControlPoint, OpticalModel, Profile, Region, TransferFunction, Wave, Widget,
};
use voltet_core::volume::Volume;
use voltet_optics::shading::{Light, Shading};

/// A cube in which s spans some decades from one corner to the other, and g the same the other way.
fn decades(grid: Grid, span: f64) -> Arc<Volume> {
    let along = |p: &DVec3| (p.x + 0.6 * p.y + 0.3 * (4.0 * p.z).sin()) / 2.0;
    let value = |exponent: f64| 10f64.powf(span * exponent);
    let scalar: Vec<f64> = grid.points.iter().map(|p| value(along(p) - 0.5)).collect();
    let g: Vec<f64> = grid.points.iter().map(|p| value(0.5 - along(p) + 0.2 * p.z)).collect();
    let gradient = grid.points.iter().map(|&p| smooth_gradient(p)).collect();
    Arc::new(Volume {
        grid: Arc::new(grid),
        scalar: SharedSlice::from(scalar),
        gradient: Some(gradient),
        gradient_magnitude: Some(SharedSlice::from(g)),
    })
}

fn look(axes: [AxisScale; 2], widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction { model: OpticalModel::DensityEmitter, unit_distance: 0.1, widgets, axes }
}

fn gaussian(centre: [f64; 2], sigma: [f64; 2], extinction: f64, color: [f64; 3]) -> Widget {
    let [a, b] = sigma.map(|sigma| 1.0 / (2f64.sqrt() * sigma));
    let profile = Profile::Gaussian { centre, matrix: [[a, 0.0], [0.0, b]] };
    Widget { profile, color, extinction, region: None }
}

fn uniform(region: Region, extinction: f64, color: [f64; 3]) -> Widget {
    Widget { profile: Profile::Uniform, color, extinction, region: Some(region) }
}

fn map(low: f64, high: f64, extinction: f64) -> Widget {
    let point = |&(level, color): &(f64, [f64; 3])| ControlPoint {
        s: low + level * (high - low),
        color,
        extinction: extinction * (1.0 - (2.0 * level - 1.0).abs()),
    };
    let points = Colormap::Viridis.curve().knots().iter().map(point).collect();
    Widget { profile: Profile::PiecewiseLinear { points }, color: [1.0; 3], extinction: 1.0, region: None }
}

const LOG: [AxisScale; 2] = [AxisScale::Log, AxisScale::Log];

fn looks(span: f64) -> Vec<(&'static str, TransferFunction)> {
    let wave = Wave { origin: [0.0; 2], angle: 0.0, scale: [1.0; 2], period: 0.2 * span, band_width: 1.0 };
    let wave = Widget {
        profile: Profile::SineWave(wave),
        color: [0.9, 0.6, 0.2],
        extinction: 0.4,
        region: Some(Region::rectangle([-0.3 * span, 0.3 * span], [f64::NEG_INFINITY, f64::INFINITY])),
    };
    let near = gaussian([0.1 * span, 0.0], [0.05 * span, 0.3 * span], 2.0, [1.0, 0.5, 0.1]);
    let far = gaussian([-0.1 * span, 0.1], [0.1 * span, f64::INFINITY], 1.0, [0.1, 0.5, 0.9]);
    let box_region = Region::rectangle([-0.2 * span, 0.05 * span], [-0.4 * span, 0.3 * span]);
    let polygon = Region { corners: vec![[0.0, 0.0], [0.3 * span, 0.0], [0.2 * span, -0.3 * span]] };
    let symlog = [AxisScale::SymLog { linear_below: 1.0 }, AxisScale::Linear];
    // Nearly as narrow as a device draws.
    let shell = gaussian([0.1 * span, 0.0], [4e-3, f64::INFINITY], 25.0, [0.3, 1.0, 0.4]);
    vec![
        ("one colour", look(LOG, vec![near.clone()])),
        ("a narrow shell", look(LOG, vec![shell, far.clone()])),
        ("several", look(LOG, vec![near.clone(), far.clone()])),
        // The second looks at g, so that places without a position of g are not drawn, whether it is seen or not.
        ("out of sight", look(LOG, vec![far.clone(), gaussian([9.0 * span, 0.0], [0.1; 2], 1.0, [1.0; 3])])),
        ("edges", look(LOG, vec![uniform(box_region, 0.5, [0.2, 0.8, 0.4]), far.clone()])),
        ("edges aslant", look(LOG, vec![uniform(polygon, 0.5, [0.2, 0.8, 0.4])])),
        ("a colour map", look([AxisScale::Log, AxisScale::Linear], vec![map(-0.4 * span, 0.4 * span, 1.0)])),
        ("waves", look([AxisScale::Log, AxisScale::Linear], vec![wave])),
        ("both signs", look(symlog, vec![map(-0.3 * span, 0.3 * span, 1.0)])),
        (
            "constant emitter",
            TransferFunction {
                model: OpticalModel::ConstantEmitter { cutoff: 0.05 },
                ..look(LOG, vec![near, far])
            },
        ),
    ]
}

/// Fields over one decade and over twelve, by every kind of widget, in every view with some of these.
pub fn fields_over_decades(draw: Draw) {
    for span in [1.0, 12.0] {
        let volume = decades(cube([5, 5, 5], 0.2), span);
        for (number, (name, look)) in looks(span).into_iter().enumerate() {
            for turn in [0, 3] {
                let (view, camera) = cameras()[(number + turn) % 5];
                let scene = scene(&volume, look.clone(), camera, &SHADING);
                compare(draw, &format!("{span} decades, {name}, {view}"), &scene);
            }
        }
    }
}

/// Light, clips and values without a position.
pub fn decades_lit_and_cut(draw: Draw) {
    let volume = decades(cube([5, 5, 5], 0.2), 3.0);
    let shifted = volume.scalar.iter().map(|s| s - 0.5).collect::<Vec<_>>();
    let flat = volume.gradient_magnitude.iter().flat_map(|g| g.iter()).map(|g| (g - 0.5).max(0.0));
    let flat = Some(SharedSlice::from(flat.collect::<Vec<_>>()));
    let scalar = SharedSlice::from(shifted);
    let shifted = Arc::new(Volume { scalar, gradient_magnitude: flat, ..(*volume).clone() });
    let light = Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 };
    let lit = Shading { light: Some(light), ..SHADING };
    let ball = ClipShape::Sphere { centre: DVec3::new(0.5, 0.5, 0.6), radius: 0.45 };
    for (number, (name, look)) in looks(3.0).into_iter().enumerate() {
        let (view, camera) = cameras()[number % 3];
        let with = |volume, shading, clips: Vec<Clip>| {
            let mut scene = scene(volume, look.clone(), camera, shading);
            scene.clips = clips;
            scene
        };
        let cut = vec![Clip { shape: ball, invert: true }];
        compare(draw, &format!("lit and cut, {name}, {view}"), &with(&volume, &lit, cut));
        compare(draw, &format!("below 0, {name}, {view}"), &with(&shifted, &SHADING, Vec::new()));
    }
}
