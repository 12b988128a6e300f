//! Tests of the first hit under the pointer, of the cell that a click picks, and of lengths.

use super::handles::with_slice;
use super::*;
use crate::worker::Hit;
use glam::DVec3;

/// Moves the pointer to a place, and waits for what is seen there.
fn hover(hand: &mut Hand, at: Pos2) -> Hit {
    hand.move_to(at, Modifiers::NONE);
    let picture = hand.editor.panels.picture.rect.unwrap();
    let is_there = |hand: &Hand, point: DVec3| {
        let [x, y] = hand.editor.view().unwrap().place(point).unwrap();
        (picture.center() + picture.height() * vec2(x as f32, -y as f32)).distance(at) < 0.1
    };
    until(hand, "nothing is seen", |hand| {
        hand.editor.scene().hovered.is_some_and(|hit| is_there(hand, hit.point))
    });
    hand.frames(2);
    hand.editor.scene().hovered.unwrap()
}

fn middle(hand: &Hand) -> Pos2 {
    hand.named("picture picture")
}

#[test]
fn the_values_cell_and_point_under_the_pointer_are_shown_and_marked_in_the_plane() {
    let mut hand = Hand::in_tall_window(TEXT);
    transfer::with_distribution(&mut hand);
    assert!(!hand.sees("value under the pointer"));
    let at = middle(&hand);
    // Of places that the pointer only passes nothing comes.
    for step in 0..20 {
        hand.move_to(at - vec2(3.0 * step as f32, 20.0), Modifiers::NONE);
        assert!(hand.editor.worker().shown(|shown| shown.hover.asked().is_none()), "{step}: only passed");
    }
    let hit = hover(&mut hand, at);
    let cell = hit.cell.clone().unwrap();
    assert!(hit.point.abs().max_element() <= 10.0 + 1e-6, "in the box: {}", hit.point);
    // The point parts the tetrahedron into four: weights of the corners, where the formula of the node `wavelet` holds.
    let mut corners: Vec<DVec3> = Vec::new();
    for end in cell.edges.as_flattened() {
        if !corners.contains(end) {
            corners.push(*end);
        }
    }
    assert_eq!(cell.edges.len(), 6);
    let all: [DVec3; 4] = corners.try_into().unwrap();
    let field = |p: DVec3| {
        let x = -p / 20.0;
        let bell = 255.0 * (-2.0 * x.length_squared()).exp();
        bell + 10.0 * (60.0 * x.x).sin() + 18.0 * (30.0 * x.y).sin() + 5.0 * (40.0 * x.z).cos()
    };
    let volume = |[a, b, c, d]: [DVec3; 4]| (b - a).cross(c - a).dot(d - a).abs();
    let weights = [0, 1, 2, 3].map(|k: usize| {
        let mut corners = all;
        corners[k] = hit.point;
        volume(corners) / volume(all)
    });
    assert!((weights.iter().sum::<f64>() - 1.0).abs() < 1e-6, "in the cell: {hit:?}");
    let s: f64 = (0..4).map(|k| weights[k] * field(all[k])).sum();
    assert!((cell.s - s).abs() < 1e-4 && cell.g.unwrap() > 0.0, "{cell:?} {s}");
    assert!(cell.number < 6 * 12 * 12 * 12, "{}", cell.number);
    let said = |hand: &Hand| hand.shown(&|text| text.starts_with("s ") && text.contains("   cell "));
    let words = said(&hand);
    assert!(words.len() == 1 && hand.sees("value under the pointer"), "{words:?}");
    assert_eq!((hand.text(), hand.said()), (TEXT.to_string(), String::new()));
    // Another place is asked for as the pointer leaves, and the answer comes late: it shows nothing.
    hand.move_to(at - vec2(10.0, 0.0), Modifiers::NONE);
    hand.frames(5);
    hand.move_to(hand.named("node look"), Modifiers::NONE);
    hand.frames(2);
    std::thread::sleep(Duration::from_millis(100));
    hand.frames(1);
    assert!(said(&hand).is_empty() && !hand.sees("value under the pointer"));
}

#[test]
fn what_a_clip_takes_away_is_not_met_and_a_surface_is() {
    let clip = "clip = [{ kind = \"plane\", origin = [0.0, 0.0, 3.0], normal = [0.0, 0.0, -1.0] }]\n";
    let mut hand = Hand::new(&TEXT.replace("engine = \"cpu\"\n", &format!("engine = \"cpu\"\n{clip}")));
    let at = middle(&hand);
    let hit = hover(&mut hand, at - vec2(0.0, 10.0));
    assert!((hit.point.z - 3.0).abs() < 0.05, "the cut of the clip: {}", hit.point);
    hand.click(at);
    until(&mut hand, "nothing is picked", |hand| hand.said().contains("ray"));
    let probed = hand.editor.scene().probed.clone().unwrap();
    assert!(
        probed.hit.as_ref().unwrap().point.z < 3.0 + 1e-6 && hand.said().starts_with("cell "),
        "{}",
        hand.said()
    );
    // A widget that nothing in the data meets leaves the slice alone.
    let empty = with_slice().replace("centre = [150.0, 20.0]", "centre = [9000.0, 20.0]");
    let mut hand = Hand::new(&empty);
    let at = middle(&hand);
    let hit = hover(&mut hand, at + vec2(0.0, 10.0));
    assert!((hit.point.z + 4.0).abs() < 1e-4 && hit.cell.is_some(), "{hit:?}");
}

#[test]
fn two_clicks_measure_a_length() {
    let mut hand = Hand::new(TEXT);
    let at = middle(&hand);
    hand.click_on("measure");
    let mut points = Vec::new();
    for place in [at - vec2(15.0, 0.0), at + vec2(15.0, 5.0)] {
        points.push(hover(&mut hand, place).point);
        let count = points.len();
        hand.click(place);
        until(&mut hand, "no end comes", |hand| hand.editor.scene().measured.len() == count);
    }
    let length = points[0].distance(points[1]);
    assert!(length > 1.0 && hand.editor.scene().measured[1].distance(points[1]) < 1e-6);
    let words = crate::worker::short(length);
    assert!(hand.said().starts_with(&format!("distance {words} ")), "{} {words}", hand.said());
    hand.frames(2);
    assert_eq!(hand.texts(&words).len(), 1, "at the line");
    hand.click(at);
    until(&mut hand, "no other begins", |hand| hand.editor.scene().measured.len() == 1);
    hand.click_on("measure");
    assert!(hand.editor.scene().probed.is_none() && hand.text() == TEXT);
}

/// Values of an earlier place are not shown as those of a later one.
#[test]
fn values_of_an_earlier_place_are_gone_while_the_pointer_moves() {
    let mut hand = Hand::new(TEXT);
    let at = middle(&hand);
    hover(&mut hand, at);
    hand.move_to(at + vec2(12.0, 0.0), Modifiers::NONE);
    hand.frames(1);
    assert_eq!(hand.editor.scene().hovered, None);
    // A click asks for all that the pointer then shows: nothing is asked twice.
    hand.click(at);
    until(&mut hand, "nothing is picked", |hand| hand.said().starts_with("cell "));
    let shown = hover(&mut hand, at);
    let is_same = |hand: &Hand| {
        hand.editor.worker().shown(|shown| {
            let [probe, hover] =
                [&shown.probe, &shown.hover].map(|asked| asked.answer().unwrap().clone().unwrap());
            Arc::ptr_eq(&probe, &hover)
        })
    };
    assert!(is_same(&hand) && hand.editor.scene().probed.as_ref().unwrap().hit == Some(shown));
}

#[test]
fn what_the_window_leaves_out_is_not_met() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let at = middle(&hand);
    hover(&mut hand, at);
    hand.move_to(transfer_more::place(&hand, [150.0, 20.0]), Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::V, Modifiers::NONE);
    assert!(hand.editor.panels.transfer.hidden().is_some());
    hand.settle();
    hand.move_to(at, Modifiers::NONE);
    until(&mut hand, "no answer comes", |hand| {
        hand.editor.worker().shown(|shown| shown.hover.answer().is_some())
    });
    assert_eq!(hand.editor.scene().hovered, None, "the only widget is hidden");
}

/// Another transfer function and another volume can be selected than those of the shown picture.
#[test]
fn the_shown_picture_is_probed_whatever_is_selected() {
    let second = "[nodes.other]\ntype = \"transfer-function\"\n\n[[nodes.other.widgets]]\nkind = \"gaussian\"\n\
                  color = [0.1, 0.5, 1.0]\nextinction = 40.0\ncentre = [60.0, 10.0]\nsigma = [20.0, 40.0]\n\n\
                  [nodes.coarse]\ntype = \"wavelet\"\nresolution = [4, 4, 4]\n\n[nodes.steps]\ntype = \"gradient-magnitude\"\n\
                  inputs = { grid = \"coarse\" }\n\n[nodes.second]\ntype = \"renderer\"\nengine = \"cpu\"\n\
                  inputs = { volume = \"steps\", transfer_function = \"other\", camera = \"view\" }\n\n[nodes.file]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.file]", second));
    let mut found = Vec::new();
    for (shown, selected) in
        [("picture", "look"), ("picture", "other"), ("second", "other"), ("second", "look")]
    {
        hand.editor.show_picture(shown);
        hand.editor.selection = [selected.to_string()].into();
        hand.move_to(pos2(5.0, 400.0), Modifiers::NONE);
        hand.settle();
        let at = hand.named(&format!("picture {shown}"));
        found.push(hover(&mut hand, at + vec2(4.0, 3.0)));
    }
    assert_eq!((&found[0], &found[2]), (&found[1], &found[3]));
    assert_ne!(found[0], found[2]);
}

/// The widgets of another transfer function add nothing to the picture, and no figures of the first are theirs.
#[test]
fn no_share_is_told_of_widgets_that_are_in_no_picture() {
    let second = "[nodes.other]\ntype = \"transfer-function\"\n\n[[nodes.other.widgets]]\nkind = \"gaussian\"\n\
                  color = [0.1, 0.5, 1.0]\nextinction = 40.0\ncentre = [60.0, 10.0]\nsigma = [20.0, 40.0]\n\n[nodes.file]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.file]", second));
    hand.editor.selection = ["look".to_string()].into();
    until(&mut hand, "no share comes", |hand| hand.editor.scene().share.is_some());
    hand.editor.selection = ["other".to_string()].into();
    hand.frames(3);
    hand.settle();
    assert!(hand.editor.scene().share.is_none());
    hand.editor.selection = ["look".to_string()].into();
    until(&mut hand, "the share is not told again", |hand| hand.editor.scene().share.is_some());
}

#[test]
fn what_lies_behind_a_surface_is_not_probed_and_the_surface_is_a_centre() {
    // Across the view, six units before the middle.
    let text = with_slice()
        .replace("[\"50 %\", 0.0, \"30 %\"]", "[-3.2, -4.3, 2.7]")
        .replace("normal = [0.0, 0.0, 1.0]", "normal = [-28.0, -38.0, 24.0]")
        .replace("extinction = 4.0", "extinction = 0.02");
    let probed = |text: &str| {
        let mut hand = Hand::new(text);
        let at = middle(&hand);
        let (from, to) = (at - vec2(15.0, 10.0), at + vec2(15.0, 10.0));
        hand.drag_with(from, to, PointerButton::Primary, Modifiers::ALT);
        until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
        hand.editor.scene().probed.clone().unwrap()
    };
    let (before, all) = (probed(&text), probed(&text.replace("surfaces = [\"cut\"]", "near = 0.0")));
    assert!(before.values.len() * 2 < all.values.len(), "{} of {}", before.values.len(), all.values.len());
    assert!((before.opacity - 1.0).abs() < 1e-6 && all.opacity < 0.9, "{} {}", before.opacity, all.opacity);
    // Where the data are not seen, the slice alone is.
    let empty = with_slice().replace("centre = [150.0, 20.0]", "centre = [9000.0, 20.0]");
    let mut hand = Hand::new(&empty);
    hand.editor.probe(vec![[0.01, -0.02]], crate::scene::ProbePurpose::Centre);
    until(&mut hand, "the view has no other centre", |hand| {
        (hand.editor.view().unwrap().target.z + 4.0).abs() < 1e-3
    });
}

/// Clips without numbers are those of the data, and need no picture that was drawn before.
#[test]
fn a_probe_respects_a_clip_without_numbers_as_one_in_numbers() {
    let place = [0.013, -0.11];
    let [none, silent, stated] =
        ["", "clip = [{ kind = \"plane\" }]\n", "clip = [{ kind = \"plane\", origin = [0, 0, 0] }]\n"].map(
            |clip| {
                let text = TEXT.replace("extinction = 4.0", "extinction = 0.05");
                let mut hand =
                    Hand::new(&text.replace("engine = \"cpu\"\n", &format!("engine = \"cpu\"\n{clip}")));
                hand.editor.probe(vec![place], crate::scene::ProbePurpose::Values);
                until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
                hand.editor.scene().probed.clone().unwrap().values.clone()
            },
        );
    assert_eq!(silent, stated);
    assert!(!silent.is_empty() && silent.len() < none.len(), "{} of {}", silent.len(), none.len());
}

/// One ray meets in the cells near it what it meets in those of a box.
#[test]
fn one_ray_meets_what_it_meets_among_several() {
    let mut hand = Hand::new(&TEXT.replace("extinction = 4.0", "extinction = 0.05"));
    for place in [[0.0, 0.0], [0.013, -0.11], [-0.2, 0.05], [0.1, 0.17]] {
        let [alone, both] = [1, 2].map(|count| {
            hand.editor.answers.probed = None;
            hand.editor.probe(vec![place; count], crate::scene::ProbePurpose::Values);
            until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
            hand.editor.scene().probed.clone().unwrap()
        });
        assert!(alone.values.len() > 10 && both.values.len() == 2 * alone.values.len(), "{place:?}");
        assert!((alone.opacity - both.opacity).abs() < 1e-12, "{place:?}");
        for (one, other) in alone.values.iter().zip(&both.values) {
            let near = |a: f64, b: f64| (a - b).abs() <= 1e-9 * a.abs();
            assert!(
                (0..2).all(|k| near(one.0[k], other.0[k])) && near(one.1, 2.0 * other.1),
                "{one:?} {other:?}"
            );
        }
    }
}

/// Rays through a box meet together, in bundles, what each meets alone.
#[test]
fn rays_of_a_box_meet_what_each_meets_alone() {
    let mut hand = Hand::new(&TEXT.replace("extinction = 4.0", "extinction = 0.05"));
    let mut probed = |places: Vec<[f64; 2]>| {
        hand.editor.answers.probed = None;
        hand.editor.probe(places, crate::scene::ProbePurpose::Values);
        until(&mut hand, "no answer comes", |hand| hand.editor.scene().probed.is_some());
        hand.editor.scene().probed.clone().unwrap()
    };
    // Three bundles, the last one of a few rays; some of all go past the data.
    let places: Vec<[f64; 2]> =
        (0..40).map(|k| [-0.6 + 0.03 * f64::from(k), 0.3 - 0.1 * f64::from(k / 16)]).collect();
    let all = probed(places.clone());
    let alone: Vec<_> = places.iter().map(|place| probed(vec![*place])).collect();
    let sum = |of: &dyn Fn(&crate::worker::PixelProbe) -> f64| alone.iter().map(|one| of(one)).sum::<f64>();
    assert_eq!(all.values.len() as f64, sum(&|one| one.values.len() as f64));
    assert_eq!(all.heaviest.len() as f64, sum(&|one| one.heaviest.len() as f64));
    assert!(all.heaviest.len() > 20 && all.heaviest.len() < 40, "{}", all.heaviest.len());
    assert!((all.opacity - sum(&|one| one.opacity) / 40.0).abs() < 1e-12);
    // A point is that of one ray.
    assert!(all.point.is_none() && alone.iter().any(|one| one.point.is_some()));
}

/// Two hexahedra beside each other along x, each split into tetrahedra to be drawn.
fn hexahedra() -> String {
    let at = |i: usize| [[-10, 0, 10][i / 4], [-10, 10][i / 2 % 2], [-10, 10][i % 2]];
    let points: String = (0..12).map(at).map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    let values: String = (0..12).map(|i| format!("{}\n", 120 + 5 * i)).collect();
    let cell =
        |first: usize| [0, 4, 6, 2, 1, 5, 7, 3].map(|corner: usize| (first + corner).to_string()).join(" ");
    format!(
        "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 12 double\n{points}CELLS 2 18\n\
         8 {}\n8 {}\nCELL_TYPES 2\n12\n12\nPOINT_DATA 12\nSCALARS T double 1\nLOOKUP_TABLE default\n{values}",
        cell(0),
        cell(4)
    )
}

/// Number, outline and count are those of the file's cells, not of the tetrahedra that they are split into.
#[test]
fn cells_that_are_picked_are_those_of_the_file() {
    let reader = "type = \"reader\"\npath = \"data.vtk\"\nscalar = \"T\"";
    let text = TEXT
        .replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", reader)
        .replace("extinction = 4.0", "extinction = 0.05");
    let mut hand = Hand::with_file(&text, "data.vtk", &hexahedra());
    let at = middle(&hand);
    hand.click(at);
    until(&mut hand, "nothing is picked", |hand| hand.said().contains("on the ray"));
    assert!(hand.said().starts_with("cell 0; 2 cells on the ray: s "), "{}", hand.said());
    let probed = hand.editor.scene().probed.clone().unwrap();
    assert!(probed.values.len() > 2, "it meets several tetrahedra of a cell");
    let edges = probed.hit.as_ref().unwrap().cell.clone().unwrap().edges;
    let is_along_axis =
        |[a, b]: &[DVec3; 2]| (*b - *a).to_array().iter().filter(|x| x.abs() > 1e-9).count() == 1;
    assert!(edges.len() == 12 && edges.iter().all(is_along_axis), "{edges:?}");
    assert!(edges.as_flattened().iter().all(|end| end.x <= 0.0), "those of the first: {edges:?}");
    hand.command(Command::Section);
    until(&mut hand, "no section comes", |hand| !hand.shown_beginning("2 cells are cut").is_empty());
}
