//! Scales, offsets, flat neighbourhoods, coincident points, cells without volume.

use super::*;

#[test]
fn units_of_length_and_value_do_not_matter() {
    let grid = box_of_tetrahedra([4, 3, 5], UNIT, 0.2);
    let field = |p: DVec3| (3.0 * p.x).sin() + p.y * p.z;
    let s = sample(&grid, field);
    for method in METHODS {
        let plain = gradient(method, &grid, &s).vectors;
        for (length, value) in
            [(1e20, 1.0), (1e-20, 1.0), (1.0, 1e20), (1e-20, 1e20), (1e120, 1e-100), (1e-150, 1.0)]
        {
            let scaled = moved(&grid, |p| p * length);
            let values: Vec<f64> = s.iter().map(|v| v * value).collect();
            let found = gradient(method, &scaled, &values);
            assert!(found.fallbacks.is_empty());
            for (a, b) in plain.iter().zip(&found.vectors) {
                // 1e-10: scaling by a number that is no power of two rounds every coordinate and value anew, and
                // differences over a fifth of the size and the condition of the fit enlarge that.
                let b = *b * (length / value);
                assert!((*a - b).length() < 1e-10, "{method}, {length:e}, {value:e}: {a} {b}");
            }
        }
    }
}

#[test]
fn offsets_cost_only_what_the_input_has_lost() {
    let slope = DVec3::new(0.7, -1.3, 2.1);
    let grid = box_of_tetrahedra([4, 4, 4], UNIT, 0.2);
    // Coordinates offset by 1e6 times the size: rounding 1e-10 over spacings of about 0.1.
    let far = moved(&grid, |p| p + DVec3::new(1e6, -1e6, 1e6));
    // Values near 1e8 that vary by 1e-2: rounding 1.5e-8 over spacings of about 0.1, so up to 1e-6 of 3e-2.
    for method in METHODS {
        for v in gradient(method, &far, &sample(&far, |p| slope.dot(p - DVec3::new(1e6, -1e6, 1e6)))).vectors
        {
            assert!((v - slope).length() < 1e-7, "{method}: {v}");
        }
        for v in gradient(method, &grid, &sample(&grid, |p| 1e8 + 1e-2 * slope.dot(p))).vectors {
            assert!((v - 1e-2 * slope).length() < 2e-6, "{method}: {v}");
        }
    }
}

#[test]
fn a_flat_neighbourhood_gives_the_slope_in_its_plane_and_is_counted() {
    // Four points in the plane z = 0: no volume; s = 2 x − y.
    let points = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let grid = grid_of(points.to_vec(), vec![[0, 1, 2, 3]]);
    let s = sample(&grid, |p| 2.0 * p.x - p.y);
    for method in ["least-squares", "quadratic-fit"] {
        let found = gradient(method, &grid, &s);
        for v in found.vectors {
            assert!((v - DVec3::new(2.0, -1.0, 0.0)).length() < 1e-14, "{method}: {v}");
        }
        assert_eq!(found.fallbacks.len(), 1);
        assert_eq!(found.fallbacks[0].point_count, 4);
        assert!(found.fallbacks[0].what.contains("plane"));
    }
    for method in ["cell-average", "volume-weighted"] {
        let found = gradient(method, &grid, &s);
        assert!(found.vectors.iter().all(|v| *v == DVec3::ZERO));
        assert_eq!(found.fallbacks[0].point_count, 4);
    }
}

#[test]
fn flat_to_rounding_is_flat() {
    // The same plane tilted and far from the origin: its points leave it by rounding only, and a slope across it
    // taken from that would be anything.
    let (u, v) = (DVec3::new(0.6, 0.48, 0.64), DVec3::new(-0.8, 0.36, 0.48));
    let mut random = Random(5);
    let points: Vec<DVec3> =
        (0..12).map(|_| DVec3::splat(1e5 / 3.0) + u * random.next() + v * random.next()).collect();
    let tetrahedra = (0..9).map(|i| [i, i + 1, i + 2, i + 3]).collect();
    let grid = grid_of(points, tetrahedra);
    let s = sample(&grid, |p| (p - DVec3::splat(1e5 / 3.0)).dot(u) + 1e-3 * random_of(p));
    for method in METHODS {
        for g in gradient(method, &grid, &s).vectors {
            assert!(g.length() < 10.0, "{method}: {g}");
        }
    }
}

/// Something that is no linear function of position.
fn random_of(p: DVec3) -> f64 {
    (1e3 * p.x).sin()
}

#[test]
fn coincident_points_and_lonely_points_are_harmless() {
    // A box with one point doubled, in its place and one rounding beside it: a cell without volume joins the pair, their
    // values differ.
    for beside in [DVec3::ZERO, DVec3::X * f64::EPSILON / 4.0] {
        let mut grid = box_of_tetrahedra([3, 3, 3], UNIT, 0.1);
        let slope = DVec3::new(1.0, 2.0, -1.0);
        let mut points = grid.points.to_vec();
        let mut tetrahedra = grid.tetrahedra.to_vec();
        let twin = points.len() as u32;
        points.push(points[21] + beside);
        assert_eq!(points[21] == points[twin as usize], beside == DVec3::ZERO);
        points.push(DVec3::splat(0.4));
        let [a, b, ..] = *tetrahedra.iter().find(|t| t[0] == 21).unwrap();
        assert_eq!(a, 21);
        tetrahedra.push([a, b, b + 1, twin]);
        (grid.points, grid.tetrahedra) = (points.into(), tetrahedra.into());
        assert!(tetrahedron_volume(grid.corners(grid.tetrahedra.len() - 1)).abs() < 1e-17);
        let mut s = sample(&grid, |p| slope.dot(p));
        s[twin as usize] += 1.0;
        for method in METHODS {
            let found = gradient(method, &grid, &s);
            // At the point itself the twin has no say, since it lies in no direction.
            assert!((found.vectors[21] - slope).length() < 1e-9, "{method}: {}", found.vectors[21]);
            // The last point belongs to no cell.
            assert_eq!(found.vectors[twin as usize + 1], DVec3::ZERO);
            assert!(!found.fallbacks.is_empty());
        }
    }
}

#[test]
fn surroundings_on_a_paraboloid_do_not_blow_up_what_a_quadratic_fit_cannot_hold() {
    // All neighbours within 1e-6 of z = x² + y²: a slope along z is as good as a curvature, and a cubic field, whose gradient is
    // 0 at the middle, decides between them by chance.
    let mut random = Random(3);
    let mut around = || {
        let (x, y) = (2.0 * random.next() - 1.0, 2.0 * random.next() - 1.0);
        DVec3::new(x, y, x * x + y * y + 1e-6 * random.next())
    };
    let mut points = vec![DVec3::ZERO];
    points.extend((0..16).map(|_| around()));
    let tetrahedra = (1..15).map(|i| [0, i, i + 1, i + 2]).collect();
    let grid = grid_of(points, tetrahedra);
    let found = gradient("quadratic-fit", &grid, &sample(&grid, |p| p.x.powi(3) + p.y.powi(3)));
    assert!(found.vectors[0].length() < 3.0, "{}", found.vectors[0]);
    assert!(found.fallbacks[0].what.contains("linear"), "{:?}", found.fallbacks);
}

#[test]
fn distances_whose_squares_vanish_are_harmless() {
    // A twin 1e-170 beside a corner at the origin: apart by the digits, yet its square is no number.
    let grid = box_of_tetrahedra([2, 2, 2], UNIT, 0.0);
    let mut points = grid.points.to_vec();
    let mut tetrahedra = grid.tetrahedra.to_vec();
    points.push(DVec3::new(1e-170, 0.0, 0.0));
    tetrahedra.push([0, 1, 3, 27]);
    let grid = grid_of(points, tetrahedra);
    let slope = DVec3::new(1.0, 2.0, -1.0);
    for method in METHODS {
        let found = gradient(method, &grid, &sample(&grid, |p| slope.dot(p)));
        assert!((found.vectors[0] - slope).length() < 1e-12, "{method}: {}", found.vectors[0]);
    }
}

#[test]
fn slivers_do_not_drown_their_neighbours() {
    // A cell 1e-12 high on top of a box, with a value on its tip that the linear field does not have: the
    // volume-weighted mean hardly sees it.
    let mut grid = box_of_tetrahedra([2, 2, 2], UNIT, 0.0);
    let slope = DVec3::new(1.0, 2.0, -1.0);
    let mut points = grid.points.to_vec();
    let mut tetrahedra = grid.tetrahedra.to_vec();
    let tip = points.len() as u32;
    points.push(DVec3::new(0.2, 0.2, 1.0 + 1e-12));
    let top: Vec<u32> = (0..27).filter(|&p| points[p as usize].z == 1.0).collect();
    tetrahedra.push([top[0], top[1], top[3], tip]);
    (grid.points, grid.tetrahedra) = (points.into(), tetrahedra.into());
    let s = sample(&grid, |p| slope.dot(p));
    for method in METHODS {
        for v in &gradient(method, &grid, &s).vectors[..27] {
            // 1e-3: the plain mean takes the sliver's slope (rounding 1e-16 over 1e-12) as one of few.
            assert!((*v - slope).length() < 1e-3, "{method}: {v}");
        }
    }
}
