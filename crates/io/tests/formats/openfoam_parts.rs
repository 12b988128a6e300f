//! Parts of cases of OpenFOAM: regions with meshes of their own, processors, and collated files of several.

use super::refusals::says;
use crate::openfoam::{copy, grid, request, same, sample};
use std::path::{Path, PathBuf};
use voltet_core::progress::NoProgress;
use voltet_io::formats::{Request, arrays, files_read_beside, inspect, read};

#[test]
fn later_times_of_processors_are_read_with_a_warning() {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("decomposed"), folder.path());
    copy(&sample("text/constant"), &folder.path().join("constant"));
    copy(&sample("text/2"), &folder.path().join("2"));
    let read = grid(folder.path(), &request("T"));
    assert!(
        read.origin.warnings.iter().any(|warning| warning.contains("later times")),
        "{:?}",
        read.origin.warnings
    );
    same(&read, &grid(&sample("text"), &request("T")), 1e-13, "decomposed");
    copy(&sample("text/10"), &folder.path().join("10"));
    assert!(grid(folder.path(), &request("T")).origin.warnings.is_empty());
}

#[test]
fn regions_are_blocks_with_meshes_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (sample("text"), folder.path());
    copy(&from.join("system"), &to.join("system"));
    for region in ["fluid", "solid"] {
        copy(&from.join("constant/polyMesh"), &to.join("constant").join(region).join("polyMesh"));
        copy(&from.join("10"), &to.join("10").join(region));
    }
    // The solid has no zones, lies elsewhere, and has no T.
    let solid = to.join("constant/solid/polyMesh");
    std::fs::remove_file(solid.join("cellZones")).unwrap();
    let points = std::fs::read_to_string(solid.join("points")).unwrap();
    let begin = points.find("\n(\n").unwrap();
    std::fs::write(
        solid.join("points"),
        points[..begin].to_owned() + &points[begin..].replace("\n(0 ", "\n(-1 "),
    )
    .unwrap();
    std::fs::remove_file(to.join("10/solid/T")).unwrap();
    let summary = inspect(to, &Request::default(), &NoProgress).unwrap();
    let blocks: Vec<(&str, u64)> =
        summary.blocks.iter().map(|block| (&*block.name, block.cell_count())).collect();
    assert_eq!(blocks, [("fluid/left", 8), ("fluid/right", 8), ("solid", 16)]);
    let displacement = grid(to, &request("D:0"));
    assert!(displacement.points.iter().any(|p| p.x == -1.0));
    let whole = grid(&from, &request("T"));
    let own = grid(to, &request("T"));
    same(&own, &whole, 0.0, "fluid");
    assert!(
        own.origin.warnings.iter().any(|own| own.contains("'T'") && own.contains("solid")),
        "{:?}",
        own.origin.warnings
    );
    let right = Request { blocks: vec!["fluid/right".to_owned()], ..request("T") };
    let expected = Request { blocks: vec!["right".to_owned()], ..request("T") };
    same(&grid(to, &right), &grid(&from, &expected), 0.0, "fluid/right");
    // Five files of each mesh but one, and a boundary; T, D, S and C.
    assert_eq!(files_read_beside(to, &request("T")).len(), 6 + 5 + 4 + 3);
    // The case's own mesh beside them is a block, too.
    copy(&from.join("constant/polyMesh"), &to.join("constant/polyMesh"));
    std::fs::remove_file(to.join("constant/polyMesh/cellZones")).unwrap();
    let names = inspect(to, &Request::default(), &NoProgress).unwrap();
    assert_eq!(names.blocks[0].name, "region0");
}

/// Blocks of a case with their cells, and the warnings about them.
fn blocks_of(case: &Path, blocks: &[&str]) -> (Vec<(String, u64)>, Vec<String>) {
    let blocks = blocks.iter().map(|block| block.to_string()).collect();
    let summary = inspect(case, &Request { blocks, ..request("D:0") }, &NoProgress).unwrap();
    let counts = summary.blocks.iter().map(|block| (block.name.clone(), block.cell_count())).collect();
    (counts, summary.warnings)
}

#[test]
fn the_mesh_that_was_split_into_regions_is_not_drawn_over_them() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (sample("text"), folder.path());
    let counts = |own: u64| [("region0".to_owned(), own), ("a".to_owned(), 16), ("b".to_owned(), 16)];
    for name in ["constant/polyMesh", "constant/a/polyMesh", "constant/b/polyMesh"] {
        copy(&from.join("constant/polyMesh"), &to.join(name));
        std::fs::remove_file(to.join(name).join("cellZones")).unwrap();
    }
    for name in ["2/a", "2/b", "10/a", "10/b"] {
        copy(&from.join("10"), &to.join(name));
    }
    let fields = |time: &str| std::fs::copy(from.join("10/T"), to.join(time).join("T")).unwrap();
    // Fields of the first time are those from which the regions' were made.
    fields("2");
    let (found, warnings) = blocks_of(to, &[]);
    assert_eq!(found, counts(0));
    assert!(warnings.iter().any(|own| own.contains("no time but the first") && own.contains("region0")));
    assert_eq!(blocks_of(to, &["region0"]).0[0], counts(16)[0]);
    assert!(blocks_of(to, &["region0"]).1.is_empty());
    // A mesh of its own has fields of later times.
    fields("10");
    assert_eq!(blocks_of(to, &[]), (counts(16).to_vec(), Vec::new()));
    // That of all regions together has as many cells, whatever fields are there.
    let owner = to.join("constant/polyMesh/owner");
    let text = std::fs::read_to_string(&owner).unwrap();
    assert!(text.contains("nCells:16"));
    std::fs::write(owner, text.replace("nCells:16", "nCells:32")).unwrap();
    let (found, warnings) = blocks_of(to, &[]);
    assert_eq!(found, counts(0));
    assert!(warnings.iter().any(|own| own.contains("as many cells as they together, 32")), "{warnings:?}");
}

#[test]
fn a_mesh_beside_one_region_of_as_many_cells_is_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let (from, to) = (sample("text"), folder.path());
    for name in ["constant/polyMesh", "constant/solid/polyMesh"] {
        copy(&from.join("constant/polyMesh"), &to.join(name));
        std::fs::remove_file(to.join(name).join("cellZones")).unwrap();
    }
    for name in ["2", "2/solid", "10", "10/solid"] {
        copy(&from.join("10"), &to.join(name));
    }
    let counts = |own: u64| vec![("region0".to_owned(), own), ("solid".to_owned(), 16)];
    assert_eq!(blocks_of(to, &[]), (counts(16), Vec::new()));
    // So it is where the only time has fields of it.
    std::fs::rename(to.join("2"), to.join("two")).unwrap();
    assert_eq!(blocks_of(to, &[]), (counts(16), Vec::new()));
    std::fs::rename(to.join("two"), to.join("2")).unwrap();
    let files = files_read_beside(to, &Request::default());
    // No solver went on with it.
    for entry in std::fs::read_dir(to.join("10")).unwrap().map(|entry| entry.unwrap().path()) {
        if entry.is_file() {
            std::fs::remove_file(entry).unwrap();
        }
    }
    let (found, warnings) = blocks_of(to, &[]);
    assert_eq!(found, counts(0));
    assert!(warnings.iter().any(|own| own.contains("as many cells")), "{warnings:?}");
    // Of its files only the sizes are read.
    let left = files_read_beside(to, &Request::default());
    let is_own = |file: &&PathBuf| !file.to_string_lossy().contains("solid");
    let own: Vec<_> = left.iter().filter(is_own).collect();
    let sizes = ["constant/polyMesh/owner", "constant/polyMesh/points"].map(|name| to.join(name));
    assert!(left.len() < files.len() && own == sizes.iter().collect::<Vec<_>>(), "{left:?}");
}

#[test]
fn headers_of_collated_cases_are_read_without_faces() {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("collated_ascii"), folder.path());
    let path = folder.path().join("processors2/constant/polyMesh/faces");
    let text = std::fs::read_to_string(&path).unwrap();
    let second = text.find("// Processor1").unwrap();
    assert!(text[second..].contains("4("));
    std::fs::write(&path, text[..second].to_owned() + &text[second..].replace("4(", "x(")).unwrap();
    assert_eq!(arrays(folder.path(), &request("T")).unwrap().len(), 4);
    let found = read(folder.path(), &request("T"), &NoProgress).unwrap_err().to_string();
    assert!(found.contains("'x'") && found.contains("faces"), "{found}");
}

#[test]
fn mistakes_in_collated_files_say_what_and_where() {
    let folder = tempfile::tempdir().unwrap();
    copy(&sample("collated_ascii"), folder.path());
    let own = folder.path().join("processors2/10/T");
    let sound = std::fs::read_to_string(&own).unwrap();
    let second = sound.find("// Processor1").unwrap();
    let cut = |at: usize| sound[..at].to_owned();
    for (text, words) in [
        (cut(second), ["too few parts", "found 1", "2 or more"]),
        (cut(second) + "x (", ["length of a part", "'x'", "10/T"]),
        (cut(second) + "99999 (", ["ends early", "99999", "10/T"]),
        (cut(second) + "1 (1 x", ["damaged", "'x'", "10/T"]),
    ] {
        std::fs::write(&own, text).unwrap();
        let found = read(folder.path(), &request("T"), &NoProgress).unwrap_err().to_string();
        says(&found, &words);
    }
    // A folder with the range of its processors.
    std::fs::write(&own, sound).unwrap();
    std::fs::rename(folder.path().join("processors2"), folder.path().join("processors2_0-1")).unwrap();
    same(&grid(folder.path(), &request("T")), &grid(&sample("text"), &request("T")), 1e-13, "0-1");
}

#[test]
fn folders_of_processors_hold_each_once() {
    let message = |name: &str, other: Option<&str>| {
        let folder = tempfile::tempdir().unwrap();
        copy(&sample("collated_ascii"), folder.path());
        let own = std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().path());
        let own: PathBuf =
            own.into_iter().find(|path| path.to_string_lossy().contains("processors")).unwrap();
        std::fs::rename(own, folder.path().join(name)).unwrap();
        if let Some(other) = other {
            copy(&folder.path().join(name), &folder.path().join(other));
        }
        read(folder.path(), &request("T"), &NoProgress).map(|_| ()).map_err(|error| error.to_string())
    };
    assert_eq!(message("processors2", Some("processors2_old")), Ok(()));
    for (name, other, words) in [
        ("processors2", Some("processors2_0-1"), ["each of them once", "processors2, processors2_0-1"]),
        ("processors4_0-1", None, ["each of them once", "processors4_0-1"]),
        ("processors1048576", None, ["too few parts", "found 2"]),
        ("processors1", None, ["number of parts", "found 2"]),
    ] {
        let found = message(name, other).unwrap_err();
        says(&found, &words);
    }
}
