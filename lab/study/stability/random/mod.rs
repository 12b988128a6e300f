//! Random scenes (grids, fields, transfer functions, cameras), by every engine, held against the 64-bit referee.
//!
//! Some scenes have no picture that 32 bits, or the data's own rounding, determine: a ray within a face, a widget a
//! millionth as wide as a cell's range. A pixel beyond its bound is *explained* where the referee itself changes by half as much
//! when rays move by a thousandth of a pixel, when s and g or the points are rounded to 32 bits of their ranges, or when s and
//! g all move by as much as that may change the larger half of them. What is not explained is wrong.
//!
//! A device draws each scene by tiles, and by what blends where one colour needs no order. Hardware moves the corners
//! of triangles to a raster, those of each cell for itself: there the sum counts of what each cell, drawn alone, changes when it
//! moves by a step of that raster. Other ways of compositing decide by the rounded points of a face, for each face
//! alone, whether a ray within it meets the cell beside it. Where a face has a cell on one side only, both are right: of such cells,
//! and of no others, the sum of changes counts as well.
//!
//! Every number gives two scenes, one in general position and one in a special one.

mod general;
mod special;

use crate::stability::pictures::{BOUND, OpenRenderer, Subjects, may_refuse, picture};
use crate::work_precision::{RendererVariant, pixel_errors};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::f64::consts::PI;
use std::sync::Arc;
use voltet_core::grid::extent::range;
use voltet_core::grid::{Grid, cells_of_faces};
use voltet_core::picture::Picture;
use voltet_core::progress::{CancelOnly, Progress};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, SharedSlice};
use voltet_introspect::clear_caches;
use voltet_optics::engine::Compositor;
use voltet_optics::scene::Scene;
use voltet_optics::trace::Ray;
use voltet_reference as reference;

/// Ratio of an explained error to the largest change that was found: only some neighbours of a scene are looked at.
const LIKE: f64 = 2.0;

#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Position {
    General,
    Special,
}

impl Position {
    pub fn name(self) -> &'static str {
        ["general", "special"][self as usize]
    }
}

/// The scene of a number.
pub fn scene(seed: u64, number: u64, position: Position) -> Result<Scene> {
    match position {
        Position::General => general::scene(seed, number),
        Position::Special => special::scene(seed, number),
    }
}

/// A scene on which an engine was beyond its bound.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BoundViolation {
    /// The scene's number: with the seed and the position all that it takes to draw it again.
    pub scene: u64,
    pub position: Position,
    pub engine: String,
    pub pixels: usize,
    /// Pixels beyond the bound that neither the camera nor the data's rounding explain.
    pub wrong: usize,
    /// The largest error of a channel, of those not explained where there are any.
    pub worst_error: f64,
    pub worst_pixel: [usize; 2],
}

#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct RandomReport {
    /// All scenes follow from it.
    pub seed: u64,
    pub drawn: u64,
    /// Scenes that show something: an opacity of more than 1/255 somewhere.
    pub shown: u64,
    /// Scenes that the referee cannot integrate: it says so, and nothing can be held against it.
    pub without_reference: u64,
    /// Scenes that an engine refused, by engine.
    pub refused: Vec<(String, u64)>,
    /// The error of a channel that is allowed.
    pub bound: f64,
    pub beyond: Vec<BoundViolation>,
}

impl RandomReport {
    /// True if nothing is beyond its bound without an explanation.
    pub fn passed(&self) -> bool {
        self.beyond.iter().all(|scene| scene.wrong == 0)
    }
}

/// Draws the scenes of these numbers with every engine.
///
/// Errors: a stopped run, and an engine that does not draw a scene that has a reference picture.
pub fn random(
    subjects: &Subjects,
    seed: u64,
    scenes: std::ops::Range<u64>,
    progress: &dyn Progress,
) -> Result<RandomReport> {
    let mut found = RandomReport { seed, bound: BOUND, ..RandomReport::default() };
    let (first, count) = (scenes.start, scenes.end.saturating_sub(scenes.start));
    let positions = [Position::General, Position::Special];
    for (number, position) in scenes.flat_map(|number| positions.map(|position| (number, position))) {
        progress.report("random scenes", (number - first) as f64 / count as f64);
        progress.check_cancelled()?;
        let scene = scene(seed, number, position)?;
        let exact = match reference::draw(&scene, &CancelOnly(progress)) {
            Ok(exact) => exact,
            Err(_) if progress.cancelled() => return Err(Error::cancelled()),
            Err(_) => {
                found.without_reference += 1;
                continue;
            }
        };
        found.drawn += 1;
        found.shown += u64::from(exact.rgba.iter().any(|pixel| pixel[3] > 1.0 / 255.0));
        // Hardly two scenes share compiled shaders.
        subjects.renderers.iter().for_each(|renderer| clear_caches(renderer.engine.as_ref()));
        let mut explained = None;
        let ordering = scene.ordering(false);
        let variants = |renderer: &OpenRenderer| {
            RendererVariant::all_of_engine(renderer.declared).filter(move |variant| variant.makes(ordering))
        };
        let each = subjects.renderers.iter().flat_map(|one| variants(one).map(move |variant| (one, variant)));
        for (renderer, RendererVariant { compositing: way, .. }) in each {
            let engine = match way {
                None => renderer.engine.label(),
                Some(way) => format!("{}, {}", renderer.engine.label(), way.name()),
            };
            let picture = match picture(renderer, way, &scene, progress) {
                Ok(picture) => picture,
                Err(_) if may_refuse(renderer, progress) => {
                    match found.refused.iter_mut().find(|refused| refused.0 == engine) {
                        Some(refused) => refused.1 += 1,
                        None => found.refused.push((engine, 1)),
                    }
                    continue;
                }
                Err(error) => return Err(error.at_item(format!("scene {number} of seed {seed}"))),
            };
            let errors: Vec<f64> = pixel_errors(&picture, &exact).collect();
            if errors.iter().all(|error| *error <= BOUND) {
                continue;
            }
            let known = explained.get_or_insert_with(|| largest(&neighbours_of(&scene, progress), &exact));
            let is_wrong = |most: &[f64]| errors.iter().zip(most).any(|(e, most)| *e > BOUND + LIKE * most);
            let mut most = known.clone();
            // A sum over all cells is a bound already.
            let grid = &scene.volume.grid;
            let further = match way {
                Some(Compositor::Triangles) => Some((grid.tetrahedra.to_vec(), RASTER)),
                _ => is_wrong(&most).then(|| (outer_cells(grid), EDGE_ON_ROUNDING)),
            };
            if let Some((cells, by)) = further {
                let further = changes_of_cells(&scene, &cells, by, progress);
                most.iter_mut().zip(further).for_each(|(most, further)| *most = most.max(further / LIKE));
            }
            found.beyond.push(beyond((number, position), engine, &errors, &most, exact.width));
        }
    }
    Ok(found)
}

fn beyond(
    (scene, position): (u64, Position),
    engine: String,
    errors: &[f64],
    changes: &[f64],
    width: usize,
) -> BoundViolation {
    let pixels = errors.iter().filter(|error| **error > BOUND).count();
    let wrong: Vec<usize> = (0..errors.len()).filter(|&k| errors[k] > BOUND + LIKE * changes[k]).collect();
    let all: Vec<usize> = (0..errors.len()).collect();
    let among = if wrong.is_empty() { &all } else { &wrong };
    let worst = among.iter().copied().max_by(|&a, &b| errors[a].total_cmp(&errors[b])).unwrap_or(0);
    BoundViolation {
        scene,
        position,
        engine,
        pixels,
        wrong: wrong.len(),
        worst_error: errors[worst],
        worst_pixel: [worst % width, worst / width],
    }
}

/// Move of the camera (pixels).
const NUDGE: f64 = 1e-3;
/// The raster that hardware moves the corners of triangles to, pixels.
const RASTER: f64 = 1.0 / 256.0;
/// By how much an engine may round each face, seen edge-on, for itself, pixels: what it does with a ray in a face it decides by the
/// face's three points.
const EDGE_ON_ROUNDING: f64 = 1.0 / (1 << 15) as f64;
/// Change by rounding to 32 bits in a number from a half to one.
const HALF_STEP: f64 = 1.0 / (1 << 25) as f64;

/// Cells that have a face to themselves.
fn outer_cells(grid: &Grid) -> Vec<[u32; 4]> {
    let faces = cells_of_faces(grid);
    let cells = grid.tetrahedra.iter().zip(faces.chunks(4));
    cells.filter(|(_, neighbours)| neighbours.contains(&u32::MAX)).map(|(cell, _)| *cell).collect()
}

/// By how much each pixel may change when the corners of these cells move by so many pixels, each cell for itself: what one loses no other
/// gains. The sum, over the cells, of what each changes when it is drawn alone and moves. As it hides and is hidden by others at most
/// wholly, the picture changes by no more.
fn changes_of_cells(scene: &Scene, cells: &[[u32; 4]], by: f64, progress: &dyn Progress) -> Vec<f64> {
    let size = scene.camera.size.map(|n| n as usize);
    let mut sum = vec![0.0; size[0] * size[1]];
    for &cell in cells {
        let grid = Grid { tetrahedra: vec![cell].into(), ..(*scene.volume.grid).clone() };
        let volume = Arc::new(Volume { grid: Arc::new(grid), ..(*scene.volume).clone() });
        let alone = Scene { volume, ..scene.clone() };
        if let Ok(exact) = reference::draw(&alone, &CancelOnly(progress)) {
            let most = largest(&nudged(&alone, by, progress), &exact);
            sum.iter_mut().zip(most).for_each(|(sum, change)| *sum += change);
        }
    }
    sum
}

/// The largest change of each pixel from the exact picture.
fn largest(pictures: &[Picture], exact: &Picture) -> Vec<f64> {
    let mut most = vec![0.0_f64; exact.rgba.len()];
    for picture in pictures {
        most.iter_mut().zip(pixel_errors(picture, exact)).for_each(|(most, change)| *most = most.max(change));
    }
    most
}

/// Pictures of the scene with its rays moved by so many pixels, in 16 directions.
fn nudged(scene: &Scene, by: f64, progress: &dyn Progress) -> Vec<Picture> {
    // A ray along an edge borders on as many cells as meet there, each within an angle of its own.
    let steps = (0..16).map(|k| (f64::from(k) * PI / 8.0).sin_cos());
    let Ok(tracer) = reference::tracer(scene) else { return Vec::new() };
    let pixel = tracer.ray(1.0, 0.0).x - tracer.ray(0.0, 0.0).x;
    let [width, height] = scene.camera.size;
    let picture = |(y, x): (f64, f64)| -> Result<Picture> {
        let seen = |number: u32| -> Result<[f32; 4]> {
            progress.check_cancelled()?;
            let rays = tracer.rays([number % width, number / width]);
            let moved = |ray: &Ray| Ray { x: ray.x + by * x * pixel, y: ray.y + by * y * pixel, ..*ray };
            let moved: Vec<Ray> = rays.iter().map(moved).collect();
            Ok(tracer.pixel(&moved)?.map(|channel| channel as f32))
        };
        let rgba = (0..width * height).into_par_iter().map(seen).collect::<Result<_>>()?;
        Ok(Picture { rgba, ..Picture::transparent(width as usize, height as usize) })
    };
    steps.filter_map(|step| picture(step).ok()).collect()
}

/// The scene as it may be for what nobody can see, and for the data's rounding.
fn neighbours_of(scene: &Scene, progress: &dyn Progress) -> Vec<Picture> {
    let mut all = nudged(scene, NUDGE, progress);
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
    let scenes = volumes.into_iter().map(|volume| Scene { volume: Arc::new(volume), ..scene.clone() });
    all.extend(scenes.filter_map(|scene| reference::draw(&scene, &CancelOnly(progress)).ok()));
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
    use crate::stability::subjects;
    use voltet_core::picture::Picture;
    use voltet_core::progress::NoProgress;

    /// On every lane set; most show something, so that they prove something.
    #[test]
    fn no_scene_is_beyond_its_bound_unexplained() {
        let found =
            random(&subjects(None).expect("the native engine"), 1, 0..120, &NoProgress).expect("drawn");
        assert_eq!((found.drawn, found.without_reference), (240, 0));
        assert!(found.shown > 150, "{}", found.shown);
        assert!(found.passed(), "{:#?}", found.beyond);
    }

    /// Edge-on faces that lie along a row of pixels to some 1e-9, slivers of 1 : 30,000 behind steep widgets, faces that are lines
    /// on the screen since they are narrow, a widget that falls by e⁻¹⁶ over a cell where another begins, an edge through the eye that
    /// the middle ray follows, cells that overlap at the near plane, faces of a millionth of a pixel, a stiff ramp at 1e8, faces close by
    /// a ray on processors without a fused multiply-add; in special positions stiff layers thinner than the rounding of distances.
    #[test]
    fn scenes_once_beyond_their_bound_are_not() {
        let subjects = subjects(None).expect("the native engine");
        let general = [
            (5, 4042),
            (5, 3438),
            (5, 4970),
            (6, 2674),
            (6, 5644),
            (7, 838),
            (7, 1390),
            (7, 5801),
            (2, 4397),
            (5, 4221),
            (8, 3186),
            (8, 5116),
            (8, 9196),
            (2, 192),
            (2, 3280),
            (2, 3322),
        ];
        let special = [(1, 669), (1, 1479), (2, 2238)];
        for (position, scenes) in [(Position::General, &general[..]), (Position::Special, &special)] {
            scenes.iter().for_each(|&(seed, number)| assert_within_bound(&subjects, seed, number, position));
        }
    }

    /// The rim of a thin layer, whose planes rounding must not tilt along it; constant fields whose value is the edge of a region.
    #[test]
    fn scenes_once_beyond_a_devices_bound_are_not() {
        let subjects = match subjects(Some("software")) {
            Ok(subjects) => subjects,
            Err(why) => return voltet_testing::skipped_without_device(why),
        };
        assert_within_bound(&subjects, 22, 197, Position::General);
        for (seed, number) in [(24, 425), (23, 445)] {
            assert_within_bound(&subjects, seed, number, Position::Special);
        }
    }

    fn assert_within_bound(subjects: &Subjects, seed: u64, number: u64, position: Position) {
        let found = random(subjects, seed, number..number + 1, &NoProgress).expect("drawn");
        let beyond = found.beyond.iter().filter(|scene| scene.position == position);
        assert_eq!(beyond.collect::<Vec<_>>(), Vec::<&BoundViolation>::new());
    }

    /// A ray along an edge where six cells meet, beside holes; rays in faces of the outer surface, some of whose cells get them and some not.
    #[test]
    fn rays_in_the_outer_surface_are_explained() {
        let subjects = subjects(None).expect("the native engine");
        for (seed, number) in [(12, 8876), (1, 3645), (2, 1330)] {
            let found = random(&subjects, seed, number..number + 1, &NoProgress).expect("drawn");
            assert!(!found.beyond.is_empty() && found.passed(), "{:#?}", found.beyond);
        }
    }

    /// Layers of slivers that the rounding of points makes visibly thicker or thinner: a device refuses them, so that `auto` takes the
    /// CPU. What is as thin and less dense, or as dense and less thin, it draws.
    #[test]
    fn a_device_refuses_slivers_that_rounding_spoils() {
        let subjects = match subjects(Some("software")) {
            Ok(subjects) => subjects,
            Err(why) => return voltet_testing::skipped_without_device(why),
        };
        let on_device = subjects.renderers.iter().find(|renderer| renderer.declared.on_device);
        let device = on_device.expect("it is named");
        let draw = |number| {
            let scene = scene(1, number, Position::Special).expect("a scene");
            clear_caches(device.engine.as_ref());
            (picture(device, None, &scene, &NoProgress), scene)
        };
        for number in [226, 126, 656, 466, 896] {
            let refused = draw(number).0.expect_err("too dense").to_string();
            assert!(refused.contains("flat cell") && refused.contains("\"cpu\""), "{number}: {refused}");
        }
        for number in [406, 696, 1186] {
            let (drawn, scene) = draw(number);
            let exact = reference::draw(&scene, &NoProgress).expect("drawn");
            let drawn = drawn.expect("held");
            assert!(pixel_errors(&drawn, &exact).all(|error| error <= BOUND), "{number}");
        }
    }

    #[test]
    fn a_scene_follows_from_its_number() {
        let look = |seed, number| scene(seed, number, Position::General).expect("a scene").transfer_function;
        assert_eq!(look(1, 5), look(1, 5));
        assert_ne!(look(1, 5), look(1, 6));
        assert_ne!(look(1, 5), look(2, 5));
    }

    /// Three pixels beyond: one that the referee's own change explains, two not, of which one is not finite.
    #[test]
    fn only_what_changes_as_much_is_explained() {
        let errors = [0.0, 3e-4, 4e-4, f64::INFINITY];
        let found =
            beyond((7, Position::General), "an engine".into(), &errors, &[0.0, 0.6e-4, 0.6e-4, 9.0], 2);
        assert_eq!((found.pixels, found.wrong), (3, 2));
        assert_eq!((found.worst_error, found.worst_pixel), (f64::INFINITY, [1, 1]));
        let all = RandomReport { beyond: vec![found], ..RandomReport::default() };
        assert!(!all.passed());
    }

    /// A pixel that is not a number differs by ∞.
    #[test]
    fn what_is_not_finite_is_wrong() {
        let exact = Picture::transparent(2, 1);
        let mut found = exact.clone();
        found.rgba[1][2] = f32::NAN;
        assert_eq!(pixel_errors(&found, &exact).collect::<Vec<_>>(), [0.0, f64::INFINITY]);
    }

    /// An offset takes no digits of what is explained by rounding.
    #[test]
    fn values_are_rounded_within_their_range() {
        let far = about_the_least(&[1e8, 1e8 + 0.25, 1e8 + 1.0], rounded);
        assert_eq!(far, [1e8, 1e8 + 0.25, 1e8 + 1.0]);
        assert_eq!(about_the_least(&[2.0; 3], |x| x + 0.5), [2.0; 3]);
        assert_eq!(about_the_least(&[-1.0, 1.0], |x| x + 0.25), [-0.5, 1.5]);
    }
}
