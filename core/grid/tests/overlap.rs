//! Cells that overlap are found, and no others.

use crate::grid::generate::box_of_tetrahedra;
use crate::grid::overlap::overlapping;
use glam::DVec3;

fn sorted(mut tetrahedra: Vec<[u32; 4]>) -> Vec<[u32; 4]> {
    tetrahedra.iter_mut().for_each(|cell| cell.sort_unstable());
    tetrahedra
}

/// A box of 4 × 4 × 4 hexahedra cut into tetrahedra, points moved a little.
fn a_box() -> (Vec<DVec3>, Vec<[u32; 4]>) {
    let grid = box_of_tetrahedra([4; 3], [DVec3::ZERO, DVec3::ONE], 0.2);
    (grid.points.to_vec(), sorted(grid.tetrahedra.to_vec()))
}

#[test]
fn a_grid_that_fills_space_once_has_none() {
    let (points, tetrahedra) = a_box();
    assert_eq!(overlapping(&points, &tetrahedra), Vec::<u32>::new());
    // Cells that stand apart, each with points of its own at the places of its neighbours'.
    let own: Vec<DVec3> = tetrahedra.iter().flatten().map(|&p| points[p as usize]).collect();
    let apart = (0..tetrahedra.len() as u32).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect();
    assert_eq!(overlapping(&own, &sorted(apart)), Vec::<u32>::new());
}

#[test]
fn cells_that_are_there_twice_are_found_also_by_points_of_their_own() {
    let (mut points, mut tetrahedra) = a_box();
    let twice = tetrahedra[17];
    tetrahedra.push(twice);
    let last = tetrahedra.len() as u32 - 1;
    // The neighbours across its faces share these with one cell on either side, and with the other one on the other side only.
    assert_eq!(overlapping(&points, &tetrahedra), [17, last]);
    let first = points.len() as u32;
    points.extend(twice.map(|p| points[p as usize]));
    tetrahedra[last as usize] = [first, first + 1, first + 2, first + 3];
    assert_eq!(overlapping(&points, &tetrahedra), [17, last]);
}

#[test]
fn folded_cells_are_found_and_flat_ones_are_not() {
    // Two tetrahedra on one face; the second one's top is moved through it.
    let at = |z: f64| vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(0.2, 0.2, z)];
    let cells = [[0, 1, 2, 3], [0, 1, 2, 4]];
    assert_eq!(overlapping(&at(-1.0), &cells), Vec::<u32>::new());
    assert_eq!(overlapping(&at(0.5), &cells), [0, 1]);
    assert_eq!(overlapping(&at(1e-12), &cells), Vec::<u32>::new(), "flat, to rounding");
}
