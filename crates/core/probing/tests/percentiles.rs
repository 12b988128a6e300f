//! Percentiles against distributions that are known.

use crate::SharedSlice;
use crate::grid::Grid;
use crate::grid::generate::box_of_tetrahedra;
use crate::probing::{Volumes, value_range};
use crate::progress::NoProgress;
use glam::DVec3;

fn percentile(grid: &Grid, values: &[f64], percent: f64) -> f64 {
    Volumes::new(grid, values, &NoProgress).unwrap().percentile(percent, &NoProgress).unwrap()
}

#[test]
fn a_ramp_over_a_box_has_the_value_of_its_place() {
    // However the box is cut into cells: a share p of it lies below x = p of its width.
    for (cells, jitter) in [([1, 1, 1], 0.0), ([7, 5, 6], 0.3), ([40, 3, 2], 0.1)] {
        let grid = box_of_tetrahedra(cells, [DVec3::new(-1.0, 0.0, 2.0), DVec3::new(3.0, 1.0, 5.0)], jitter);
        let values: Vec<f64> = grid.points.iter().map(|p| 10.0 + 0.25 * (p.x + 1.0)).collect();
        for percent in [0.0, 1e-3, 1.0, 25.0, 50.0, 90.0, 99.9, 100.0] {
            let found = percentile(&grid, &values, percent);
            // The share is met to 1e-12, which is a value of as much of the width.
            assert!((found - (10.0 + percent / 100.0)).abs() < 1e-11, "{percent} of {cells:?}: {found}");
        }
    }
}

fn tetrahedra(count: usize) -> Grid {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let points = (0..count).flat_map(|i| corners.map(|p| p + DVec3::new(2.0 * i as f64, 0.0, 0.0)));
    let cells = (0..count as u32).map(|i| [4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3]);
    Grid {
        points: SharedSlice::from(points.collect::<Vec<_>>()),
        tetrahedra: SharedSlice::from(cells.collect::<Vec<_>>()),
        ..Grid::default()
    }
}

#[test]
fn one_cell_has_the_distribution_of_its_corners() {
    // Values 0, 0, 0, 1: the part above v is a smaller tetrahedron, (1 - v)³ of the volume.
    let grid = tetrahedra(1);
    for percent in [1.0, 10.0, 50.0, 99.0] {
        let wanted = 1.0 - (1.0 - percent / 100.0_f64).cbrt();
        let found = percentile(&grid, &[0.0, 0.0, 0.0, 1.0], percent);
        assert!((found - wanted).abs() < 1e-10, "{percent}: {found}, {wanted}");
    }
}

#[test]
fn steps_and_gaps_give_their_lower_value() {
    // A quarter of the volume at 1, a quarter at 2, the rest at 5.
    let grid = tetrahedra(4);
    let values: Vec<f64> = [1.0, 2.0, 5.0, 5.0].iter().flat_map(|&v| [v; 4]).collect();
    for (percent, wanted) in
        [(0.0, 1.0), (10.0, 1.0), (25.0, 1.0), (25.1, 2.0), (50.0, 2.0), (50.1, 5.0), (100.0, 5.0)]
    {
        assert_eq!(percentile(&grid, &values, percent), wanted, "{percent}");
    }
    assert_eq!(percentile(&grid, &[3.0; 16], 40.0), 3.0);
}

#[test]
fn a_map_of_the_values_maps_the_percentiles() {
    let grid = box_of_tetrahedra([6, 6, 6], [DVec3::ZERO, DVec3::ONE], 0.3);
    let values: Vec<f64> = grid.points.iter().map(|p| (7.0 * p.x).sin() + p.y * p.z).collect();
    let mapped: Vec<f64> = values.iter().map(|v| 3.7 * v - 1e3).collect();
    for percent in [5.0, 50.0, 97.5] {
        let [one, other] = [&values, &mapped].map(|values| percentile(&grid, values, percent));
        // A thousand has digits of 1e-13, and the share is met to 1e-12.
        assert!((other - (3.7 * one - 1e3)).abs() < 1e-9, "{percent}");
    }
}

#[test]
fn many_values_at_once_are_as_one_by_one() {
    let grid = box_of_tetrahedra([5, 4, 6], [DVec3::ZERO, DVec3::ONE], 0.3);
    let mut values: Vec<f64> = grid.points.iter().map(|p| (5.0 * p.x).sin() + p.y).collect();
    values[3] = f64::NAN;
    let volumes = Volumes::new(&grid, &values, &NoProgress).unwrap();
    let edges: Vec<f64> = (0..=50).map(|i| -1.2 + 0.07 * f64::from(i)).collect();
    for (edge, many) in edges.iter().zip(volumes.below_each(&edges, &NoProgress).unwrap()) {
        // A sum of hundreds of roundings.
        assert!((volumes.below(*edge) - many).abs() < 1e-13, "{edge}");
    }
    assert!(volumes.total() < 1.0 && (volumes.below(f64::INFINITY) - volumes.total()).abs() < 1e-13);
}

#[test]
fn what_has_no_values_is_refused() {
    let grid = tetrahedra(1);
    let refused = |values: &[f64]| Volumes::new(&grid, values, &NoProgress).err().unwrap().to_string();
    assert!(refused(&[f64::NAN, 1.0, 1.0, 1.0]).contains("without finite values"));
    assert!(refused(&[1.0]).contains("one value a point"));
    let flat = Grid { points: SharedSlice::from(vec![DVec3::ZERO; 4]), ..tetrahedra(1) };
    assert!(
        Volumes::new(&flat, &[1.0; 4], &NoProgress).err().unwrap().to_string().contains("without volume")
    );
    assert!(value_range(&[f64::NAN]).unwrap_err().to_string().contains("no finite values"));
    assert!(value_range(&[-1e308, 1.5e308]).unwrap_err().to_string().contains("beyond 64-bit"));
    assert_eq!(value_range(&[2.0, f64::NAN, -1.0]).unwrap(), [-1.0, 2.0]);
}
