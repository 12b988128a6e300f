use super::super::{ProbeRegion, ProbeResult, kernel, probe};
use super::{close, cube};
use crate::grid::Grid;
use crate::grid::generate::sample;
use crate::progress::NoProgress;
use glam::DVec3;

/// Rounding of a few hundred sums of numbers near 1.
const ROUNDING: f64 = 1e-13;

fn found(grid: &Grid, fields: &[fn(DVec3) -> f64], region: ProbeRegion) -> ProbeResult {
    let values: Vec<Vec<f64>> = fields.iter().map(|&field| sample(grid, field)).collect();
    let values: Vec<&[f64]> = values.iter().map(Vec::as_slice).collect();
    probe(grid, &values, &region, None, &NoProgress).unwrap()
}

/// The covariance in the fields' own units.
fn covariance(found: &ProbeResult, i: usize, j: usize) -> f64 {
    found.covariance[i][j] * found.extent[i] * found.extent[j]
}

#[test]
fn a_box_gives_the_moments_of_linear_fields_exactly() {
    // Faces of the box run through cells, and one lies beyond the grid.
    let region = ProbeRegion::Box { low: DVec3::new(0.13, 0.2, -3.0), high: DVec3::new(0.71, 0.9, 0.45) };
    let found = found(&cube(), &[|p| 3.0 * p.x + 5.0, |p| p.x - 2.0 * p.y + p.z], region);
    let (x, y, z) = ((0.13_f64, 0.71_f64), (0.2_f64, 0.9_f64), (0.0_f64, 0.45_f64));
    let mean = |(a, b): (f64, f64)| 0.5 * (a + b);
    // A uniform distribution of width w has variance w²/12.
    let variance = |(a, b): (f64, f64)| (b - a) * (b - a) / 12.0;
    close(found.volume, 0.58 * 0.7 * 0.45, ROUNDING);
    close(found.mean[0], 3.0 * mean(x) + 5.0, ROUNDING);
    close(found.mean[1], mean(x) - 2.0 * mean(y) + mean(z), ROUNDING);
    close(covariance(&found, 0, 0), 9.0 * variance(x), ROUNDING);
    close(covariance(&found, 0, 1), 3.0 * variance(x), ROUNDING);
    close(covariance(&found, 1, 0), 3.0 * variance(x), ROUNDING);
    close(covariance(&found, 1, 1), variance(x) + 4.0 * variance(y) + variance(z), ROUNDING);
}

#[test]
fn a_mask_leaves_whole_cells() {
    let grid = cube();
    let values = sample(&grid, |p| p.x);
    let first = probe(&grid, &[&values], &ProbeRegion::Everywhere, Some(&|i| i == 0), &NoProgress).unwrap();
    let corners = grid.corners(0);
    close(first.mean[0], corners.iter().map(|p| p.x).sum::<f64>() / 4.0, ROUNDING);
    close(first.volume, crate::grid::tetrahedron_volume(corners), ROUNDING);
    assert_eq!(first.cell_count, 1);
    let error =
        probe(&grid, &[&values], &ProbeRegion::Everywhere, Some(&|_| false), &NoProgress).unwrap_err();
    assert!(error.what.contains("the mask leaves no cell"), "{error}");
}

#[test]
fn a_sphere_gives_its_volume_and_variance_to_the_stated_tolerance() {
    // A ball over many cells, one within a single cell, and one far smaller than a cell.
    for (radius, centre) in
        [(0.4, DVec3::new(0.5, 0.45, 0.5)), (0.02, DVec3::new(0.31, 0.47, 0.52)), (1e-9, DVec3::splat(0.4))]
    {
        let found = found(&cube(), &[|p| p.x, |p| p.y + p.z], ProbeRegion::Sphere { centre, radius });
        let volume = 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
        close(found.volume / volume, 1.0, 1e-6);
        // A ball's variance along an axis is r²/5. What a coordinate near 1 resolves adds to it.
        let resolved = 1e-15 / radius;
        close(found.mean[0], centre.x, 5e-5 * radius + 1e-15);
        close(covariance(&found, 0, 0) / (radius * radius / 5.0), 1.0, 1e-5 + resolved);
        close(covariance(&found, 0, 1) / (radius * radius / 5.0), 0.0, 1e-5 + resolved);
    }
}

#[test]
fn points_give_their_interpolated_values() {
    // The second lies on a corner of many cells and must count once; the last lies outside.
    let points = vec![DVec3::splat(0.25), DVec3::ZERO, DVec3::new(0.9, 0.1, 0.6), DVec3::splat(1.5)];
    let found = found(&cube(), &[|p| p.x], ProbeRegion::Points(points));
    assert_eq!(found.point_count, 3);
    let values = [0.25, 0.0, 0.9];
    let mean = values.iter().sum::<f64>() / 3.0;
    close(found.mean[0], mean, ROUNDING);
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / 3.0;
    close(covariance(&found, 0, 0), variance, ROUNDING);
}

#[test]
fn the_matrix_is_that_of_the_inverse_covariance() {
    let fields: &[fn(DVec3) -> f64] = &[|p| 1e6 * p.x, |p| p.x + 0.1 * p.y, |p| 1e-6 * p.z * p.x];
    let found = found(&cube(), fields, ProbeRegion::Everywhere);
    for (scale, correlated) in [(1.0, true), (3.0, true), (1.0, false)] {
        let k = kernel(&found, 1e-6, scale, correlated);
        let wanted = |i: usize, j: usize| match i == j || correlated {
            true => found.covariance[i][j] * found.extent[i] * found.extent[j] * scale * scale,
            false => 0.0,
        };
        // 2 KᵀK C = 1.
        for i in 0..3 {
            for j in 0..3 {
                let entry = |l: usize| 2.0 * (0..3).map(|m| k[m][i] * k[m][l]).sum::<f64>() * wanted(l, j);
                let unit = found.extent[j] / found.extent[i];
                let identity = if i == j { 1.0 } else { 0.0 };
                // The condition of this covariance is some 1e3.
                close((0..3).map(entry).sum::<f64>() / unit, identity, 1e-11);
            }
        }
    }
}

#[test]
fn directions_without_width_get_the_stated_least() {
    // The second field is three times the first, the third constant in the box and the fourth everywhere.
    let fields: &[fn(DVec3) -> f64] = &[|p| p.x, |p| 3.0 * p.x, |p| (p.x - 0.5).max(0.0), |_| 7.0];
    let grid = crate::grid::generate::box_of_tetrahedra([4, 4, 4], [DVec3::ZERO, DVec3::ONE], 0.0);
    let region = ProbeRegion::Box { low: DVec3::ZERO, high: DVec3::new(0.25, 1.0, 1.0) };
    let found = found(&grid, fields, region);
    let least = 1e-3;
    let k = kernel(&found, least, 1.0, true);
    let exponent =
        |v: [f64; 4]| k.iter().map(|row| (0..4).map(|j| row[j] * v[j]).sum::<f64>().powi(2)).sum::<f64>();
    // One least width along the third field is one standard deviation: exp(−1/2).
    close(exponent([0.0, 0.0, least * found.extent[2], 0.0]), 0.5, 1e-9);
    // Along the first two together, the true deviation counts, √2 of it in the scaled plane; across, the least.
    let sigma = 0.25 / 12.0_f64.sqrt();
    close(exponent([sigma, 3.0 * sigma, 0.0, 0.0]), 0.5, 1e-9);
    let across = least / 2.0_f64.sqrt();
    close(exponent([across * found.extent[0], -across * found.extent[1], 0.0, 0.0]), 0.5, 1e-9);
    // What is constant everywhere is not looked at.
    assert_eq!(exponent([0.0, 0.0, 0.0, 1e30]), 0.0);
}
