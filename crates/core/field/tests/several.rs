//! The magnitude of several gradients at a point.

use super::*;

/// The largest |D x| of unit vectors x, by repeated application of DᵀD: another way to the same number.
fn by_iteration(rows: &[DVec3]) -> f64 {
    let times = |x: DVec3| rows.iter().map(|row| *row * row.dot(x)).sum::<DVec3>();
    let starts = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE];
    let largest = |start: DVec3| {
        let mut x = start;
        for _ in 0..2000 {
            let next = times(x);
            if next.length() == 0.0 {
                return 0.0;
            }
            x = next.normalize();
        }
        x.dot(times(x)).sqrt()
    };
    starts.into_iter().map(largest).fold(0.0, f64::max)
}

#[test]
fn of_one_field_it_is_the_gradient_magnitude_and_of_several_the_largest_singular_value() {
    let v = DVec3::new(0.3, -2.0, 0.7);
    assert_eq!(spectral_norm(&[v]), length(v));
    assert_eq!(spectral_norm(&[DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, -4.0, 0.0)]), 4.0);
    // Twice the same field: √2 of one; some roundings.
    assert!((spectral_norm(&[v, v]) / (std::f64::consts::SQRT_2 * length(v)) - 1.0).abs() < 1e-15);
    // Equal singular values.
    assert!((spectral_norm(&[DVec3::X, DVec3::Z, DVec3::Y]) - 1.0).abs() < 1e-15);
    assert_eq!(spectral_norm(&[DVec3::ZERO, DVec3::ZERO]), 0.0);
    for size in [1e-200, 1e200] {
        let rows = [size * DVec3::new(1.0, 2.0, 2.0), size * DVec3::new(-2.0, 2.0, -1.0)];
        assert!((spectral_norm(&rows) / (3.0 * size) - 1.0).abs() < 1e-15);
    }
}

#[test]
fn it_agrees_with_another_way_to_the_largest_singular_value() {
    let mut random = Random(7);
    for count in 2..8 {
        for _ in 0..50 {
            let mut number = || 2.0 * random.next() - 1.0;
            let rows: Vec<DVec3> = (0..count).map(|_| DVec3::new(number(), number(), number())).collect();
            let (found, other) = (spectral_norm(&rows), by_iteration(&rows));
            // The iteration's: near neighbours of the largest value fade slowly.
            assert!((found / other - 1.0).abs() < 1e-9, "{found} {other}");
        }
    }
}

#[test]
fn curl_divergence_and_q_are_those_of_the_parts_of_the_matrix() {
    let rows = [DVec3::new(1.0, -2.0, 0.0), DVec3::new(2.0, 0.0, 0.0), DVec3::new(0.0, 0.0, 3.0)];
    let values = Derivative::ALL.map(|(_, derivative)| derivative.value(rows));
    assert_eq!(values, [5.0_f64.sqrt(), 4.0, 4.0, -1.0]);
    let mut random = Random(11);
    for _ in 0..100 {
        let mut number = || 2.0 * random.next() - 1.0;
        let rows = [0; 3].map(|_| DVec3::new(number(), number(), number()));
        let square = |sign: f64| {
            let part = |i: usize, j: usize| 0.5 * (rows[i][j] + sign * rows[j][i]);
            (0..9).map(|k| part(k / 3, k % 3).powi(2)).sum::<f64>()
        };
        let (rotation, strain) = (square(-1.0), square(1.0));
        let [_, vorticity, _, q] = Derivative::ALL.map(|(_, derivative)| derivative.value(rows));
        assert!((q - 0.5 * (rotation - strain)).abs() < 1e-14, "{q}");
        // Each component of the curl is twice one of the antisymmetric part, which holds it twice.
        assert!((vorticity - (2.0 * rotation).sqrt()).abs() < 1e-14, "{vorticity}");
    }
}
