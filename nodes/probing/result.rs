//! Result of a probe as text and as figures.

use serde_json::json;
use voltet_core::probing::ProbeResult;

/// Mean and deviation of each field.
pub fn sentence(found: &ProbeResult, names: &[String]) -> String {
    let sigma = found.sigma();
    let field = |k: usize| format!("{} {}", names[k], with_deviation(found.mean[k], sigma[k]));
    let fields: Vec<String> = (0..names.len()).map(field).collect();
    let place = match found.point_count {
        0 => format!("{} cells, volume {:.6e}", found.cell_count, found.volume),
        count => format!("{count} points in {} cells", found.cell_count),
    };
    format!("{} ({place})", fields.join(", "))
}

/// A mean and its deviation, to three digits of the deviation.
fn with_deviation(mean: f64, sigma: f64) -> String {
    if sigma <= 0.0 {
        return format!("{mean:?} ± 0");
    }
    let decimals = 2.0 - sigma.log10().floor();
    match (0.0..=9.0).contains(&decimals) && mean.abs() < 1e9 {
        true => format!("{mean:.0$} ± {sigma:.0$}", decimals as usize),
        false => format!("{mean:.8e} ± {sigma:.2e}"),
    }
}

/// Figures from which a pipeline file can state the widget, and their source.
pub fn figures(found: &ProbeResult, names: &[String], matrix: &[Vec<f64>]) -> serde_json::Value {
    let n = names.len();
    let covariance = |i: usize, j: usize| found.covariance[i][j] * found.extent[i] * found.extent[j];
    let covariance: Vec<Vec<f64>> = (0..n).map(|i| (0..n).map(|j| covariance(i, j)).collect()).collect();
    json!({
        "fields": names,
        "centre": found.mean,
        "sigma": found.sigma(),
        "covariance": covariance,
        "matrix": matrix,
        "cells": found.cell_count,
        "volume": found.volume,
        "points": found.point_count,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_show_three_digits_of_their_deviation() {
        for (mean, sigma, wanted) in [
            (457.889822, 32.208, "457.9 ± 32.2"),
            (0.0270821, 0.00012345, "0.027082 ± 0.000123"),
            (1e8 + 0.5, 0.00289, "100000000.50000 ± 0.00289"),
            (5.0, 0.0, "5.0 ± 0"),
            (-2.5e-20, 3e-21, "-2.50000000e-20 ± 3.00e-21"),
            (7e6, 12345.0, "7.00000000e6 ± 1.23e4"),
        ] {
            assert_eq!(with_deviation(mean, sigma), wanted);
        }
    }
}
