//! Scenes that are hard for the device's compositor alone: long lists, more segments than it keeps, surfaces within its limits.

use crate::drawing::{Tested, device, draw, draw_tiles};
use glam::DVec3;
use voltet_gpu::Renderer;
use voltet_integrators::{riemann, segments};
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_testing::pictures::Engine;
use voltet_testing::pictures::compare::{NamedScene, ORDINARY, SHADING, referee, within};
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

/// Hundreds of segments in a pixel, long cells among them: a dispatch that goes on meets cells of every former chunk again.
#[test]
fn deep_pixels_with_long_cells() {
    let base = moved(&cube([2, 780, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for k in 0..240u32 {
        let share = f64::from(k) / 240.0;
        let [x, z] = [0.754_877_67, 0.569_840_29].map(|step| 0.05 + 0.85 * (step * f64::from(k)).fract());
        let y = 2.9 * share;
        points.extend(
            [[x, y, z], [x + 0.05, y, z], [x, y, z + 0.05], [x + 0.02, 3.1, z + 0.02]].map(DVec3::from),
        );
        cells.push([4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
    }
    let s = |p: DVec3| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin();
    let scene = NamedScene {
        name: "deep with long cells".into(),
        volume: volume(together(&[base, grid(points, cells)]), s, |p| p.z),
        look: look(overlapping().widgets.iter().map(|widget| widget.with_extinction_times(0.2)).collect()),
        camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [16, 16]),
    };
    Tested.ordinary(&scene);
}

/// Many cells that begin at one depth and overlap: a pixel gives up what finds no room, and sweeps again.
#[test]
fn sweeps_lose_nothing() {
    let (mut points, mut cells) = (Vec::new(), Vec::new());
    for k in 0..60u32 {
        let back = 0.3 + 0.01 * f64::from(k);
        points.extend([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.2, back, 0.2]].map(DVec3::from));
        cells.push([4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3]);
    }
    let scene = NamedScene {
        name: "overlapping cells".into(),
        volume: volume(grid(points, cells), |p| (40.0 * p.y).sin().abs(), |p| 2.0 * p.x),
        look: overlapping(),
        camera: orthographic([0.3, -2.0, 0.3], [0.3, 0.0, 0.3], 0.8, [24, 24]),
    };
    let Some(drawn) = draw(&scene, &SHADING, VisibilityOrder::Exact) else { return };
    assert!(drawn.sweeps_further > 0);
    Tested.ordinary(&scene);
}

/// Samples are rounds of loops, too, of which a software driver makes 65,535.
#[test]
fn many_samples_on_each_of_many_segments() {
    let base = moved(&cube([2, 60, 2], 0.0), |p| DVec3::new(p.x, 3.0 * p.y, p.z));
    let scene = NamedScene {
        name: "many samples".into(),
        volume: volume(base, |p| 0.5 + 0.4 * (2.0 * p.y + 2.0 * p.x).sin(), |p| p.z),
        look: look(ramp().widgets.iter().map(|widget| widget.with_extinction_times(0.2)).collect()),
        camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 18.0, [12, 12]),
    };
    for integrator in [riemann(256), segments(128, 256)] {
        Tested.ordinary_shaded(&scene, &Shading { integrator, ..SHADING });
    }
    let Some(device) = device().filter(|device| device.is_software) else { return };
    let renderer = Renderer::new(device, &scene.volume).expect("fits");
    let shading = Shading { integrator: riemann(100_000), ..SHADING };
    let refused = draw_tiles(&renderer, &scene, &shading, VisibilityOrder::Exact);
    let error = refused.expect_err("too many").to_string();
    assert!(error.contains("ends loops") && error.contains("fewer samples"), "{error}");
}

/// A driver that ends loops early is noticed, whatever a tile may do in one dispatch: what it left out is drawn again.
#[test]
fn loops_that_a_driver_ends() {
    let s = |p: DVec3| 0.5 + 0.5 * (9.0 * p.y + 2.0 * p.x).sin();
    let scene = NamedScene {
        name: "long lists".into(),
        volume: volume(cube([3, 500, 3], 0.2), s, |_| 0.0),
        look: look(ramp().widgets.iter().map(|widget| widget.with_extinction_times(0.2)).collect()),
        camera: perspective([0.45, -3.0, 0.55], [0.5, 0.0, 0.5], 16.0, [16, 16]),
    };
    let Some(device) = device() else { return };
    let renderer = Renderer::new(device, &scene.volume).expect("fits").with_budget_of(1 << 22);
    let expected = referee(&scene);
    for order in [VisibilityOrder::Exact, VisibilityOrder::Centroid] {
        let drawn = draw_tiles(&renderer, &scene, &SHADING, order).expect("draws");
        println!("{:?}", drawn.counts);
        // The order of centroids is wrong by more than rounding, but hides nothing.
        let bound = if order == VisibilityOrder::Exact { ORDINARY } else { 2e-2 };
        within(&format!("{} {order:?}", scene.name), &drawn.picture, &expected, bound);
    }
}

/// A cell before more tiles than such a driver goes through: the picture is drawn in windows.
#[test]
fn a_cell_before_130_thousand_tiles() {
    let corners = [[-6.0, 0.0, -6.0], [6.0, 0.0, -6.0], [0.0, 0.0, 10.0], [0.0, 3.0, 0.0]];
    let scene = NamedScene {
        name: "one cell".into(),
        volume: volume(grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]]), |_| 0.5, |_| 0.0),
        look: look(vec![everywhere(0.3, [1.0, 0.5, 0.25])]),
        camera: orthographic([0.0, -2.0, 0.0], [0.0, 0.0, 0.0], 2.0, [2880, 2880]),
    };
    let Some(drawn) = draw(&scene, &SHADING, VisibilityOrder::Exact) else { return };
    assert_eq!(drawn.counts.segments, Some(2880 * 2880));
    assert!(drawn.picture.rgba.iter().all(|pixel| 0.4 < pixel[3] && pixel[3] < 0.6));
}

/// A near plane that leaves 2e-5 of a dense cube, from far away: rounding would take a thousandth of that.
#[test]
fn a_near_plane_close_before_the_back() {
    let left = 2e-5;
    let mut camera = perspective([0.45, -1000.0, 0.55], [0.45, 0.0, 0.55], 0.05, [16, 16]);
    camera.near = 1001.0 - left;
    let scene = NamedScene {
        name: "near plane".into(),
        volume: smooth(cube([3, 3, 3], 0.0)),
        look: look(vec![everywhere(1.0 / left, [1.0, 0.5, 0.25])]),
        camera,
    };
    Tested.ordinary(&scene);
    let Some(drawn) = draw(&scene, &SHADING, VisibilityOrder::Exact) else { return };
    let opacity = -(-1.0f32).exp_m1();
    assert!(drawn.picture.rgba.iter().any(|pixel| (pixel[3] - opacity).abs() < 1e-5));
}

#[test]
fn surfaces() {
    for sigma in [1e-3, 1e-4] {
        Tested.stiff(&NamedScene {
            name: format!("narrow {sigma:e}"),
            volume: smooth(cube([5, 5, 5], 0.2)),
            look: look(vec![
                gaussian([0.6, 0.8], [sigma, 2.0], 1e4, [1.0, 0.5, 0.15]),
                gaussian([0.35, 0.8], [sigma, 0.6], 5e3, [0.2, 0.5, 1.0]),
            ]),
            camera: outside([64, 64]),
        });
        Tested.stiff(&NamedScene {
            name: format!("sheet {sigma:e}"),
            volume: smooth(cube([5, 5, 5], 0.2)),
            look: look(vec![gaussian([0.6, 0.8], [sigma, 2.0], 0.5 / sigma, [1.0, 0.5, 0.15])]),
            camera: outside([64, 64]),
        });
    }
}

/// Cells that begin in front of the depth at which their corners are projected, a ten-thousandth of their farthest: what
/// lies there is seen where nothing behind it is. Corners that are near come first, so that faces are found from them.
#[test]
fn cells_that_begin_at_the_eye() {
    let at_the_eye = |name: String, corners: [[f64; 3]; 4], extinction| {
        Tested.ordinary(&NamedScene {
            name: format!("at the eye {name}"),
            volume: volume(grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]]), |_| 0.5, |_| 0.0),
            look: look(vec![everywhere(extinction, [1.0, 0.5, 0.25])]),
            camera: perspective([0.0; 3], [0.0, 1.0, 0.0], 60.0, [40, 40]),
        });
    };
    // Fills the picture at its nearest, half of which is tan 30° = 0.58 wide at depth 1; where it is cut, it spans half.
    let narrowing = [[-3e-5, 1e-5, -3e-5], [3e-5, 1e-5, -3e-5], [0.0, 1e-5, 4e-5], [0.0, 1.0, 0.0]];
    at_the_eye("narrowing".into(), narrowing, 2e4);
    // Leaves the picture to a side just before it is cut.
    let aside = [[3.6e-5, 7.5e-5, -3e-5], [4.2e-5, 7.5e-5, -3e-5], [3.9e-5, 7.5e-5, 3e-5], [3.0, 1.0, 0.0]];
    for turns in 0..4 {
        let turned = |p: [f64; 3]| (0..turns).fold(p, |[x, y, z], _| [-z, y, x]);
        at_the_eye(format!("aside {turns}"), aside.map(turned), 1e6);
    }
}

/// A widget a ten-millionth of the range wide, among cells that vary as little: values keep their digits about the place
/// that they are counted from. Two cells beside the view hold the ends of the range.
#[test]
fn widgets_far_narrower_than_the_range() {
    let beside = |x: f64| {
        let corners = [[x, 0.0, 0.0], [x + 0.1, 0.0, 0.0], [x, 0.1, 0.0], [x, 0.0, 0.1]];
        grid(corners.map(DVec3::from).to_vec(), vec![[0, 1, 2, 3]])
    };
    let whole = together(&[cube([5, 5, 5], 0.2), beside(-3.0), beside(4.0)]);
    let (low, high) = (|p: DVec3| p.x < -2.0, |p: DVec3| p.x > 3.0);
    let of = move |base: f64, p: DVec3, field: f64| {
        if low(p) {
            0.0
        } else if high(p) {
            1.0
        } else {
            base + 1e-6 * field
        }
    };
    let s = move |p| of(0.7, p, smooth_s(p));
    let g = move |p| of(0.3, p, smooth_g(p));
    for (name, widget) in [
        ("line", gaussian([0.7 + 0.6e-6, 0.0], [1e-7, f64::INFINITY], 4.0, [1.0, 0.5, 0.15])),
        ("plane", gaussian([0.7 + 0.6e-6, 0.3 + 0.8e-6], [1e-7, 5e-7], 4.0, [1.0, 0.5, 0.15])),
    ] {
        Tested.ordinary(&NamedScene {
            name: format!("narrow in the range {name}"),
            volume: volume(whole.clone(), s, g),
            look: look(vec![widget]),
            camera: outside([40, 40]),
        });
    }
}
