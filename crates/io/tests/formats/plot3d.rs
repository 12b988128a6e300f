//! PLOT3D files in every way of writing them.

use voltet_core::grid::Grid;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, inspect, read};
use voltet_testing::files::plot3d::{Layout, grid_file, grids, layouts, position, solution_file};
use voltet_testing::files::samples::file;

fn check(grid: &Grid, counted: bool, blanking: bool, what: &str) {
    let cells = if counted { 6 + 2 } else { 6 };
    let blanked = match (blanking, counted) {
        (false, _) => 0,
        (true, false) => 1,
        (true, true) => 2,
    };
    assert_eq!(grid.tetrahedra.len(), 6 * (cells - blanked), "{what}");
    assert_eq!(grid.origin.cells_ghost, blanked as u64, "{what}");
    let last = grid.points[grid.points.len() - 1].to_array();
    assert_eq!(last, if counted { [11.0, 0.5, 4.0] } else { [3.0, 1.0, 2.0] }, "{what}");
}

#[test]
fn every_way_of_writing_is_found_out() {
    let folder = tempfile::tempdir().unwrap();
    for layout in layouts() {
        let path = file(&folder, "a.xyz", &grid_file(layout));
        let solution = file(&folder, "b.bin", &solution_file(Layout { blanking: false, ..layout }));
        let read_scalar = |scalar: &str| {
            let request = Request {
                scalar: Some(scalar.to_owned()),
                solution: Some(solution.clone()),
                ..Request::default()
            };
            read(&path, &request, &NoProgress).unwrap_or_else(|error| panic!("{error} {layout:?}"))
        };
        let grid = read_scalar("momentum:1");
        check(&grid, layout.counted, layout.blanking, &format!("{layout:?}"));
        let first = grid.scalar.as_ref().unwrap()[0];
        // Where the first point is blanked no cell uses it.
        assert_eq!(first, if layout.blanking { 3.0 } else { 2.0 }, "{layout:?}");
        assert!(read_scalar("Density").scalar.unwrap().iter().all(|&d| d == 2.0));
        let summary =
            inspect(&path, &Request { solution: Some(solution.clone()), ..Request::default() }, &NoProgress)
                .unwrap();
        assert_eq!(summary.point_count, if layout.counted { 36 } else { 24 });
        assert!(
            summary.format.contains(if layout.double { "double" } else { "single" }),
            "{}",
            summary.format
        );
    }
}

#[test]
fn text_files_are_read_and_the_solution_is_found_by_name() {
    let folder = tempfile::tempdir().unwrap();
    for counted in [false, true] {
        for blanking in [false, true] {
            let layout = Layout { big_endian: false, marks: false, counted, double: true, blanking };
            let words = |values: &mut dyn Iterator<Item = f64>| {
                values.map(|v| format!("{v:.3}\n")).collect::<String>()
            };
            let mut head = if counted { "2\n".to_owned() } else { String::new() };
            grids(layout).iter().flatten().for_each(|n| head.push_str(&format!("{n} ")));
            let (mut grid_text, mut solution_text) = (head.clone(), head);
            for (g, &size) in grids(layout).iter().enumerate() {
                let count: usize = size.iter().product();
                for axis in 0..3 {
                    grid_text += &words(&mut (0..count).map(|n| position(g, size, n)[axis]));
                }
                if blanking {
                    grid_text += "0 ";
                    grid_text += &"1 ".repeat(count - 1);
                }
                solution_text += "0.5 0 1e5 0 ";
                solution_text += &words(&mut (0..5 * count).map(|n| 1.0 + n as f64));
            }
            let path = file(&folder, "t.xyz", grid_text.as_bytes());
            file(&folder, "t.q", solution_text.as_bytes());
            let request = Request { scalar: Some("energy".to_owned()), ..Request::default() };
            let grid = read(&path, &request, &NoProgress).unwrap_or_else(|error| panic!("{error}"));
            check(&grid, counted, blanking, &format!("text, {counted} {blanking}"));
        }
    }
}

#[test]
fn files_that_do_not_fit_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let layout = layouts().next().unwrap();
    let sound = grid_file(layout);
    let message = |bytes: &[u8], solution: &[u8]| {
        let request = Request {
            scalar: Some("density".to_owned()),
            solution: Some(file(&folder, "a.q", solution)),
            ..Request::default()
        };
        read(&file(&folder, "a.xyz", bytes), &request, &NoProgress).unwrap_err().to_string()
    };
    let other = solution_file(Layout { counted: true, ..layout });
    let wrong = message(&sound, &other);
    assert!(wrong.contains("does not fit the grid") && wrong.contains("a.q"), "{wrong}");
    let cut = message(&sound[..sound.len() - 3], &solution_file(layout));
    assert!(cut.contains("no PLOT3D file") && cut.contains("a.xyz"), "{cut}");
    let mut huge = sound.clone();
    huge[..12].fill(0x7F);
    assert!(message(&huge, &other).contains("no PLOT3D file"));
}
