//! Draws a volume on a device: as requested, blended along the faces of its cells, or by tiles in place of that; at once, or
//! submitted and collected once it is finished, so that neither the caller nor the device blocks the other.
//!
//! A device does what is submitted in turn, so the frames of a grid share all buffers but those that they come back by.

use crate::frame::inputs::{can_serve, compositing, inputs};
use crate::frame::output::{FaceOrderReport, FrameOutput, OrderCheckReport, PendingStats};
use crate::frame::passes::SubmittedPicture;
use crate::frame::renderer::{ReadbackBuffers, Renderer};
use std::sync::Arc;
use std::time::Instant;
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::visibility::{FaceOrder, disorder};
use voltet_core::{Error, Result};
use voltet_optics::engine::{Accumulation, Compositor, OrderCheck, RenderOptions, Stage, StageTiming};
use voltet_optics::scene::Scene;
use voltet_optics::shading::Ordering;
use voltet_shaders::ViewRecord;

/// Draws a scene of the volume that `renderer` was made from. What blends draws an exact order where the cells have one along
/// their faces, and where the check that is asked for bears it out; else tiles do.
///
/// Errors: what the device has no shader for, cannot hold in 32 bits, or has more parts than it binds; memory; a lost device; a
/// stopped run.
pub fn draw(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    match find_order(renderer, scene, options)? {
        Ok(order) => {
            let found = order.as_ref().map(|(order, _)| order);
            let output = inputs(renderer, scene, options, found)?.draw(progress)?;
            check(renderer, scene, options, order, output, progress)
        }
        Err(why) => tiles_instead(renderer, scene, options, why, progress),
    }
}

/// An order, and the seconds that it took to find where it was not there.
type TimedFaceOrder = (Arc<FaceOrder>, Option<f64>);

/// The order along the faces of the cells in which they are blended; `None` where the frame needs none. The inner error is the
/// reason why tiles draw it.
///
/// Errors: what no device has a shader for; a camera out of range.
fn find_order(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
) -> Result<std::result::Result<Option<TimedFaceOrder>, String>> {
    // Exhaustive mode makes an order that is not needed by the cells' centroids.
    if compositing(options) == Compositor::Tiles || scene.ordering(false) != Ordering::PerPixel {
        return Ok(Ok(None));
    }
    can_serve(&scene.transfer_function, &scene.shading)?;
    let (found, seconds) = renderer.along_faces(scene)?;
    Ok(match found {
        Ok(order) => Ok(Some((order, seconds))),
        Err(why) => Err(format!("no order along the faces of the cells is exact: {why}")),
    })
}

/// Checks what was blended in an order, as the options ask for; where it is wrong, tiles draw it.
fn check(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    order: Option<TimedFaceOrder>,
    mut output: FrameOutput,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    let Some((order, seconds)) = order else { return Ok(output) };
    let sort = |pass, seconds| StageTiming { stage: Stage::Sort, pass: Some(pass), seconds };
    output.passes.extend(seconds.map(|seconds| sort("faces (CPU)", seconds)));
    let begun = Instant::now();
    let checked = check_order(renderer, scene, options, &order, &output, progress)?;
    if let Some(why) = checked.as_ref().and_then(|checked| checked.is_wrong(options, &output)) {
        return tiles_instead(renderer, scene, options, why, progress);
    }
    if checked.is_some() {
        output.passes.push(sort("check of the order", begun.elapsed().as_secs_f64()));
    }
    output.counts.pixels_disordered = checked.as_ref().and_then(|checked| checked.disordered);
    output.along_faces = Some(FaceOrderReport { order, checked });
    Ok(output)
}

/// Draws by tiles what was to be blended. Errors: also an accumulation that tiles do not have.
fn tiles_instead(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    why: String,
    progress: &dyn Progress,
) -> Result<FrameOutput> {
    let by_tiles = RenderOptions { compositing: Some(Compositor::Tiles), ..*options };
    if options.accumulation.check(Compositor::Tiles).is_err() {
        return Err(Error::run(format!("the hardware does not blend this scene in exact order: {why}"))
            .got(format!("accumulation = \"{}\", which tiles do not have", options.accumulation.name()))
            .expected("accumulation = \"float\", which tiles draw; or order = \"centroid\""));
    }
    let output = inputs(renderer, scene, &by_tiles, None)?.draw(progress)?;
    Ok(FrameOutput { tiles_instead: Some(why), ..output })
}

/// Number of tiles of 64 pixels that are compared with those of the other compositor: 256 pixels.
const CHECKED_TILES: usize = 4;

/// Compares some pixels of a blended picture with those of tiles, and counts over all of them, as the options ask for; `None`
/// where they ask for neither. Errors: a lost device; a stopped run.
fn check_order(
    renderer: &Renderer,
    scene: &Scene,
    options: &RenderOptions,
    order: &FaceOrder,
    output: &FrameOutput,
    progress: &dyn Progress,
) -> Result<Option<OrderCheckReport>> {
    let disordered = match options.order_check {
        OrderCheck::None => return Ok(None),
        OrderCheck::Sample => None,
        OrderCheck::Count => {
            Some(disorder(&scene.volume.grid, &order.cells, &scene.camera, |_| true)?.disordered)
        }
    };
    let by_tiles =
        RenderOptions { compositing: Some(Compositor::Tiles), accumulation: Accumulation::Float, ..*options };
    let windows = sample(&output.picture);
    let held = inputs(renderer, scene, &by_tiles, None)
        .and_then(|inputs| inputs.draw_windows(windows.clone(), progress))
        .map(|tiles| compare(&output.picture, &tiles.picture, &windows));
    let ((pixels, largest), without_tiles) = match held {
        Ok(compared) => (compared, None),
        Err(error) if error.kind == ErrorKind::Cancelled || renderer.device().is_lost() => return Err(error),
        Err(error) => ((0, 0.0), Some(error.to_string())),
    };
    Ok(Some(OrderCheckReport { pixels, largest, disordered, without_tiles }))
}

/// Windows of one tile each, spread evenly among those that show something: the same ones of the same picture.
fn sample(picture: &Picture) -> Vec<[u32; 4]> {
    let side = ViewRecord::TILE as usize;
    let [columns, rows] = [picture.width, picture.height].map(|n| n.div_ceil(side));
    let shows = |&[x, y]: &[usize; 2]| pixels_of(picture, [x, y]).any(|at| picture.rgba[at][3] > 0.0);
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let shown: Vec<[usize; 2]> = all.filter(shows).collect();
    let count = CHECKED_TILES.min(shown.len());
    // The middles of as many equal parts.
    let places = (0..count).map(|k| shown[(2 * k + 1) * shown.len() / (2 * count)]);
    places.map(|[x, y]| [x as u32, y as u32, 1, 1]).collect()
}

/// Indices of a tile's pixels in a picture.
fn pixels_of(picture: &Picture, [x, y]: [usize; 2]) -> impl Iterator<Item = usize> {
    let side = ViewRecord::TILE as usize;
    let (width, height) = (picture.width, picture.height);
    let rows = y * side..((y + 1) * side).min(height);
    rows.flat_map(move |row| (x * side..((x + 1) * side).min(width)).map(move |column| row * width + column))
}

/// Number of pixels in the windows, and the largest difference of a channel.
fn compare(a: &Picture, b: &Picture, windows: &[[u32; 4]]) -> (u64, f32) {
    let places = windows.iter().flat_map(|w| pixels_of(a, [w[0] as usize, w[1] as usize]));
    let apart = |at: usize| a.rgba[at].iter().zip(b.rgba[at]).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
    places.fold((0, 0.0), |(count, most), at| (count + 1, most.max(apart(at))))
}

/// Frames of a grid in flight at most: as many pictures are held on their way back.
const IN_FLIGHT: usize = 4;

/// A submitted frame.
pub enum SubmittedFrame {
    /// In flight.
    InFlight(Box<PendingFrame>),
    /// Drawn at once: it comes in parts, or enough are in flight.
    Finished(Box<FrameOutput>),
}

/// A frame in flight.
pub struct PendingFrame {
    scene: Scene,
    options: RenderOptions,
    order: Option<TimedFaceOrder>,
    pending: PendingStats,
    submitted: SubmittedPicture,
    slot: FrameSlot,
}

/// Readback slot of a frame in flight.
struct FrameSlot {
    renderer: Arc<Renderer>,
    returning: Option<ReadbackBuffers>,
}

impl FrameSlot {
    /// A free slot, where there is one.
    fn take(renderer: &Arc<Renderer>) -> Option<FrameSlot> {
        let mut buffers = renderer.buffers();
        if buffers.in_flight >= IN_FLIGHT {
            return None;
        }
        buffers.in_flight += 1;
        let returning = Some(buffers.idle_readbacks.pop().unwrap_or_default());
        Some(FrameSlot { renderer: renderer.clone(), returning })
    }

    /// Frees the slot of a finished frame; the next one reuses its buffers.
    fn finish(mut self) {
        let returning = self.returning.take();
        self.renderer.buffers().idle_readbacks.extend(returning);
    }
}

impl Drop for FrameSlot {
    // The buffers of a frame that nobody took may still be on their way: others are made.
    fn drop(&mut self) {
        self.renderer.buffers().in_flight -= 1;
    }
}

/// Submits a frame; see [`draw`]. Errors: those of [`draw`].
pub fn begin(
    renderer: &Arc<Renderer>,
    scene: &Scene,
    options: &RenderOptions,
    progress: &dyn Progress,
) -> Result<SubmittedFrame> {
    progress.check_cancelled()?;
    if let Ok(order) = find_order(renderer, scene, options)?
        && let Some(mut slot) = FrameSlot::take(renderer)
    {
        let inputs = inputs(renderer, scene, options, order.as_ref().map(|(order, _)| order))?;
        if let Some(submitted) = inputs.submit(slot.returning.get_or_insert_default())? {
            let (pending, scene, options) = (inputs.pending, scene.clone(), *options);
            let frame = PendingFrame { scene, options, order, pending, submitted, slot };
            return Ok(SubmittedFrame::InFlight(Box::new(frame)));
        }
        drop(inputs);
        slot.finish();
    }
    draw(renderer, scene, options, progress).map(|output| SubmittedFrame::Finished(Box::new(output)))
}

impl SubmittedFrame {
    /// Blocks until the frame is finished. Errors: those of [`draw`].
    pub fn collect(self, progress: &dyn Progress) -> Result<FrameOutput> {
        let frame = match self {
            SubmittedFrame::Finished(output) => return Ok(*output),
            SubmittedFrame::InFlight(frame) => frame,
        };
        let PendingFrame { scene, options, order, pending, submitted, slot } = *frame;
        let renderer = slot.renderer.clone();
        let returned = submitted.finish(renderer.device())?;
        slot.finish();
        match returned {
            Some(returned) => check(&renderer, &scene, &options, order, pending.with(returned), progress),
            None => draw(&renderer, &scene, &options, progress),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::Device;
    use std::sync::Arc;
    use voltet_core::progress::NoProgress;
    use voltet_optics::engine::Compositor;
    use voltet_optics::shading::VisibilityOrder;
    use voltet_testing::pictures::compare::{NamedScene, SHADING};
    use voltet_testing::pictures::grids::{cube, smooth};
    use voltet_testing::pictures::looks::{outside, overlapping};

    /// An order back to front is found by either check, and the way out is said.
    #[test]
    fn a_wrong_order_is_found() {
        let device = match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
            Ok(device) => Arc::new(device),
            Err(why) => return voltet_testing::skipped_without_device(why),
        };
        let volume = smooth(cube([5, 5, 5], 0.2));
        let renderer = Renderer::new(device, &volume).expect("fits");
        let scene =
            NamedScene { name: "cube".into(), volume, look: overlapping(), camera: outside([40, 32]) };
        let scene = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
        let right = renderer.along_faces(&scene).expect("is in range").0.expect("has an order");
        let mut wrong = FaceOrder::clone(&right);
        wrong.cells.reverse();
        for order in [wrong, FaceOrder::clone(&right)] {
            let order = Arc::new(order);
            let is_right = order == right;
            for (order_check, words) in
                [(OrderCheck::Sample, "from that of tiles"), (OrderCheck::Count, "out of order at")]
            {
                let options = RenderOptions {
                    order_check,
                    compositing: Some(Compositor::Raster),
                    ..RenderOptions::default()
                };
                let output = inputs(&renderer, &scene, &options, Some(&order)).expect("serves");
                let output = output.draw(&NoProgress).expect("draws");
                let checked = check_order(&renderer, &scene, &options, &order, &output, &NoProgress);
                let checked = checked.expect("draws").expect("is asked for");
                let why = checked.is_wrong(&options, &output);
                assert_eq!(why.is_none(), is_right, "{order_check:?}: {checked:?}");
                assert!(why.is_none_or(|why| why.contains(words)), "{checked:?}");
            }
        }
    }

    /// A device that is lost in between is an error for each of the frames, whatever becomes of them, and for the next one.
    #[test]
    fn a_lost_device_is_an_error() {
        let device = match Device::open(std::env::var("VOLTET_ADAPTER").ok().as_deref(), false) {
            Ok(device) => Arc::new(device),
            Err(why) => return voltet_testing::skipped_without_device(why),
        };
        let volume = smooth(cube([5, 5, 5], 0.2));
        let renderer = Arc::new(Renderer::new(device.clone(), &volume).expect("fits"));
        let scene =
            NamedScene { name: "cube".into(), volume, look: overlapping(), camera: outside([40, 32]) };
        let scene = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
        let options = RenderOptions { compositing: Some(Compositor::Tiles), ..RenderOptions::default() };
        let start = || begin(&renderer, &scene, &options, &NoProgress);
        draw(&renderer, &scene, &options, &NoProgress).expect("draws");
        let frames: Vec<SubmittedFrame> = (0..3).map(|_| start().expect("begins")).collect();
        device.device.destroy();
        for frame in frames {
            // What had come back before may still be taken.
            if let Err(error) = frame.collect(&NoProgress) {
                assert!(error.to_string().contains("lost"), "{error}");
            }
        }
        assert!(start().and_then(|frame| frame.collect(&NoProgress)).is_err());
        assert!(device.is_lost());
    }
}
