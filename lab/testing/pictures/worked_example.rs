//! The numbers of `docs/src/explanation/optics.md`, section 11 (A worked example): one cell, two rays, each kind of widget under both
//! models. Tests of all engines.
//!
//! The document's numbers were computed apart from this program, by quadrature with 18 digits, and are given to six
//! decimals.

use super::Engine;
use super::compare::{NamedScene, SHADING};
use super::looks::{everywhere, gaussian, points};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::transfer::{OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget};
use voltet_core::volume::Volume;
use voltet_optics::WidgetBlend;
use voltet_optics::shading::{Light, Shading, VisibilityOrder};
use voltet_reference as reference;

/// Half of the last decimal, and as much again for what stands on a tie.
const SIX_DECIMALS: f64 = 1e-6;

/// The middle pixel, whose ray enters at (s, g) = (1, 1) and leaves at (2, 2) after a length of 1.
const MIDDLE: [usize; 2] = [1, 7];

fn cell() -> Arc<Volume> {
    let points = vec![DVec3::ZERO, DVec3::X * 2.0, DVec3::Y * 2.0, DVec3::Z * 2.0];
    let tetrahedra = vec![[0, 1, 2, 3]];
    let gradient = vec![DVec3::Z, DVec3::Z, DVec3::Z, DVec3::new(0.0, 2.88, 0.84)];
    Arc::new(Volume {
        grid: Arc::new(Grid {
            points: SharedSlice::from(points),
            tetrahedra: tetrahedra.into(),
            ..Grid::default()
        }),
        scalar: SharedSlice::from(vec![0.0, 2.0, 2.0, 2.0]),
        gradient_magnitude: Some(SharedSlice::from(gradient.iter().map(|v| v.length()).collect::<Vec<_>>())),
        gradient: Some(SharedSlice::from(gradient)),
    })
}

fn camera() -> Camera {
    Camera {
        eye: DVec3::new(0.5, 0.5, -1.5),
        target: DVec3::new(0.5, 0.5, 0.0),
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y: 90.0 },
        near: 0.0,
        size: [3, 15],
        samples: 1,
    }
}

fn scene(widgets: Vec<Widget>, model: OpticalModel) -> NamedScene {
    let look = TransferFunction { model, unit_distance: 2.0, widgets, axes: Default::default() };
    NamedScene { name: "one cell".into(), volume: cell(), look, camera: camera() }
}

const DENSITY: OpticalModel = OpticalModel::DensityEmitter;
const CONSTANT: OpticalModel = OpticalModel::ConstantEmitter { cutoff: 1.0 / 255.0 };
const COLOR: [f64; 3] = [1.0, 0.5, 0.25];

fn of(profile: Profile) -> Widget {
    Widget { profile, color: COLOR, extinction: 4.0, region: None }
}

/// A wave from the origin [1, 1].
fn wave(angle_degrees: f64, scale: [f64; 2], band_width: f64) -> Wave {
    Wave { origin: [1.0, 1.0], angle: angle_degrees.to_radians(), scale, period: 0.4, band_width }
}

fn ramp() -> Widget {
    points(&[[1.25, 1.0, 0.0, 0.0, 0.0], [1.75, 0.0, 0.0, 1.0, 4.0]])
}

fn table() -> Table {
    let texels = [0.0, 1.0, 0.5, 0.0].map(|alpha| [1.0, 0.5, 0.25, alpha]).to_vec();
    Table { width: 2, height: 2, texels, s: [1.0, 2.0], g: [1.0, 2.0] }
}

/// Widgets with T, and with red and blue of C under the density-emitter and under the constant-emitter.
type Row = (&'static str, Widget, f64, [f64; 2], [f64; 2]);

fn rows() -> Vec<Row> {
    // Blue is a quarter of red where the colour is `COLOR`.
    let plain = |name, widget, depth, density: f64, constant: f64| -> Row {
        (name, widget, depth, [density, 0.25 * density], [constant, 0.25 * constant])
    };
    let strip = Region::rectangle([1.25, 1.75], [f64::NEG_INFINITY, f64::INFINITY]);
    let uniform = Widget { region: Some(strip), ..of(Profile::Uniform) };
    let tilted = Profile::Gaussian { centre: [1.5, 1.5], matrix: [[2.0, 1.0], [0.0, 1.0]] };
    let triangle = |angle, scale, width| of(Profile::TriangleWave(wave(angle, scale, width)));
    let sine = |width| of(Profile::SineWave(wave(0.0, [1.0; 2], width)));
    vec![
        plain("uniform", uniform, 1.0, 0.632121, 0.158030),
        plain(
            "gaussian",
            gaussian([1.5, 0.0], [0.25, f64::INFINITY], 4.0, COLOR),
            1.196288,
            0.697686,
            0.299882,
        ),
        plain("gaussian with a matrix", of(tilted), 1.092584, 0.664651, 0.312866),
        plain(
            "triangular gaussian",
            of(Profile::TriangularGaussian { centre: 1.5, sigma: 0.1 }),
            0.539717,
            0.417087,
            0.278873,
        ),
        plain("triangle wave", triangle(0.0, [1.0; 2], 1.0), 1.0, 0.632121, 0.317272),
        plain("half bands", triangle(0.0, [1.0; 2], 0.5), 0.5, 0.393469, 0.196656),
        plain("oblique bands", triangle(30.0, [1.0, 2.0], 1.0), 1.023702, 0.640738, 0.315467),
        plain("sine wave", sine(1.0), 1.273240, 0.720077, 0.284532),
        plain("half sine bands", sine(0.5), 0.871982, 0.581878, 0.223107),
        ("piecewise-linear", ramp(), 1.0, [0.144376, 0.487745], [0.114560, 0.158028]),
        plain("table", of(Profile::Table(Arc::new(table()))), 1.25, 0.713495, 0.316496),
    ]
}

/// Red, blue and opacity of a pixel: of the referee's ray, and of the picture of the engine that is tested.
fn assert_pixel(
    engine: &dyn Engine,
    name: &str,
    scene: &NamedScene,
    shading: &Shading,
    at: [usize; 2],
    expected: [f64; 3],
) {
    let wanted = scene.drawn_by(shading, VisibilityOrder::Exact);
    let made = reference::tracer(&wanted).unwrap_or_else(|error| panic!("{name}: {error}"));
    let seen = made.trace(&made.ray(at[0] as f64 + 0.5, at[1] as f64 + 0.5)).expect("traces");
    let found = [seen.color[0], seen.color[2], seen.opacity];
    let close = |found: [f64; 3], bound: f64| found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= bound);
    assert!(close(found, SIX_DECIMALS), "{name}, referee: {found:?} for {expected:?}");
    if let Some(picture) = engine.picture(scene, shading) {
        let [red, _, blue, opacity] = picture.pixel(at[0], at[1]).map(f64::from);
        let found = [red, blue, opacity];
        assert!(close(found, SIX_DECIMALS + engine.rounding()), "{name}, engine: {found:?} for {expected:?}");
    }
}

pub fn each_kind_of_widget(engine: &dyn Engine) {
    for (name, widget, depth, density, constant) in rows() {
        let opacity = 1.0 - (-depth).exp();
        for (model, [red, blue]) in [(DENSITY, density), (CONSTANT, constant)] {
            let scene = scene(vec![widget.clone()], model);
            assert_pixel(engine, name, &scene, &SHADING, MIDDLE, [red, blue, opacity]);
        }
    }
}

/// A uniform widget in red with a Gaussian in blue, in their order and mixed.
pub fn widgets_that_overlap(engine: &dyn Engine) {
    let blue = gaussian([1.75, 0.0], [0.1, f64::INFINITY], 4.0, [0.0, 0.0, 1.0]);
    let widgets = vec![everywhere(4.0, [1.0, 0.0, 0.0]), blue];
    for (overlap, model, red, blue) in [
        (WidgetBlend::Exact, DENSITY, 0.825715, 0.092053),
        (WidgetBlend::Mix, DENSITY, 0.734740, 0.183028),
        (WidgetBlend::Exact, CONSTANT, 0.206429, 0.064987),
        (WidgetBlend::Mix, CONSTANT, 0.183685, 0.111651),
    ] {
        let shading = Shading { overlap, ..SHADING };
        let name = format!("{overlap:?} {model:?}");
        assert_pixel(engine, &name, &scene(widgets.clone(), model), &shading, MIDDLE, [red, blue, 0.917768]);
    }
}

/// The piecewise-linear widget in a uniform one without light: the mix keeps the colour that it has alone.
pub fn a_colour_that_varies_in_a_mix(engine: &dyn Engine) {
    let scene = scene(vec![ramp(), everywhere(4.0, [0.0; 3])], DENSITY);
    for (overlap, red, blue) in
        [(WidgetBlend::Exact, 0.055735, 0.117571), (WidgetBlend::Mix, 0.072343, 0.244395)]
    {
        let shading = Shading { overlap, ..SHADING };
        assert_pixel(engine, &format!("{overlap:?}"), &scene, &shading, MIDDLE, [red, blue, 0.950213]);
    }
}

/// ĝ = (0, 0.6, 0.8) at the middle of the segment.
pub fn silhouette_and_light(engine: &dyn Engine) {
    let scene = scene(vec![everywhere(4.0, COLOR)], DENSITY);
    let light = Light { direction: DVec3::Y * 5.0, ambient: 0.3, diffuse: 0.7 };
    let lit = Shading { light: Some(light), ..SHADING };
    let edged = Shading { silhouette: Some(1.0), ..SHADING };
    let both = Shading { silhouette: Some(1.0), ..lit };
    for (shading, red, opacity) in [
        (SHADING, 0.864665, 0.864665),
        (lit, 0.622559, 0.864665),
        (edged, 0.172933, 0.172933),
        (both, 0.124512, 0.172933),
    ] {
        assert_pixel(engine, "surface", &scene, &shading, MIDDLE, [red, 0.25 * red, opacity]);
    }
}

/// The camera: right is −x here, so the left pixel's ray leans to +x; the near plane is a depth, a length is not.
pub fn another_ray_and_a_near_plane(engine: &dyn Engine) {
    let uniform = scene(vec![everywhere(4.0, COLOR)], DENSITY);
    let opacity = 0.759313;
    assert_pixel(engine, "left", &uniform, &SHADING, [0, 7], [opacity, 0.25 * opacity, opacity]);
    let cut = NamedScene { camera: Camera { near: 2.0, ..camera() }, ..uniform };
    let opacity = 0.632121;
    assert_pixel(engine, "near", &cut, &SHADING, MIDDLE, [opacity, 0.25 * opacity, opacity]);
}

/// A widget without extinction has no share of its peak above the cutoff.
pub fn nothing_glows_without_extinction(engine: &dyn Engine) {
    let bright = gaussian([1.5, 0.0], [0.25, f64::INFINITY], 0.0, [9.0; 3]);
    let widgets = vec![everywhere(4.0, COLOR), bright];
    assert_pixel(
        engine,
        "no extinction",
        &scene(widgets, CONSTANT),
        &SHADING,
        MIDDLE,
        [0.216166, 0.054042, 0.864665],
    );
}
