//! Overlaps mixed, light and silhouettes, and data far from 0 on the device.

use crate::compare;
use crate::compare::{SHADING, Scene, ordinary, ordinary_shaded, referee, within};
use crate::grids::{cube, smooth_g};
use crate::looks::*;
use crate::widgets::{all, scene};
use glam::DVec3;
use voltet_core::optics::Overlap;
use voltet_core::shading::{Light, Order, Shading};

#[test]
fn all_mixed() {
    let mix = Shading { overlap: Overlap::Mix, ..SHADING };
    // The mix leaves out the order of widgets within a segment, and the referee does not: 1e-2 here.
    let scene = scene("all mixed".into(), all());
    let Some(drawn) = compare::draw(&scene, &mix, Order::Exact) else { return };
    within("all mixed", &drawn.picture, &referee(&scene, &SHADING), 2e-2);
}

const LIGHT: Light = Light { direction: DVec3::new(0.4, -0.7, 3.5), ambient: 0.3, diffuse: 0.8 };

#[test]
fn light_and_silhouettes() {
    let even = Light { diffuse: 0.0, ..LIGHT };
    let shadings = [
        ("light", Shading { light: Some(LIGHT), ..SHADING }),
        ("silhouette 1", Shading { silhouette: Some(1.0), ..SHADING }),
        ("silhouette 0.5", Shading { silhouette: Some(0.5), light: Some(even), ..SHADING }),
        ("silhouette 3.7 and light", Shading { silhouette: Some(3.7), light: Some(LIGHT), ..SHADING }),
        ("silhouette 0", Shading { silhouette: Some(0.0), ..SHADING }),
    ];
    let cameras = [
        ("outside", outside([40, 32])),
        ("ortho", orthographic([3.0, -2.0, 2.5], [0.5, 0.5, 0.5], 1.9, [32, 32])),
        ("inside", perspective([0.43, 0.37, 0.52], [0.9, 0.8, 0.45], 90.0, [32, 32])),
    ];
    for (kind, shading) in shadings {
        for (view, camera) in cameras {
            for (name, look) in [("overlap", overlapping()), ("one colour", one_gaussian())] {
                let scene = Scene { camera, ..scene(format!("{kind} {view} {name}"), look) };
                ordinary_shaded(&scene, &shading);
            }
        }
    }
}

/// Values near 1e8 that vary by 1e-2: their 64-bit digits are enough, 32-bit ones are not.
#[test]
fn large_values_that_hardly_vary() {
    let (base, span) = (1e8, 1e-2);
    let volume = crate::grids::volume(
        cube([5, 5, 5], 0.2),
        |p| base + span * crate::grids::smooth_s(p),
        |p| span * smooth_g(p),
    );
    let centre = [base + 0.6 * span, 0.8 * span];
    let widgets = [
        ("gaussian", gaussian(centre, [0.1 * span, 0.5 * span], 4.0, [1.0, 0.5, 0.2])),
        ("ramp", points(&[[base, 0.1, 0.2, 0.9, 0.0], [base + 0.5 * span, 0.9, 0.7, 0.1, 2.0]])),
    ];
    for (name, widget) in widgets {
        let (volume, look) = (volume.clone(), look(vec![widget]));
        let name = format!("offset values {name}");
        ordinary(&Scene { name, volume, look, camera: outside([40, 40]) });
    }
}
