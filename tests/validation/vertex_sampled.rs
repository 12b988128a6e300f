//! The transfer function applied at the grid's points alone.

use glam::DVec3;
use std::sync::Arc;
use voltet_core::Result;
use voltet_core::grid::extent;
use voltet_core::picture::Picture;
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{OpticalModel, TransferFunction};
use voltet_core::volume::Volume;
use voltet_integrators::VERTEX_SAMPLED;
use voltet_optics::engine::{AdapterRequest, RenderOptions};
use voltet_optics::scene::Scene;
use voltet_optics::shading::{Integrator, Shading, VisibilityOrder};
use voltet_testing::pictures::compare::SHADING;
use voltet_testing::pictures::grids::*;
use voltet_testing::pictures::looks::*;

fn drawn(volume: &Arc<Volume>, look: &TransferFunction, integrator: Integrator) -> Picture {
    let scene = Scene::new(
        volume.clone(),
        Arc::new(look.clone()),
        outside([40, 32]),
        Shading { integrator, ..SHADING },
        VisibilityOrder::Exact,
    );
    let draw = || -> Result<Picture> {
        let engine = voltet_cpu::ENGINE.open(&AdapterRequest::default())?;
        Ok(engine.prepare(volume)?.draw(&scene, &RenderOptions::default(), &NoProgress)?.picture)
    };
    draw().unwrap_or_else(|error| panic!("{error}"))
}

fn difference(a: &Picture, b: &Picture) -> f32 {
    let pixel =
        |(a, b): (&[f32; 4], &[f32; 4])| a.iter().zip(b).map(|(x, y)| (x - y).abs()).fold(0.0, f32::max);
    a.rgba.iter().zip(&b.rgba).map(pixel).fold(0.0, f32::max)
}

/// Extinction linear in s and one colour: between the points it is what it is there, and so is what glows.
#[test]
fn what_is_linear_between_the_points_is_drawn_as_by_the_closed_forms() {
    let volume = smooth(cube([5, 5, 5], 0.2));
    let [low, high] = extent::range(&volume.scalar).unwrap();
    let linear = look(vec![points(&[[low, 0.9, 0.4, 0.1, 0.2], [high, 0.9, 0.4, 0.1, 5.0]])]);
    let exact = drawn(&volume, &linear, Integrator::ANALYTIC);
    assert!(exact.rgba.iter().any(|pixel| pixel[3] > 0.5));
    let found = difference(&drawn(&volume, &linear, VERTEX_SAMPLED), &exact);
    assert!(found < 2e-4, "{found}");
    // The constant-emitter glows alike at all points.
    let even = TransferFunction { model: OpticalModel::ConstantEmitter { cutoff: 0.0 }, ..linear };
    let [exact, found] = [Integrator::ANALYTIC, VERTEX_SAMPLED].map(|i| drawn(&volume, &even, i));
    assert!(difference(&exact, &found) < 2e-4, "{}", difference(&exact, &found));
}

/// A peak that no point's value comes near is not there; where one does, it fills the cells around it.
#[test]
fn what_lies_between_the_points_is_missed() {
    // s = 0 and 1 by layers.
    let grid = cube([2, 2, 4], 0.0);
    let scalar: Vec<f64> = grid.points.iter().map(|p: &DVec3| (4.0 * p.z).round() % 2.0).collect();
    let volume = Arc::new(Volume {
        grid: Arc::new(grid),
        scalar: scalar.into(),
        gradient: None,
        gradient_magnitude: None,
    });
    let peak = |s| look(vec![gaussian([s, 0.0], [0.05, f64::INFINITY], 20.0, [1.0, 0.5, 0.2])]);
    let middle = |look: &TransferFunction, integrator| drawn(&volume, look, integrator).rgba[16 * 40 + 20][3];
    assert!(middle(&peak(0.5), Integrator::ANALYTIC) > 0.3);
    assert_eq!(middle(&peak(0.5), VERTEX_SAMPLED), 0.0);
    let [exact, found] = [Integrator::ANALYTIC, VERTEX_SAMPLED].map(|i| middle(&peak(0.0), i));
    assert!(found > exact + 0.05, "{found} for {exact}");
}
