use super::*;
use crate::scene::Command;

/// A window with a frame around two nodes that is named.
fn framed() -> Hand {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["look", "view"].map(String::from).into();
    let ctx = hand.ctx.clone();
    hand.editor.command(&ctx, Command::Frame);
    hand.frames(2);
    hand.typed("What is seen");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    hand.pause = 2.0;
    hand
}

#[test]
fn a_frame_is_named_moved_with_what_it_holds_and_resized() {
    let mut hand = framed();
    assert!(hand.text().contains("{ title = \"What is seen\""), "{}", hand.text());
    let before = hand.text();
    let steps = hand.steps();
    let at = |hand: &Hand, node: &str| hand.editor.document().position(node);
    let (look, grid) = (at(&hand, "look"), at(&hand, "grid"));
    let frame = hand.editor.document().view().frames[0].clone();
    let title = hand.texts("What is seen")[0];
    hand.drag(title, title + vec2(20.0, 60.0));
    let moved = hand.editor.document().view().frames[0].clone();
    let by = [moved.position[0] - frame.position[0], moved.position[1] - frame.position[1]];
    assert!(by[0] > 15.0 && by[1] > 50.0, "{by:?}");
    for (node, from) in [("look", look), ("grid", grid)] {
        let went = [at(&hand, node)[0] - from[0], at(&hand, node)[1] - from[1]];
        let wanted = if node == "look" { by } else { [0.0; 2] };
        assert!((0..2).all(|i| (went[i] - wanted[i]).abs() <= 1.0), "{node}: {went:?} {wanted:?}");
    }
    assert_eq!(hand.steps(), steps + 1, "a drag is one step");
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), before);
    let title = hand.texts("What is seen")[0];
    hand.move_to(title, Modifiers::NONE);
    for _ in 0..2 {
        hand.button(true, PointerButton::Primary, Modifiers::NONE);
        hand.button(false, PointerButton::Primary, Modifiers::NONE);
    }
    hand.frames(2);
    hand.typed("Other words");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("{ title = \"Other words\""), "{}", hand.text());
}

#[test]
fn nodes_are_folded_and_keep_their_wires() {
    let mut hand = Hand::new(TEXT);
    let before = hand.rect("node picture");
    hand.editor.selection = ["picture", "view"].map(String::from).into();
    hand.key(Key::B, Modifiers::NONE);
    hand.frames(3);
    let after = hand.rect("node picture");
    assert!(after.height() < 0.6 * before.height(), "{before:?} {after:?}");
    assert!(!hand.sees("input picture.camera"), "the head alone");
    assert!(hand.text().contains("folded = true"), "{}", hand.text());
    hand.key(Key::B, Modifiers::NONE);
    hand.frames(3);
    assert!(hand.sees("input picture.camera"));
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn far_away_nodes_show_their_names_alone_and_are_still_moved() {
    let mut hand = Hand::new(TEXT);
    assert_eq!(hand.texts("transfer_function").len(), 2, "ports have names");
    let ground = hand.rect("node view").max + vec2(40.0, 40.0);
    hand.move_to(ground, Modifiers::NONE);
    let delta = vec2(0.0, -12.0);
    let unit = eframe::egui::MouseWheelUnit::Line;
    hand.frame(
        vec![Event::MouseWheel { unit, delta, phase: TouchPhase::Move, modifiers: Modifiers::NONE }],
        Modifiers::NONE,
    );
    hand.frames(30);
    assert_eq!(hand.texts("transfer_function").len(), 0);
    let frame = hand.rect("node picture");
    let names = hand.texts("picture");
    assert!(names.iter().any(|at| frame.contains(*at)) && frame.width() < 90.0, "{frame:?} {names:?}");
    let before = hand.editor.document().position("picture");
    hand.drag(frame.center(), frame.center() + vec2(0.0, 30.0));
    assert!(hand.editor.document().position("picture")[1] > before[1] + 60.0);
}

#[test]
fn a_node_has_a_remark_and_the_pipeline_a_title() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["view".to_string()].into();
    hand.frames(3);
    hand.click_on("remark of view");
    hand.typed("from the south");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
    assert!(hand.text().contains("remark = \"from the south\""), "{}", hand.text());
    let frame = hand.rect("node view");
    assert!(hand.texts("from the south").iter().any(|at| frame.contains(*at)), "it stands in the node");
    hand.editor.selection.clear();
    hand.frames(2);
    hand.click_on("title of the pipeline");
    hand.typed("A box");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("title = \"A box\""), "{}", hand.text());
    assert_eq!(hand.steps(), 2);
}
