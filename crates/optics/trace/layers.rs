//! Layers of a picture: numbers of the rays through the centres of its pixels, by closed forms in 64 bits whatever integrator draws the
//! colours.
//!
//! The optical depth τ(z) of a ray up to depth z is that of the cells and surfaces before, a surface of opacity α adding −ln(1 − α), and a
//! cell whose opacity a silhouette thins by a factor f adding −ln(1 − f (1 − e^(−τ))). The transmittance is e^(−τ).

use super::Tracer;
use super::crossing::{Crossing, FacePlanes, Ray};
use super::ray_parts::{Event, EventKind, RayPart, visit_parts};
use super::tiles::{SIDE, TILE_PIXELS};
use crate::ray_events::{RayEvent, RayEventKind};
use crate::scene::Scene;
use crate::shading::{Shading, VisibilityOrder};
use crate::special::opacity;
use crate::{CompiledTransferFunction, Segment};
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::f64::consts::LN_2;
use std::ops::ControlFlow;
use voltet_core::Result;
use voltet_core::picture_parts::{LayerValues, NO_CELL, PictureLayer, PictureLayers};
use voltet_core::progress::Progress;

/// Optical depth from which on a ray has met something: what changes a pixel by less than 1e-6 engines may leave out.
const FIRST_HIT: f64 = 1e-6;

/// Optical depths that differ by less, as a share of the one that is sought, are the same: less than 32 bits tell apart.
const SAME_OPTICAL_DEPTH: f64 = 1e-9;

/// Parts of a cell's crossing, as a share, that 32 bits do not tell apart.
const SAME_SHARE: f64 = 1e-9;

/// Most steps that a search takes: every third halves the bracket, so that fewer than 3 · log₂(1/[`SAME_SHARE`]) are enough.
const MAX_STEPS: usize = 96;

struct RayLayers {
    /// z, internal units.
    depth: f64,
    /// z, internal units.
    first_hit: f64,
    cell: u32,
    optical_depth: f64,
}

/// The requested layers of a scene's picture. `cells`: numbers of the tetrahedra that can contribute.
///
/// # Errors
/// - those of [`Tracer::new`]; a stopped run.
pub fn layers(
    scene: &Scene,
    requested: &BTreeSet<PictureLayer>,
    cells: &[u32],
    progress: &dyn Progress,
) -> Result<PictureLayers> {
    // A silhouette of exponent 0 changes nothing; light changes colours alone; a depth has its place in the exact order.
    let silhouette = scene.shading.silhouette.filter(|exponent| *exponent != 0.0);
    let shading = Shading { light: None, silhouette, ..scene.shading };
    let scene = Scene { shading, order: VisibilityOrder::Exact, ..scene.clone() };
    let function = CompiledTransferFunction::new(&scene.transfer_function)?;
    let tracer = Tracer::new(&scene, Box::new(function.clone()))?;
    let events = scene.ray_event_source()?.map(|source| source.events([0.0; 2], progress)).transpose()?;
    let [width, height] = scene.camera.size.map(|n| n as usize);
    let [columns, _] = tracer.tile_counts();
    let lists = tracer.tile_lists(cells.iter().copied());
    let (near, is_whole) = (tracer.near(), requested.contains(&PictureLayer::OpticalDepth));
    let tile = |number: usize| {
        progress.check_cancelled()?;
        let corner = [number % columns * SIDE, number / columns * SIDE];
        let mut crossings: Vec<Vec<Crossing>> = vec![Vec::new(); TILE_PIXELS];
        let of_cell = |cell: u32| {
            let planes = FacePlanes::new(&tracer.corners(cell))?;
            Some(move |ray: &Ray| planes.cross(ray, cell, near))
        };
        tracer.find_crossings(corner, [0.5; 2], &lists[number], &mut crossings, of_cell);
        let pixels = crossings.iter_mut().enumerate().map(|(pixel, crossings)| {
            let (i, j) = (corner[0] + pixel % SIDE, corner[1] + pixel / SIDE);
            let is_within = i < width && j < height;
            let events = events.as_ref().filter(|_| is_within).map_or(&[][..], |all| all.of_pixel(i, j));
            tracer.sort(crossings);
            let ray = tracer.tile_ray(corner, [0.5; 2], pixel);
            tracer.ray_layers(&ray, &function, crossings, events, is_whole)
        });
        pixels.collect::<Result<Vec<RayLayers>>>()
    };
    let tiles = (0..lists.len()).into_par_iter().map(tile).collect::<Result<Vec<_>>>()?;
    let pixels = (0..width * height).map(|pixel| {
        let (i, j) = (pixel % width, pixel / width);
        &tiles[j / SIDE * columns + i / SIDE][j % SIDE * SIDE + i % SIDE]
    });
    let numbers = |number: &dyn Fn(&RayLayers) -> f64| {
        LayerValues::Numbers(pixels.clone().map(|ray| number(ray) as f32).collect())
    };
    let values = |layer: PictureLayer| match layer {
        PictureLayer::Depth => numbers(&|ray| ray.depth * tracer.unit),
        PictureLayer::FirstHit => numbers(&|ray| ray.first_hit * tracer.unit),
        PictureLayer::OpticalDepth => numbers(&|ray| ray.optical_depth),
        PictureLayer::Cell => LayerValues::Cells(pixels.clone().map(|ray| ray.cell).collect()),
    };
    Ok(requested.iter().map(|layer| (*layer, values(*layer))).collect())
}

impl Tracer<'_> {
    /// Numbers of a ray whose crossings are in order. `is_whole`: the ray is followed to its end, not only to where its transmittance is ½.
    fn ray_layers(
        &self,
        ray: &Ray,
        function: &CompiledTransferFunction,
        crossings: &[Crossing],
        events: &[RayEvent],
        is_whole: bool,
    ) -> Result<RayLayers> {
        let event = |event: &RayEvent| Event {
            depth: event.depth / self.unit,
            kind: match event.kind {
                RayEventKind::Surface(rgba) => EventKind::Surface(rgba.map(f64::from)),
                RayEventKind::Hide => EventKind::Hide,
                RayEventKind::Show => EventKind::Show,
            },
        };
        let events: Vec<Event> = events.iter().map(event).collect();
        let (depth, first_hit) = (f64::INFINITY, f64::INFINITY);
        let mut ends = [Vec::with_capacity(self.stride), Vec::with_capacity(self.stride)];
        let mut found = RayLayers { depth, first_hit, cell: NO_CELL, optical_depth: 0.0 };
        visit_parts(crossings, &events, |part| {
            let before = found.optical_depth;
            let reached = |level: f64, after: f64| before < level && level <= after;
            found.optical_depth += match part {
                RayPart::Cell(crossing) => {
                    let [silhouette, _] = self.surface(ray, crossing);
                    let mut optical_depth = |crossing: &Crossing| {
                        let length = self.segment_into(ray, crossing, &mut ends);
                        let own =
                            function.optical_depth_of_values(&Segment::of_values(length, &ends[0], &ends[1]));
                        // Opacity that the silhouette thins.
                        if silhouette == 1.0 { own } else { -(-silhouette * opacity(own)).ln_1p() }
                    };
                    let own = optical_depth(crossing);
                    let mut up_to = |z: f64| optical_depth(&crossing.cut(z)[0]);
                    let mut search = |level| depth_where(crossing.depth, own, level - before, &mut up_to);
                    if reached(FIRST_HIT, before + own) {
                        found.first_hit = search(FIRST_HIT);
                    }
                    if reached(LN_2, before + own) {
                        found.depth = search(LN_2);
                        found.cell = self.volume.grid.source_cell(crossing.cell as usize) as u32;
                    }
                    own
                }
                RayPart::Surface { depth, rgba: [.., opacity] } => {
                    let own = -(-opacity).ln_1p();
                    if reached(FIRST_HIT, before + own) {
                        found.first_hit = depth;
                    }
                    if reached(LN_2, before + own) {
                        found.depth = depth;
                    }
                    own
                }
            };
            let is_done = found.optical_depth == f64::INFINITY || (!is_whole && found.depth < f64::INFINITY);
            Ok(if is_done { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        Ok(found)
    }
}

/// z within a crossing at which its optical depth, `whole` at its exit, is `level`: secants, and now and then the middle, so that the bracket
/// shrinks whatever the profile is. `up_to`: the optical depth up to z.
fn depth_where([entry, exit]: [f64; 2], whole: f64, level: f64, up_to: &mut impl FnMut(f64) -> f64) -> f64 {
    let place = |share: f64| entry + share * (exit - entry);
    // Share of the crossing and optical depth up to there.
    let ([mut low, mut high], mut step) = ([[0.0, 0.0], [1.0, whole]], 0);
    while high[0] - low[0] > SAME_SHARE && step < MAX_STEPS {
        let middle = 0.5 * (low[0] + high[0]);
        let secant = low[0] + (level - low[1]) / (high[1] - low[1]) * (high[0] - low[0]);
        let is_usable = step % 3 < 2 && low[0] < secant && secant < high[0];
        let share = if is_usable { secant } else { middle };
        let own = up_to(place(share));
        if (own - level).abs() <= SAME_OPTICAL_DEPTH * level {
            return place(share);
        }
        if own < level {
            low = [share, own];
        } else {
            high = [share, own];
        }
        step += 1;
    }
    place(high[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;
    use std::sync::Arc;
    use voltet_core::camera::{Camera, Projection};
    use voltet_core::clip::{Clip, ClipShape};
    use voltet_core::grid::generate::{box_of_tetrahedra, sample};
    use voltet_core::progress::NoProgress;
    use voltet_core::surface::{Paint, Surface};
    use voltet_core::transfer::{ControlPoint, OpticalModel, Profile, Widget};
    use voltet_core::volume::Volume;
    use voltet_testing::segments::{look, widget};

    const EXTINCTION: f64 = 0.7;

    /// A widget whose extinction is linear in s, from s = 0 to s = 4.
    fn ramp(extinctions: [f64; 2]) -> Widget {
        let point = |s: f64, extinction: f64| ControlPoint { s, color: [0.5; 3], extinction };
        let points = vec![
            point(-1.0, extinctions[0]),
            point(0.0, extinctions[0]),
            point(4.0, extinctions[1]),
            point(5.0, extinctions[1]),
        ];
        widget(Profile::PiecewiseLinear { points }, [0.5; 3], 1.0)
    }

    /// A slab 1 ≤ z ≤ 5 of even extinction, larger than the picture, seen from z = −2.
    fn slab(projection: Projection) -> Scene {
        let grid =
            box_of_tetrahedra([3, 3, 4], [DVec3::new(-9.0, -9.0, 1.0), DVec3::new(9.0, 9.0, 5.0)], 0.2);
        let scalar = sample(&grid, |p| p.z - 1.0).into();
        let volume = Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None };
        let camera = Camera {
            eye: DVec3::new(0.1, 0.2, -2.0),
            target: DVec3::new(0.1, 0.2, 0.0),
            up: DVec3::Y,
            projection,
            near: 0.0,
            size: [19, 17],
            samples: 4,
        };
        let function = look(OpticalModel::DensityEmitter, vec![ramp([EXTINCTION; 2])]);
        let shading = Shading::default();
        Scene::new(Arc::new(volume), Arc::new(function), camera, shading, VisibilityOrder::Exact)
    }

    fn wall(z: f64, opacity: f64) -> Arc<Surface> {
        let points = [[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]];
        Arc::new(Surface {
            points: points.map(|[x, y]| DVec3::new(x, y, z)).into(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            paint: Paint::Uniform([1.0; 3]),
            opacity,
            light: None,
            normals: Vec::new(),
        })
    }

    fn found(scene: &Scene) -> ([Vec<f32>; 3], Vec<u32>) {
        let cells: Vec<u32> = (0..scene.volume.grid.tetrahedra.len() as u32).collect();
        let all = layers(scene, &PictureLayer::ALL.into(), &cells, &NoProgress).unwrap();
        let numbers =
            [PictureLayer::Depth, PictureLayer::FirstHit, PictureLayer::OpticalDepth].map(|layer| match &all
                [&layer]
            {
                LayerValues::Numbers(numbers) => numbers.clone(),
                LayerValues::Cells(_) => panic!("{layer:?}"),
            });
        let LayerValues::Cells(cells) = &all[&PictureLayer::Cell] else { panic!() };
        (numbers, cells.clone())
    }

    /// Length of a ray per unit of depth.
    fn stretch(scene: &Scene, pixel: usize) -> f64 {
        let tracer =
            Tracer::new(scene, Box::new(CompiledTransferFunction::new(&scene.transfer_function).unwrap()));
        let (x, y) = (pixel % 19, pixel / 19);
        tracer.unwrap().ray(x as f64 + 0.5, y as f64 + 0.5).stretch()
    }

    fn near(found: f32, wanted: f64, what: &str) {
        let is_near = if wanted.is_finite() {
            // Roundings to 32 bits, and 1e-6 of optical depth before the first hit.
            (f64::from(found) - wanted).abs() <= 1e-6 * wanted.abs() + 2e-6
        } else {
            f64::from(found) == wanted
        };
        assert!(is_near, "{what}: {found} in place of {wanted}");
    }

    const VIEWS: [Projection; 2] =
        [Projection::Perspective { fov_y: 40.0 }, Projection::Orthographic { height: 6.0 }];

    #[test]
    fn a_slab_has_the_depths_of_its_closed_form() {
        for projection in VIEWS {
            let scene = slab(projection);
            let ([depth, first_hit, optical_depth], cells) = found(&scene);
            for pixel in 0..19 * 17 {
                let per_depth = EXTINCTION * stretch(&scene, pixel);
                near(first_hit[pixel], 3.0, "first hit");
                near(depth[pixel], 3.0 + LN_2 / per_depth, "depth");
                near(optical_depth[pixel], 4.0 * per_depth, "optical depth");
                // The cell holds the depth.
                let z = f64::from(depth[pixel]) - 2.0;
                let corners = scene.volume.grid.corners(cells[pixel] as usize);
                let [low, high] =
                    [f64::min, f64::max].map(|pick| corners.map(|p| p.z).into_iter().reduce(pick).unwrap());
                assert!((low - 1e-6..=high + 1e-6).contains(&z), "{low} {z} {high}");
            }
        }
    }

    /// Extinction k (z − 1) has the optical depth ½ k (z − 1)².
    #[test]
    fn a_ramp_has_the_depth_of_its_closed_form() {
        let (mut scene, k) = (slab(VIEWS[1]), 1.3);
        let function = look(OpticalModel::DensityEmitter, vec![ramp([0.0, 4.0 * k])]);
        scene.transfer_function = Arc::new(function);
        let ([depth, first_hit, optical_depth], _) = found(&scene);
        for pixel in 0..19 * 17 {
            let reached = |level: f64| 3.0 + (2.0 * level / k).sqrt();
            near(depth[pixel], reached(LN_2), "depth");
            near(first_hit[pixel], reached(FIRST_HIT), "first hit");
            near(optical_depth[pixel], 8.0 * k, "optical depth");
        }
    }

    #[test]
    fn surfaces_and_clips_have_their_places() {
        for projection in VIEWS {
            let mut scene = slab(projection);
            // 2 ≤ z ≤ 5 is left.
            let shape = ClipShape::Plane { origin: DVec3::new(0.0, 0.0, 2.0), normal: DVec3::Z };
            scene.clips = vec![Clip { shape, invert: false }];
            let per_depth: Vec<f64> = (0..19 * 17).map(|pixel| EXTINCTION * stretch(&scene, pixel)).collect();
            let ([depth, first_hit, _], _) = found(&scene);
            for pixel in 0..19 * 17 {
                near(first_hit[pixel], 4.0, "first hit behind a clip");
                near(depth[pixel], 4.0 + LN_2 / per_depth[pixel], "depth behind a clip");
            }
            // Half of the light is left behind a pane before the volume: no cell holds that depth.
            scene.surfaces = vec![wall(0.5, 0.5)];
            let ([depth, first_hit, optical_depth], cells) = found(&scene);
            for pixel in 0..19 * 17 {
                near(first_hit[pixel], 2.5, "pane");
                near(depth[pixel], 2.5, "depth of the pane");
                near(optical_depth[pixel], LN_2 + 3.0 * per_depth[pixel], "pane and volume");
                assert_eq!(cells[pixel], NO_CELL);
            }
            // Opaque within the volume, before half of the light is gone.
            scene.surfaces = vec![wall(2.25, 1.0)];
            let ([depth, first_hit, optical_depth], cells) = found(&scene);
            for pixel in 0..19 * 17 {
                near(first_hit[pixel], 4.0, "first hit");
                near(depth[pixel], 4.25, "wall");
                near(optical_depth[pixel], f64::INFINITY, "wall");
                assert_eq!(cells[pixel], NO_CELL);
            }
        }
    }

    #[test]
    fn a_ray_that_keeps_its_light_has_no_depth() {
        let mut scene = slab(VIEWS[0]);
        let shape = ClipShape::Plane { origin: DVec3::new(0.0, 0.0, 1.5), normal: -DVec3::Z };
        scene.clips = vec![Clip { shape, invert: false }];
        let ([depth, first_hit, optical_depth], cells) = found(&scene);
        near(depth[0], f64::INFINITY, "depth");
        near(first_hit[0], 3.0, "first hit");
        near(optical_depth[0], 0.5 * EXTINCTION * stretch(&scene, 0), "optical depth");
        assert_eq!(cells[0], NO_CELL);
        scene.clips[0].shape = ClipShape::Sphere { centre: DVec3::splat(100.0), radius: 1.0 };
        let ([depth, first_hit, optical_depth], _) = found(&scene);
        assert_eq!([depth[0], first_hit[0], optical_depth[0]], [f32::INFINITY, f32::INFINITY, 0.0]);
    }
}
