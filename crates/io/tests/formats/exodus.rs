//! Exodus II files as netCDF4 writes them (`files/make_exodus.py`), against formulas: every element type, every form of the file, steps,
//! blocks and the files of several processes.

use super::packed::{MemoryLeft, follow, grid, grid_at, path, request};
use std::path::Path;
use voltet_core::grid::{Grid, tetrahedron_volume};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Association, BLOCK, Request, files_beside, files_read_beside, inspect, read};

const TIMES: [f64; 2] = [0.5, 1.5];

fn temperature([x, y, z]: [f64; 3], time: f64) -> f64 {
    1.0 + x + 2.0 * y + 3.0 * z * (1.0 - y) + time * x * x
}

fn of_blocks(name: &str, scalar: &str, blocks: &[&str]) -> Grid {
    let blocks = blocks.iter().map(|name| name.to_string()).collect();
    grid(name, &Request { blocks, cell_arrays: vec![BLOCK.to_owned()], ..request(scalar) })
}

/// Volume of each block.
fn volumes(grid: &Grid) -> Vec<(String, f64)> {
    let numbers = &grid.cell_arrays[BLOCK].values;
    let mut volumes: Vec<(String, f64)> = grid.origin.blocks.iter().map(|name| (name.clone(), 0.0)).collect();
    for i in 0..grid.tetrahedra.len() {
        volumes[numbers[grid.source_cell(i)] as usize].1 += tetrahedron_volume(grid.corners(i));
    }
    volumes
}

#[test]
fn elements_of_every_type_have_their_volume_and_values() {
    for name in ["exodus_kinds.exo", "exodus_kinds.ex2"] {
        let own = of_blocks(name, "T", &[]);
        let volumes = volumes(&own);
        assert_eq!(volumes.len(), 13, "{name}");
        for (block, volume) in volumes {
            let expected = match block.split(' ').next() {
                Some("hexes") => 1.0,
                Some("tets") => 1.0 / 6.0,
                Some("wedges") => 0.5,
                Some("pyramids") => 1.0 / 3.0,
                _ => 0.0,
            };
            // Roundings of sums of some tens of parts.
            assert!((volume - expected).abs() < 1e-13, "{name}: {block} has the volume {volume}");
        }
        // A node in the wrong place makes a cell of another shape, whose parts overlap.
        assert!(
            !own.origin.warnings.iter().any(|warning| warning.contains("overlap")),
            "{:?}",
            own.origin.warnings
        );
        let lack = |grid: &Grid| {
            let warnings = grid.origin.warnings.iter();
            warnings.filter(|warning| warning.contains("VTK's cells lack")).cloned().collect::<Vec<_>>()
        };
        let [warning] = &lack(&own)[..] else { panic!("{name}: {:?}", own.origin.warnings) };
        assert!(warning.contains("'tets 14'") && !warning.contains("'hexes 27'"), "{warning}");
        assert!(lack(&of_blocks(name, "T", &["hexes 27"])).is_empty(), "{name}");
        for (step, time) in TIMES.into_iter().enumerate() {
            let own = grid_at(name, "T", step);
            assert_eq!(own.origin.time, Some(time), "{name}");
            follow(&own, |point| temperature(point, time), name);
            follow(&grid_at(name, "disp:x", step), |[_, y, _]| time * y, name);
            follow(&grid_at(name, "disp:2", step), |[x, ..]| 0.25 * time * x, name);
        }
    }
}

#[test]
fn a_quadratic_field_is_met_within_elements_of_second_order() {
    for block in ["hexes 20", "hexes 27", "tets 10", "tets 14", "wedges 15", "wedges 18", "pyramids 13"] {
        let mut wanted = Request { blocks: vec![block.into()], ..request("T") };
        wanted.options.subdivision = 2;
        // Three values along an edge become five: those between follow from all nodes, each in its place.
        let fine = grid("exodus_kinds.exo", &wanted);
        assert!(fine.points.len() > 27, "{block}");
        follow(&fine, |point| temperature(point, 0.5), block);
    }
}

#[test]
fn files_in_hdf5_and_of_the_older_form_are_read() {
    let own = of_blocks("exodus_hdf5.e", "T", &[]);
    let expected = [("hexes", 1.0), ("tets", 1.0 / 6.0), ("wedges 15", 0.5)];
    for ((name, volume), expected) in volumes(&own).into_iter().zip(expected) {
        assert!(name == expected.0 && (volume - expected.1).abs() < 1e-13, "{name} {volume}");
    }
    follow(&grid_at("exodus_hdf5.e", "T", 1), |point| temperature(point, 1.5), "hdf5");
    follow(&grid_at("exodus_hdf5.e", "disp:z", 1), |[x, ..]| 0.375 * x, "hdf5");
    let old = of_blocks("exodus_old.g", "T", &["block 20"]);
    assert_eq!(volumes(&old), [("block 10".into(), 0.0), ("block 20".into(), 2.0)]);
    follow(&grid_at("exodus_old.g", "T", 1), |point| temperature(point, 1.5), "old");
    // Elements share their nodes.
    assert_eq!(grid("exodus_old.g", &request("T")).points.len(), 20);
}

#[test]
fn names_in_hdf5_have_any_letters_and_may_be_strings() {
    for name in ["exodus_letters.e", "exodus_strings.e"] {
        let blocks = volumes(&of_blocks(name, "T", &[]));
        assert_eq!(
            blocks.iter().map(|block| &block.0[..]).collect::<Vec<_>>(),
            ["Gehäuse", "Träger"],
            "{name}"
        );
        // Roundings of sums of some parts.
        assert!((volumes(&of_blocks(name, "T", &["Gehäuse"]))[0].1 - 1.0).abs() < 1e-13, "{name}");
    }
}

#[test]
fn a_result_may_be_missing_in_a_block() {
    for name in ["exodus_kinds.exo", "exodus_hdf5.e"] {
        let own = of_blocks(name, "p", &[]);
        let of_tets = volumes(&own).into_iter().find(|block| block.0 == "tets").unwrap();
        assert_eq!(of_tets.1, 0.0, "{name}");
        let said = |grid: &Grid| {
            grid.origin
                .warnings
                .iter()
                .any(|text| text.contains("lacks the array 'p'") && text.contains("'tets'"))
        };
        assert!(said(&own), "{name}: {:?}", own.origin.warnings);
        assert!(!said(&of_blocks(name, "T", &[])), "{name}");
        // Elements of a block have its number as value, which their nodes share.
        let hexes = of_blocks(name, "p", &["hexes"]);
        assert!(hexes.scalar.unwrap().iter().all(|&value| value == 1.5), "{name}");
        let nothing = Request { blocks: vec!["tets".into()], ..request("p") };
        let error = read(&path(name), &nothing, &NoProgress).unwrap_err().to_string();
        assert!(error.contains("no array 'p'"), "{name}: {error}");
    }
}

#[test]
fn a_variable_at_nodes_that_is_listed_again_has_its_number() {
    let mut bytes = std::fs::read(path("exodus_kinds.exo")).unwrap();
    let begin = bytes.windows(6).position(|own| own == b"disp_z").unwrap();
    bytes[begin..begin + 6].copy_from_slice(b"T\0\0\0\0\0");
    let folder = tempfile::tempdir().unwrap();
    let twice = folder.path().join("twice.exo");
    std::fs::write(&twice, bytes).unwrap();
    let twice = twice.to_str().unwrap();
    follow(&grid_at(twice, "T", 1), |point| temperature(point, 1.5), "the first");
    follow(&grid_at(twice, "T (2)", 1), |[x, ..]| 0.375 * x, "the second");
}

#[test]
fn a_component_that_a_block_has_alone_stays_by_itself() {
    let mut bytes = std::fs::read(path("exodus_kinds.exo")).unwrap();
    let place = |name: &[u8]| bytes.windows(name.len()).position(|own| own == name).unwrap();
    let [of_nodes, of_elements, of_hexes] =
        [&b"name_nod_var"[..], b"name_elem_var", b"vals_elem_var1eb1\0"].map(place);
    // The names at nodes (dimensions, type and place behind a name) are those in elements, too: T, disp_x, disp_y, disp_z.
    bytes.copy_within(of_nodes + 12..of_nodes + 48, of_elements + 16);
    bytes[of_hexes + 13] = b'2';
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.exo");
    std::fs::write(&alone, bytes).unwrap();
    let hexes = of_blocks(alone.to_str().unwrap(), "disp_x", &["hexes"]);
    assert!(hexes.scalar.unwrap().iter().all(|&value| value == 1.5));
}

#[test]
fn points_are_moved_by_a_displacement() {
    let moved = |name: &str| {
        read(
            &path("exodus_old.g"),
            &Request { displacement: Some((name.to_owned(), 4.0)), ..request("T") },
            &NoProgress,
        )
    };
    let (plain, grid) = (grid("exodus_old.g", &request("T")), moved("disp").unwrap());
    for (from, to) in plain.points.iter().zip(grid.points.iter()) {
        // Values in single precision.
        assert!(
            (*to - *from - 4.0 * 0.5 * glam::DVec3::new(from.y, 0.0, 0.25 * from.x)).length() < 1e-6,
            "{from} {to}"
        );
    }
    assert_eq!((plain.scalar, grid.origin.arrays_decoded), (grid.scalar, 2));
    let error = moved("T").unwrap_err().to_string();
    assert!(error.contains("'T' is no vector") && error.contains("'disp'"), "{error}");
    let error = moved("dips").unwrap_err().to_string();
    assert!(error.contains("no array 'dips'") && error.contains("'disp'"), "{error}");
}

#[test]
fn files_of_processes_are_one_grid() {
    let first = path("exodus_row.e.2.0");
    for own in [&first, &path("exodus_row.e.2.1")] {
        let grid =
            read(own, &Request { cell_arrays: vec![BLOCK.into()], ..request("T") }, &NoProgress).unwrap();
        // 4 cubes of 20 nodes, of which the files share 4.
        assert_eq!((grid.points.len(), grid.origin.points_joined), (20, 4));
        assert_eq!(volumes(&grid), [("left".into(), 2.0), ("right".into(), 2.0)]);
        follow(&grid, |point| temperature(point, 0.5), "row");
        let selected =
            Request { blocks: vec!["right".into()], cell_arrays: vec![BLOCK.into()], ..request("T") };
        assert_eq!(volumes(&read(own, &selected, &NoProgress).unwrap())[1].1, 2.0);
        assert_eq!((files_beside(own).len(), files_read_beside(own, &Request::default()).len()), (1, 1));
    }
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("row.e.2.0");
    std::fs::copy(&first, &alone).unwrap();
    let error = read(&alone, &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("row.e.2.0' names") && error.contains("row.e.2.1"), "{error}");
}

#[test]
fn summaries_tell_blocks_steps_and_sets() {
    let summary = inspect(&path("exodus_kinds.exo"), &Request::default(), &NoProgress).unwrap();
    assert_eq!((summary.cell_count, summary.time_steps.as_slice()), (13, &TIMES[..]));
    let walls = summary.blocks.last().unwrap();
    assert_eq!((walls.name.as_str(), walls.cell_count()), ("walls", 1));
    assert_eq!(summary.notes, ["2 node sets: 'inlet', '9'"]);
    let heads: Vec<(&str, bool, usize)> = summary
        .arrays
        .iter()
        .map(|array| {
            (&*array.head.name, array.head.association == Association::Cell, array.head.component_count)
        })
        .collect();
    assert_eq!(heads, [("T", false, 1), ("disp", false, 3), ("p", true, 1), (BLOCK, true, 1)]);
    assert!(summary.format.contains("Exodus II"), "{}", summary.format);
}

#[test]
fn netcdf_of_other_kinds_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("weather.nc");
    std::fs::write(&path, b"CDF\x01\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0\0").unwrap();
    let error = read(&path, &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(error.contains("no Exodus file") && error.contains("ParaView"), "{error}");
}

#[test]
fn memory_is_checked_for_the_files_of_all_processes() {
    let own = path("exodus_row.e.2.0");
    let refused = |bytes: u64| {
        let error = read(&own, &request("T"), &MemoryLeft(bytes)).err().map(|error| error.to_string());
        error.filter(|error| error.contains("memory ends") && error.contains("points and"))
    };
    // Each file has 12 points of 24 bytes and 2 hexahedra of 41.
    let one = 12 * 24 + 2 * 41;
    assert!(refused(2 * one - 1).is_some());
    assert_eq!(refused(2 * one), None);
    let error = inspect(&own, &Request::default(), &MemoryLeft(one - 1)).unwrap_err().to_string();
    assert!(error.contains("memory ends"), "{error}");
}

#[test]
fn a_name_alone_does_not_make_files_of_processes() {
    assert_eq!(files_beside(Path::new("none/a.e.1048576.0")), [Path::new("none/a.e.1048576.1")]);
}

#[test]
fn polyhedra_and_polygons_of_sandias_library_are_read() {
    let own = grid("exodus_faces.e", &request("s"));
    follow(&own, super::packed::field, "exodus_faces");
    // Two sheared cubes and a wedge of half the volume of its box, and a cube.
    let truth = grid("polyhedra.vtu", &request("s"));
    let volume = |grid: &Grid| -> f64 {
        (0..grid.tetrahedra.len()).map(|i| tetrahedron_volume(grid.corners(i))).sum()
    };
    assert!((volume(&own) - volume(&truth) - 1.0).abs() < 1e-12, "{}", volume(&own));
    assert_eq!(own.points.len(), truth.points.len() + 8);
    let summary = inspect(&path("exodus_faces.e"), &Request::default(), &NoProgress).unwrap();
    let blocks: Vec<(&str, u64)> =
        summary.blocks.iter().map(|block| (&*block.name, block.cell_count())).collect();
    assert_eq!(blocks, [("cells", 3), ("wall", 2), ("bricks", 1)]);
    assert_eq!(summary.cells_by_type.get(&7), Some(&2));
    let bricks = Request { blocks: vec!["bricks".into()], ..request("c") };
    assert!(grid("exodus_faces.e", &bricks).scalar.unwrap().iter().all(|&c| c == 6.0));
}

#[test]
fn mistakes_of_polyhedra_say_what_and_where() {
    let sound = std::fs::read(path("exodus_faces.e")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let words = |numbers: &[i32]| numbers.iter().flat_map(|number| number.to_be_bytes()).collect::<Vec<u8>>();
    for (from, to, expected) in [
        ([6, 6, 5], [6, 6, 4], ["numbers of nodes or faces", "a sum of 16", "17, as 'facconn1'"]),
        ([1, 2, 3], [1, 2, 17], ["does not exist", "found 17", "1 to 16"]),
        ([1, 7, 10], [1, 7, 27], ["does not exist", "found 27", "1 to 26"]),
    ] {
        let (from, to) = (words(&from), words(&to));
        let at = sound.windows(12).rposition(|window| window == from).unwrap();
        let path = folder.path().join("a.e");
        std::fs::write(&path, [&sound[..at], &to, &sound[at + 12..]].concat()).unwrap();
        let found = read(&path, &request("s"), &NoProgress).unwrap_err().to_string();
        assert!(expected.iter().all(|word| found.contains(word)), "{found}");
    }
}
