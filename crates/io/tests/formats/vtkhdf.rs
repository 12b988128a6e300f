//! VTKHDF files as VTK and h5py write them, against the same grids in .vtu files and against formulas.

use super::packed::{field, follow, grid, grid_at, path, request, same_files};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, arrays, files_read_beside, inspect, read, steps};
use voltet_testing::files::samples::file;

#[test]
fn every_cell_type_is_that_of_the_xml_file() {
    same_files("vtkhdf_cells.vtkhdf", "cells.vtu");
    same_files("vtkhdf_short_offsets.vtkhdf", "cells.vtu");
    same_files("vtkhdf_partitions.vtkhdf", "cells.vtu");
    same_files("vtkhdf_arrays.vtkhdf", "cells.vtu");
    same_files("vtkhdf_polyhedra.vtkhdf", "polyhedra.vtu");
    let partitions = inspect(&path("vtkhdf_partitions.vtkhdf"), &Request::default(), &NoProgress).unwrap();
    assert_eq!((partitions.piece_count, partitions.active_scalars.as_deref()), (2, Some("s")));
    let names: Vec<String> = arrays(&path("vtkhdf_partitions.vtkhdf"), &Request::default())
        .unwrap()
        .into_iter()
        .map(|a| a.name)
        .collect();
    assert_eq!(names, ["s", "v", "c"], "text is no quantity");
}

#[test]
fn a_file_without_a_type_holds_an_unstructured_grid() {
    let folder = tempfile::tempdir().unwrap();
    let bytes = std::fs::read(path("vtkhdf_cells.vtkhdf")).unwrap();
    let place = bytes.windows(5).position(|own| own == b"Type\0").unwrap();
    let nameless = [&bytes[..place], b"Kind\0", &bytes[place + 5..]].concat();
    let found = read(&file(&folder, "a.vtkhdf", &nameless), &request("s"), &NoProgress).unwrap();
    assert_eq!(found.tetrahedra, grid("vtkhdf_cells.vtkhdf", &request("s")).tetrahedra);
    let image = std::fs::read(path("vtkhdf_image.vtkhdf")).unwrap();
    let place = image.windows(5).position(|own| own == b"Type\0").unwrap();
    let nameless = [&image[..place], b"Kind\0", &image[place + 5..]].concat();
    let found =
        read(&file(&folder, "a.vtkhdf", &nameless), &request("s"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("does not say what it holds"), "{found}");
}

#[test]
fn structured_grids_have_their_points_and_values() {
    for kind in ["curvilinear", "rectilinear", "image"] {
        let name = format!("vtkhdf_{kind}.vtkhdf");
        let own = grid(&name, &request("s"));
        assert_eq!(own.points.len(), 12, "{name}");
        follow(&own, field, &name);
        follow(&grid(&name, &request("v:2")), field, &name);
        follow(&grid(&name, &request("v:0")), |[x, ..]| x, &name);
        let summary = inspect(&path(&name), &Request::default(), &NoProgress).unwrap();
        assert_eq!((summary.cell_count, summary.active_scalars.as_deref()), (2, Some("s")), "{name}");
    }
}

#[test]
fn a_step_has_its_own_points_and_values() {
    for (name, moves) in [("vtkhdf_static.vtkhdf", 0.0), ("vtkhdf_moving.vtkhdf", 1.0)] {
        assert_eq!(steps(&path(name), &Request::default()).unwrap().0.len(), 3, "{name}");
        for (step, time) in [0.0, 0.5, 2.0].into_iter().enumerate() {
            let own = grid_at(name, "T", step);
            assert_eq!((own.points.len(), own.origin.time), (12, Some(time)), "{name}");
            follow(&own, |[x, y, z]| field([x - moves * time, y, z]) + 100.0 * time, name);
        }
    }
    for step in 0..2 {
        let own = grid_at("vtkhdf_image_steps.vtkhdf", "s", step);
        follow(&own, |point| field(point) + 100.0 * step as f64, "image");
    }
}

#[test]
fn blocks_are_read_together_and_external_links_are_followed() {
    let collection = ["fluid/rotor", "solid/casing"];
    for (name, cells, blocks) in
        [("collection", 6, collection), ("linked", 6, collection), ("blocks", 4, ["casing", "fluid/rotor"])]
    {
        let name = format!("vtkhdf_{name}.vtkhdf");
        follow(&grid(&name, &request("s")), field, &name);
        let summary = inspect(&path(&name), &Request::default(), &NoProgress).unwrap();
        assert_eq!(summary.cell_count, cells, "{name}");
        let rotor = Request { blocks: vec!["fluid".to_owned()], ..request("s") };
        let rotor = grid(&name, &rotor);
        assert!(rotor.points.iter().all(|point| point.x >= 9.0), "{name}");
        assert_eq!(rotor.origin.blocks[..], blocks, "{name}");
        // Partitions of a block share the points between them.
        assert_eq!(rotor.points.len(), if cells == 6 { 20 } else { 12 }, "{name}");
    }
    assert_eq!(files_read_beside(&path("vtkhdf_linked.vtkhdf"), &Request::default()).len(), 2);
}

#[test]
fn a_missing_linked_file_is_an_error_that_names_it() {
    let folder = tempfile::tempdir().unwrap();
    let alone = folder.path().join("alone.vtkhdf");
    std::fs::copy(path("vtkhdf_linked.vtkhdf"), &alone).unwrap();
    let error = read(&alone, &request("s"), &NoProgress).unwrap_err().to_string();
    for words in ["alone.vtkhdf", "external link", "vtkhdf_linked_"] {
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn each_fault_is_one_error_that_names_the_file_and_the_object() {
    for (name, words) in [
        ("huge", &["/VTKHDF/Offsets", "too small"][..]),
        ("points", &["lacks the HDF5 dataset '/VTKHDF/Points'"]),
        ("chunks", &["/VTKHDF/Points", "larger than the file can hold"]),
        ("link", &["lacks the HDF5 dataset '/VTKHDF/Points'"]),
        ("external", &["/VTKHDF", "cycle"]),
        ("tree", &["contains itself"]),
        ("version", &["newer version", "found 3"]),
        ("text", &["/VTKHDF/Points", "wrong type"]),
        ("filter", &["'/VTKHDF/Points'", "filter id 32000 (LZF)", "h5repack -f GZIP=4"]),
        (
            "virtual",
            &["'/VTKHDF/Points'", "virtual", "'points' in the file 'values_0.h5' and 1 more", "h5repack"],
        ),
        ("elsewhere", &["'/VTKHDF/Points'", "virtual", "found values of other datasets"]),
    ] {
        let name = format!("vtkhdf_bad_{name}.vtkhdf");
        let error = read(&path(&name), &request("s"), &NoProgress).unwrap_err().to_string();
        assert!(error.contains(&name) && words.iter().all(|word| error.contains(word)), "{name}: {error}");
    }
}
