//! Every kind of widget, alone and together, with regions, under both models. Scenes and tests of all engines.

use super::Engine;
use super::compare::NamedScene;
use super::grids::{cube, smooth, smooth_gradient};
use super::looks::*;
use crate::random::widget_of_each_kind;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::grid::Array;
use voltet_core::transfer::{OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget};
use voltet_core::volume::Volume;

/// The smooth field with its gradient, and three further fields: two, and a magnitude that is 0 on a part.
fn volume() -> Arc<Volume> {
    let mut grid = cube([4, 4, 4], 0.2);
    let points = grid.points.clone();
    let field = |value: &dyn Fn(DVec3) -> f64| {
        Arc::new(Array { component_count: 1, values: points.iter().map(|&p| value(p)).collect() })
    };
    grid.point_arrays.insert("a".into(), field(&|p| (3.0 * p.x).sin()));
    grid.point_arrays.insert("b".into(), field(&|p| 400.0 + 50.0 * p.y * p.z));
    grid.point_arrays.insert("m".into(), field(&|p| (p.x + p.z - 0.3).max(0.0)));
    let gradient = points.iter().map(|&p| smooth_gradient(p)).collect();
    Arc::new(Volume { gradient: Some(gradient), ..(*smooth(grid)).clone() })
}

fn wave(period: f64, band_width: f64) -> Wave {
    Wave { origin: [0.1, 0.0], angle: 0.3, scale: [1.0, 0.2], period, band_width }
}

/// Four texels by three, with a corner of alpha 0.
fn table() -> Table {
    let texel = |k: usize| {
        let x = k as f32 / 11.0;
        [x, 1.0 - x, 0.3, if k == 0 { 0.0 } else { 0.2 + 0.8 * x }]
    };
    Table { width: 4, height: 3, texels: (0..12).map(texel).collect(), s: [0.1, 0.9], g: [0.0, 2.0] }
}

/// Each kind, by name, some of them with a region; a kind that has no entry here is drawn by lot.
pub fn widgets() -> Vec<(&'static str, Widget)> {
    let of = |profile| Widget { profile, color: [0.9, 0.6, 0.2], extinction: 3.0, region: None };
    let cut = |widget: Widget| Widget {
        region: Some(Region { corners: vec![[0.2, 0.1], [0.9, 0.3], [0.5, 2.0]] }),
        ..widget
    };
    let nd = Profile::GaussianNd {
        fields: vec!["b".into(), "a".into()],
        centre: vec![415.0, 0.6],
        matrix: vec![vec![0.05, 0.0], vec![0.01, 2.0]],
    };
    let triangular_nd = Profile::TriangularGaussianNd {
        fields: vec!["b".into(), "a".into()],
        magnitude: "m".into(),
        centre: vec![415.0, 0.6],
        matrix: vec![vec![0.1, 0.0], vec![0.02, 3.0]],
    };
    let ramp = ramp().widgets.remove(0);
    let mut widgets = vec![
        ("uniform", polygon(&[[0.2, 0.0], [0.8, 0.1], [0.7, 1.0], [0.3, 1.3]], 1.5, [0.3, 0.9, 0.4])),
        ("line", gaussian([0.6, 0.8], [0.1, f64::INFINITY], 4.0, [1.0, 0.5, 0.15])),
        ("plane", gaussian([0.6, 0.8], [0.1, 0.5], 4.0, [0.2, 0.5, 1.1])),
        ("nd", of(nd)),
        ("triangular", of(Profile::TriangularGaussian { centre: 0.5, sigma: 0.1 })),
        ("triangular nd", of(triangular_nd.clone())),
        ("triangle", of(Profile::TriangleWave(wave(0.21, 0.4)))),
        ("sine", of(Profile::SineWave(wave(0.13, 1.0)))),
        ("ramp", ramp.clone()),
        ("table", of(Profile::Table(Arc::new(table())))),
        ("cut line", cut(gaussian([0.6, 0.8], [0.1, f64::INFINITY], 4.0, [1.0, 0.5, 0.15]))),
        ("cut sine", cut(of(Profile::SineWave(wave(0.13, 0.7))))),
        ("cut ramp", cut(ramp)),
        ("cut triangular nd", cut(of(triangular_nd))),
    ];
    for widget in widget_of_each_kind() {
        let name = widget.profile.name();
        if widgets.iter().all(|(_, known)| known.profile.name() != name) {
            widgets.push((name, Widget { extinction: 3.0, ..widget }));
        }
    }
    widgets
}

const CONSTANT: OpticalModel = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };

/// A look at all the fields.
pub fn scene(name: String, look: TransferFunction) -> NamedScene {
    NamedScene { name, volume: volume(), look, camera: outside([40, 40]) }
}

pub fn each_alone_under_both_models(engine: &dyn Engine) {
    for (name, widget) in widgets() {
        let density = look(vec![widget]);
        engine.ordinary(&scene(name.into(), density.clone()));
        engine.ordinary(&scene(format!("glowing {name}"), TransferFunction { model: CONSTANT, ..density }));
    }
}

/// All of them, thinned so that they show.
pub fn all() -> TransferFunction {
    look(widgets().into_iter().map(|(_, widget)| widget.with_extinction_times(0.2)).collect())
}

pub fn all_at_once(engine: &dyn Engine) {
    engine.ordinary(&scene("all".into(), all()));
}

pub fn overlaps_that_glow(engine: &dyn Engine) {
    let look = TransferFunction { model: CONSTANT, ..overlapping() };
    engine.ordinary(&scene("glowing overlap".into(), look));
}

/// With the scalar more values than a device's workgroup keeps of a cell.
pub fn a_gaussian_over_eight_fields(engine: &dyn Engine) {
    let names: Vec<String> = (0..8).map(|k| format!("field {k}")).collect();
    let mut whole = (*volume()).clone();
    let mut grid = (*whole.grid).clone();
    for (k, name) in names.iter().enumerate() {
        let wave = |p: &DVec3| ((1.0 + 0.3 * k as f64) * p.x + p.y - 0.5 * p.z).sin();
        let values = grid.points.iter().map(wave).collect();
        grid.point_arrays.insert(name.clone(), Arc::new(Array { component_count: 1, values }));
    }
    whole.grid = Arc::new(grid);
    let row = |i: usize| (0..8).map(|j| if i == j { 1.0 } else { 0.1 * f64::from(j < i) }).collect();
    let profile =
        Profile::GaussianNd { fields: names, centre: vec![0.4; 8], matrix: (0..8).map(row).collect() };
    let widget = Widget { profile, color: [0.9, 0.6, 0.2], extinction: 3.0, region: None };
    let eight = scene("eight fields".into(), look(vec![widget]));
    engine.ordinary(&NamedScene { volume: Arc::new(whole), ..eight });
}
