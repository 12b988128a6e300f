//! Templates: each for data of two unlike kinds, and the way to one by the mouse.

use super::*;
use crate::templates::{Template, templates};
use voltet_core::progress::NoProgress;

/// A cube of a thousandth's side, whose points have a vector beside two scalars, of which one does not vary.
const CUBE: &str = "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 double\n\
0 0 0\n1e-3 0 0\n1e-3 1e-3 0\n0 1e-3 0\n0 0 1e-3\n1e-3 0 1e-3\n1e-3 1e-3 1e-3\n0 1e-3 1e-3\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\n\
POINT_DATA 8\nFIELD all 3\nU 3 8 double\n0 0 1 0 1 0 1 0 0 0 0 2 0 2 0 2 0 0 1 1 1 2 2 2\nsame 1 8 double\n4 4 4 4 4 4 4 4\n\
p 1 8 double\n-3e5 -2e5 -1e5 0 1e5 2e5 3e5 4e5\n";

/// A lattice far from the origin with an array of its cells alone.
fn lattice() -> String {
    let values: Vec<String> = (0..27).map(|k| format!("{}", 1e-6 * f64::from(k * k % 19))).collect();
    format!(
        "# vtk DataFile Version 3.0\nlattice\nASCII\nDATASET STRUCTURED_POINTS\nDIMENSIONS 4 4 4\nORIGIN 5e6 5e6 -200\nSPACING 800 900 100\n\
         CELL_DATA 27\nSCALARS concentration double 1\nLOOKUP_TABLE default\n{}\n",
        values.join(" ")
    )
}

fn all() -> Vec<Template> {
    templates(&voltet_nodes::registry().unwrap())
}

#[test]
fn each_template_draws_data_of_two_unlike_kinds() {
    let all = all();
    let titles: Vec<&str> = all.iter().map(|template| template.title.as_str()).collect();
    let wanted = [
        "A look inside",
        "The edges",
        "A series for a film",
        "A volume",
        "A plane through",
        "A picture with a colour bar",
    ];
    assert!(
        titles.len() == wanted.len()
            && titles.iter().zip(wanted).all(|(title, begins)| title.starts_with(begins)),
        "{titles:?}"
    );
    let registry = voltet_nodes::registry().unwrap();
    for (name, data, scalar) in
        [("cube.vtk", CUBE.to_string(), "p"), ("lattice.vtk", lattice(), "concentration")]
    {
        for template in &all {
            let folder = tempfile::tempdir().unwrap();
            let file = folder.path().join(name);
            std::fs::write(&file, &data).unwrap();
            let made =
                template.filled(&file, &folder.path().join("scene.toml"), &registry, &NoProgress).unwrap();
            assert!(
                made.is_unwritten() && made.text().contains(&format!("scalar = \"{scalar}\"")),
                "{}",
                made.text()
            );
            let hand = Hand::with_file(made.text(), name, &data);
            let scene = hand.editor.scene();
            let place = format!("{} {name}\n{}", template.title, made.text());
            assert!(
                scene.faults.is_empty() && scene.failure.is_none(),
                "{:?} {:?} {place}",
                scene.faults,
                scene.failure
            );
            let picture = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
            let lit = picture.rgba.iter().filter(|pixel| pixel[3] > 0.05).count();
            assert!(lit * 20 > picture.rgba.len(), "{lit} of {} pixels: {place}", picture.rgba.len());
        }
    }
}

#[test]
fn data_that_cannot_be_drawn_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let registry = voltet_nodes::registry().unwrap();
    let filled = |content: &str| {
        let file = folder.path().join("data.vtk");
        std::fs::write(&file, content).unwrap();
        all()[0]
            .filled(&file, &folder.path().join("scene.toml"), &registry, &NoProgress)
            .unwrap_err()
            .to_string()
    };
    let even = CUBE.split("POINT_DATA").next().unwrap().to_string()
        + "POINT_DATA 8\nFIELD all 1\nsame 1 8 double\n4 4 4 4 4 4 4 4\n";
    assert!(filled(&even).contains("no array is a quantity that varies"));
    let flat =
        CUBE.replace("\n12\n", "\n7\n").replace("CELLS 1 9\n8 0 1 2 3 4 5 6 7", "CELLS 1 5\n4 0 1 2 3");
    assert!(filled(&flat).contains("no cell has a volume"), "{}", filled(&flat));
}

#[test]
fn a_template_is_begun_by_the_mouse_with_data_that_are_asked_for() {
    let mut hand = Hand::with_file("[pipeline]\nformat = 1\n", "cube.vtk", CUBE);
    hand.click_on("Begin with a template …");
    let template = all().into_iter().find(|template| template.title.starts_with("A look inside")).unwrap();
    hand.click_on(&template.title);
    assert!(hand.sees("      cube.vtk") && !hand.sees("      scene.toml"), "data alone are listed");
    hand.click_on("      cube.vtk");
    hand.click_on("Open");
    until(&mut hand, "no pipeline is made", |hand| hand.text().contains("[nodes.walls]"));
    hand.settle();
    assert!(hand.text().contains("path = \"cube.vtk\"\nscalar = \"p\""), "{}", hand.text());
    assert!(hand.text().contains("path = \"cube.png\"") && hand.editor.scene().failure.is_none());
    // For the data at hand another template begins with their file.
    hand.key(Key::S, Modifiers::COMMAND);
    hand.click_on("File");
    let submenu = hand.shown_beginning("Template")[0];
    hand.click(submenu);
    hand.frames(10);
    let other = &all()[3].title;
    hand.click_on(other);
    hand.click_on("Open");
    until(&mut hand, "no other is made", |hand| !hand.text().contains("[nodes.walls]"));
    assert!(hand.text().contains("path = \"cube.vtk\"\nscalar = \"p\""), "{}", hand.text());
}
