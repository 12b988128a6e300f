use super::*;
use voltet_graph::ArrayRef;

#[test]
fn saved_in_another_folder_the_file_means_the_same_data_and_says_so() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"data.vtu\" # coarse",
    );
    let mut hand = Hand::new(&text);
    std::fs::write(hand.folder.path().join("data.vtu"), "").unwrap();
    let other = hand.folder.path().join("in");
    std::fs::create_dir(&other).unwrap();
    hand.editor.save_as(&other.join("scene"));
    let saved = std::fs::read_to_string(other.join("scene.toml")).unwrap();
    assert_eq!(saved, text.replace("\"data.vtu\"", "\"../data.vtu\""));
    assert!(hand.said().contains("a path in it leads to the same file"), "{}", hand.said());
    assert!(hand.editor.document().is_saved());
    // Where the file cannot be written, nothing changes.
    let nowhere = hand.folder.path().join("none/scene.toml");
    hand.editor.save_as(&nowhere);
    assert!(hand.editor.document().is_saved() && hand.text() == saved, "{}", hand.said());
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), text, "it is a step that can be undone");
}

#[test]
fn the_file_of_a_parameter_is_chosen_in_a_list() {
    let mut hand = Hand::new(TEXT);
    std::fs::create_dir(hand.folder.path().join("pictures")).unwrap();
    std::fs::write(hand.folder.path().join("pictures/other.png"), "").unwrap();
    let title = hand.rect("node file").min + vec2(30.0, 8.0);
    hand.click(title);
    hand.frames(3);
    hand.click_on("choose file.path");
    hand.click_on("🗀  pictures");
    hand.click_on("      other.png");
    hand.click_on("Choose");
    assert!(hand.text().contains("path = \"pictures/other.png\""), "{}", hand.said());
    assert_eq!(hand.steps(), 1);
}

/// Until something is said that begins so.
fn said(hand: &mut Hand, wanted: &str) {
    for _ in 0..2000 {
        hand.frames(1);
        if hand.said().starts_with(wanted) {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("'{wanted}' is not said, but '{}'", hand.said());
}

#[test]
fn a_run_writes_what_a_run_of_the_file_would() {
    let mut hand = Hand::new(TEXT);
    hand.key(Key::X, Modifiers::NONE);
    hand.key(Key::S, Modifiers::COMMAND);
    hand.key(Key::R, Modifiers::COMMAND);
    said(&mut hand, "written in");
    let picture = hand.folder.path().join("picture.png");
    let here = std::fs::read(&picture).unwrap();
    std::fs::remove_file(&picture).unwrap();
    let registry = voltet_nodes::registry().unwrap();
    let text = std::fs::read_to_string(hand.path()).unwrap();
    let pipeline = voltet_graph::pipeline::Pipeline::parse(&text).unwrap();
    let mut graph = pipeline.graph(&registry, hand.folder.path().to_path_buf()).unwrap();
    graph.stated = voltet_graph::pipeline::Pipeline::stated(text, &registry).unwrap();
    voltet_nodes::session().run(&graph, &voltet_graph::NoObserver).unwrap();
    assert_eq!(std::fs::read(&picture).unwrap(), here, "to the byte");
    // Without a writer it says what is missing.
    let start = hand.text().find("[nodes.file]").unwrap();
    let text = hand.text()[..start].to_string();
    hand.editor.edit("text".into(), &[voltet_document::Edit::Text(text)]);
    hand.key(Key::R, Modifiers::COMMAND);
    said(&mut hand, "the pipeline writes nothing");
}

#[test]
fn an_empty_window_offers_the_files_opened_last_and_takes_dropped_ones() {
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    let list = hand.folder.path().join("state/recent");
    hand.editor.recent = crate::files::Recent::in_file(list.clone());
    let (other, gone) = (hand.folder.path().join("other.toml"), hand.folder.path().join("gone.toml"));
    std::fs::write(&other, TEXT).unwrap();
    std::fs::write(&gone, TEXT).unwrap();
    hand.editor.recent.add(&gone);
    hand.editor.recent.add(&other);
    std::fs::remove_file(&gone).unwrap();
    hand.editor.recent = crate::files::Recent::in_file(list);
    hand.frames(2);
    assert_eq!(hand.texts("Open data or a pipeline …").len(), 1);
    assert!(hand.texts("Recent files").len() == 1);
    assert_eq!(hand.editor.recent.paths().count(), 1, "what is gone is not offered");
    let folder = other.parent().unwrap().canonicalize().unwrap();
    let entry = hand.shown_beginning(&format!("other.toml   in {}", &folder.display().to_string()[..3]));
    hand.click(entry[0]);
    hand.frames(2);
    assert_eq!(hand.text(), TEXT);
    assert!(hand.texts("Open data or a pipeline …").is_empty());
    // A dropped file is asked about where work is not saved.
    hand.key(Key::X, Modifiers::NONE);
    dropped::drop_files(&mut hand, &["scene.toml"]);
    assert_ne!(hand.text(), "[pipeline]\nformat = 1\n");
    hand.click_on("Discard");
    assert_eq!(hand.text(), "[pipeline]\nformat = 1\n");
}

#[test]
fn an_empty_window_offers_an_example_that_needs_no_data() {
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    hand.click_on("Begin with an example");
    hand.settle();
    assert!(hand.text().contains("type = \"wavelet\"") && hand.steps() == 0);
    let scene = hand.editor.scene();
    assert!(
        scene.faults.is_empty() && scene.failure.is_none() && scene.pixels.is_some(),
        "{:?}",
        scene.failure
    );
    hand.key(Key::S, Modifiers::COMMAND);
    hand.frames(2);
    assert!(hand.sees("name of the file"), "it has no file yet");
}

/// A tetrahedron whose values begin with this one.
fn tetrahedron(first: u32) -> String {
    format!(
        "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\
         CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS heat float 1\nLOOKUP_TABLE default\n{first} 2 3 4\n"
    )
}

#[test]
fn data_that_come_or_change_are_read_again() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"data.vtk\"",
    );
    let mut hand = Hand::new(&text);
    let data = hand.folder.path().join("data.vtk");
    let failure =
        |hand: &Hand| hand.editor.worker.shown(|shown| shown.failure.as_ref().map(Error::to_string));
    assert!(failure(&hand).is_some_and(|failure| failure.contains("data.vtk")), "{:?}", failure(&hand));
    // As if it had been looked at long ago.
    std::fs::write(&data, tetrahedron(1)).unwrap();
    hand.editor.disk.looked = None;
    hand.settle();
    assert_eq!(failure(&hand), None);
    assert!(hand.said().contains("read again"), "{}", hand.said());
    let s = ArrayRef::Named("s");
    let least =
        |hand: &Hand| hand.editor.scene().distribution.and_then(|found| Some(found.known.ranges.get(&s)?[0]));
    until(&mut hand, "a distribution", |hand| least(hand) == Some(1.0));
    // Gone, what follows from them is stale.
    std::fs::remove_file(&data).unwrap();
    hand.key(Key::F5, Modifiers::NONE);
    hand.settle();
    for (node, status) in hand.editor.scene().nodes {
        let is_fresh = status.state == crate::worker::NodeState::Fresh;
        assert_eq!(is_fresh, ["look", "view"].contains(&node.as_str()), "{node}: {:?}", status.state);
    }
    assert!(hand.editor.scene().is_earlier());
    // By hand.
    std::fs::write(&data, tetrahedron(0)).unwrap();
    hand.key(Key::F5, Modifiers::NONE);
    until(&mut hand, "the distribution of the new data", |hand| least(hand) == Some(0.0));
    assert_eq!(hand.text(), text);
}

#[test]
fn a_file_is_found_by_a_part_of_its_name_or_by_the_arrows() {
    let mut hand = Hand::in_folder(TEXT, &|folder| {
        ["wing.vtu", "wake.vtu", "tail.vtu"].iter().for_each(|name| {
            std::fs::write(folder.join(name), "").unwrap();
        });
    });
    let name = |hand: &Hand| hand.editor.file_dialog.as_ref().map(|dialog| dialog.name.clone()).unwrap();
    hand.command(Command::Open);
    hand.frames(2);
    hand.typed("w");
    hand.frames(2);
    assert!(hand.sees("      wing.vtu") && !hand.sees("      tail.vtu"));
    for (key, wanted) in
        [(Key::ArrowDown, "wake.vtu"), (Key::ArrowDown, "wing.vtu"), (Key::ArrowUp, "wake.vtu")]
    {
        hand.key(key, Modifiers::NONE);
        hand.frames(1);
        assert_eq!(name(&hand), wanted);
    }
    // What is no name of a file is refused where it was typed, and can be typed anew.
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("zz");
    hand.frames(1);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(!hand.shown_beginning("'zz' is no file of this folder").is_empty());
    hand.typed("t");
    hand.frames(2);
    assert_eq!(name(&hand), "zzt");
    // A part that one name alone holds stands for it.
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("tai");
    hand.frames(1);
    hand.key(Key::Enter, Modifiers::NONE);
    until(&mut hand, "no reason is said", |hand| {
        hand.editor.file_dialog.as_ref().is_some_and(|dialog| dialog.fault.is_some())
    });
    let fault = hand.editor.file_dialog.as_ref().unwrap().fault.clone().unwrap();
    // As the tests' reading of data refuses all.
    assert!(fault.contains("no data here"), "{fault}");
}
