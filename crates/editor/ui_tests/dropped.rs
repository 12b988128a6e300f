//! Files that are dropped on the window.

use super::*;

#[derive(Debug)]
pub(super) struct Dropped(pub PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

/// Drops files of these names, in the folder of the pipeline, together.
pub(super) fn drop_files(hand: &mut Hand, names: &[&str]) {
    let mut input = RawInput::default();
    for name in names {
        input.dropped_files.push(Arc::new(Dropped(hand.folder.path().join(name))));
    }
    hand.frame_with(input, Modifiers::NONE);
    hand.frames(2);
}

/// Two colour maps in one transfer function.
fn with_maps() -> String {
    let map = "[[nodes.look.widgets]]\nkind = \"colormap\"\nextinction = [[0.0, 0.0], [300.0, 1.0]]\ncolormap = \"viridis\"\n";
    TEXT.replace("[nodes.view]", &format!("{map}\n{map}\n[nodes.view]"))
}

#[test]
fn a_colour_map_goes_to_the_widget_in_hand_and_says_so_where_there_is_none() {
    let mut hand = Hand::new(&with_maps());
    drop_files(&mut hand, &["own.json"]);
    assert_eq!(hand.text().matches("colormap = \"own.json\"").count(), 1, "the first: {}", hand.said());
    assert_eq!(hand.said(), "look.widgets.1.colormap is now own.json");
    hand.key(Key::Z, Modifiers::COMMAND);
    for key in [Key::W, Key::PageDown, Key::PageDown, Key::W] {
        hand.key(key, Modifiers::NONE);
    }
    // Whatever nodes are selected, the widget was chosen last.
    hand.editor.selection = ["look".to_string(), "view".to_string()].into();
    drop_files(&mut hand, &["own.json"]);
    let text = hand.text();
    let (first, last) = text.split_once("colormap = \"viridis\"").unwrap();
    assert!(!first.contains("own.json") && last.contains("colormap = \"own.json\""), "{text}");
    hand.key(Key::Z, Modifiers::COMMAND);
    let refused = |hand: &mut Hand| {
        drop_files(hand, &["own.json"]);
        assert_eq!(hand.text(), with_maps());
        assert!(
            hand.said().starts_with("select a widget or a node that has a colour map"),
            "{}",
            hand.said()
        );
    };
    // The Gaussian in hand has none.
    for key in [Key::W, Key::PageUp, Key::PageUp, Key::W] {
        hand.key(key, Modifiers::NONE);
    }
    refused(&mut hand);
    hand.editor.select(["view".to_string()].into());
    refused(&mut hand);
}

#[test]
fn a_plug_in_and_several_files_are_answered_by_what_to_do() {
    let mut hand = Hand::new(TEXT);
    drop_files(&mut hand, &["filter.so"]);
    assert!(hand.said().contains("voltet edit --plugin"), "{}", hand.said());
    drop_files(&mut hand, &["a.vtu", "b.vtu"]);
    assert!(hand.said().starts_with("drop one file at a time"), "{}", hand.said());
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn a_file_over_the_window_is_named_before_it_is_dropped() {
    let mut hand = Hand::new(TEXT);
    let path = Some(hand.folder.path().join("data.vtu"));
    let over = eframe::egui::HoveredFile { path, ..Default::default() };
    hand.frame_with(RawInput { hovered_files: vec![over], ..RawInput::default() }, Modifiers::NONE);
    assert_eq!(hand.texts("drop data.vtu here to take it up").len(), 1);
    hand.frames(1);
    assert!(hand.texts("drop data.vtu here to take it up").is_empty());
}
