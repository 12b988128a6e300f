//! Wires of nodes that are added, and places of those that are there.

use super::first_steps::{add, node};
use super::*;

/// Source of an input of a node.
fn source<'a>(hand: &'a Hand, name: &str, port: &str) -> Option<&'a str> {
    let link = node(hand, name).inputs.iter().find(|link| link.port == port)?;
    voltet_document::links::sources(link).last()
}

fn select(hand: &mut Hand, name: &str) {
    hand.editor.selection = [name.to_string()].into();
    hand.frames(2);
}

/// A run writes the picture that the window shows.
#[test]
fn an_annotation_stands_between_its_picture_and_the_writer() {
    let mut hand = Hand::new(TEXT);
    select(&mut hand, "picture");
    add(&mut hand, "annotation");
    assert_eq!(source(&hand, "annotation", "image"), Some("picture"));
    assert_eq!(source(&hand, "file", "image"), Some("annotation"), "{}", hand.text());
    assert_eq!(hand.editor.shown_node.as_deref(), Some("annotation"));
    // It shows the scale of the colours at once.
    let drawn_with = |hand: &Hand, name: &str| {
        ["transfer_function", "volume", "camera"].map(|port| source(hand, name, port).map(str::to_string))
    };
    assert_eq!(drawn_with(&hand, "annotation"), ["look", "gradient", "view"].map(|name| Some(name.into())));
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    // A second one follows the first, also by a wire that is dropped.
    let (from, empty) =
        (hand.named("output annotation.image"), hand.rect("node view").max + vec2(40.0, 40.0));
    hand.drag(from, empty);
    hand.typed("annotation");
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(source(&hand, "annotation_2", "image"), Some("annotation"));
    assert_eq!(drawn_with(&hand, "annotation_2"), [None, None, None], "the scale stands there already");
    assert_eq!(source(&hand, "file", "image"), Some("annotation_2"), "{}", hand.text());
    assert_eq!(hand.steps(), 2, "a node with its wires is one step");
    // A picture beside another takes none of its writers.
    select(&mut hand, "view");
    add(&mut hand, "renderer");
    assert_eq!(source(&hand, "file", "image"), Some("annotation_2"));
    for _ in 0..3 {
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn a_surface_is_made_of_the_data_of_the_selected_picture_and_drawn_in_it() {
    let mut hand = Hand::new(TEXT);
    select(&mut hand, "picture");
    // The pointer is not over the graph.
    let beside = hand.named("picture picture");
    hand.move_to(beside, Modifiers::NONE);
    add(&mut hand, "contour");
    assert_eq!(source(&hand, "contour", "volume"), Some("gradient"));
    assert_eq!(source(&hand, "picture", "surfaces"), Some("contour"), "{}", hand.text());
    assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    // It stands where it is looked for, on no other.
    let frame = |name: &str| {
        let (at, size) = (hand.editor.document().position(name), hand.editor.panels.graph.size_of(name));
        Rect::from_min_size(pos2(at[0] as f32, at[1] as f32), vec2(size[0] as f32, size[1] as f32))
    };
    let (own, feeding) = (frame("contour"), frame("gradient"));
    assert!(own.center().distance(feeding.center()) < 500.0, "{own} is far from {feeding}");
    for other in ["grid", "gradient", "look", "view", "picture", "file"] {
        assert!(!own.intersects(frame(other)), "{own} lies on {other}: {}", frame(other));
    }
    // Without a selected node it is made of what the shown picture draws, and drawn in that.
    hand.editor.selection.clear();
    hand.frames(2);
    add(&mut hand, "contour");
    assert_eq!(source(&hand, "contour_2", "volume"), Some("gradient"), "{}", hand.text());
    assert!(hand.text().contains("surfaces = [\"contour\", \"contour_2\"]"), "{}", hand.text());
}

#[test]
fn a_surface_is_drawn_behind_the_annotation_that_is_shown() {
    let note = "[nodes.figure]\ntype = \"annotation\"\ninputs = { image = \"picture\" }\n\n[nodes.file]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.file]", note));
    hand.editor.show_picture("figure");
    for selected in ["", "figure", "grid"] {
        hand.editor.select(Some(selected.to_string()).into_iter().filter(|name| !name.is_empty()).collect());
        hand.frames(2);
        add(&mut hand, "slice");
        assert!(source(&hand, "picture", "surfaces").is_some(), "{selected}: {}", hand.text());
        hand.key(Key::Z, Modifiers::COMMAND);
    }
}

/// One of several conditions that exclude each other is needed.
#[test]
fn nodes_with_a_choice_of_conditions_have_one_when_added() {
    for (name, stated) in [("threshold", "range = [\"50 %\", \"100 %\"]"), ("probe", "box = { low = ")] {
        let mut hand = Hand::new(TEXT);
        select(&mut hand, "gradient");
        add(&mut hand, name);
        assert!(hand.text().contains(stated), "{}", hand.text());
        assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    }
}

/// The file gives them no places, and those in which they would be laid out are others then.
#[test]
fn nodes_stay_where_they_are_when_others_go_or_wires_do() {
    for without in ["node", "wire"] {
        let mut hand = Hand::new(TEXT);
        let place = |document: &Document, name: &str| document.position(name).map(f64::round);
        let names = ["grid", "gradient", "look", "picture", "file"];
        let before = names.map(|name| place(hand.editor.document(), name));
        select(&mut hand, "view");
        if without == "node" {
            hand.key(Key::Delete, Modifiers::NONE);
            assert!(!hand.text().contains("[nodes.view]"));
        } else {
            select(&mut hand, "gradient");
            hand.key(Key::J, Modifiers::NONE);
            hand.typed("take off grid");
            hand.frames(2);
            hand.key(Key::Enter, Modifiers::NONE);
            assert!(!hand.text().contains("grid = \"grid\""), "{}", hand.text());
        }
        hand.frames(2);
        assert_eq!(names.map(|name| place(hand.editor.document(), name)), before);
        hand.key(Key::S, Modifiers::COMMAND);
        let again = Document::open(&hand.path()).unwrap();
        assert_eq!(names.map(|name| place(&again, name)), before, "without a {without}: {}", hand.text());
        hand.key(Key::Z, Modifiers::COMMAND);
        assert_eq!(hand.text(), TEXT);
    }
}
