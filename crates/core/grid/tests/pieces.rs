//! A grid cut into pieces is the grid: same cells in the same places, means and gradients, however it was cut.

use super::*;
use crate::field::{LeastSquares, Method};
use crate::grid::generate::lattice;
use crate::parameters::Parameters;
use crate::progress::NoProgress;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Hexahedra and wedges over a jittered lattice, with values at points and cells.
fn whole(n: usize) -> RawGrid {
    let points = lattice([n; 3], UNIT, 0.2);
    let mut set = CellSet::default();
    for cell in 0..n * n * n {
        let [a, b, c, d, e, f, g, h] = structured_corners([n + 1; 3], cell);
        let cells: &[(u8, &[u32])] = match cell % 3 {
            0 => &[(code::HEXAHEDRON, &[a, b, d, c, e, f, h, g])],
            1 => &[(code::VOXEL, &[a, b, c, d, e, f, g, h])],
            _ => &[(code::WEDGE, &[a, b, d, e, f, h]), (code::WEDGE, &[a, d, c, e, h, g])],
        };
        for (code, corners) in cells {
            set.push(*code, corners.iter().copied());
        }
    }
    let at_points = points.iter().map(|p| (3.0 * p.x).sin() + p.y * p.z).collect::<Vec<f64>>();
    let at_cells = (0..set.types.len()).map(|cell| (0.7 * cell as f64).sin()).collect::<Vec<f64>>();
    let mut raw = RawGrid::new(points, Cells::Mixed(set));
    let scalar = Scalar { name: "s".into(), association: Association::Point, values: at_points.into() };
    raw.scalar = Some(scalar);
    raw.cell_arrays.insert("c".into(), at_cells.into());
    raw
}

/// The cells for which `keep` gives flags, with the points that they use, in the order of the grid.
fn piece(whole: &RawGrid, ids: bool, keep: impl Fn(usize) -> Option<u8>) -> RawGrid {
    let Cells::Mixed(all) = &whole.cells else { panic!("mixed cells") };
    let corners = |cell: usize| &all.connectivity[all.offsets[cell] as usize..all.offsets[cell + 1] as usize];
    let kept: Vec<(usize, u8)> =
        (0..all.types.len()).filter_map(|cell| keep(cell).map(|flags| (cell, flags))).collect();
    let mut used: Vec<u32> = kept.iter().flat_map(|&(cell, _)| corners(cell)).copied().collect();
    used.sort_unstable();
    used.dedup();
    let mut set = CellSet::default();
    for &(cell, _) in &kept {
        set.push(all.types[cell], corners(cell).iter().map(|&p| used.partition_point(|&q| q < p) as u32));
    }
    let points: Vec<DVec3> = used.iter().map(|&p| whole.points[p as usize]).collect();
    let mut raw = RawGrid::new(points, Cells::Mixed(set));
    let scalar = whole.scalar.as_ref().unwrap();
    let values: Vec<f64> = used.iter().map(|&p| scalar.values[p as usize]).collect();
    raw.scalar = Some(Scalar { values: values.into(), ..scalar.clone() });
    let at_cells: Vec<f64> = kept.iter().map(|&(cell, _)| whole.cell_arrays["c"].values[cell]).collect();
    raw.cell_arrays.insert("c".into(), at_cells.into());
    raw.ghost = kept.iter().any(|kept| kept.1 != 0).then(|| kept.iter().map(|kept| kept.1).collect());
    raw.global_ids = ids.then(|| used.iter().map(|&p| i64::from(p) * 7 - 100).collect());
    raw
}

/// The pieces by the number of each cell's; with a layer of ghosts where asked for.
fn cut(whole: &RawGrid, part: &[usize], ids: bool, ghosts: bool) -> Vec<RawGrid> {
    let Cells::Mixed(all) = &whole.cells else { panic!("mixed cells") };
    let corners = |cell: usize| &all.connectivity[all.offsets[cell] as usize..all.offsets[cell + 1] as usize];
    (0..=*part.iter().max().unwrap())
        .map(|own| {
            let mut touched = vec![false; whole.points.len()];
            let own_cells = (0..part.len()).filter(|&cell| part[cell] == own);
            own_cells.flat_map(corners).for_each(|&p| touched[p as usize] = true);
            piece(whole, ids, |cell| match part[cell] == own {
                true => Some(0),
                false => (ghosts && corners(cell).iter().any(|&p| touched[p as usize])).then_some(1),
            })
        })
        .collect()
}

fn built(raw: RawGrid) -> Grid {
    build(raw, &Options::default(), &NoProgress).unwrap()
}

fn gradient(grid: &Grid) -> Vec<DVec3> {
    let method = Method::new(Arc::new(LeastSquares), Parameters::default()).unwrap();
    method.gradient(grid, grid.scalar.as_ref().unwrap(), &NoProgress).unwrap().vectors
}

/// Tetrahedra by their places: corners in ascending places, each with its value, mean of cells and gradient.
type ByPlace = BTreeMap<Vec<[u64; 3]>, Vec<[f64; 5]>>;

fn by_place(grid: &Grid) -> ByPlace {
    let vectors = gradient(grid);
    let values = |p: u32| {
        let p = p as usize;
        let [x, y, z] = vectors[p].to_array();
        [grid.scalar.as_ref().unwrap()[p], grid.point_arrays["c"].values[p], x, y, z]
    };
    let of = |&corners: &[u32; 4]| {
        let mut corners =
            corners.map(|p| (grid.points[p as usize].to_array().map(|x| (x + 4.0).to_bits()), values(p)));
        corners.sort_by_key(|corner| corner.0);
        corners.into_iter().unzip()
    };
    grid.tetrahedra.iter().map(of).collect()
}

fn assert_same(found: &ByPlace, expected: &ByPlace, what: &str) {
    assert!(found.keys().eq(expected.keys()), "{what}: other tetrahedra");
    for (found, expected) in found.values().flatten().flatten().zip(expected.values().flatten().flatten()) {
        // Sums over neighbours in another order.
        assert!((found - expected).abs() <= 1e-12 * (1.0 + expected.abs()), "{what}: {found} for {expected}");
    }
}

#[test]
fn a_grid_in_pieces_is_the_grid() {
    let whole = whole(6);
    let expected = by_place(&built(whole.clone()));
    let cells = whole.cells.count();
    let mut random = Random(7);
    for count in [1, 2, 8, 64] {
        let slabs: Vec<usize> = (0..cells).map(|cell| cell * count / cells).collect();
        let scattered: Vec<usize> = (0..cells).map(|_| (random.next() * count as f64) as usize).collect();
        for (name, part) in [("slabs", slabs), ("scattered", scattered)] {
            for (ids, ghosts) in [(false, false), (true, false), (false, true), (true, true)] {
                let what = format!("{count} {name}, ids {ids}, ghosts {ghosts}");
                let joined = join(cut(&whole, &part, ids, ghosts)).unwrap();
                assert_eq!(joined.points.len(), whole.points.len(), "{what}");
                let grid = built(joined);
                assert_eq!(grid.origin.ghosts_without_owner, 0, "{what}");
                assert!(grid.origin.warnings.is_empty(), "{what}: {:?}", grid.origin.warnings);
                assert_same(&by_place(&grid), &expected, &what);
            }
        }
    }
}

#[test]
fn ghosts_without_owner_serve_and_are_not_drawn() {
    let whole = whole(5);
    let cells = whole.cells.count();
    let mut all = by_place(&built(whole.clone()));
    let part: Vec<usize> = (0..cells).map(|cell| usize::from(cell >= cells / 2)).collect();
    let own = cut(&whole, &part, true, true).swap_remove(0);
    let ghosts = own.ghost.iter().flatten().filter(|&&flags| flags == 1).count() as u64;
    let grid = built(own.clone());
    assert_eq!((grid.origin.ghosts_without_owner, grid.origin.cells_ghost), (ghosts, ghosts));
    assert!(grid.origin.warnings.iter().any(|warning| warning.contains("ghost cells have no owner")));
    let found = by_place(&grid);
    let drawn =
        built(RawGrid { ghost: own.ghost.clone().map(|flags| flags.iter().map(|f| f * 8).collect()), ..own });
    assert_eq!(found.len(), drawn.tetrahedra.len());
    all.retain(|place, _| found.contains_key(place));
    assert_same(&found, &all, "half of the grid");
    // What ghosts alone use comes last and is in no bounds.
    assert!(grid.drawn_points() < grid.points.len());
    assert_eq!(grid.bounds(), drawn.bounds());
}

#[test]
fn a_crack_and_a_jump_stay_and_blocks_stay_apart() {
    let points =
        |z: f64| vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.2, 0.2, z), DVec3::X, DVec3::ZERO];
    let tetrahedron = |z: f64, value: f64, block: usize| {
        let cells = Cells::Tetrahedra(vec![[0, 1, 2, 3], [5, 4, 2, 3]].into());
        let mut raw = RawGrid::new(points(z), cells);
        let values = vec![value, 1.0, 2.0, z, 1.0, value];
        let scalar = Scalar { name: "s".into(), association: Association::Point, values: values.into() };
        (raw.scalar, raw.block) = (Some(scalar), block);
        raw
    };
    let count = |pieces: Vec<RawGrid>| join(pieces).unwrap().points.len();
    // The two points at the origin and at x = 1 of a piece stay two; each is one with its like of the other piece.
    assert_eq!(count(vec![tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.0, 0)]), 7);
    assert_eq!(count(vec![tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.5, 0)]), 9);
    assert_eq!(count(vec![tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.0, 1)]), 12);
    let parts = |pieces: &[RawGrid]| {
        SharedPoints::by_values(pieces).is_some_and(|shared| shared.are_parted_by_values(pieces))
    };
    assert!(!parts(&[tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.0, 0)]));
    assert!(parts(&[tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.5, 0)]));
    assert!(!parts(&[tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.5, 1)]));
    assert!(!parts(&[tetrahedron(1.0, 0.5, 0)]));
    // Global ids stand above values where both pieces have them.
    let with_ids = |value: f64| RawGrid { global_ids: Some((0..6).collect()), ..tetrahedron(1.0, value, 0) };
    assert!(!parts(&[with_ids(0.0), with_ids(0.5)]));
    assert!(parts(&[with_ids(0.0), tetrahedron(-1.0, 0.5, 0)]));
    // Joined by the points that were found before, as by those that are found then.
    let pair = || vec![tetrahedron(1.0, 0.0, 0), tetrahedron(-1.0, 0.5, 0)];
    let text = |raw: Result<RawGrid>| format!("{:?}", raw.unwrap());
    assert_eq!(text(join_by(pair(), SharedPoints::by_values(&pair()))), text(join(pair())));
    let three = [pair(), vec![RawGrid::default()]].concat();
    let error = join_by(three.clone(), SharedPoints::by_values(&three)).unwrap_err().to_string();
    assert!(error.contains("found 3; expected 2 pieces, those with cells"), "{error}");
    let bare = RawGrid { scalar: None, ..tetrahedron(1.0, 0.0, 0) };
    let error = join(vec![tetrahedron(1.0, 0.0, 0), bare]).unwrap_err().to_string();
    assert!(error.contains("lacks the array 's'"), "{error}");
}

#[test]
fn ghosts_with_older_values_do_not_stand_for_their_owners() {
    let whole = whole(4);
    let part: Vec<usize> = (0..whole.cells.count()).map(|cell| cell % 2).collect();
    let mut pieces = cut(&whole, &part, true, true);
    for piece in &mut pieces {
        let Cells::Mixed(set) = &piece.cells else { panic!("mixed cells") };
        let mut owned = vec![false; piece.points.len()];
        for (cell, flags) in piece.ghost.iter().flatten().enumerate() {
            let range = set.offsets[cell] as usize..set.offsets[cell + 1] as usize;
            set.connectivity[range].iter().for_each(|&p| owned[p as usize] |= *flags == 0);
        }
        let scalar = piece.scalar.as_mut().unwrap();
        let stale = scalar.values.iter().zip(owned).map(|(&v, owned)| if owned { v } else { -99.0 });
        scalar.values = stale.collect();
    }
    let found = by_place(&built(join(pieces).unwrap()));
    assert_same(&found, &by_place(&built(whole)), "older values at ghosts");
}

#[test]
fn orders_that_contradict_each_other_still_give_one_grid() {
    let whole = whole(4);
    let cells = whole.cells.count();
    let part: Vec<usize> = (0..cells).map(|cell| cell * 3 / cells).collect();
    for ids in [false, true] {
        let pieces = cut(&whole, &part, ids, false);
        let mixed = pieces.into_iter().zip(1..).map(|(piece, seed)| {
            let points: Vec<DVec3> = piece.points.to_vec();
            let (given, values) = (piece.global_ids.clone(), piece.scalar.clone().unwrap());
            let mut piece = shuffled(piece, seed);
            let from = |p: &DVec3| points.iter().position(|q| q == p).unwrap();
            let old: Vec<usize> = piece.points.iter().map(from).collect();
            piece.global_ids = given.map(|ids| old.iter().map(|&p| ids[p]).collect());
            let own: Vec<f64> = old.iter().map(|&p| values.values[p]).collect();
            piece.scalar = Some(Scalar { values: own.into(), ..values });
            piece
        });
        let grid = built(join(mixed.collect()).unwrap());
        assert_fills_unit_cube_but_wedges(&grid, &whole);
        if ids {
            // The order of ids is that of the grid that was cut.
            assert_same(&by_place(&grid), &by_place(&built(whole.clone())), "by ids");
        }
    }
}

fn assert_fills_unit_cube_but_wedges(grid: &Grid, whole: &RawGrid) {
    assert_eq!(grid.points.len(), whole.points.len());
    assert!((total_volume(grid) - total_volume(&built(whole.clone()))).abs() < 1e-3);
    assert!(triangle_uses(grid).values().all(|&uses| uses <= 2));
}

#[test]
fn structured_pieces_become_hexahedra_for_their_cells_may_be_no_boxes() {
    let sheared = |shift: f64| {
        let points = lattice([1; 3], UNIT, 0.0).into_iter();
        RawGrid::new(
            points.map(|p| DVec3::new(p.x + shift, p.y + p.x, p.z)).collect::<Vec<_>>(),
            Cells::Structured([2; 3]),
        )
    };
    let joined = join(vec![sheared(0.0), sheared(5.0)]).unwrap();
    let Cells::Mixed(set) = &joined.cells else { panic!("mixed cells") };
    assert_eq!(
        (&set.types[..], &set.connectivity[..8]),
        (&[code::HEXAHEDRON; 2][..], &[0, 1, 3, 2, 4, 5, 7, 6][..])
    );
}
