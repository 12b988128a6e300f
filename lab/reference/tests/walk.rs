//! Rays cell by cell.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::{box_of_tetrahedra, sample};
use voltet_core::progress::NoProgress;
use voltet_core::transfer::TransferFunction;
use voltet_core::transfer::{OpticalModel, Profile, Region, Widget};
use voltet_core::volume::Volume;
use voltet_optics::WidgetBlend;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Light, Shading, VisibilityOrder};
use voltet_optics::trace::CellCrossing;
use voltet_reference::{REFERENCE, draw, tracer, widget_depths};

const PLAIN: Shading =
    Shading { integrator: REFERENCE, overlap: WidgetBlend::Exact, silhouette: None, light: None };

fn uniform(s: [f64; 2], color: [f64; 3], extinction: f64) -> Widget {
    let region = Some(Region::rectangle(s, [f64::NEG_INFINITY, f64::INFINITY]));
    Widget { profile: Profile::Uniform, color, extinction, region }
}

fn look(model: OpticalModel, widgets: Vec<Widget>) -> Arc<TransferFunction> {
    Arc::new(TransferFunction { model, unit_distance: 1.0, widgets, axes: Default::default() })
}

/// Two cells that share the face z = 1, with apexes at z = 0 and 3, and s = z. At height z the one is the triangle x, y ≥ −1,
/// x + y ≤ 1 scaled by z, the other that scaled by (3 − z)/2: the ray at (¼, 0) is inside from ¼ to 1 and on to 2½.
fn two_cells() -> Scene {
    let corners = [[0.0, 0.0, 0.0], [-1.0, -1.0, 1.0], [2.0, -1.0, 1.0], [-1.0, 2.0, 1.0], [0.0, 0.0, 3.0]];
    let points: Vec<DVec3> = corners.map(DVec3::from).to_vec();
    let scalar = points.iter().map(|p| p.z).collect();
    let tetrahedra = vec![[1, 2, 3, 4], [0, 1, 2, 3]];
    let grid = Grid { points: SharedSlice::from(points), tetrahedra: tetrahedra.into(), ..Grid::default() };
    let infinity = f64::INFINITY;
    let (red, green) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
    Scene::new(
        Arc::new(Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None }),
        look(
            OpticalModel::DensityEmitter,
            vec![uniform([-infinity, 1.0], red, 2.0), uniform([0.5, infinity], green, 1.0)],
        ),
        Camera {
            eye: DVec3::new(0.25, 0.0, -2.0),
            target: DVec3::new(0.25, 0.0, 0.0),
            up: DVec3::Y,
            projection: Projection::Orthographic { height: 1.0 },
            near: 0.0,
            size: [1, 1],
            samples: 1,
        },
        PLAIN,
        VisibilityOrder::Exact,
    )
}

#[test]
fn a_ray_through_two_cells_is_as_by_hand() {
    let scene = two_cells();
    let tracer = tracer(&scene).unwrap();
    let ray = tracer.rays([0, 0])[0];
    let walk = tracer.walk(&ray).unwrap();
    let near = |found: f64, exact: f64| assert!((found - exact).abs() < 1e-12, "{found}, not {exact}");
    let [first, second] = walk.steps.as_slice() else { panic!("{walk:?}") };
    assert_eq!((first.cell, second.cell, walk.hidden), (1, 0, 0));
    let alone = widget_depths(&scene.transfer_function, &walk.steps).unwrap();
    for ((step, distance, s, depths), alone) in
        [(first, [2.25, 3.0], [0.25, 1.0], [1.5, 0.5]), (second, [3.0, 4.5], [1.0, 2.5], [0.0, 1.5])]
            .into_iter()
            .zip(&alone)
    {
        (0..2).for_each(|k| near(step.distance[k], distance[k]));
        near(step.length, distance[1] - distance[0]);
        near(step.front[0], s[0]);
        near(step.back[0], s[1]);
        (0..2).for_each(|k| near(alone[k], depths[k]));
        near(step.part.optical_depth, depths[0] + depths[1]);
    }
    near(first.transmittance, 1.0);
    near(second.transmittance, (-2.0f64).exp());
    // Red alone over a depth of ½, then two parts red and one green over 1½; behind a depth of 2 green over 1½.
    let through = |depth: f64| 1.0 - (-depth).exp();
    let mixed = (-0.5f64).exp() * through(1.5);
    let [r, g, _, a] = first.contribution();
    near(r, through(0.5) + mixed * 2.0 / 3.0);
    near(g, mixed / 3.0);
    near(a, through(2.0));
    let [r, g, _, a] = second.contribution();
    near(r, 0.0);
    near(g, (-2.0f64).exp() * through(1.5));
    near(a, g);
}

/// The unit cube with s = x² + y z and its gradient, seen from outside and from inside.
fn scenes() -> Vec<(&'static str, Scene)> {
    let grid = box_of_tetrahedra([4, 3, 5], [DVec3::ZERO, DVec3::ONE], 0.0);
    let gradient: Vec<DVec3> = grid.points.iter().map(|p| DVec3::new(2.0 * p.x, p.z, p.y)).collect();
    let volume = Arc::new(Volume {
        scalar: SharedSlice::from(sample(&grid, |p| p.x * p.x + p.y * p.z)),
        gradient_magnitude: Some(SharedSlice::from(gradient.iter().map(|v| v.length()).collect::<Vec<_>>())),
        gradient: Some(SharedSlice::from(gradient)),
        grid: Arc::new(grid),
    });
    let gaussian = |centre: [f64; 2], color| Widget {
        profile: Profile::Gaussian { centre, matrix: [[4.0, 0.0], [0.0, 3.0]] },
        color,
        extinction: 3.0,
        region: None,
    };
    let widgets = vec![gaussian([0.3, 0.8], [1.0, 0.4, 0.1]), gaussian([0.9, 1.6], [0.1, 0.3, 1.0])];
    let camera = |eye: [f64; 3], near: f64, samples: u32| Camera {
        eye: eye.into(),
        target: DVec3::new(0.5, 0.45, 0.55),
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 25.0 },
        near,
        size: [9, 7],
        samples,
    };
    let light = Light { direction: DVec3::new(1.0, -2.0, 0.5), ambient: 0.2, diffuse: 0.9 };
    let drawn = Shading { silhouette: Some(1.5), light: Some(light), ..PLAIN };
    let constant = OpticalModel::ConstantEmitter { cutoff: 0.1 };
    let (density, outside) = (OpticalModel::DensityEmitter, camera([2.0, -2.5, 1.0], 0.0, 1));
    [
        ("outside", density, outside, PLAIN),
        ("the eye inside", density, camera([0.3, 0.4, 0.35], 0.0, 1), PLAIN),
        ("cut by the near plane, four rays", density, camera([2.0, -2.5, 1.0], 3.2, 4), PLAIN),
        ("silhouettes and light", density, outside, drawn),
        ("constant-emitter", constant, outside, drawn),
        ("mixed", density, outside, Shading { overlap: WidgetBlend::Mix, ..PLAIN }),
    ]
    .into_iter()
    .map(|(name, model, camera, shading)| {
        let (volume, transfer_function) = (volume.clone(), look(model, widgets.clone()));
        (name, Scene::new(volume, transfer_function, camera, shading, VisibilityOrder::Exact))
    })
    .collect()
}

/// Also between two tiles and at the picture's border.
#[test]
fn a_ray_meets_the_same_cells_in_the_list_of_its_tile_as_among_all() {
    for (name, mut scene) in scenes() {
        scene.camera.size = [60, 44];
        let tracer = tracer(&scene).unwrap();
        let lists = tracer.tile_lists(0..scene.volume.grid.tetrahedra.len() as u32);
        let mut met = 0;
        for i in [0.0, 3.7, 15.999, 16.0, 31.5, 48.0, 59.9, 60.0] {
            for j in [0.0, 9.3, 16.0, 22.0, 32.0, 44.0] {
                let walk = tracer.walk(&tracer.ray(i, j)).unwrap();
                assert_eq!(walk, tracer.walk_near([i, j], &lists).unwrap(), "{name} {i} {j}");
                met += walk.steps.len();
            }
        }
        assert!(met > 50, "{name}: {met}");
    }
}

/// Nothing but rounding of sums lies between the two.
#[test]
fn what_the_cells_add_is_the_pixel() {
    for (name, scene) in scenes() {
        let picture = draw(&scene, &NoProgress).unwrap();
        let tracer = tracer(&scene).unwrap();
        let mut lit = 0;
        for place in 0..9 * 7 {
            let [i, j] = [place % 9, place / 9];
            let rays = tracer.rays([i, j]);
            let mut pixel = [0.0; 4];
            for ray in &rays {
                let walk = tracer.walk(ray).unwrap();
                let sum = walk.steps.iter().fold([0.0; 4], |sum: [f64; 4], step| {
                    let adds = step.contribution();
                    std::array::from_fn(|c| sum[c] + adds[c])
                });
                let seen = tracer.trace(ray).unwrap();
                let [r, g, b] = seen.color;
                for (c, exact) in [r, g, b, seen.opacity].into_iter().enumerate() {
                    assert!((sum[c] - exact).abs() <= 1e-12, "{name} {i} {j}: {sum:?} {seen:?}");
                    pixel[c] += sum[c] / rays.len() as f64;
                }
                let depths = widget_depths(&scene.transfer_function, &walk.steps).unwrap();
                let depth: f64 = depths.iter().flatten().sum();
                let whole: f64 = walk.steps.iter().map(|step| step.part.optical_depth).sum();
                assert!((depth - whole).abs() <= 1e-12 * whole.max(1.0), "{name}: {depth} {whole}");
                let gap = |pair: &[CellCrossing]| (pair[0].distance[1] - pair[1].distance[0]).abs();
                assert!(walk.steps.windows(2).all(|pair| gap(pair) < 1e-12), "{name}: neighbours meet");
                lit += u32::from(seen.opacity > 0.1);
            }
            // The picture has 32 bits.
            let drawn = picture.pixel(i as usize, j as usize);
            (0..4).for_each(|c| assert!((f64::from(drawn[c]) - pixel[c]).abs() < 1e-7, "{name} {i} {j}"));
        }
        assert!(lit > 9, "{name}: {lit} rays see something");
    }
}

#[test]
fn rays_begin_where_the_camera_is_and_know_what_the_near_plane_took() {
    let mut scene = two_cells();
    let whole = tracer(&scene).unwrap();
    assert_eq!(whole.world(&whole.rays([0, 0])[0]), [[0.25, 0.0, -2.0], [0.0, 0.0, 1.0]]);
    assert_eq!(whole.cut_away(&whole.rays([0, 0])[0]), 0);
    scene.camera.near = 3.5;
    let near = tracer(&scene).unwrap();
    assert_eq!(near.cut_away(&near.rays([0, 0])[0]), 1, "the other is cut, and still there");
    scene.camera.near = 9.0;
    let far = tracer(&scene).unwrap();
    assert_eq!(far.cut_away(&far.rays([0, 0])[0]), 2);
}
