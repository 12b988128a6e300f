//! Files of several processes and collections of MFEM: text that the tests write, and the files of `tests/files/make_mfem.py`.

use super::mfem::{ONE, TWO, bent, field, folder_of, grid, linear, message, places, request, root};
use super::refusals::says;
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, TimeStep, files_beside, files_read_beside, inspect, outline, steps};

#[test]
fn collections_of_several_cycles_are_a_series_by_a_file_that_names_them() {
    let folder = tempfile::tempdir().unwrap();
    let series = folder.path().join("a.series");
    let entry = |name: &str, time: f64| format!("{{\"name\": {:?}, \"time\": {time}}}", root(name));
    let text = |entries: &[String]| {
        format!("{{\"file-series-version\": \"1.0\", \"files\": [{}]}}", entries.join(", "))
    };
    std::fs::write(&series, text(&[entry("third", 1.0), entry("bent", 2.0)])).unwrap();
    assert_eq!(steps(&series, &Request::default()).unwrap().0, [1.0, 2.0]);
    let at = |time| Request { time_step: Some(TimeStep::Time(time)), ..request("third") };
    assert_eq!(places(&grid(&series, &at(2.0)), |p| p), places(&grid(&series, &at(1.0)), bent));
}

#[test]
fn nodes_end_before_what_parallel_files_add() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.mesh");
    let own = |name: &str| folder_of("curved/curved_000003").join(name);
    let text = std::fs::read_to_string(own("mesh.000000")).unwrap();
    let parallel = text.replacen("mesh v1.0", "mesh v1.2", 1)
        + "\nmfem_serial_mesh_end\n\ncommunication_groups\nnumber_of_groups 2\n\n# a\n1 0\n\nmfem_mesh_end\n";
    let request = Request { solution: Some(own("quadratic.000000")), ..request("quadratic") };
    let whole = grid(&own("mesh.000000"), &request);
    for text in [parallel.clone(), parallel.replace('\n', "\r\n")] {
        std::fs::write(&path, text).unwrap();
        let found = grid(&path, &request);
        assert!(found.points == whole.points && found.scalar == whole.scalar);
    }
    std::fs::write(&path, parallel.replacen("mfem_serial_mesh_end", "", 1).replacen("mfem_mesh_end", "", 1))
        .unwrap();
    let found = message(&path, &request);
    assert!(found.contains("'communication_groups'") && found.contains("a.mesh:"), "{found}");
}

#[test]
fn processes_have_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let part = |number: usize, text: &str, values: &str| {
        std::fs::write(folder.path().join(format!("mesh.00000{number}")), text).unwrap();
        std::fs::write(folder.path().join(format!("sol.00000{number}")), field("H1_3D_P1", 1, values))
            .unwrap();
    };
    let one = "MFEM mesh v1.2\n\ndimension\n3\n\nelements\n1\n1 4 0 1 2 3\n\nboundary\n0\n\nvertices\n4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\n\
        mfem_serial_mesh_end\n\ncommunication_groups\n";
    part(0, one, "1 3 -2 5");
    part(1, &one.replace("0 0 0", "1 1 1").replace("1 4 0", "2 4 0"), "4 3 -2 5");
    let mesh = folder.path().join("mesh.000001");
    let request = Request { solution: Some(folder.path().join("sol.000000")), ..request("sol") };
    let own = grid(&mesh, &request);
    assert_eq!((own.points.len(), own.tetrahedra.len()), (5, 2));
    assert!(
        own.points.iter().zip(own.scalar.as_ref().unwrap().iter()).all(|(&p, &value)| value == linear(p))
    );
    assert_eq!(files_read_beside(&mesh, &request).len(), 2);
    // The same by a root file; packed, and with a field that is not read.
    let root = folder.path().join("a_000000.mfem_root");
    let text = |domains: &str| {
        format!(
            "{{\"dsets\": {{\"main\": {{\"cycle\": 0, \"domains\": {domains}, \"fields\": {{\"f\": {{\"path\": \"sol.%06d\"}}, \"E\": \
             {{\"path\": \"E.%06d\"}}}}, \"mesh\": {{\"path\": \"mesh.%06d\"}}, \"time\": 2.5}}}}}}"
        )
    };
    std::fs::write(&root, text("2")).unwrap();
    for number in 0..2 {
        std::fs::write(folder.path().join(format!("E.00000{number}")), field("ND_3D_P1", 1, "1 2 3 4 5 6"))
            .unwrap();
    }
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    std::io::Write::write_all(&mut packed, one.as_bytes()).unwrap();
    std::fs::write(folder.path().join("mesh.000000"), packed.finish().unwrap()).unwrap();
    let of_root = grid(&root, &Request { scalar: Some("f".to_owned()), ..Request::default() });
    assert_eq!((of_root.points.len(), of_root.scalar), (5, own.scalar));
    let is_named = |own: &String| own.contains("'E'") && own.contains("ND_3D_P1");
    assert!(of_root.origin.warnings.iter().any(is_named), "{:?}", of_root.origin.warnings);
    assert_eq!(files_beside(&root).len(), 6);
    let blocks = outline(&root, &Request::default()).unwrap().blocks;
    assert_eq!(blocks, ["1", "2"]);
    assert_eq!(steps(&root, &Request::default()).unwrap().0, [0.0; 0]);
    for (domains, words) in [
        ("3", ["mesh.000002", "3 files"]),
        ("1e99", ["domains", "damaged"]),
        ("0", ["domains", "at least 1"]),
    ] {
        std::fs::write(&root, text(domains)).unwrap();
        let found = message(&root, &Request::default());
        says(&found, &words);
    }
}

/// A root file of so many domains.
fn root_text(domains: &str, mesh: &str, field: &str) -> String {
    format!(
        "{{\"dsets\": {{\"main\": {{\"domains\": {domains}, \"fields\": {{\"f\": {{\"path\": \"{field}\"}}}}, \"mesh\": \
         {{\"path\": \"{mesh}\"}}}}}}}}"
    )
}

#[test]
fn long_names_of_sets_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("a.mesh");
    let with = |name: &str| {
        std::fs::write(&mesh, TWO.replacen("\nboth\n", &format!("\n{name}\n"), 1)).unwrap();
        inspect(&mesh, &Request::default(), &NoProgress).map(|own| own.blocks[0].name.clone())
    };
    let longest = "n".repeat(1024);
    for name in [longest.clone(), format!("\"{longest}\""), format!("\"{}\"", "\\n".repeat(1024))] {
        assert_eq!(with(&name).unwrap(), longest.clone() + "/5");
        let found = with(&name.replacen('n', "nn\\n", 1)).unwrap_err().to_string();
        assert!(found.contains("name of a set") && found.contains("a.mesh:17"), "{found}");
    }
}

#[test]
fn blocks_have_names_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = folder.path().join("a.mesh");
    let names = |from: &str, to: &str| {
        assert!(TWO.contains(from));
        std::fs::write(&mesh, TWO.replacen(from, to, 1)).unwrap();
        let blocks = inspect(&mesh, &Request::default(), &NoProgress).unwrap().blocks;
        blocks.into_iter().map(|block| block.name).collect::<Vec<_>>()
    };
    let sets = "2\n\"a \\\"b\\\"\"\n1\n7\nboth\n2\n5 7\n";
    assert_eq!(names(sets, "2\na\n1\n5\na\n1\n7\n"), ["a", "a/7"]);
    assert_eq!(names(sets, "1\n5\n1\n7\n"), ["5", "5/7"]);
    assert_eq!(names(sets, "2\na\n2\n5 6\na/5\n1\n7\n"), ["a/5", "a/5/7"]);
    // The first set of an attribute names it.
    assert_eq!(names(sets, "2\nboth\n2\n5 7\nb\n1\n7\n"), ["both/5", "both/7"]);
}

#[test]
fn domains_are_files_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("a.mfem_root");
    for name in ["mesh", "mesh.000000", "mesh.000001"] {
        std::fs::write(folder.path().join(name), ONE).unwrap();
    }
    for name in ["f", "f.000000", "g.000000", "g.000001"] {
        std::fs::write(folder.path().join(name), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    }
    for (domains, mesh, field, words) in [
        ("2", "mesh", "g.%06d", ["the mesh has one path", "found mesh;", "%06d"]),
        ("4000000000", "mesh", "g.%06d", ["the mesh has one path", "found mesh;", "%06d"]),
        ("4000000000", "mesh.%06d", "g.%06d", ["the mesh", "mesh.000002", "4000000000 files"]),
        ("2", "mesh.%06d", "f", ["field 'f' has one path", "found f;", "%06d"]),
        ("2", "mesh.%06d", "f.%06d", ["field 'f'", "f.000001", "2 files"]),
        ("1", "mesh.%06d", "h", ["field 'f'", "h", "1 file"]),
    ] {
        std::fs::write(&root, root_text(domains, mesh, field)).unwrap();
        let found = message(&root, &request("f"));
        says(&found, &words);
        assert!(files_beside(&root).is_empty());
    }
    std::fs::write(&root, root_text("1", "mesh", "f")).unwrap();
    assert_eq!(grid(&root, &request("f")).points.len(), 4);
    std::fs::write(&root, root_text("2", "mesh.%06d", "g.%06d")).unwrap();
    assert_eq!(files_beside(&root).len(), 4);
}

#[test]
fn a_field_that_one_process_leaves_out_is_left_out_of_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.mfem_root"), root_text("2", "mesh.%06d", "f.%06d")).unwrap();
    let cube = ONE.replace("1 4 0 1 2 3", "1 5 0 1 2 3 4 5 6 7").replace(
        "4\n3\n0 0 0\n1 0 0\n0 1 0\n0 0 1",
        "8\n3\n0 0 2\n1 0 2\n1 1 2\n0 1 2\n0 0 3\n1 0 3\n1 1 3\n0 1 3",
    );
    for (number, mesh, count) in [(0, cube.as_str(), 27), (1, ONE, 10)] {
        std::fs::write(path(&format!("mesh.00000{number}")), mesh).unwrap();
        let values = field("L2_T1_3D_P2", 1, &"1\n".repeat(count));
        std::fs::write(path(&format!("f.00000{number}")), values).unwrap();
    }
    let summary = inspect(&path("a.mfem_root"), &Request::default(), &NoProgress).unwrap();
    assert_eq!(summary.quantities().map(|own| &*own.head.name).collect::<Vec<_>>(), ["attribute"]);
    let warnings = &summary.warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("'f' is left out"), "{warnings:?}");
}

#[test]
fn damaged_coordinates_name_their_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    let root = path("a.mfem_root");
    std::fs::write(&root, root_text("2", "mesh.%06d", "f.%06d")).unwrap();
    for name in ["mesh.000000", "mesh.000001"] {
        std::fs::write(path(name), ONE).unwrap();
    }
    for name in ["f.000000", "f.000001"] {
        std::fs::write(path(name), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    }
    for name in ["mesh.000001", "mesh.000000"] {
        std::fs::write(path(name), ONE.replacen("0 1 0\n", "0 x 0\n", 1)).unwrap();
        for (opened, scalar) in [(&root, "f"), (&path("mesh.000000"), "attribute")] {
            let found = message(opened, &request(scalar));
            assert!(found.contains("'x'") && found.contains(&format!("{name}:18")), "{found}");
        }
        std::fs::write(path(name), ONE).unwrap();
    }
    let alone = path("a.mesh");
    std::fs::write(&alone, ONE.replacen("0 1 0\n", "0 x 0\n", 1)).unwrap();
    let found = message(&alone, &request("attribute"));
    assert!(found.contains("'x'") && found.contains("a.mesh:18"), "{found}");
}

#[test]
fn a_root_file_takes_no_solution() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("a.mfem_root"), root_text("1", "mesh", "f")).unwrap();
    std::fs::write(path("mesh"), ONE).unwrap();
    std::fs::write(path("f"), field("H1_3D_P1", 1, "1 3 -2 5")).unwrap();
    let found = message(&path("a.mfem_root"), &Request { solution: Some(path("f")), ..request("f") });
    assert!(found.contains("solution") && found.contains("mesh of a process"), "{found}");
}
