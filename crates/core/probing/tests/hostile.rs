//! Data that lose digits, leave the number range or hold nothing.

use super::super::{Axis, ProbeRegion, bands, histogram, kernel, probe};
use super::{close, cube};
use crate::grid::generate::sample;
use crate::progress::NoProgress;
use crate::transfer::{OpticalModel, TransferFunction};
use crate::volume::Volume;
use glam::DVec3;
use std::sync::Arc;

#[test]
fn a_small_spread_around_a_large_value_keeps_its_digits() {
    let grid = cube();
    let values = sample(&grid, |p| 1e8 + 1e-2 * p.x);
    let found = probe(&grid, &[&values], &ProbeRegion::Everywhere, None, &NoProgress).unwrap();
    // A number near 1e8 resolves 1.5e-8, a millionth of the spread.
    close(found.sigma()[0] / (1e-2 / 12.0_f64.sqrt()), 1.0, 2e-6);
    close(found.mean[0] - 1e8, 5e-3, 2e-8);
    // The same spread where a far value sets the extent.
    let mut far = values;
    far[0] = 0.0;
    let region = ProbeRegion::Box { low: DVec3::splat(0.5), high: DVec3::ONE };
    let found = probe(&grid, &[&far], &region, None, &NoProgress).unwrap();
    close(found.sigma()[0] / (5e-3 / 12.0_f64.sqrt()), 1.0, 1e-5);
    let histogram =
        histogram(&grid, [&far, &far], [Axis { low: 1e8, high: 1e8 + 1e-2, bins: 10 }; 2], &NoProgress);
    let volumes = histogram.unwrap().volumes;
    // s = g: the bins on the diagonal hold all there is, each a tenth but where the far value pulls.
    close(volumes[99], 0.1, 1e-5);
    assert!((0..100).all(|bin| bin % 11 == 0 || volumes[bin] < 1e-5), "{volumes:?}");
}

#[test]
fn scale_changes_nothing() {
    let plain = cube();
    let region = |f: f64| ProbeRegion::Sphere { centre: DVec3::splat(0.5 * f), radius: 0.3 * f };
    let values = sample(&plain, |p| p.x * p.y);
    let wanted = probe(&plain, &[&values], &region(1.0), None, &NoProgress).unwrap();
    for scale in [1e-150, 1e150] {
        let mut grid = plain.clone();
        grid.points = plain.points.iter().map(|&p| p * scale).collect();
        let huge: Vec<f64> = values.iter().map(|v| v * 1e300).collect();
        let found = probe(&grid, &[&huge], &region(scale), None, &NoProgress).unwrap();
        // The power of ten is no power of two: roundings of positions and values.
        close(found.sigma()[0] / 1e300, wanted.sigma()[0], 1e-12);
        close(found.mean[0] / 1e300, wanted.mean[0], 1e-12);
        let axes = [Axis::over(&huge, 8), Axis::over(&values, 8)];
        let found = histogram(&grid, [&huge, &values], axes, &NoProgress).unwrap();
        let plain = histogram(&plain, [&values, &values], [axes[1]; 2], &NoProgress).unwrap();
        for (a, b) in found.volumes.iter().zip(&plain.volumes) {
            let volume = a / scale;
            // 1e450 is no number: only shares can be compared there.
            if volume.is_finite() && volume > 0.0 {
                close(a / found.total, b / plain.total, 1e-12);
            }
        }
    }
}

#[test]
fn constant_fields_and_empty_regions_are_told_apart() {
    let grid = cube();
    let constant = vec![-7.0; grid.points.len()];
    let varying = sample(&grid, |p| p.x);
    let found = probe(&grid, &[&constant, &varying], &ProbeRegion::Everywhere, None, &NoProgress).unwrap();
    assert_eq!((found.mean[0], found.sigma()[0]), (-7.0, 0.0));
    let k = kernel(&found, 1e-3, 1.0, true);
    assert_eq!([k[0][0], k[0][1], k[1][0]], [0.0; 3]);
    assert!(k[1][1].is_finite() && k[1][1] > 0.0);
    let axes = [Axis::over(&constant, 3), Axis::over(&varying, 1)];
    let histogram = histogram(&grid, [&constant, &varying], axes, &NoProgress).unwrap();
    close(histogram.volumes[1], 1.0, 1e-13);
    for (region, what) in [
        (
            ProbeRegion::Box { low: DVec3::splat(2.0), high: DVec3::splat(3.0) },
            "no cell reaches into the box",
        ),
        // A face of the grid is no part of it with a volume.
        (ProbeRegion::Box { low: DVec3::X, high: DVec3::new(2.0, 1.0, 1.0) }, "no cell reaches into the box"),
        (ProbeRegion::Sphere { centre: DVec3::splat(-1.0), radius: 1.0 }, "no cell reaches into the sphere"),
        (ProbeRegion::Points(vec![DVec3::splat(-1.0)]), "no cell holds any of the points"),
        (ProbeRegion::Points(Vec::new()), "no cell holds any of the points"),
    ] {
        let error = probe(&grid, &[&varying], &region, None, &NoProgress).unwrap_err();
        assert!(error.what.contains(what) && error.expected.is_some(), "{error}");
    }
}

#[test]
fn values_that_are_not_finite_are_left_out_and_counted() {
    let grid = cube();
    let good = sample(&grid, |p| p.x);
    let mut bad = good.clone();
    let spoilt = grid.tetrahedra[0][0];
    bad[spoilt as usize] = f64::NAN;
    let found = probe(&grid, &[&bad], &ProbeRegion::Everywhere, None, &NoProgress).unwrap();
    let spoilt_cells = grid.tetrahedra.iter().filter(|t| t.contains(&spoilt)).count() as u64;
    assert_eq!(found.cell_count, grid.tetrahedra.len() as u64 - spoilt_cells);
    assert!(found.mean[0].is_finite() && found.covariance[0][0] > 0.0);
    let histogram =
        histogram(&grid, [&good, &bad], [Axis::over(&good, 4), Axis::over(&bad, 4)], &NoProgress).unwrap();
    close(histogram.volumes.iter().sum::<f64>() + histogram.not_finite, 1.0, 1e-13);
    assert!(histogram.not_finite > 0.0);
    let all_bad = vec![f64::INFINITY; good.len()];
    assert!(probe(&grid, &[&all_bad], &ProbeRegion::Everywhere, None, &NoProgress).is_err());
    assert!(
        probe(
            &grid,
            &[&[-1.7e308, 1.7e308].repeat(good.len())[..good.len()]],
            &ProbeRegion::Everywhere,
            None,
            &NoProgress
        )
        .is_err()
    );
}

#[test]
fn flat_and_missing_cells_make_no_numbers_up() {
    let mut grid = cube();
    grid.points = grid.points.iter().map(|p| p.with_z(0.0)).collect();
    let values = sample(&grid, |p| p.x);
    let error = probe(&grid, &[&values], &ProbeRegion::Everywhere, None, &NoProgress).unwrap_err();
    assert!(error.what.contains("no volume"), "{error}");
    let found = histogram(&grid, [&values, &values], [Axis::over(&values, 4); 2], &NoProgress).unwrap();
    assert_eq!((found.total, found.volumes.iter().sum::<f64>()), (0.0, 0.0));
    let nothing = crate::grid::Grid::default();
    assert!(probe(&nothing, &[&[]], &ProbeRegion::Everywhere, None, &NoProgress).is_err());
    let empty = histogram(&nothing, [&[], &[]], [Axis::over(&[], 4); 2], &NoProgress).unwrap();
    assert_eq!(empty.total, 0.0);
    let volume = Volume {
        grid: Arc::new(nothing),
        scalar: Default::default(),
        gradient: None,
        gradient_magnitude: None,
    };
    let model = OpticalModel::DensityEmitter;
    assert!(
        bands(
            &volume,
            &TransferFunction { model, unit_distance: 1.0, widgets: Vec::new(), axes: Default::default() }
        )
        .unwrap()
        .is_empty()
    );
}
