//! Events along a pixel's ray beside its cells: surfaces, and the ends of the parts that clips keep. Engines cut segments there, and
//! composite a surface's colour in its place.

use glam::DVec3;
use rayon::prelude::*;
use std::cell::OnceCell;
use std::ops::Range;
use std::sync::Arc;
use voltet_core::arithmetic::unit_vector;
use voltet_core::camera::{Camera, Frame, Projection};
use voltet_core::clip::{Clip, KeptRanges};
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
    width: usize,
    bands: Vec<Band>,
}

/// Rows of pixels whose events lie together; a thread finds those of one band at a time.
pub const BAND: usize = 16;

/// Pixels by which a triangle's bounds are widened: more than any rounding of places within a picture of 2¹⁶ pixels.
const SLACK: f64 = 1.0 / 64.0;

/// Surfaces and clips as a camera sees them, for the events of each of its samples.
pub struct RayEventSource<'a> {
    frame: Frame,
    camera: &'a Camera,
    clips: &'a [Clip],
    surfaces: Vec<SeenSurface<'a>>,
}

/// A surface as a camera sees it, wherever its samples are.
struct SeenSurface<'a> {
    surface: &'a Surface,
    /// Points from the eye: right, up, forward.
    points: Vec<DVec3>,
    /// Unit normals of the points, where light reads them.
    normals: Vec<DVec3>,
}

/// The events of a band of rows.
#[derive(Debug)]
struct Band {
    /// First of each pixel's, row by row, and the end of the last one's.
    first: Vec<u32>,
    events: Vec<RayEvent>,
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
        let surfaces = surfaces.iter().map(|surface| SeenSurface {
            surface,
            points: surface.points.par_iter().map(seen).collect(),
            normals: match surface.light {
                Some(_) => surface.normals.par_iter().map(|&normal| unit_vector(normal)).collect(),
                None => Vec::new(),
            },
        });
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
            surfaces.iter().map(|surface| ScreenSurface::new(surface, &rays)).collect();
        let [width, height] = camera.size.map(|n| n as usize);
        let is_lit = surfaces.iter().any(|seen| seen.surface.light.is_some());
        let band = |number: usize| {
            let rows = number * BAND..((number + 1) * BAND).min(height);
            let pixel_count = rows.len() * width;
            if seen.is_empty() {
                return Ok(Band::of_clips(clips, &rays, rows, width));
            }
            let mut found: Vec<(u32, RayEvent)> = Vec::new();
            if !clips.is_empty() {
                let clipped = Band::of_clips(clips, &rays, rows.clone(), width);
                let by_pixel = (0..).zip(clipped.by_pixel());
                found.extend(by_pixel.flat_map(|(pixel, own)| own.iter().map(move |event| (pixel, *event))));
            }
            let direction = |pixel: usize| {
                let [_, direction] = rays.ray(rays.across([pixel % width, rows.start + pixel / width]));
                direction.normalize()
            };
            let directions: Vec<DVec3> =
                if is_lit { (0..pixel_count).map(direction).collect() } else { Vec::new() };
            for surface in &seen {
                progress.check_cancelled()?;
                surface.cross(&rays, number, &directions, &mut found);
            }
            Ok(Band::new(&found, pixel_count))
        };
        let bands: Vec<Band> = (0..height.div_ceil(BAND)).into_par_iter().map(band).collect::<Result<_>>()?;
        let count = bands.iter().map(|band| band.events.len()).sum::<usize>();
        if u32::try_from(count).is_err() {
            return Err(Error::run("rays meet too many surfaces")
                .got(count)
                .expected("at most 4,294,967,295"));
        }
        Ok(RayEvents { width, bands })
    }
}

impl Band {
    /// Events of clips alone.
    fn of_clips(clips: &[Clip], rays: &Rays<'_>, rows: Range<usize>, width: usize) -> Band {
        let mut first = Vec::with_capacity(rows.len() * width + 1);
        let mut events = Vec::with_capacity(rows.len() * width);
        let mut scratch = KeptRanges::default();
        for j in rows {
            for i in 0..width {
                first.push(events.len() as u32);
                rays.clip(clips, [i, j], &mut scratch, |event| events.push(event));
            }
        }
        first.push(events.len() as u32);
        Band { first, events }
    }

    /// The events of each pixel, row by row.
    fn by_pixel(&self) -> impl Iterator<Item = &[RayEvent]> {
        self.first.windows(2).map(|ends| &self.events[ends[0] as usize..ends[1] as usize])
    }

    /// Puts events, each with its pixel, in order: by pixel, then by depth, then as they were found.
    fn new(found: &[(u32, RayEvent)], pixel_count: usize) -> Band {
        let mut first = vec![0; pixel_count + 1];
        for (pixel, _) in found {
            first[*pixel as usize + 1] += 1;
        }
        for pixel in 0..pixel_count {
            first[pixel + 1] += first[pixel];
        }
        let mut next = first.clone();
        let mut events = vec![RayEvent { depth: 0.0, kind: RayEventKind::Show }; found.len()];
        for (pixel, event) in found {
            let at = &mut next[*pixel as usize];
            events[*at as usize] = *event;
            *at += 1;
        }
        for ends in first.windows(2).filter(|ends| ends[1] - ends[0] > 1) {
            events[ends[0] as usize..ends[1] as usize].sort_by(|a, b| a.depth.total_cmp(&b.depth));
        }
        Band { first, events }
    }
}

impl RayEvents {
    /// All events of the band of rows that holds row `j`.
    pub fn of_band(&self, j: usize) -> &[RayEvent] {
        &self.bands[j / BAND].events
    }

    /// Range of a pixel's events among [`RayEvents::of_band`].
    pub fn range_of(&self, i: usize, j: usize) -> [u32; 2] {
        let pixel = j % BAND * self.width + i;
        let first = &self.bands[j / BAND].first;
        [first[pixel], first[pixel + 1]]
    }

    /// The events of a pixel's ray.
    pub fn of_pixel(&self, i: usize, j: usize) -> &[RayEvent] {
        let [first, end] = self.range_of(i, j).map(|at| at as usize);
        &self.of_band(j)[first..end]
    }

    /// The events of each pixel's ray, row by row.
    pub fn by_pixel(&self) -> impl Iterator<Item = &[RayEvent]> {
        self.bands.iter().flat_map(Band::by_pixel)
    }

    /// Takes away what lies behind the end of each pixel's ray. `limits`: depths along the view direction, row by row.
    pub fn end_at(&mut self, limits: &[f32]) {
        for (Band { first, events }, limits) in self.bands.iter_mut().zip(limits.chunks(BAND * self.width)) {
            let all = std::mem::take(events);
            let ends = std::mem::take(first);
            for (ends, limit) in ends.windows(2).zip(limits) {
                first.push(events.len() as u32);
                let own = &all[ends[0] as usize..ends[1] as usize];
                events.extend(own.iter().filter(|event| event.depth < f64::from(*limit)));
            }
            first.push(events.len() as u32);
        }
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
    #[inline]
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

    /// Finds the events of a pixel's clips.
    fn clip(
        &self,
        clips: &[Clip],
        pixel: [usize; 2],
        scratch: &mut KeptRanges,
        mut put: impl FnMut(RayEvent),
    ) {
        let [origin, direction] = self.ray(self.across(pixel));
        let near = self.camera.near;
        let mut event = |depth: f64, kind: RayEventKind| put(RayEvent { depth, kind });
        let mut is_shown = true;
        for &[from, to] in scratch.find(clips, origin, direction, near) {
            if from > near {
                if is_shown {
                    event(near, RayEventKind::Hide);
                }
                event(from, RayEventKind::Show);
            }
            if to == f64::INFINITY {
                return;
            }
            event(to, RayEventKind::Hide);
            is_shown = false;
        }
        if is_shown {
            event(near, RayEventKind::Hide);
        }
    }
}

/// A surface as the rays of a view meet it.
struct ScreenSurface<'a> {
    seen: &'a SeenSurface<'a>,
    /// Triangles that may be met in each band, with the pixels that they may cover: columns and rows from … to before.
    bands: Vec<Vec<(u32, [u16; 4])>>,
}

impl<'a> ScreenSurface<'a> {
    fn new(seen: &'a SeenSurface<'a>, rays: &Rays<'_>) -> ScreenSurface<'a> {
        let SeenSurface { surface, points, .. } = seen;
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
        ScreenSurface { seen, bands }
    }

    /// Finds the surface's events in a band, each with its pixel from the band's first one on. `directions`: unit vectors of the band's
    /// rays, where there is light.
    fn cross(&self, rays: &Rays<'_>, band: usize, directions: &[DVec3], found: &mut Vec<(u32, RayEvent)>) {
        let (width, top) = (rays.camera.size[0] as usize, band * BAND);
        let SeenSurface { surface, points, normals } = self.seen;
        for &(number, [left, right, from, to]) in &self.bands[band] {
            let numbers = surface.triangles[number as usize].map(|p| p as usize);
            let [a, b, c] = numbers.map(|p| points[p]);
            let edges = [rays.edge(b, c), rays.edge(c, a), rays.edge(a, b)];
            // Most triangles of a fine surface meet no ray.
            let flat = OnceCell::new();
            for j in (from as usize).max(top)..(to as usize).min(top + BAND) {
                for i in left as usize..right as usize {
                    let [x, y] = rays.across([i, j]);
                    let side = |edge: DVec3| edge.x * x + edge.y * y + edge.z;
                    let [u, v, w] = [side(edges[0]), side(edges[1]), side(edges[2])];
                    let first = is_positive(u, edges[0]);
                    if first != is_positive(v, edges[1]) || first != is_positive(w, edges[2]) {
                        continue;
                    }
                    let sum = u + v + w;
                    let weights @ [u, v, w] = [u / sum, v / sum, w / sum];
                    let depth = u * a.z + v * b.z + w * c.z;
                    if !(depth >= rays.camera.near && depth > 0.0) {
                        continue;
                    }
                    let pixel = (j - top) * width + i;
                    let facing = match surface.light {
                        None => 1.0,
                        Some(_) => {
                            let normal = if normals.is_empty() {
                                *flat.get_or_init(|| surface.flat_normal(number as usize))
                            } else {
                                let [a, b, c] = numbers;
                                unit_vector(u * normals[a] + v * normals[b] + w * normals[c])
                            };
                            normal.dot(directions[pixel]).abs()
                        }
                    };
                    let [red, green, blue, opacity] = surface.color(number as usize, weights, facing);
                    let rgba = [red as f32, green as f32, blue as f32, opacity as f32];
                    found.push((pixel as u32, RayEvent { depth, kind: RayEventKind::Surface(rgba) }));
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
            // Pixel i has its sample at i + ½ + offset.
            let from = (low - 0.5 - self.offset[axis] - SLACK).ceil().clamp(0.0, f64::from(size));
            let to = (high - 0.5 - self.offset[axis] + SLACK).floor() + 1.0;
            [from as u16, to.clamp(0.0, f64::from(size)) as u16]
        };
        let ([left, right], [top, bottom]) = (range(0, width), range(1, height));
        (left < right && top < bottom).then_some([left, right, top, bottom])
    }
}

/// True if a product is positive; where it is zero, as if the ray were moved by (ε, ε²).
#[inline]
fn is_positive(side: f64, edge: DVec3) -> bool {
    match side {
        0.0 if edge.x != 0.0 => edge.x > 0.0,
        0.0 => edge.y > 0.0,
        _ => side > 0.0,
    }
}
