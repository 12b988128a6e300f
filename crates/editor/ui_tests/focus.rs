//! The focus of the keyboard: where Tab leads, what is in view then, and what Escape leaves.

use super::*;
use crate::focus::Sheet;
use eframe::egui::Response;

fn focused(hand: &Hand) -> Option<Response> {
    hand.ctx.memory(|memory| memory.focused()).and_then(|id| hand.ctx.read_response(id))
}

fn selected(hand: &Hand) -> Vec<&str> {
    hand.editor.selection.iter().map(String::as_str).collect()
}

fn press(hand: &mut Hand, key: Key, held: Modifiers) {
    hand.key(key, held);
    hand.frames(2);
}

#[test]
fn what_gains_the_focus_by_tab_is_in_view() {
    let mut hand = Hand::before_window(TEXT, [700.0, 500.0], &|_| {});
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(2);
    press(&mut hand, Key::Enter, Modifiers::NONE);
    let pane = hand.rect("remark of picture");
    let mut places = Vec::new();
    for held in [[Modifiers::NONE; 12], [Modifiers::SHIFT; 12]].concat() {
        press(&mut hand, Key::Tab, held);
        // It scrolls there.
        hand.frames(30);
        let Some(focused) = focused(&hand).filter(|focused| pane.x_range().contains(focused.rect.center().x))
        else {
            continue;
        };
        let seen = focused.interact_rect;
        assert!(seen.height() > 0.9 * focused.rect.height(), "{} of {} after {places:?}", seen, focused.rect);
        places.push(focused.rect.center().y);
    }
    assert!(places.len() > 12, "{places:?}");
}

#[test]
fn the_sheet_of_keys_scrolls_by_keys_and_keeps_tab() {
    let mut hand = Hand::before_window(TEXT, [700.0, 500.0], &|_| {});
    let before = hand.text();
    hand.key(Key::F1, Modifiers::NONE);
    hand.frames(4);
    let at = |hand: &Hand, words: &str| hand.texts(words).first().map(|at| at.y);
    let first = |hand: &Hand| at(hand, "new pipeline").unwrap_or(-1e6);
    let (start, node) = (first(&hand), hand.editor.selection.clone());
    let mut last = start;
    for key in [Key::ArrowDown, Key::PageDown] {
        press(&mut hand, key, Modifiers::NONE);
        assert!(first(&hand) < last - 20.0, "{key:?}");
        last = first(&hand).max(-1e3);
    }
    press(&mut hand, Key::End, Modifiers::NONE);
    assert!(at(&hand, "store (in the file) and recall the widgets").is_some_and(|y| y < 500.0));
    press(&mut hand, Key::Home, Modifiers::NONE);
    assert!((first(&hand) - start).abs() < 1.0, "{} after {start}", first(&hand));
    for held in [Modifiers::NONE, Modifiers::NONE, Modifiers::NONE, Modifiers::SHIFT] {
        press(&mut hand, Key::Tab, held);
        assert_eq!(focused(&hand).map(|focused| focused.layer_id.id), Some(Sheet::KEYS.id()));
    }
    assert_eq!((hand.text(), &hand.editor.selection), (before, &node));
    // Once it is closed they are for the graph again.
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert!(!hand.editor.panels.help);
    press(&mut hand, Key::ArrowLeft, Modifiers::NONE);
    assert_ne!(hand.editor.selection, node);
}

#[test]
fn tab_goes_on_from_the_selected_node_and_back() {
    let mut hand = Hand::new(TEXT);
    assert_eq!(selected(&hand), ["look"]);
    for (held, node) in
        [(Modifiers::NONE, "view"), (Modifiers::SHIFT, "look"), (Modifiers::SHIFT, "gradient")]
    {
        press(&mut hand, Key::Tab, held);
        assert_eq!(selected(&hand), [node]);
        assert!(hand.editor.panels.graph.has_focus(), "{node}");
    }
    // A node that was raised by a click lies above the others, and is followed by the same node as before.
    press(&mut hand, Key::Escape, Modifiers::NONE);
    hand.click(hand.rect("node grid").left_top() + vec2(12.0, 8.0));
    hand.frames(2);
    assert_eq!(selected(&hand), ["grid"]);
    press(&mut hand, Key::Tab, Modifiers::NONE);
    assert_eq!(selected(&hand), ["gradient"]);
    // Enter goes to its parameters, Escape and Tab on to the next one.
    press(&mut hand, Key::Enter, Modifiers::NONE);
    assert!(!hand.editor.panels.graph.has_focus() && focused(&hand).is_some());
    press(&mut hand, Key::Escape, Modifiers::NONE);
    press(&mut hand, Key::Tab, Modifiers::NONE);
    assert_eq!(selected(&hand), ["look"]);
    // Without a selection it begins at the first one.
    press(&mut hand, Key::Escape, Modifiers::NONE);
    hand.editor.selection.clear();
    press(&mut hand, Key::Tab, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(selected(&hand), ["grid"]);
    assert!(hand.editor.panels.graph.has_focus());
}

#[test]
fn tab_begins_at_the_list_of_widgets_where_they_have_the_keys_and_a_ring_shows_the_focus() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    press(&mut hand, Key::W, Modifiers::NONE);
    press(&mut hand, Key::Tab, Modifiers::NONE);
    let mut first = hand.harness.query_all_by_label_contains("widget 1 gaussian");
    assert!(first.any(|widget| widget.is_focused()));
    drop(first);
    let color = hand.ctx.global_style().visuals.selection.stroke.color;
    let has_ring = |hand: &Hand| {
        let focused = focused(hand).expect("the focus").interact_rect;
        let is_ring = |shape: &Shape| matches!(shape, Shape::Rect(ring) if ring.stroke.color == color && (ring.rect.center() - focused.center()).length() < 2.0);
        hand.shapes().iter().any(|clipped| is_ring(&clipped.shape))
    };
    assert!(has_ring(&hand));
    for _ in 0..40 {
        press(&mut hand, Key::Tab, Modifiers::NONE);
        let mut planes = hand.harness.query_all_by_label_contains("plane of ");
        if planes.any(|plane| plane.is_focused()) {
            drop(planes);
            assert!(has_ring(&hand), "of the plane");
            return;
        }
    }
    panic!("Tab does not lead to the plane");
}

/// It would lie above what is opened.
#[test]
fn help_goes_where_a_sheet_or_a_dialog_opens() {
    for command in [Command::Help, Command::Open] {
        let mut hand = Hand::new(TEXT);
        let at = hand.named("all of the data into the picture");
        hand.move_to(at, Modifiers::NONE);
        hand.pause = 1.0;
        hand.frames(8);
        let words = |hand: &Hand| hand.texts("all of the data into the picture (H)").len();
        assert_eq!(words(&hand), 1);
        hand.command(command);
        hand.frames(20);
        assert_eq!(words(&hand), 0, "{command:?}");
        hand.key(Key::Escape, Modifiers::NONE);
        hand.key(Key::Escape, Modifiers::NONE);
        hand.frames(2);
        hand.move_to(at + vec2(1.0, 0.0), Modifiers::NONE);
        hand.pause = 1.0;
        hand.frames(8);
        assert_eq!(words(&hand), 1, "{command:?} is closed");
    }
}

#[test]
fn escape_leaves_modes_of_the_picture_then_the_comparison_then_the_strip() {
    let mut hand = Hand::new(TEXT);
    press(&mut hand, Key::M, Modifiers::NONE);
    hand.click_on("remember");
    hand.click(hand.texts("measure")[0]);
    hand.frames(2);
    let shown = |hand: &Hand| [hand.sees("line of comparison"), hand.sees("frame")];
    assert_eq!(shown(&hand), [true, true]);
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert_eq!(shown(&hand), [true, true], "it measures no more");
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert_eq!(shown(&hand), [false, true]);
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert_eq!(shown(&hand), [false, false]);
    // The sheet of films shows it, and takes it away.
    hand.command(Command::Film);
    hand.frames(3);
    assert!(hand.sees("frame"));
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert!(!hand.sees("frame"));
    // Escape in the parameters is for them.
    hand.click_on("remember");
    hand.editor.selection = ["picture".to_string()].into();
    press(&mut hand, Key::Enter, Modifiers::NONE);
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert!(hand.sees("line of comparison"));
    press(&mut hand, Key::Escape, Modifiers::NONE);
    assert!(!hand.sees("line of comparison"));
}
