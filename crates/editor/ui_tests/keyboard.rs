//! The window without a mouse.

use super::*;
use crate::scene::Command;

/// Adds a node by its name.
fn add(hand: &mut Hand, name: &str) {
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed(name);
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
}

/// A wire of the selected node by its words.
fn wire(hand: &mut Hand, words: &str) {
    hand.key(Key::J, Modifiers::NONE);
    hand.frames(2);
    hand.typed(words);
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
}

fn selected(hand: &Hand) -> Vec<&str> {
    hand.editor.selection.iter().map(String::as_str).collect()
}

#[test]
fn a_whole_round_is_done_by_the_keyboard_alone() {
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    for name in ["wavelet", "gradient-magnitude", "transfer-function", "camera", "renderer"] {
        add(&mut hand, name);
    }
    add(&mut hand, "image-writer");
    assert!(hand.editor.scene().faults.is_empty(), "{:?}\n{}", hand.editor.scene().faults, hand.text());
    hand.key(Key::W, Modifiers::NONE);
    transfer::with_distribution(&mut hand);
    hand.key(Key::P, Modifiers::NONE);
    hand.key(Key::W, Modifiers::NONE);
    hand.settle();
    assert!(hand.text().contains("kind = \"gaussian\""), "{}", hand.text());
    // All into view, to the first node, and a number of it.
    hand.key(Key::F, Modifiers::NONE);
    hand.frames(5);
    for _ in 0..80 {
        if selected(&hand) == ["wavelet"] {
            break;
        }
        hand.key(Key::Tab, Modifiers::NONE);
        hand.frames(1);
    }
    assert_eq!(selected(&hand), ["wavelet"]);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(4);
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("9");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("resolution = [9, "), "{}", hand.text());
    hand.key(Key::Escape, Modifiers::NONE);
    hand.key(Key::S, Modifiers::COMMAND);
    assert!(hand.editor.document().is_saved(), "{}", hand.said());
    hand.key(Key::R, Modifiers::COMMAND);
    until(&mut hand, "nothing is written", |hand| hand.said().starts_with("written in"));
    assert!(hand.folder.path().join("picture.png").exists());
}

#[test]
fn tab_and_arrows_lead_from_answer_to_answer_of_a_question() {
    let mut hand = Hand::new(TEXT);
    hand.key(Key::X, Modifiers::NONE);
    hand.command(Command::New);
    hand.frames(3);
    let focused =
        |hand: &Hand, name: &str| hand.harness.query_all_by_label(name).any(|node| node.is_focused());
    assert!(focused(&hand, "Cancel"));
    let forward = (Key::Tab, Modifiers::NONE);
    for (key, held, answer) in [
        (forward.0, forward.1, "Save"),
        (forward.0, forward.1, "Discard"),
        (Key::Tab, Modifiers::SHIFT, "Save"),
        (Key::ArrowLeft, Modifiers::NONE, "Cancel"),
        (Key::ArrowRight, Modifiers::NONE, "Save"),
        (Key::ArrowRight, Modifiers::NONE, "Discard"),
    ] {
        hand.key(key, held);
        hand.frames(2);
        assert!(focused(&hand, answer), "{key:?} {answer}");
    }
    // Keys of frames that follow one another: from "Discard" on to "Cancel", "Save" and "Discard" again, and back over the ends.
    let press = |hand: &mut Hand, key: Key, modifiers: Modifiers| {
        let pressed = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        hand.frame(vec![pressed], modifiers);
    };
    for (key, held) in [(Key::Tab, Modifiers::NONE), (Key::ArrowRight, Modifiers::NONE)] {
        for answer in ["Cancel", "Save", "Discard"] {
            press(&mut hand, key, held);
            assert!(focused(&hand, answer), "{key:?} {answer}");
        }
    }
    for answer in ["Save", "Cancel", "Discard"] {
        press(&mut hand, Key::Tab, Modifiers::SHIFT);
        assert!(focused(&hand, answer), "{answer}");
    }
    press(&mut hand, Key::Enter, Modifiers::NONE);
    hand.frames(3);
    assert!(hand.editor.unsaved.is_none() && hand.editor.document().pipeline().nodes.is_empty());
}

#[test]
fn arrows_select_and_move_nodes_and_wires_are_taken_off() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["grid".to_string()].into();
    hand.frames(2);
    hand.key(Key::ArrowRight, Modifiers::NONE);
    assert_eq!(selected(&hand), ["gradient"]);
    let before = hand.editor.document().position("gradient");
    hand.key(Key::ArrowDown, Modifiers::SHIFT);
    let after = hand.editor.document().position("gradient");
    assert!(after[0] == before[0] && after[1] > before[1], "{before:?} {after:?}");
    // Moves of two nodes are two steps.
    hand.key(Key::ArrowRight, Modifiers::NONE);
    assert_eq!(selected(&hand), ["picture"]);
    hand.key(Key::ArrowDown, Modifiers::SHIFT);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.editor.document().position("gradient"), after);
    hand.editor.selection = ["gradient".to_string()].into();
    hand.frames(1);
    wire(&mut hand, "take off grid");
    assert!(!hand.text().contains("grid = \"grid\""), "{}", hand.text());
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn the_only_wire_is_taken_off_where_it_is_chosen() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["file".to_string()].into();
    hand.frames(2);
    let list = |hand: &mut Hand| {
        hand.key(Key::J, Modifiers::NONE);
        hand.frames(2);
        assert!(hand.sees("  take off picture to file.image"));
    };
    list(&mut hand);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.text(), TEXT, "Enter alone takes nothing off");
    hand.key(Key::Escape, Modifiers::NONE);
    hand.frames(2);
    list(&mut hand);
    hand.key(Key::ArrowDown, Modifiers::NONE);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(!hand.text().contains("image = \"picture\""), "{}", hand.text());
}

#[test]
fn tab_goes_to_nodes_which_are_then_selected_and_adds_none() {
    let mut hand = Hand::new(TEXT);
    let mut seen = std::collections::BTreeSet::new();
    for _ in 0..80 {
        hand.key(Key::Tab, Modifiers::NONE);
        hand.frames(1);
        seen.extend(hand.editor.selection.iter().cloned());
    }
    assert!(
        ["grid", "gradient", "look", "view", "picture", "file"].iter().all(|name| seen.contains(*name)),
        "{seen:?}"
    );
    assert_eq!(hand.text(), TEXT);
    assert!(!hand.sees("search"));
}

/// Goes by Tab to a node.
fn tab_to(hand: &mut Hand, node: &str) {
    for _ in 0..80 {
        if hand.editor.panels.graph.has_focus() && selected(hand) == [node] {
            return;
        }
        hand.key(Key::Tab, Modifiers::NONE);
        hand.frames(1);
    }
    panic!("Tab does not lead to {node}");
}

#[test]
fn tab_goes_on_to_nodes_out_of_view_and_after_the_last_out_of_the_graph() {
    let mut hand = Hand::new(TEXT);
    let far = vec![("view".to_string(), [20000.0, 20000.0])];
    hand.editor.edit("away".into(), &[voltet_document::Edit::MoveNodes(far)]);
    hand.frames(3);
    assert!(!hand.sees("node view"));
    tab_to(&mut hand, "grid");
    let goes = |hand: &mut Hand, held: Modifiers, node: &str| {
        hand.key(Key::Tab, held);
        hand.frames(3);
        assert_eq!(selected(hand), [node]);
        assert!(hand.sees(&format!("node {node}")) && hand.editor.panels.graph.has_focus(), "{node}");
    };
    for node in ["gradient", "look", "view", "picture", "file"] {
        goes(&mut hand, Modifiers::NONE, node);
    }
    goes(&mut hand, Modifiers::SHIFT, "picture");
    goes(&mut hand, Modifiers::NONE, "file");
    hand.key(Key::Tab, Modifiers::NONE);
    hand.frames(3);
    assert!(!hand.editor.panels.graph.has_focus() && hand.ctx.memory(|memory| memory.focused()).is_some());
    assert_eq!(selected(&hand), ["file"]);
}

#[test]
fn arrows_choose_what_lies_ahead_before_what_is_wired_aside() {
    let mut hand = Hand::new(TEXT);
    let places = [
        ("picture", [0.0, 0.0]),
        ("file", [60.0, 320.0]),
        ("grid", [400.0, 20.0]),
        ("gradient", [-400.0, 0.0]),
        ("look", [-400.0, 200.0]),
        ("view", [-400.0, 400.0]),
    ];
    let places = places.map(|(node, at)| (node.to_string(), at)).to_vec();
    hand.editor.edit("place".into(), &[voltet_document::Edit::MoveNodes(places)]);
    for (key, node) in [(Key::ArrowRight, "grid"), (Key::ArrowDown, "file")] {
        hand.editor.selection = ["picture".to_string()].into();
        hand.frames(2);
        hand.key(key, Modifiers::NONE);
        assert_eq!(selected(&hand), [node], "{key:?}");
    }
}

#[test]
fn the_focus_goes_with_the_node_that_arrows_choose_and_is_lost_out_of_view() {
    let mut hand = Hand::new(TEXT);
    tab_to(&mut hand, "grid");
    for node in ["gradient", "picture"] {
        hand.key(Key::ArrowRight, Modifiers::NONE);
        hand.frames(2);
        assert_eq!(selected(&hand), [node]);
        assert!(hand.editor.panels.graph.has_focus(), "{node}");
    }
    // Out of view, it has the keys no more.
    let far = vec![("picture".to_string(), [20000.0, 20000.0])];
    hand.editor.edit("away".into(), &[voltet_document::Edit::MoveNodes(far)]);
    hand.frames(3);
    assert!(!hand.sees("node picture") && !hand.editor.panels.graph.has_focus());
}

/// Its keys are for it alone: none chooses or deletes a node.
#[test]
fn arrows_choose_in_an_open_list_and_the_graph_stays_as_it_is() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["grid".to_string()].into();
    hand.frames(3);
    let open = |hand: &mut Hand| {
        let at = hand.rect("grid.field").left_center() + vec2(20.0, 0.0);
        hand.click(at);
        hand.frames(2);
        assert!(hand.sees("distance"));
    };
    open(&mut hand);
    hand.key(Key::ArrowDown, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(selected(&hand), ["grid"]);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("field = \"distance\""), "{}", hand.text());
    let text = hand.text();
    open(&mut hand);
    for key in [Key::ArrowDown, Key::ArrowDown, Key::ArrowRight, Key::Delete, Key::B] {
        hand.key(key, Modifiers::NONE);
        hand.frames(1);
    }
    hand.key(Key::ArrowUp, Modifiers::NONE);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(selected(&hand), ["grid"]);
    assert!(hand.text() != text && hand.text().contains("field = \"wavelet\""), "{}", hand.text());
    // Once it is closed they are for the graph again.
    hand.key(Key::ArrowRight, Modifiers::NONE);
    assert_eq!(selected(&hand), ["gradient"]);
}
