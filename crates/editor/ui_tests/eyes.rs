//! Eyes of surfaces, annotations and clips: what they add is taken out of the picture and brought back.

use super::handles::with_slice;
use super::*;
use voltet_core::picture::Picture;

fn picture(hand: &Hand) -> Arc<Picture> {
    hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture)
}

#[test]
fn a_closed_eye_leaves_the_picture_that_the_rest_of_the_nodes_gives() {
    let clip = "engine = \"cpu\"\nclip = [{ kind = \"sphere\", centre = [0.0, 0.0, 0.0], radius = 6.0 }]\n";
    let clipped = TEXT.replace("engine = \"cpu\"\n", clip);
    let figure = "[nodes.figure]\ntype = \"annotation\"\ntitle = \"a title\"\ninputs = { image = \"picture\" }\n\n[nodes.file]";
    let annotated = TEXT.replace("[nodes.file]", figure);
    let bare = picture(&Hand::new(TEXT));
    for (text, node) in [(with_slice(), "cut"), (clipped, "picture"), (annotated, "figure")] {
        let mut hand = Hand::new(&text);
        let whole = picture(&hand);
        assert_ne!(whole, bare, "{node}");
        hand.click_on(&format!("eye of {node}"));
        hand.settle();
        assert!(picture(&hand) == bare, "{node}: {}", hand.said());
        assert!(hand.text().contains("hidden = true") && hand.steps() == 1, "{}", hand.text());
        let without = if node == "picture" { "without the clips of" } else { "without" };
        assert_eq!(hand.shown(&|shown| shown.ends_with(&format!("{without} '{node}'"))).len(), 1);
        let kept = Hand::new(&hand.text());
        assert!(picture(&kept) == bare, "{node}: the file keeps it");
        hand.key(Key::Z, Modifiers::COMMAND);
        hand.settle();
        assert!(hand.text() == text && picture(&hand) == whole, "{node}: undone");
    }
}

#[test]
fn a_key_closes_and_opens_the_eyes_of_the_selected_nodes_and_what_is_hidden_has_no_grips() {
    let mut hand = Hand::new(&with_slice());
    assert!(hand.sees("plane of cut: position"));
    hand.editor.selection = ["cut".to_string(), "look".to_string()].into();
    for is_open in [false, true] {
        hand.key(Key::E, Modifiers::NONE);
        hand.frames(2);
        assert_eq!(hand.sees("plane of cut: position"), is_open);
        assert_eq!(hand.text().contains("hidden"), !is_open, "{}", hand.text());
    }
    assert!(!hand.sees("eye of look"), "a transfer function is no part that can be left out");
    hand.editor.selection = ["look".to_string()].into();
    let text = hand.text();
    hand.key(Key::E, Modifiers::NONE);
    assert!(hand.said().starts_with("surfaces, annotations and clips") && hand.text() == text);
}

#[test]
fn eyes_of_several_surfaces_are_one_step_and_go_with_a_name() {
    let second = "[nodes.across]\ntype = \"slice\"\norigin = [0.0, -6.0, 0.0]\nnormal = [0.0, 1.0, 0.0]\n\
                  inputs = { volume = \"gradient\" }\n\n[nodes.view]";
    let both = with_slice()
        .replace("[nodes.view]", second)
        .replace("surfaces = [\"cut\"]", "surfaces = [\"cut\", \"across\"]");
    let bare = picture(&Hand::new(TEXT));
    let mut hand = Hand::new(&both);
    hand.click_on("eye of across");
    hand.settle();
    let of_one = picture(&Hand::new(&with_slice()));
    assert!(picture(&hand) == of_one && of_one != bare, "the other one stays in the list");
    hand.click_on("eye of across");
    hand.editor.selection = ["cut".to_string(), "across".to_string()].into();
    hand.key(Key::E, Modifiers::NONE);
    hand.settle();
    assert!(picture(&hand) == bare);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.said(), "undone: take 2 nodes out of the picture");
    hand.key(Key::Y, Modifiers::COMMAND);
    hand.key(Key::E, Modifiers::NONE);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.said(), "undone: bring 2 nodes back into the picture");
    // One surface, named without a list; and under another name.
    let mut hand = Hand::new(&with_slice().replace("[\"cut\"]", "\"cut\""));
    hand.click_on("eye of cut");
    hand.settle();
    assert!(picture(&hand) == bare);
    let rename = voltet_document::Edit::Rename { node: "cut".into(), to: "slab".into() };
    hand.editor.edit("rename".into(), &[rename]);
    hand.settle();
    assert!(picture(&hand) == bare && hand.sees("eye of slab"), "{}", hand.text());
    hand.click_on("eye of slab");
    hand.settle();
    assert!(picture(&hand) == of_one);
}

/// From node to node, whose eyes are for the pointer: a key does what they do.
#[test]
fn tab_does_not_lead_to_eyes() {
    let figure =
        "\n[nodes.figure]\ntype = \"annotation\"\ntitle = \"a title\"\ninputs = { image = \"picture\" }\n";
    let mut hand = Hand::new(&[TEXT, figure].concat());
    assert!(hand.sees("eye of figure"));
    let mut is_last = false;
    for _ in 0..80 {
        hand.key(Key::Tab, Modifiers::NONE);
        hand.frames(1);
        let mut eyes = hand.harness.query_all_by_label("eye of figure");
        assert!(!eyes.any(|eye| eye.is_focused()));
        is_last |= hand.editor.panels.graph.has_focus() && hand.editor.selection.contains("figure");
    }
    assert!(is_last, "Tab led to its node");
}
