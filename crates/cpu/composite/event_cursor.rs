//! Surfaces and clips among the segments of rays ([`voltet_optics::ray_events`]): segments are cut at the events of their pixel, parts
//! that are hidden left out, and colours of surfaces put in their places.

use crate::composite::frame::FrameContext;
use crate::fragments::batch::{BATCH, Batch};
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::ray_events::{RayEvent, RayEventKind, RayEvents, composite_behind};

/// Cursors of a tile's pixels: the events of each that have been taken.
pub(crate) struct EventCursors {
    pixels: [Cursor; PIXELS],
    /// Parts of each lane of the batch's slices, front to back.
    lanes: [Vec<Part>; TILE],
}

/// Cursor of a pixel among its events.
#[derive(Clone, Copy, Default)]
struct Cursor {
    /// The next, and the end, among all of the view.
    next: u32,
    end: u32,
    hidden: bool,
}

/// A part of a segment, or a surface.
#[derive(Clone, Copy)]
pub(crate) struct Part {
    /// Index of the segment in its batch.
    of: usize,
    /// Its depths.
    depths: [f32; 2],
    /// Premultiplied colour and opacity of a surface.
    surface: Option<[f32; 4]>,
}

impl Cursor {
    /// Cuts a segment at its pixel's events, and takes these and those before it. `of`: its index in the batch.
    fn cut(
        &mut self,
        (frame, events): (&FrameContext<'_>, &RayEvents),
        (of, [mut entry, exit]): (usize, [f32; 2]),
        mut put: impl FnMut(Part),
    ) {
        for event in &events.all()[self.next as usize..self.end as usize] {
            let depth = depth_of(event, frame);
            if depth >= exit {
                break;
            }
            if entry < depth {
                if !self.hidden {
                    put(Part { of, depths: [entry, depth], surface: None });
                }
                entry = depth;
            }
            match event.kind {
                RayEventKind::Surface(rgba) => put(Part { of, depths: [depth; 2], surface: Some(rgba) }),
                RayEventKind::Hide => self.hidden = true,
                RayEventKind::Show => self.hidden = false,
            }
            self.next += 1;
        }
        if !self.hidden {
            put(Part { of, depths: [entry, exit], surface: None });
        }
    }
}

impl EventCursors {
    pub fn new() -> EventCursors {
        EventCursors { pixels: [Cursor::default(); PIXELS], lanes: std::array::from_fn(|_| Vec::new()) }
    }

    /// Goes to the beginning of a tile's rays.
    pub fn begin(&mut self, events: &RayEvents, rect: TileRect) {
        self.pixels = [Cursor::default(); PIXELS];
        for j in 0..rect.size[1] {
            for i in 0..rect.size[0] {
                let [next, end] = events.range_of(rect.left + i, rect.top + j);
                self.pixels[j * TILE + i] = Cursor { next, end, hidden: false };
            }
        }
    }

    /// Takes the first `count` fragments of a batch, slices of a row, for [`EventCursors::fill`].
    pub fn take_slices(&mut self, frame: &FrameContext<'_>, events: &RayEvents, batch: &Batch, count: usize) {
        for lane in 0..TILE {
            let mut parts = std::mem::take(&mut self.lanes[lane]);
            parts.clear();
            for k in (lane..count).step_by(TILE).filter(|&k| batch.length[k] > 0.0) {
                let cursor = &mut self.pixels[batch.pixel[k] as usize % PIXELS];
                cursor.cut((frame, events), (k, [batch.entry[k], batch.exit[k]]), |part| parts.push(part));
            }
            self.lanes[lane] = parts;
        }
    }

    /// Fills a batch with the slices of parts from `first` on; returns its fragments, none at the end, and puts the colours of those that
    /// are surfaces into a list.
    pub fn fill(
        &self,
        first: usize,
        from: &Batch,
        attribute_count: usize,
        to: &mut Batch,
        surfaces: &mut Vec<(usize, [f32; 4])>,
    ) -> usize {
        surfaces.clear();
        let longest = self.lanes.iter().map(Vec::len).max().unwrap_or(0);
        let slices = first.min(longest)..(first + BATCH / TILE).min(longest);
        for (k, slice) in slices.clone().enumerate() {
            for (lane, parts) in self.lanes.iter().enumerate() {
                let at = k * TILE + lane;
                match parts.get(slice) {
                    Some(part) => {
                        copy_part(part, from, attribute_count, at, to);
                        surfaces.extend(part.surface.map(|rgba| (at, rgba)));
                    }
                    None => clear(at, attribute_count, to),
                }
            }
        }
        slices.len() * TILE
    }

    /// Cuts segment `k` of a batch whatever was cut before, and hands on the parts that are drawn.
    pub fn cut_alone(
        frame: &FrameContext<'_>,
        events: &RayEvents,
        pixel: [usize; 2],
        from: &Batch,
        k: usize,
        mut put: impl FnMut(Part),
    ) {
        let [next, end] = events.range_of(pixel[0], pixel[1]);
        let mut alone = Cursor { next, end, hidden: false };
        alone.cut((frame, events), (k, [from.entry[k], from.exit[k]]), |part| {
            if part.surface.is_none() {
                put(part);
            }
        });
    }

    /// Composites the surfaces that are left behind a tile's pixels; none is left.
    pub fn end(&mut self, events: &RayEvents, picture: &mut TilePicture) {
        for (cursor, pixel) in self.pixels.iter_mut().zip(picture) {
            composite_behind(&events.all()[cursor.next as usize..cursor.end as usize], pixel);
            cursor.next = cursor.end;
        }
    }
}

/// The surfaces of a pixel, with their depths from the distance origin.
pub(crate) fn surfaces_of(
    frame: &FrameContext<'_>,
    [i, j]: [usize; 2],
) -> impl Iterator<Item = (f32, [f32; 4])> {
    let events = frame.events.map_or(&[][..], |events| events.of_pixel(i, j));
    events.iter().filter_map(|event| match event.kind {
        RayEventKind::Surface(rgba) => Some((depth_of(event, frame), rgba)),
        RayEventKind::Hide | RayEventKind::Show => None,
    })
}

/// Depth from the distance origin, scene lengths.
fn depth_of(event: &RayEvent, frame: &FrameContext<'_>) -> f32 {
    (event.depth / frame.view.length - frame.input.distance_origin) as f32
}

fn clear(at: usize, attribute_count: usize, to: &mut Batch) {
    to.length[at] = 0.0;
    (to.entry[at], to.exit[at]) = (0.0, 0.0);
    for a in 0..attribute_count {
        (to.front[a][at], to.back[a][at]) = (0.0, 0.0);
    }
}

/// Puts a part in slot `at` of a batch. Along a ray depths and attributes are linear, so a fraction of the one is a fraction of the other.
pub(crate) fn copy_part(part: &Part, from: &Batch, attribute_count: usize, at: usize, to: &mut Batch) {
    let (k, [entry, exit]) = (part.of, part.depths);
    let whole = [from.entry[k], from.exit[k]];
    let share = |depth: f32| ((depth - whole[0]) / (whole[1] - whole[0])).clamp(0.0, 1.0);
    // A segment may be thinner than the rounding of its depths.
    let start = if entry > whole[0] { share(entry) } else { 0.0 };
    let end = if exit < whole[1] { share(exit) } else { 1.0 };
    to.pixel[at] = from.pixel[k];
    (to.entry[at], to.exit[at]) = (entry, exit);
    to.length[at] = if part.surface.is_some() { 0.0 } else { from.length[k] * (end - start) };
    for a in 0..attribute_count {
        let (front, back) = (from.front[a][k], from.back[a][k]);
        to.front[a][at] = front + start * (back - front);
        to.back[a][at] = if end == 1.0 { back } else { front + end * (back - front) };
    }
}
