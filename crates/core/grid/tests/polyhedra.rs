//! Polyhedra.

use super::boxes::{Kind, box_of, built, parts_with_scalar};
use super::*;

#[test]
fn boxes_of_polyhedra_fill_the_cube_and_conform() {
    for seed in 1..20 {
        let grid = built(shuffled(box_of(Kind::Polyhedra, [3, 2, 2], UNIT, 0.0), seed)).unwrap();
        assert_fills_unit_cube(&grid, &format!("seed {seed}"));
        // Faces that are not plane: still the same triangles on both sides.
        let grid = built(shuffled(box_of(Kind::Polyhedra, [3, 2, 2], UNIT, 0.2), seed)).unwrap();
        assert_fills_unit_cube(&grid, &format!("seed {seed}, jittered"));
    }
}

#[test]
fn polyhedra_share_their_faces_with_hexahedra() {
    for seed in 1..20 {
        let mut parts = shuffled(box_of(Kind::Hexahedra, [2, 2, 2], UNIT, 0.2), seed);
        let faces = {
            let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
            for cell in (0..8).step_by(3) {
                let v: Vec<u32> = set.connectivity[8 * cell..8 * cell + 8].to_vec();
                let face = |f: [usize; 4]| f.map(|c| v[c]).to_vec();
                let faces =
                    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];
                set.types[cell] = code::POLYHEDRON;
                set.polyhedra.push(Polyhedron { cell: cell as u32, faces: faces.map(face).to_vec() });
            }
            set.polyhedra.len()
        };
        assert_eq!(faces, 3);
        assert_fills_unit_cube(&built(parts).unwrap(), &format!("seed {seed}"));
    }
}

/// A polygon in the plane, extruded from z = 0 to 1; some faces turn the other way.
fn extruded(polygon: &[[f64; 2]], order: impl Fn(u32) -> u32) -> RawGrid {
    let n = polygon.len() as u32;
    let mut points = vec![DVec3::ZERO; 2 * n as usize];
    for (i, p) in polygon.iter().enumerate() {
        points[order(i as u32) as usize] = DVec3::new(p[0], p[1], 0.0);
        points[order(n + i as u32) as usize] = DVec3::new(p[0], p[1], 1.0);
    }
    let mut faces = vec![(0..n).map(&order).collect::<Vec<_>>(), (n..2 * n).map(&order).collect()];
    faces.extend((0..n).map(|i| {
        let j = (i + 1) % n;
        vec![order(i), order(j), order(n + j), order(n + i)]
    }));
    let connectivity: Vec<u32> = (0..2 * n).collect();
    let set = CellSet {
        types: vec![code::POLYHEDRON],
        offsets: vec![0, u64::from(2 * n)],
        connectivity,
        polyhedra: vec![Polyhedron { cell: 0, faces }],
    };
    parts_with_scalar(RawGrid::new(points, Cells::Mixed(set)), "s", |p| p.x + 2.0 * p.y - p.z)
}

#[test]
fn convex_prisms_add_no_point() {
    let hexagon: Vec<[f64; 2]> =
        (0..6).map(|i| f64::from(i) * std::f64::consts::FRAC_PI_3).map(|a| [a.cos(), a.sin()]).collect();
    for turn in 0..12 {
        let grid = built(extruded(&hexagon, |i| (i * 5 + turn) % 12)).unwrap();
        assert_eq!(grid.points.len(), 12);
        assert!((total_volume(&grid) - 1.5 * 3.0_f64.sqrt()).abs() < 1e-12);
        assert!(triangle_uses(&grid).values().all(|&uses| uses <= 2));
    }
}

#[test]
fn cells_that_are_not_convex_keep_their_volume() {
    // An L: only points near its inner corner see all of it.
    let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    for turn in 0..12 {
        let grid = built(extruded(&l, |i| (i * 7 + turn) % 12)).unwrap();
        assert!((total_volume(&grid) - 3.0).abs() < 1e-12, "turn {turn}: {}", total_volume(&grid));
        assert!(grid.origin.warnings.is_empty(), "{:?}", grid.origin.warnings);
        // An added point carries the mean of the corners' values, exact for a linear field.
        for (&p, &s) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
            assert!((s - (p.x + 2.0 * p.y - p.z)).abs() < 1e-14);
        }
    }
    // A U that no single point sees whole is drawn all the same, and said.
    let u = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [2.9, 2.0], [2.9, 0.1], [0.1, 0.1], [0.1, 2.0], [0.0, 2.0]];
    let grid = built(extruded(&u, |i| i)).unwrap();
    assert!(grid.origin.warnings[0].starts_with("1 polyhedron is so far"), "{:?}", grid.origin.warnings);
}

#[test]
fn damaged_polyhedra_are_errors() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let mut parts = extruded(&square, |i| i);
    if let Cells::Mixed(set) = &mut parts.cells {
        set.polyhedra[0].faces[2][1] = 99;
    }
    let error = built(parts).unwrap_err().to_string();
    assert!(error.contains("99") && error.contains("below 8"), "{error}");
    let mut parts = extruded(&square, |i| i);
    if let Cells::Mixed(set) = &mut parts.cells {
        set.polyhedra.clear();
    }
    assert!(built(parts).unwrap_err().to_string().contains("has no faces"));
    let mut parts = extruded(&square, |i| i);
    parts.points.make_mut()[3].y = f64::NAN;
    let error = built(parts).unwrap_err().to_string();
    assert!(error.contains("nothing to draw") && error.contains("not finite"), "{error}");
}
