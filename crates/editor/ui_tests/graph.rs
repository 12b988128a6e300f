use super::*;
use voltet_graph::NodeEntry;

fn node<'a>(hand: &'a Hand, name: &str) -> Option<&'a NodeEntry> {
    hand.editor.document().pipeline().nodes.iter().find(|node| node.name == name)
}

fn port(hand: &Hand, node: &str, name: &str, is_input: bool) -> Pos2 {
    hand.named(&format!("{} {node}.{name}", if is_input { "input" } else { "output" }))
}

fn title(hand: &Hand, node: &str) -> Pos2 {
    hand.rect(&format!("node {node}")).min + vec2(30.0, 8.0)
}

#[test]
fn the_words_about_a_node_cover_neither_it_nor_others() {
    let mut hand = Hand::new(TEXT);
    const NAMES: [&str; 6] = ["grid", "gradient", "look", "view", "picture", "file"];
    for name in NAMES {
        let node = hand.rect(&format!("node {name}"));
        hand.move_to(node.center(), Modifiers::NONE);
        hand.pause = 1.0;
        hand.frames(4);
        let words = hand.shown_beginning(&format!("{name} ("));
        assert_eq!(words.len(), 1, "{name}");
        let covered = NAMES.iter().find(|other| hand.rect(&format!("node {other}")).contains(words[0]));
        assert_eq!(covered, None, "by the words about {name}");
    }
}

/// Among many nodes they would stand above or below all of them.
#[test]
fn the_words_about_a_node_are_near_the_pointer() {
    let more: String = (0..60).map(|i| format!("[nodes.more{i}]\ntype = \"wavelet\"\n\n")).collect();
    let mut hand = Hand::new(&TEXT.replace("[nodes.view]", &(more + "[nodes.view]")));
    hand.command(Command::FitGraph);
    hand.frames(8);
    for name in ["more7", "more30", "more52"] {
        let node = hand.rect(&format!("node {name}"));
        hand.move_to(node.center(), Modifiers::NONE);
        hand.pause = 1.0;
        hand.frames(4);
        let words = hand.shown_beginning(&format!("{name} ("))[0];
        let away = words.distance(node.center());
        assert!(away < 170.0, "the words about {name} are {away} points away");
    }
}

#[test]
fn a_dragged_node_has_its_place_in_the_file_and_undo_takes_it_back() {
    let mut hand = Hand::new(TEXT);
    let before = hand.editor.document().position("look");
    let from = title(&hand, "look");
    hand.drag(from, from + vec2(30.0, 90.0));
    let after = hand.editor.document().position("look");
    assert!(after[0] > before[0] + 20.0 && after[1] > before[1] + 60.0, "{before:?} {after:?}");
    assert_eq!(hand.steps(), 1);
    assert!(hand.text().contains("[editor"), "{}", hand.text());
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn ports_under_another_node_are_not_shown() {
    let mut hand = Hand::new(TEXT);
    let covered = port(&hand, "view", "camera", false);
    assert!(hand.sees("output view.camera"));
    let from = title(&hand, "picture");
    hand.drag(from, from + (covered - port(&hand, "picture", "camera", true)) + vec2(-40.0, 0.0));
    assert!(!hand.sees("output view.camera"));
}

#[test]
fn a_wire_is_drawn_from_port_to_port_and_taken_off_again() {
    let mut hand = Hand::new(TEXT);
    let (from, to) = (port(&hand, "gradient", "volume", false), port(&hand, "look", "volume", true));
    hand.drag(from, to);
    let feeds = |hand: &Hand| node(hand, "look").unwrap().inputs.iter().any(|link| link.port == "volume");
    assert!(feeds(&hand), "{}", hand.said());
    let empty = hand.rect("node view").max + vec2(60.0, 60.0);
    let to = port(&hand, "look", "volume", true);
    hand.drag(to, empty);
    assert!(!feeds(&hand), "{}", hand.text());
    assert_eq!(hand.steps(), 2);
}

#[test]
fn what_does_not_fit_is_not_joined_and_the_reason_is_said() {
    let mut hand = Hand::new(TEXT);
    let (from, to) = (port(&hand, "view", "camera", false), port(&hand, "picture", "volume", true));
    hand.drag(from, to);
    assert_eq!(hand.text(), TEXT);
    assert_eq!(hand.said(), "'volume' takes a volume: found a camera");
}

#[test]
fn a_wire_dropped_on_empty_space_offers_what_fits_and_joins_it() {
    let mut hand = Hand::new(TEXT);
    let empty = hand.rect("node view").max + vec2(40.0, 40.0);
    let from = port(&hand, "gradient", "volume", false);
    hand.drag(from, empty);
    hand.typed("histogram");
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    let added = node(&hand, "histogram").expect("the node is added");
    assert_eq!(added.inputs[0].source.text(), Some("gradient"));
    assert_eq!(hand.steps(), 1, "the node and its wire are one step");
}

#[test]
fn nodes_are_added_selected_copied_and_deleted_by_keys() {
    let mut hand = Hand::new(TEXT);
    let ground = hand.rect("node view").max + vec2(40.0, 60.0);
    hand.move_to(ground, Modifiers::NONE);
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed("wavelet");
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(node(&hand, "wavelet").is_some());
    assert_eq!(hand.editor.selection.iter().collect::<Vec<_>>(), ["wavelet"]);
    hand.pause = 2.0;
    hand.key(Key::D, Modifiers::COMMAND);
    assert!(node(&hand, "wavelet_2").is_some());
    hand.frames(2);
    hand.key(Key::Delete, Modifiers::NONE);
    assert!(node(&hand, "wavelet_2").is_none() && node(&hand, "wavelet").is_some());
    hand.key(Key::A, Modifiers::COMMAND);
    hand.key(Key::Delete, Modifiers::NONE);
    assert!(hand.editor.document().pipeline().nodes.is_empty());
    for _ in 0..4 {
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn deleted_nodes_leave_what_fed_them_to_what_they_fed() {
    let notes = "[nodes.note]\ntype = \"annotation\"\ninputs = { image = \"picture\" }\n\n\
        [nodes.notes]\ntype = \"annotation\"\ninputs = { image = \"note.image\" }\n\n[nodes.file]";
    let text =
        TEXT.replace("[nodes.file]", notes).replace("{ image = \"picture\" }", "{ image = \"notes\" }");
    let text = text.replacen("{ image = \"notes\" }", "{ image = \"picture\" }", 1);
    for gone in [&["note", "notes"][..], &["notes"], &["note"], &["gradient"]] {
        let mut hand = Hand::new(&text);
        hand.editor.select(gone.iter().map(|name| name.to_string()).collect());
        hand.frames(2);
        hand.key(Key::Delete, Modifiers::NONE);
        let fed = |name: &str| {
            node(&hand, name).and_then(|node| node.inputs.first()?.source.text()).map(str::to_string)
        };
        assert!(gone.iter().all(|name| node(&hand, name).is_none()));
        let (of_file, of_notes) = match gone {
            ["note", "notes"] => ("picture", None),
            ["notes"] => ("note.image", None),
            ["note"] => ("notes", Some("picture")),
            _ => ("notes", Some("note.image")),
        };
        assert_eq!((fed("file").as_deref(), fed("notes").as_deref()), (Some(of_file), of_notes), "{gone:?}");
        // A volume is not what a grid is.
        assert!(gone != ["gradient"] || fed("picture").as_deref() != Some("grid"));
        hand.key(Key::Z, Modifiers::COMMAND);
        assert_eq!(hand.text(), text);
    }
}

#[test]
fn a_box_selects_and_a_click_on_the_ground_takes_it_back() {
    let mut hand = Hand::new(TEXT);
    let (first, last) = (hand.rect("node look"), hand.rect("node view"));
    hand.drag(last.max + vec2(30.0, 40.0), first.min - vec2(6.0, 6.0));
    let selected = hand.editor.selection.clone();
    assert!(selected.contains("look") && selected.contains("view"), "{selected:?}");
    hand.click(last.max + vec2(40.0, 40.0));
    assert!(hand.editor.selection.is_empty(), "{:?}", hand.editor.selection);
    hand.click(title(&hand, "look"));
    assert_eq!(hand.editor.selection.iter().collect::<Vec<_>>(), ["look"]);
}

/// With their pictures and errors, nodes that the file gives no place have room.
#[test]
fn nodes_that_are_laid_out_do_not_cover_each_other() {
    let more = "[nodes.counts]\ntype = \"histogram\"\ninputs = { volume = \"gradient\" }\n\n\
        [nodes.other]\ntype = \"renderer\"\nintegrator = \"none\"\n\
        inputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }\n\n[nodes.view]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.view]", more));
    for _ in 0..4000 {
        hand.frames(1);
        if hand.editor.scene().previews.contains_key("counts") {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    hand.frames(4);
    let names = ["grid", "gradient", "look", "counts", "view", "other", "picture", "file"];
    let frames = names.map(|name| (name, hand.rect(&format!("node {name}"))));
    for (i, (name, frame)) in frames.iter().enumerate() {
        for (other, beside) in &frames[i + 1..] {
            assert!(!frame.intersects(*beside), "{name} {frame:?} and {other} {beside:?}");
        }
    }
}

#[test]
fn hundreds_of_nodes_are_all_brought_into_view() {
    let more: String = (0..300).map(|i| format!("[nodes.more{i}]\ntype = \"wavelet\"\n\n")).collect();
    let mut hand =
        Hand::before_window(&TEXT.replace("[nodes.view]", &(more + "[nodes.view]")), [700.0, 500.0], &|_| {});
    hand.editor.panels.graph.fit();
    hand.frames(8);
    let pane = hand.editor.panels.graph.pane();
    let names: Vec<String> =
        hand.editor.document().pipeline().nodes.iter().map(|node| node.name.clone()).collect();
    for name in names {
        let frame = hand.rect(&format!("node {name}"));
        assert!(pane.contains_rect(frame) && frame.width() < 0.2 * 150.0, "{name}: {frame:?} in {pane:?}");
    }
}

/// Where a hand put them, far below each other.
#[test]
fn a_column_of_hundreds_of_nodes_is_brought_into_view() {
    let names: Vec<String> = (0..400).map(|i| format!("more{i}")).collect();
    let nodes: String = names.iter().map(|name| format!("[nodes.{name}]\ntype = \"wavelet\"\n\n")).collect();
    let place = |(i, name): (usize, &String)| format!("{name} = [0, {}]\n", 240 * i);
    let places: String = names.iter().enumerate().map(place).collect();
    let text = format!("[pipeline]\nformat = 1\n\n{nodes}[editor.nodes]\n{places}");
    let mut hand = Hand::before_window(&text, [700.0, 500.0], &|_| {});
    hand.key(Key::F, Modifiers::NONE);
    hand.frames(8);
    let pane = hand.editor.panels.graph.pane();
    for name in names {
        let frame = hand.rect(&format!("node {name}"));
        assert!(pane.contains_rect(frame), "{name}: {frame:?} in {pane:?}");
    }
}

/// Points of the window a point at the usual scale.
fn zoom(hand: &Hand, node: &str) -> f32 {
    hand.rect(&format!("node {node}")).width() / hand.editor.panels.graph.size_of(node)[0] as f32
}

#[test]
fn the_lower_edge_of_a_node_is_the_node() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection.clear();
    hand.frames(2);
    let top = hand.rect("node look").center_top();
    let height = hand.editor.panels.graph.size_of("look")[1] as f32 * zoom(&hand, "look");
    let edge = top + vec2(0.0, height - 2.0);
    hand.click(edge);
    assert_eq!(hand.editor.selection.iter().collect::<Vec<_>>(), ["look"]);
    let before = hand.editor.document().position("look");
    hand.drag(edge, edge + vec2(0.0, 60.0));
    let after = hand.editor.document().position("look");
    assert!(after[1] > before[1] + 40.0 && hand.steps() == 1, "{before:?} {after:?}");
}

#[test]
fn a_wire_begins_a_little_beside_its_port() {
    let mut hand = Hand::new(TEXT);
    let beside = vec2(9.0 * zoom(&hand, "gradient"), 0.0);
    let (from, to) = (port(&hand, "gradient", "volume", false), port(&hand, "look", "volume", true));
    hand.drag(from + beside, to);
    assert!(node(&hand, "look").unwrap().inputs.iter().any(|link| link.port == "volume"), "{}", hand.said());
}

#[test]
fn the_lower_edge_of_a_node_has_the_menu_of_the_node() {
    let mut hand = Hand::new(TEXT);
    let top = hand.rect("node picture").center_top();
    let height = hand.editor.panels.graph.size_of("picture")[1] as f32 * zoom(&hand, "picture");
    hand.move_to(top + vec2(0.0, height - 2.0), Modifiers::NONE);
    hand.button(true, PointerButton::Secondary, Modifiers::NONE);
    hand.button(false, PointerButton::Secondary, Modifiers::NONE);
    hand.frames(3);
    assert_eq!(hand.editor.selection.iter().collect::<Vec<_>>(), ["picture"]);
    hand.click_on("Delete");
    assert!(!hand.text().contains("[nodes.picture]"), "{}", hand.text());
}
