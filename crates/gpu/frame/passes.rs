//! A frame: windows of the picture that fit the device's memory, the samples of each, and the passes over them, bound to their
//! buffers.

use crate::bound_pass::{Binder, folded};
use crate::device::pipelines::{Bound, BoundPass, Program, in_order};
use crate::device::{Device, PendingReadback, Timing};
use crate::frame::inputs::FrameInputs;
use crate::frame::output::{FrameOutput, Readback, counters};
use crate::frame::renderer::{FrameBuffers, ReadbackBuffers};
use crate::grid::GrowingSplitBuffer;
use crate::raster::{Blending, OUTLINES, Raster, TRIANGLES, Target};
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::{Error, Result, counted};
use voltet_optics::engine::Stage;
use voltet_shaders::{CompositorProgram, FramePass, GridArray, PlacementRecord, ViewRecord, cells_read};
use wgpu::{Buffer, BufferUsages, CommandEncoder, SubmissionIndex};

enum CompositorPasses {
    Tiles(BoundPass),
    Raster(Box<Raster>),
}

pub(crate) struct Passes<'a> {
    device: &'a Device,
    points: BoundPass,
    attributes: Vec<BoundPass>,
    /// Cells, and for tiles starts, lists, sort.
    lists: Vec<BoundPass>,
    compositor: CompositorPasses,
    view: Buffer,
    counts: Buffer,
    entries: Buffer,
    /// Words behind the lists, by sample.
    events: &'a [Vec<[u32; 2]>],
    pixels: Buffer,
    returned: Buffer,
    returned_counts: Buffer,
    picture_bytes: u64,
    keeps_states: bool,
}

pub(crate) fn counts_of(bytes: &[u8]) -> [u32; counters::ALL] {
    std::array::from_fn(|k| bytemuck::pod_read_unaligned(&bytes[4 * k..4 * k + 4]))
}

const COUNTS_BYTES: u64 = counters::ALL as u64 * 4;

/// Index behind them at which those of the tiles begin: `COUNTED` of `passes/view.wgsl`.
const TILES_COUNTED_AT: u64 = 16 * 4;

impl<'a> Passes<'a> {
    /// Makes what is missing of the buffers, and binds it.
    pub fn new(
        frame: &'a FrameInputs,
        window: [u32; 4],
        capacity: u32,
        buffers: &mut FrameBuffers,
        returning: &mut ReadbackBuffers,
    ) -> Result<Passes<'a>> {
        let (device, grid) = (frame.device(), &frame.renderer.grid);
        let (sizes, layout) = (&frame.sizes, &frame.shader_key.layout);
        let tiles = u64::from(window[2]) * u64::from(window[3]);
        let picture_bytes = frame.picture_bytes(window);

        let storage = |what: &'static str| move |size: u64| device.storage(what, size);
        let parted = |growing: &mut GrowingSplitBuffer, array| {
            growing.at_least(device, array, sizes, layout.parts(array))
        };
        let usage = BufferUsages::UNIFORM | BufferUsages::COPY_DST;
        let view = device.buffer("the view", size_of::<ViewRecord>() as u64, usage)?;
        let binder = Binder {
            grid,
            view: &view,
            layout,
            seen: parted(&mut buffers.seen, GridArray::Seen)?,
            attributes: parted(&mut buffers.attributes, GridArray::Attributes)?,
            bounds: parted(&mut buffers.bounds, GridArray::Bounds)?,
        };
        let events = frame.events.iter().map(|events| events.len() as u64).max().unwrap_or(0);
        let entries =
            buffers.entries.at_least((u64::from(capacity) + events) * 8, storage("the tiles' lists"))?;
        let pixels_bytes = frame.window_bytes(window, buffers.keeps_states);
        let pixels = buffers.picture.at_least(pixels_bytes, storage("the picture"))?;
        let counts = buffers.counts.at_least(TILES_COUNTED_AT + tiles * 4, storage("the tiles' counts"))?;
        let mapped = BufferUsages::MAP_READ | BufferUsages::COPY_DST;
        let back = |size: u64| device.buffer("the picture on its way back", size, mapped);
        let returned = returning.picture.at_least(picture_bytes, back)?;
        let returned_counts = returning.counts.at_least(COUNTS_BYTES, back)?;
        let scene = device.uniform("the scene", &frame.scene)?;
        let support = device.upload("the widgets' supports", frame.support.len(), |i| frame.support[i])?;

        let most = device.limits.max_compute_workgroups_per_dimension;
        let over_points = folded(grid.point_count, most);
        let over_cells = folded(grid.cell_count, most);
        let over_tiles = [window[2], window[3], 1];
        let scalar = &frame.scalar;
        let step = |pass, workgroups, constants, own: &[&Buffer]| {
            binder.step(pass, workgroups, constants, own, scalar)
        };
        let stride = ("ATTRIBUTE_STRIDE", sizes.stride as f64);
        let points = step(FramePass::Points, over_points, vec![], &[])?;
        let mut attributes = Vec::new();
        for (slot, (stored, offset)) in frame.attributes.iter().enumerate() {
            let record = PlacementRecord { offset: *offset, slot: slot as u32, padding: 0 };
            let placement = device.uniform("the place of a value", bytemuck::bytes_of(&record))?;
            let own = [&placement];
            attributes.push(binder.step(FramePass::Attribute, over_points, vec![stride], &own, stored)?);
        }
        let reads_g = if frame.shader_key.reads_gradient_magnitude { 1.0 } else { 0.0 };
        let blended = match frame.shader_key.compositor {
            CompositorProgram::Raster(blend) => Some((OUTLINES, blend)),
            CompositorProgram::Triangles(blend) => Some((TRIANGLES, blend)),
            CompositorProgram::None | CompositorProgram::Segments | CompositorProgram::Tiles(_) => None,
        };
        let lists_tiles = if blended.is_some() { 0.0 } else { 1.0 };
        let constants = vec![stride, ("reads_g", reads_g), ("lists_tiles", lists_tiles)];
        let mut lists = vec![step(FramePass::Cells, over_cells, constants, &[&support, &counts])?];

        let tables = buffers.tables.update(
            device,
            &frame.tables,
            &frame.shader_key,
            &frame.shading,
            &frame.numbers,
        )?;
        let mut read = in_order([(Bound::Uniform, &scene)]);
        for (name, binding) in frame.shader_key.storage_buffers() {
            read.push((binding, Bound::Read, tables.named(&name)?.as_entire_binding()));
        }
        let in_grid = binder.bindings(cells_read(sizes.stride as usize), scalar);
        let compositor = if let Some((primitive, blend)) = blended {
            let blending = Blending {
                shader: &frame.compositor,
                primitive,
                target: Target::new(blend, frame.shader_key.depths_add_up(), device.blends_32_bits),
                sorted: frame.sorted,
                window,
                scalar,
                scene: &read,
                in_grid: &in_grid,
                pixels: &pixels,
            };
            CompositorPasses::Raster(Box::new(Raster::new(&blending, &mut buffers.raster, &binder)?))
        } else {
            let own = [&counts, &entries, &pixels];
            lists.push(step(FramePass::Starts, [1; 3], vec![], &own)?);
            lists.push(step(FramePass::Lists, over_cells, vec![], &own)?);
            if frame.sorted {
                lists.push(step(FramePass::Sort, over_tiles, vec![], &own)?);
            }
            CompositorPasses::Tiles(device.pass(&Program {
                name: ("composite_tiles", Stage::Composite),
                shader: &frame.compositor,
                // No transparency is less than this.
                constants: if frame.pending.exhaustive { vec![("OPAQUE", -1.0)] } else { vec![] },
                groups: [&read, &binder.own(None, &own), &in_grid],
                workgroups: over_tiles,
            })?)
        };
        Ok(Passes {
            device,
            points,
            attributes,
            lists,
            compositor,
            view,
            counts,
            entries,
            events: &frame.events,
            pixels,
            returned,
            returned_counts,
            picture_bytes,
            keeps_states: buffers.keeps_states,
        })
    }

    /// All passes of a sample, by its number. The first one of a pixel clears the counts.
    pub fn submit(&self, number: usize, record: &ViewRecord, timing: &mut Timing) -> Result<SubmissionIndex> {
        self.encode(record, timing, |encoder, timing| {
            if let Some(events) = self.events.get(number) {
                self.device.write(
                    &self.entries,
                    u64::from(record.capacity) * 8,
                    bytemuck::cast_slice(events),
                );
            }
            let kept = if record.is_first == 1 { 0 } else { TILES_COUNTED_AT };
            encoder.clear_buffer(&self.counts, kept, None);
            self.points.run(encoder, timing);
            if record.is_first == 1 {
                self.attributes.iter().for_each(|step| step.run(encoder, timing));
            }
            self.lists.iter().for_each(|step| step.run(encoder, timing));
        })
    }

    fn encode(
        &self,
        record: &ViewRecord,
        timing: &mut Timing,
        before: impl FnOnce(&mut CommandEncoder, &mut Timing),
    ) -> Result<SubmissionIndex> {
        let submitted = self.device.submit("the frame", |encoder| {
            self.device.write(&self.view, 0, bytemuck::bytes_of(record));
            before(encoder, timing);
            // Without states to go on from, one unfinished sample is enough for the caller to begin anew.
            if self.keeps_states {
                encoder.clear_buffer(&self.counts, 4 * counters::UNFINISHED as u64, Some(4));
            }
            match &self.compositor {
                CompositorPasses::Tiles(tiles) => tiles.run(encoder, timing),
                CompositorPasses::Raster(raster) => raster.encode(self.device, encoder, timing),
            }
            timing.end(encoder);
            encoder.copy_buffer_to_buffer(&self.counts, 0, &self.returned_counts, 0, COUNTS_BYTES);
            // Where tiles go on, this is seldom the last time.
            if !self.keeps_states {
                self.copy_pixels(encoder);
            }
        })?;
        timing.take(self.device)?;
        Ok(submitted)
    }

    /// The counts up to the last submission.
    pub fn counts(&self) -> Result<[u32; counters::ALL]> {
        self.device.read("the counts", &self.returned_counts, COUNTS_BYTES, counts_of)
    }

    /// Readbacks of the last submission: the counts and, where no states are kept, the pixels.
    pub fn send(&self, last: Option<SubmissionIndex>) -> [PendingReadback; 2] {
        let sent = |what, buffer, bytes| self.device.send(what, buffer, bytes, last.clone());
        [
            sent("the counts", &self.returned_counts, COUNTS_BYTES),
            sent("the picture", &self.returned, self.picture_bytes),
        ]
    }

    fn copy_pixels(&self, encoder: &mut CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.pixels, 0, &self.returned, 0, self.picture_bytes);
    }

    /// The window's pixels after the last submission.
    pub fn picture(&self, take: impl FnOnce(&[u8])) -> Result<()> {
        if self.keeps_states {
            self.device.submit("the frame", |encoder| self.copy_pixels(encoder))?;
        }
        self.device.read("the picture", &self.returned, self.picture_bytes, take)
    }
}

/// Entries that lists are given room for before their lengths are known.
const CAPACITY_AT_FIRST: u32 = 1 << 16;

/// Work that a tile does in one dispatch, in cells tested: under a tenth of a second on a slow device, well within the
/// seconds that a system grants.
const BUDGET: u32 = 1 << 22;

/// Like `BUDGET`, on a software driver: Mesa's ends loops after 65,535 rounds in all, of which a segment takes several. Where they
/// were too many, the shader says so, and the frame is drawn again with a quarter of the budget.
const BUDGET_SOFTWARE: u32 = 1 << 13;

/// Less makes no difference: a chunk of cells is gone through without a pause.
const MIN_BUDGET: u32 = 1 << 6;

/// Dispatches in which every tile gets further, so that far fewer suffice.
const MAX_DISPATCHES: u32 = 100_000;

/// Cells of one tile that a software driver sorts within those rounds.
const LONGEST_SOFTWARE: u32 = 20_000;

impl FrameInputs<'_> {
    /// Draws the whole picture. Errors: memory, a lost device, a stopped run.
    pub fn draw(self, progress: &dyn Progress) -> Result<FrameOutput> {
        let [width, height] = self.samples[0].size;
        let mut picture = Picture::transparent(width as usize, height as usize);
        let mut all = [0u64; counters::ALL];
        let mut timing = Timing::new(self.device())?;
        let mut open = vec![self.whole_window()];
        let mut is_first = true;
        while let Some(window) = open.pop() {
            progress.check_cancelled()?;
            let counts = match self.fits(window) {
                true => self.draw_window(window, &mut picture, &mut timing)?,
                false => None,
            };
            let Some(counts) = counts else {
                open.extend(halves(window)?);
                continue;
            };
            for (place, (sum, count)) in all.iter_mut().zip(counts).enumerate() {
                if is_first || !counters::OF_CELLS.contains(&place) {
                    *sum += u64::from(count);
                }
            }
            is_first = false;
        }
        Ok(self.pending.with(Readback { picture, counts: all, passes: timing.sums }))
    }

    /// The window of the whole picture, in tiles.
    fn whole_window(&self) -> [u32; 4] {
        let [columns, rows] = self.samples[0].size.map(|n| n.div_ceil(ViewRecord::TILE));
        [0, 0, columns, rows]
    }

    /// True if the device can hold a window's pixels.
    fn fits(&self, window: [u32; 4]) -> bool {
        let limits = &self.device().limits;
        let side = window[2].max(window[3]) * ViewRecord::TILE;
        self.window_bytes(window, self.keeps_states()) <= self.device().most_bytes()
            && side <= limits.max_texture_dimension_2d
    }

    /// True if tiles stop within their lists and go on, by former frames of the grid.
    fn keeps_states(&self) -> bool {
        self.renderer.buffers().keeps_states
    }

    /// Bytes of a window's pixels with their states: a state is two vectors, or three with events; a pixel is one.
    pub fn window_bytes(&self, window: [u32; 4], keeps_states: bool) -> u64 {
        let state = if self.events.is_empty() { 2 } else { 3 };
        self.picture_bytes(window) * if keeps_states { 1 + state } else { 1 }
    }

    /// Draws one window; `None` where its lists or its pixels' states do not fit one binding, or a cell has more tiles in it
    /// than a driver goes through.
    fn draw_window(
        &self,
        window: [u32; 4],
        picture: &mut Picture,
        timing: &mut Timing,
    ) -> Result<Option<[u32; counters::ALL]>> {
        let device = self.device();
        let most = self.most_entries();
        let mut buffers = self.renderer.buffers();
        loop {
            let (capacity, budget) = self.room(&mut buffers);
            let counts = self.run(window, capacity, budget, &mut buffers, picture, timing)?;
            let needed = counts[counters::ENTRIES];
            if needed > most || counts[counters::CELLS_CUT_SHORT] != 0 {
                return Ok(None);
            }
            if device.is_software && self.sorted && counts[counters::LONGEST] > LONGEST_SOFTWARE {
                let what = "a software driver does not sort so many cells of one tile";
                return Err(Error::new(ErrorKind::CrowdedTile, what)
                    .got(counts[counters::LONGEST])
                    .expected(format!("at most {LONGEST_SOFTWARE}, or engine = \"cpu\"")));
            }
            if needed > capacity {
                // Some room for the next frame.
                buffers.capacity = needed.saturating_add(needed / 4).min(most);
            } else if counts[counters::PIXELS_CUT_SHORT] != 0 {
                if budget <= MIN_BUDGET {
                    return Err(self.ends_loops(counts[counters::PIXELS_CUT_SHORT]));
                }
                buffers.budget = Some(budget / 4);
            } else if counts[counters::UNFINISHED] != 0 {
                buffers.keeps_states = true;
                if self.window_bytes(window, true) > device.most_bytes() {
                    return Ok(None);
                }
            } else {
                return Ok(Some(counts));
            }
        }
    }

    fn ends_loops(&self, pixels: u32) -> Error {
        let name = &self.device().name;
        Error::run(format!("{name} ends loops before the segments of 64 cells are integrated"))
            .got(format!("{} cut short", counted(pixels, "pixel")))
            .expected(
                "fewer samples of a segment, fewer control points, another adapter, or engine = \"cpu\"",
            )
    }

    /// Entries that lists can have in one binding.
    fn most_entries(&self) -> u32 {
        (self.device().most_bytes() / 8).min(u64::from(u32::MAX)) as u32
    }

    /// Entries that lists have room for, and the work of a tile in one dispatch, as former frames found out.
    fn room(&self, buffers: &mut FrameBuffers) -> (u32, u32) {
        buffers.capacity = buffers.capacity.max(CAPACITY_AT_FIRST.min(self.most_entries()));
        let budget = if self.device().is_software { BUDGET_SOFTWARE } else { BUDGET };
        (buffers.capacity, *buffers.budget.get_or_insert(budget))
    }

    /// Uniform of the passes for a sample.
    fn record(
        &self,
        number: usize,
        sample: &ViewRecord,
        window: [u32; 4],
        capacity: u32,
        budget: u32,
    ) -> ViewRecord {
        let weight = 1.0 / self.samples.len() as f32;
        ViewRecord { window, capacity, weight, is_first: u32::from(number == 0), budget, ..*sample }
    }

    /// Submits the whole picture without waiting for it. `None` where it has to be drawn in parts, whose numbers come back in
    /// between. Errors: memory; a lost device.
    pub fn submit(&self, returning: &mut ReadbackBuffers) -> Result<Option<SubmittedPicture>> {
        let [width, height] = self.samples[0].size;
        let window = self.whole_window();
        if !self.fits(window) || self.keeps_states() {
            return Ok(None);
        }
        let mut buffers = self.renderer.buffers();
        let (capacity, budget) = self.room(&mut buffers);
        let passes = Passes::new(self, window, capacity, &mut buffers, returning)?;
        let mut last = None;
        for (number, sample) in self.samples.iter().enumerate() {
            let record = self.record(number, sample, window, capacity, budget);
            last = Some(passes.submit(number, &record, &mut Timing::default())?);
        }
        let longest = if self.device().is_software && self.sorted { LONGEST_SOFTWARE } else { u32::MAX };
        Ok(Some(SubmittedPicture {
            sent: passes.send(last),
            size: [width, height],
            window,
            capacity,
            longest,
        }))
    }

    /// Runs all passes for all samples over a window, and copies its pixels to the picture.
    fn run(
        &self,
        window: [u32; 4],
        capacity: u32,
        budget: u32,
        buffers: &mut FrameBuffers,
        picture: &mut Picture,
        timing: &mut Timing,
    ) -> Result<[u32; counters::ALL]> {
        let device = self.device();
        let goes_on = buffers.keeps_states;
        let mut returning = std::mem::take(&mut buffers.returned);
        let passes = Passes::new(self, window, capacity, buffers, &mut returning);
        buffers.returned = returning;
        let passes = passes?;
        let mut counted = [0; counters::ALL];
        let is_right = |counted: &[u32; counters::ALL]| is_right(counted, capacity);
        for (number, sample) in self.samples.iter().enumerate() {
            let mut record = self.record(number, sample, window, capacity, budget);
            passes.submit(number, &record, timing)?;
            record.goes_on = 1;
            // Without states a dispatch cannot go on: the caller finds that out from the counts.
            if goes_on {
                counted = passes.counts()?;
                let mut dispatches = 0;
                while counted[counters::UNFINISHED] != 0 && is_right(&counted) {
                    dispatches += 1;
                    if dispatches > MAX_DISPATCHES {
                        return Err(Error::run(format!(
                            "{} does not come to an end with the tiles",
                            device.name
                        ))
                        .got(format!("{} tiles that go on", counted[counters::UNFINISHED]))
                        .expected("another adapter, or engine = \"cpu\""));
                    }
                    // The tiles alone, which go on where they stopped.
                    passes.encode(&record, timing, |_, _| {})?;
                    counted = passes.counts()?;
                }
                if !is_right(&counted) {
                    break;
                }
            }
        }
        if !goes_on {
            counted = passes.counts()?;
        }
        if is_right(&counted) && counted[counters::UNFINISHED] == 0 {
            passes.picture(|bytes| put_window(picture, window, bytes))?;
        }
        Ok(counted)
    }
}

/// True if a frame came to its end but for tiles that go on: lists that had room, and loops that nothing ended.
fn is_right(counted: &[u32; counters::ALL], capacity: u32) -> bool {
    let cut_short = counted[counters::CELLS_CUT_SHORT] + counted[counters::PIXELS_CUT_SHORT];
    counted[counters::ENTRIES] <= capacity && cut_short == 0
}

/// A submitted picture that was not read back yet.
pub(crate) struct SubmittedPicture {
    sent: [PendingReadback; 2],
    size: [u32; 2],
    window: [u32; 4],
    capacity: u32,
    /// Cells of one tile that are put in order, at most.
    longest: u32,
}

impl SubmittedPicture {
    /// The picture; `None` where it has to be drawn again, with more room. Errors: a lost device.
    pub fn finish(self, device: &Device) -> Result<Option<Readback>> {
        let [counts, pixels] = self.sent;
        let counted = counts.take(device, counts_of)?;
        let mut picture = Picture::transparent(self.size[0] as usize, self.size[1] as usize);
        pixels.take(device, |bytes| put_window(&mut picture, self.window, bytes))?;
        let is_whole = is_right(&counted, self.capacity)
            && counted[counters::UNFINISHED] == 0
            && counted[counters::LONGEST] <= self.longest;
        let counts = counted.map(u64::from);
        Ok(is_whole.then_some(Readback { picture, counts, passes: Vec::new() }))
    }
}

/// A window cut in two along its longer side.
fn halves([x, y, width, height]: [u32; 4]) -> Result<[[u32; 4]; 2]> {
    if width == 1 && height == 1 {
        let what = "the list of one tile of the picture does not fit one binding of the device";
        return Err(Error::new(ErrorKind::CrowdedTile, what)
            .expected("a closer view, a smaller grid, or engine = \"cpu\""));
    }
    Ok(if width >= height {
        let half = width / 2;
        [[x, y, half, height], [x + half, y, width - half, height]]
    } else {
        let half = height / 2;
        [[x, y, width, half], [x, y + half, width, height - half]]
    })
}

/// Copies a window's pixels to their place.
fn put_window(picture: &mut Picture, window: [u32; 4], bytes: &[u8]) {
    let [left, top, width, height] = window.map(|n| (n * ViewRecord::TILE) as usize);
    let right = (left + width).min(picture.width);
    for row in 0..height.min(picture.height.saturating_sub(top)) {
        let from = row * width * 16;
        let pixels = bytes[from..from + (right - left) * 16].chunks_exact(16);
        let start = (top + row) * picture.width + left;
        for (pixel, bytes) in picture.rgba[start..start + right - left].iter_mut().zip(pixels) {
            *pixel = bytemuck::pod_read_unaligned(bytes);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_are_halved_down_to_a_tile() {
        let mut open = vec![[0, 0, 5, 3]];
        let mut tiles = Vec::new();
        while let Some(window) = open.pop() {
            match halves(window) {
                Ok(both) => open.extend(both),
                Err(_) => tiles.push([window[0], window[1]]),
            }
        }
        tiles.sort_unstable();
        let every: Vec<[u32; 2]> = (0..5).flat_map(|x| (0..3).map(move |y| [x, y])).collect();
        assert_eq!(tiles, every);
    }
}
