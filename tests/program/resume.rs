//! `voltet run --resume`: the pictures that are left out, and those that are drawn again.

use crate::series::{relative, series};
use crate::support::{Folder, cube_of};
use std::fs::File;
use std::time::Duration;

/// Number of pictures that a run leaves out, and what it says beside its results.
fn kept(folder: &Folder, arguments: &[&str]) -> (usize, String) {
    let ran = folder.voltet(&[&["run", "p.toml", "--steps", "all", "--resume"], arguments].concat()).ok();
    (ran.stdout.matches("there already").count(), ran.stderr)
}

/// Moves the time of the last change of a file.
fn shift(folder: &Folder, name: &str, forward: bool, by: Duration) {
    let file = File::options().write(true).open(folder.join(name)).unwrap();
    let time = file.metadata().unwrap().modified().unwrap();
    file.set_modified(if forward { time + by } else { time - by }).unwrap();
}

#[test]
fn a_change_within_a_second_is_a_change() {
    let folder = series(3);
    kept(&folder, &[]);
    assert_eq!(kept(&folder, &[]).0, 3);
    // The size stays, and so does the second but for a chance of one in a million.
    shift(&folder, "s1.vtu", true, Duration::from_micros(1));
    assert_eq!(kept(&folder, &[]).0, 2);
    assert_eq!(kept(&folder, &[]).0, 3);
}

/// Of 20 steps 8 are looked at, the first and the last among them, and not the second.
#[test]
fn what_numbers_are_relative_to_is_a_part_of_what_a_picture_is_made_from() {
    let folder = series(20);
    relative(&folder);
    kept(&folder, &[]);
    assert_eq!(kept(&folder, &[]).0, 20);
    // A file with the time of a backup, long before the pictures.
    folder.write("s19.vtu", cube_of(2, "T", |x| 30.0 * x));
    shift(&folder, "s19.vtu", false, Duration::from_secs(3600));
    assert_eq!(kept(&folder, &[]).0, 0);
    assert_eq!(kept(&folder, &[]).0, 20);
    shift(&folder, "s1.vtu", false, Duration::from_secs(3600));
    assert_eq!(kept(&folder, &[]).0, 19, "a step that nobody but its picture looks at");
    let all = ["--ranges", "all"];
    kept(&folder, &all);
    shift(&folder, "s1.vtu", false, Duration::from_secs(3600));
    assert_eq!(kept(&folder, &all).0, 0, "relative to all steps");
    let said = folder.voltet(&["info", "p_0000.exr"]).ok().stdout;
    assert!(said.contains("and 20 files of the steps that numbers are relative to"), "{said}");
}

#[test]
fn pictures_that_carry_nothing_are_drawn_again_and_that_is_said_once() {
    let folder = series(3);
    let why = "--resume draws every picture again";
    for (name, set, reason) in [
        ("p.jpg", "file.provenance=true", "jpeg carries no texts"),
        ("p.tif", "file.provenance=true", "tiff carries no texts"),
        ("p.webp", "file.provenance=true", "webp carries no texts"),
        ("p.png", "file.provenance=false", "provenance = false at 'file'"),
    ] {
        let arguments = ["-o", name, "--set", set];
        for _ in 0..2 {
            let (count, said) = kept(&folder, &arguments);
            assert_eq!((count, said.matches(why).count()), (0, 1), "{name}: {said}");
            assert!(said.contains(reason), "{name}: {said}");
        }
    }
    for name in ["p.png", "p.exr", "p.svg", "p.pdf"] {
        kept(&folder, &["-o", name]);
        let (count, said) = kept(&folder, &["-o", name]);
        assert_eq!((count, said.contains(why)), (3, false), "{name}: {said}");
    }
}
