//! Skipped cells, dropped points, cell values, structured grids, damaged input.

use super::boxes::{Kind, box_of, built, parts_with_scalar};
use super::generate::box_of_tetrahedra;
use super::*;
use crate::error::ErrorKind;
use crate::progress::{NoProgress, Progress};

fn on_cells(mut parts: RawGrid, values: Vec<f64>) -> RawGrid {
    parts.scalar = Some(Scalar { name: "c".into(), association: Association::Cell, values: values.into() });
    parts
}

/// Two bars along x, of lengths 1 and 3, as hexahedra.
fn two_bars() -> RawGrid {
    let mut parts = box_of(Kind::Hexahedra, [2, 1, 1], UNIT, 0.0);
    parts.points.make_mut().iter_mut().for_each(|p| p.x = [0.0, 1.0, 4.0][(2.0 * p.x) as usize]);
    parts
}

#[test]
fn cell_values_are_averaged_by_the_volume_of_the_cells() {
    let grid = built(on_cells(two_bars(), vec![10.0, 2.0])).unwrap();
    for (p, &s) in grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()) {
        // Between the bars (10 × 1 + 2 × 3) / 4.
        let expected = if p.x == 0.0 {
            10.0
        } else if p.x == 1.0 {
            4.0
        } else {
            2.0
        };
        assert!((s - expected).abs() < 1e-14, "{s} at {p}");
    }
    assert_eq!(grid.scalar_name, "c");
}

/// A cube of edge 2, at whose face x = 2 four of edge 1 lie; the five points that hang there. `cells`: which are in the piece.
fn two_sizes(cells: std::ops::Range<usize>) -> RawGrid {
    let low = [[0, 0, 0], [2, 0, 0], [2, 1, 0], [2, 0, 1], [2, 1, 1]];
    let mut places: Vec<[u32; 3]> = Vec::new();
    let mut set = CellSet::default();
    let number = |place: [u32; 3], places: &mut Vec<[u32; 3]>| {
        let known = places.iter().position(|own| *own == place);
        known.unwrap_or_else(|| {
            places.push(place);
            places.len() - 1
        }) as u32
    };
    for cell in cells.clone() {
        let size = if cell == 0 { 2 } else { 1 };
        let corner = |corner: u32| std::array::from_fn(|axis| low[cell][axis] + size * (corner >> axis & 1));
        set.push(code::VOXEL, (0..8).map(|own| number(corner(own), &mut places)));
    }
    let mut hanging = Vec::new();
    if cells.len() == 5 {
        for (place, [a, b]) in [
            ([2, 1, 0], [[2, 0, 0], [2, 2, 0]]),
            ([2, 0, 1], [[2, 0, 0], [2, 0, 2]]),
            ([2, 2, 1], [[2, 2, 0], [2, 2, 2]]),
            ([2, 1, 2], [[2, 0, 2], [2, 2, 2]]),
            ([2, 1, 1], [[2, 0, 0], [2, 2, 2]]),
        ] {
            let [point, a, b] = [place, a, b].map(|place| number(place, &mut places));
            hanging.push(HangingPoint { point, corners: [a, a, a, b], weights: [0.5, 0.0, 0.0, 0.5] });
        }
    }
    let points: Vec<DVec3> = places.iter().map(|place| DVec3::from_array(place.map(f64::from))).collect();
    let values = cells.map(|cell| if cell == 0 { 1.0 } else { 2.5 }).collect();
    on_cells(RawGrid { hanging: Some(hanging), ..RawGrid::new(points, Cells::Mixed(set)) }, values)
}

#[test]
fn means_of_the_greatest_numbers_are_numbers() {
    for value in [f64::MAX, f64::MIN, f64::MIN_POSITIVE] {
        let grid = built(on_cells(two_sizes(0..5), vec![value; 5])).unwrap();
        let scalar = grid.scalar.as_ref().unwrap();
        assert!(scalar.iter().all(|own| (own / value - 1.0).abs() < 1e-15), "{value}");
    }
}

/// The field x at the centres of cells of two sizes: with weights of one over the edge it is exact between them.
#[test]
fn cell_values_of_an_adaptive_grid_are_exact_between_levels() {
    let mut apart = two_sizes(0..5);
    // A point that nothing uses moves the numbers of the others.
    apart.points.make_mut().insert(0, DVec3::splat(9.0));
    let Cells::Mixed(set) = &mut apart.cells else { panic!() };
    set.connectivity.iter_mut().for_each(|corner| *corner += 1);
    let moved = |own: &HangingPoint| HangingPoint {
        point: own.point + 1,
        corners: own.corners.map(|corner| corner + 1),
        ..*own
    };
    apart.hanging = apart.hanging.map(|own| own.iter().map(moved).collect());
    let far = |mut parts: RawGrid| {
        parts.points.make_mut().iter_mut().for_each(|point| point.y += 7.0);
        parts
    };
    let joined = join(vec![far(two_sizes(0..1)), two_sizes(0..5)]).unwrap();
    for grid in [two_sizes(0..5), apart, joined].map(|parts| built(parts).unwrap()) {
        let scalar = grid.scalar.as_ref().unwrap();
        let between: Vec<f64> = (0..grid.points.len())
            .filter(|&p| grid.points[p].x == 2.0 && grid.points[p].y < 5.0)
            .map(|p| scalar[p])
            .collect();
        assert_eq!(between.len(), 9);
        assert!(between.iter().all(|value| (value - 2.0).abs() < 1e-12), "{between:?}");
    }
    let mut beyond = two_sizes(0..5);
    beyond.hanging.as_mut().unwrap()[0].corners[0] = 99;
    let message = built(beyond).unwrap_err().to_string();
    assert!(message.contains("hanging point") && message.contains("99"), "{message}");
}

#[test]
fn cells_without_volume_take_part_only_where_nothing_else_does() {
    let mut parts = on_cells(two_bars(), vec![10.0, 2.0]);
    parts.points.make_mut().iter_mut().filter(|p| p.x == 4.0).for_each(|p| p.x = 1.0);
    let grid = built(parts).unwrap();
    for (p, &s) in grid.scalar.as_ref().unwrap().iter().enumerate() {
        let far = p % 3 == 2;
        assert_eq!(s, if far { 2.0 } else { 10.0 }, "point {p}");
    }
}

#[test]
fn cell_values_can_stay_constant_in_each_cell() {
    let mut parts = on_cells(two_bars(), vec![10.0, 2.0]);
    let x = parts.points.iter().map(|p| p.x).collect();
    parts.point_arrays.insert("x".into(), Array { component_count: 1, values: x });
    parts
        .cell_arrays
        .insert("pair".into(), Array { component_count: 2, values: vec![1.0, 2.0, 3.0, 4.0].into() });
    let options = Options { cell_values: CellValues::Constant, ..Options::default() };
    let grid = build(parts, &options, &NoProgress).unwrap();
    assert_eq!(grid.points.len(), 16);
    assert!((total_volume(&grid) - 4.0).abs() < 1e-14);
    let (s, pair, x) =
        (grid.scalar.as_ref().unwrap(), &grid.point_arrays["pair"].values, &grid.point_arrays["x"].values);
    for (t, &cell) in grid.tetrahedra.iter().zip(grid.source_cells.as_ref().unwrap().iter()) {
        assert!(t.is_sorted());
        for &p in t {
            let p = p as usize;
            assert_eq!(s[p], [10.0, 2.0][cell as usize]);
            assert_eq!(pair[2 * p + 1], [2.0, 4.0][cell as usize]);
            assert_eq!(x[p], grid.points[p].x);
        }
    }
    for method in ["cell-average", "volume-weighted", "least-squares"] {
        let filters = crate::field::filters();
        let filter = filters.iter().find(|filter| filter.declaration().name == method).unwrap();
        let found = crate::field::Method::with_defaults(filter.clone())
            .unwrap()
            .gradient(&grid, s, &NoProgress)
            .unwrap();
        assert!(found.vectors.iter().all(|&v| v == DVec3::ZERO), "{method}");
    }
}

#[test]
fn what_is_not_finite_is_left_out_counted_and_said() {
    for kind in [Kind::Tetrahedra, Kind::Hexahedra, Kind::QuadraticHexahedra, Kind::Polyhedra] {
        let clean = parts_with_scalar(box_of(kind, [3, 3, 3], UNIT, 0.1), "s", |p| p.x);
        let cell_count = clean.cells.count();
        let using = |parts: &RawGrid, point: u32| {
            let Cells::Mixed(set) = &parts.cells else { unreachable!() };
            (0..cell_count)
                .filter(|&c| {
                    let range = set.offsets[c] as usize..set.offsets[c + 1] as usize;
                    set.connectivity[range].contains(&point)
                })
                .count() as u64
        };
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut value = clean.clone();
            value.scalar.as_mut().unwrap().values.make_mut()[21] = bad;
            let mut position = clean.clone();
            position.points.make_mut()[21].z = bad;
            let mut further = clean.clone();
            let mut values = vec![0.0; 2 * clean.points.len()];
            values[43] = bad;
            further.point_arrays.insert("f".into(), Array { component_count: 2, values: values.into() });
            for parts in [value, position, further] {
                let left_out = using(&parts, 21);
                let grid = built(parts).unwrap();
                assert_eq!(grid.origin.cells_not_finite, left_out, "{kind:?}");
                assert!(grid.origin.warnings[0].starts_with(&left_out.to_string()));
                assert!(grid.points.iter().all(|p| p.is_finite()));
                assert!(grid.scalar.as_ref().unwrap().iter().all(|s| s.is_finite()));
                assert!(grid.point_arrays.values().all(|a| a.values.iter().all(|v| v.is_finite())));
            }
        }
        let mut values = vec![1.0; cell_count];
        values[2] = f64::NAN;
        let grid = built(on_cells(clean, values)).unwrap();
        assert_eq!(grid.origin.cells_not_finite, 1);
        assert!(grid.scalar.as_ref().unwrap().iter().all(|&s| s == 1.0));
    }
}

#[test]
fn ghosts_and_surfaces_are_left_out_and_unused_points_dropped() {
    let mut parts = parts_with_scalar(box_of(Kind::Tetrahedra, [2, 1, 1], UNIT, 0.0), "s", |p| p.x);
    let lonely = parts.points.len();
    parts.points.make_mut().extend([DVec3::splat(99.0), DVec3::splat(f64::NAN)]);
    parts.scalar.as_mut().unwrap().values.make_mut().extend([99.0, f64::NAN]);
    let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
    for (kind, corners) in [(5_u8, vec![0, 1, 2]), (1, vec![lonely as u32]), (3, vec![0, 1])] {
        set.push(kind, corners);
    }
    let mut ghost = vec![0; 15];
    ghost[..3].fill(8);
    ghost[3..6].fill(32);
    parts.ghost = Some(ghost);
    let grid = built(parts).unwrap();
    let origin = &grid.origin;
    assert_eq!((origin.cells_ghost, origin.cells_not_volume, origin.cells_not_finite), (6, 3, 0));
    assert_eq!(origin.cells_by_type, [(1, 1), (3, 1), (5, 1), (10, 12)].into());
    assert!(origin.warnings.is_empty());
    // Half of the box is left: its own eight points, in the file's order, with their values.
    assert_eq!(grid.points.len(), 8);
    assert_eq!(grid.source_cells.as_ref().unwrap().to_vec(), (6..12).collect::<Vec<u32>>());
    assert!(grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()).all(|(p, &s)| p.x == s && s >= 0.5));
    assert!((total_volume(&grid) - 0.5).abs() < 1e-14);
}

#[test]
fn structured_grids_equal_their_hexahedra() {
    let hexahedra = built(box_of(Kind::Hexahedra, [3, 2, 4], UNIT, 0.2)).unwrap();
    let parts = RawGrid::new(hexahedra.points.to_vec(), Cells::Structured([4, 3, 5]));
    let structured = built(parts).unwrap();
    assert_eq!(structured.tetrahedra, hexahedra.tetrahedra);
    assert_eq!(structured.source_cells, hexahedra.source_cells);
    let flat = RawGrid::new(vec![DVec3::ZERO; 12], Cells::Structured([4, 3, 1]));
    assert!(built(flat).unwrap_err().to_string().contains("nothing to draw"));
    let wrong = RawGrid::new(vec![DVec3::ZERO; 12], Cells::Structured([4, 3, 2]));
    assert!(built(wrong).unwrap_err().to_string().contains("4 × 3 × 2"));
}

#[test]
fn plain_tetrahedra_are_the_cells_of_the_file() {
    let grid = box_of_tetrahedra([2, 2, 2], UNIT, 0.1);
    let mut own: Vec<[u32; 4]> = grid.tetrahedra.to_vec();
    own.iter_mut().for_each(|t| t.reverse());
    let parts = RawGrid::new(grid.points.to_vec(), Cells::Tetrahedra(own.into()));
    let built = built(parts).unwrap();
    assert!(built.source_cells.is_none());
    assert_eq!(built.tetrahedra, grid.tetrahedra);
    // Cells without volume stay.
    let flat = RawGrid::new(vec![DVec3::ZERO; 4], Cells::Tetrahedra(vec![[3, 1, 0, 2]].into()));
    assert_eq!(boxes::built(flat).unwrap().tetrahedra[0], [0, 1, 2, 3]);
}

#[test]
fn the_error_is_that_of_the_first_damaged_cell_though_another_thread_begins_with_the_second() {
    const COUNT: usize = 100_000;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    for without_tetrahedra in [false, true] {
        let mut parts = box_of(Kind::Hexahedra, [COUNT, 1, 1], UNIT, 0.0);
        let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
        // Threads begin at the middle, or at the chunk of 8,192 cells that holds it.
        (6 * 8192 - 1..=COUNT / 2).for_each(|cell| set.connectivity[8 * cell] = u32::MAX);
        parts.scalar = None;
        let options = Options { without_tetrahedra, ..Options::default() };
        let error = pool.install(|| build(parts, &options, &NoProgress)).unwrap_err().to_string();
        assert!(error.contains("cell 49151 "), "{error}");
    }
}

#[test]
fn damaged_input_is_one_clear_error() {
    let cube = || box_of(Kind::Hexahedra, [2, 1, 1], UNIT, 0.0);
    let with = |f: &dyn Fn(&mut CellSet)| {
        let mut parts = cube();
        if let Cells::Mixed(set) = &mut parts.cells {
            f(set);
        }
        built(parts).unwrap_err().to_string()
    };
    type Damage<'a> = (&'a dyn Fn(&mut CellSet), &'a [&'a str]);
    let cases: [Damage; 5] = [
        (&|s| s.connectivity[9] = 12, &["cell 1", "12", "below 12"]),
        (&|s| s.types[1] = 17, &["cell 1", "unknown type", "17"]),
        (&|s| s.types[1] = 13, &["cell 1", "wedge", "found 8", "6"]),
        (&|s| s.offsets[1] = 7, &["hexahedron", "found 7", "8"]),
        (&|s| s.offsets[2] = 1 << 60, &["offsets", "cell 1"]),
    ];
    for (damage, words) in cases {
        let error = with(damage);
        assert!(words.iter().all(|w| error.contains(w)), "{error}");
    }
    let Cells::Mixed(mut set) = cube().cells else { unreachable!() };
    set.types.fill(7);
    let error = built(RawGrid::new(cube().points, Cells::Mixed(set))).unwrap_err();
    assert!(error.to_string().contains("2 polygons"), "{error}");
    assert_eq!(error.kind, ErrorKind::Run);
    let error =
        built(RawGrid::new(vec![DVec3::ZERO; 3], Cells::Tetrahedra(vec![[0, 1, 2, 3]].into()))).unwrap_err();
    assert!(error.to_string().contains("cell 0") && error.to_string().contains("found 3"), "{error}");
    let empty = built(RawGrid::new(Vec::<DVec3>::new(), Cells::Tetrahedra(Vec::new().into()))).unwrap_err();
    assert!(empty.to_string().contains("no cells"), "{empty}");
    let mut short = cube();
    short.point_arrays.insert("short".into(), Array { component_count: 3, values: vec![0.0; 35].into() });
    let error = built(short).unwrap_err().to_string();
    assert!(error.contains("'short'") && error.contains("35") && error.contains("36"), "{error}");
    let options = Options { subdivision: 0, ..Options::default() };
    assert_eq!(build(cube(), &options, &NoProgress).unwrap_err().kind, ErrorKind::Usage);
}

#[test]
fn types_that_cannot_be_split_are_left_out_and_said() {
    let mut parts = box_of(Kind::Hexahedra, [2, 1, 1], UNIT, 0.0);
    let Cells::Mixed(set) = &mut parts.cells else { unreachable!() };
    set.types[1] = code::CONVEX_POINT_SET;
    let grid = built(parts.clone()).unwrap();
    assert!(grid.origin.warnings[0].contains("1 convex point set"), "{:?}", grid.origin.warnings);
    if let Cells::Mixed(set) = &mut parts.cells {
        set.types[0] = code::CONVEX_POINT_SET;
    }
    let error = built(parts).unwrap_err().to_string();
    assert!(error.contains("convex point set cannot be split"), "{error}");
}

#[test]
fn a_stopped_build_says_so() {
    struct Stopped;
    impl Progress for Stopped {
        fn report(&self, _: &str, _: f64) {}
        fn cancelled(&self) -> bool {
            true
        }
    }
    let parts = box_of(Kind::Hexahedra, [2, 1, 1], UNIT, 0.0);
    assert_eq!(build(parts, &Options::default(), &Stopped).unwrap_err().kind, ErrorKind::Cancelled);
}

#[test]
fn neighbours_and_cells_of_points_are_complete() {
    let grid = box_of_tetrahedra([3, 4, 2], UNIT, 0.1);
    let cells = cells_of_points(&grid);
    let points = points_of_points(&grid, &cells);
    let mut neighbours = Neighbours::default();
    for p in 0..grid.points.len() {
        let expected: Vec<u32> = (0..grid.tetrahedra.len() as u32)
            .filter(|&t| grid.tetrahedra[t as usize].contains(&(p as u32)))
            .collect();
        assert_eq!(cells.row(p), expected);
        let mut ring: Vec<u32> = expected.iter().flat_map(|&t| grid.tetrahedra[t as usize]).collect();
        ring.sort_unstable();
        ring.dedup();
        ring.retain(|&q| q != p as u32);
        let mut found = points.row(p).to_vec();
        assert_eq!(neighbours.around(&grid, &cells, p), found);
        found.sort_unstable();
        assert_eq!(found, ring);
        let mut second: Vec<u32> = ring.iter().flat_map(|&q| points.row(q as usize)).copied().collect();
        second.extend(&ring);
        second.sort_unstable();
        second.dedup();
        second.retain(|&q| q != p as u32);
        let mut found = neighbours.second_ring(&points, p).to_vec();
        found.sort_unstable();
        assert_eq!(found, second);
    }
    assert_eq!(points.count(), grid.points.len());
}
