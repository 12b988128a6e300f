//! Ray tracer in 64 bits: every cell that a ray crosses, in the order of the scene, by an integral of the caller's choice. It is slow
//! and shares no geometry with the engines (docs/src/explanation/optics.md, section 4).
//!
//! Points are seen from the ray: x and y across it, z along the view direction, by a shear that is linear in
//! the position, so a face is hit where the origin lies in its projected triangle and the same barycentric
//! weights give z and every point quantity. The signs of the triangle's three edge functions are exact, and a
//! sign of zero is resolved by moving the ray by an infinitesimal (ε, ε²) (Edelsbrunner & Mücke, "Simulation of
//! simplicity", 1990). Both are the same for all cells, so a ray in a shared face, edge or point is given to
//! exactly one of the cells around it, a ray that enters a cell also leaves it, and no volume
//! threshold is needed.

mod crossing;
mod layers;
mod ray_parts;
pub mod tiles;

pub use crossing::{Crossing, Ray};
pub use layers::layers;

use crate::scene::Scene;
use crate::shading::{Light, Ordering};
use crate::{CompiledTransferFunction, Contribution, Segment, WidgetBlend};
use crossing::{cross, cross_triangle};
use glam::DVec3;
use ray_parts::{Event, EventKind, RayPart, visit_parts};
use rayon::prelude::*;
use std::ops::ControlFlow;
use voltet_core::arithmetic::unit_vector;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::clip::{Clip, KeptRanges};
use voltet_core::surface::Surface;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result, counted};

/// Integral of a ray segment. Ends are [s, g, fields …], the fields in the order of [`TransferFunction::fields`].
pub trait SegmentIntegral: Send + Sync {
    /// Contribution of a segment of this length (world units). Errors: what cannot be integrated.
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution>;

    /// Upper bound of a colour channel of a segment of this length (world units).
    fn max_color(&self, _length: f64) -> f64 {
        f64::INFINITY
    }
}

/// Closed forms; overlapping widgets in their order ([`WidgetBlend::Exact`]).
impl SegmentIntegral for CompiledTransferFunction {
    fn integrate(&self, length: f64, front: &[f64], back: &[f64]) -> Result<Contribution> {
        Ok(self.integrate_values(&Segment::of_values(length, front, back), WidgetBlend::Exact))
    }
}

/// Compositing stops where less opacity and colour than this are left.
const DARK: f64 = 1e-22;

/// Depths that differ by less than this share of themselves are one: some hundred roundings.
const SAME_DEPTH: f64 = 1e-13;

/// Result of a traced ray.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct TracedRay {
    /// C, premultiplied linear.
    pub color: [f64; 3],
    /// A.
    pub opacity: f64,
    /// Cells crossed over a positive length.
    pub segments: u64,
}

/// A scene made ready for rays.
pub struct Tracer<'a> {
    volume: &'a Volume,
    integral: Box<dyn SegmentIntegral>,
    camera: Camera,
    frame: Frame,
    silhouette: Option<f64>,
    light: Option<Light>,
    ordering: Ordering,
    /// Internal length unit in world units, a power of two about the size of what is seen.
    unit: f64,
    /// Points in the camera's axes (right, up, forward) from the eye, internal units.
    points: Vec<[f64; 3]>,
    /// Per point: s, g, fields; `stride` numbers.
    quantities: Vec<f64>,
    stride: usize,
    /// Surfaces with their points as those of the grid.
    surfaces: Vec<(&'a Surface, Vec<[f64; 3]>)>,
    clips: &'a [Clip],
}

impl<'a> Tracer<'a> {
    /// Tracer of a scene, whose segments are integrated by `integral`.
    ///
    /// # Errors
    ///
    /// - Arrays that the scene needs and that are missing or of the wrong length.
    /// - Cells with points that do not exist or are not finite.
    /// - A camera or a light out of range.
    pub fn new(scene: &'a Scene, integral: Box<dyn SegmentIntegral>) -> Result<Self> {
        let Scene { volume, transfer_function, camera, shading, .. } = scene;
        let frame = camera.frame()?;
        shading.check(transfer_function)?;
        let (quantities, stride) = quantities(volume, transfer_function)?;
        let world = &volume.grid.points;
        for (cell, corners) in volume.grid.tetrahedra.iter().enumerate() {
            for &corner in corners {
                let corner = corner as usize;
                let known = world.get(corner).is_some_and(|p| p.is_finite());
                if !known || quantities[corner * stride..][..stride].iter().any(|q| !q.is_finite()) {
                    return Err(Error::run("a cell has a point that does not exist or is not finite")
                        .got(format!("point {corner} of cell {cell}")));
                }
            }
        }
        if let Some(light) = shading.light
            && !(light.direction.is_finite() && light.direction != DVec3::ZERO)
        {
            return Err(Error::usage("the light's direction is zero or not finite").got(light.direction));
        }
        if shading.light.is_some() || shading.silhouette.is_some() {
            let count = volume.gradient.as_ref().map_or(0, |g| g.len());
            if count != world.len() {
                return Err(Error::run("light and silhouettes need a gradient at every point").got(format!(
                    "{} at {}",
                    counted(count, "gradient"),
                    counted(world.len(), "point")
                )));
            }
        }
        let used = || volume.grid.tetrahedra.iter().flatten().map(|&p| world[p as usize] - camera.eye);
        let largest = used().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let unit = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
        let axes = [frame.right, frame.up, frame.forward];
        let seen = |p: &DVec3| axes.map(|axis| ((*p - camera.eye) / unit).dot(axis));
        let points = world.iter().map(seen).collect();
        scene.surfaces.iter().try_for_each(|surface| surface.check())?;
        scene.clips.iter().try_for_each(|clip| clip.shape.check())?;
        let surfaces = scene
            .surfaces
            .iter()
            .map(|surface| (&**surface, surface.points.iter().map(seen).collect()))
            .collect();
        let direction = |light: Light| Light { direction: unit_vector(light.direction), ..light };
        Ok(Tracer {
            volume,
            integral,
            camera: *camera,
            frame,
            silhouette: shading.silhouette,
            light: shading.light.map(direction),
            ordering: scene.ordering(true),
            unit,
            points,
            quantities,
            stride,
            surfaces,
            clips: &scene.clips,
        })
    }

    /// The ray through (i, j) in pixels from the picture's upper left corner; pixel centres lie at halves.
    pub fn ray(&self, i: f64, j: f64) -> Ray {
        let [width, height] = self.camera.size.map(f64::from);
        let pitch = self.pitch();
        let perspective = matches!(self.camera.projection, Projection::Perspective { .. });
        Ray { x: (i - 0.5 * width) * pitch, y: (0.5 * height - j) * pitch, perspective }
    }

    /// Side of a pixel: slope, or internal units.
    fn pitch(&self) -> f64 {
        match self.camera.projection {
            Projection::Perspective { .. } => self.frame.pixel,
            Projection::Orthographic { .. } => self.frame.pixel / self.unit,
        }
    }

    /// Depth of the near plane, internal units.
    fn near(&self) -> f64 {
        self.camera.near / self.unit
    }

    fn cell_count(&self) -> u32 {
        self.volume.grid.tetrahedra.len() as u32
    }

    /// The corners of a cell in the camera's axes.
    fn corners(&self, cell: u32) -> [[f64; 3]; 4] {
        self.volume.grid.tetrahedra[cell as usize].map(|p| self.points[p as usize])
    }

    /// The crossing of one cell, if its length is positive.
    pub fn crossing(&self, ray: &Ray, cell: u32) -> Option<Crossing> {
        cross(ray, cell, &self.corners(cell), self.near())
    }

    /// All crossings of a ray in the order of the scene. Tries every cell.
    pub fn crossings(&self, ray: &Ray) -> Vec<Crossing> {
        let cells = (0..self.cell_count()).into_par_iter();
        let mut found: Vec<_> = cells.filter_map(|c| self.crossing(ray, c)).collect();
        self.sort(&mut found);
        found
    }

    /// Puts the crossings of one ray into the order of the scene.
    pub fn sort(&self, crossings: &mut [Crossing]) {
        match self.ordering {
            Ordering::Independent | Ordering::PerPixel => {
                crossings.sort_unstable_by(|a, b| {
                    let by_depth = |k: usize| a.depth[k].total_cmp(&b.depth[k]);
                    by_depth(0).then(by_depth(1)).then(a.cell.cmp(&b.cell))
                });
                // Two cells on one side of a shared face begin at one depth, found twice: their exits decide.
                let equal = |a: f64, b: f64| (a - b).abs() <= SAME_DEPTH * a.abs().max(b.abs());
                for k in 1..crossings.len() {
                    let mut to = k;
                    while to > 0
                        && equal(crossings[to - 1].depth[0], crossings[to].depth[0])
                        && crossings[to - 1].depth[1] > crossings[to].depth[1]
                    {
                        crossings.swap(to - 1, to);
                        to -= 1;
                    }
                }
            }
            Ordering::CellCentroid => {
                let distance = |c: &Crossing| {
                    let corners = self.corners(c.cell);
                    let centre: [f64; 3] = std::array::from_fn(|k| corners.iter().map(|p| p[k]).sum());
                    match self.camera.projection {
                        Projection::Perspective { .. } => centre.iter().map(|x| x * x).sum(),
                        Projection::Orthographic { .. } => centre[2],
                    }
                };
                let order = |a: &Crossing, b: &Crossing| {
                    f64::total_cmp(&distance(a), &distance(b)).then(a.cell.cmp(&b.cell))
                };
                crossings.sort_by(order);
            }
            Ordering::Submission => crossings.sort_unstable_by_key(|c| c.cell),
        }
    }

    /// Length and end values ([s, g, fields …]) of a crossing, world units.
    pub fn segment(&self, ray: &Ray, crossing: &Crossing) -> (f64, [Vec<f64>; 2]) {
        let mut ends = [Vec::new(), Vec::new()];
        let length = self.segment_into(ray, crossing, &mut ends);
        (length, ends)
    }

    /// [`Tracer::segment`] into lists that are used again.
    fn segment_into(&self, ray: &Ray, crossing: &Crossing, ends: &mut [Vec<f64>; 2]) -> f64 {
        let corners = self.volume.grid.tetrahedra[crossing.cell as usize];
        for (end, weights) in ends.iter_mut().zip(crossing.weights) {
            end.clear();
            for q in 0..self.stride {
                let values = corners.map(|corner| self.quantities[corner as usize * self.stride + q]);
                // From the smallest corner value, so that values that hardly vary keep their differences.
                let base = values[0].min(values[1]).min(values[2]).min(values[3]);
                end.push(base + (0..4).map(|k| weights[k] * (values[k] - base)).sum::<f64>());
            }
        }
        (crossing.depth[1] - crossing.depth[0]) * ray.stretch() * self.unit
    }

    /// Contribution of one cell to a ray, silhouette and light included.
    pub fn contribution(&self, ray: &Ray, crossing: &Crossing) -> Result<Contribution> {
        let (length, [front, back]) = self.segment(ray, crossing);
        let part = self.integral.integrate(length, &front, &back);
        let mut part = part.map_err(|error| error.at_item(format!("cell {}", crossing.cell)))?;
        let [silhouette, light] = self.surface(ray, crossing);
        part.opacity *= silhouette;
        part.color = part.color.map(|c| c * silhouette * light);
        Ok(part)
    }

    /// Factors of a crossing's opacity and colour by its silhouette, and of its colour by light; 1 without.
    pub fn surface(&self, ray: &Ray, crossing: &Crossing) -> [f64; 2] {
        let mut factors = [1.0; 2];
        if self.silhouette.is_none() && self.light.is_none() {
            return factors;
        }
        let Some(gradient) = &self.volume.gradient else { return factors };
        let corners = self.volume.grid.tetrahedra[crossing.cell as usize];
        let middle = (0..4).fold(DVec3::ZERO, |sum, k| {
            sum + 0.5 * (crossing.weights[0][k] + crossing.weights[1][k]) * gradient[corners[k] as usize]
        });
        // Where there is no gradient ĝ is zero: the silhouette's factor is 1 there.
        let normal = unit_vector(middle);
        if let Some(exponent) = self.silhouette {
            let view = unit_vector(self.direction(ray));
            // 1 − |cos| by the sine, which keeps its digits where the surface is seen face on.
            let sine = if normal == DVec3::ZERO { 1.0 } else { normal.cross(view).length() };
            factors[0] = (sine * sine / (1.0 + normal.dot(view).abs())).powf(exponent);
        }
        if let Some(light) = self.light {
            factors[1] = light.ambient + light.diffuse * normal.dot(light.direction).abs();
        }
        factors
    }

    /// Composites crossings that are in order, front to back, as far as light comes from them. `each` is called with every one of
    /// these, the transmittance before it, and its contribution.
    fn composite(
        &self,
        ray: &Ray,
        crossings: &[Crossing],
        mut each: impl FnMut(&Crossing, f64, &Contribution),
    ) -> Result<TracedRay> {
        let mut seen = TracedRay { segments: crossings.len() as u64, ..TracedRay::default() };
        let mut transmittance = 1.0;
        // The brightest that any part of the ray could be.
        let farthest = crossings.iter().map(|crossing| crossing.depth[1]).fold(0.0, f64::max);
        let nearest = crossings.iter().map(|crossing| crossing.depth[0]).fold(farthest, f64::min);
        let lit = self.light.map_or(1.0, |light| light.ambient + light.diffuse);
        let brightest = lit * self.integral.max_color((farthest - nearest) * ray.stretch() * self.unit);
        visit_parts(crossings, &self.events(ray), |part| {
            let (part, passed) = match part {
                RayPart::Cell(crossing) => {
                    let part = self.contribution(ray, crossing)?;
                    each(crossing, transmittance, &part);
                    let is_thinned = self.silhouette.is_some();
                    (part, if is_thinned { 1.0 - part.opacity } else { (-part.optical_depth).exp() })
                }
                RayPart::Surface { rgba: [r, g, b, opacity], .. } => {
                    (Contribution { optical_depth: f64::NAN, color: [r, g, b], opacity }, 1.0 - opacity)
                }
            };
            for (total, color) in seen.color.iter_mut().zip(part.color) {
                *total += transmittance * color;
            }
            seen.opacity += transmittance * part.opacity;
            transmittance *= passed;
            let is_dark = transmittance == 0.0 || transmittance * brightest.max(1.0) < DARK;
            Ok(if is_dark { ControlFlow::Break(()) } else { ControlFlow::Continue(()) })
        })?;
        Ok(seen)
    }

    /// Events of a ray, in order. Tries every triangle.
    fn events(&self, ray: &Ray) -> Vec<Event> {
        let mut events = Vec::new();
        let direction = self.direction(ray);
        for (surface, points) in &self.surfaces {
            for (number, corners) in surface.triangles.iter().enumerate() {
                let hit = cross_triangle(ray, &corners.map(|p| points[p as usize]));
                let Some((depth, weights)) = hit.filter(|(depth, _)| *depth >= self.near() && *depth > 0.0)
                else {
                    continue;
                };
                let facing = match surface.light {
                    Some(_) => surface.normal(number, weights).dot(direction.normalize()).abs(),
                    None => 1.0,
                };
                let rgba = surface.color(number, weights, facing);
                events.push(Event { depth, kind: EventKind::Surface(rgba) });
            }
        }
        if !self.clips.is_empty() {
            let [origin, _] = self.world(ray);
            let mut hidden_from = f64::NEG_INFINITY;
            let mut ranges = KeptRanges::default();
            for &[from, to] in ranges.find(self.clips, origin.into(), direction, self.camera.near) {
                if hidden_from < from {
                    events.push(Event { depth: hidden_from / self.unit, kind: EventKind::Hide });
                    events.push(Event { depth: from / self.unit, kind: EventKind::Show });
                }
                hidden_from = to;
            }
            events.push(Event { depth: hidden_from / self.unit, kind: EventKind::Hide });
        }
        events.sort_by(|a, b| a.depth.total_cmp(&b.depth));
        events
    }

    /// Composites the crossings of a ray. Tries every cell.
    pub fn trace(&self, ray: &Ray) -> Result<TracedRay> {
        self.composite(ray, &self.crossings(ray), |_, _, _| {})
    }

    /// C and A of a pixel: the mean of its rays.
    pub fn pixel(&self, rays: &[Ray]) -> Result<[f64; 4]> {
        let mut sum = [0.0; 4];
        for ray in rays {
            let TracedRay { color: [r, g, b], opacity, .. } = self.trace(ray)?;
            sum.iter_mut().zip([r, g, b, opacity]).for_each(|(sum, channel)| *sum += channel);
        }
        Ok(sum.map(|channel| channel / rays.len() as f64))
    }

    /// Origin and unit direction of a ray (world units).
    pub fn world(&self, ray: &Ray) -> [[f64; 3]; 2] {
        let aside = self.frame.right * ray.x + self.frame.up * ray.y;
        let origin = self.camera.eye + if ray.perspective { DVec3::ZERO } else { aside * self.unit };
        [origin.into(), self.direction(ray).normalize().into()]
    }

    /// Direction of a ray, of depth 1 (world axes).
    fn direction(&self, ray: &Ray) -> DVec3 {
        let Frame { right, up, forward, .. } = self.frame;
        if ray.perspective { forward + (right * ray.x + up * ray.y) } else { forward }
    }
}

/// Per point s, g and the fields, one after the other, and how many that are.
fn quantities(volume: &Volume, transfer_function: &TransferFunction) -> Result<(Vec<f64>, usize)> {
    let count = volume.grid.points.len();
    let mut columns: Vec<&[f64]> = vec![&volume.scalar];
    let zeros;
    match &volume.gradient_magnitude {
        Some(g) => columns.push(g),
        None if transfer_function.uses_gradient_magnitude() => {
            return Err(Error::run(
                "a widget looks at the gradient magnitude, which the volume does not have",
            ));
        }
        None => {
            zeros = vec![0.0; count];
            columns.push(&zeros);
        }
    }
    for name in transfer_function.fields() {
        let array = volume.grid.point_arrays.get(name);
        let array = array.filter(|a| a.component_count == 1);
        let array = array.ok_or_else(|| {
            Error::run("a widget looks at a point array that the grid does not have as a scalar")
                .at_item(name)
        })?;
        columns.push(&array.values);
    }
    if let Some(wrong) = columns.iter().find(|c| c.len() != count) {
        return Err(Error::run("a point array has not one value for every point").got(format!(
            "{} at {}",
            counted(wrong.len(), "value"),
            counted(count, "point")
        )));
    }
    let values = (0..count).flat_map(|p| columns.iter().map(move |c| c[p])).collect();
    Ok((values, columns.len()))
}

/// Cell on a ray, and its contribution.
#[derive(Debug, Clone, PartialEq)]
pub struct CellCrossing {
    /// Number of the tetrahedron.
    pub cell: u32,
    /// Entry and exit from the eye, or from its plane where rays are parallel, along the ray; world units.
    pub distance: [f64; 2],
    /// Length inside, world units.
    pub length: f64,
    /// s, g and the further fields at entry.
    pub front: Vec<f64>,
    /// s, g and the further fields at exit.
    pub back: Vec<f64>,
    /// Factor of the opacity and the colour by the silhouette; 1 without.
    pub silhouette: f64,
    /// Factor of the colour by light; 1 without.
    pub light: f64,
    /// Contribution of the cell, silhouette and light included in colour and opacity.
    pub part: Contribution,
    /// Transmittance of all cells before.
    pub transmittance: f64,
}

/// A ray from the eye on.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walk {
    /// The cells in the order of the scene.
    pub steps: Vec<CellCrossing>,
    /// Cells behind these that were not looked at, since no light comes from there.
    pub hidden: u64,
    /// Result of the ray.
    pub seen: TracedRay,
}

impl CellCrossing {
    /// Colour and opacity that it adds to the ray.
    pub fn contribution(&self) -> [f64; 4] {
        let [r, g, b] = self.part.color;
        [r, g, b, self.part.opacity].map(|x| self.transmittance * x)
    }
}

impl Tracer<'_> {
    /// The rays of a pixel, in the order of its samples.
    pub fn rays(&self, [x, y]: [u32; 2]) -> Vec<Ray> {
        let places = sample_places(self.camera.samples);
        places.iter().map(|place| self.ray(f64::from(x) + place[0], f64::from(y) + place[1])).collect()
    }

    /// Number of cells on a ray that the near plane cuts away.
    pub fn cut_away(&self, ray: &Ray) -> usize {
        let whole = |cell| cross(ray, cell, &self.corners(cell), 0.0).is_some();
        let is_cut = |&cell: &u32| whole(cell) && self.crossing(ray, cell).is_none();
        (0..self.cell_count()).filter(is_cut).count()
    }

    /// Traces a ray cell by cell. Errors: what cannot be integrated.
    pub fn walk(&self, ray: &Ray) -> Result<Walk> {
        self.walk_crossings(ray, &self.crossings(ray))
    }

    fn walk_crossings(&self, ray: &Ray, crossings: &[Crossing]) -> Result<Walk> {
        let mut steps = Vec::with_capacity(crossings.len());
        let seen = self.composite(ray, crossings, |crossing, transmittance, part| {
            let (length, [front, back]) = self.segment(ray, crossing);
            let [silhouette, light] = self.surface(ray, crossing);
            steps.push(CellCrossing {
                cell: crossing.cell,
                distance: crossing.depth.map(|depth| depth * ray.stretch() * self.unit),
                length,
                front,
                back,
                silhouette,
                light,
                part: *part,
                transmittance,
            });
        })?;
        Ok(Walk { hidden: (crossings.len() - steps.len()) as u64, steps, seen })
    }
}

/// Positions of a pixel's samples from its upper left corner: the middles of n × n equal parts for square
/// numbers, else the points of Roberts' sequence R₂ (2018), the first in the middle.
fn sample_places(count: u32) -> Vec<[f64; 2]> {
    let count = count.max(1);
    let side = (1..=count).find(|n| n * n >= count).unwrap_or(count);
    if side * side == count {
        let middle = |k: u32| (f64::from(k) + 0.5) / f64::from(side);
        return (0..count).map(|k| [middle(k % side), middle(k / side)]).collect();
    }
    // 1/x and 1/x² for x³ = x + 1.
    const STEP: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_2];
    (0..count).map(|k| STEP.map(|step| (0.5 + step * f64::from(k)).fract())).collect()
}
