//! Meshes of SU2 and their solutions, as its manual writes them.

use super::meshes::{self, grid, mesh, sample};
use super::refusals::refused;
use glam::DVec3;
use std::path::PathBuf;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, inspect, read};
use voltet_testing::files::samples::file;

#[test]
fn su2_has_zones_and_markers() {
    let folder = tempfile::tempdir().unwrap();
    let zone = |number: usize, x: f64| {
        format!(
            "IZONE= {number}\nNDIME= 3\nNELEM= 1 % one\n10 0 1 2 3 0\nNPOIN= 4 4\n{x} 0 0 0\n{} 0 0 1\n% a point\n{x} 1 0 2\n{x} 0 1 3\n\
             NMARK= 1\nMARKER_TAG= wall\nMARKER_ELEMS= 1\n5 0 1 2\n",
            x + 1.0
        )
    };
    let text = format!("NZONE= 2\n{}{}", zone(1, 0.0), zone(2, 5.0));
    let path = file(&folder, "a.su2", text.as_bytes());
    let all = grid(&path, &mesh());
    assert_eq!((all.tetrahedra.len(), all.points.len()), (2, 8));
    let second = grid(&path, &Request { blocks: vec!["zone 2".into()], ..mesh() });
    assert_eq!(second.points[1], DVec3::new(6.0, 0.0, 0.0));
    for (from, to, words) in [
        ("NDIME= 3", "NDIME= 2", ["flat", "NDIME= 3"]),
        ("10 0 1 2 3", "10 0 1 2 4", ["does not exist", "element"]),
        (
            "2\nNDIME= 3\nNELEM= 1 % one\n10 0 1 2 3",
            "2\nNDIME= 3\nNELEM= 1 % one\n10 0 1 2 4",
            ["element 0 names", "found 4;"],
        ),
        ("10 0 1 2 3 0", "10 0 1", ["damaged", "a.su2:5"]),
        ("10 0 1 2 3 0", "10 0 1 2 -1 0", ["found -1", "a.su2:5"]),
        ("10 0 1 2 3 0", "10 0 1 2 1.5 0", ["found 1.5", "a.su2:5"]),
        ("10 0 1 2 3 0", "10 0 1 2 1e13 0", ["found 10000000000000", "a.su2:5"]),
        ("NELEM= 1", "NELEM= x", ["NELEM is damaged", "'x'"]),
    ] {
        let path = file(&folder, "a.su2", text.replacen(from, to, 1).as_bytes());
        refused(&path, &mesh(), &words);
    }
    let cut = &text[..text.rfind("6 0 0 1").unwrap()];
    let found =
        inspect(&file(&folder, "b.su2", cut.as_bytes()), &mesh(), &NoProgress).unwrap_err().to_string();
    assert!(["ends early", "found 1;", "4 rows"].iter().all(|word| found.contains(word)), "{found}");
    let none = read(&sample("mesh.su2"), &Request::default(), &NoProgress).unwrap_err().to_string();
    assert!(none.contains("no quantity to draw") && none.contains("calculator"), "{none}");
}

#[test]
fn su2_has_its_solution_in_a_file_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = "NDIME= 3\nNELEM= 1\n10 0 1 2 3 0\nNPOIN= 4\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let path = file(&folder, "a.su2", mesh.as_bytes());
    let table = "\"PointID\",\"x\",\"y\",\"z\",\"Density\",\"Momentum_x\",\"Momentum_y\",\"Momentum_z\"\n\
        1, 1, 0, 0, 1.25, 4, 0, 3\n0, 0, 0, 0, 1.5e+00, 0, 0, 0\n\n2, 0, 1, 0, 2.5, 0, 0, 2\n3, 0, 0, 1, 3.5, 0, 7, 0\nAOA= 2, 1\n";
    let tabs = table.replace("\",\"", "\"\t\"").replace(", ", "\t");
    let names = ["x", "y", "z", "Density", "Momentum_x", "Momentum_y", "Momentum_z"];
    let rows: [[f64; 7]; 4] = [
        [0.0, 0.0, 0.0, 1.5, 0.0, 0.0, 0.0],
        [1.0, 0.0, 0.0, 1.25, 4.0, 0.0, 3.0],
        [0.0, 1.0, 0.0, 2.5, 0.0, 0.0, 2.0],
        [0.0, 0.0, 1.0, 3.5, 0.0, 7.0, 0.0],
    ];
    let mut bytes: Vec<u8> =
        [535_532_u32, 7, 4, 0, 0].iter().flat_map(|number| number.to_le_bytes()).collect();
    for name in names {
        bytes.extend(name.bytes().chain(std::iter::repeat(0)).take(33));
    }
    bytes.extend(rows.as_flattened().iter().flat_map(|value| value.to_le_bytes()));
    // The number of iterations and eight settings.
    bytes.extend([0; 4 + 8 * 8]);
    let with = |scalar: &str, solution: &PathBuf| Request {
        solution: Some(solution.clone()),
        ..meshes::scalar(scalar)
    };
    for (name, content) in [("r.csv", table.as_bytes()), ("t.dat", tabs.as_bytes()), ("b.dat", &bytes)] {
        let solution = file(&folder, name, content);
        assert_eq!(
            **grid(&path, &with("Density", &solution)).scalar.as_ref().unwrap(),
            [1.5, 1.25, 2.5, 3.5],
            "{name}"
        );
        let speed = grid(&path, &with("Momentum:magnitude", &solution));
        assert_eq!(**speed.scalar.as_ref().unwrap(), [0.0, 5.0, 2.0, 7.0], "{name}");
        let arrays = vec!["Momentum".into(), "Momentum:2".into()];
        let several = grid(&path, &Request { point_arrays: arrays, ..with("Density", &solution) });
        assert_eq!(**several.scalar.as_ref().unwrap(), [1.5, 1.25, 2.5, 3.5], "{name}");
        let (vectors, z) =
            (&several.point_arrays["Momentum"].values, &several.point_arrays["Momentum:2"].values);
        assert_eq!(**vectors, [0.0, 0.0, 0.0, 4.0, 0.0, 3.0, 0.0, 0.0, 2.0, 0.0, 7.0, 0.0], "{name}");
        assert_eq!(**z, [0.0, 3.0, 2.0, 0.0], "{name}");
        let names = inspect(&path, &with("Density", &solution), &NoProgress).unwrap();
        let names: Vec<String> = names.arrays.into_iter().map(|array| array.head.name).collect();
        assert_eq!(names, ["Density", "Momentum"], "{name}");
        let alone = read(&solution, &meshes::mesh(), &NoProgress).unwrap_err().to_string();
        assert!(
            alone.contains("a restart or surface file of SU2") && alone.contains("--solution"),
            "{alone}"
        );
    }
    for (from, to, words) in [
        ("3, 0, 0, 1, 3.5, 0, 7, 0\n", "", ["does not fit the mesh", "3 rows"]),
        ("3, 0, 0, 1,", "4, 0, 0, 1,", ["a row of point 4", "points 0 to 3"]),
        ("3, 0, 0, 1,", "2, 0, 0, 1,", ["a row of point 2", "one of each"]),
        ("3.5, 0, 7, 0", "3.5, 0, 7", ["a value of 'Momentum_z'", "r.csv:6"]),
        ("3.5, 0, 7, 0", "3.5, 0, 7, 0, 1", ["further values", "8, one of each variable"]),
        ("3.5, 0, 7, 0", "3.5, , 0, 7", ["a value of 'Momentum_x'", "r.csv:6"]),
        ("1.25", "high", ["'high'", "r.csv:2"]),
        ("\"PointID\"", "PointID", ["no solution of SU2", "names in quotes"]),
    ] {
        let solution = file(&folder, "r.csv", table.replacen(from, to, 1).as_bytes());
        refused(&path, &with("Density", &solution), &words);
    }
    for (place, value, word) in
        [(8, 5, "5 points"), (4, 1 << 30, "at most 65535"), (4, 60000, "ends early"), (4, 0, "no variables")]
    {
        let mut wrong = bytes.clone();
        wrong[place..place + 4].copy_from_slice(&u32::to_le_bytes(value));
        let solution = file(&folder, "b.dat", &wrong);
        let found = read(&path, &with("Density", &solution), &NoProgress).unwrap_err().to_string();
        assert!(found.contains(word) && found.contains("b.dat"), "{found}");
    }
    let zones = format!("NZONE= 2\nIZONE= 1\n{mesh}IZONE= 2\n{mesh}");
    let zones = file(&folder, "zones.su2", zones.as_bytes());
    let found =
        read(&zones, &with("Density", &file(&folder, "r.csv", table.as_bytes())), &NoProgress).unwrap_err();
    assert!(found.to_string().contains("found 2 zones"), "{found}");
}
