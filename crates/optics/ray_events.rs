//! Events along a pixel's ray beside its cells: surfaces, and the ends of the parts that clips keep. Engines cut segments there, and
//! composite a surface's colour in its place.

use glam::DVec3;
use rayon::prelude::*;
use std::sync::Arc;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::clip::{Clip, kept};
use voltet_core::progress::Progress;
use voltet_core::surface::Surface;
use voltet_core::{Error, Result};

/// An event along a ray.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayEvent {
    /// Depth from the eye along the view direction, world units.
    pub depth: f64,
    /// Kind of the event.
    pub kind: RayEventKind,
}

/// Kind of an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RayEventKind {
    /// A surface: premultiplied linear colour and opacity.
    Surface([f32; 4]),
    /// The volume is not drawn from here on.
    Hide,
    /// The volume is drawn from here on, as at a ray's begin.
    Show,
}

/// The events of every pixel's ray, by depth; of one sample a pixel.
#[derive(Debug)]
pub struct RayEvents {
    size: [usize; 2],
    /// First event of each pixel, row by row, and the end of the last one's.
    first: Vec<u32>,
    events: Vec<RayEvent>,
}

/// Rows of pixels that a thread takes at a time.
const BAND: usize = 16;

/// Surfaces and clips as a camera sees them, for the events of each of its samples.
pub struct RayEventSource<'a> {
    frame: Frame,
    camera: &'a Camera,
    clips: &'a [Clip],
    /// With their points from the eye: right, up, forward.
    surfaces: Vec<(&'a Surface, Vec<DVec3>)>,
}

impl<'a> RayEventSource<'a> {
    /// The source of a view; none where there are no surfaces and no clips.
    ///
    /// # Errors
    /// - a surface, a clip or a camera with a number out of range.
    pub fn new(
        surfaces: &'a [Arc<Surface>],
        clips: &'a [Clip],
        camera: &'a Camera,
    ) -> Result<Option<RayEventSource<'a>>> {
        if surfaces.is_empty() && clips.is_empty() {
            return Ok(None);
        }
        surfaces.iter().try_for_each(|surface| surface.check())?;
        clips.iter().try_for_each(|clip| clip.shape.check())?;
        let frame = camera.frame()?;
        let Frame { right, up, forward, .. } = frame;
        let seen = |p: &DVec3| {
            let q = *p - camera.eye;
            DVec3::new(q.dot(right), q.dot(up), q.dot(forward))
        };
        let surfaces =
            surfaces.iter().map(|surface| (&**surface, surface.points.par_iter().map(seen).collect()));
        Ok(Some(RayEventSource { frame, camera, clips, surfaces: surfaces.collect() }))
    }

    /// The events of the samples that lie `offset` off the pixels' centres.
    ///
    /// # Errors
    /// - more than 2³² events; a stopped run.
    pub fn events(&self, offset: [f64; 2], progress: &dyn Progress) -> Result<RayEvents> {
        let RayEventSource { frame, camera, clips, surfaces } = self;
        let rays = Rays { frame: *frame, camera, offset };
        let seen: Vec<ScreenSurface<'_>> =
            surfaces.iter().map(|(surface, points)| ScreenSurface::new(surface, points, &rays)).collect();
        let [width, height] = camera.size.map(|n| n as usize);
        let band = |number: usize| {
            let rows = number * BAND..((number + 1) * BAND).min(height);
            let mut found: Vec<(u32, RayEvent)> = Vec::new();
            if !clips.is_empty() {
                for j in rows.clone() {
                    for i in 0..width {
                        let pixel = ((j - rows.start) * width + i) as u32;
                        found.extend(rays.clipped(clips, [i, j]).into_iter().map(|event| (pixel, event)));
                    }
                }
            }
            for surface in &seen {
                progress.check_cancelled()?;
                surface.cross(&rays, number, &mut found);
            }
            found.sort_by(|(pixel, a), (other, b)| pixel.cmp(other).then(a.depth.total_cmp(&b.depth)));
            Ok(found)
        };
        let bands: Vec<Vec<(u32, RayEvent)>> =
            (0..height.div_ceil(BAND)).into_par_iter().map(band).collect::<Result<_>>()?;
        let count = bands.iter().map(Vec::len).sum::<usize>();
        if u32::try_from(count).is_err() {
            return Err(Error::run("rays meet too many surfaces")
                .got(count)
                .expected("at most 4,294,967,295"));
        }
        let mut first = Vec::with_capacity(width * height + 1);
        let mut events = Vec::with_capacity(count);
        for (number, found) in bands.iter().enumerate() {
            let pixels = (BAND.min(height - number * BAND) * width) as u32;
            let mut next = found.iter().peekable();
            for pixel in 0..pixels {
                first.push(events.len() as u32);
                while let Some((_, event)) = next.next_if(|(of, _)| *of == pixel) {
                    events.push(*event);
                }
            }
        }
        first.push(events.len() as u32);
        Ok(RayEvents { size: [width, height], first, events })
    }
}

impl RayEvents {
    /// Range of a pixel's events among [`RayEvents::all`].
    pub fn range_of(&self, i: usize, j: usize) -> [u32; 2] {
        let pixel = j * self.size[0] + i;
        [self.first[pixel], self.first[pixel + 1]]
    }

    /// The events of a pixel's ray.
    pub fn of_pixel(&self, i: usize, j: usize) -> &[RayEvent] {
        let [first, end] = self.range_of(i, j).map(|at| at as usize);
        &self.events[first..end]
    }

    /// First of each pixel's events among [`RayEvents::all`], row by row, and the end of the last one's.
    pub fn first(&self) -> &[u32] {
        &self.first
    }

    /// All events, pixel by pixel.
    pub fn all(&self) -> &[RayEvent] {
        &self.events
    }

    /// Takes away what lies behind the end of each pixel's ray. `limits`: depths along the view direction, row by row.
    pub fn end_at(&mut self, limits: &[f32]) {
        let (mut events, mut first) = (Vec::with_capacity(self.events.len()), Vec::new());
        for (ends, limit) in self.first.windows(2).zip(limits) {
            first.push(events.len() as u32);
            let own = &self.events[ends[0] as usize..ends[1] as usize];
            events.extend(own.iter().filter(|event| event.depth < f64::from(*limit)));
        }
        first.push(events.len() as u32);
        (self.events, self.first) = (events, first);
    }
}

/// Composites the surfaces among events behind what a pixel holds (premultiplied colour and opacity).
pub fn composite_behind(events: &[RayEvent], pixel: &mut [f32; 4]) {
    for event in events {
        if let RayEventKind::Surface(rgba) = event.kind {
            let transmittance = 1.0 - pixel[3];
            pixel.iter_mut().zip(rgba).for_each(|(sum, value)| *sum += transmittance * value);
        }
    }
}

/// The rays of a view.
struct Rays<'a> {
    frame: Frame,
    camera: &'a Camera,
    offset: [f64; 2],
}

impl Rays<'_> {
    fn is_perspective(&self) -> bool {
        matches!(self.camera.projection, Projection::Perspective { .. })
    }

    /// To the right and up of the axis: slopes, or world units.
    fn across(&self, [i, j]: [usize; 2]) -> [f64; 2] {
        let [width, height] = self.camera.size.map(f64::from);
        let x = i as f64 + 0.5 + self.offset[0] - 0.5 * width;
        let y = 0.5 * height - (j as f64 + 0.5 + self.offset[1]);
        [x * self.frame.pixel, y * self.frame.pixel]
    }

    /// Origin, and direction of depth 1.
    fn ray(&self, [x, y]: [f64; 2]) -> [DVec3; 2] {
        let Frame { right, up, forward, .. } = self.frame;
        let aside = right * x + up * y;
        match self.is_perspective() {
            true => [self.camera.eye, forward + aside],
            false => [self.camera.eye + aside, forward],
        }
    }

    fn clipped(&self, clips: &[Clip], pixel: [usize; 2]) -> Vec<RayEvent> {
        let [origin, direction] = self.ray(self.across(pixel));
        let hide = |depth: f64| RayEvent { depth, kind: RayEventKind::Hide };
        let near = self.camera.near;
        let kept = kept(clips, origin, direction, near);
        let is_shown_first = kept.first().is_some_and(|[from, _]| *from <= near);
        let mut events = Vec::with_capacity(2 * kept.len() + 1);
        if !is_shown_first {
            events.push(hide(near));
        }
        for (k, [from, to]) in kept.into_iter().enumerate() {
            if k > 0 || !is_shown_first {
                events.push(RayEvent { depth: from, kind: RayEventKind::Show });
            }
            if to < f64::INFINITY {
                events.push(hide(to));
            }
        }
        events
    }
}

/// A surface as a view sees it.
struct ScreenSurface<'a> {
    surface: &'a Surface,
    /// Points from the eye: right, up, forward.
    points: &'a [DVec3],
    /// Triangles that may be met in each band, with the pixels that they may cover: columns and rows from … to before.
    bands: Vec<Vec<(u32, [u16; 4])>>,
}

impl<'a> ScreenSurface<'a> {
    fn new(surface: &'a Surface, points: &'a [DVec3], rays: &Rays<'_>) -> ScreenSurface<'a> {
        let bounds: Vec<_> = surface
            .triangles
            .par_iter()
            .map(|corners| rays.covered(corners.map(|p| points[p as usize])))
            .collect();
        let mut bands = vec![Vec::new(); (rays.camera.size[1] as usize).div_ceil(BAND)];
        for (number, covered) in bounds.into_iter().enumerate() {
            let Some(covered @ [_, _, from, to]) = covered else { continue };
            for band in &mut bands[from as usize / BAND..(to as usize).div_ceil(BAND)] {
                band.push((number as u32, covered));
            }
        }
        ScreenSurface { surface, points, bands }
    }

    /// Finds the surface's events in a band, as pixels from its first one on.
    fn cross(&self, rays: &Rays<'_>, band: usize, found: &mut Vec<(u32, RayEvent)>) {
        let (width, top) = (rays.camera.size[0] as usize, band * BAND);
        for &(number, [left, right, from, to]) in &self.bands[band] {
            let corners = self.surface.triangles[number as usize].map(|p| self.points[p as usize]);
            let edges = [[1, 2], [2, 0], [0, 1]].map(|[a, b]| rays.edge(corners[a], corners[b]));
            for j in (from as usize).max(top)..(to as usize).min(top + BAND) {
                for i in left as usize..right as usize {
                    let across @ [x, y] = rays.across([i, j]);
                    let sides = edges.map(|edge| edge.x * x + edge.y * y + edge.z);
                    let is_right = |k: usize| is_positive(sides[k], edges[k]);
                    let first = is_right(0);
                    if first != is_right(1) || first != is_right(2) {
                        continue;
                    }
                    let sum: f64 = sides.iter().sum();
                    let weights = sides.map(|side| side / sum);
                    let depth: f64 =
                        weights.iter().zip(corners).map(|(weight, corner)| weight * corner.z).sum();
                    if !(depth >= rays.camera.near && depth > 0.0) {
                        continue;
                    }
                    let [_, direction] = rays.ray(across);
                    let rgba = self.surface.color(number as usize, weights, direction.normalize());
                    let kind = RayEventKind::Surface(rgba.map(|value| value as f32));
                    found.push((((j - top) * width + i) as u32, RayEvent { depth, kind }));
                }
            }
        }
    }
}

impl Rays<'_> {
    /// The side of the ray (x, y, 1) on which an edge lies is the sign of its product with this; opposite edges have opposite ones,
    /// so that a ray between two triangles of a surface meets one of them.
    fn edge(&self, a: DVec3, b: DVec3) -> DVec3 {
        match self.is_perspective() {
            true => a.cross(b),
            false => DVec3::new(a.y - b.y, b.x - a.x, a.x * b.y - a.y * b.x),
        }
    }

    /// Columns and rows from … to before, that a triangle may cover; none where it covers no pixel's sample.
    fn covered(&self, corners: [DVec3; 3]) -> Option<[u16; 4]> {
        let [width, height] = self.camera.size;
        if corners.iter().all(|corner| corner.z < self.camera.near || corner.z <= 0.0) {
            return None;
        }
        if self.is_perspective() && corners.iter().any(|corner| corner.z <= 0.0) {
            // It reaches behind the eye: anywhere.
            return Some([0, width as u16, 0, height as u16]);
        }
        let place = |corner: DVec3| {
            let scale = if self.is_perspective() { corner.z } else { 1.0 } * self.frame.pixel;
            [0.5 * f64::from(width) + corner.x / scale, 0.5 * f64::from(height) - corner.y / scale]
        };
        let places = corners.map(place);
        let range = |axis: usize, size: u32| {
            let [low, high] = places.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
                [low.min(place[axis]), high.max(place[axis])]
            });
            // Pixel i has its sample at i + ½ + offset; half a pixel of slack is more than any rounding.
            let from = (low - 0.5 - self.offset[axis] - 0.5).ceil().clamp(0.0, f64::from(size));
            let to = (high - 0.5 - self.offset[axis] + 0.5).floor() + 1.0;
            [from as u16, to.clamp(0.0, f64::from(size)) as u16]
        };
        let ([left, right], [top, bottom]) = (range(0, width), range(1, height));
        (left < right && top < bottom).then_some([left, right, top, bottom])
    }
}

/// True if a product is positive; where it is zero, as if the ray were moved by (ε, ε²).
fn is_positive(side: f64, edge: DVec3) -> bool {
    let first = [side, edge.x, edge.y].into_iter().find(|x| *x != 0.0);
    first.is_some_and(|x| x > 0.0)
}
