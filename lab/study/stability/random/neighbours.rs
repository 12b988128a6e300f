//! Tolerance of a picture: by how much the referee's own picture changes where something moves that nobody
//! can see, or that the data's rounding moves.

use super::super::pictures::errors;
use super::cameras;
use glam::DVec3;
use std::sync::Arc;
use voltet_core::SharedSlice;
use voltet_core::grid::Grid;
use voltet_core::grid::extent::range;
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::volume::Volume;
use voltet_optics::scene::Scene;
use voltet_reference as reference;

/// Move of the camera (pixels).
const NUDGE: f64 = 1e-3;
/// The raster that hardware moves the corners of triangles to, pixels.
const RASTER: f64 = 1.0 / 256.0;
/// Change by rounding to 32 bits in a number from a half to one.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// By how much each pixel changes at most when the camera moves by a thousandth of a pixel, or the data are rounded.
pub(super) fn changes(scene: &Scene, exact: &Picture, progress: &dyn Progress) -> Vec<f64> {
    largest(&neighbours_of(scene), exact, progress)
}

/// By how much each pixel may change when the corners of every cell's triangles move by a step of the raster, each cell for
/// itself: its thick vertex is no point that it shares with others, so what one loses no other gains. The sum, over the cells,
/// of what each changes when it is drawn alone and moves. As it hides and is hidden by others at most wholly, the picture
/// changes by no more.
pub(super) fn changes_of_triangles(scene: &Scene, progress: &dyn Progress) -> Vec<f64> {
    let size = scene.camera.size.map(|n| n as usize);
    let mut sum = vec![0.0; size[0] * size[1]];
    for &cell in scene.volume.grid.tetrahedra.iter() {
        let grid = Grid { tetrahedra: vec![cell].into(), ..(*scene.volume.grid).clone() };
        let volume = Arc::new(Volume { grid: Arc::new(grid), ..(*scene.volume).clone() });
        let alone = Scene { volume, ..scene.clone() };
        if let Ok(exact) = reference::draw(&alone, &CancelOnly(progress)) {
            let most = largest(&nudged(&alone, RASTER), &exact, progress);
            sum.iter_mut().zip(most).for_each(|(sum, change)| *sum += change);
        }
    }
    sum
}

/// By how much each pixel changes at most from scene to scene.
fn largest(scenes: &[Scene], exact: &Picture, progress: &dyn Progress) -> Vec<f64> {
    let mut most = vec![0.0_f64; exact.rgba.len()];
    for neighbour in scenes {
        if let Ok(picture) = reference::draw(neighbour, &CancelOnly(progress)) {
            most.iter_mut().zip(errors(&picture, exact)).for_each(|(most, change)| *most = most.max(change));
        }
    }
    most
}
/// The scene with the camera moved by so many pixels.
fn nudged(scene: &Scene, by: f64) -> Vec<Scene> {
    let steps = [[by, 0.0], [-by, 0.0], [0.0, by], [0.0, -by], [by, by], [-by, -by]];
    let cameras = steps.iter().filter_map(|&step| cameras::nudged(&scene.camera, step));
    cameras.map(|camera| Scene { camera, ..scene.clone() }).collect()
}

/// The scene as it may be for what nobody can see, and for the data's rounding.
fn neighbours_of(scene: &Scene) -> Vec<Scene> {
    let mut all = nudged(scene, NUDGE);
    let Volume { grid, scalar, gradient, gradient_magnitude } = (*scene.volume).clone();
    let with_values = |change: fn(f64) -> f64| Volume {
        scalar: SharedSlice::from(about_the_least(&scalar, change)),
        gradient_magnitude: gradient_magnitude.as_ref().map(|g| about_the_least(g, change).into()),
        grid: grid.clone(),
        gradient: gradient.clone(),
    };
    let changes: [fn(f64) -> f64; 3] = [rounded, |x| x + HALF_STEP, |x| x - HALF_STEP];
    let mut volumes: Vec<Volume> = changes.into_iter().map(with_values).collect();
    let axes = [0, 1, 2].map(|axis| grid.points.iter().map(|p| p[axis]).collect::<Vec<_>>());
    let [x, y, z] = axes.map(|values| about_the_least(&values, rounded));
    let points = x.into_iter().zip(y).zip(z).map(|((x, y), z)| DVec3::new(x, y, z)).collect();
    let moved = Grid { points, ..(*grid).clone() };
    volumes.push(Volume { grid: Arc::new(moved), scalar, gradient, gradient_magnitude });
    all.extend(volumes.into_iter().map(|volume| Scene { volume: Arc::new(volume), ..scene.clone() }));
    all
}

fn rounded(x: f64) -> f64 {
    f64::from(x as f32)
}

/// Values with a change of their fraction of the range: an offset costs no digits.
fn about_the_least(values: &[f64], change: fn(f64) -> f64) -> Vec<f64> {
    let [low, high] = range(values).unwrap_or_default();
    let width = high - low;
    let changed = |&x: &f64| if width > 0.0 { low + width * change((x - low) / width) } else { x };
    values.iter().map(changed).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An offset takes no digits of what is explained by rounding.
    #[test]
    fn values_are_rounded_within_their_range() {
        let far = about_the_least(&[1e8, 1e8 + 0.25, 1e8 + 1.0], rounded);
        assert_eq!(far, [1e8, 1e8 + 0.25, 1e8 + 1.0]);
        assert_eq!(about_the_least(&[2.0; 3], |x| x + 0.5), [2.0; 3]);
        assert_eq!(about_the_least(&[-1.0, 1.0], |x| x + 0.25), [-0.5, 1.5]);
    }
}
