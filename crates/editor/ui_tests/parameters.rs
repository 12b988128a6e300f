use super::*;
use std::sync::Arc;
use voltet_document::{Edit, Gesture};

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
fn what_is_added_to_a_list_begins_right() {
    let registry = voltet_nodes::registry().unwrap();
    let annotation = "[nodes.words]\ntype = \"annotation\"\ninputs = { image = \"picture\" }\n\n[nodes.file]";
    let text = TEXT.replace("[nodes.file]", annotation);
    let mut hand = Hand::new(&text);
    let lists = [("look", "widgets", 1), ("picture", "clip", 0), ("words", "texts", 0)];
    for (node, list, place, kind) in lists
        .into_iter()
        .flat_map(|(node, list, place)| {
            let rows = hand.editor.document().rows(&registry, node);
            let row = rows.into_iter().find(|row| row.parameter.name == list).unwrap();
            let voltet_document::panel::Control::Entries(kinds) = row.control else { panic!("a list") };
            kinds.iter().map(move |kind| (node, row.path.clone(), place, kind)).collect::<Vec<_>>()
        })
        .collect::<Vec<_>>()
    {
        let entry = voltet_document::panel::default_value(kind, &hand.editor.scene().data_extent());
        let edit = Edit::Insert { node: node.into(), list, place, entry };
        hand.editor.edit(edit.label(), &[edit]);
        let faults = hand.editor.document().faults(&registry);
        let is_name = |fault: &voltet_document::Diagnostic| {
            ["'fields' is missing", "'image' is missing"].iter().any(|what| fault.error.what.contains(what))
        };
        assert!(faults.iter().all(is_name), "{}: {faults:?}", kind.name);
        hand.frames(2);
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(hand.text(), text);
}

#[test]
fn a_clip_that_is_added_takes_the_half_before_the_eye_away() {
    let mut hand = Hand::new(TEXT);
    select(&mut hand, "picture");
    hand.click_on("add");
    hand.click_on("plane");
    hand.settle();
    // The eye is at (-28, -38, 24), the middle of the data at the origin.
    let text = hand.text();
    assert!(
        text.contains("kind = \"plane\"\nnormal = [0.0, 1.0, 0.0]\n") && !text.contains("origin"),
        "{text}"
    );
    assert!(hand.editor.scene().failure.is_none() && hand.sees("plane of clip: position"), "{text}");
}

#[test]
fn arrays_of_the_data_are_chosen_one_or_several() {
    let text = TEXT
        .replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", "type = \"reader\"\npath = \"data.vtk\"")
        .replace("[nodes.view]", "[nodes.fields]\ntype = \"multi-gradient\"\nfields = [\"heat\"]\ninputs = { grid = \"grid\" }\n\n[nodes.view]");
    let heat = "SCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4\n";
    let data = one_cell(&(heat.to_string() + "SCALARS speed float 1\nLOOKUP_TABLE default\n5 6 7 8\n"));
    // The file is there before the window is: one that comes later is read anew some time after.
    let mut hand = Hand::with_file(&text, "data.vtk", &data);
    for (node, list, wanted) in [
        ("fields", "speed  (points, 5 to 8)", "fields = [\"heat\", \"speed\"]"),
        ("grid", "heat  (points, 1 to 4)", "scalar = \"heat\""),
    ] {
        select(&mut hand, node);
        until(&mut hand, "the arrays are found", |hand| !hand.texts("data").is_empty());
        hand.click(hand.texts("data")[0]);
        // Their ranges are found on a thread of its own.
        until(&mut hand, "the ranges are found", |hand| !hand.texts(list).is_empty());
        hand.click_on(list);
        hand.key(Key::Escape, Modifiers::NONE);
        assert!(hand.text().contains(wanted), "{node}: {}", hand.text());
    }
}

/// A legacy file of one tetrahedron with these arrays at its points.
fn one_cell(arrays: &str) -> String {
    format!(
        "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n\
         CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n{arrays}"
    )
}

/// A grid of four points with an array of one value, and one that varies.
fn of_two_arrays() -> String {
    one_cell("FIELD all 2\nsame 1 4 float\n1 1 1 1\nheat 1 4 float\n1 2 3 4\n")
}

/// Before a window with a reader of such a file, which is there as `other.vtk`, too.
fn before_reader() -> (Hand, String) {
    let reader = "type = \"reader\"\npath = \"data.vtk\"";
    let text = TEXT.replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", reader);
    let hand = Hand::in_folder(&text, &|folder| {
        for name in ["data.vtk", "other.vtk"] {
            std::fs::write(folder.join(name), of_two_arrays()).unwrap();
        }
    });
    (hand, text)
}

fn read_other(hand: &mut Hand) {
    hand.editor.edit("read".into(), &[Edit::set("grid", ["path"], "other.vtk".into())]);
}

/// Frames until the arrays of a file are known, or that they cannot be; and some more.
fn until_read(hand: &mut Hand, path: &str) {
    until(hand, "the file is not read", |hand| {
        let editor = &hand.editor;
        let mut reader =
            editor.document.pipeline().nodes.iter().find(|node| node.name == "grid").unwrap().clone();
        reader.settings.retain(|field| field.name != "path");
        reader.settings.push(voltet_graph::Field::new("path", path));
        let extent = crate::jobs::Extent::Whole;
        editor.arrays.of_reader(&hand.ctx, &editor.document, &editor.registry, &reader, extent).is_whole
    });
    hand.frames(3);
}

#[test]
fn a_reader_that_is_given_a_file_takes_the_first_array_that_varies() {
    let (mut hand, text) = before_reader();
    let fault = "the file holds several arrays";
    until(&mut hand, "no fault", |hand| !hand.shown_beginning(fault).is_empty());
    let of_node = hand.rect("node grid");
    assert!(hand.shown_beginning(fault).iter().any(|at| of_node.contains(*at)), "the reader says it");
    assert_eq!(hand.text(), text, "a file that is opened stays as it is");
    hand.editor.gesture = Some(Gesture(77));
    read_other(&mut hand);
    until(&mut hand, "no array", |hand| hand.text().contains("scalar = \"heat\""));
    assert!(hand.said().starts_with("grid: draws 'heat'"), "{}", hand.said());
    hand.settle();
    assert!(hand.shown_beginning(fault).is_empty());
    assert_eq!(hand.steps(), 2, "a step of its own");
    hand.key(Key::Z, Modifiers::COMMAND);
    until_read(&mut hand, "other.vtk");
    assert!(
        hand.text().contains("other.vtk") && !hand.text().contains("scalar = \"heat\""),
        "{}",
        hand.text()
    );
    assert!(hand.editor.document.history().redo_label().is_some());
}

#[test]
fn what_a_hand_undid_before_the_arrays_are_known_stays_undone() {
    let (mut hand, text) = before_reader();
    let ctx = hand.ctx.clone();
    read_other(&mut hand);
    hand.editor.command(&ctx, Command::Undo);
    hand.frames(1);
    until_read(&mut hand, "other.vtk");
    assert_eq!(hand.text(), text);
    assert_eq!(hand.editor.document.history().redo_label(), Some("read"));
    hand.editor.command(&ctx, Command::Redo);
    hand.frames(3);
    assert_eq!(hand.text(), text.replace("data.vtk", "other.vtk"));
    // An earlier step that stands undone can be done again, too.
    hand.editor.edit("later".into(), &[Edit::set("grid", ["path"], "data.vtk".into())]);
    hand.editor.edit("last".into(), &[Edit::set("look", "widgets.0.extinction", 3.0.into())]);
    hand.editor.command(&ctx, Command::Undo);
    until_read(&mut hand, "data.vtk");
    assert_eq!(hand.editor.document.history().redo_label(), Some("last"));
}

#[test]
fn another_document_is_not_edited_by_what_the_former_one_waited_for() {
    let (mut hand, text) = before_reader();
    let other = text.replace("data.vtk", "other.vtk");
    let path = hand.folder.path().join("second.toml");
    std::fs::write(&path, &other).unwrap();
    read_other(&mut hand);
    hand.editor.take(Document::open(&path).unwrap());
    until_read(&mut hand, "other.vtk");
    assert_eq!(hand.text(), other);
    assert!(hand.editor.document.is_saved());
    // The document's own file, as another program left it.
    hand.editor.edit("read".into(), &[Edit::set("grid", ["path"], "data.vtk".into())]);
    std::fs::write(&path, &text).unwrap();
    hand.editor.settle_with_disk(true);
    until_read(&mut hand, "data.vtk");
    assert_eq!(hand.text(), text);
}

#[test]
fn a_file_that_cannot_be_read_is_not_waited_for() {
    let (mut hand, text) = before_reader();
    hand.editor.edit("read".into(), &[Edit::set("grid", ["path"], "gone.vtk".into())]);
    until(&mut hand, "the reader waits", |hand| hand.editor.new_readers.is_empty());
    assert_eq!(hand.text(), text.replace("data.vtk", "gone.vtk"));
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
    let start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Err(Error::usage("no data here")));
    let document = Document::new();
    let editor = Editor::new(document, &registry, start, Arc::new(|| {})).unwrap();
    for error in [editor.registry.find_filter("gone").map(drop), editor.registry.find("gone").map(drop)]
        .map(Result::unwrap_err)
    {
        assert!(error.to_string().contains("of the plug-ins: one with nothing"), "{error}");
    }
}

#[test]
fn a_number_field_says_why_it_holds_another_number_than_was_typed() {
    let mut hand = Hand::in_tall_window(TEXT);
    select(&mut hand, "look");
    let field = |hand: &Hand| row(hand, "look.widgets.0.extinction").left_top() + vec2(14.0, 8.0);
    let at = field(&hand);
    type_at(&mut hand, at, "much");
    assert_eq!(hand.texts("'much' is not a number; 4.0 stays").len(), 1);
    assert_eq!(hand.text(), TEXT);
    let at = field(&hand);
    type_at(&mut hand, at, "-3");
    assert_eq!(hand.texts("0.0 is the least: -3 is below it").len(), 1);
    assert!(hand.text().contains("extinction = 0.0\n"), "{}", hand.text());
    let at = field(&hand);
    type_at(&mut hand, at, "12345678");
    assert!(hand.text().contains("extinction = 12345678"), "{}", hand.text());
    assert!(!hand.texts("1.2345678e7").is_empty(), "a long number has an exponent");
    assert!(hand.texts("0.0 is the least: -3 is below it").is_empty());
    let at = field(&hand);
    type_at(&mut hand, at, "-4");
    assert_eq!(hand.texts("0.0 is the least: -4 is below it").len(), 1);
    let ctx = hand.ctx.clone();
    hand.editor.command(&ctx, Command::Undo);
    hand.frames(2);
    assert!(hand.texts("0.0 is the least: -4 is below it").is_empty(), "what was undone is not explained");
}

#[test]
fn a_colour_is_typed_as_its_code() {
    let mut hand = Hand::in_tall_window(TEXT);
    let button = hand.named("colour");
    hand.click(button);
    hand.frames(2);
    assert!(hand.texts("Blending").is_empty() && hand.sees("code of the colour"));
    hand.click_on("code of the colour");
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("#ff0080");
    hand.frames(2);
    let nodes = &hand.editor.document().pipeline().nodes;
    let look = nodes.iter().find(|node| node.name == "look").unwrap();
    let widget = look.setting("widgets").unwrap().list().unwrap()[0].table().unwrap();
    let color = voltet_graph::find_setting(widget, "color").unwrap().color().unwrap();
    // sRGB 128 of 255 is 0.2159 of a linear channel (IEC 61966-2-1).
    assert!(color[0] == 1.0 && color[1] == 0.0 && (color[2] - 0.2159).abs() < 1e-4, "{color:?}");
    assert_eq!(hand.steps(), 1);
}

/// Texts of the parameters that their pane cuts at its sides.
fn cut_texts(hand: &Hand) -> Vec<String> {
    fn of(shape: &Shape, clip: Rect, found: &mut Vec<String>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, clip, found)),
            Shape::Text(text) => {
                let rect = text.visual_bounding_rect();
                if rect.intersects(clip)
                    && (rect.right() > clip.right() + 1.0 || rect.left() < clip.left() - 1.0)
                {
                    found.push(text.galley.text().to_string());
                }
            }
            _ => {}
        }
    }
    let pane = hand.rect("name of look");
    let mut found = Vec::new();
    for clipped in hand.shapes() {
        let clip = clipped.clip_rect;
        if clip.left() <= pane.left()
            && clip.right() < 0.8 * hand.ctx.content_rect().right()
            && clip.bottom() > pane.bottom()
        {
            of(&clipped.shape, clip, &mut found);
        }
    }
    found
}

#[test]
fn no_text_of_a_transfer_function_is_cut_in_a_small_window() {
    for size in [[700.0, 500.0], [900.0, 600.0], [1280.0, 720.0]] {
        let mut hand = Hand::before_window(TEXT, size, &|_| {});
        hand.frames(3);
        let mut seen = 0;
        for _ in 0..12 {
            assert_eq!(cut_texts(&hand), Vec::<String>::new(), "{size:?}");
            seen += usize::from(hand.sees("look.widgets.0.extinction"));
            hand.move_to(hand.rect("name of look").left_bottom() + vec2(40.0, 60.0), Modifiers::NONE);
            let delta = vec2(0.0, -2.0);
            let unit = eframe::egui::MouseWheelUnit::Line;
            let wheel =
                Event::MouseWheel { unit, delta, phase: TouchPhase::Move, modifiers: Modifiers::NONE };
            hand.frame(vec![wheel], Modifiers::NONE);
            hand.frames(10);
        }
        assert!(seen > 0, "{size:?}");
    }
}

#[test]
fn colour_maps_are_chosen_by_their_colours() {
    let gaussian = TEXT.split("kind = ").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
    let text = TEXT.replace(gaussian, "\"colormap\"\ncolormap = \"viridis\"");
    let mut hand = Hand::in_tall_window(&text);
    hand.frames(3);
    hand.click(hand.texts("viridis")[0]);
    hand.frames(2);
    assert!(hand.sees("colours of viridis") && hand.sees("colours of inferno"));
    hand.click_on("inferno");
    assert_eq!(hand.text(), text.replace("viridis", "inferno"));
}

/// Before the kinds of clips that are added to the renderer; and where a cylinder is.
fn before_clips() -> (Hand, Pos2) {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(3);
    hand.click(hand.texts("add")[0]);
    hand.frames(2);
    let at = hand.texts("cylinder")[0];
    (hand, at)
}

#[test]
fn an_entry_that_is_added_is_in_view() {
    let (mut hand, at) = before_clips();
    hand.click(at);
    let bottom = hand.texts("F1: keys and mouse")[0].y;
    until(&mut hand, "its last row is out of view", |hand| {
        hand.all_named("picture.clip.0.invert").first().is_some_and(|row| row.max.y < bottom)
    });
}

#[test]
fn an_entry_that_is_not_there_in_the_next_frame_is_not_brought_into_view_later() {
    let (mut hand, at) = before_clips();
    hand.move_to(at, Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    hand.button(false, PointerButton::Primary, Modifiers::NONE);
    assert!(hand.text().contains("cylinder"), "{}", hand.text());
    for node in ["look", "picture"] {
        hand.editor.selection = [node.to_string()].into();
        hand.frames(10);
    }
    let bottom = hand.texts("F1: keys and mouse")[0].y;
    assert!(hand.all_named("picture.clip.0.invert").first().is_none_or(|row| row.max.y > bottom));
}
