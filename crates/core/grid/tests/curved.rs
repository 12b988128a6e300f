//! Curved cells.

use super::boxes::{Kind, box_of, built, parts_with_scalar};
use super::*;
use crate::progress::NoProgress;

fn subdivided(parts: RawGrid, subdivision: u32) -> Grid {
    build(parts, &Options { subdivision, ..Options::default() }, &NoProgress).unwrap()
}

#[test]
fn straight_quadratic_cells_fill_the_cube_and_conform() {
    for kind in [Kind::QuadraticTetrahedra, Kind::QuadraticHexahedra] {
        for seed in 1..6 {
            for subdivision in [1, 2, 3] {
                let parts = shuffled(box_of(kind, [2, 2, 2], UNIT, 0.2), seed);
                let grid = subdivided(parts, subdivision);
                assert_fills_unit_cube(&grid, &format!("{kind:?}, seed {seed}, subdivision {subdivision}"));
            }
        }
    }
}

/// Nodes of VTK's cells in [0, 1]³ (their parametric coordinates), times 2.
const TETRAHEDRON: &[[i32; 3]] = &[
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [0, 1, 1],
];
const HEXAHEDRON: &[[i32; 3]] = &[
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [2, 2, 2],
    [0, 2, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [1, 0, 2],
    [2, 1, 2],
    [1, 2, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [2, 2, 1],
    [0, 2, 1],
    [0, 1, 1],
    [2, 1, 1],
    [1, 0, 1],
    [1, 2, 1],
    [1, 1, 0],
    [1, 1, 2],
    [1, 1, 1],
];
const WEDGE: &[[i32; 3]] = &[
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [0, 2, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [1, 0, 2],
    [1, 1, 2],
    [0, 1, 2],
    [0, 0, 1],
    [2, 0, 1],
    [0, 2, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];
const LINEAR_WEDGE: &[[i32; 3]] = &[
    [0, 0, 0],
    [2, 0, 0],
    [0, 2, 0],
    [0, 0, 2],
    [2, 0, 2],
    [0, 2, 2],
    [1, 0, 0],
    [1, 1, 0],
    [0, 1, 0],
    [1, 0, 2],
    [1, 1, 2],
    [0, 1, 2],
];
const PYRAMID: &[[i32; 3]] = &[
    [0, 0, 0],
    [2, 0, 0],
    [2, 2, 0],
    [0, 2, 0],
    [0, 0, 2],
    [1, 0, 0],
    [2, 1, 0],
    [1, 2, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 0, 1],
    [1, 1, 1],
    [0, 1, 1],
];

fn single(code: u8, nodes: impl IntoIterator<Item = DVec3>) -> RawGrid {
    let points: Vec<DVec3> = nodes.into_iter().collect();
    let count = points.len();
    let set = CellSet {
        types: vec![code],
        offsets: vec![0, count as u64],
        connectivity: (0..count as u32).collect(),
        polyhedra: Vec::new(),
    };
    RawGrid::new(points, Cells::Mixed(set))
}

fn halves(nodes: &[[i32; 3]]) -> Vec<DVec3> {
    nodes.iter().map(|n| DVec3::from_array(n.map(|x| 0.5 * f64::from(x)))).collect()
}

/// Type, nodes, volume, tetrahedra without subdivision.
fn kinds() -> Vec<(u8, Vec<DVec3>, f64, usize)> {
    let third = 1.0 / 3.0;
    vec![
        (code::QUADRATIC_TETRA, halves(TETRAHEDRON), third / 2.0, 8),
        (code::QUADRATIC_HEXAHEDRON, halves(&HEXAHEDRON[..20]), 1.0, 0),
        (code::BIQUADRATIC_QUADRATIC_HEXAHEDRON, halves(&HEXAHEDRON[..24]), 1.0, 0),
        (code::TRIQUADRATIC_HEXAHEDRON, halves(HEXAHEDRON), 1.0, 0),
        (code::QUADRATIC_WEDGE, halves(&WEDGE[..15]), 0.5, 24),
        (code::BIQUADRATIC_QUADRATIC_WEDGE, halves(WEDGE), 0.5, 24),
        (code::QUADRATIC_LINEAR_WEDGE, halves(LINEAR_WEDGE), 0.5, 12),
        (code::QUADRATIC_PYRAMID, halves(PYRAMID), third, 16),
    ]
}

#[test]
fn every_quadratic_cell_keeps_its_volume_and_reproduces_its_polynomials() {
    // All these cells hold full quadratic polynomials (the quadratic-linear wedge: in x and y), so added points
    // have exact values of such a field.
    for (code, nodes, volume, count) in kinds() {
        let field = |p: DVec3| {
            1.0 + p.x - 2.0 * p.y + 3.0 * p.x * p.x + p.x * p.y - p.y * p.y
                + if code == code::QUADRATIC_LINEAR_WEDGE { p.z } else { p.z * p.z - p.x * p.z }
        };
        for subdivision in [1, 2, 3] {
            let grid = subdivided(parts_with_scalar(single(code, nodes.clone()), "s", field), subdivision);
            // 1e-14 × some hundred terms.
            assert!((total_volume(&grid) - volume).abs() < 1e-12, "type {code}: {}", total_volume(&grid));
            for (&p, &s) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
                assert!((s - field(p)).abs() < 1e-12, "type {code}, subdivision {subdivision}: {s} at {p}");
            }
            assert!(triangle_uses(&grid).values().all(|&uses| uses <= 2));
            if subdivision == 1 && count > 0 {
                assert_eq!(grid.tetrahedra.len(), count, "type {code}");
            }
        }
    }
}

#[test]
fn mid_edge_nodes_are_never_ignored() {
    for (code, nodes, volume, _) in kinds() {
        // The edge between the first two corners bulges out (down): the volume grows.
        let mut bulged = nodes.clone();
        let middle = nodes.iter().position(|&p| p == DVec3::new(0.5, 0.0, 0.0)).unwrap();
        bulged[middle] += DVec3::new(0.0, -0.1, -0.1);
        let straight = subdivided(single(code, bulged.clone()), 1);
        let fine = subdivided(single(code, bulged), 4);
        assert!(total_volume(&straight) > volume + 1e-3, "type {code}");
        assert!(total_volume(&fine) > volume + 1e-3, "type {code}");
    }
}

#[test]
fn subdivision_converges_to_the_curved_cell() {
    // A quadratic hexahedron whose four edges along z bulge by the shape function 4 z (1 − z) × 0.1 outward in x and
    // y: its section at height z is a square of side 1 + 0.8 z (1 − z), so its volume is the integral of its square.
    let mut nodes = halves(&HEXAHEDRON[..20]);
    for p in &mut nodes {
        if p.z == 0.5 {
            *p += DVec3::new(p.x - 0.5, p.y - 0.5, 0.0).signum() * DVec3::new(0.1, 0.1, 0.0);
        }
    }
    // ∫ (1 + 2 a u + a² u²) with a = 0.8, u = z (1 − z): ∫ u = 1/6, ∫ u² = 1/30.
    let exact = 1.0 + 2.0 * 0.8 / 6.0 + 0.64 / 30.0;
    let errors: Vec<f64> = [1, 2, 4]
        .map(|n| {
            (total_volume(&subdivided(single(code::QUADRATIC_HEXAHEDRON, nodes.clone()), n)) - exact).abs()
        })
        .to_vec();
    // Straight pieces: second order.
    assert!(errors[0] / errors[1] > 3.0 && errors[1] / errors[2] > 3.0, "{errors:?}");
}

#[test]
fn neighbours_of_different_types_share_their_curved_faces() {
    // A quadratic hexahedron with a quadratic wedge on its face x = 1 and a quadratic pyramid on its face z = 1.
    let mut points = halves(&HEXAHEDRON[..20]);
    let mut number = |p: DVec3| match points.iter().position(|&q| q == p) {
        Some(at) => at as u32,
        None => {
            points.push(p);
            points.len() as u32 - 1
        }
    };
    let mut set = CellSet::default();
    set.push(code::QUADRATIC_HEXAHEDRON, 0..20);
    let wedge = halves(&WEDGE[..15]).into_iter().map(|p| number(DVec3::new(1.0 + p.x, p.y, p.z)));
    set.push(code::QUADRATIC_WEDGE, wedge);
    let pyramid = halves(PYRAMID).into_iter().map(|p| number(p + DVec3::Z));
    set.push(code::QUADRATIC_PYRAMID, pyramid);
    let parts = RawGrid::new(points, Cells::Mixed(set));
    for seed in 1..20 {
        for subdivision in [1, 2] {
            let grid = subdivided(shuffled(parts.clone(), seed), subdivision);
            assert!((total_volume(&grid) - (1.0 + 0.5 + 1.0 / 3.0)).abs() < 1e-12);
            let uses = triangle_uses(&grid);
            for inside in [[0, 1], [2, 1]] {
                // Triangles in the planes x = 1 and z = 1 between the cells have two neighbours.
                let [axis, side] = inside;
                for (face, &count) in &uses {
                    let corners = face.map(|p| grid.points[p as usize]);
                    let shared = corners.iter().all(|c| c[axis] == side as f64 && c.x <= 1.0 && c.z <= 1.0);
                    assert!(!shared || count == 2, "seed {seed}, subdivision {subdivision}: {corners:?}");
                }
            }
        }
    }
}

#[test]
fn a_triquadratic_pyramid_is_joined_from_node_to_node() {
    // VTK's nodes; its own pyramid stands on z = 0.5 with its apex above the middle.
    let s = 1.0 / 6.0;
    let nodes = [
        [0.0, 0.0, 0.5],
        [1.0, 0.0, 0.5],
        [1.0, 1.0, 0.5],
        [0.0, 1.0, 0.5],
        [0.5, 0.5, 1.0],
        [0.5, 0.0, 0.5],
        [1.0, 0.5, 0.5],
        [0.5, 1.0, 0.5],
        [0.0, 0.5, 0.5],
        [0.25, 0.25, 0.75],
        [0.75, 0.25, 0.75],
        [0.75, 0.75, 0.75],
        [0.25, 0.75, 0.75],
        [0.5, 0.5, 0.5],
        [0.5, s, 4.0 * s],
        [5.0 * s, 0.5, 4.0 * s],
        [0.5, 5.0 * s, 4.0 * s],
        [s, 0.5, 4.0 * s],
        [0.5, 0.5, 0.625],
    ];
    let grid = built(single(code::TRIQUADRATIC_PYRAMID, nodes.map(DVec3::from_array))).unwrap();
    assert_eq!(grid.points.len(), 19);
    assert_eq!(grid.tetrahedra.len(), 4 * 2 + 4 * 6);
    assert!((total_volume(&grid) - 1.0 / 6.0).abs() < 1e-14);
    let uses = triangle_uses(&grid);
    assert!(uses.values().all(|&uses| uses <= 2));
    // Outside: six triangles around the centre of each side, eight in the base.
    assert_eq!(uses.values().filter(|&&uses| uses == 1).count(), 4 * 6 + 8);
}
