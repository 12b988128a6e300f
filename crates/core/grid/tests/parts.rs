//! Parts of a grid in pieces have at their cells what the whole grid has there, however it was cut and put together.

use super::boxes::{Kind, box_of};
use super::*;
use crate::field::{CellAverage, GradientFilter, LeastSquares, QuadraticFit, VolumeWeighted};
use crate::grid::halo::{Halo, join_part};
use crate::grid::point_keys::{PointKeys, boxes_of_others};
use crate::grid::shared_points::{SharedPoints, keys_of_all, shared_points};
use crate::parameters::Parameters;
use crate::progress::NoProgress;
use std::cell::Cell;
use std::collections::BTreeMap;
use std::sync::{Barrier, Mutex};

/// A box in cells of a kind, with values at points and cells.
fn whole(kind: Kind, n: usize, seed: u64) -> RawGrid {
    let mut raw = shuffled(box_of(kind, [n, n, n], UNIT, 0.2), seed);
    let values = raw.points.iter().map(|p| (3.0 * p.x).sin() + p.y * p.z).collect();
    raw.scalar = Some(Scalar { name: "s".into(), association: Association::Point, values });
    let at_cells: Vec<f64> = (0..raw.cells.count()).map(|cell| (0.7 * cell as f64).sin()).collect();
    raw.cell_arrays.insert("c".into(), at_cells.into());
    raw
}

/// A way to cut a grid.
#[derive(Debug, Clone, Copy)]
struct Cut {
    ids: bool,
    /// With a layer of ghosts in the pieces themselves.
    ghosts: bool,
    /// With the points of each piece in an order of its own.
    mixed: bool,
}

/// The pieces by the number of each cell's; piece 1 has no cells.
fn cut(whole: &RawGrid, owners: &[usize], cut: Cut) -> Vec<RawGrid> {
    let Cells::Mixed(all) = &whole.cells else { panic!("mixed cells") };
    let corners = |cell: usize| &all.connectivity[all.offsets[cell] as usize..all.offsets[cell + 1] as usize];
    let polyhedra: BTreeMap<u32, &Polyhedron> = all.polyhedra.iter().map(|own| (own.cell, own)).collect();
    let scalar = whole.scalar.as_ref().unwrap();
    let piece = |own: usize| {
        let is_own = |cell: &usize| owners[*cell] == own;
        let mut touched = vec![false; whole.points.len()];
        (0..owners.len()).filter(is_own).flat_map(corners).for_each(|&p| touched[p as usize] = true);
        let is_ghost = |cell: usize| cut.ghosts && corners(cell).iter().any(|&p| touched[p as usize]);
        let kept: Vec<usize> = (0..owners.len()).filter(|cell| is_own(cell) || is_ghost(*cell)).collect();
        let mut used: Vec<u32> = kept.iter().flat_map(|&cell| corners(cell)).copied().collect();
        used.sort_unstable();
        used.dedup();
        let mut random = Random(own as u64 + 1);
        for i in (1..used.len()).rev().filter(|_| cut.mixed) {
            used.swap(i, (random.next() * (i + 1) as f64) as usize);
        }
        let numbers: BTreeMap<u32, u32> = used.iter().copied().zip(0..).collect();
        let mut set = CellSet::default();
        for &cell in &kept {
            if let Some(polyhedron) = polyhedra.get(&(cell as u32)) {
                let face = |face: &Vec<u32>| face.iter().map(|p| numbers[p]).collect();
                let faces = polyhedron.faces.iter().map(face).collect();
                set.polyhedra.push(Polyhedron { cell: set.types.len() as u32, faces });
            }
            set.push(all.types[cell], corners(cell).iter().map(|p| numbers[p]));
        }
        let points: Vec<DVec3> = used.iter().map(|&p| whole.points[p as usize]).collect();
        let mut raw = RawGrid::new(points, Cells::Mixed(set));
        let values: Vec<f64> = used.iter().map(|&p| scalar.values[p as usize]).collect();
        raw.scalar = Some(Scalar { values: values.into(), ..scalar.clone() });
        let at_cells: Vec<f64> = kept.iter().map(|&cell| whole.cell_arrays["c"].values[cell]).collect();
        raw.cell_arrays.insert("c".into(), at_cells.into());
        raw.ghost = cut.ghosts.then(|| kept.iter().map(|cell| u8::from(!is_own(cell))).collect());
        raw.global_ids = cut.ids.then(|| used.iter().map(|&p| i64::from(p) * 7 - 100).collect());
        raw
    };
    (0..=*owners.iter().max().unwrap()).map(piece).collect()
}

/// Gradient filters with the array that they look at, by the layers that they need.
const LOOKS: [(&dyn GradientFilter, bool, usize); 6] = [
    (&LeastSquares, false, 1),
    (&CellAverage, false, 1),
    (&VolumeWeighted, false, 1),
    (&QuadraticFit, false, 2),
    (&LeastSquares, true, 2),
    (&QuadraticFit, true, 3),
];

/// Positions of the corners of a tetrahedron, ascending, and all values there.
type Tetrahedron = (Vec<[u64; 3]>, Vec<Vec<f64>>);

/// What is drawn of a grid, with what `layers` layers of cells around it are good for.
fn drawn(grid: &Grid, layers: usize) -> Vec<Tetrahedron> {
    let scalar = grid.scalar.as_ref().unwrap();
    let mut columns: Vec<Vec<f64>> = vec![scalar.to_vec()];
    let means = &grid.point_arrays["c"].values;
    if layers > 0 {
        columns.push(means.to_vec());
    }
    let with_ghosts = grid.with_ghosts();
    for (filter, of_cells, _) in LOOKS.iter().filter(|look| look.2 <= layers) {
        let values = if *of_cells { means } else { scalar };
        let found = filter.gradient(&with_ghosts, values, &Parameters::default(), &NoProgress).unwrap();
        (0..3).for_each(|axis| columns.push(found.vectors.iter().map(|vector| vector[axis]).collect()));
    }
    let of = |corners: &[u32; 4]| {
        let corner = |&p: &u32| {
            let place = grid.points[p as usize].to_array().map(|x| (x + 4.0).to_bits());
            (place, columns.iter().map(|column| column[p as usize]).collect::<Vec<f64>>())
        };
        let mut corners: Vec<_> = corners.iter().map(corner).collect();
        corners.sort_by_key(|corner| corner.0);
        corners.into_iter().unzip()
    };
    let mut all: Vec<Tetrahedron> = grid.tetrahedra.iter().map(of).collect();
    all.sort_by(|a, b| a.0.cmp(&b.0));
    all
}

fn assert_same(found: &[Tetrahedron], expected: &[Tetrahedron], what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}: tetrahedra");
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.0, expected.0, "{what}: another tetrahedron");
        for (found, expected) in found.1.iter().flatten().zip(expected.1.iter().flatten()) {
            // Sums over neighbours in another order.
            let error = (found - expected).abs();
            assert!(error <= 1e-12 * (1.0 + expected.abs()), "{what}: {found} for {expected}");
        }
    }
}

fn built(raw: RawGrid) -> Option<Grid> {
    build_part(raw, &Options::default(), &NoProgress).unwrap()
}

fn halos(pieces: &[RawGrid], shared: &SharedPoints, layers: usize) -> Vec<Option<Halo>> {
    let halo = |(index, piece): (usize, &RawGrid)| {
        Halo::from_piece(&mut piece.clone(), shared, index, layers).unwrap()
    };
    pieces.iter().enumerate().map(halo).collect()
}

/// The number of the first cell of each piece.
fn first_cells(pieces: &[RawGrid]) -> Vec<u64> {
    let end =
        |end: &mut u64, piece: &RawGrid| Some(std::mem::replace(end, *end + piece.cells.count() as u64));
    pieces.iter().scan(0, end).collect()
}

/// The grids of groups of pieces, one after the other.
fn parts(pieces: &[RawGrid], groups: usize, layers: usize) -> Vec<Grid> {
    let shared = shared_points(pieces);
    let halos = halos(pieces, &shared, layers);
    let part = |group: usize| {
        let own = pieces
            .iter()
            .enumerate()
            .filter(|(index, piece)| index % groups == group && piece.cells.count() > 0);
        let own: Vec<(usize, RawGrid)> = own.map(|(index, piece)| (index, piece.clone())).collect();
        if own.is_empty() {
            None
        } else {
            built(join_part(own, &halos, &shared, &first_cells(pieces)).unwrap())
        }
    };
    (0..groups).filter_map(part).collect()
}

/// The number in the whole grid of each cell that is drawn.
fn numbers_of_cells(part: &Grid) -> Vec<u64> {
    (0..part.tetrahedra.len()).map(|i| part.origin.whole_cell(part.source_cell(i) as u32)).collect()
}

fn assert_parts_are_the_grid(pieces: &[RawGrid], layers: usize, what: &str) {
    let all = built(join(pieces.to_vec()).unwrap()).unwrap();
    let expected = drawn(&all, layers);
    for groups in [2, pieces.len()] {
        let parts = parts(pieces, groups, layers);
        let what = format!("{what}, {layers} layers, {groups} groups");
        let mut found: Vec<Tetrahedron> = parts.iter().flat_map(|part| drawn(part, layers)).collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        assert_same(&found, &expected, &what);
        let sum = |count: fn(&ImportStats) -> u64| parts.iter().map(|part| count(&part.origin)).sum::<u64>();
        let cells = |own: &ImportStats| own.cells_by_type.values().sum::<u64>();
        assert_eq!(sum(cells), cells(&all.origin), "{what}");
        assert_eq!(sum(|own| own.ghosts_without_owner), all.origin.ghosts_without_owner, "{what}");
        assert_eq!(sum(|own| own.cells_ghost), all.origin.cells_ghost, "{what}");
        let mut all_cells = numbers_of_cells(&all);
        all_cells.dedup();
        let mut cells: Vec<u64> = parts.iter().flat_map(numbers_of_cells).collect();
        cells.sort_unstable();
        cells.dedup();
        assert_eq!(cells, all_cells, "{what}: numbers of cells");
        for part in &parts {
            assert!(part.origin.warnings.is_empty(), "{what}: {:?}", part.origin.warnings);
        }
    }
}

const KINDS: [Kind; 8] = [
    Kind::Tetrahedra,
    Kind::Voxels,
    Kind::Hexahedra,
    Kind::Wedges,
    Kind::Pyramids,
    Kind::Polyhedra,
    Kind::QuadraticTetrahedra,
    Kind::QuadraticHexahedra,
];

/// Pieces of cells in slabs, taken in turns and at random; none is number 1.
fn owners(cells: usize, seed: u64) -> [(&'static str, Vec<usize>); 3] {
    let number = |piece: usize| if piece == 0 { 0 } else { piece + 1 };
    let mut random = Random(seed);
    [
        ("slabs", (0..cells).map(|cell| number(cell * 4 / cells)).collect()),
        ("in turns", (0..cells).map(|cell| number(cell % 3)).collect()),
        ("scattered", (0..cells).map(|_| number((random.next() * 5.0) as usize)).collect()),
    ]
}

#[test]
fn parts_of_a_grid_are_the_grid() {
    for (seed, kind) in (1..).zip(KINDS) {
        let whole = whole(kind, 3, seed);
        for (turn, (name, owners)) in owners(whole.cells.count(), seed).into_iter().enumerate() {
            for case in 0..8 {
                let way = Cut { ids: case & 1 > 0, ghosts: case & 2 > 0, mixed: case & 4 > 0 };
                let pieces = cut(&whole, &owners, way);
                // Each number of layers with each kind, and with each way over the kinds.
                let layers = (case + turn + seed as usize) % 4;
                let layers = layers.max(usize::from(way.ghosts));
                assert_parts_are_the_grid(&pieces, layers, &format!("{kind:?} in {name}, {way:?}"));
            }
        }
    }
}

const PLAIN: Cut = Cut { ids: false, ghosts: false, mixed: false };

#[test]
fn a_layer_less_is_too_few() {
    let whole = whole(Kind::Hexahedra, 4, 3);
    let pieces = cut(&whole, &owners(whole.cells.count(), 3)[0].1, PLAIN);
    let all = built(join(pieces.clone()).unwrap()).unwrap();
    for layers in 1..=3 {
        let expected = drawn(&all, layers);
        let mut found: Vec<Tetrahedron> =
            parts(&pieces, pieces.len(), layers - 1).iter().flat_map(|part| drawn(part, layers)).collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        assert!(found.iter().zip(&expected).all(|(found, expected)| found.0 == expected.0));
        let differ = |(a, b): (&f64, &f64)| (a - b).abs() > 1e-9;
        let values = |all: &[Tetrahedron]| all.iter().flat_map(|own| own.1.concat()).collect::<Vec<f64>>();
        assert!(values(&found).iter().zip(&values(&expected)).any(differ), "{layers} layers");
    }
}

#[test]
fn values_at_shared_points_with_ids_are_those_of_one_piece() {
    let whole = whole(Kind::Hexahedra, 3, 5);
    let owners = &owners(whole.cells.count(), 5)[2].1;
    for ghosts in [false, true] {
        let mut pieces = cut(&whole, owners, Cut { ids: true, ghosts, mixed: true });
        // Each piece has values of its own.
        for (piece, own) in pieces.iter_mut().zip(0..) {
            let scalar = piece.scalar.as_mut().unwrap();
            scalar.values = scalar.values.iter().map(|value| value + f64::from(own)).collect();
        }
        for layers in usize::from(ghosts)..=2 {
            assert_parts_are_the_grid(&pieces, layers, &format!("own values, ghosts {ghosts}"));
        }
    }
}

#[test]
fn blocks_stay_apart_and_pieces_without_borders_are_parts() {
    let whole = whole(Kind::Wedges, 3, 6);
    for ids in [false, true] {
        let mut pieces = cut(&whole, &owners(whole.cells.count(), 6)[2].1, Cut { ids, ..PLAIN });
        pieces.iter_mut().enumerate().for_each(|(index, piece)| piece.block = index / 3);
        assert_parts_are_the_grid(&pieces, 2, "two blocks");
        pieces.iter_mut().enumerate().for_each(|(index, piece)| piece.block = index);
        assert_parts_are_the_grid(&pieces, 2, "blocks of one piece");
        assert!(halos(&pieces, &shared_points(&pieces), 2).iter().all(Option::is_none));
    }
}

#[test]
fn boundary_values_and_hanging_points_reach_over_borders() {
    let whole = whole(Kind::Hexahedra, 4, 8);
    for (name, owners) in owners(whole.cells.count(), 8) {
        for ids in [false, true] {
            let mut pieces = cut(&whole, &owners, Cut { ids, ..PLAIN });
            let mut random = Random(9);
            for piece in &mut pieces {
                let Cells::Mixed(set) = &piece.cells else { panic!("mixed cells") };
                let (mut boundary, mut hanging) = (BoundaryValues::default(), Vec::new());
                for corners in set.connectivity.chunks(8) {
                    if random.next() < 0.3 {
                        boundary.points.extend(&corners[..4]);
                        boundary.ends.push(boundary.points.len());
                        boundary.values.push(if random.next() < 0.2 { f64::NAN } else { random.next() });
                    }
                    if random.next() < 0.2 {
                        let mut any = || (random.next() * piece.points.len() as f64) as u32;
                        let (point, corners) = (corners[6], [any(), any(), any(), any()]);
                        hanging.push(HangingPoint { point, corners, weights: [0.25; 4] });
                    }
                }
                piece.hanging = Some(hanging);
                piece.boundary_values.insert("c".into(), boundary);
            }
            for layers in 1..=3 {
                let all = built(join(pieces.clone()).unwrap()).unwrap();
                let parts = parts(&pieces, 3, layers);
                let mut found: Vec<Tetrahedron> = parts.iter().flat_map(|part| drawn(part, layers)).collect();
                found.sort_by(|a, b| a.0.cmp(&b.0));
                assert_same(&found, &drawn(&all, layers), &format!("{name}, ids {ids}, {layers} layers"));
                // Values that are not finite are said of the part that has them.
                let count = |grid: &Grid| -> u64 {
                    let words = grid.origin.warnings.iter().filter(|own| own.contains("at the boundary"));
                    words.map(|own| own.split(' ').next().unwrap().parse::<u64>().unwrap()).sum()
                };
                assert!(count(&all) > 1);
                assert_eq!(parts.iter().map(count).sum::<u64>(), count(&all));
            }
        }
    }
}

#[test]
fn ghosts_whose_original_is_nowhere_serve_once() {
    let whole = whole(Kind::Hexahedra, 4, 4);
    for (name, owners) in owners(whole.cells.count(), 4) {
        let mut pieces = cut(&whole, &owners, Cut { ids: true, ghosts: true, mixed: false });
        // The file of this piece is missing.
        pieces.remove(2);
        let all = built(join(pieces.clone()).unwrap()).unwrap();
        assert!(all.origin.ghosts_without_owner > 0);
        let parts = parts(&pieces, pieces.len(), 2);
        let mut found: Vec<Tetrahedron> = parts.iter().flat_map(|part| drawn(part, 2)).collect();
        found.sort_by(|a, b| a.0.cmp(&b.0));
        assert_same(&found, &drawn(&all, 2), name);
        let count: u64 = parts.iter().map(|part| part.origin.ghosts_without_owner).sum();
        assert_eq!(count, all.origin.ghosts_without_owner, "{name}");
    }
}

#[test]
fn curved_cells_add_the_same_points_on_both_sides() {
    for (kind, seed) in [(Kind::QuadraticTetrahedra, 1), (Kind::QuadraticHexahedra, 2)] {
        let whole = whole(kind, 2, seed);
        let options = Options { subdivision: 3, ..Options::default() };
        for (name, owners) in owners(whole.cells.count(), seed) {
            let pieces = cut(&whole, &owners, Cut { mixed: true, ..PLAIN });
            let all = build(join(pieces.clone()).unwrap(), &options, &NoProgress).unwrap();
            let shared = shared_points(&pieces);
            for layers in 0..=1 {
                let halos = halos(&pieces, &shared, layers);
                let of_piece = |(index, piece): (usize, &RawGrid)| {
                    let part =
                        join_part(vec![(index, piece.clone())], &halos, &shared, &first_cells(&pieces))
                            .unwrap();
                    drawn(&build(part, &options, &NoProgress).unwrap(), layers)
                };
                let filled = pieces.iter().enumerate().filter(|piece| piece.1.cells.count() > 0);
                let mut found: Vec<Tetrahedron> = filled.flat_map(of_piece).collect();
                found.sort_by(|a, b| a.0.cmp(&b.0));
                assert_same(&found, &drawn(&all, layers), &format!("{kind:?} in {name}, {layers} layers"));
            }
        }
    }
}

/// The keys that are left where the pieces are dealt out to processes, which are threads here, and the bytes that each process received.
fn retained_by_processes(keys: &[PointKeys], count: usize) -> (Vec<PointKeys>, Vec<usize>) {
    let (messages, barrier) = (Mutex::new(vec![Vec::new(); count]), Barrier::new(count));
    let process = |rank: usize| {
        let byte_count = Cell::new(0);
        let exchange = |to_each: Vec<Vec<u8>>| {
            messages.lock().unwrap()[rank] = to_each;
            barrier.wait();
            let received: Vec<Vec<u8>> =
                messages.lock().unwrap().iter().map(|own: &Vec<Vec<u8>>| own[rank].clone()).collect();
            byte_count.update(|count| count + received.iter().map(Vec::len).sum::<usize>());
            barrier.wait();
            Ok(received)
        };
        let mut own: Vec<PointKeys> = keys.iter().skip(rank).step_by(count).cloned().collect();
        PointKeys::retain_shared(&mut own, count, &exchange).unwrap();
        (own, byte_count.get())
    };
    let of_ranks: Vec<(Vec<PointKeys>, usize)> = std::thread::scope(|scope| {
        let process = &process;
        let threads: Vec<_> = (0..count).map(|rank| scope.spawn(move || process(rank))).collect();
        threads.into_iter().map(|thread| thread.join().unwrap()).collect()
    });
    let retained = (0..keys.len()).map(|piece| of_ranks[piece % count].0[piece / count].clone()).collect();
    (retained, of_ranks.into_iter().map(|own| own.1).collect())
}

#[test]
fn processes_keep_the_keys_that_several_pieces_have() {
    let whole = whole(Kind::Hexahedra, 4, 5);
    for (name, owners) in owners(whole.cells.count(), 9) {
        for case in 0..8 {
            let way = Cut { ids: case & 1 > 0, ghosts: case & 2 > 0, mixed: case & 4 > 0 };
            let keys = keys_of_all(&cut(&whole, &owners, way));
            for count in [1, 2, 5] {
                let (retained, received) = retained_by_processes(&keys, count);
                let what = format!("{name}, {way:?}, {count} processes");
                let shared = SharedPoints::find(&keys);
                assert_eq!(SharedPoints::find(&retained), shared, "{what}");
                for (piece, own) in retained.iter().enumerate() {
                    let points: Vec<u32> = (0..own.count()).map(|key| own.point(key)).collect();
                    let expected: Vec<u32> = shared.of_piece(piece).iter().map(|own| own.point).collect();
                    assert_eq!(
                        points, expected,
                        "{what}: the keys of piece {piece} are those of shared points"
                    );
                }
                // Hashes of 8 bytes and flags of one, about the same share for each process.
                let all = 9 * keys.iter().map(PointKeys::count).sum::<usize>();
                let most = if count == 1 { 0 } else { all / count + all / 10 };
                assert!(received.iter().all(|bytes| *bytes <= most), "{what}: {received:?} of {all} bytes");
            }
            // Of a piece that is alone none.
            assert_eq!(retained_by_processes(&keys[..1], 2).0[0].byte_count(), 0);
        }
    }
}

#[test]
fn every_box_that_meets_that_of_a_piece_is_among_those_of_others() {
    let meets = |[a, b]: [DVec3; 2], [c, d]: [DVec3; 2]| a.cmple(d).all() && c.cmple(b).all();
    let mut of_counts = [0; 3];
    for (seed, count, size) in
        [(1, 40, 0.1), (2, 400, 0.15), (3, 60, 0.9), (4, 1, 1.0), (5, 300, 2.0), (6, 600, 1.2)]
    {
        let mut random = Random(seed);
        // Coordinates of which many are the same, so that boxes touch each other.
        let mut point = || DVec3::from_array(std::array::from_fn(|_| (random.next() * 64.0).floor() / 64.0));
        let mut boxes: Vec<(usize, Option<[DVec3; 2]>)> = (0..count)
            .map(|index| {
                let low = point();
                // A plate through all, and a few without points.
                let high = if index == 7 { low + DVec3::new(0.0, 1.0, 1.0) } else { low + size * point() };
                (index % 3, (index % 11 != 10).then_some([low, high]))
            })
            .collect();
        boxes.push((3, boxes[0].1));
        let found = boxes_of_others(&boxes);
        for (index, (block, own)) in boxes.iter().enumerate() {
            let is_other =
                |(place, other): &(usize, &(usize, Option<[DVec3; 2]>))| *place != index && other.0 == *block;
            let others = boxes.iter().enumerate().filter(is_other).filter_map(|(_, other)| other.1);
            let mut meeting: Vec<_> =
                others.filter(|&other| own.is_some_and(|own| meets(own, other))).collect();
            of_counts[usize::from(!meeting.is_empty()) + usize::from(meeting.len() > 32)] += 1;
            if meeting.len() > 32 {
                meeting = own.iter().copied().collect();
            }
            let sorted = |boxes: &[[DVec3; 2]]| {
                let mut words: Vec<[[u64; 3]; 2]> =
                    boxes.iter().map(|own| own.map(|at| at.to_array().map(f64::to_bits))).collect();
                words.sort_unstable();
                words
            };
            assert_eq!(sorted(&found[index]), sorted(&meeting), "{seed} {index}");
        }
    }
    assert!(of_counts.iter().all(|count| *count > 50), "alone, among few, among many: {of_counts:?}");
}

#[test]
fn pieces_among_many_share_the_points_that_all_boxes_show() {
    let mut random = Random(8);
    // Points of two planes of a lattice, in boxes that meet few others of their plane or all.
    let pieces: Vec<RawGrid> = (0..120)
        .map(|index| {
            let (first, size) = (20.0 * random.next(), if index % 5 == 0 { 40.0 } else { 6.0 });
            let mut coordinate = || (first + size * random.next()).floor();
            let points = (0..50).map(|_| DVec3::new(coordinate(), coordinate(), (index % 2) as f64 * 90.0));
            RawGrid::new(points.collect::<Vec<_>>(), Cells::Tetrahedra(Vec::new().into()))
        })
        .collect();
    let all: Vec<[DVec3; 2]> = vec![[DVec3::NEG_INFINITY, DVec3::INFINITY]];
    let plain: Vec<PointKeys> = pieces.iter().map(|piece| PointKeys::of_places(piece, &all)).collect();
    let shared = SharedPoints::find(&plain);
    assert!((0..pieces.len()).map(|piece| shared.of_piece(piece).len()).sum::<usize>() > 2000);
    assert_eq!(shared_points(&pieces), shared);
}
