//! Lagrange and Bezier cells: VTK's order of nodes, volumes, values.

use super::boxes::parts_with_scalar;
use super::*;
use crate::progress::NoProgress;

/// VTK's positions (vtkLagrangeTetra's parametric coordinates × 4 and × 5, vtkHigherOrderHexahedron and
/// vtkHigherOrderWedge::PointIndexFromIJK), written as digits i j k.
const TETRAHEDRON_4: &str = "000 400 040 004 100 200 300 310 220 130 030 020 010 001 002 003 301 202 103 031 022 013 \
    101 201 102 121 112 211 011 012 021 110 120 210 111";
const TETRAHEDRON_5: &str = "000 500 050 005 100 200 300 400 410 320 230 140 040 030 020 010 001 002 003 004 401 302 \
    203 104 041 032 023 014 101 301 103 201 202 102 131 113 311 122 212 221 011 013 031 012 022 021 110 130 310 120 \
    220 210 111 211 121 112";
const HEXAHEDRON_234: &str = "000 200 230 030 004 204 234 034 100 210 220 130 010 020 104 214 224 134 014 024 001 002 \
    003 201 202 203 231 232 233 031 032 033 011 021 012 022 013 023 211 221 212 222 213 223 101 102 103 131 132 133 \
    110 120 114 124 111 121 112 122 113 123";
const HEXAHEDRON_333: &str = "000 300 330 030 003 303 333 033 100 200 310 320 130 230 010 020 103 203 313 323 133 233 \
    013 023 001 002 301 302 331 332 031 032 011 021 012 022 311 321 312 322 101 201 102 202 131 231 132 232 110 210 \
    120 220 113 213 123 223 111 211 121 221 112 212 122 222";
const WEDGE_443: &str = "000 400 040 003 403 043 100 200 300 310 220 130 030 020 010 103 203 303 313 223 133 033 023 \
    013 001 002 401 402 041 042 110 210 120 113 213 123 101 201 301 102 202 302 311 221 131 312 222 132 031 021 011 \
    032 022 012 111 211 121 112 212 122";

fn positions(digits: &str, orders: [f64; 3]) -> Vec<DVec3> {
    let digit = |c: u8| f64::from(c - b'0');
    digits
        .split_whitespace()
        .map(|w| {
            let b = w.as_bytes();
            DVec3::new(digit(b[0]) / orders[0], digit(b[1]) / orders[1], digit(b[2]) / orders[2])
        })
        .collect()
}

fn cell(code: u8, points: Vec<DVec3>, degrees: Option<[u8; 3]>) -> RawGrid {
    let count = points.len();
    let set = CellSet {
        types: vec![code],
        offsets: vec![0, count as u64],
        connectivity: (0..count as u32).collect(),
        polyhedra: Vec::new(),
    };
    let mut parts = RawGrid::new(points, Cells::Mixed(set));
    parts.degrees = degrees.map(|d| vec![d]);
    parts
}

fn subdivided(parts: RawGrid, subdivision: u32) -> Grid {
    build(parts, &Options { subdivision, ..Options::default() }, &NoProgress).unwrap()
}

#[test]
fn lagrange_cells_follow_vtks_order_of_nodes() {
    // A node out of place would turn pieces over and make the sum of volumes exceed the cell's; a cubic field has
    // exact values at added points.
    let cases = [
        (code::LAGRANGE_TETRAHEDRON, positions(TETRAHEDRON_4, [4.0; 3]), None, 1.0 / 6.0, 64),
        (code::LAGRANGE_TETRAHEDRON, positions(TETRAHEDRON_5, [5.0; 3]), None, 1.0 / 6.0, 125),
        (code::LAGRANGE_HEXAHEDRON, positions(HEXAHEDRON_234, [2.0, 3.0, 4.0]), Some([2, 3, 4]), 1.0, 0),
        (code::LAGRANGE_HEXAHEDRON, positions(HEXAHEDRON_333, [3.0; 3]), None, 1.0, 0),
        (code::LAGRANGE_WEDGE, positions(WEDGE_443, [4.0, 4.0, 3.0]), Some([4, 4, 3]), 0.5, 16 * 3 * 3),
    ];
    let field = |p: DVec3| p.y * p.y * p.y - 2.0 * p.x * p.y + p.z * p.z * p.z + p.x * p.x * p.z;
    for (code, points, degrees, volume, count) in cases {
        for subdivision in [1, 2] {
            let grid =
                subdivided(parts_with_scalar(cell(code, points.clone(), degrees), "s", field), subdivision);
            assert!((total_volume(&grid) - volume).abs() < 1e-12, "type {code}: {}", total_volume(&grid));
            assert!(triangle_uses(&grid).values().all(|&uses| uses <= 2));
            for (&p, &s) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
                assert!((s - field(p)).abs() < 1e-12, "type {code}, subdivision {subdivision}: {s} at {p}");
            }
            if subdivision == 1 {
                assert_eq!(grid.points.len(), points.len());
                assert!(
                    count == 0 || grid.tetrahedra.len() == count,
                    "type {code}: {}",
                    grid.tetrahedra.len()
                );
            }
        }
    }
}

#[test]
fn bezier_cells_pass_through_their_curve_and_not_through_their_control_points() {
    // A quadratic Bezier tetrahedron: with control points at the straight middles it is the straight one.
    let points = positions("000 200 020 002 100 110 010 001 101 011", [2.0; 3]);
    let straight = subdivided(cell(code::BEZIER_TETRAHEDRON, points.clone(), None), 1);
    assert!((total_volume(&straight) - 1.0 / 6.0).abs() < 1e-14);
    // Pulling the control point of the edge 0-1 by 0.2 moves the middle of the curve by half of that.
    let mut pulled = points;
    pulled[4].y -= 0.2;
    let curved = subdivided(cell(code::BEZIER_TETRAHEDRON, pulled, None), 1);
    assert!(curved.points.iter().any(|&p| (p - DVec3::new(0.5, -0.1, 0.0)).length() < 1e-15));
    assert!(curved.points.iter().all(|&p| p.y > -0.15), "the control point itself is not drawn");
    let hexahedron = positions(HEXAHEDRON_234, [2.0, 3.0, 4.0]);
    let grid = subdivided(cell(code::BEZIER_HEXAHEDRON, hexahedron, Some([2, 3, 4])), 2);
    assert!((total_volume(&grid) - 1.0).abs() < 1e-12);
    let wedge = positions(WEDGE_443, [4.0, 4.0, 3.0]);
    let grid = subdivided(cell(code::BEZIER_WEDGE, wedge, Some([4, 4, 3])), 2);
    assert!((total_volume(&grid) - 0.5).abs() < 1e-12);
}

#[test]
fn wrong_numbers_of_points_and_too_fine_cuts_are_errors() {
    let points = positions(TETRAHEDRON_4, [4.0; 3]);
    let short = cell(code::LAGRANGE_TETRAHEDRON, points[..34].to_vec(), None);
    let error = build(short, &Options::default(), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("Lagrange tetrahedron") && error.contains("34"), "{error}");
    let fine = Options { subdivision: 17, ..Options::default() };
    let error = build(cell(code::LAGRANGE_TETRAHEDRON, points, None), &fine, &NoProgress).unwrap_err();
    assert!(error.to_string().contains("at most 16"), "{error}");
}
