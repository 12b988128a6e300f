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
}

/// Shapes in the plane, counter-clockwise, and their areas.
const SHAPES: [(&str, &[[f64; 2]], f64); 8] = [
    // Drawn with a volume of 74.4 of 40 once.
    ("C", &[[0., 0.], [10., 0.], [10., 2.], [2., 2.], [2., 8.], [10., 8.], [10., 10.], [0., 10.]], 52.0),
    ("L", &[[0., 0.], [9., 0.], [9., 1.], [1., 1.], [1., 7.], [0., 7.]], 15.0),
    ("thin U", &[[0., 0.], [3., 0.], [3., 2.], [2.9, 2.], [2.9, 0.1], [0.1, 0.1], [0.1, 2.], [0., 2.]], 0.68),
    ("pentagon", &[[0., 0.], [4., 0.], [4., 3.], [2., 0.5], [0., 3.]], 7.0),
    ("dart", &[[0., 0.], [4., -3.], [1., 0.], [4., 3.]], 3.0),
    ("T", &[[2., 0.], [3., 0.], [3., 4.], [5., 4.], [5., 5.], [0., 5.], [0., 4.], [2., 4.]], 9.0),
    (
        "E",
        &[
            [0., 0.],
            [5., 0.],
            [5., 1.],
            [1., 1.],
            [1., 2.],
            [5., 2.],
            [5., 3.],
            [1., 3.],
            [1., 4.],
            [5., 4.],
            [5., 5.],
            [0., 5.],
        ],
        17.0,
    ),
    (
        "S",
        &[
            [0., 0.],
            [5., 0.],
            [5., 3.],
            [1., 3.],
            [1., 4.],
            [5., 4.],
            [5., 5.],
            [0., 5.],
            [0., 2.],
            [4., 2.],
            [4., 1.],
            [0., 1.],
        ],
        17.0,
    ),
];

/// Turns, scales and shifts.
fn moved(mut parts: RawGrid, scale: f64) -> RawGrid {
    let turn = glam::DQuat::from_euler(glam::EulerRot::XYZ, scale, 0.7, 0.3);
    let points = parts.points.make_mut();
    points.iter_mut().for_each(|p| *p = scale * (turn * *p + DVec3::new(1.0, -30.0, 0.2)));
    parts
}

/// Point numbers in any order.
fn any_order(count: u32, random: &mut Random) -> Vec<u32> {
    let mut order: Vec<u32> = (0..count).collect();
    (1..count as usize).rev().for_each(|i| order.swap(i, (random.next() * (i + 1) as f64) as usize));
    order
}

#[test]
fn prisms_over_any_shape_keep_their_volume() {
    let mut random = Random(1);
    for (name, polygon, area) in SHAPES {
        for scale in [1e-3, 1.0, 1e4] {
            let order = any_order(2 * polygon.len() as u32, &mut random);
            let parts = extruded(polygon, |i| order[i as usize]);
            // As a file of 32-bit numbers has it: no face is plane.
            let mut rounded = moved(parts.clone(), scale);
            let to_32_bits = |p: &mut DVec3| *p = p.as_vec3().as_dvec3();
            rounded.points.make_mut().iter_mut().for_each(to_32_bits);
            for (parts, tolerance) in [(moved(parts, scale), 1e-9), (rounded, 1e-4)] {
                if name == "E" && tolerance > 1e-9 {
                    assert_filled_or_left_out(parts, area * scale.powi(3));
                    continue;
                }
                let grid =
                    built(parts).unwrap_or_else(|error| panic!("{name}, {scale}, {tolerance}: {error}"));
                assert!(grid.origin.warnings.is_empty(), "{name}, {scale}: {:?}", grid.origin.warnings);
                let volume = total_volume(&grid) / scale.powi(3);
                assert!((volume - area).abs() < tolerance * area, "{name}, {scale}: {volume}");
                assert!(triangle_uses(&grid).values().all(|&uses| uses <= 2), "{name}, {scale}");
                // The surface is made of the file's points alone, which come first.
                let own = 2 * polygon.len() as u32;
                let outer = triangle_uses(&grid).into_iter().filter(|&(_, uses)| uses == 1);
                assert!(outer.flat_map(|(face, _)| face).all(|p| p < own), "{name}, {scale}");
                for (&p, &s) in
                    grid.points.iter().zip(grid.scalar.as_ref().unwrap().iter()).skip(own as usize)
                {
                    let scalar = grid.scalar.as_ref().unwrap();
                    let range = scalar[..own as usize]
                        .iter()
                        .fold((s, s), |(low, high), &v| (low.min(v), high.max(v)));
                    assert!(p.is_finite() && range.0 < s && s < range.1, "{name}: {s} not within {range:?}");
                }
            }
        }
    }
}

/// Faces that rounding has bent may leave no room between them: the cell is drawn as it is or not at all.
fn assert_filled_or_left_out(parts: RawGrid, volume: f64) {
    match built(parts) {
        Ok(grid) => {
            assert!(grid.origin.warnings.is_empty(), "{:?}", grid.origin.warnings);
            assert!((total_volume(&grid) / volume - 1.0).abs() < 1e-4);
        }
        Err(error) => assert!(error.to_string().contains("cell 0: no split"), "{error}"),
    }
}

#[test]
fn polyhedra_that_cannot_be_split_are_left_out_and_named() {
    let square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let crossed = [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, -1.0], [0.0, 2.0]];
    let mut open = extruded(&square, |i| i);
    if let Cells::Mixed(set) = &mut open.cells {
        set.polyhedra[0].faces.remove(0);
    }
    for (parts, why) in
        [(open, "is a face missing?"), (extruded(&crossed, |i| i), "cross or touch each other")]
    {
        let error = built(parts.clone()).unwrap_err().to_string();
        assert!(error.contains(why) && error.contains("cell 0"), "{error}");
        // Beside a cell that can be: that one is drawn, and nothing of the other.
        let mut both = extruded(&square, |i| i);
        let shift = both.points.len() as u32;
        both.points = both.points.iter().chain(parts.points.iter()).copied().collect();
        both.scalar = None;
        let (Cells::Mixed(set), Cells::Mixed(bad)) = (&mut both.cells, &parts.cells) else { unreachable!() };
        set.append(bad.clone(), |p| p + shift);
        let grid = built(both).unwrap();
        assert!((total_volume(&grid) - 1.0).abs() < 1e-12);
        let [warning] = &grid.origin.warnings[..] else { panic!("{:?}", grid.origin.warnings) };
        assert!(warning.contains("1 polyhedron was left out, cell 1") && warning.contains(why), "{warning}");
    }
}

/// Cells of a box by the number of the polyhedron that they are a part of, x fastest; a lattice of `counts` cells.
fn joined_cells(counts: [usize; 3], jitter: f64, owner: &[u32]) -> RawGrid {
    let parts = box_of(Kind::Polyhedra, counts, UNIT, jitter);
    let Cells::Mixed(cells) = &parts.cells else { unreachable!() };
    let mut set = CellSet::default();
    for number in 0..=owner.iter().copied().max().unwrap() {
        let own = cells.polyhedra.iter().filter(|p| owner[p.cell as usize] == number);
        let mut faces: HashMap<Vec<u32>, Vec<Vec<u32>>> = HashMap::new();
        for face in own.flat_map(|p| &p.faces) {
            let mut key = face.clone();
            key.sort_unstable();
            faces.entry(key).or_default().push(face.clone());
        }
        let mut faces: Vec<Vec<u32>> = faces.into_values().filter(|same| same.len() == 1).flatten().collect();
        faces.sort_unstable();
        set.push_polyhedron(faces);
    }
    parts_with_scalar(RawGrid::new(parts.points, Cells::Mixed(set)), "s", |p| p.x + 2.0 * p.y - p.z)
}

/// Length of a line in a grid's tetrahedra.
fn length_within(grid: &Grid, origin: DVec3, direction: DVec3) -> f64 {
    let within = |t: usize| {
        let corners = grid.corners(t);
        if tetrahedron_volume(corners) < 1e-15 {
            return 0.0;
        }
        let (mut enter, mut leave) = (f64::NEG_INFINITY, f64::INFINITY);
        for i in 0..4 {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| corners[(i + k) % 4]);
            let normal = (b - a).cross(c - a);
            let normal = normal * normal.dot(d - a).signum();
            let (distance, speed) = (normal.dot(origin - a), normal.dot(direction));
            if speed > 0.0 {
                enter = enter.max(-distance / speed);
            } else {
                leave = leave.min(-distance / speed);
            }
        }
        (leave - enter).max(0.0)
    };
    (0..grid.tetrahedra.len()).map(within).sum()
}

fn assert_rays_see_unit_cube(grid: &Grid, random: &mut Random, what: &str) {
    for _ in 0..200 {
        let [a, b] = [0; 2].map(|_| DVec3::new(random.next(), random.next(), random.next()));
        let direction = (b - a).normalize();
        let ends = [0, 1, 2].map(|axis| {
            let [low, high] = [0.0, 1.0].map(|side| (side - a[axis]) / direction[axis]);
            [low.min(high), low.max(high)]
        });
        let chord = ends.iter().map(|e| e[1]).fold(f64::INFINITY, f64::min)
            - ends.iter().map(|e| e[0]).fold(f64::NEG_INFINITY, f64::max);
        let found = length_within(grid, a, direction);
        assert!((found - chord).abs() < 1e-9, "{what}: {found} of {chord}");
    }
}

#[test]
fn concave_cells_fill_a_block_without_cracks() {
    // A box with an alcove in its edge, its filling, and a C that encloses a rod; a plate between them.
    let alcove = |x: usize, y: usize, z: usize| match (x, y, z) {
        (1, 0..2, 2..4) => 1,
        (0..3, 0..3, 1..4) => 0,
        (.., 4) => 2,
        (0..3, 3, 1..4) => 3,
        (3, 1..3, 1..4) => 4,
        (3, ..) => 5,
        _ => 6,
    };
    let [nx, ny, nz] = [4, 4, 5];
    let cells = (0..nz).flat_map(|z| (0..ny).flat_map(move |y| (0..nx).map(move |x| (x, y, z))));
    let owner: Vec<u32> = cells.map(|(x, y, z)| alcove(x, y, z)).collect();
    let mut random = Random(5);
    for seed in 1..6 {
        for jitter in [0.0, 0.2] {
            let what = format!("seed {seed}, jitter {jitter}");
            let grid = built(shuffled(joined_cells([nx, ny, nz], jitter, &owner), seed)).unwrap();
            assert!(grid.origin.warnings.is_empty(), "{what}: {:?}", grid.origin.warnings);
            // Where several faces of a cell are in one plane, its flat tetrahedra meet those of its neighbour.
            if jitter > 0.0 {
                assert_fills_unit_cube(&grid, &what);
            }
            assert!((total_volume(&grid) - 1.0).abs() < 1e-9, "{what}: {}", total_volume(&grid));
            assert_rays_see_unit_cube(&grid, &mut random, &what);
        }
    }
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
