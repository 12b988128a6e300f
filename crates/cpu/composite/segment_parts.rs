//! Parts of segments, in place of the whole: between surfaces and clips of their rays ([`voltet_optics::ray_events`]), whose colours take
//! their places among them; and, where an axis is logarithmic, straight pieces along it ([`voltet_optics::curved_axes`]).
//!
//! Segments that nothing cuts, by far the most, stay in their batch, and so does the one part that a clip leaves; along logarithmic axes they
//! are one straight piece or two, of which the second ones become a slice of their own. The parts of the others are shaded in a batch
//! of their own, and composited to one colour that takes the segment's place.

use crate::composite::accumulators::Fragment;
use crate::composite::frame::FrameContext;
use crate::composite::illumination;
use crate::composite::lane_axes::LaneAxes;
use crate::composite::stretches::StretchRecorder;
use crate::fragments::batch::{BATCH, Batch};
use crate::shade::light::Rays;
use crate::shade::shaded_batch::ShadedBatch;
use crate::tile::{PIXELS, TILE, TilePicture, TileRect};
use voltet_optics::curved_axes::{AxisCut, StraightPiece};
use voltet_optics::ray_events::{BAND, RayEvent, RayEventKind, RayEvents, composite_behind};
use voltet_simd::{Float, Kernel, Lanes, Mask, dispatch};

/// The rows of a tile are those of one band of events.
const _: () = assert!(BAND.is_multiple_of(TILE));

pub(crate) struct SegmentCutter {
    pixels: [Cursor; PIXELS],
    /// First row of the tile.
    top: usize,
    scratch: Vec<AxisCut>,
    /// Parts that are not shaded yet.
    parts: Batch,
    count: usize,
    /// Parts and surfaces, segment by segment, front to back.
    layers: Vec<CutFragment>,
    /// Colours of the segments that were cut, in order of their slots: premultiplied, with opacities; where the scene has one colour, the
    /// last is the optical depth, or the opacity after light.
    colors: Vec<(usize, [f32; 4])>,
    pub shaded: ShadedBatch,
    /// Parts that are drawn, each with its pixel, where stretches of rays are recorded.
    recorded: Vec<(usize, Fragment)>,
}

/// Cursor of a pixel among its events.
#[derive(Clone, Copy)]
struct Cursor {
    /// The next, and the end, among those of its band of rows.
    next: u32,
    end: u32,
    /// Depth of the next; infinite at the end.
    depth: f32,
    hidden: bool,
}

/// A part of a segment that is cut, or a surface among its parts.
struct CutFragment {
    slot: usize,
    /// A surface's colour, or none for the next part.
    surface: Option<[f32; 4]>,
}

/// A part of a segment, or a surface.
#[derive(Clone, Copy)]
struct Part {
    /// Index of the segment in its batch.
    of: usize,
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

    /// Values of an attribute at the part's ends, of a segment of a batch.
    fn ends_of(&self, batch: &Batch, attribute: usize, frame: &FrameContext<'_>) -> [f32; 2] {
        // A piece has the gradient of all of its part.
        let [start, end] = if attribute < frame.scalar_count { self.shares } else { self.whole };
        let (front, back) = (batch.front[attribute][self.of], batch.back[attribute][self.of]);
        [front + start * (back - front), if end == 1.0 { back } else { front + end * (back - front) }]
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
    /// Past the end of all events.
    const END: Cursor = Cursor { next: 0, end: 0, depth: f32::INFINITY, hidden: false };

    /// At the first event of a pixel.
    fn new(frame: &FrameContext<'_>, [i, j]: [usize; 2]) -> Cursor {
        let Some(events) = frame.events else { return Cursor::END };
        let [next, end] = events.range_of(i, j);
        let mut cursor = Cursor { next, end, ..Cursor::END };
        cursor.find_depth(frame, events.of_band(j));
        cursor
    }

    fn find_depth(&mut self, frame: &FrameContext<'_>, events: &[RayEvent]) {
        let next = events[..self.end as usize].get(self.next as usize);
        self.depth = next.map_or(f32::INFINITY, |event| depth_of(event, frame));
    }

    /// The one part that is left of a segment within which one clip begins or ends and nothing else is met; that is taken. None where there
    /// are more parts or surfaces, and nothing is taken.
    fn trim(
        &mut self,
        frame: &FrameContext<'_>,
        row: usize,
        (of, whole @ [entry, exit]): (usize, [f32; 2]),
    ) -> Option<Part> {
        let events = &frame.events?.of_band(row)[..self.end as usize];
        let (&event, rest) = events[self.next as usize..].split_first()?;
        let is_last = rest.first().is_none_or(|event| exit <= depth_of(event, frame));
        if !is_last || matches!(event.kind, RayEventKind::Surface(_)) {
            return None;
        }
        let depth = self.depth.max(entry);
        let was_hidden = std::mem::replace(&mut self.hidden, event.kind == RayEventKind::Hide);
        self.next += 1;
        self.find_depth(frame, events);
        let from = if was_hidden { depth } else { entry };
        let to = if self.hidden { depth } else { exit };
        Some(Part::between(of, whole, [from, to.max(from)]))
    }

    /// Cuts a segment at its pixel's events, and takes these and those before it. `row`: one of its band; `of`: its index in the batch.
    fn cut(
        &mut self,
        frame: &FrameContext<'_>,
        row: usize,
        (of, whole): (usize, [f32; 2]),
        mut put: impl FnMut(Part),
    ) {
        let events = frame.events.map_or(&[][..], |events| events.of_band(row));
        let [mut entry, exit] = whole;
        while self.depth < exit {
            let depth = self.depth;
            if entry < depth {
                if !self.hidden {
                    put(Part::between(of, whole, [entry, depth]));
                }
                entry = depth;
            }
            match events[self.next as usize].kind {
                RayEventKind::Surface(rgba) => {
                    put(Part { surface: Some(rgba), ..Part::between(of, whole, [depth; 2]) });
                }
                RayEventKind::Hide => self.hidden = true,
                RayEventKind::Show => self.hidden = false,
            }
            self.next += 1;
            self.find_depth(frame, events);
        }
        if !self.hidden {
            put(Part::between(of, whole, [entry, exit]));
        }
    }
}

impl SegmentCutter {
    pub fn new(frame: &FrameContext<'_>) -> SegmentCutter {
        SegmentCutter {
            pixels: [Cursor::END; PIXELS],
            top: 0,
            scratch: Vec::new(),
            parts: Batch::new(frame.attribute_count(), frame.scalar_count),
            count: 0,
            layers: Vec::new(),
            colors: Vec::new(),
            shaded: ShadedBatch::new(),
            recorded: Vec::new(),
        }
    }

    /// Goes to the beginning of a tile's rays.
    pub fn begin(&mut self, frame: &FrameContext<'_>, rect: TileRect) {
        self.pixels = [Cursor::END; PIXELS];
        self.top = rect.top;
        for j in 0..rect.size[1] {
            for i in 0..rect.size[0] {
                self.pixels[j * TILE + i] = Cursor::new(frame, [rect.left + i, rect.top + j]);
            }
        }
    }

    /// Takes the segments that are cut, and those that are hidden, out of the first `count` of a batch, slices of a row, and closes up the
    /// slices that are left. Returns how many segments these have, and the slots and colours of those that were cut.
    pub fn cut_row(
        &mut self,
        frame: &FrameContext<'_>,
        batch: &mut Batch,
        count: usize,
        rays: &Rays,
    ) -> (usize, &[(usize, [f32; 4])]) {
        self.forget();
        let pixels = pixels_of(batch, count);
        let kept = dispatch(frame.lanes, CutRow { cutter: self, frame, batch, count, pixels, rays });
        (kept, self.finish(frame, rays))
    }

    /// Shades the parts that are left; slots and colours of the segments that were cut.
    pub fn finish(&mut self, frame: &FrameContext<'_>, rays: &Rays) -> &[(usize, [f32; 4])] {
        self.shade(frame, rays);
        &self.colors
    }

    /// Forgets the segments that were cut.
    pub fn forget(&mut self) {
        self.colors.clear();
    }

    /// Depth of a pixel's next event.
    pub fn next_depth(&self, pixel: usize) -> f32 {
        self.pixels[pixel].depth
    }

    /// Factor of the lengths of a pixel's next segments: 0 where they are hidden.
    pub fn shown(&self, pixel: usize) -> f32 {
        f32::from(!self.pixels[pixel].hidden)
    }

    /// Leaves the one part of segment `k` of a batch, of a pixel, that its events leave; false if they leave more.
    fn trim(&mut self, frame: &FrameContext<'_>, batch: &mut Batch, k: usize, pixel: usize) -> bool {
        let whole = [batch.entry[k], batch.exit[k]];
        let Some(part) = self.pixels[pixel].trim(frame, self.top, (k, whole)) else { return false };
        for a in 0..frame.attribute_count() {
            let [front, back] = part.ends_of(batch, a, frame);
            (batch.front[a][k], batch.back[a][k]) = (front, back);
        }
        (batch.entry[k], batch.exit[k]) = part.depths.into();
        batch.length[k] *= part.shares[1] - part.shares[0];
        true
    }

    /// Cuts a segment of a batch, of a pixel, whose slot is now the first and will be the second.
    pub fn cut(
        &mut self,
        frame: &FrameContext<'_>,
        batch: &Batch,
        [k, slot]: [usize; 2],
        pixel: usize,
        rays: &Rays,
    ) {
        let mut cursor = self.pixels[pixel];
        let mut scratch = std::mem::take(&mut self.scratch);
        cursor.cut(frame, self.top, (k, [batch.entry[k], batch.exit[k]]), |part| {
            part.straighten(frame.axes, batch, &mut scratch, &mut |piece| {
                if piece.surface.is_none() {
                    if self.count == BATCH {
                        self.shade(frame, rays);
                    }
                    copy_part(&piece, batch, frame, self.count, &mut self.parts);
                    self.count += 1;
                }
                self.layers.push(CutFragment { slot, surface: piece.surface });
            });
        });
        self.scratch = scratch;
        self.pixels[pixel] = cursor;
    }

    /// Hands on the parts that were drawn.
    pub fn hand_on(&mut self, recorder: &mut StretchRecorder) {
        self.recorded.drain(..).for_each(|(pixel, fragment)| recorder.push(pixel, fragment));
    }

    /// Shades the parts, and composites the layers of each segment.
    fn shade(&mut self, frame: &FrameContext<'_>, rays: &Rays) {
        let SegmentCutter { parts: batch, layers, colors, shaded, recorded, .. } = self;
        let count = std::mem::take(&mut self.count);
        let adds = frame.shader.one_color.is_some() && frame.shader.surface.is_none();
        if count > 0 {
            illumination::shade(frame, batch, count, rays, shaded);
        }
        if frame.records_stretches {
            let drawn = (0..count).filter(|&k| batch.length[k] > 0.0);
            recorded
                .extend(drawn.map(|k| (batch.pixel[k] as usize % PIXELS, Fragment::of(batch, shaded, k))));
        }
        let mut next = 0..count;
        for CutFragment { slot, surface } in layers.drain(..) {
            let rgba = match surface {
                Some(rgba) => rgba,
                None => match next.next() {
                    Some(k) if batch.length[k] > 0.0 => match frame.shader.one_color {
                        Some(_) => [0.0, 0.0, 0.0, shaded.depth[k]],
                        None => shaded.rgba.each_ref().map(|column| column[k]),
                    },
                    _ => [0.0; 4],
                },
            };
            match colors.last_mut() {
                Some((last, front)) if *last == slot => {
                    let transmittance = if adds { 1.0 } else { 1.0 - front[3] };
                    front.iter_mut().zip(rgba).for_each(|(front, behind)| *front += transmittance * behind);
                }
                _ => colors.push((slot, rgba)),
            }
        }
    }

    /// Takes segment `k` of a batch out of it, whatever was cut before, if it is cut or hidden. Hands on the parts that are drawn, when they fill a batch.
    pub fn cut_alone(
        &mut self,
        frame: &FrameContext<'_>,
        pixel: [usize; 2],
        batch: &mut Batch,
        k: usize,
        mut shade: impl FnMut(&Batch, usize),
    ) {
        let mut alone = Cursor::new(frame, pixel);
        if frame.axes.is_none() && batch.exit[k] <= alone.depth {
            return;
        }
        let SegmentCutter { scratch, parts, count, .. } = self;
        alone.cut(frame, pixel[1], (k, [batch.entry[k], batch.exit[k]]), |part| {
            if part.surface.is_none() {
                part.straighten(frame.axes, batch, scratch, &mut |piece| {
                    copy_part(&piece, batch, frame, *count, parts);
                    *count += 1;
                    if *count == BATCH {
                        shade(parts, std::mem::take(count));
                    }
                });
            }
        });
        batch.length[k] = 0.0;
    }

    /// Hands on the parts that are left of [`SegmentCutter::cut_alone`].
    pub fn end_alone(&mut self, shade: impl FnOnce(&Batch, usize)) {
        shade(&self.parts, std::mem::take(&mut self.count));
    }

    /// Composites the surfaces that are left behind a tile's pixels; none is left.
    pub fn end(&mut self, events: &RayEvents, picture: &mut TilePicture) {
        let events = events.of_band(self.top);
        for (cursor, pixel) in self.pixels.iter_mut().zip(picture) {
            composite_behind(&events[cursor.next as usize..cursor.end as usize], pixel);
            *cursor = Cursor::END;
        }
    }
}

/// Cutting of a row's slices, see [`SegmentCutter::cut_row`]: most are passed over.
struct CutRow<'a, 'f> {
    cutter: &'a mut SegmentCutter,
    frame: &'a FrameContext<'f>,
    batch: &'a mut Batch,
    count: usize,
    pixels: [usize; TILE],
    rays: &'a Rays,
}

impl Kernel<usize> for CutRow<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes>(mut self) -> usize {
        let mut depths = self.pixels.map(|pixel| self.cutter.next_depth(pixel));
        let mut shown = self.pixels.map(|pixel| self.cutter.shown(pixel));
        let (zero, mut kept) = (L::F::splat(0.0), 0);
        for first in (0..self.count).step_by(TILE) {
            let mut meets = 0;
            for lane in (0..TILE).step_by(L::WIDTH) {
                let at = first + lane;
                let (length, exit) =
                    (L::F::load(&self.batch.length[at..]), L::F::load(&self.batch.exit[at..]));
                let is_met = zero.lt(length).and(L::F::load(&depths[lane..]).lt(exit));
                meets |= is_met.bits() << lane;
            }
            let (mut factors, mut is_drawn) = (shown, false);
            if meets != 0 {
                is_drawn = self.cut_slice([first, kept], meets, &mut factors);
                depths = self.pixels.map(|pixel| self.cutter.next_depth(pixel));
                shown = self.pixels.map(|pixel| self.cutter.shown(pixel));
            }
            for lane in (0..TILE).step_by(L::WIDTH) {
                let lengths = &mut self.batch.length[first + lane..];
                let length = L::F::load(lengths) * L::F::load(&factors[lane..]);
                length.store(lengths);
                is_drawn |= zero.lt(length).any();
            }
            if is_drawn {
                if kept < first {
                    self.batch.move_slice(first, kept);
                }
                kept += TILE;
            }
        }
        kept
    }
}

impl CutRow<'_, '_> {
    /// Cuts segments of a slice, by bits of their lanes, whose first slot is now the first and will be the second, and sets the factors of
    /// their lengths. True if any was taken out.
    fn cut_slice(&mut self, [first, kept]: [usize; 2], meets: u32, factors: &mut [f32; TILE]) -> bool {
        let CutRow { cutter, frame, batch, pixels, rays, .. } = self;
        let mut is_cut = false;
        for lane in (0..TILE).filter(|lane| meets >> lane & 1 == 1) {
            factors[lane] = 1.0;
            if !cutter.trim(frame, batch, first + lane, pixels[lane]) {
                cutter.cut(frame, batch, [first, kept].map(|first| first + lane), pixels[lane], rays);
                (is_cut, factors[lane]) = (true, 0.0);
            }
        }
        is_cut
    }
}

/// Pixel of each lane of a row's slices. A lane's segments are of one pixel, which slots without a segment need not name.
pub(super) fn pixels_of(batch: &Batch, count: usize) -> [usize; TILE] {
    std::array::from_fn(|lane| {
        let first = (lane..count).step_by(TILE).find(|&k| batch.length[k] > 0.0);
        first.map_or(0, |k| batch.pixel[k] as usize % PIXELS)
    })
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

/// Puts a part in slot `at` of a batch.
fn copy_part(part: &Part, from: &Batch, frame: &FrameContext<'_>, at: usize, to: &mut Batch) {
    let Part { of: k, depths, shares, .. } = *part;
    to.pixel[at] = from.pixel[k];
    (to.entry[at], to.exit[at]) = depths.into();
    to.length[at] = from.length[k] * (shares[1] - shares[0]);
    for a in 0..frame.attribute_count() {
        let [front, back] = part.ends_of(from, a, frame);
        (to.front[a][at], to.back[a][at]) = (front, back);
    }
    let curved = frame.axes.zip(part.ends);
    if let Some((axes, [front, back])) = curved {
        for axis in (0..2).filter(|axis| axes.curved.scale(*axis).is_curved()) {
            (to.front[axis][at], to.back[axis][at]) = (front[axis], back[axis]);
        }
    }
}
