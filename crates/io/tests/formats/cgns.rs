//! CGNS files as pyCGNS writes them, against the same grids in .vtu files and against formulas. VTK's reader of CGNS gives the
//! same cells of them.

use super::packed::{field, follow, grid, grid_at, path, request, same_files};
use hdf5_reader::checksum::jenkins_lookup3;
use voltet_core::grid::Association;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, files_read_beside, inspect, read, steps};

#[test]
fn every_element_type_is_that_of_the_xml_file() {
    // The library 3.0 had other numbers of types; there components of vectors are v_x, v_y and v_z.
    for name in ["cells", "mixed", "mixed_old", "cells_3_0", "mixed_3_0"] {
        same_files(&format!("cgns_{name}.cgns"), "cgns_cells.vtu");
    }
    // The coordinates are those of another file.
    same_files("cgns_linked.cgns", "cgns_cells.vtu");
    assert_eq!(files_read_beside(&path("cgns_linked.cgns"), &Request::default()), [path("cgns_cells.cgns")]);
    for name in ["polyhedra", "polyhedra_old"] {
        same_files(&format!("cgns_{name}.cgns"), "polyhedra.vtu");
    }
}

#[test]
fn components_beside_a_field_of_the_vectors_name_stay_by_themselves() {
    let folder = tempfile::tempdir().unwrap();
    let beside = folder.path().join("beside.cgns");
    let mut bytes = std::fs::read(path("cgns_mixed_3_0.cgns")).unwrap();
    for place in 0..bytes.len() {
        if bytes[place..].starts_with(b"v_") {
            // The part of a header that holds the name ends with its checksum.
            let is_part =
                |begin: &usize| [b"OHDR", b"OCHK"].iter().any(|mark| bytes[*begin..].starts_with(*mark));
            let begin = (0..place).rev().find(is_part).unwrap();
            let checksum = |bytes: &[u8], end: usize| jenkins_lookup3(&bytes[begin..end]).to_le_bytes();
            let end = (place..).find(|&end| bytes[end..].starts_with(&checksum(&bytes, end))).unwrap();
            bytes[place] = b's';
            let changed = checksum(&bytes, end);
            bytes[end..end + 4].copy_from_slice(&changed);
        }
    }
    std::fs::write(&beside, bytes).unwrap();
    let arrays = |path: &std::path::Path| {
        let summary = inspect(path, &Request::default(), &NoProgress).unwrap();
        let arrays = summary.arrays.into_iter().filter(|array| array.head.association == Association::Point);
        let mut arrays: Vec<_> =
            arrays.map(|array| (array.head.name, array.head.component_count, array.number_type)).collect();
        arrays.sort();
        arrays
    };
    let of = |name: &str, count: usize, number_type| (name.to_owned(), count, number_type);
    let s = of("s", 1, "Float32");
    assert_eq!(arrays(&path("cgns_mixed_3_0.cgns")), [s.clone(), of("v", 3, "Float64")]);
    let [x, y, z] = ["s_x", "s_y", "s_z"].map(|name| of(name, 1, "Float64"));
    assert_eq!(arrays(&beside), [s, x, y, z]);
}

#[test]
fn a_pyramid_of_14_nodes_among_others_loses_one_with_a_warning() {
    let mut bytes = std::fs::read(path("cgns_mixed_old.cgns")).unwrap();
    let numbers = |own: &[i64]| own.iter().flat_map(|number| number.to_le_bytes()).collect::<Vec<_>>();
    // PENTA_15 with its first nodes; PENTA_18 and PYRA_13 follow.
    let first = numbers(&[15, 81, 82, 83]);
    let begin = bytes.windows(first.len()).position(|own| *own == first).unwrap();
    let number = |place: usize| i64::from_le_bytes(*bytes[begin + 8 * place..].first_chunk().unwrap());
    let mut nodes = Vec::new();
    for (place, kind, count) in [(0, 15, 15), (16, 16, 18), (35, 21, 13)] {
        assert_eq!(number(place), kind);
        nodes.extend((1..=count).map(|node| number(place + node)));
    }
    // The same nodes as PYRA_14, HEXA_27 and PYRA_5.
    let mut elements = Vec::new();
    for (kind, count) in [(13, 14), (19, 27), (12, 5)] {
        elements.push(kind);
        elements.extend(nodes.drain(..count));
    }
    bytes[begin..begin + 8 * elements.len()].copy_from_slice(&numbers(&elements));
    let folder = tempfile::tempdir().unwrap();
    let own = folder.path().join("pyramid.cgns");
    std::fs::write(&own, bytes).unwrap();
    let own = read(&own, &request("s"), &NoProgress).unwrap();
    let is_said = |warning: &String| warning.starts_with("The points of 1 cell beyond those that their type");
    assert!(own.origin.warnings.iter().any(is_said), "{:?}", own.origin.warnings);
}

#[test]
fn zones_of_several_bases_are_read_together_without_their_rind() {
    let own = grid("cgns_zones.cgns", &request("s"));
    follow(&own, field, "zones");
    assert_eq!(own.points.len(), 36);
    let cells = Request { association: Some(Association::Cell), ..request("c") };
    assert!(grid("cgns_zones.cgns", &cells).scalar.is_some());
    let solid = grid("cgns_zones.cgns", &Request { blocks: vec!["Solid/*".to_owned()], ..request("s") });
    assert!(solid.points.len() == 12 && solid.points.iter().all(|point| point.x >= 20.0));
    assert_eq!(solid.origin.blocks[..], ["Fluid/Rotor", "Fluid/Casing", "Wall/Skin", "Solid/Block"]);
    let summary = inspect(&path("cgns_zones.cgns"), &Request::default(), &NoProgress).unwrap();
    assert_eq!((summary.piece_count, summary.cell_count), (3, 6));
    assert!(summary.warnings.iter().any(|warning| warning.contains("Wall/Skin")), "{:?}", summary.warnings);
}

#[test]
fn a_step_has_its_own_solution_and_coordinates() {
    assert_eq!(steps(&path("cgns_steps.cgns"), &Request::default()).unwrap().0.len(), 2);
    for step in 0..2 {
        let own = grid_at("cgns_steps.cgns", "T", step);
        let shift = step as f64;
        follow(&own, |[x, y, z]| field([x - shift, y, z]) + 100.0 * shift, "steps");
        assert_eq!(own.origin.time, Some(0.25 * shift));
    }
}
