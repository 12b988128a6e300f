//! Nothing of another document, or of an earlier state, is shown as if it were of what the window shows.

use super::transfer::with_distribution;
use super::*;
use crate::scene::{Action, Command, EARLIER};

/// The scene with a histogram beside its picture.
fn with_counts() -> String {
    let counts = "[nodes.counts]\ntype = \"histogram\"\ninputs = { volume = \"gradient\" }\n\n[nodes.view]";
    TEXT.replace("[nodes.view]", counts)
}

fn without_data(text: &str) -> String {
    text.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"none.vtu\"",
    )
}

/// A window that shows all that it can: both pictures, the distribution, a section, probed values, an estimate.
fn full_window() -> Hand {
    let mut hand = Hand::new(&with_counts());
    with_distribution(&mut hand);
    until(&mut hand, "no small picture", |hand| hand.editor.scene().previews.contains_key("counts"));
    hand.command(Command::Section);
    until(&mut hand, "no section", |hand| matches!(hand.editor.scene().section, Some(Ok(_))));
    let at = hand.named("picture picture");
    hand.click(at);
    until(&mut hand, "no probed values", |hand| hand.editor.scene().probed.is_some());
    let ctx = hand.ctx.clone();
    hand.editor.apply(&ctx, Action::Estimate);
    until(&mut hand, "no estimate", |hand| hand.editor.scene().estimate.is_some());
    hand
}

fn assert_empty(hand: &Hand) {
    let scene = hand.editor.scene();
    assert!(scene.pixels.is_none() && scene.previews.is_empty() && scene.distribution.is_none());
    assert!(scene.probed.is_none() && scene.section.is_none() && scene.estimate.is_none());
    assert!(scene.report.is_none() && scene.values.is_empty() && scene.share.is_none());
    assert!(hand.editor.worker().shown(|shown| shown.bounds.is_none()));
}

#[test]
fn a_new_document_shows_nothing_of_the_one_before() {
    let mut hand = full_window();
    assert!(hand.has_textures(5), "letters, two pictures, the distribution, the section");
    hand.command(Command::New);
    assert_empty(&hand);
    hand.frames(3);
    assert_empty(&hand);
    assert!(hand.editor.scene().nodes.is_empty() && hand.editor.scene().failure.is_none());
    assert!(hand.said().is_empty() && !hand.has_textures(2), "{}", hand.said());
    // Nor does a node by a name that the other document had.
    let picture = voltet_document::Edit::AddNode {
        name: "picture".into(),
        node_type: "renderer".into(),
        settings: Vec::new(),
        at: None,
    };
    hand.editor.edit("add".into(), &[picture]);
    hand.settle();
    assert_empty(&hand);
    assert!(hand.editor.scene().failure.is_some() && !hand.has_textures(2));
}

#[test]
fn a_document_whose_data_are_missing_shows_why_and_nothing_of_the_one_before() {
    let mut hand = full_window();
    let other = hand.folder.path().join("other.toml");
    std::fs::write(&other, without_data(&with_counts())).unwrap();
    let ctx = hand.ctx.clone();
    hand.editor.open_any(&ctx, &other);
    for _ in 0..3 {
        assert_empty(&hand);
        hand.settle();
    }
    let scene = hand.editor.scene();
    assert!(scene.failure.is_some_and(|failure| failure.to_string().contains("none.vtu")));
    assert!(scene.pixels.is_none() && scene.previews.is_empty() && scene.distribution.is_none());
    drop(scene.entries);
    assert!(hand.shown_beginning(&format!("picture {EARLIER}")).is_empty());
}

#[test]
fn what_an_edit_left_behind_is_marked_until_it_is_of_what_is_shown_again() {
    let mut hand = full_window();
    let mark = format!("picture {EARLIER}");
    assert!(hand.texts(&mark).is_empty() && hand.editor.scene().earlier.is_empty());
    let text = without_data(&hand.text());
    hand.editor.edit("other data".into(), &[voltet_document::Edit::Text(text)]);
    assert!(hand.editor.scene().probed.is_some());
    hand.frames(1);
    assert!(hand.editor.scene().estimate.is_none() && hand.editor.scene().probed.is_none());
    assert!(hand.editor.scene().distribution.is_none());
    hand.settle();
    assert!(hand.editor.scene().failure.is_some() && hand.editor.scene().pixels.is_some());
    assert!(hand.editor.scene().earlier.contains("picture"));
    let is_as_new = |scene: &crate::scene::Scene| {
        scene.previews.contains_key("counts") && !scene.earlier.contains("counts")
    };
    assert!(!is_as_new(&hand.editor.scene()));
    assert_eq!(hand.texts(&mark).len(), 1);
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.settle();
    until(&mut hand, "still marked", |hand| hand.editor.scene().earlier.is_empty());
    hand.frames(1);
    assert!(hand.texts(&mark).is_empty() && hand.editor.scene().failure.is_none());
}

#[test]
fn a_picture_is_that_of_the_node_that_is_shown() {
    let mut hand = full_window();
    let ctx = hand.ctx.clone();
    hand.editor.apply(&ctx, Action::Show("counts".into()));
    let of = |hand: &Hand| hand.editor.scene().pixels.map(|pixels| pixels.node);
    assert_eq!(of(&hand), None);
    hand.settle();
    assert_eq!(of(&hand).as_deref(), Some("counts"));
    // Without a node that gives a picture there is none, and no failure of the one before.
    hand.editor.edit(
        "remove".into(),
        &[voltet_document::Edit::RemoveNodes(vec!["counts".into(), "picture".into(), "file".into()])],
    );
    hand.frames(3);
    let scene = hand.editor.scene();
    assert!(scene.pixels.is_none() && scene.failure.is_none() && scene.running.is_none());
}
