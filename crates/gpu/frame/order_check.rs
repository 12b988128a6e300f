//! The check of an exact order that was blended: some of its pixels against those of tiles, and a count over all of them.

use crate::frame::inputs::inputs;
use crate::frame::output::{FrameOutput, OrderCheckReport};
use crate::frame::renderer::Renderer;
use voltet_core::Result;
use voltet_core::error::ErrorKind;
use voltet_core::picture::Picture;
use voltet_core::progress::Progress;
use voltet_core::visibility::{FaceOrder, disorder};
use voltet_optics::engine::{Accumulation, Compositor, OrderCheck, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_shaders::ViewRecord;

/// Number of tiles of 64 pixels that are compared with those of the other compositor: 256 pixels.
const TILES: usize = 4;

/// Checks as the options asks for; `None` where it does not. Errors: a lost device; a stopped run.
pub(crate) fn check(
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
    Ok(Some(match held {
        Ok((pixels, largest)) => OrderCheckReport { pixels, largest, disordered, without_tiles: None },
        Err(error) if error.kind == ErrorKind::Cancelled || renderer.device().is_lost() => return Err(error),
        Err(error) => {
            OrderCheckReport { pixels: 0, largest: 0.0, disordered, without_tiles: Some(error.to_string()) }
        }
    }))
}

/// Windows of one tile each, spread evenly among those that show something: the same ones of the same picture.
fn sample(picture: &Picture) -> Vec<[u32; 4]> {
    let side = ViewRecord::TILE as usize;
    let [columns, rows] = [picture.width, picture.height].map(|n| n.div_ceil(side));
    let shows = |&[x, y]: &[usize; 2]| pixels_of(picture, [x, y]).any(|at| picture.rgba[at][3] > 0.0);
    let all = (0..rows).flat_map(|y| (0..columns).map(move |x| [x, y]));
    let shown: Vec<[usize; 2]> = all.filter(shows).collect();
    let count = TILES.min(shown.len());
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::device::device_handle::Device;
    use std::sync::Arc;
    use voltet_core::progress::NoProgress;
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
                let options =
                    RenderOptions { order_check, ..RenderOptions::with_compositor(Compositor::Raster) };
                let output = inputs(&renderer, &scene, &options, Some(&order)).expect("serves");
                let output = output.draw(&scene, &options, &NoProgress).expect("draws");
                let checked = check(&renderer, &scene, &options, &order, &output, &NoProgress);
                let checked = checked.expect("draws").expect("is asked for");
                let why = checked.is_wrong(&options, &output);
                assert_eq!(why.is_none(), is_right, "{order_check:?}: {checked:?}");
                assert!(why.is_none_or(|why| why.contains(words)), "{checked:?}");
            }
        }
    }
}
