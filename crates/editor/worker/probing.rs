//! Values on rays of the picture, weighted by their contribution to it; and a section of the data by a plane: s and g at the pixels of a
//! picture of it, linear in each cell.

use super::hits::{Hit, edges, first_hit};
use super::query::{Query, QueryRun};
use super::request::VolumeSource;
use crate::view::View;
use glam::{DMat3, DVec2, DVec3};
use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::grid::whole_cells;
use voltet_core::progress::Progress;
use voltet_core::transfer::AxisScale;
use voltet_core::volume::Volume;
use voltet_graph::{Parameters, RunContext, diagonal};
use voltet_nodes::drawing::clips;
use voltet_nodes::relative::placed;
use voltet_optics::CompiledTransferFunction;
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Shading, VisibilityOrder};
use voltet_optics::trace::Tracer;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct ProbeQuery {
    pub source: VolumeSource,
    /// The nodes that give the transfer function and the camera.
    pub look: String,
    pub camera: String,
    /// Parameters `clip` of the nodes that draw: parts of space in which the volume is drawn.
    pub clips: Vec<Parameters>,
    /// Outputs that give the surfaces of the picture.
    pub surfaces: Vec<String>,
    /// Places, in heights of the picture from its middle, to the right and up.
    pub places: Vec<[f64; 2]>,
}

#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct PixelProbe {
    /// Rays that were walked; 0 where the values are those of a section.
    pub rays: usize,
    /// Values [s, g] with their shares of what is seen (or of the way, where nothing is).
    pub values: Vec<([f64; 2], f64)>,
    /// Segment of each ray that adds the most to the picture: its values [s, g], and the opacity that it adds. Rays that meet nothing have none.
    pub heaviest: Vec<([f64; 2], f64)>,
    /// Point of a single ray where the most is seen, or where it meets a surface first; world units. `None` where nothing is met.
    pub point: Option<DVec3>,
    /// Place that is seen first, of a single ray.
    pub hit: Option<Hit>,
    /// Number of the file's cells that the rays meet.
    pub cells: usize,
    pub opacity: f64,
}

impl ProbeQuery {
    fn walk(&self, call: &RunContext) -> Result<PixelProbe> {
        let (volume, look) = (call.volume("volume")?, call.look("transfer-function")?);
        let camera = call.camera("camera")?;
        let bounds = volume.grid.bounds();
        let clips = self.clips.iter().map(|p| clips(&placed(p, bounds)?)).collect::<Result<Vec<_>>>()?;
        let transfer_function = Arc::new(look.for_diagonal(diagonal(bounds)));
        let camera = Camera { samples: 1, ..*camera };
        let surfaces = call.surfaces("surface")?;
        let forms = CompiledTransferFunction::new(&transfer_function)?;
        // All cells are looked at once, and few are made ready for rays.
        let near = Arc::new(near_rays(&volume, camera, &self.places, call.progress())?);
        // What is seen, as the values count: light and silhouettes change colours.
        let (shading, order) = (Shading::default(), VisibilityOrder::Exact);
        let scene = Scene::new(near, transfer_function, camera, shading, order);
        let scene = Scene { clips: clips.concat(), surfaces, ..scene };
        let mut probed = self.walk_rays(&scene, &forms, call.progress())?;
        if let Some(cell) = probed.hit.as_mut().and_then(|hit| hit.cell.as_mut()) {
            // Of all its parts, also those that no ray is near.
            cell.edges = edges(&volume.grid, cell.number);
        }
        Ok(probed)
    }

    /// Walks the rays through the places, each among the cells that lie before its part of the picture.
    fn walk_rays(
        &self,
        scene: &Scene,
        forms: &CompiledTransferFunction,
        progress: &dyn Progress,
    ) -> Result<PixelProbe> {
        let mut probed = PixelProbe { rays: self.places.len(), ..PixelProbe::default() };
        let tracer = Tracer::new(scene, Box::new(forms.clone()))?;
        let count = scene.volume.grid.tetrahedra.len() as u32;
        let goes_on = |cell: &u32| !(cell.is_multiple_of(LOOKED_AT) && progress.cancelled());
        let lists = tracer.tile_lists((0..count).take_while(goes_on));
        let (mut seen_most, [width, height]) = (0.0, scene.camera.size.map(f64::from));
        let mut met = HashSet::new();
        for place in &self.places {
            progress.check_cancelled()?;
            let pixel = [0.5 * width + place[0] * height, (0.5 - place[1]) * height];
            let (ray, walk) = (tracer.ray(pixel[0], pixel[1]), tracer.walk_near(pixel, &lists)?);
            probed.opacity += walk.seen.opacity / self.places.len() as f64;
            let all: f64 = walk.steps.iter().map(|step| step.contribution()[3]).sum();
            let way: f64 = walk.steps.iter().map(|step| step.length).sum();
            let mut heaviest = ([0.0; 2], 0.0);
            let [start, direction] = tracer.world(&ray).map(DVec3::from);
            let is_single = self.places.len() == 1;
            if is_single {
                probed.hit = first_hit(&scene.volume, forms, &walk, &scene.surfaces, [start, direction]);
            }
            met.extend(walk.steps.iter().map(|step| scene.volume.grid.source_cell(step.cell as usize)));
            for step in &walk.steps {
                let share = if all > 1e-6 { step.contribution()[3] / all } else { step.length / way };
                let value = |k: usize| {
                    let (front, back) = (step.front.get(k).copied(), step.back.get(k).copied());
                    0.5 * front.unwrap_or(0.0) + 0.5 * back.unwrap_or(0.0)
                };
                probed.values.push(([value(0), value(1)], share / self.places.len() as f64));
                if step.contribution()[3] > heaviest.1 {
                    heaviest = ([value(0), value(1)], step.contribution()[3]);
                }
                if is_single && share > seen_most {
                    seen_most = share;
                    let middle = 0.5 * (step.distance[0] + step.distance[1]);
                    probed.point = Some(start + middle * direction);
                }
            }
            probed.heaviest.extend((all > 1e-6).then_some(heaviest));
            let on_surface = probed.hit.as_ref().filter(|hit| hit.is_on_surface).map(|hit| hit.point);
            probed.point = on_surface.or(probed.point);
        }
        probed.cells = met.len();
        Ok(probed)
    }
}

/// Cells after which a probe can be cancelled.
const LOOKED_AT: u32 = 4096;

/// Room for rounding about a cell, as a share of its distance from the eye.
const ROUNDING: f64 = 1e-9;

/// Margin of the rays, heights of the picture.
const MARGIN: f64 = 1e-6;

/// The cells of a volume whose balls, about the middle of their corners, reach into the box of the picture that holds these places. Errors: a
/// newer query; memory ends.
fn near_rays(
    volume: &Volume,
    camera: Camera,
    places: &[[f64; 2]],
    progress: &dyn Progress,
) -> Result<Volume> {
    let Some(sides) = sides(camera, places) else { return Ok(volume.clone()) };
    let (grid, stops) = (&volume.grid, AtomicBool::new(false));
    let is_met = |cell: usize| {
        if cell.is_multiple_of(LOOKED_AT as usize) && progress.cancelled() {
            stops.store(true, Ordering::Relaxed);
        }
        let corner = |point: u32| grid.points.get(point as usize).copied().unwrap_or(DVec3::NAN);
        let corners = grid.tetrahedra[cell].map(corner);
        let middle = 0.25 * corners.iter().sum::<DVec3>();
        let radius = corners.map(|corner| corner.distance(middle)).into_iter().fold(0.0, f64::max);
        let reaches = |[point, inwards]: &[DVec3; 2]| {
            let from = middle - *point;
            from.dot(*inwards) >= -(radius + ROUNDING * from.length())
        };
        !stops.load(Ordering::Relaxed) && sides.iter().all(reaches)
    };
    let near = whole_cells(grid, is_met, progress)?;
    progress.check_cancelled()?;
    Ok(volume.subset(&near))
}

/// Planes at the sides of the box of the picture that holds places, [a point, unit normal inwards]; `None` of a view that is not sound.
fn sides(camera: Camera, places: &[[f64; 2]]) -> Option<[[DVec3; 2]; 4]> {
    let view = View::from(camera);
    let end = |axis: usize, of: fn(f64, f64) -> f64, start: f64, margin: f64| {
        places.iter().map(|place| place[axis]).fold(start, of) + margin
    };
    let low = [0, 1].map(|axis| end(axis, f64::min, f64::INFINITY, -MARGIN));
    let high = [0, 1].map(|axis| end(axis, f64::max, f64::NEG_INFINITY, MARGIN));
    let middle = view.ray([0.5 * (low[0] + high[0]), 0.5 * (low[1] + high[1])])?;
    let corners = [[low[0], low[1]], [high[0], low[1]], [high[0], high[1]], [low[0], high[1]]];
    let mut sides = [[DVec3::ZERO; 2]; 4];
    for (k, side) in sides.iter_mut().enumerate() {
        let ([from, along], [origin, direction]) = (view.ray(corners[k])?, view.ray(corners[(k + 1) % 4])?);
        let normal = along.cross(origin + direction - from).try_normalize()?;
        let inwards = if normal.dot(middle[0] + middle[1] - from) < 0.0 { -normal } else { normal };
        *side = [from, inwards];
    }
    Some(sides)
}

impl Query for ProbeQuery {
    type Reply = Arc<PixelProbe>;
    // In a newer picture the values lie elsewhere.
    const WAITS: bool = false;

    fn answer(&self, run: &mut QueryRun) -> Result<Arc<PixelProbe>> {
        let mut others = vec![("transfer-function", &*self.look), ("camera", &*self.camera)];
        others.extend(self.surfaces.iter().map(|source| ("surface", source.as_str())));
        self.source.feed(run, &BTreeSet::new(), &others, |call| self.walk(call)).map(Arc::new)
    }
}

impl PixelProbe {
    /// Values that a widget is to cover: of several rays those that are seen most, of one ray or a section all.
    pub fn gathered(&self) -> &[([f64; 2], f64)] {
        if self.rays > 1 && !self.heaviest.is_empty() { &self.heaviest } else { &self.values }
    }

    /// The gathered values at their positions on the axes of s and g, as those of a section; without those that have none.
    pub fn on(&self, scales: [AxisScale; 2]) -> PixelProbe {
        let placed =
            |([s, g], share): &([f64; 2], f64)| ([scales[0].position(*s), scales[1].position(*g)], *share);
        let values = self.gathered().iter().map(placed);
        let values = values.filter(|(place, _)| place.iter().all(|x| x.is_finite())).collect();
        PixelProbe { values, ..PixelProbe::default() }
    }

    /// Mean and covariance of the gathered values by their shares; `None` where there are none.
    pub fn moments(&self) -> Option<([f64; 2], [[f64; 2]; 2])> {
        let gathered = self.gathered();
        let total: f64 = gathered.iter().map(|(_, share)| share).sum();
        if total.is_nan() || total <= 0.0 {
            return None;
        }
        let mean =
            |of: &dyn Fn([f64; 2]) -> f64| gathered.iter().map(|(v, w)| w * of(*v)).sum::<f64>() / total;
        let centre = [mean(&|v| v[0]), mean(&|v| v[1])];
        let covariance = |i: usize, j: usize| mean(&|v| (v[i] - centre[i]) * (v[j] - centre[j]));
        let mixed = covariance(0, 1);
        Some((centre, [[covariance(0, 0).max(0.0), mixed], [mixed, covariance(1, 1).max(0.0)]]))
    }

    /// Ranges of s and g that leave out a share of the gathered values at each end.
    pub fn ranges(&self, without: f64) -> Option<[[f64; 2]; 2]> {
        let total: f64 = self.gathered().iter().map(|(_, share)| share).sum();
        let end = |axis: usize, sign: f64| {
            let mut values: Vec<(f64, f64)> =
                self.gathered().iter().map(|(v, w)| (sign * v[axis], *w)).collect();
            values.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut passed = 0.0;
            let value = values.into_iter().find(|(_, share)| {
                passed += share;
                passed > without * total
            });
            value.map(|(value, _)| sign * value)
        };
        let range = |axis: usize| Some([end(axis, 1.0)?, end(axis, -1.0)?]);
        Some([range(0)?, range(1)?])
    }
}

/// Barycentric distance outside of a cell within which a position still counts as on its face.
const ON_FACE: f64 = 1e-9;

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct SectionQuery {
    pub source: VolumeSource,
    /// The point in the middle, world units.
    pub centre: DVec3,
    /// Unit vectors in the plane: to the right and up in its picture.
    pub axes: [DVec3; 2],
    /// Half of its height, world units.
    pub half: f64,
    pub size: [usize; 2],
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Section {
    pub of: SectionQuery,
    /// [s, g] at the middle of each pixel, rows from the top; none outside of all cells.
    pub values: Vec<Option<[f64; 2]>>,
    /// Number of the file's cells that are cut.
    pub cells: usize,
}

impl SectionQuery {
    /// World units a pixel.
    fn step(&self) -> f64 {
        2.0 * self.half / self.size[1].max(1) as f64
    }

    /// In the plane, from the middle of the picture: pixels to the right and up.
    fn place(&self, point: DVec3) -> DVec2 {
        let from = point - self.centre;
        DVec2::new(from.dot(self.axes[0]), from.dot(self.axes[1])) / self.step()
    }

    fn cut(&self, volume: &Volume, progress: &dyn Progress) -> Result<Section> {
        let [width, height] = self.size;
        let mut section = Section { of: self.clone(), values: vec![None; width * height], cells: 0 };
        let normal = self.axes[0].cross(self.axes[1]);
        let Volume { grid, scalar, gradient_magnitude, .. } = volume;
        let mut cut = HashSet::new();
        let aside: Vec<f64> = grid.points.iter().map(|point| (*point - self.centre).dot(normal)).collect();
        for (i, cell) in grid.tetrahedra.iter().enumerate() {
            if i % 4096 == 0 {
                progress.check_cancelled()?;
            }
            let at = cell.map(|point| point as usize);
            let distances = at.map(|point| aside[point]);
            if distances.iter().all(|d| *d > 0.0) || distances.iter().all(|d| *d < 0.0) {
                continue;
            }
            let corners = at.map(|point| grid.points[point]);
            let g = gradient_magnitude.as_ref();
            let of = |point: usize| [scalar[point], g.map_or(0.0, |g| g[point])];
            if self.fill(&mut section.values, corners, distances, at.map(of)) {
                cut.insert(grid.source_cell(i));
            }
        }
        section.cells = cut.len();
        Ok(section)
    }

    /// Fills the pixels whose middles lie in a cell; false if the cell has no volume.
    fn fill(
        &self,
        values: &mut [Option<[f64; 2]>],
        corners: [DVec3; 4],
        distances: [f64; 4],
        at_corners: [[f64; 2]; 4],
    ) -> bool {
        let edges =
            DMat3::from_cols(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
        let inverse = edges.inverse();
        if !inverse.is_finite() {
            return false;
        }
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for (a, b) in [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)] {
            if distances[a] * distances[b] <= 0.0 && distances[a] != distances[b] {
                let share = distances[a] / (distances[a] - distances[b]);
                let place = self.place(corners[a].lerp(corners[b], share));
                (low, high) = (low.min(place), high.max(place));
            }
        }
        let [width, height] = self.size.map(|side| side as f64);
        // From places to pixels; beyond the picture there are none.
        let first = |x: f64| x.floor().max(0.0) as usize;
        let last = |x: f64, count: f64| (x.ceil().clamp(0.0, count)) as usize;
        let columns = first(low.x + 0.5 * width)..last(high.x + 0.5 * width, width);
        let rows = first(0.5 * height - high.y)..last(0.5 * height - low.y, height);
        for row in rows {
            for column in columns.clone() {
                let point = self.point([column as f64 + 0.5, row as f64 + 0.5]);
                let [b, c, d] = (inverse * (point - corners[0])).to_array();
                let shares = [1.0 - b - c - d, b, c, d];
                if shares.iter().all(|share| *share >= -ON_FACE) {
                    let value = |k: usize| (0..4).map(|v| shares[v] * at_corners[v][k]).sum();
                    values[row * self.size[0] + column] = Some([value(0), value(1)]);
                }
            }
        }
        true
    }

    /// The point at a place of the picture, in pixels from its upper left corner.
    pub fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        let [width, height] = self.size.map(|side| side as f64);
        let [right, up] = self.axes;
        self.centre + self.step() * ((x - 0.5 * width) * right + (0.5 * height - y) * up)
    }
}

impl Query for SectionQuery {
    type Reply = Arc<Section>;
    const WAITS: bool = true;

    fn answer(&self, run: &mut QueryRun) -> Result<Arc<Section>> {
        let cut = |call: &RunContext| self.cut(&*call.volume("volume")?, call.progress());
        self.source.feed(run, &BTreeSet::new(), &[], cut).map(Arc::new)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::camera::Projection;
    use voltet_core::error::ErrorKind;
    use voltet_core::grid::Grid;
    use voltet_core::progress::NoProgress;

    #[test]
    fn moments_are_those_of_the_values_by_their_shares() {
        let values = vec![([1.0, 10.0], 1.0), ([3.0, 30.0], 1.0), ([50.0, 5.0], 0.0)];
        let (centre, covariance) = PixelProbe { values, ..PixelProbe::default() }.moments().unwrap();
        assert_eq!((centre, covariance), ([2.0, 20.0], [[1.0, 10.0], [10.0, 100.0]]));
        let (_, of_one) =
            PixelProbe { values: vec![([7.0, 2.0], 0.3)], ..PixelProbe::default() }.moments().unwrap();
        assert!(of_one.as_flattened().iter().all(|x| x.abs() < 1e-20), "{of_one:?}");
        assert!(PixelProbe::default().moments().is_none() && PixelProbe::default().ranges(0.1).is_none());
        // Of several rays the heaviest segments count; a tenth of them at each end is left out.
        let heaviest = (0..20).map(|k| ([f64::from(k), 3.0], 0.5)).collect();
        let of_rays = PixelProbe { rays: 20, heaviest, ..PixelProbe::default() };
        assert_eq!(of_rays.moments().unwrap().0, [9.5, 3.0]);
        assert_eq!(of_rays.ranges(0.1), Some([[2.0, 17.0], [3.0, 3.0]]));
    }

    /// Says that the user asked to stop.
    struct Cancelled;

    impl Progress for Cancelled {
        fn report(&self, _stage: &str, _fraction: f64) {}

        fn cancelled(&self) -> bool {
            true
        }
    }

    #[test]
    fn cells_apart_from_the_rays_are_left_out_and_a_cancelled_probe_prepares_none() {
        // A hundred cells in a row, each a unit from the next, seen from above.
        let cell = |k: u32| {
            let corner = DVec3::new(f64::from(k), 0.0, 0.0);
            [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|side| corner + 0.5 * side)
        };
        let points: Vec<DVec3> = (0..100).flat_map(cell).collect();
        let tetrahedra: Vec<[u32; 4]> = (0..100).map(|k| [0, 1, 2, 3].map(|corner| 4 * k + corner)).collect();
        let scalar = vec![1.0; points.len()].into();
        let grid = Grid { points: points.into(), tetrahedra: tetrahedra.into(), ..Grid::default() };
        let volume = Volume { grid: Arc::new(grid), scalar, gradient: None, gradient_magnitude: None };
        for projection in
            [Projection::Perspective { fov_y: 90.0 }, Projection::Orthographic { height: 200.0 }]
        {
            let [eye, target] = [100.0, 0.0].map(|height| DVec3::new(50.0, 0.0, height));
            let view = View { eye, target, up: DVec3::Y, projection };
            let camera = view.camera([100, 100]);
            // A height of the picture is 200 units long: from x = 40 to 60.
            let row = [-0.05, 0.0, 0.05].map(|right| [right, 0.0]);
            let near = near_rays(&volume, camera, &row, &NoProgress).unwrap();
            let count = near.grid.tetrahedra.len();
            assert!((21..=25).contains(&count), "{count} {projection:?}");
            let alone = near_rays(&volume, camera, &row[1..2], &NoProgress).unwrap();
            assert!((1..=2).contains(&alone.grid.tetrahedra.len()), "{projection:?}");
            let stopped = near_rays(&volume, camera, &row, &Cancelled).unwrap_err();
            assert_eq!(stopped.kind, ErrorKind::Cancelled);
        }
    }
}
