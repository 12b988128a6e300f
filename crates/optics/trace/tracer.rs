//! A scene made ready for rays: points as the camera sees them, quantities per point, the transfer function.

use super::crossing::{Crossing, Ray, cross};
use super::integral::SegmentIntegral;
use crate::Contribution;
use crate::scene::Scene;
use crate::shading::{Light, Ordering};
use glam::DVec3;
use rayon::prelude::*;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};

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
    pub(super) points: Vec<[f64; 3]>,
    /// Per point: s, g, fields; `stride` numbers.
    quantities: Vec<f64>,
    stride: usize,
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
                return Err(Error::run("light and silhouettes need a gradient at every point")
                    .got(format!("{count} gradients, {} points", world.len())));
            }
        }
        let used = || volume.grid.tetrahedra.iter().flatten().map(|&p| world[p as usize] - camera.eye);
        let largest = used().map(|p| p.abs().max_element()).fold(0.0, f64::max);
        let unit = if largest > 0.0 { largest.log2().floor().exp2() } else { 1.0 };
        let axes = [frame.right, frame.up, frame.forward];
        let seen = |p: &DVec3| axes.map(|axis| ((*p - camera.eye) / unit).dot(axis));
        let points = world.iter().map(seen).collect();
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
    pub(super) fn pitch(&self) -> f64 {
        match self.camera.projection {
            Projection::Perspective { .. } => self.frame.pixel,
            Projection::Orthographic { .. } => self.frame.pixel / self.unit,
        }
    }

    /// Depth of the near plane, internal units.
    pub(super) fn near(&self) -> f64 {
        self.camera.near / self.unit
    }

    /// World units in an internal unit.
    pub(super) fn unit(&self) -> f64 {
        self.unit
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The number of cells.
    pub(super) fn cell_count(&self) -> u32 {
        self.volume.grid.tetrahedra.len() as u32
    }

    /// The corners of a cell in the camera's axes.
    pub(super) fn corners(&self, cell: u32) -> [[f64; 3]; 4] {
        self.volume.grid.tetrahedra[cell as usize].map(|p| self.points[p as usize])
    }

    /// The crossing of one cell, if its length is positive.
    pub fn crossing(&self, ray: &Ray, cell: u32) -> Option<Crossing> {
        self.crossing_from(ray, cell, self.near())
    }

    /// Like [`Self::crossing`], with the near plane at this depth (internal units).
    pub(super) fn crossing_from(&self, ray: &Ray, cell: u32, near: f64) -> Option<Crossing> {
        cross(ray, cell, &self.corners(cell), near)
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
            Ordering::CellCentroid => crossings.sort_by_cached_key(|c| {
                let corners = self.corners(c.cell);
                let centre: [f64; 3] = std::array::from_fn(|k| corners.iter().map(|p| p[k]).sum());
                // Distances are positive, so their bits are in their order; a depth may be negative.
                let distance = match self.camera.projection {
                    Projection::Perspective { .. } => centre.iter().map(|x| x * x).sum(),
                    Projection::Orthographic { .. } => centre[2],
                };
                (ordered_bits(distance), c.cell)
            }),
            Ordering::Submission => crossings.sort_unstable_by_key(|c| c.cell),
        }
    }

    /// Length and end values ([s, g, fields …]) of a crossing, world units.
    pub fn segment(&self, ray: &Ray, crossing: &Crossing) -> (f64, [Vec<f64>; 2]) {
        let length = (crossing.depth[1] - crossing.depth[0]) * ray.stretch() * self.unit;
        let mut ends = [vec![0.0; self.stride], vec![0.0; self.stride]];
        self.ends(crossing, &mut ends);
        (length, ends)
    }

    fn ends(&self, crossing: &Crossing, ends: &mut [Vec<f64>; 2]) {
        let corners = self.volume.grid.tetrahedra[crossing.cell as usize];
        for (weights, end) in crossing.weights.iter().zip(ends) {
            for (q, value) in end.iter_mut().enumerate() {
                let at = |k: usize| self.quantities[corners[k] as usize * self.stride + q];
                // From the smallest corner value, so that values that hardly vary keep their differences.
                let base = (0..4).map(at).fold(f64::INFINITY, f64::min);
                *value = base + (0..4).map(|k| weights[k] * (at(k) - base)).sum::<f64>();
            }
        }
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
            let view = unit_vector(if ray.perspective {
                self.frame.forward + self.frame.right * ray.x + self.frame.up * ray.y
            } else {
                self.frame.forward
            });
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
    pub(super) fn composite(
        &self,
        ray: &Ray,
        crossings: &[Crossing],
        mut each: impl FnMut(&Crossing, f64, &Contribution),
    ) -> Result<TracedRay> {
        let mut seen = TracedRay { segments: crossings.len() as u64, ..TracedRay::default() };
        let mut light = 1.0;
        // The brightest that any part of the ray could be.
        let farthest = crossings.iter().map(|crossing| crossing.depth[1]).fold(0.0, f64::max);
        let nearest = crossings.iter().map(|crossing| crossing.depth[0]).fold(farthest, f64::min);
        let lit = self.light.map_or(1.0, |light| light.ambient + light.diffuse);
        let brightest = lit * self.integral.max_color((farthest - nearest) * ray.stretch() * self.unit);
        for crossing in crossings {
            if light == 0.0 || light * brightest.max(1.0) < DARK {
                break;
            }
            let part = self.contribution(ray, crossing)?;
            each(crossing, light, &part);
            for (total, color) in seen.color.iter_mut().zip(part.color) {
                *total += light * color;
            }
            seen.opacity += light * part.opacity;
            light *= if self.silhouette.is_some() { 1.0 - part.opacity } else { (-part.optical_depth).exp() };
        }
        Ok(seen)
    }

    /// Composites the crossings of a ray. Tries every cell.
    pub fn trace(&self, ray: &Ray) -> Result<TracedRay> {
        self.composite(ray, &self.crossings(ray), |_, _, _| {})
    }

    /// Origin and unit direction of a ray (world units).
    pub fn world(&self, ray: &Ray) -> [[f64; 3]; 2] {
        let Frame { right, up, forward, .. } = self.frame;
        let aside = right * ray.x + up * ray.y;
        let [origin, direction] = match ray.perspective {
            true => [self.camera.eye, forward + aside],
            false => [self.camera.eye + aside * self.unit, forward],
        };
        [origin.into(), direction.normalize().into()]
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
        return Err(Error::run("a point array has not one value for every point")
            .got(format!("{} values, {count} points", wrong.len())));
    }
    let values = (0..count).flat_map(|p| columns.iter().map(move |c| c[p])).collect();
    Ok((values, columns.len()))
}

/// v / |v| for any magnitude of v; zero where v is.
fn unit_vector(v: DVec3) -> DVec3 {
    let largest = v.abs().max_element();
    if largest > 0.0 && largest.is_finite() { (v / largest).normalize() } else { DVec3::ZERO }
}

/// Bits whose order as integers is the order of the numbers.
fn ordered_bits(x: f64) -> u64 {
    let bits = x.to_bits();
    if x.is_sign_negative() { !bits } else { bits | 1 << 63 }
}
