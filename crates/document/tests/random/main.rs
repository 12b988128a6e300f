//! Ten thousand random edits, each held against a model that knows no text, then undone to the first byte and done again to the
//! last.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod draw;
mod forms;
mod lot;
mod model;

use lot::Lot;
use model::Model;
use voltet_document::{Document, Gesture};

/// Edits of one text.
fn edit_at_random(name: &str, text: &str, seed: u64, count: usize) {
    let mut document = Document::from_text(text.to_string(), None);
    assert!(document.is_toml(), "{name}: {:?}", document.pipeline());
    let mut model = Model::of(&document);
    let mut lot = Lot::new(seed);
    for i in 0..count {
        let edit = model.draw(&mut lot, &document);
        let before = document.text().to_string();
        // Some edits belong to drags.
        let outcome = match lot.below(4) {
            0 => document.edit_all(edit.label(), std::slice::from_ref(&edit), Some(Gesture(i as u64 / 8))),
            _ => document.edit(&edit),
        };
        outcome.unwrap_or_else(|error| panic!("{name}, edit {i}: {edit:?}\n{error}\n{before}"));
        model.carry_out(&edit);
        let read = Model::of(&document);
        assert_eq!(
            read,
            model,
            "{name}, edit {i}: {edit:?}\n--- before\n{before}\n--- after\n{}",
            document.text()
        );
        // There and back over a few steps, which changes nothing.
        if lot.below(16) == 0 {
            let now = document.text().to_string();
            let steps = lot.below(5);
            let back = (0..steps).filter(|_| document.undo()).count();
            (0..back).for_each(|_| assert!(document.redo()));
            assert_eq!(document.text(), now, "{name}, edit {i}");
        }
    }
    let last = document.text().to_string();
    while document.undo() {}
    assert_eq!(document.text(), text, "{name}: undone to the first byte");
    assert!(document.is_saved());
    while document.redo() {}
    assert_eq!(document.text(), last, "{name}: done again to the last byte");
    if text.contains("\r\n") && !text.replace("\r\n", "").contains('\n') {
        assert!(!last.replace("\r\n", "").contains('\n'), "{name}: line ends");
    }
}

#[test]
fn ten_thousand_edits_of_pipelines_that_ship() {
    let files = forms::shipped();
    assert!(files.len() >= 10);
    for (i, (name, text)) in files.iter().enumerate() {
        edit_at_random(name, text, i as u64, 10_000 / files.len());
    }
}

#[test]
fn edits_of_files_written_in_unusual_ways() {
    for (i, (name, text)) in forms::unusual().iter().enumerate() {
        for seed in 0..10 {
            // Short ones too: what was written in unusual ways is soon written over.
            edit_at_random(name, text, 1000 + 100 * i as u64 + seed, 20);
        }
        edit_at_random(name, text, 5000 + i as u64, 400);
    }
}
