//! Subsets: volumes in closed form, no cracks, values that come along.

use super::*;
use crate::grid::generate::{box_of_tetrahedra, lattice, sample, with_scalar};
use crate::progress::NoProgress;
use crate::volume::Volume;
use std::sync::Arc;

fn above(grid: &Grid, field: &[f64], value: f64) -> Subset {
    cells_above(grid, field, value, &NoProgress).unwrap()
}

/// Volume of the part of the unit cube in which a x + b y + c z ≤ t, all coefficients above 0: inclusion and exclusion of its corners.
fn below_plane(coefficients: [f64; 3], t: f64) -> f64 {
    let corner = |set: u32| {
        let sum: f64 = (0..3).filter(|k| set >> k & 1 == 1).map(|k| coefficients[k]).sum();
        let sign = if set.count_ones() % 2 == 1 { -1.0 } else { 1.0 };
        sign * (t - sum).max(0.0).powi(3)
    };
    (0..8).map(corner).sum::<f64>() / (6.0 * coefficients.iter().product::<f64>())
}

#[test]
fn the_part_above_a_plane_has_its_volume() {
    let coefficients = [0.7, 1.3, 0.4];
    let grid = box_of_tetrahedra([4, 5, 3], UNIT, 0.25);
    let field = sample(&grid, |p| p.dot(DVec3::from(coefficients)));
    let other = |p: DVec3| 3.0 * p.x - p.y + 0.5 * p.z;
    let values = sample(&grid, other);
    for value in [0.05, 0.31, 0.9, 1.2, 1.7, 2.35] {
        let part = above(&grid, &field, value);
        let cut = part.grid(&grid);
        let expected = 1.0 - below_plane(coefficients, value);
        // Sums of a thousand volumes, each of a few roundings.
        assert!((total_volume(&cut) - expected).abs() < 1e-13, "{} at {value}", total_volume(&cut));
        assert_sound(&cut);
        assert!(cut.points.iter().all(|p| p.dot(coefficients.into()) > value - 1e-14));
        for (p, found) in cut.points.iter().zip(part.of_points(|p| values[p as usize])) {
            assert!((found - other(*p)).abs() < 1e-14);
        }
        // Each part lies in the cell that it is of.
        for (i, &origin) in part.origins.iter().enumerate() {
            let whole = grid.tetrahedra[origin as usize];
            let is_within = |p: &u32| part.points[*p as usize].ends.iter().all(|end| whole.contains(end));
            assert!(part.tetrahedra[i].iter().all(is_within));
        }
        let turned: Vec<f64> = field.iter().map(|f| -f).collect();
        let rest = total_volume(&above(&grid, &turned, -value).grid(&grid));
        assert!((rest + expected - 1.0).abs() < 1e-13, "{rest}");
    }
    assert_eq!(above(&grid, &field, 2.5), Subset::default());
    let all = above(&grid, &field, 0.0);
    assert_eq!(all.tetrahedra, *grid.tetrahedra);
    assert_eq!(all.grid(&grid).points, grid.points);
}

/// Ascending corners, faces of no more than two cells, and a boundary that is closed and encloses the volume.
fn assert_sound(grid: &Grid) {
    assert!(grid.tetrahedra.iter().all(|t| t.windows(2).all(|pair| pair[0] < pair[1])));
    assert!(triangle_uses(grid).values().all(|&uses| uses <= 2));
    let surface = boundary(grid, &NoProgress).unwrap();
    let mut sides = HashMap::<[u32; 2], i32>::new();
    for &[a, b, c] in &surface.triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            *sides.entry([p.min(q), p.max(q)]).or_default() += if p < q { 1 } else { -1 };
        }
    }
    assert!(sides.values().all(|&count| count == 0), "the boundary is open");
    let at = surface.positions(&grid.points);
    let volume = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|p| at[p as usize]);
        (b - a).cross(c - a).dot(a) / 6.0
    };
    let enclosed: f64 = surface.triangles.iter().map(volume).sum();
    assert!((enclosed - total_volume(grid)).abs() < 1e-13, "{enclosed}");
}

/// Share of a tetrahedron in which a field of these corner values is at most t: the divided difference of (t − f)³.
fn share_below(corners: [f64; 4], t: f64) -> f64 {
    let term = |i: usize| {
        let others = (0..4).filter(|&j| j != i).map(|j| corners[j] - corners[i]);
        (t - corners[i]).max(0.0).powi(3) / others.product::<f64>()
    };
    (0..4).map(term).sum()
}

#[test]
fn each_tetrahedron_keeps_its_share() {
    let mut random = Random(7);
    for _ in 0..500 {
        let mut point = || DVec3::new(random.next(), random.next(), random.next());
        let points = [0; 4].map(|_| point());
        let values = [0; 4].map(|_| random.next());
        let cells = Cells::Tetrahedra(vec![[0, 1, 2, 3]].into());
        let grid = build(RawGrid::new(points.to_vec(), cells), &Options::default(), &NoProgress).unwrap();
        let value = random.next();
        let kept = total_volume(&above(&grid, &values, value).grid(&grid)) / total_volume(&grid);
        let least =
            (0..4).flat_map(|i| (0..i).map(move |j| (values[i] - values[j]).abs())).fold(1.0, f64::min);
        // The closed form divides roundings by products of differences.
        let tolerance = 1e-14 / least.powi(2);
        assert!((kept - 1.0 + share_below(values, value)).abs() < tolerance, "{kept} of {values:?}");
    }
}

#[test]
fn cuts_through_points_make_no_cracks() {
    let grid = box_of_tetrahedra([5, 4, 6], UNIT, 0.2);
    for seed in 1..12 {
        let mut random = Random(seed);
        let field: Vec<f64> = grid.points.iter().map(|_| (4.0 * random.next()).floor()).collect();
        for value in [1.0, 1.5, 2.0, 3.0] {
            let part = above(&grid, &field, value);
            assert!(triangle_uses(&part.grid(&grid)).values().all(|&uses| uses <= 2));
            // Faces of one cell alone lie in the sides of the box or have the value at all corners.
            let reached = part.of_points(|p| field[p as usize]);
            let at = part.of_points(|p| grid.points[p as usize]);
            for (face, uses) in triangle_uses(&part.grid(&grid)) {
                let is_on_side = (0..3).any(|axis| {
                    [0.0, 1.0].iter().any(|side| face.iter().all(|&p| at[p as usize][axis] == *side))
                });
                let is_cut = face.iter().all(|&p| (reached[p as usize] - value).abs() < 1e-15);
                assert!(uses == 2 || is_on_side || is_cut, "{value} of field {seed}: {face:?}");
            }
        }
    }
}

#[test]
fn a_volume_comes_along() {
    let mut grid = with_scalar(box_of_tetrahedra([3; 3], UNIT, 0.2), "T", |p| p.x - 2.0 * p.z);
    let vectors: Vec<[f64; 3]> = sample(&grid, |p| [p.y, 1.0 - p.x, p.z]);
    grid.point_arrays.insert("v".into(), Arc::new(vectors.into()));
    let ids: Vec<f64> = (0..grid.tetrahedra.len()).map(|i| i as f64).collect();
    grid.cell_arrays.insert("id".into(), Arc::new(ids.into()));
    let gradient = vec![DVec3::new(1.0, 0.0, -2.0); grid.points.len()];
    let scalar = grid.scalar.clone().unwrap();
    let g = sample(&grid, |p| p.y);
    let (gradient, gradient_magnitude) = (Some(gradient.into()), Some(g.into()));
    let volume = Volume { grid: Arc::new(grid), scalar, gradient, gradient_magnitude };
    let is_kept = |i: usize| i.is_multiple_of(3);
    let whole = whole_cells(&volume.grid, is_kept, &NoProgress).unwrap();
    let cut = above(&volume.grid, &volume.scalar, -0.3);
    for part in [&whole, &cut] {
        let own = volume.subset(part);
        let grid = &own.grid;
        assert_eq!(grid.scalar.as_ref(), Some(&own.scalar));
        assert_eq!((grid.scalar_name.as_str(), &grid.cell_arrays), ("T", &volume.grid.cell_arrays));
        let (g, all) = (own.gradient_magnitude.as_ref().unwrap(), own.gradient.as_ref().unwrap());
        let vectors = grid.point_arrays["v"].values.chunks(3);
        for (i, (p, vector)) in grid.points.iter().zip(vectors).enumerate() {
            assert!((own.scalar[i] - (p.x - 2.0 * p.z)).abs() < 1e-15 && (g[i] - p.y).abs() < 1e-15);
            assert!(all[i].distance(DVec3::new(1.0, 0.0, -2.0)) < 1e-15);
            assert!(DVec3::from_slice(vector).distance(DVec3::new(p.y, 1.0 - p.x, p.z)) < 1e-15);
        }
        for i in 0..grid.tetrahedra.len() {
            assert_eq!(grid.source_cell(i) as u32, part.origins[i]);
        }
    }
    let expected: Vec<u32> = (0..volume.grid.tetrahedra.len() as u32).filter(|i| i % 3 == 0).collect();
    assert_eq!(whole.origins, expected);
    // Corners of whole cells are the same numbers as before.
    for (part, &origin) in whole.tetrahedra.iter().zip(&whole.origins) {
        let before = part.map(|p| whole.points[p as usize].ends[0]);
        assert_eq!(before, volume.grid.tetrahedra[origin as usize]);
    }
}

#[test]
fn whole_cells_of_the_file_stay_or_go() {
    let parts = RawGrid::new(lattice([4, 2, 2], UNIT, 0.0), Cells::Structured([5, 3, 3]));
    let grid = build(parts, &Options::default(), &NoProgress).unwrap();
    for (is_all, first) in [(true, 2), (false, 1)] {
        // Points from x = 0.5 on.
        let kept = cells_by_points(&grid, is_all, |p| grid.points[p as usize].x >= 0.5);
        for (i, &kept) in kept.iter().enumerate() {
            assert_eq!(kept, grid.source_cell(i) % 4 >= first, "tetrahedron {i}");
        }
        let part = whole_cells(&grid, |i| kept[i], &NoProgress).unwrap();
        assert!((total_volume(&part.grid(&grid)) - (4 - first) as f64 / 4.0).abs() < 1e-14);
        assert_sound(&part.grid(&grid));
    }
}

#[test]
fn missing_and_extreme_values_are_no_trouble() {
    let grid = box_of_tetrahedra([3; 3], UNIT, 0.0);
    let mut field = sample(&grid, |p| p.x);
    field[0] = f64::NAN;
    let part = above(&grid, &field, 0.0);
    let around = grid.tetrahedra.iter().filter(|corners| corners.contains(&0)).count();
    assert!(around > 0 && part.tetrahedra.len() == grid.tetrahedra.len() - around);
    let huge = sample(&grid, |p| if p.x < 0.5 { -1.5e308 } else { 1.5e308 });
    let part = above(&grid, &huge, 0.0).grid(&grid);
    assert!((total_volume(&part) - 0.5).abs() < 1e-14);
    assert_eq!(above(&grid, &huge, f64::NAN), Subset::default());
    let error = cells_above(&grid, &field[1..], 0.5, &NoProgress).unwrap_err().to_string();
    assert!(error.contains("one value a point"), "{error}");
}
