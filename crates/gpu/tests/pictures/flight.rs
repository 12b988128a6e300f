//! Frames in flight: the same bits as one after the other, and never more of them than are held.

use crate::drawing::device;
use crate::raster::jittered;
use std::sync::Arc;
use voltet_core::progress::NoProgress;
use voltet_gpu::{Renderer, SubmittedFrame, begin, draw};
use voltet_optics::engine::{Compositor, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::VisibilityOrder;
use voltet_testing::pictures::compare::SHADING;
use voltet_testing::pictures::looks::*;

/// A camera that turns, and a picture of another size.
fn scenes(renderer_of: &Scene) -> Vec<Scene> {
    let camera = |k: u32| {
        let angle = 0.4 * f64::from(k);
        let eye = [0.5 + 2.6 * angle.cos(), 0.5 + 2.6 * angle.sin(), 1.4];
        perspective(eye, [0.5, 0.5, 0.5], 38.0, if k == 3 { [24, 48] } else { [40, 32] })
    };
    (0..6).map(|k| Scene { camera: camera(k), ..renderer_of.clone() }).collect()
}

/// Taken one behind, taken in any order, and drawn one after the other.
#[test]
fn frames_in_flight_are_those_drawn_alone() {
    let Some(device) = device() else { return };
    for (compositing, order) in [
        (Compositor::Tiles, VisibilityOrder::Exact),
        (Compositor::Raster, VisibilityOrder::Centroid),
        (Compositor::Triangles, VisibilityOrder::Centroid),
    ] {
        let scene = jittered(overlapping(), outside([40, 32]));
        let renderer = Arc::new(Renderer::new(device.clone(), &scene.volume).expect("fits"));
        let scenes = scenes(&scene.drawn_by(&SHADING, order));
        let options = RenderOptions { compositing: Some(compositing), ..RenderOptions::default() };
        let alone: Vec<_> = scenes
            .iter()
            .map(|scene| draw(&renderer, scene, &options, &NoProgress).expect("draws"))
            .collect();
        let start = |scene: &Scene| begin(&renderer, scene, &options, &NoProgress).expect("begins");
        let is_in_flight = |begun: &SubmittedFrame| matches!(begun, SubmittedFrame::InFlight(_));
        let mut before: Option<SubmittedFrame> = None;
        let mut taken = Vec::new();
        for scene in &scenes {
            let next = start(scene);
            assert!(is_in_flight(&next), "{compositing:?}");
            taken.extend(before.replace(next));
            if let Some(frame) = taken.pop() {
                taken.clear();
                let number = scenes.iter().position(|known| known.camera == scene.camera).unwrap() - 1;
                let drawn = frame.collect(&NoProgress).expect("comes back");
                assert_eq!(drawn.picture.rgba, alone[number].picture.rgba, "{compositing:?} {number}");
                assert_eq!(drawn.counts, alone[number].counts, "{compositing:?} {number}");
            }
        }
        drop(before);
        // The last first.
        let all: Vec<SubmittedFrame> = scenes[..4].iter().map(start).collect();
        assert!(all.iter().all(is_in_flight));
        for (number, frame) in all.into_iter().enumerate().rev() {
            let drawn = frame.collect(&NoProgress).expect("comes back");
            assert_eq!(drawn.picture.rgba, alone[number].picture.rgba, "{compositing:?} {number}");
        }
    }
}

/// As many as are held fly; one more is drawn at once. A frame that nobody takes gives its place back.
#[test]
fn frames_in_flight_are_bounded() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([40, 32]));
    let renderer = Arc::new(Renderer::new(device, &scene.volume).expect("fits"));
    let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
    let options = RenderOptions { compositing: Some(Compositor::Tiles), ..RenderOptions::default() };
    let alone = draw(&renderer, &wanted, &options, &NoProgress).expect("draws");
    for _ in 0..3 {
        let all: Vec<SubmittedFrame> =
            (0..10).map(|_| begin(&renderer, &wanted, &options, &NoProgress).expect("begins")).collect();
        let flying = all.iter().filter(|begun| matches!(begun, SubmittedFrame::InFlight(_))).count();
        assert_eq!(flying, 4);
        // Half of them are given up.
        for frame in all.into_iter().skip(2) {
            let drawn = frame.collect(&NoProgress).expect("comes back");
            assert_eq!(drawn.picture.rgba, alone.picture.rgba);
        }
    }
}

/// Lists that have no room yet, and a picture in parts, are drawn again as they have to be.
#[test]
fn a_first_frame_may_be_in_flight() {
    let Some(device) = device() else { return };
    let scene = jittered(overlapping(), outside([160, 120]));
    let wanted = scene.drawn_by(&SHADING, VisibilityOrder::Exact);
    let options = RenderOptions { compositing: Some(Compositor::Tiles), ..RenderOptions::default() };
    let renderer = || Arc::new(Renderer::new(device.clone(), &scene.volume).expect("fits"));
    let alone = draw(&renderer(), &wanted, &options, &NoProgress).expect("draws");
    let first = begin(&renderer(), &wanted, &options, &NoProgress).expect("begins");
    let drawn = first.collect(&NoProgress).expect("comes back");
    assert_eq!(drawn.picture.rgba, alone.picture.rgba);
    // Tiles that stop within their lists and go on.
    let small = Arc::new(Renderer::new(device.clone(), &scene.volume).expect("fits").with_budget_of(64));
    for _ in 0..2 {
        let frame = begin(&small, &wanted, &options, &NoProgress).expect("begins");
        let drawn = frame.collect(&NoProgress).expect("comes back");
        assert_eq!(drawn.picture.rgba, alone.picture.rgba);
    }
}
