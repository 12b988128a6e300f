//! Parts of segments, in place of the whole: between surfaces and clips of their rays ([`voltet_optics::ray_events`]), whose colours take
//! their places among them; and, where an axis is logarithmic, straight pieces along it ([`voltet_optics::curved_axes`]).

use crate::composite::frame::FrameContext;
use crate::composite::lane_axes::LaneAxes;
use crate::fragments::batch::{BATCH, Batch};
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::curved_axes::{AxisCut, StraightPiece};
use voltet_optics::ray_events::{RayEvent, RayEventKind, RayEvents, composite_behind};

/// Cutter of a tile's segments.
pub(crate) struct SegmentCutter {
    pixels: [Cursor; PIXELS],
    /// Parts of each lane of the batch's slices, front to back.
    lanes: [Vec<Part>; TILE],
    scratch: Vec<AxisCut>,
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
    /// Shares of the segment at which it begins and ends.
    shares: [f32; 2],
    /// Shares of the part between two events that it is a piece of.
    whole: [f32; 2],
    /// Positions of s and g at its ends, along curved axes.
    ends: Option<[[f32; 2]; 2]>,
    /// Premultiplied colour and opacity of a surface.
    surface: Option<[f32; 4]>,
}

impl Part {
    /// A part between two depths of a segment. Along a ray depths and attributes are linear, so a fraction of the one is a fraction of the
    /// other.
    fn between(of: usize, [entry, exit]: [f32; 2], depths: [f32; 2]) -> Part {
        let share = |depth: f32| ((depth - entry) / (exit - entry)).clamp(0.0, 1.0);
        // A segment may be thinner than the rounding of its depths.
        let start = if depths[0] > entry { share(depths[0]) } else { 0.0 };
        let end = if depths[1] < exit { share(depths[1]) } else { 1.0 };
        Part { of, depths, shares: [start, end], whole: [start, end], ends: None, surface: None }
    }

    /// Hands on the straight pieces of a part.
    fn straighten(
        self,
        axes: Option<&LaneAxes>,
        batch: &Batch,
        scratch: &mut Vec<AxisCut>,
        put: &mut impl FnMut(Part),
    ) {
        let Some(axes) = axes.filter(|_| self.surface.is_none()) else { return put(self) };
        let [start, end] = self.shares.map(f64::from);
        let [front, back] = [start, end].map(|share| axes.at(batch, self.of, share));
        let piece = |StraightPiece { shares, ends }: StraightPiece| {
            let within = |low: f64, high: f64| shares.map(|share| (low + share * (high - low)) as f32);
            let [entry, exit] = self.depths.map(f64::from);
            let ends = Some(ends.map(|position| axes.stored(position)));
            put(Part { depths: within(entry, exit), shares: within(start, end), ends, ..self });
        };
        axes.curved.cut(front, back, scratch, piece);
    }
}

impl Cursor {
    /// Cuts a segment at its pixel's events, and takes these and those before it. `of`: its index in the batch.
    fn cut(&mut self, frame: &FrameContext<'_>, (of, whole): (usize, [f32; 2]), mut put: impl FnMut(Part)) {
        let events = frame.events.map_or(&[][..], RayEvents::all);
        let [mut entry, exit] = whole;
        for event in &events[self.next as usize..self.end as usize] {
            let depth = depth_of(event, frame);
            if depth >= exit {
                break;
            }
            if entry < depth {
                if !self.hidden {
                    put(Part::between(of, whole, [entry, depth]));
                }
                entry = depth;
            }
            match event.kind {
                RayEventKind::Surface(rgba) => {
                    put(Part { surface: Some(rgba), ..Part::between(of, whole, [depth; 2]) });
                }
                RayEventKind::Hide => self.hidden = true,
                RayEventKind::Show => self.hidden = false,
            }
            self.next += 1;
        }
        if !self.hidden {
            put(Part::between(of, whole, [entry, exit]));
        }
    }
}

impl SegmentCutter {
    pub fn new() -> SegmentCutter {
        SegmentCutter {
            pixels: [Cursor::default(); PIXELS],
            lanes: std::array::from_fn(|_| Vec::new()),
            scratch: Vec::new(),
        }
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

    /// Takes the first `count` fragments of a batch, slices of a row, for [`SegmentCutter::fill`].
    pub fn take_slices(&mut self, frame: &FrameContext<'_>, batch: &Batch, count: usize) {
        let SegmentCutter { pixels, lanes, scratch } = self;
        for (lane, parts) in lanes.iter_mut().enumerate() {
            parts.clear();
            for k in (lane..count).step_by(TILE).filter(|&k| batch.length[k] > 0.0) {
                let cursor = &mut pixels[batch.pixel[k] as usize % PIXELS];
                cursor.cut(frame, (k, [batch.entry[k], batch.exit[k]]), |part| {
                    part.straighten(frame.axes, batch, scratch, &mut |piece| parts.push(piece));
                });
            }
        }
    }

    /// Fills a batch with the slices of parts from `first` on; returns its fragments, none at the end, and puts the colours of those that
    /// are surfaces into a list.
    pub fn fill(
        &self,
        first: usize,
        from: &Batch,
        frame: &FrameContext<'_>,
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
                        copy_part(part, from, frame, at, to);
                        surfaces.extend(part.surface.map(|rgba| (at, rgba)));
                    }
                    None => clear(at, frame.attribute_count(), to),
                }
            }
        }
        slices.len() * TILE
    }

    /// Cuts segment `k` of a batch whatever was cut before, and hands on the parts that are drawn.
    pub fn cut_alone(
        &mut self,
        frame: &FrameContext<'_>,
        pixel: [usize; 2],
        from: &Batch,
        k: usize,
        mut put: impl FnMut(Part),
    ) {
        let [next, end] = frame.events.map_or([0; 2], |events| events.range_of(pixel[0], pixel[1]));
        let mut alone = Cursor { next, end, hidden: false };
        alone.cut(frame, (k, [from.entry[k], from.exit[k]]), |part| {
            if part.surface.is_none() {
                part.straighten(frame.axes, from, &mut self.scratch, &mut put);
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

/// Puts a part in slot `at` of a batch.
pub(crate) fn copy_part(part: &Part, from: &Batch, frame: &FrameContext<'_>, at: usize, to: &mut Batch) {
    let Part { of: k, depths: [entry, exit], shares, .. } = *part;
    to.pixel[at] = from.pixel[k];
    (to.entry[at], to.exit[at]) = (entry, exit);
    to.length[at] = if part.surface.is_some() { 0.0 } else { from.length[k] * (shares[1] - shares[0]) };
    for a in 0..frame.attribute_count() {
        // A piece has the gradient of all of its part.
        let [start, end] = if a < frame.scalar_count { shares } else { part.whole };
        let (front, back) = (from.front[a][k], from.back[a][k]);
        to.front[a][at] = front + start * (back - front);
        to.back[a][at] = if end == 1.0 { back } else { front + end * (back - front) };
    }
    let curved = frame.axes.zip(part.ends);
    if let Some((axes, [front, back])) = curved {
        for axis in (0..2).filter(|axis| axes.curved.scale(*axis).is_curved()) {
            (to.front[axis][at], to.back[axis][at]) = (front[axis], back[axis]);
        }
    }
}
