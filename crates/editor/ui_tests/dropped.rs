//! Files that are dropped on the window.

use super::*;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::channel;
use voltet_graph::Node;

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

/// A node as a plug-in brings it.
static OF_PLUGIN: Node = Node { name: "of-plug-in", summary: "A node from outside.", ..Node::BLANK };

#[test]
fn a_plug_in_is_loaded_where_a_hand_says_so_and_not_before() {
    let of_it = "\n[nodes.own]\ntype = \"of-plug-in\"\n";
    let text = TEXT.to_string() + of_it;
    let mut hand = Hand::new(&text);
    assert!(!hand.editor.scene().faults.is_empty());
    let (calls, registry) = (Arc::new(AtomicUsize::new(0)), hand.editor.registry.clone());
    let counted = calls.clone();
    hand.editor.plugins.load = Some(Arc::new(move |path: &Path| {
        counted.fetch_add(1, Ordering::SeqCst);
        let mut registry = registry.clone();
        match path.ends_with("filter.so") {
            true => registry.add(&OF_PLUGIN).map(|()| (registry, "own with of-plug-in".into())),
            false => Err(Error::run("no plug-in of this interface").in_file(path)),
        }
    }));
    drop_files(&mut hand, &["filter.so"]);
    let path = hand.folder.path().join("filter.so").display().to_string();
    assert_eq!(hand.shown_beginning(&format!("{path} is a plug-in")).len(), 1, "the path is said");
    // The question has the keys, and its last answer the focus.
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
    assert!(hand.editor.plugins.offered.is_empty() && calls.load(Ordering::SeqCst) == 0);
    for (file, words) in
        [("wrong.wasm", "no plug-in of this interface"), ("filter.so", "loaded until the window closes")]
    {
        drop_files(&mut hand, &[file]);
        hand.click_on("Load it");
        until(&mut hand, "it is not loaded", |hand| hand.said().starts_with(words));
    }
    assert_eq!((calls.load(Ordering::SeqCst), hand.text()), (2, text));
    hand.frames(3);
    assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed("from outside");
    hand.frames(2);
    assert!(hand.sees("  of-plug-in"));
}

/// Another of another plug-in.
static OF_OTHER: Node = Node { name: "of-other", summary: "A node from elsewhere.", ..Node::BLANK };

#[test]
fn plug_ins_are_loaded_one_after_the_other_and_none_is_lost() {
    let mut hand = Hand::new(TEXT);
    let known = Mutex::new(hand.editor.registry.clone());
    let (release, released) = channel();
    let released = Mutex::new(released);
    // As the program does: each with what was loaded before it began.
    hand.editor.plugins.load = Some(Arc::new(move |path: &Path| {
        let mut more = known.lock().unwrap().clone();
        released.lock().unwrap().recv_timeout(Duration::from_secs(60)).expect("it is released");
        more.add(if path.ends_with("filter.so") { &OF_PLUGIN } else { &OF_OTHER })?;
        *known.lock().unwrap() = more.clone();
        Ok((more, path.display().to_string()))
    }));
    drop_files(&mut hand, &["filter.so"]);
    hand.click_on("Load it");
    assert!(hand.said().starts_with("loading ") && hand.said().ends_with("filter.so …"), "{}", hand.said());
    drop_files(&mut hand, &["other.so"]);
    assert!(!hand.sees("Load it") && !hand.editor.asks(), "one is being loaded");
    release.send(()).unwrap();
    until(&mut hand, "it is not loaded", |hand| hand.said().starts_with("loaded until the window closes"));
    hand.frames(2);
    hand.click_on("Load it");
    release.send(()).unwrap();
    until(&mut hand, "the other is not loaded", |hand| hand.said().ends_with("other.so"));
    for name in ["of-plug-in", "of-other"] {
        assert!(hand.editor.registry.find(name).is_ok(), "{name}");
    }
}

#[test]
fn a_press_of_escape_answers_one_question() {
    let mut hand = Hand::new(TEXT);
    hand.editor.plugins.load = Some(Arc::new(|_: &Path| Err(Error::run("not asked for"))));
    hand.command(Command::Open);
    drop_files(&mut hand, &["filter.so"]);
    assert!(hand.editor.file_dialog.is_some() && !hand.sees("Load it"));
    hand.key(Key::Escape, Modifiers::NONE);
    assert!(hand.editor.file_dialog.is_none() && hand.sees("Load it"));
    hand.key(Key::Escape, Modifiers::NONE);
    assert!(!hand.sees("Load it"));
    // The view is another one.
    hand.key(Key::X, Modifiers::NONE);
    hand.command(Command::Quit);
    drop_files(&mut hand, &["filter.so"]);
    assert!(hand.editor.unsaved.is_some() && !hand.sees("Load it"));
    hand.key(Key::Escape, Modifiers::NONE);
    assert!(hand.editor.unsaved.is_none() && hand.sees("Load it"));
}

#[test]
fn several_files_are_answered_by_what_to_do() {
    let mut hand = Hand::new(TEXT);
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
