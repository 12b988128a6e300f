//! Orders of convergence on a manufactured field, on grids whose points are moved at random by a fixed share of the
//! spacing, so that no error cancels by symmetry.

use super::*;

fn field(p: DVec3) -> f64 {
    (2.0 * p.x + 0.3).sin() * (1.5 * p.y).cos() * (0.8 * p.z).exp()
}

fn field_gradient(p: DVec3) -> DVec3 {
    let (sx, cx) = (2.0 * p.x + 0.3).sin_cos();
    let (sy, cy) = (1.5 * p.y).sin_cos();
    let ez = (0.8 * p.z).exp();
    DVec3::new(2.0 * cx * cy * ez, -1.5 * sx * sy * ez, 0.8 * sx * cy * ez)
}

/// Root mean square of the error inside and on the boundary of a box of n³ hexahedra.
fn errors(method: &str, n: usize, jitter: f64) -> [f64; 2] {
    let grid = box_of_tetrahedra([n; 3], UNIT, jitter);
    let found = gradient(method, &grid, &sample(&grid, field));
    assert!(found.fallbacks.is_empty(), "{method}: {:?}", found.fallbacks);
    let (mut sums, mut counts) = ([0.0; 2], [0.0; 2]);
    for (&p, &g) in grid.points.iter().zip(&found.vectors) {
        let on_boundary = (0..3).any(|axis| p[axis] == 0.0 || p[axis] == 1.0);
        let k = usize::from(on_boundary);
        sums[k] += (g - field_gradient(p)).length_squared();
        counts[k] += 1.0;
    }
    [0, 1].map(|k| f64::sqrt(sums[k] / counts[k]))
}

/// Orders between the two finer of three grids, inside and on the boundary.
fn orders(method: &str, jitter: f64) -> [f64; 2] {
    let e = [6, 12, 24].map(|n| errors(method, n, jitter));
    println!("{method}, jitter {jitter}: {e:?}");
    let order = |k: usize| f64::log2(e[1][k] / e[2][k]);
    [order(0), order(1)]
}

/// Tolerance 0.2: at 24 cells a side the next order of the error still contributes a few per cent.
fn assert_orders(method: &str, jitter: f64, expected: [f64; 2]) {
    let found = orders(method, jitter);
    println!("{method}, jitter {jitter}: orders {found:?}");
    for k in 0..2 {
        assert!(
            (found[k] - expected[k]).abs() < 0.2,
            "{method}, jitter {jitter}: {found:?}, not {expected:?}"
        );
    }
}

#[test]
fn means_of_cells_are_first_order() {
    assert_orders("cell-average", 0.2, [1.0, 1.0]);
    assert_orders("volume-weighted", 0.2, [1.0, 1.0]);
}

#[test]
fn least_squares_is_first_order_and_second_where_the_neighbours_are_symmetric() {
    assert_orders("least-squares", 0.2, [1.0, 1.0]);
    assert_orders("least-squares", 0.0, [2.0, 1.0]);
}

#[test]
fn the_quadratic_fit_is_second_order_up_to_the_boundary() {
    assert_orders("quadratic-fit", 0.2, [2.0, 2.0]);
}
