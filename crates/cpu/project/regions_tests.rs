//! Regions hold what they should: held against each cell's box.

use crate::project::cells::Input;
use crate::project::regions::Regions;
use crate::tile::{Area, tiles_of};
use crate::view::{ScreenVertex, View};
use glam::DVec3;
use voltet_core::camera::{Camera, Projection};
use voltet_core::grid::Grid;
use voltet_core::grid::generate::box_of_tetrahedra;
use voltet_simd::LaneSet;

fn camera(eye: DVec3) -> Camera {
    Camera {
        eye,
        target: DVec3::ZERO,
        up: DVec3::Z,
        projection: Projection::Perspective { fov_y: 40.0 },
        near: 0.0,
        size: [300, 200],
        samples: 1,
    }
}

/// Cells binned by regions of so many cells: the numbers of each region's cells, the view and the count.
fn binned(grid: &Grid, eye: DVec3, wished: usize) -> (Vec<(Area, Vec<u32>)>, View, u64) {
    let view = View::new(&camera(eye), 1.0, [0.0; 2]).unwrap();
    let screen_vertices = view.project(&grid.points).0;
    let area = Area::of_picture(view.size);
    let (attributes, tetrahedra) = (&[][..], &grid.tetrahedra[..]);
    let input = Input {
        view: &view,
        screen_vertices: &screen_vertices,
        tetrahedra,
        attributes,
        distance_origin: 0.0,
        max_optical_depth: 0.0,
        area,
    };
    let cells: Vec<u32> = (0..tetrahedra.len() as u32).collect();
    let regions = Regions::new(&input, LaneSet::detect().unwrap(), &grid.points, &cells, wished);
    let list = regions.list.iter().map(|region| (region.area, region.pieces.concat())).collect();
    (list, view, regions.cell_count)
}

/// Each tile of the picture is in one region at most, and that one has every cell whose box covers a pixel centre there, in order.
/// From outside, and with the eye among the cells, where some have no box.
#[test]
fn every_cell_is_in_the_windows_that_it_touches() {
    let grid = box_of_tetrahedra([12, 12, 12], [DVec3::splat(-1.0), DVec3::splat(1.0)], 0.2);
    for eye in [DVec3::new(-3.0, -4.0, 2.5), DVec3::new(0.31, 0.22, 0.13)] {
        for wished in [1, 40, 700, 100_000] {
            let (regions, view, _) = binned(&grid, eye, wished);
            let area = Area::of_picture(view.size);
            let mut held = vec![0; area.tile_count()];
            for (region, _) in &regions {
                for index in 0..region.tile_count() {
                    held[area.index(region.tile(index))] += 1;
                }
            }
            assert!(held.iter().all(|&held| held <= 1));
            for (_, cells) in &regions {
                assert!(cells.is_sorted_by(|a, b| a < b), "a cell twice, or out of order");
            }
            let mut boxes = 0;
            for (id, corners) in grid.tetrahedra.iter().enumerate() {
                let seen = corners.map(|p| view.pixel_from_eye(view.eye_from_world(grid.points[p as usize])));
                if seen.iter().any(|seen| seen.z <= 0.0) {
                    continue;
                }
                let range = |of: fn(&ScreenVertex) -> f64, max: usize| {
                    let low = seen.iter().map(of).fold(f64::INFINITY, f64::min).ceil().max(0.0) as usize;
                    let high = seen.iter().map(of).fold(f64::NEG_INFINITY, f64::max).ceil() as usize;
                    low..high.min(max)
                };
                let (columns, rows) = (range(|s| s.x, view.size[0]), range(|s| s.y, view.size[1]));
                if columns.is_empty() || rows.is_empty() {
                    continue;
                }
                boxes += 1;
                let touched = tiles_of([columns.start, rows.start, columns.end, rows.end]);
                let [x0, y0, x1, y1] = touched;
                let touches: usize = (regions.iter().filter(|(_, cells)| cells.contains(&(id as u32))))
                    .filter_map(|(region, _)| region.intersection(touched))
                    .map(|[x0, y0, x1, y1]| (x1 - x0) * (y1 - y0))
                    .sum();
                assert_eq!(touches, (x1 - x0) * (y1 - y0), "cell {id}, regions of {wished}");
            }
            assert!(boxes > 1000, "{boxes} cells have boxes");
        }
    }
}

/// Regions are as full as wished, or a tile.
#[test]
fn windows_hold_what_a_thread_should_work_on() {
    // Half of the cells lie in a hundredth of the picture.
    let coarse = box_of_tetrahedra([12, 12, 12], [DVec3::splat(-1.0), DVec3::splat(1.0)], 0.2);
    let fine = box_of_tetrahedra([12, 12, 12], [DVec3::splat(-0.1), DVec3::splat(0.1)], 0.2);
    let offset = coarse.points.len() as u32;
    let grid = Grid {
        points: [&coarse.points[..], &fine.points[..]].concat().into(),
        tetrahedra: [
            coarse.tetrahedra.to_vec(),
            fine.tetrahedra.iter().map(|cell| cell.map(|p| p + offset)).collect(),
        ]
        .concat()
        .into(),
        ..Grid::default()
    };
    for wished in [500, 2000] {
        let (regions, _, count) = binned(&grid, DVec3::new(-3.0, -4.0, 2.5), wished);
        let counts: Vec<usize> = regions.iter().map(|(_, cells)| cells.len()).collect();
        assert!(counts.is_sorted_by(|a, b| a >= b), "the fullest first: {counts:?}");
        let fits = |(area, cells): &(Area, Vec<u32>)| cells.len() <= 2 * wished || area.tile_count() == 1;
        assert!(regions.iter().all(fits), "regions of {wished}: {counts:?}");
        assert!(count > 10_000 && counts.iter().sum::<usize>() >= count as usize);
    }
}
