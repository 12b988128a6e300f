//! Small pictures of scenes that are hard to draw, by every engine, held against the 64-bit referee: small grids with hard cells, hard
//! transfer functions and hard cameras.

use crate::devices;
use crate::work_precision::pixel_errors;
use glam::DVec3;
use serde::Serialize;
use std::sync::Arc;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::grid::{Array, Grid};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::transfer::{
    ControlPoint, OpticalModel, Profile, Region, Table, TransferFunction, Wave, Widget,
};
use voltet_core::volume::Volume;
use voltet_core::{Result, SharedSlice};
use voltet_introspect::evaluator;
use voltet_judge::{Evaluator64, SegmentEvaluator};
use voltet_nodes::drawing::ENGINES;
use voltet_optics::WidgetBlend;
use voltet_optics::engine::{Compositor, Engine, EngineInfo, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Light, Shading, VisibilityOrder};
use voltet_reference as reference;

/// Largest error of a channel of premultiplied linear RGBA, on either engine: what 32-bit segments leave on ordinary scenes,
/// with room for their condition.
pub(super) const BOUND: f64 = 2e-4;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HardPicture {
    pub category: &'static str,
    pub scene: String,
    pub engine: String,
    /// Reason why it was not drawn: a scene that a device refuses goes to the CPU engine by `auto`.
    pub refused: Option<String>,
    /// Largest error of a channel; ∞ where one is not finite.
    pub worst_error: f64,
    pub worst_pixel: [usize; 2],
    pub bound: f64,
}

impl HardPicture {
    pub fn passed(&self) -> bool {
        self.worst_error <= self.bound
    }
}

/// Draws every picture with all of them. Errors: a stopped run, and those of drawing.
pub(super) fn pictures(renderers: &[OpenRenderer], progress: &dyn Progress) -> Result<Vec<HardPicture>> {
    let scenes = hard_scenes();
    let mut all = Vec::new();
    for (k, hard) in scenes.iter().enumerate() {
        progress.report(hard.category, k as f64 / scenes.len() as f64);
        progress.check_cancelled()?;
        let exact = reference::draw(&hard.scene, &CancelOnly(progress))?;
        for renderer in renderers {
            let ((worst_error, worst_pixel), refused) = match picture(renderer, None, &hard.scene, progress) {
                Ok(found) => (worst(&found, &exact), None),
                // What a device does not hold `auto` leaves to the native engine.
                Err(error) if may_refuse(renderer, progress) => ((0.0, [0; 2]), Some(error.to_string())),
                Err(error) => return Err(error),
            };
            let (category, scene, engine) = (hard.category, hard.name.clone(), renderer.engine.label());
            all.push(HardPicture {
                category,
                scene,
                engine,
                refused,
                worst_error,
                worst_pixel,
                bound: BOUND,
            });
        }
    }
    Ok(all)
}

/// Draws it. `way`: how a device composites.
pub(super) fn picture(
    renderer: &OpenRenderer,
    way: Option<Compositor>,
    scene: &Scene,
    progress: &dyn Progress,
) -> Result<Picture> {
    let volume = renderer.engine.prepare(&scene.volume)?;
    let manner = RenderOptions { compositing: way, ..RenderOptions::default() };
    Ok(volume.draw(scene, &manner, &CancelOnly(progress))?.picture)
}

/// True if what went wrong is that a device does not hold the scene.
pub(super) fn may_refuse(renderer: &OpenRenderer, progress: &dyn Progress) -> bool {
    renderer.declared.on_device && !renderer.engine.is_lost() && !progress.cancelled()
}

fn worst(found: &Picture, exact: &Picture) -> (f64, [usize; 2]) {
    let errors = pixel_errors(found, exact).enumerate();
    let (at, error) = errors.fold((0, 0.0), |most, one| if one.1 > most.1 { one } else { most });
    (error, [at % exact.width, at / exact.width])
}

/// The sets of forms and the engines that this build and this machine have.
pub struct Subjects {
    /// The 64-bit ones, then those of every engine that has any.
    pub forms: Vec<Box<dyn SegmentEvaluator>>,
    /// Engines that are not judged, with the reason and the remedy.
    pub left_out: Vec<String>,
    pub renderers: Vec<OpenRenderer>,
}

pub struct OpenRenderer {
    pub declared: &'static EngineInfo,
    pub engine: Arc<dyn Engine>,
}

/// Everything that can be judged here. `adapter`: a device by its kind or a part of its name; without it the fastest that is
/// hardware, and what is left out where there is none.
///
/// Errors: a device that is named and not there.
pub fn subjects(adapter: Option<&str>) -> Result<Subjects> {
    let mut subjects =
        Subjects { forms: vec![Box::new(Evaluator64)], left_out: Vec::new(), renderers: Vec::new() };
    for declared in ENGINES {
        match devices::open_variants_of(declared, adapter.filter(|_| declared.on_device)) {
            Ok(each) => {
                subjects.forms.extend(each.iter().filter_map(|engine| evaluator(engine.as_ref())));
                subjects.renderers.extend(each.into_iter().map(|engine| OpenRenderer { declared, engine }));
            }
            Err(error) if adapter.is_some() => return Err(error),
            Err(error) => subjects.left_out.push(format!("the engine {}: {error}", declared.name)),
        }
    }
    Ok(subjects)
}

pub(super) struct HardScene {
    pub category: &'static str,
    pub name: String,
    pub scene: Scene,
}

fn hard_scenes() -> Vec<HardScene> {
    [cells(), transfer_functions(), cameras()].into_iter().flatten().collect()
}

const FIELDS: [&str; 2] = ["a", "b"];
const RED: [f64; 3] = [0.9, 0.3, 0.2];
const BLUE: [f64; 3] = [0.2, 0.5, 1.1];
const CENTRE: DVec3 = DVec3::splat(0.5);

/// The scene of a grid of the unit cube with its points moved, seen from outside, with two Gaussians in closed form and without light,
/// as far as `change` leaves it. Fields stay with the points: all are smooth, of order 1, with gradients of order 1.
fn hard(
    category: &'static str,
    name: impl Into<String>,
    base: &Grid,
    place: impl Fn(DVec3) -> DVec3,
    change: impl FnOnce(&mut Scene),
) -> HardScene {
    let field = |value: fn(DVec3) -> f64| SharedSlice::from(sample(base, value));
    let mut grid = Grid { points: SharedSlice::from(sample(base, place)), ..base.clone() };
    let further: [fn(DVec3) -> f64; 2] = [|p| (3.0 * p.x - p.z).sin(), |p| (2.0 * p.y + 2.0 * p.z).cos()];
    for (name, value) in FIELDS.iter().zip(further) {
        let array = Array { component_count: 1, values: field(value) };
        grid.point_arrays.insert(name.to_string(), Arc::new(array));
    }
    let gradient = |p: DVec3| {
        let (wave, other) = ((4.0 * p.x + p.y).cos(), (3.0 * p.z - 2.0 * p.y).sin());
        DVec3::new(wave, 0.25 * wave + 0.5 * other, -0.75 * other)
    };
    let volume = Volume {
        grid: Arc::new(grid),
        scalar: field(|p| 0.5 + 0.25 * (4.0 * p.x + p.y).sin() + 0.25 * (3.0 * p.z - 2.0 * p.y).cos()),
        gradient: Some(SharedSlice::from(sample(base, gradient))),
        gradient_magnitude: Some(field(|p| 0.4 + p.x + 0.5 * p.y * p.z)),
    };
    let mut scene = Scene::new(
        Arc::new(volume),
        Arc::new(two_gaussians()),
        outside(),
        Shading {
            integrator: Integrator::ANALYTIC,
            overlap: WidgetBlend::Exact,
            silhouette: None,
            light: None,
        },
        VisibilityOrder::Exact,
    );
    change(&mut scene);
    HardScene { category, name: name.into(), scene }
}

/// Two Gaussians, one of them tilted and one cut by a region, that overlap.
fn two_gaussians() -> TransferFunction {
    let gaussian = |centre, matrix, extinction, color, region| Widget {
        profile: Profile::Gaussian { centre, matrix },
        color,
        extinction,
        region,
    };
    let rectangle = Region { corners: vec![[0.35, 0.2], [0.75, 0.2], [0.75, 1.4], [0.35, 1.4]] };
    density(vec![
        gaussian([0.55, 0.9], [[4.0, 1.5], [-1.0, 1.6]], 3.0, BLUE, None),
        gaussian([0.5, 0.7], [[4.7, 0.0], [0.0, 1.2]], 5.0, RED, Some(rectangle)),
    ])
}

fn density(widgets: Vec<Widget>) -> TransferFunction {
    TransferFunction {
        model: OpticalModel::DensityEmitter,
        unit_distance: 1.0,
        widgets,
        axes: Default::default(),
    }
}

fn cube(counts: [usize; 3], jitter: f64) -> Grid {
    box_of_tetrahedra(counts, [DVec3::ZERO, DVec3::ONE], jitter)
}

fn outside() -> Camera {
    Camera {
        eye: DVec3::new(-0.9, -1.1, 1.4),
        target: CENTRE,
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 45.0 },
        near: 0.0,
        size: [24, 24],
        samples: 1,
    }
}

/// Degenerate cells, cells at extreme coordinates, thousands along a ray.
fn cells() -> Vec<HardScene> {
    const DEGENERATE: &str = "degenerate cells";
    let unchanged = |_: &mut Scene| {};
    let mut scenes = Vec::new();
    let regular = cube([3, 3, 3], 0.0);
    for thickness in [1e-3, 1e-6, 1e-9, 1e-12, 0.0] {
        let place = |p: DVec3| {
            let x = [0.0, 0.5, 0.5 + thickness, 1.0][(p.x * 3.0).round() as usize];
            DVec3::new(x, p.y, p.z)
        };
        scenes.push(hard(
            DEGENERATE,
            format!("a layer of thickness {thickness:e}"),
            &regular,
            place,
            unchanged,
        ));
    }
    // Squeezed together across one axis but for a layer at each end, by a Gaussian over two further fields.
    for thin in [1e-2, 1e-4, 1e-6] {
        let place = |p: DVec3| {
            DVec3::new(p.x, p.y, 0.5 + (p.z - 0.5) * if p.z.min(1.0 - p.z) < 0.2 { 1.0 } else { thin })
        };
        let profile = Profile::GaussianNd {
            fields: FIELDS.map(String::from).into(),
            centre: vec![0.2, 0.9],
            matrix: vec![vec![3.0, 0.7], vec![-0.4, 2.5]],
        };
        let widget = Widget { profile, extinction: 6.0, color: [0.9, 0.6, 0.1], region: None };
        let name = format!("slivers of {thin:e} by two fields");
        scenes.push(hard(DEGENERATE, name, &cube([4, 4, 4], 0.1), place, |scene| {
            scene.transfer_function = Arc::new(density(vec![widget]));
        }));
    }
    // Points 0 to 3 lie on an edge, 0, 21, 42, 63 on the diagonal, 0, 1, 4, 5 in a face.
    let without_volume: [(&str, &[[u32; 4]]); 3] = [
        ("cells in a plane", &[[0, 1, 4, 5], [0, 3, 12, 15]]),
        ("cells on a line", &[[0, 1, 2, 3], [0, 21, 42, 63]]),
        ("cells with equal points", &[[5, 5, 9, 11], [7, 7, 7, 7], [3, 3, 3, 30]]),
    ];
    for (name, further) in without_volume {
        let tetrahedra = [&regular.tetrahedra[..], further].concat().into();
        let grid = Grid { tetrahedra, ..regular.clone() };
        scenes.push(hard(DEGENERATE, name, &grid, |p| p, unchanged));
    }
    let irregular = cube([4, 4, 4], 0.2);
    for (scale, offset) in [
        (1e-30, DVec3::ZERO),
        (1e-20, DVec3::ZERO),
        (1e20, DVec3::ZERO),
        (1e30, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
        (1e-3, DVec3::new(1e3, 1e3, -1e3)),
        (1e20, DVec3::new(1e26, 0.0, -1e26)),
    ] {
        let place = |p: DVec3| offset + scale * p;
        let name = format!("lengths of {scale:.0e} at {:.1e} from the origin", offset.length());
        scenes.push(hard("extreme coordinates", name, &irregular, place, |scene| {
            let view = outside();
            scene.camera = Camera { eye: place(view.eye), target: place(view.target), ..view };
            scene.transfer_function = Arc::new(TransferFunction { unit_distance: scale, ..two_gaussians() });
        }));
    }
    let narrow = |p: DVec3| DVec3::new(p.x, 0.5 + 1e-5 * (p.y - 0.5), p.z);
    scenes.push(hard(DEGENERATE, "needles of 1 : 100,000", &cube([3, 3, 3], 0.2), narrow, |scene| {
        scene.camera.eye = DVec3::new(0.503, -2.0, 0.507);
        scene.camera.target = DVec3::new(0.503, 0.0, 0.507);
        scene.camera.projection = Projection::Orthographic { height: 0.9 };
        // So that 1e-5 of length is seen.
        scene.transfer_function = Arc::new(TransferFunction { unit_distance: 1e-5, ..two_gaussians() });
    }));
    let long = |p: DVec3| DVec3::new(p.x, 3.0 * p.y, p.z);
    let (chain, name) = ("long compositing chains", "over 1,200 cells along a ray");
    scenes.push(hard(chain, name, &cube([1, 600, 1], 0.0), long, |scene| {
        let (eye, target) = (DVec3::new(0.45, -3.0, 0.55), DVec3::new(0.5, 0.0, 0.5));
        let projection = Projection::Perspective { fov_y: 18.0 };
        scene.camera = Camera { eye, target, projection, size: [8, 8], ..outside() };
    }));
    scenes
}

/// Thin and stiff, narrow, stepped, banded, tabulated and lit transfer functions on a cube of irregular cells.
fn transfer_functions() -> Vec<HardScene> {
    let base = cube([4, 4, 4], 0.2);
    let drawn_by = |category, name: String, function: TransferFunction| {
        hard(category, name, &base, |p| p, |scene| scene.transfer_function = Arc::new(function))
    };
    let mut scenes = Vec::new();
    for factor in [1e-12, 1e3, 1e6, 1e9, 1e12] {
        let mut stiff = two_gaussians();
        stiff.widgets.iter_mut().for_each(|widget| widget.extinction *= factor);
        scenes.push(drawn_by("optical depths", format!("extinction times {factor:e}"), stiff));
    }
    let widget = |profile, extinction, color| Widget { profile, color, extinction, region: None };
    let gaussian = |centre: f64, width: f64, extinction, color| {
        let matrix = [[1.0 / width, 0.0], [0.0, 0.0]];
        widget(Profile::Gaussian { centre: [centre, 0.0], matrix }, extinction, color)
    };
    for width in [1e-3, 1e-6] {
        let triangular = Profile::TriangularGaussian { centre: 0.45, sigma: width };
        let function = density(vec![
            gaussian(0.55, width, 1.0 / width, BLUE),
            widget(triangular, 1.0 / width, RED),
            gaussian(0.5, 0.2, 1.0, RED),
        ]);
        scenes.push(drawn_by("narrow widgets", format!("widths of {width:e}"), function));
    }
    // From nothing to a dense rest, with a thin part before.
    for (width, dense) in [(1e-3, 1e3), (1e-6, 1e6)] {
        let point = |s, extinction, color| ControlPoint { s, color, extinction };
        let thin = [point(0.1, 0.0, BLUE), point(0.3, 1.0, BLUE), point(0.5, 0.0, BLUE)];
        let points = thin.into_iter().chain([point(0.5 + width, dense, RED)]).collect();
        let function = density(vec![widget(Profile::PiecewiseLinear { points }, 0.0, [0.0; 3])]);
        scenes.push(drawn_by("steps", format!("to {dense:e} over {width:e}"), function));
    }
    let wave = |period, profile: fn(Wave) -> Profile, color| {
        let wave = Wave { origin: [0.1, 0.0], angle: 0.4, scale: [1.0, 0.3], period, band_width: 0.4 };
        let region = Some(Region::rectangle([0.2, 0.8], [0.3, 1.6]));
        Widget { region, ..widget(profile(wave), 4.0, color) }
    };
    for period in [1e-2, 1e-3] {
        let waves =
            vec![wave(period, Profile::SineWave, BLUE), wave(3.0 * period, Profile::TriangleWave, RED)];
        scenes.push(drawn_by("many bands", format!("a period of {period:e}"), density(waves)));
    }
    for cutoff in [1.0 / 255.0, 1e-6] {
        let model = OpticalModel::ConstantEmitter { cutoff };
        let function = TransferFunction { model, ..two_gaussians() };
        scenes.push(drawn_by("constant emitter", format!("a cutoff of {cutoff:.1e}"), function));
    }
    let texels = (0..15u8).map(|k| {
        let x = f32::from(k) / 14.0;
        [x, 0.5, 1.0 - x, f32::from(k * 7 % 5) / 4.0]
    });
    let table = Table { width: 5, height: 3, texels: texels.collect(), s: [0.1, 0.9], g: [0.3, 1.8] };
    let image = widget(Profile::Table(Arc::new(table)), 4.0, [0.0; 3]);
    scenes.push(drawn_by("tables", "an image of 5 × 3 texels".into(), density(vec![image])));
    let light = Some(Light { direction: DVec3::new(0.3, -0.7, 0.9), ambient: 0.2, diffuse: 0.8 });
    for (name, silhouette, light) in [
        ("diffuse light", None, light),
        ("silhouettes of exponent 0.5", Some(0.5), None),
        ("silhouettes of exponent 8, lit", Some(8.0), light),
    ] {
        scenes.push(hard(
            "light and silhouettes",
            name,
            &base,
            |p| p,
            |scene| {
                scene.shading = Shading { silhouette, light, ..scene.shading };
            },
        ));
    }
    scenes
}

/// The eye inside or far away, angles from the widest to the narrowest, rays along edges and faces: before a cube of irregular cells or, for
/// rays along edges, of regular ones.
fn cameras() -> Vec<HardScene> {
    let (irregular, regular) = (cube([4, 4, 4], 0.2), cube([4, 4, 4], 0.0));
    let perspective = |eye: DVec3, fov_y: f64| Camera {
        eye,
        target: CENTRE + DVec3::new(0.01, 0.02, 0.03),
        projection: Projection::Perspective { fov_y },
        ..outside()
    };
    let straight = |eye: DVec3, height: f64| Camera {
        eye,
        projection: Projection::Orthographic { height },
        ..outside()
    };
    let side = DVec3::new(-1.0, -1.3, 0.8);
    let seen = |name: &str, camera, base| hard("cameras", name, base, |p| p, |scene| scene.camera = camera);
    let near = Camera { near: 1.2, ..perspective(CENTRE + side, 45.0) };
    vec![
        seen("an eye inside the grid", perspective(CENTRE, 60.0), &irregular),
        seen("an eye inside, 170 degrees", perspective(CENTRE, 170.0), &irregular),
        seen("an eye inside, 179.9 degrees", perspective(CENTRE, 179.9), &irregular),
        seen("an eye at a corner of cells", perspective(DVec3::splat(0.25), 90.0), &regular),
        seen("an eye in a face of cells", perspective(DVec3::new(0.25, 0.3, 0.4), 90.0), &regular),
        seen("a near plane in the grid", near, &irregular),
        seen("0.1 degrees", perspective(CENTRE + 400.0 * side, 0.1), &irregular),
        seen("0.01 degrees", perspective(CENTRE + 4e3 * side, 0.01), &irregular),
        seen("a pixel of 1e-6", straight(CENTRE + side, 24e-6), &irregular),
        // 24 pixels over 1.5 of a grid of 4 cells: every fourth ray through edges, and through the grid's own sides.
        seen("rays along edges and faces", straight(CENTRE - 2.0 * DVec3::Y, 1.5), &regular),
        seen("the grid edge on, in perspective", perspective(DVec3::new(0.5, -1.0, 0.0), 40.0), &regular),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::progress::NoProgress;
    use voltet_nodes::drawing::ENGINES;

    /// Each of the pictures on the software driver, within the bound of the native engine's; skipped without one, loudly.
    #[test]
    fn hard_scenes_keep_their_bound_on_every_engine() {
        let Some(declared) =
            ENGINES.iter().find(|engine| engine.on_device && engine.unavailable_reason.is_none())
        else {
            return;
        };
        let found = match subjects(Some("software")) {
            Ok(found) => found,
            Err(why) => {
                voltet_testing::skipped_without_device(why);
                return;
            }
        };
        let on_device = found.renderers.iter().find(|renderer| renderer.declared == declared);
        let device = on_device.expect("the device paints").engine.label();
        let all = pictures(&found.renderers, &NoProgress).expect("drawn");
        let on_device: Vec<&HardPicture> = all.iter().filter(|drawn| drawn.engine == device).collect();
        assert_eq!(
            (on_device.len(), all.len()),
            (hard_scenes().len(), hard_scenes().len() * found.renderers.len())
        );
        // What 32 bits do not hold; `auto` leaves it to the native engine, which refuses nothing.
        let refused: Vec<&str> =
            all.iter().filter(|drawn| drawn.refused.is_some()).map(|drawn| drawn.scene.as_str()).collect();
        let beyond = [
            "extinction times 1e9",
            "extinction times 1e12",
            "widths of 1e-6",
            "to 1e6 over 1e-6",
            "a period of 1e-3",
            "a pixel of 1e-6",
        ];
        assert_eq!(refused, beyond);
        let wrong: Vec<&HardPicture> = all.iter().filter(|drawn| !drawn.passed()).collect();
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}
