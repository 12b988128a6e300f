//! The errors of tables against their size.

use super::*;
use voltet_optics::linear::{emission_weights, front_back};

/// The largest error over depths from 1e-6 to 1e4: of the front's share of a density-emitter's light, and of F
/// and B relative to the largest of them, 1/2.
fn partial_error(density: bool, size: usize) -> f64 {
    let table = PartialTable::new(density, size);
    let depth = |k: i32| 10.0_f64.powf(f64::from(k) / 9.0);
    let mut worst = 0.0_f64;
    for (i, j) in (-54..36).flat_map(|i| (-54..36).map(move |j| (i, j))) {
        let (a, b) = (depth(i), depth(j));
        let exact = if density { emission_weights(a, b) } else { front_back(a, b) };
        let found = table.weights(a, b);
        let scale = if density { exact.0 + exact.1 } else { 0.5 };
        worst = worst.max((found.0 - exact.0).abs() / scale).max((found.1 - exact.1).abs() / scale);
    }
    worst
}

#[test]
fn the_partial_table_s_error_falls_with_the_square_of_its_side() {
    for (density, most) in [(true, 6e-4), (false, 1e-3)] {
        let errors = [65, 129, 257].map(|size| partial_error(density, size));
        println!("{errors:?}");
        assert!(errors[0] < most, "{errors:?}");
        for pair in errors.windows(2) {
            // Second order is 4; near the corner of infinite depth a cell holds more of a layer.
            assert!(pair[0] / pair[1] > 3.0, "{errors:?}");
        }
    }
}

/// A thin piece keeps its relative accuracy, and opacity is exact at any depth.
#[test]
fn the_partial_table_splits_the_light_of_a_piece() {
    let table = PartialTable::new(true, 64);
    for (a, b) in
        [(1e-12, 3e-12), (0.0, 1e-7), (0.4, 0.0), (3.0, 80.0), (1e9, 1e5), (0.0, 0.0), (1e300, 1e300)]
    {
        let (front, back) = table.weights(a, b);
        let opacity = voltet_optics::special::opacity(0.5 * (a + b));
        assert!((front + back - opacity).abs() <= 4.0 * f64::EPSILON * opacity, "{a} {b}: {front} {back}");
        assert!(front >= 0.0 && back >= 0.0);
    }
}

/// The largest error of (C, A) on a net of paths; `D/U` of the constant-emitter's colour divided out.
fn largest(integrator: &dyn SegmentIntegrator, transfer_function: &TransferFunction, longest: f64) -> f64 {
    let exact = Analytic::new(transfer_function, WidgetBlend::Exact).expect("valid");
    let mut worst = 0.0_f64;
    for (i, j, k) in (0..23).flat_map(|i| (0..23).flat_map(move |j| (1..13).map(move |k| (i, j, k)))) {
        let place = |i: i32| (f64::from(i) + 0.37) / 23.0;
        let length = longest * f64::from(k) / 12.0;
        let segment = Segment { length, front: [place(i), 0.0], back: [place(j), 0.0], ..ACROSS };
        let (mut a, mut b) = (exact.integrate(&segment), integrator.integrate(&segment));
        if transfer_function.model != OpticalModel::DensityEmitter {
            let scale = transfer_function.unit_distance / length;
            (a.color, b.color) = (a.color.map(|c| c * scale), b.color.map(|c| c * scale));
        }
        worst = worst.max(largest_error(&a, &b));
    }
    worst
}

/// Two Gaussians of the scalar alone.
fn waves_of_colour(model: OpticalModel) -> TransferFunction {
    let mut transfer_function = smooth(model);
    for widget in &mut transfer_function.widgets {
        if let Profile::Gaussian { matrix, .. } = &mut widget.profile {
            *matrix = [[4.0, 0.0], [0.0, 0.0]];
        }
    }
    transfer_function
}

#[test]
fn pre_integrated_errors_fall_with_the_square_of_the_size() {
    let extent = Extent { scalar: [0.0, 1.0], longest: 3.0 };
    // A cutoff at which both widgets glow everywhere: nothing jumps.
    for model in [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 1e-9 }] {
        let transfer_function = waves_of_colour(model);
        let error = |size: usize| {
            let table = PreIntegrated::new(&transfer_function, size, 2, None, &extent).expect("serves");
            let tiles = PreIntegrated::new(&transfer_function, size, 2, Some(1), &extent).expect("serves");
            [largest(&table, &transfer_function, 3.0), largest(&tiles, &transfer_function, 3.0)]
        };
        let errors = [32, 64, 128].map(error);
        println!("{model:?} {errors:?}");
        for kind in 0..2 {
            assert!(errors[0][kind] > 8.0 * errors[2][kind], "{errors:?}");
        }
        assert!(errors[2][0] < 2e-3 && errors[2][1] < 8e-3, "{errors:?}");
    }
}

/// A corner of the function between two nodes leaves an error of first order in the distance of the nodes.
#[test]
fn corners_of_the_function_leave_an_error_of_first_order() {
    let extent = Extent { scalar: [0.0, 1.0], longest: 1.0 };
    let transfer_function = piecewise();
    let error = |size: usize| {
        let table = PreIntegrated::new(&transfer_function, size, 2, None, &extent).expect("serves");
        largest(&table, &transfer_function, 1.0)
    };
    for size in [24, 48, 96] {
        // The steepest flank, 6/0.35 a unit, rises by this over a step; a quarter of it is missed at a corner.
        let rise = 6.0 / 0.35 / (size - 1) as f64;
        let found = error(size);
        println!("{size} {found} {rise}");
        assert!(found < 0.5 * rise, "{size}: {found}");
    }
}

/// A widget that is the same everywhere leaves nothing to interpolate.
#[test]
fn a_constant_function_is_tabulated_exactly() {
    let mut transfer_function = piecewise();
    let point = ControlPoint { s: 0.3, color: [0.5, 0.25, 1.0], extinction: 0.75 };
    transfer_function.widgets[0].profile = Profile::PiecewiseLinear { points: vec![point] };
    for model in [OpticalModel::DensityEmitter, OpticalModel::ConstantEmitter { cutoff: 0.1 }] {
        transfer_function.model = model;
        for integrator in [pre_integrated(5, 2), pre_integrated_cylindrical(5, 2, 1)] {
            let made = new(&integrator, WidgetBlend::Exact, &transfer_function, &EXTENT).expect("serves");
            // The entries are 32-bit; longer than the longest still has the right opacity.
            assert!(largest(made.as_ref(), &transfer_function, 10.0) < 1e-6, "{integrator:?} {model:?}");
            let longer = made.integrate(&Segment { length: 20.0, ..ACROSS });
            assert!((longer.opacity + (-15.0_f64).exp_m1()).abs() < 1e-6);
        }
    }
}

/// A peak between two nodes is not missed: its depth is in the step that holds it.
#[test]
fn a_peak_between_nodes_keeps_its_depth() {
    let mut transfer_function = piecewise();
    transfer_function.widgets[0] = Widget {
        profile: Profile::Gaussian { centre: [0.55, 0.0], matrix: [[1e4, 0.0], [0.0, 0.0]] },
        color: [1.0, 0.5, 0.0],
        extinction: 3e3,
        region: None,
    };
    let table = PreIntegrated::new(&transfer_function, 9, 2, None, &EXTENT).expect("serves");
    let across = Segment { front: [0.125, 0.0], back: [0.875, 0.0], ..ACROSS };
    let exact = Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid").integrate(&across);
    assert!(exact.opacity > 0.5);
    // Both ends are nodes: nothing is interpolated but along D, which one colour leaves exact.
    assert!(largest_error(&exact, &table.integrate(&across)) < 1e-6);
}

/// The largest difference of tiles from the table that they are resampled from.
fn of_resampling(table_size: usize, planes: usize) -> f64 {
    let transfer_function = waves_of_colour(OpticalModel::DensityEmitter);
    let extent = Extent { scalar: [0.0, 1.0], longest: 3.0 };
    let table = PreIntegrated::new(&transfer_function, table_size, 2, None, &extent).expect("serves");
    let tiles = PreIntegrated::new(&transfer_function, table_size, 2, Some(planes), &extent).expect("serves");
    let mut worst = 0.0_f64;
    for (i, j, k) in (0..40).flat_map(|i| (0..40).flat_map(move |j| (1..20).map(move |k| (i, j, k)))) {
        let [front, back, length] = [i, j, k].map(|n| (f64::from(n) + 0.37) / 41.0);
        let segment = Segment { length: 3.0 * length, front: [front, 0.0], back: [back, 0.0], ..ACROSS };
        worst = worst.max(largest_error(&table.integrate(&segment), &tiles.integrate(&segment)));
    }
    worst
}

/// Roettger and Ertl 2002, section 4, hold four times the table's side for enough to reconstruct it exactly. More planes bring
/// the tiles nearer, but the places on a tile are resampled, too, and that error stays.
#[test]
fn more_planes_bring_tiles_nearer_to_their_table_but_never_onto_it() {
    let errors = [1, 2, 4, 8].map(|planes| of_resampling(48, planes));
    println!("{errors:?}");
    assert!(errors[1] < 0.7 * errors[0] && errors[2] < errors[1], "{errors:?}");
    assert!(errors[3] > 0.2 * errors[2] && errors[3] > 1e-5, "{errors:?}");
}

/// Pieces of a step have the means of the closed forms; what they leave is where light lies within one.
#[test]
fn oversampling_resolves_what_lies_between_two_entries() {
    let mut transfer_function = waves_of_colour(OpticalModel::DensityEmitter);
    // Opaque within a step, so that the order within it shows.
    transfer_function.widgets.iter_mut().for_each(|widget| widget.extinction *= 200.0);
    let across = Segment { front: [0.25, 0.0], back: [0.75, 0.0], ..ACROSS };
    let exact = Analytic::new(&transfer_function, WidgetBlend::Exact).expect("valid").integrate(&across);
    let errors = [1, 2, 8, 32].map(|oversampling| {
        let table = PreIntegrated::new(&transfer_function, 9, oversampling, None, &EXTENT).expect("serves");
        largest_error(&exact, &table.integrate(&across))
    });
    println!("{errors:?}");
    assert!(
        errors[1] < errors[0] && errors[2] < 0.5 * errors[1] && errors[3] < 0.5 * errors[2],
        "{errors:?}"
    );
}
