//! Pictures of triangles that lie side by side in a plane, of parallel rays: each sample of a pixel has the place in the triangle that
//! it falls into.
//!
//! Triangles are filled by edge functions (Pineda 1988, A parallel algorithm for polygon rasterization, SIGGRAPH 22(4)), each of which
//! is found from its ends in one order, so that no sample falls between two triangles that share an edge.

use crate::camera::{Camera, Frame, Projection};
use crate::picture::Picture;
use crate::progress::Progress;
use crate::{Error, Result};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Rows of a chunk of work.
const ROWS: usize = 8;

/// The picture: a pixel is the mean of its samples, with nothing where no triangle is or where it lies before the near plane.
///
/// `color`: premultiplied linear colour and opacity at a place of a triangle, by its number and the weights of its corners.
///
/// # Errors
/// - a perspective camera; those of [`Camera::frame`] and [`Camera::check_picture`]; those of `color`; the run is cancelled.
pub fn flat_picture(
    camera: &Camera,
    points: &[DVec3],
    triangles: &[[u32; 3]],
    color: impl Fn(usize, [f64; 3]) -> [f64; 4] + Sync,
    progress: &dyn Progress,
) -> Result<Picture> {
    let Projection::Orthographic { .. } = camera.projection else {
        return Err(
            Error::usage("rays of a perspective camera are not parallel").expected("height, not fov_y")
        );
    };
    camera.check_picture()?;
    let Frame { right, up, forward, pixel } = camera.frame()?;
    let [width, height] = camera.size.map(|n| n as usize);
    let place = |p: &DVec3| {
        let from_eye = *p - camera.eye;
        let at = DVec2::new(from_eye.dot(right), -from_eye.dot(up)) / pixel;
        at + 0.5 * DVec2::new(width as f64, height as f64)
    };
    let places: Vec<DVec2> = points.par_iter().map(place).collect();
    let depths: Vec<f64> = points.par_iter().map(|p| (*p - camera.eye).dot(forward)).collect();
    let is_in_view = |triangle: usize, weights: [f64; 3]| {
        let corners = triangles[triangle].iter().zip(weights);
        corners.map(|(&p, w)| w * depths[p as usize]).sum::<f64>() >= camera.near
    };
    let corners = |triangle: u32| triangles[triangle as usize].map(|p| places[p as usize]);
    let mut of_chunks: Vec<Vec<u32>> = vec![Vec::new(); height.div_ceil(ROWS)];
    for triangle in 0..triangles.len() as u32 {
        let [low, high] = extent(corners(triangle).map(|corner| corner.y), height);
        (low / ROWS..high.div_ceil(ROWS)).for_each(|chunk| of_chunks[chunk].push(triangle));
    }
    let offsets: Vec<DVec2> = camera.sample_offsets().into_iter().map(|o| DVec2::from(o) + 0.5).collect();
    let mut picture = Picture::transparent(width, height);
    let chunks = picture.rgba.par_chunks_mut(ROWS * width).zip(of_chunks).enumerate();
    chunks.try_for_each(|(chunk, (pixels, own))| {
        progress.check_cancelled()?;
        let mut filled = vec![false; pixels.len() * offsets.len()];
        let mut sums = vec![[0.0; 4]; pixels.len()];
        for triangle in own {
            let corners = corners(triangle);
            let first = chunk * ROWS;
            let [top, bottom] = extent(corners.map(|corner| corner.y - first as f64), pixels.len() / width);
            let [left, right] = extent(corners.map(|corner| corner.x), width);
            for (row, column) in (top..bottom).flat_map(|row| (left..right).map(move |column| (row, column)))
            {
                let number = row * width + column;
                let at = DVec2::new(column as f64, (first + row) as f64);
                for (sample, offset) in offsets.iter().enumerate() {
                    let is_filled = &mut filled[number * offsets.len() + sample];
                    if let (false, Some(weights)) = (*is_filled, weights(corners, at + *offset))
                        && is_in_view(triangle as usize, weights)
                    {
                        *is_filled = true;
                        let own = color(triangle as usize, weights);
                        sums[number].iter_mut().zip(own).for_each(|(sum, own)| *sum += own);
                    }
                }
            }
        }
        let share = 1.0 / offsets.len() as f64;
        pixels.iter_mut().zip(sums).for_each(|(pixel, sum)| *pixel = sum.map(|c| (c * share) as f32));
        Result::Ok(())
    })?;
    Ok(picture)
}

/// The first and one past the last of so many whole numbers between the least and the largest coordinate.
fn extent([a, b, c]: [f64; 3], count: usize) -> [usize; 2] {
    // A number below 0 becomes 0, and one that is no number, too.
    let low = a.min(b).min(c).floor() as usize;
    let high = (a.max(b).max(c).floor() + 1.0) as usize;
    [low.min(count), high.min(count)]
}

/// Weights of the corners at a place; `None` outside of the triangle, and of one without area.
fn weights([a, b, c]: [DVec2; 3], at: DVec2) -> Option<[f64; 3]> {
    let edges = [edge(b, c, at), edge(c, a, at), edge(a, b, at)];
    let area: f64 = edges.iter().sum();
    let is_inside = edges.iter().all(|edge| *edge >= 0.0) || edges.iter().all(|edge| *edge <= 0.0);
    (is_inside && area != 0.0).then(|| edges.map(|edge| edge / area))
}

/// Twice the area of the triangle from an edge to a place, the same number for either direction of the edge but for its sign.
fn edge(from: DVec2, to: DVec2, at: DVec2) -> f64 {
    match (from.x, from.y) <= (to.x, to.y) {
        true => (to - from).perp_dot(at - from),
        false => -(from - to).perp_dot(at - to),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::generate::{box_of_tetrahedra, sample};
    use crate::grid::{contour, extent as extents};
    use crate::progress::NoProgress;

    /// A camera that looks along a direction at a plane, with the plane's points that are nearest to the middle of the unit cube.
    fn camera(toward: DVec3, size: [u32; 2], samples: u32) -> Camera {
        let projection = Projection::Orthographic { height: 1.0 };
        let camera =
            Camera { eye: toward, target: DVec3::ZERO, up: DVec3::Z, projection, near: 0.0, size, samples };
        camera.fitted(&extents::corners([DVec3::ZERO, DVec3::ONE])).unwrap()
    }

    #[test]
    fn a_cut_has_the_values_of_the_field_at_every_pixel() {
        let grid = box_of_tetrahedra([5, 4, 6], [DVec3::ZERO, DVec3::ONE], 0.2);
        let field = sample(&grid, |p| 3.0 * p.x - 2.0 * p.y + p.z);
        // Straight on, and askew.
        for (normal, toward) in [
            (DVec3::X, DVec3::X),
            (DVec3::new(0.3, 1.0, -0.5), DVec3::new(0.3, 1.0, -0.5)),
            (DVec3::Y, DVec3::new(0.4, 1.0, 0.3)),
        ] {
            let distances = sample(&grid, |p| (p - 0.5).dot(normal));
            let cut = contour(&grid, &distances, 0.0, &NoProgress).unwrap();
            let (points, values) = (cut.positions(&grid.points), cut.values(&field));
            let camera = camera(toward, [61, 47], 1);
            let at = |triangle: usize, weights: [f64; 3]| {
                let own = cut.triangles[triangle].iter().zip(weights);
                let [x, y, z, value] = own.fold([0.0; 4], |sum, (&p, w)| {
                    let p = p as usize;
                    let [x, y, z] = points[p].to_array();
                    [sum[0] + w * x, sum[1] + w * y, sum[2] + w * z, sum[3] + w * values[p]]
                });
                assert!((3.0 * x - 2.0 * y + z - value).abs() < 1e-13);
                [x, y, z, 1.0]
            };
            let picture = flat_picture(&camera, &points, &cut.triangles, at, &NoProgress).unwrap();
            let Frame { right, up, forward, pixel } = camera.frame().unwrap();
            let mut seen = 0;
            for j in 0..47 {
                for i in 0..61 {
                    let from = camera.eye + right * (i as f64 + 0.5 - 30.5) * pixel
                        - up * (j as f64 + 0.5 - 23.5) * pixel;
                    let place = from + forward * ((0.5 - from).dot(normal) / forward.dot(normal));
                    let distance = (place - 0.5).abs().max_element() - 0.5;
                    let [x, y, z, opacity] = picture.pixel(i, j);
                    // A pixel on the very edge may fall to either side.
                    if distance.abs() > 1e-12 {
                        assert_eq!(opacity, f32::from(distance < 0.0), "{place}");
                    }
                    if opacity > 0.0 {
                        seen += 1;
                        let found = DVec3::new(x.into(), y.into(), z.into());
                        assert!(found.distance(place) < 1e-6, "{found} for {place}");
                    }
                }
            }
            assert!(seen > 500, "{seen}");
        }
    }

    #[test]
    fn a_pixel_is_the_mean_of_its_samples() {
        let points = [DVec3::ZERO, DVec3::Y, DVec3::new(0.0, 1.0, 1.0), DVec3::Z];
        let triangles = [[0, 1, 2], [0, 3, 2]];
        let camera = Camera {
            eye: DVec3::new(1.0, 0.5, 0.5),
            target: DVec3::new(0.0, 0.5, 0.5),
            projection: Projection::Orthographic { height: 4.0 / 1.5 },
            ..camera(DVec3::X, [4, 4], 16)
        };
        // A pixel of side 2/3: the square covers 1.5 by 1.5 pixels about the middle.
        let white = |_, _| [1.0; 4];
        let picture = flat_picture(&camera, &points, &triangles, white, &NoProgress).unwrap();
        let total: f32 = picture.rgba.iter().map(|pixel| pixel[3]).sum();
        assert_eq!(total, 2.25, "{:?}", picture.rgba);
        let behind = Camera { near: 1.5, ..camera };
        let picture = flat_picture(&behind, &points, &triangles, white, &NoProgress).unwrap();
        assert!(picture.rgba.iter().all(|pixel| *pixel == [0.0; 4]));
        let perspective = Camera { projection: Projection::Perspective { fov_y: 30.0 }, ..camera };
        assert!(flat_picture(&perspective, &points, &triangles, white, &NoProgress).is_err());
        // Points far out, or that are no numbers, draw what there is.
        let far = [DVec3::new(0.0, -1e300, 0.0), DVec3::new(0.0, f64::NAN, 0.0), DVec3::Y, DVec3::Z];
        flat_picture(&camera, &far, &[[0, 1, 2], [0, 2, 3]], white, &NoProgress).unwrap();
    }
}
