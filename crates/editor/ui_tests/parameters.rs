use super::*;
use std::sync::Arc;

/// The value of a row; the panel shows it once its node is selected.
fn row(hand: &Hand, key: &str) -> Rect {
    hand.rect(key)
}

/// Selects a node.
fn select(hand: &mut Hand, node: &str) {
    let title = hand.rect(&format!("node {node}")).min + vec2(30.0, 8.0);
    hand.click(title);
    hand.frames(3);
}

/// Types a text in place of what stands in the field at a place.
fn type_at(hand: &mut Hand, at: Pos2, text: &str) {
    hand.click(at);
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed(text);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
}

#[test]
fn a_dragged_number_is_one_step_with_digits_that_a_hand_means() {
    let mut hand = Hand::in_tall_window(TEXT);
    select(&mut hand, "look");
    let at = row(&hand, "look.widgets.0.extinction").left_center() + vec2(14.0, 0.0);
    hand.drag(at, at + vec2(25.0, 0.0));
    let line = hand.text().lines().find(|line| line.starts_with("extinction")).unwrap().to_string();
    let value: f64 = line.split_once("= ").unwrap().1.parse().unwrap();
    assert!(value > 4.2 && line.len() <= "extinction = 4.123".len(), "{line}");
    assert_eq!(hand.steps(), 1);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn a_number_is_typed_relative_to_the_data_and_what_is_wrong_is_said() {
    let mut hand = Hand::in_tall_window(TEXT);
    select(&mut hand, "look");
    let key = "look.widgets.0.centre";
    hand.click_on(&format!("type {key}"));
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("p50, 10 percent");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.text(), TEXT, "what is wrong is no edit");
    assert!(row(&hand, key).height() > 30.0, "the reason stands below the field");
    let field = row(&hand, key).left_top() + vec2(20.0, 8.0);
    type_at(&mut hand, field, "p50, 10 %");
    assert!(hand.text().contains("centre = [\"p50\", \"10 %\"]"), "{}", hand.text());
    assert!(row(&hand, key).height() < 30.0, "there is nothing wrong any more");
    assert_eq!(hand.steps(), 1);
}

#[test]
fn what_a_new_widget_begins_with_is_right() {
    let registry = voltet_nodes::registry().unwrap();
    let mut hand = Hand::new(TEXT);
    let rows = hand.editor.document().rows(&registry, "look");
    let row = rows.iter().find(|row| row.parameter.name == "widgets").unwrap();
    let voltet_document::panel::Control::Entries(kinds) = row.control else { panic!("a list") };
    for kind in kinds {
        let entry = voltet_document::panel::default_value(kind);
        let list = row.path.clone();
        let edit = voltet_document::Edit::Insert { node: "look".into(), list, place: 1, entry };
        hand.editor.edit(edit.label(), &[edit]);
        let faults = hand.editor.document().faults(&registry);
        let is_name = |fault: &voltet_document::Diagnostic| {
            ["'fields' is missing", "'image' is missing"].iter().any(|what| fault.error.what.contains(what))
        };
        assert!(faults.iter().all(is_name), "{}: {faults:?}", kind.name);
        hand.frames(2);
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn arrays_of_the_data_are_chosen_one_or_several() {
    let text = TEXT
        .replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", "type = \"reader\"\npath = \"data.vtk\"")
        .replace("[nodes.view]", "[nodes.fields]\ntype = \"multi-gradient\"\nfields = [\"heat\"]\ninputs = { grid = \"grid\" }\n\n[nodes.view]");
    let mut hand = Hand::new(&text);
    let points = "0 0 0\n1 0 0\n0 1 0\n0 0 1\n";
    let data = format!(
        "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n{points}CELLS 1 5\n4 0 1 2 3\n\
         CELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4\nSCALARS speed float 1\nLOOKUP_TABLE default\n5 6 7 8\n"
    );
    std::fs::write(hand.folder.path().join("data.vtk"), data).unwrap();
    for (node, list, wanted) in [
        ("fields", "speed  (points, 5 to 8)", "fields = [\"heat\", \"speed\"]"),
        ("grid", "heat  (points, 1 to 4)", "scalar = \"heat\""),
    ] {
        select(&mut hand, node);
        // Their ranges are found on a thread of its own.
        for _ in 0..2000 {
            hand.frames(1);
            if !hand.texts("data").is_empty() {
                break;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        for _ in 0..400 {
            let at = hand.texts("data")[0];
            hand.click(at);
            hand.frames(2);
            if !hand.texts(list).is_empty() {
                break;
            }
            hand.key(Key::Escape, Modifiers::NONE);
            std::thread::sleep(Duration::from_millis(5));
        }
        hand.click_on(list);
        hand.key(Key::Escape, Modifiers::NONE);
        assert!(hand.text().contains(wanted), "{node}: {}", hand.text());
    }
}

/// The data are not there, so that nothing is drawn; what is wrong is shown, too.
#[test]
fn to_look_at_a_pipeline_that_ships_changes_nothing() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../pipelines");
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|end| end != "toml") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let mut hand = Hand::new(&text);
        let nodes: Vec<String> =
            hand.editor.document().pipeline().nodes.iter().map(|node| node.name.clone()).collect();
        for node in nodes {
            hand.editor.selection = [node].into();
            hand.frames(3);
        }
        assert_eq!(hand.text(), text, "{}", path.display());
    }
}

#[test]
fn a_wrong_number_stays_until_another_is_typed() {
    let text = TEXT.replace("extinction = 4.0", "extinction = -4.0");
    let mut hand = Hand::in_tall_window(&text);
    select(&mut hand, "look");
    let field = |hand: &Hand| row(hand, "look.widgets.0.extinction").left_center() + vec2(14.0, 0.0);
    let at = field(&hand);
    hand.click(at);
    hand.frames(2);
    let ground = hand.rect("node view").max + vec2(60.0, 30.0);
    hand.key(Key::Tab, Modifiers::NONE);
    hand.click(ground);
    assert_eq!(hand.text(), text, "a look at it changes nothing");
    select(&mut hand, "look");
    let at = field(&hand);
    type_at(&mut hand, at, "7");
    assert!(hand.text().contains("extinction = 7\n"), "{}", hand.text());
    assert_eq!(hand.steps(), 1);
}

/// A file that names what nobody has loaded: the window says which plug-ins were asked, as the program does.
#[test]
fn what_is_unknown_is_said_with_the_plugins_that_were_asked() {
    let mut registry = voltet_nodes::registry().unwrap();
    registry.tell_plugins("of the plug-ins: one with nothing".into());
    let start = Arc::new(|_: &Path, _: &Path| Err(Error::usage("no data here")));
    let document = Document::new();
    let editor = Editor::new(document, &registry, start, Arc::new(|| {})).unwrap();
    for error in [editor.registry.find_filter("gone").map(drop), editor.registry.find("gone").map(drop)]
        .map(Result::unwrap_err)
    {
        assert!(error.to_string().contains("of the plug-ins: one with nothing"), "{error}");
    }
}
