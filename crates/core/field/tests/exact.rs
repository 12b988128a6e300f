//! Values worked by hand, linear and quadratic fields, the array filter.

use super::*;
use crate::SharedSlice;
use crate::grid::Array;
use crate::parameters::ParameterValue;

#[test]
fn a_single_tetrahedron_by_hand() {
    // s = 7 at (1, 0, 0), 1 at (1, 2, 0), 3 at (1, 0, 4), 6 at (3, 0, 0):
    // differences −6, −4, −1 over lengths 2 along y, 4 along z, 2 along x: ∇s = (−0.5, −3, −1).
    let points = [[1.0, 0.0, 0.0], [1.0, 2.0, 0.0], [1.0, 0.0, 4.0], [3.0, 0.0, 0.0]].map(DVec3::from_array);
    let grid = grid_of(points.to_vec(), vec![[0, 1, 2, 3]]);
    for method in METHODS {
        let found = gradient(method, &grid, &[7.0, 1.0, 3.0, 6.0]);
        for v in &found.vectors {
            // 1e-14: a handful of operations on numbers of order 1.
            assert!((*v - DVec3::new(-0.5, -3.0, -1.0)).length() < 1e-14, "{method}: {v}");
        }
        // Four points determine no quadratic function, and the filter says so.
        let count: u64 = found.fallbacks.iter().map(|f| f.point_count).sum();
        assert_eq!(count, if method == "quadratic-fit" { 4 } else { 0 }, "{method}");
    }
}

#[test]
fn two_tetrahedra_by_hand() {
    // Volumes 1/6 and 2/6 on either side of the triangle x = 0; s = x on the left, 0 on the right:
    // ∇s = (1, 0, 0) and 0. At the shared points the plain mean is 1/2, the mean by volume 1/3.
    let points = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [-1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
    let grid = grid_of(points.map(DVec3::from_array).to_vec(), vec![[0, 1, 2, 3], [0, 1, 2, 4]]);
    let s = [0.0, 0.0, 0.0, -1.0, 0.0];
    for (method, expected) in [("cell-average", 0.5), ("volume-weighted", 1.0 / 3.0)] {
        let found = gradient(method, &grid, &s).vectors;
        for (p, g) in [(0, expected), (1, expected), (2, expected), (3, 1.0), (4, 0.0)] {
            assert!(
                (found[p] - DVec3::new(g, 0.0, 0.0)).length() < 1e-15,
                "{method}, point {p}: {}",
                found[p]
            );
        }
    }
    // Least squares at point 0: unit vectors y, z, −x, x with slopes 0, 0, 1, 0: the mean of 1 and 0 along x.
    let found = gradient("least-squares", &grid, &s).vectors[0];
    assert!((found - DVec3::new(0.5, 0.0, 0.0)).length() < 1e-15, "{found}");
}

/// At some points alone the vectors are the same, bit by bit; averages over cells are made for all points at once.
#[test]
fn gradients_at_some_points_are_those_at_all() {
    let grid = box_of_tetrahedra([7, 5, 6], UNIT, 0.25);
    let s = sample(&grid, |p| (3.0 * p.x).sin() * p.y + p.z * p.z);
    // More than one task of points, in no order.
    let points: Vec<u32> = (0..grid.points.len() as u32).rev().filter(|p| p % 3 != 1).collect();
    for name in METHODS {
        let all = gradient(name, &grid, &s).vectors;
        let found = Method::with_defaults(filter(name)).unwrap().gradient_at(&grid, &s, &points, &NoProgress);
        let is_by_points = ["least-squares", "quadratic-fit"].contains(&name);
        assert_eq!(found.is_some(), is_by_points, "{name}");
        let Some(found) = found else { continue };
        let expected: Vec<DVec3> = points.iter().map(|&p| all[p as usize]).collect();
        assert_eq!(found.unwrap().vectors, expected, "{name}");
    }
}

#[test]
fn linear_fields_are_exact() {
    let slope = DVec3::new(0.7, -1.3, 2.1);
    let grid = box_of_tetrahedra([7, 5, 6], UNIT, 0.25);
    // Squeezed to cells a thousand times longer than high, and sheared.
    let thin = moved(&grid, |p| DVec3::new(p.x + 0.3 * p.y, p.y, 1e-3 * p.z + 0.1 * p.x));
    for grid in [grid, thin] {
        let s = sample(&grid, |p| 4.0 + slope.dot(p));
        for method in METHODS {
            let found = gradient(method, &grid, &s);
            assert!(found.fallbacks.is_empty());
            for v in found.vectors {
                // 1e-9: values of order 1 with rounding 1e-16 over heights of 1e-4, times the condition of the fit.
                assert!((v - slope).length() < 1e-9, "{method}: {v}");
            }
        }
    }
}

#[test]
fn quadratic_fields_are_exact_for_the_quadratic_fit() {
    let grid = box_of_tetrahedra([5, 6, 4], UNIT, 0.2);
    let s = sample(&grid, |p| p.x * p.x - 2.0 * p.x * p.y + 3.0 * p.z * p.y - p.z * p.z + p.x);
    let found = gradient("quadratic-fit", &grid, &s);
    assert!(found.fallbacks.is_empty(), "{:?}", found.fallbacks);
    for (&p, v) in grid.points.iter().zip(&found.vectors) {
        let expected = DVec3::new(2.0 * p.x - 2.0 * p.y + 1.0, -2.0 * p.x + 3.0 * p.z, 3.0 * p.y - 2.0 * p.z);
        // 1e-11: rounding 1e-16 over spacings of 0.2, times a condition of at most 1e3.
        assert!((*v - expected).length() < 1e-11, "{v} for {expected}");
    }
}

#[test]
fn cell_average_equals_vtks_gradient_filter() {
    // Eight distorted hexahedra in six tetrahedra each; ∂s by vtkGradientFilter of VTK 9.7.2 on the same cells.
    let points: Vec<DVec3> = (0..27)
        .map(|n| {
            let shift = |axis: i32| f64::from((37 * n + 5 * axis) % 11 - 5) / 60.0;
            DVec3::new(
                f64::from(n % 3) + shift(0),
                f64::from(n / 3 % 3) + shift(1),
                f64::from(n / 9) + shift(2),
            )
        })
        .collect();
    let grid = Grid { points: SharedSlice::from(points), ..box_of_tetrahedra([2, 2, 2], UNIT, 0.0) };
    assert_eq!(grid.tetrahedra.len(), 48);
    let s = sample(&grid, |p| p.x * p.x + 2.0 * p.y * p.z - p.z * p.z * p.z);
    let found = gradient("cell-average", &grid, &s).vectors;
    let vtk = [
        (0, [0.8797112823588642, 0.9905322956058759, 0.01903728567360774]),
        (4, [2.4484402398758363, 0.6409547709203491, 1.620861198268288]),
        (13, [1.9859778940426727, 2.0565438040597193, -2.007055817617043]),
        (17, [3.062752123548912, 1.2287933720516502, 0.8647807527290228]),
        (26, [2.778273842747143, 3.0830893336083007, -3.825014919098567]),
    ];
    for (point, expected) in vtk {
        // 1e-13: sums of up to 24 gradients of order 1 to 10 in another order of operations.
        let error = (found[point] - DVec3::from_array(expected)).length();
        assert!(error < 1e-13, "point {point}: {} for {expected:?}", found[point]);
    }
}

#[test]
fn the_array_filter_takes_three_components_and_names_what_is_wrong() {
    let mut grid = box_of_tetrahedra([1, 1, 1], UNIT, 0.0);
    let values = (0..24).map(f64::from).collect();
    grid.point_arrays.insert("grad".into(), Arc::new(Array { component_count: 3, values }));
    grid.point_arrays
        .insert("flat".into(), Arc::new(Array { component_count: 2, values: vec![0.0; 16].into() }));
    let run = |name: &str| {
        let values = [("array", ParameterValue::Text(name.into()))];
        let parameters = Parameters::from_values(FromArray.declaration().parameters, values).unwrap();
        let method = Method::new(Arc::new(FromArray), parameters).unwrap();
        assert_eq!(method.arrays().unwrap(), [name]);
        method.gradient(&grid, &[0.0; 8], &NoProgress)
    };
    assert_eq!(run("grad").unwrap().vectors[2], DVec3::new(6.0, 7.0, 8.0));
    assert!(run("flat").unwrap_err().to_string().contains("2 components"));
    let missing = run("gard").unwrap_err().to_string();
    assert!(missing.contains("'gard'") && missing.contains("grad"), "{missing}");
    assert!(
        Method::with_defaults(Arc::new(FromArray)).unwrap_err().to_string().contains("'array' is missing")
    );
}

#[test]
fn magnitudes_neither_overflow_nor_vanish() {
    let cases = [(3e200, 4e200, 5e200), (3e-200, 4e-200, 5e-200), (3.0, 4.0, 5.0), (0.0, 0.0, 0.0)];
    for (x, y, expected) in cases {
        let found = magnitude(&[DVec3::new(x, y, 0.0)])[0];
        assert!((found - expected).abs() <= 1e-15 * expected, "{found} for {expected}");
    }
}
