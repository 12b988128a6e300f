//! Edges of cells on the boundary: those of the file's cells, without diagonals.

use super::boxes::{Kind, box_of};
use super::*;
use crate::grid::generate::lattice;
use crate::progress::NoProgress;

const COUNTS: [usize; 3] = [3, 2, 2];

/// Edges of a box of hexahedra on its outside: those of six rectangles, less those that two share.
const HEXAHEDRAL: usize = 2 * (17 + 12 + 17) - 4 * (3 + 2 + 2);

fn found(parts: RawGrid, keep_cells: bool) -> (Grid, BoundaryEdges) {
    let grid = build(parts, &Options { keep_cells, ..Options::default() }, &NoProgress).unwrap();
    let edges = boundary_edges(&grid, &NoProgress).unwrap();
    (grid, edges)
}

#[test]
fn edges_are_those_of_the_files_cells() {
    for (kind, expected) in [
        (Kind::Voxels, HEXAHEDRAL),
        (Kind::Hexahedra, HEXAHEDRAL),
        (Kind::Polyhedra, HEXAHEDRAL),
        // Their bases lie outside.
        (Kind::Pyramids, HEXAHEDRAL),
        // Two triangles a rectangle at both ends along z.
        (Kind::Wedges, HEXAHEDRAL + 2 * 3 * 2),
        // Two triangles each rectangle.
        (Kind::Tetrahedra, HEXAHEDRAL + 2 * (6 + 4 + 6)),
    ] {
        for seed in 1..5 {
            let jitter = if kind == Kind::Voxels { 0.0 } else { 0.2 };
            let (grid, edges) = found(shuffled(box_of(kind, COUNTS, UNIT, jitter), seed), true);
            assert_eq!((edges.edges.len(), edges.has_diagonals), (expected, false), "{kind:?}");
            let mut distinct = edges.edges.clone();
            distinct.dedup();
            assert_eq!(distinct, edges.edges, "{kind:?}");
            let on_side = |&[a, b]: &[u32; 2]| {
                let [a, b] = [a, b].map(|p| grid.points[p as usize]);
                (0..3).any(|axis| a[axis] == b[axis] && (a[axis] == 0.0 || a[axis] == 1.0))
            };
            assert!(edges.edges.iter().all(on_side), "{kind:?}");
        }
    }
}

#[test]
fn structured_cells_have_no_diagonals_either() {
    let parts = RawGrid::new(lattice(COUNTS, UNIT, 0.0), Cells::Structured(COUNTS.map(|n| n + 1)));
    let (grid, edges) = found(parts, true);
    assert_eq!((edges.edges.len(), edges.has_diagonals), (HEXAHEDRAL, false));
    let is_along_axis = |&[a, b]: &[u32; 2]| {
        let step = grid.points[a as usize] - grid.points[b as usize];
        step.to_array().iter().filter(|x| **x != 0.0).count() == 1
    };
    assert!(edges.edges.iter().all(is_along_axis));
}

#[test]
fn unknown_cells_show_their_pieces() {
    let all = HEXAHEDRAL + 2 * (6 + 4 + 6);
    let (_, edges) = found(box_of(Kind::Hexahedra, COUNTS, UNIT, 0.0), false);
    assert_eq!((edges.edges.len(), edges.has_diagonals), (all, true));
    let (_, edges) = found(box_of(Kind::Tetrahedra, COUNTS, UNIT, 0.0), false);
    assert_eq!((edges.edges.len(), edges.has_diagonals), (all, false));
    let (_, edges) = found(box_of(Kind::QuadraticHexahedra, COUNTS, UNIT, 0.0), true);
    assert!(edges.has_diagonals && edges.edges.len() > all);
}

#[test]
fn pieces_that_meet_point_by_point_have_no_edges_between_them() {
    let [one, other] = [0.0, 1.0].map(|x| {
        let bounds = UNIT.map(|at| at + DVec3::X * x);
        box_of(Kind::Hexahedra, [1, 1, 1], bounds, 0.0)
    });
    let mut parts = one;
    let before = parts.points.len() as u32;
    let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
    let Cells::Mixed(more) = other.cells else { unreachable!() };
    set.types.extend(more.types);
    set.connectivity.extend(more.connectivity.iter().map(|p| p + before));
    set.offsets.push(16);
    parts.points = parts.points.iter().chain(other.points.iter()).copied().collect();
    let (_, edges) = found(parts, true);
    // Two cubes: of the square between them its four sides, once.
    assert_eq!((edges.edges.len(), edges.has_diagonals), (20, false));
}
