//! The first view of a data set: all of it, from where its shape is seen best.

use crate::core::arithmetic::decimal;
use crate::core::camera::{Camera, Projection};
use crate::core::clip::ClipShape;
use crate::core::grid::extent::{bounds, corners};
use glam::{DMat3, DVec3};

/// Vertical angle of view, degrees.
const FOV_Y: f64 = 30.0;

/// Width and height of the picture, pixels.
const PICTURE: [u32; 2] = [1024, 768];

/// Direction to the eye: from the front, the side and above.
const OBLIQUE: DVec3 = DVec3::new(-0.8, -1.4, 0.9);

/// Share of the picture under which other directions are tried.
const FILLED: f64 = 0.3;

/// Share of the upright box's volume under which a box that leans holds the points better.
const MUCH_SMALLER: f64 = 0.5;

/// Steps to a principal component; a box needs no exact one.
const STEPS: usize = 8;

/// Shares of the components of the oblique direction in those that are tried.
const TILTS: [f64; 5] = [0.01, 0.05, 0.2, 0.5, 1.0];

/// A camera, and what its rays meet.
pub(super) struct FirstView {
    camera: Camera,
    /// Mean length of rays through the box of what is seen.
    pub chord: f64,
    /// Share of the picture that the box fills.
    filled: f64,
    /// True if it is along the axes of a box that leans.
    pub leans: bool,
    /// Distance of the nearest point along the view.
    nearest: f64,
}

/// A view of all points: along the axes, or along those of a box that leans where what it holds would fill too little of the picture.
pub(super) fn view(points: &[DVec3], boxed: bool) -> Option<FirstView> {
    let [low, high] = bounds(points)?;
    let upright = upright_view(points, boxed)?;
    let middle = 0.5 * low + 0.5 * high;
    let Some(axes) = leaning_axes(points, middle, high - low) else {
        return Some(upright);
    };
    let turned: Vec<DVec3> = points.iter().map(|point| axes.transpose() * (*point - middle)).collect();
    let Camera { eye, target, up, .. } = upright.camera;
    let [eye, target] = [eye, target].map(|place| axes.transpose() * (place - middle));
    let camera = Camera { eye, target, up: axes.transpose() * up, ..upright.camera };
    let (chord, filled) = rays(&camera, bounds(&turned)?)?;
    if filled >= FILLED {
        return Some(FirstView { chord, filled, ..upright });
    }
    let leaning = upright_view(&turned, false)?;
    let Camera { eye, target, up, .. } = leaning.camera;
    let [eye, target] = [eye, target].map(|place| middle + axes * place);
    Some(FirstView {
        camera: Camera { eye, target, up: axes * up, ..leaning.camera },
        leans: true,
        ..leaning
    })
}

/// Axes of a box that is much smaller than the upright one, as of a rod along a diagonal: the principal components of the points in the
/// L1 norm, by the fixed point of Kwak (IEEE Trans. Pattern Analysis and Machine Intelligence 30(9), 2008).
fn leaning_axes(points: &[DVec3], middle: DVec3, size: DVec3) -> Option<DMat3> {
    let largest = size.max_element().max(f64::MIN_POSITIVE);
    let places = || points.iter().filter(|point| point.is_finite()).map(|point| (*point - middle) / largest);
    let (sum, count) = places().fold((DVec3::ZERO, 0.0), |(sum, count), place| (sum + place, count + 1.0));
    let principal = |part: &dyn Fn(DVec3) -> DVec3| {
        let parts = || places().map(|place| part(place - sum / count));
        let farthest = parts().max_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let step = |axis: DVec3| parts().map(|part| part * axis.dot(part).signum()).sum::<DVec3>();
        (0..STEPS).try_fold(farthest?.try_normalize()?, |axis, _| step(axis).try_normalize())
    };
    let along = principal(&|place| place)?;
    let across = principal(&|place| place - along * along.dot(place))?;
    let across = (across - along * along.dot(across)).try_normalize()?;
    let above = along.cross(across);
    let side = if above.z < 0.0 { -1.0 } else { 1.0 };
    let axes = DMat3::from_cols(along, side * across, side * above);
    let turned: Vec<DVec3> = places().map(|place| axes.transpose() * place).collect();
    let [low, high] = bounds(&turned)?;
    let content = |sides: DVec3| sides.max(DVec3::splat(1e-9)).element_product();
    (content(high - low) < MUCH_SMALLER * content(size / largest)).then_some(axes)
}

/// A view of all points, mostly along the shortest side of their box; along another where that leaves the picture empty, as of a rod.
/// `boxed`: holds their box, too.
fn upright_view(points: &[DVec3], boxed: bool) -> Option<FirstView> {
    let [low, high] = bounds(points)?;
    let largest = (high - low).max_element().max(f64::MIN_POSITIVE);
    let size = (high - low).max(DVec3::splat(1e-9 * largest));
    let ends = [low, low + size];
    let seen =
        |towards: DVec3, points: &[DVec3]| FirstView::from_direction(towards.normalize(), points, ends);
    let mut best = OBLIQUE * (0.3 + 0.7 * size.min_element() / size);
    let mut filled = seen(best, &corners(ends))?.filled;
    if filled < FILLED {
        let shares = || TILTS.into_iter();
        let tilted = shares()
            .flat_map(|x| shares().flat_map(move |y| shares().map(move |z| OBLIQUE * DVec3::new(x, y, z))));
        for towards in tilted {
            let other = seen(towards, &corners(ends))?.filled;
            (best, filled) = if other > filled { (towards, other) } else { (best, filled) };
        }
    }
    if boxed { seen(best, &corners(ends)) } else { seen(best, points) }
}

impl FirstView {
    /// From where the picture holds all points. `ends`: of their box.
    fn from_direction(towards: DVec3, points: &[DVec3], ends: [DVec3; 2]) -> Option<FirstView> {
        let up = if towards.z.abs() > 0.8 { DVec3::Y } else { DVec3::Z };
        let (target, projection) = (DVec3::ZERO, Projection::Perspective { fov_y: FOV_Y });
        let camera = Camera { eye: towards, target, up, projection, near: 0.0, size: PICTURE, samples: 1 };
        let camera = camera.fitted(points).ok()?;
        let (chord, filled) = rays(&camera, ends)?;
        let forward = camera.frame().ok()?.forward;
        let depths = points.iter().map(|point| (*point - camera.eye).dot(forward));
        let nearest = depths.filter(|depth| depth.is_finite()).fold(f64::INFINITY, f64::min);
        Some(FirstView { camera, chord, filled, nearest, leans: false })
    }

    /// Its keys in a pipeline file.
    pub fn keys(&self) -> String {
        let Camera { eye, target, up, .. } = self.camera;
        // A thousandth of a pixel at what is nearest.
        let step = 1e-6 * self.nearest;
        let vector = |v: DVec3| {
            let [x, y, z] = v.to_array().map(|x| decimal(x, step));
            format!("[{x:?}, {y:?}, {z:?}]")
        };
        let (eye, target, up) = (vector(eye), vector(target), up.to_array());
        format!("eye = {eye}\ntarget = {target}\nup = {up:?}\nfov_y = {FOV_Y:?}\n")
    }
}

/// Mean length of the rays of a picture through a box, and the share of them that meet it.
fn rays(camera: &Camera, [low, high]: [DVec3; 2]) -> Option<(f64, f64)> {
    const RAYS: [usize; 2] = [64, 48];
    let frame = camera.frame().ok()?;
    let seen = ClipShape::Box { low, high };
    let half = PICTURE.map(|side| 0.5 * f64::from(side) * frame.pixel);
    let (mut sum, mut met) = (0.0, 0_u32);
    for ray in 0..RAYS[0] * RAYS[1] {
        let [x, y] = [ray % RAYS[0], ray / RAYS[0]].map(|i| i as f64 + 0.5);
        let x = (2.0 * x / RAYS[0] as f64 - 1.0) * half[0];
        let y = (2.0 * y / RAYS[1] as f64 - 1.0) * half[1];
        let direction = (x * frame.right + y * frame.up + frame.forward).normalize();
        if let Some([enter, leave]) = seen.inside(camera.eye, direction)
            && leave > enter.max(0.0)
        {
            (sum, met) = (sum + (leave - enter.max(0.0)), met + 1);
        }
    }
    Some((sum / f64::from(met.max(1)), f64::from(met) / (RAYS[0] * RAYS[1]) as f64))
}
