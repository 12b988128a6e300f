//! The integrators that sample or look up, in lanes, against their own 64-bit truths, on every lane set.

mod classified;
mod found;
mod tabulated;

use found::{Found, shading};
use voltet_core::progress::NoProgress;
use voltet_core::transfer::{ControlPoint, Profile, Widget};
use voltet_cpu::VolumeCache;
use voltet_integrators::{pre_integrated, pre_integrated_cylindrical, riemann, tabulated};
use voltet_judge::segment_cases;
use voltet_optics::shading::Integrator;
use voltet_testing::pictures::grids::{cube, smooth};
use voltet_testing::pictures::looks::outside;
use voltet_testing::segments::{MODELS, look, overlapping, segments, widget};

/// Samples alone, in twos, in groups of four with one over, and so many that Gaussians follow from step to step.
const SAMPLING: [Integrator; 6] = [
    riemann(1),
    riemann(2),
    riemann(13),
    voltet_integrators::segments(1, 33),
    voltet_integrators::segments(6, 33),
    riemann(64),
];

#[test]
fn samples_are_those_of_64_bits_on_the_exact_cases() {
    let mut all: [Found; SAMPLING.len()] = Default::default();
    for (n, (id, _, case)) in segment_cases().expect("well formed").into_iter().enumerate() {
        let which = n % SAMPLING.len();
        all[which].judge(&id, &case.transfer_function, SAMPLING[which], &[case.segment()]);
    }
    for found in &all {
        found.passed();
        assert!(found.judged > 100, "only {} values were judged", found.judged);
        // What is left to 64 bits: the widest segments, and depths beyond 32 bits.
        let left: usize = found.left.values().sum();
        assert!(20 * left < found.judged, "{left} of {} were left to 64 bits", found.judged);
    }
}

/// A piecewise-linear function, and a Gaussian in front of it and behind.
fn ramp(factor: f64) -> Vec<Widget> {
    let point = |s, extinction, color| ControlPoint { s, color, extinction: factor * extinction };
    let points = vec![
        point(0.1, 0.0, [0.1, 0.2, 0.9]),
        point(0.3, 1.0, [0.1, 0.8, 0.9]),
        point(0.55, 0.3, [0.9, 0.7, 0.1]),
        point(0.9, 6.0, [1.0, 0.1, 0.1]),
    ];
    let gaussian = Profile::Gaussian { centre: [0.5, 0.0], matrix: [[8.0, 0.0], [0.0, 0.0]] };
    vec![
        widget(Profile::PiecewiseLinear { points }, [0.0; 3], 0.0),
        widget(gaussian, [0.5, 1.0, 0.25], factor * 4.0),
    ]
}

#[test]
fn tables_over_lengths_are_those_of_64_bits() {
    let list = segments(200, 2.0);
    let mut found = Found::default();
    for model in MODELS {
        // From depths that add a last digit to those of solid matter.
        for factor in [1e-12, 1e-3, 1.0, 100.0, 1e12] {
            for table_size in [2, 9, 34] {
                let integrators = [
                    pre_integrated(table_size, 2),
                    pre_integrated(table_size, 3),
                    pre_integrated_cylindrical(table_size, 2, 1),
                    pre_integrated_cylindrical(table_size, 1, 4),
                ];
                for integrator in integrators {
                    let name = format!("{model:?} × {factor:e}, side {table_size}");
                    found.judge(&name, &look(model, ramp(factor)), integrator, &list);
                }
            }
        }
    }
    found.passed();
    assert!(found.left.is_empty(), "{:?}", found.left);
}

/// A tolerance is met within the rounding of 32 bits; samples are those of 64 bits whatever the widgets, also where depths are those
/// of solid matter.
#[test]
fn every_kind_of_widget_is_sampled_and_subdivided() {
    let list = segments(96, 2.0);
    let mut sampled = Found::default();
    let mut subdivided = Found::default();
    let (extinctions, tolerances): (&[f64], &[f64]) = match voltet_testing::whole_series() {
        true => (&[1e-12, 0.1, 3.0, 300.0, 1e12], &[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]),
        false => (&[1e-12, 3.0, 1e12], &[1e-2, 1e-5]),
    };
    for model in MODELS {
        for &extinction in extinctions {
            for (number, widgets) in overlapping(extinction).into_iter().enumerate() {
                let (look, name) = (look(model, widgets), format!("{model:?} × {extinction:e}, {number}"));
                for integrator in SAMPLING {
                    sampled.judge(&name, &look, integrator, &list);
                }
                if extinction < 1e3 {
                    for &tolerance in tolerances {
                        subdivided.judge(&name, &look, Integrator::adaptive(tolerance), &list);
                    }
                }
            }
        }
    }
    sampled.passed();
    subdivided.passed();
    assert!(sampled.left.is_empty(), "{:?}", sampled.left);
}

/// Segments that no widget reaches are not asked, and the picture is the same.
#[test]
fn empty_segments_are_left_out_without_a_trace() {
    let volume = smooth(cube([8, 8, 8], 0.2));
    let camera = outside([48, 48]);
    // Narrow, in s alone, so that tables serve it; of two colours, so that segments are taken in order.
    let narrow = |centre, color| {
        let matrix = [[60.0, 0.0], [0.0, 0.0]];
        widget(Profile::Gaussian { centre: [centre, 0.0], matrix }, color, 30.0)
    };
    for model in MODELS {
        let look = look(model, vec![narrow(0.4, [1.0, 0.2, 0.1]), narrow(0.7, [0.1, 0.4, 1.0])]);
        for integrator in SAMPLING.into_iter().chain([
            pre_integrated(128, 2),
            pre_integrated_cylindrical(128, 2, 1),
            Integrator::adaptive(1e-3),
            tabulated(128),
        ]) {
            // Cells are the same: a table's domain is that of the cells that are drawn.
            let draw = |exhaustive| {
                let cache = VolumeCache::new(&volume).expect("a cache");
                let mut cells = cache.all(&look, &camera).expect("keeps");
                cells.exhaustive = exhaustive;
                voltet_cpu::draw(&cells, &look, &camera, &shading(integrator), &NoProgress).expect("draws")
            };
            let (usual, counts) = draw(false);
            let (whole, all) = draw(true);
            let pairs = usual.rgba.iter().flatten().zip(whole.rgba.iter().flatten());
            let difference = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            let name = format!("{integrator:?}, {model:?}");
            assert!(whole.rgba.iter().any(|p| p[3] > 0.3), "{name}: nothing to see");
            // 1e-8 of depth each ray and widget, and their rounding.
            assert!(difference < 1e-6, "{name}: {difference:e}");
            // Walks in panels count every segment.
            let walks = integrator.tolerance().is_some();
            assert!(walks || counts.evaluations < all.evaluations, "{name}: {counts:?} {all:?}");
        }
    }
}
