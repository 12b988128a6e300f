//! Linear cells.

use super::boxes::{Kind, box_of, built};
use super::*;

#[test]
fn every_linear_kind_fills_the_cube_and_conforms() {
    for kind in [Kind::Tetrahedra, Kind::Voxels, Kind::Hexahedra, Kind::Wedges, Kind::Pyramids] {
        for seed in 1..20 {
            let jitter = if kind == Kind::Voxels { 0.0 } else { 0.2 };
            let parts = shuffled(box_of(kind, [3, 2, 4], UNIT, jitter), seed);
            let grid = built(parts).unwrap();
            assert_fills_unit_cube(&grid, &format!("{kind:?}, seed {seed}"));
        }
    }
}

/// The quadrilaterals of a hexahedron (VTK's order).
const HEX_FACES: [[usize; 4]; 6] =
    [[0, 4, 7, 3], [1, 2, 6, 5], [0, 1, 5, 4], [3, 7, 6, 2], [0, 3, 2, 1], [4, 5, 6, 7]];

#[test]
fn hexahedra_follow_the_published_cases() {
    let cube = box_of(Kind::Hexahedra, [1, 1, 1], UNIT, 0.0);
    let mut seen = [0; 4];
    for seed in 1..400 {
        let parts = shuffled(cube.clone(), seed);
        let Cells::Mixed(set) = &parts.cells else { unreachable!() };
        let v: [u32; 8] = set.connectivity[..].try_into().unwrap();
        let grid = built(parts.clone()).unwrap();
        let edges: std::collections::HashSet<(u32, u32)> = grid
            .tetrahedra
            .iter()
            .flat_map(|&[a, b, c, d]| [(a, b), (a, c), (a, d), (b, c), (b, d), (c, d)])
            .collect();
        let has = |a: u32, b: u32| edges.contains(&(a.min(b), a.max(b)));
        // Each face is cut through its lowest corner.
        for face in HEX_FACES {
            let f = face.map(|c| v[c]);
            let first = (0..4).min_by_key(|&i| f[i]).unwrap();
            assert!(has(f[first], f[(first + 2) % 4]), "{f:?}");
            assert!(!has(f[(first + 1) % 4], f[(first + 3) % 4]), "{f:?}");
        }
        // n diagonals through the corner opposite to the lowest (number 0 after the shuffle).
        let o = v.iter().position(|&p| p == 0).unwrap();
        let opposite = [6, 7, 4, 5, 2, 3, 0, 1];
        let p = v[opposite[o]];
        let n = HEX_FACES
            .iter()
            .map(|face| face.map(|c| v[c]))
            .filter(|f| !f.contains(&0))
            .filter(|f| {
                let at = f.iter().position(|&c| c == p).unwrap();
                has(p, f[(at + 2) % 4])
            })
            .count();
        seen[n] += 1;
        assert_eq!(grid.tetrahedra.len(), if n == 0 { 5 } else { 6 });
        // Inside: no diagonal for n = 0, one between a corner beside the lowest and its opposite for n = 1,
        // the one from the lowest corner for n = 2 and 3.
        let inside: Vec<usize> = (0..4).filter(|&c| has(v[c], v[opposite[c]])).collect();
        let of_o = [o, opposite[o]];
        match n {
            0 => assert!(inside.is_empty()),
            1 => assert!(inside.len() == 1 && !of_o.contains(&inside[0])),
            _ => assert!(inside.len() == 1 && of_o.contains(&inside[0])),
        }
    }
    assert!(seen.iter().all(|&count| count > 0), "every case was seen: {seen:?}");
}

#[test]
fn hexahedra_of_one_diagonal_meet_where_the_others_do() {
    // By hand: lowest corner 0 at (0,0,0), opposite corner at (1,1,1). Only the face x = 1 is cut through it:
    // the lowest of that face is the corner (1,0,0) = 1. The faces y = 1 and z = 1 are cut through (0,1,1) = 2.
    let ids = [0, 1, 5, 6, 3, 4, 7, 2]; // VTK's order
    let mut parts = box_of(Kind::Hexahedra, [1, 1, 1], UNIT, 0.0);
    let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
    let old = set.connectivity.clone();
    let points: Vec<DVec3> = old.iter().map(|&p| parts.points[p as usize]).collect();
    for (k, &id) in ids.iter().enumerate() {
        parts.points.make_mut()[id as usize] = points[k];
    }
    set.connectivity = ids.to_vec();
    let mut found = built(parts).unwrap().tetrahedra.to_vec();
    found.sort_unstable();
    // Dompierre et al., table 7, second column with I = (0, 1, 5, 6, 3, 4, 7, 2):
    // (I1 I6 I8 I5) (I1 I2 I8 I6) (I2 I7 I8 I6) (I1 I8 I3 I4) (I1 I8 I2 I3) (I2 I8 I7 I3).
    let mut expected =
        vec![[0, 4, 2, 3], [0, 1, 2, 4], [1, 7, 2, 4], [0, 2, 5, 6], [0, 2, 1, 5], [1, 2, 7, 5]];
    expected.iter_mut().for_each(|t: &mut [u32; 4]| t.sort_unstable());
    expected.sort_unstable();
    assert_eq!(found, expected);
}
