//! `voltet start`: from a data file to a picture in two commands.

use super::support::{Folder, cube};
use std::path::Path;

/// The heat sink that ships.
fn heat_sink(folder: &Folder) -> String {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/heat_sink.vtu");
    std::fs::create_dir(folder.join("results")).unwrap();
    std::fs::copy(from, folder.join("results/heat_sink.vtu")).unwrap();
    "results/heat_sink.vtu".into()
}

fn read(folder: &Folder, name: &str) -> String {
    std::fs::read_to_string(folder.join(name)).unwrap()
}

#[test]
fn two_commands_give_a_picture_of_boundaries() {
    let folder = Folder::new();
    let data = heat_sink(&folder);
    folder.voltet(&["start", &data, "-o", "results/look.toml"]).ok();
    let text = read(&folder, "results/look.toml");
    // The data are named from where the pipeline file is.
    assert!(text.contains("path = \"heat_sink.vtu\"") && text.contains("scalar = \"Temperature\""), "{text}");
    assert_eq!(text.matches("kind = \"gaussian\"").count(), 5, "four boundaries and the haze: {text}");
    let small = ["run", "results/look.toml", "--set", "view.size=[160, 120]"];
    folder.voltet(&small).ok();
    let picture = image::open(folder.join("results/look.png")).unwrap().to_rgb8();
    let lit = picture.pixels().filter(|pixel| pixel.0.iter().any(|c| *c > 40)).count();
    let (least, most) = (picture.pixels().len() / 10, picture.pixels().len() * 9 / 10);
    assert!((least..most).contains(&lit), "{lit} of {} pixels are lit", picture.pixels().len());
}

#[test]
fn a_file_that_is_there_is_kept_unless_forced() {
    let folder = Folder::new();
    folder.write("cube.vtu", cube(2));
    folder.write("cube.toml", "mine");
    folder.voltet(&["start", "cube.vtu"]).fails(2, &["is there already", "--force"]);
    assert_eq!(read(&folder, "cube.toml"), "mine");
    folder.voltet(&["start", "cube.vtu", "--force"]).ok();
    folder.voltet(&["check", "cube.toml"]).ok();
    let shown = folder.voltet(&["start", "cube.vtu", "-o", "-"]).ok().stdout;
    assert_eq!(shown, read(&folder, "cube.toml"));
}

#[test]
fn labels_and_constants_are_not_chosen() {
    let folder = Folder::new();
    let labelled = cube(2).replace("Name=\"layer\"", "Name=\"material_id\"");
    folder.write("cube.vtu", labelled);
    let text = folder.voltet(&["start", "cube.vtu", "-o", "-"]).ok().stdout;
    assert!(!text.contains("scalar = \"material_id\"") && !text.contains("scalar = \"ones\""), "{text}");
    folder
        .voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "ones"])
        .fails(1, &["'ones' has no boundary"]);
}

#[test]
fn of_a_scalar_that_is_named_nothing_else_is_decoded() {
    let folder = Folder::new();
    // One of the numbers of `y` is none.
    let whole = cube(2);
    let at = whole.find("Name=\"y\"").unwrap();
    let (head, tail) = whole.split_at(at + whole[at..].find('>').unwrap() + 1);
    folder.write("cube.vtu", format!("{head}broken {tail}"));
    folder.voltet(&["start", "cube.vtu", "-o", "-"]).fails(1, &["'y'"]);
    let text = folder.voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "x"]).ok().stdout;
    assert!(text.contains("scalar = \"x\""), "{text}");
    let length = folder.voltet(&["start", "cube.vtu", "-o", "-", "--scalar", "gradient"]);
    length.fails(1, &["'gradient:magnitude' has no boundary"]);
}
