//! Parts of a grid in pieces have at their cells what the whole grid has there, however it was cut and put together.

use super::boxes::{Kind, box_of};
use super::*;
use crate::field::{CellAverage, GradientFilter, LeastSquares, QuadraticFit, VolumeWeighted};
use crate::grid::halo::{Halo, join_part};
use crate::grid::shared_points::{SharedPoints, shared_points};
use crate::parameters::Parameters;
use crate::progress::NoProgress;
use std::collections::BTreeMap;

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
        let mut set = CellSet { offsets: vec![0], ..CellSet::default() };
        for &cell in &kept {
            if let Some(polyhedron) = polyhedra.get(&(cell as u32)) {
                let face = |face: &Vec<u32>| face.iter().map(|p| numbers[p]).collect();
                let faces = polyhedron.faces.iter().map(face).collect();
                set.polyhedra.push(Polyhedron { cell: set.types.len() as u32, faces });
            }
            set.types.push(all.types[cell]);
            set.connectivity.extend(corners(cell).iter().map(|p| numbers[p]));
            set.offsets.push(set.connectivity.len() as u64);
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
    let halo = |(index, piece): (usize, &RawGrid)| Halo::of(piece.clone(), shared, index, layers).unwrap();
    pieces.iter().enumerate().map(halo).collect()
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
        if own.is_empty() { None } else { built(join_part(own, &halos, &shared).unwrap()) }
    };
    (0..groups).filter_map(part).collect()
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
        for (name, owners) in owners(whole.cells.count(), seed) {
            for case in 0..8 {
                let way = Cut { ids: case & 1 > 0, ghosts: case & 2 > 0, mixed: case & 4 > 0 };
                let pieces = cut(&whole, &owners, way);
                let least = usize::from(way.ghosts);
                for layers in [least, 1, 2, 3] {
                    assert_parts_are_the_grid(&pieces, layers, &format!("{kind:?} in {name}, {way:?}"));
                }
            }
        }
    }
}
