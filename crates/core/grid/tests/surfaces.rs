//! Contours and boundaries: areas, volumes, no cracks.

use super::*;
use crate::grid::generate::{box_of_tetrahedra, sample};
use crate::progress::NoProgress;

fn triangles(surface: &GridSurface, grid: &Grid) -> Vec<[DVec3; 3]> {
    let positions = surface.positions(&grid.points);
    surface.triangles.iter().map(|corners| corners.map(|p| positions[p as usize])).collect()
}

fn area_vector([a, b, c]: [DVec3; 3]) -> DVec3 {
    (b - a).cross(c - a) * 0.5
}

fn area(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|t| area_vector(*t).length()).sum()
}

/// Volume that triangles enclose, by the divergence theorem; above 0 where they turn counter-clockwise from outside.
fn volume(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|t| area_vector(*t).dot(t[0]) / 3.0).sum()
}

/// Sides of triangles less those the other way round, without those that lie in a side of the box.
fn open_edges(surface: &GridSurface, grid: &Grid, bounds: [DVec3; 2]) -> usize {
    let mut sides = HashMap::<[u32; 2], i32>::new();
    for &[a, b, c] in &surface.triangles {
        for [p, q] in [[a, b], [b, c], [c, a]] {
            *sides.entry([p.min(q), p.max(q)]).or_default() += if p < q { 1 } else { -1 };
        }
    }
    let positions = surface.positions(&grid.points);
    let on_a_side = |ends: &[u32; 2]| {
        let [p, q] = ends.map(|p| positions[p as usize]);
        (0..3).any(|axis| bounds.iter().any(|side| p[axis] == side[axis] && q[axis] == side[axis]))
    };
    sides.iter().filter(|(ends, count)| **count != 0 && !on_a_side(ends)).count()
}

#[test]
fn a_plane_is_met_exactly() {
    let grid = box_of_tetrahedra([4, 5, 3], UNIT, 0.25);
    let field = sample(&grid, |p| p.x + p.y + p.z);
    // A triangle of side √2 through corners of the grid, and a hexagon of side √½.
    for (value, expected) in [(1.0, 0.5 * 3_f64.sqrt()), (1.5, 0.75 * 3_f64.sqrt())] {
        let surface = contour(&grid, &field, value, &NoProgress).unwrap();
        let found = triangles(&surface, &grid);
        // Sums of a hundred areas, each of a few roundings.
        assert!((area(&found) - expected).abs() < 1e-13, "{} at {value}", area(&found));
        for corner in found.as_flattened() {
            assert!((corner.element_sum() - value).abs() < 1e-15, "{corner}");
        }
        let all: DVec3 = found.iter().map(|t| area_vector(*t)).sum();
        // Toward lower values.
        assert!((all + DVec3::ONE * expected / 3_f64.sqrt()).length() < 1e-13, "{all}");
        assert_eq!(open_edges(&surface, &grid, UNIT), 0);
        for (p, q) in
            surface.values(&sample(&grid, |p| 2.0 * p.x - p.z)).iter().zip(found_points(&surface, &grid))
        {
            assert!((p - (2.0 * q.x - q.z)).abs() < 1e-15);
        }
    }
    assert_eq!(contour(&grid, &field, 3.5, &NoProgress).unwrap(), GridSurface::default());
    assert_eq!(contour(&grid, &field, 0.0, &NoProgress).unwrap(), GridSurface::default());
}

fn found_points(surface: &GridSurface, grid: &Grid) -> Vec<DVec3> {
    surface.positions(&grid.points)
}

#[test]
fn a_ball_is_closed_and_its_area_converges() {
    let radius = 0.7;
    let mut last = f64::INFINITY;
    for n in [8, 16, 32] {
        let grid = box_of_tetrahedra([n; 3], [-DVec3::ONE, DVec3::ONE], 0.2);
        let field = sample(&grid, |p| -p.length());
        let surface = contour(&grid, &field, -radius, &NoProgress).unwrap();
        let found = triangles(&surface, &grid);
        let error = (area(&found) / (4.0 * std::f64::consts::PI * radius * radius) - 1.0).abs();
        // Second order: a quarter for half the spacing h = 2/n, and some (h / radius)².
        let order = (2.0 / n as f64 / radius).powi(2);
        assert!(error < last / 3.0 && error < 0.5 * order, "{error} of {n}");
        last = error;
        let volume = volume(&found) / (4.0 / 3.0 * std::f64::consts::PI * radius.powi(3));
        // The field is concave, so between points it is no less than straight lines.
        assert!(volume > 1.0 - order && volume < 1.0, "{volume}");
        assert_eq!(open_edges(&surface, &grid, UNIT), 0);
        // Euler: V - E + F = 2, with E = 3 F / 2.
        let [v, f] = [surface.points.len(), surface.triangles.len()];
        assert_eq!(2 * v, f + 4, "{v} points, {f} triangles");
        let positions = surface.positions(&grid.points);
        for (p, normal) in positions.iter().zip(point_normals(&positions, &surface.triangles)) {
            assert!(
                (normal.length() - 1.0).abs() < 1e-15 && normal.dot(p.normalize()) > 0.8,
                "{normal} at {p}"
            );
        }
    }
}

#[test]
fn values_at_points_make_no_cracks() {
    let grid = box_of_tetrahedra([5, 4, 6], UNIT, 0.2);
    for seed in 1..20 {
        let mut random = Random(seed);
        let field: Vec<f64> = grid.points.iter().map(|_| (4.0 * random.next()).floor()).collect();
        for value in [1.0, 1.5, 2.0, 3.0] {
            let surface = contour(&grid, &field, value, &NoProgress).unwrap();
            assert!(!surface.triangles.is_empty());
            assert_eq!(open_edges(&surface, &grid, UNIT), 0, "{value} of field {seed}");
            assert!(surface.points.windows(2).all(|pair| pair[0].ends < pair[1].ends));
        }
    }
}

#[test]
fn cells_of_missing_values_and_extreme_ones_are_no_trouble() {
    let grid = box_of_tetrahedra([3; 3], UNIT, 0.0);
    let mut field = sample(&grid, |p| p.x);
    field[0] = f64::NAN;
    let around = grid.tetrahedra.iter().filter(|corners| corners.contains(&0)).count();
    let surface = contour(&grid, &field, 0.1, &NoProgress).unwrap();
    assert!(around > 0 && area(&triangles(&surface, &grid)) < 1.0);
    let huge = sample(&grid, |p| if p.x < 0.5 { -1.5e308 } else { 1.5e308 });
    let surface = contour(&grid, &huge, 0.0, &NoProgress).unwrap();
    assert!(surface.points.iter().all(|point| point.share == 0.5));
    assert!((area(&triangles(&surface, &grid)) - 1.0).abs() < 1e-14);
    assert!(contour(&grid, &field[1..], 0.5, &NoProgress).is_err());
}

#[test]
fn the_boundary_of_a_box_is_its_sides() {
    let bounds = [DVec3::new(-1.0, 0.5, 2.0), DVec3::new(1.0, 3.5, 2.25)];
    let grid = box_of_tetrahedra([4, 3, 2], bounds, 0.2);
    // Each cell with points of its own, as cells of constant values have.
    let mut apart = grid.clone();
    apart.points =
        grid.tetrahedra.iter().flatten().map(|&p| grid.points[p as usize]).collect::<Vec<_>>().into();
    let own: Vec<[u32; 4]> =
        (0..grid.tetrahedra.len() as u32).map(|i| [0, 1, 2, 3].map(|k| 4 * i + k)).collect();
    apart.tetrahedra = own.into();
    for grid in [grid, apart] {
        let surface = boundary(&grid, &NoProgress).unwrap();
        let found = triangles(&surface, &grid);
        assert_eq!(found.len(), 4 * (4 * 3 + 3 * 2 + 2 * 4));
        // Sums of a hundred areas.
        assert!((area(&found) - 2.0 * (2.0 * 3.0 + 3.0 * 0.25 + 0.25 * 2.0)).abs() < 1e-13);
        assert!((volume(&found) - 1.5).abs() < 1e-13, "{}", volume(&found));
        // Points that no face uses are not among them.
        assert!((0..surface.points.len() as u32).all(|p| surface.triangles.as_flattened().contains(&p)));
        let cell_of_each = surface.triangles.iter().all(|corners| {
            let of = corners.map(|p| surface.points[p as usize].ends[0]);
            grid.tetrahedra.iter().any(|cell| of.iter().all(|p| cell.contains(p)))
        });
        assert!(cell_of_each, "values of another cell");
    }
}

#[test]
fn normals_are_there_at_any_scale() {
    for scale in [1e-200, 1.0, 1e200] {
        let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::NEG_X].map(|p| p * scale);
        let normals = point_normals(&points, &[[0, 1, 2], [0, 2, 3], [1, 1, 2]]);
        assert_eq!(normals, [DVec3::Z; 4]);
    }
    // Two that cancel.
    let flat = point_normals(&[DVec3::ZERO, DVec3::X, DVec3::Y], &[[0, 1, 2], [0, 2, 1]]);
    assert_eq!(flat, [DVec3::Z; 3]);
}

#[test]
fn a_polygon_is_cut_within_itself() {
    let angle = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
    let points = angle.map(|[x, y]| DVec3::new(x, y, 0.0));
    let cut = triangles_of_polygon(&[0, 1, 2, 3, 4, 5], &points).unwrap();
    let found: Vec<DVec3> = cut.iter().map(|t| area_vector(t.map(|p| points[p as usize]))).collect();
    assert!(found.len() == 4 && found.iter().all(|area| area.z > 0.0), "{found:?}");
    assert_eq!(found.into_iter().sum::<DVec3>(), DVec3::Z * 4.0);
    let bow = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    assert_eq!(triangles_of_polygon(&[0, 1, 2, 3], &bow), None);
    assert_eq!(triangles_of_polygon(&[0; 300], &points), None);
}

/// Whole length of edges.
fn length(edges: &[[u32; 2]], points: &[DVec3]) -> f64 {
    edges.iter().map(|&[a, b]| points[a as usize].distance(points[b as usize])).sum()
}

#[test]
fn the_feature_edges_of_a_box_are_its_twelve() {
    for (counts, count) in [([1, 1, 1], 12), ([4, 3, 2], 4 * (4 + 3 + 2))] {
        let grid = box_of_tetrahedra(counts, UNIT, 0.2);
        let surface = boundary(&grid, &NoProgress).unwrap();
        let points = surface.positions(&grid.points);
        for angle in [30.0, 89.0] {
            let edges = feature_edges(&points, &surface.triangles, angle);
            assert_eq!(edges.len(), count, "{edges:?}");
            assert!((length(&edges, &points) - 12.0).abs() < 1e-14, "{}", length(&edges, &points));
        }
        assert_eq!(feature_edges(&points, &surface.triangles, 91.0), [[0; 2]; 0]);
        // Each triangle with points of its own, every other one the other way round.
        let own: Vec<DVec3> =
            surface.triangles.as_flattened().iter().map(|&p| points[p as usize] * 1e200).collect();
        let apart: Vec<[u32; 3]> = (0..surface.triangles.len() as u32)
            .map(|i| if i % 2 == 0 { [3 * i, 3 * i + 1, 3 * i + 2] } else { [3 * i, 3 * i + 2, 3 * i + 1] })
            .collect();
        let edges = feature_edges(&own, &apart, 30.0);
        assert_eq!(edges.len(), count);
        let near: Vec<DVec3> = own.iter().map(|p| *p * 1e-200).collect();
        assert!((length(&edges, &near) - 12.0).abs() < 1e-13);
    }
}

/// A closed prism of height 1 about a circle of radius 1.
fn prism(sides: u32) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let on_circle = |i: u32, z| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(sides);
        DVec3::new(angle.cos(), angle.sin(), z)
    };
    let mut points: Vec<DVec3> =
        [0.0, 1.0].into_iter().flat_map(|z| (0..sides).map(move |i| on_circle(i, z))).collect();
    points.extend([DVec3::ZERO, DVec3::Z]);
    let triangles = (0..sides).flat_map(|i| {
        let [a, b] = [i, (i + 1) % sides];
        let [c, d] = [a, b].map(|p| p + sides);
        [[a, b, d], [a, d, c], [2 * sides, b, a], [2 * sides + 1, c, d]]
    });
    (points, triangles.collect())
}

#[test]
fn the_feature_edges_of_a_cylinder_are_its_rims() {
    let (points, triangles) = prism(36);
    let rims = 2.0 * 36.0 * 2.0 * (std::f64::consts::PI / 36.0).sin();
    // Sides turn by 10 degrees, rims by 90.
    for (angle, count, expected) in
        [(30.0, 72, rims), (10.1, 72, rims), (9.9, 108, rims + 36.0), (91.0, 0, 0.0)]
    {
        let edges = feature_edges(&points, &triangles, angle);
        assert_eq!(edges.len(), count, "at {angle}");
        assert!((length(&edges, &points) - expected).abs() < 1e-13, "{}", length(&edges, &points));
    }
    // Open, it ends where one is missing; a third triangle at a side, too.
    let open = &triangles[1..];
    assert_eq!(feature_edges(&points, open, 91.0), [[0, 1], [0, 37], [1, 37]]);
    let with_wing = [&triangles[..], &[[0, 36, 72]]].concat();
    assert_eq!(feature_edges(&points, &with_wing, 180.0).first(), Some(&[0, 36]));
    // One without area turns nothing.
    let flat = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.0, 0.0), DVec3::Y, DVec3::NEG_Y];
    let edges = feature_edges(&flat, &[[0, 1, 3], [0, 2, 1], [0, 4, 2], [2, 4, 1]], 10.0);
    assert_eq!(edges, [[0, 3], [0, 4], [1, 3], [1, 4]]);
    assert_eq!(feature_edges(&[], &[], 30.0), [[0; 2]; 0]);
}
