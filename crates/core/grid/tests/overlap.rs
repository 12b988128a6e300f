//! Cells that overlap are found, and no others.

use crate::grid::generate::box_of_tetrahedra;
use crate::grid::overlap::{BoundaryOverlap, faces, within};
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

fn overlapping(points: &[DVec3], tetrahedra: &[[u32; 4]]) -> Vec<u32> {
    faces(points, tetrahedra).overlapping
}

/// Boundary of a box that lies in a second one, or the other way round.
fn together(counts: [usize; 3], second: [DVec3; 2]) -> BoundaryOverlap {
    let (mut points, mut tetrahedra) = a_box();
    let other = box_of_tetrahedra(counts, second, 0.2);
    let first = points.len() as u32;
    points.extend_from_slice(&other.points);
    tetrahedra.extend(sorted(other.tetrahedra.iter().map(|cell| cell.map(|p| p + first)).collect()));
    let faces = faces(&points, &tetrahedra);
    assert!(faces.overlapping.is_empty());
    let found = within(&points, &tetrahedra, &faces.boundary);
    assert_eq!(found.tried, faces.boundary.len(), "few enough to try them all");
    if let Some((place, [own, within])) = found.first {
        let is_second = |cell: u32| tetrahedra[cell as usize][0] >= first;
        assert_ne!(is_second(own), is_second(within));
        let box_of_within = if is_second(within) { second } else { [DVec3::ZERO, DVec3::ONE] };
        assert!(place.cmpgt(box_of_within[0]).all() && place.cmplt(box_of_within[1]).all(), "{place}");
    }
    found
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

#[test]
fn pieces_that_overlap_without_a_shared_face_are_found() {
    let quarter = [DVec3::splat(0.75), DVec3::splat(1.75)];
    let found = together([3; 3], quarter);
    // A quarter of three sides of each box lies in the other one: of 192 and 108 faces some six and thirteen, less those near faces.
    assert!((3..=19).contains(&found.inside), "{found:?}");
    // Wholly within: every face of its boundary lies in a cell.
    let found = together([2; 3], [DVec3::splat(0.2), DVec3::splat(0.7)]);
    assert!((24..=48).contains(&found.inside), "{found:?}");
    assert!(found.first.is_some());
}

#[test]
fn pieces_that_meet_without_shared_faces_do_not_overlap() {
    for counts in [[4; 3], [3, 5, 2]] {
        let beside = [DVec3::new(1.0, 0.0, 0.0), DVec3::new(2.0, 1.0, 1.0)];
        assert_eq!(together(counts, beside).inside, 0);
        assert_eq!(together(counts, beside.map(|p| p + DVec3::splat(1e-12) * DVec3::NEG_X)).inside, 0);
    }
    let (points, tetrahedra) = a_box();
    assert_eq!(within(&points, &tetrahedra, &[]), BoundaryOverlap::default());
}
