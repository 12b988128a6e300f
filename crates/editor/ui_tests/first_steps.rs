//! What a person meets who has never seen the window.

use super::*;
use crate::scene::Command;
use voltet_graph::{DefaultValue, Node, NodeEntry, Parameter, ParameterType, Port, PortType};

pub(super) fn node<'a>(hand: &'a Hand, name: &str) -> &'a NodeEntry {
    let nodes = &hand.editor.document().pipeline().nodes;
    nodes.iter().find(|node| node.name == name).unwrap_or_else(|| panic!("no {name}: {}", hand.text()))
}

/// Adds a node by the menu at the pointer.
pub(super) fn add(hand: &mut Hand, name: &str) {
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed(name);
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(4);
}

/// Clicks with the right button at what has a name.
fn right_click(hand: &mut Hand, name: &str) {
    let at = hand.named(name);
    right_click_at(hand, at);
}

fn right_click_at(hand: &mut Hand, at: Pos2) {
    hand.move_to(at, Modifiers::NONE);
    hand.button(true, PointerButton::Secondary, Modifiers::NONE);
    hand.button(false, PointerButton::Secondary, Modifiers::NONE);
    hand.frames(3);
}

#[test]
fn a_new_camera_shows_all_of_the_data_and_a_new_writer_has_a_file_of_its_own() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection.clear();
    hand.frames(2);
    add(&mut hand, "camera");
    assert_eq!(node(&hand, "camera").setting("view").and_then(|view| view.text()), Some("isometric"));
    assert_eq!(node(&hand, "camera").inputs.len(), 1, "{}", hand.text());
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(2);
    add(&mut hand, "image-writer");
    let path =
        |name: &str| node(&hand, name).setting("path").and_then(|path| path.text()).map(str::to_string);
    assert_eq!(path("file").as_deref(), Some("picture.png"));
    assert_eq!(path("image_writer").as_deref(), Some("picture_2.png"));
    assert_eq!(node(&hand, "image_writer").inputs[0].source.text(), Some("picture"));
    assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    assert_eq!(hand.steps(), 2, "a node with its wires and numbers is one step");
}

#[test]
fn new_nodes_lie_beside_the_others() {
    let mut hand = Hand::new(TEXT);
    let ground = hand.rect("node view").max + vec2(20.0, 20.0);
    hand.move_to(ground, Modifiers::NONE);
    for _ in 0..3 {
        add(&mut hand, "wavelet");
    }
    hand.command(Command::FitGraph);
    hand.frames(5);
    let names = ["grid", "gradient", "look", "view", "picture", "file", "wavelet", "wavelet_2", "wavelet_3"];
    let frames = names.map(|name| (name, hand.rect(&format!("node {name}"))));
    for (i, (name, frame)) in frames.iter().enumerate() {
        for (other, beside) in &frames[i + 1..] {
            assert!(!frame.intersects(*beside), "{name} {frame:?} and {other} {beside:?}");
        }
    }
}

#[test]
fn a_new_node_is_in_view_wherever_there_is_room_for_it() {
    let mut hand = Hand::new(TEXT);
    for number in 0..6 {
        hand.move_to(pos2(5.0, 400.0), Modifiers::NONE);
        add(&mut hand, "wavelet");
        let name = if number == 0 { "wavelet".into() } else { format!("wavelet_{}", number + 1) };
        let (node, pane) = (hand.rect(&format!("node {name}")), hand.editor.panels.graph.pane());
        assert!(pane.contains_rect(node), "{name}: {node} in {pane}");
    }
    // Copies, too.
    hand.key(Key::A, Modifiers::COMMAND);
    hand.command(Command::Duplicate);
    hand.frames(3);
    let copied = hand.editor.selection.first().unwrap().clone();
    let (node, pane) = (hand.rect(&format!("node {copied}")), hand.editor.panels.graph.pane());
    assert!(pane.contains_rect(node), "{copied}: {node} in {pane}");
}

#[test]
fn a_node_is_found_by_what_it_can_do() {
    let mut hand = Hand::new(TEXT);
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed("clip");
    hand.frames(2);
    assert!(!hand.texts("  renderer").is_empty(), "it has the parameter");
}

#[test]
fn an_input_of_a_transfer_function_offers_transfer_functions_first() {
    let mut hand = Hand::new(&TEXT.replace("transfer_function = \"look\", ", ""));
    let empty = hand.rect("node view").max + vec2(40.0, 40.0);
    let from = hand.named("input picture.transfer_function");
    hand.drag(from, empty);
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(3);
    let sources: Vec<_> =
        node(&hand, "picture").inputs.iter().filter_map(|link| link.source.text()).collect();
    assert!(sources.contains(&"transfer_function"), "{sources:?}");
    assert_eq!(node(&hand, "transfer_function").node_type.text(), Some("transfer-function"));
}

#[test]
fn without_widgets_the_plane_offers_one() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    hand.click(at);
    hand.key(Key::Delete, Modifiers::NONE);
    hand.frames(3);
    assert!(!hand.sees("centre of widget 1"));
    transfer::with_distribution(&mut hand);
    hand.click_on("Add a widget at the peak");
    hand.frames(2);
    assert!(hand.sees("centre of widget 1"), "{}", hand.text());
    // Through the densest place of the data light is left.
    assert!(hand.text().contains("extinction = 0.1"), "{}", hand.text());
}

#[test]
fn a_transfer_function_without_a_volume_says_why_it_has_no_histogram() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection.clear();
    hand.frames(1);
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed("transfer");
    hand.frames(2);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(4);
    let why = hand.shown_beginning("no histogram: no picture is drawn with this transfer function");
    let offer = hand.rect("Add a widget at the peak");
    assert!(why.len() == 1 && !offer.y_range().contains(why[0].y), "{why:?} {offer}");
}

#[test]
fn the_plane_stays_while_the_next_histogram_is_computed() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let before = hand.named("centre of widget 1");
    hand.editor.worker.forget_query(|output| &mut output.distribution);
    hand.frame(Vec::new(), Modifiers::NONE);
    assert!(!hand.texts("computing the histogram …").is_empty());
    assert_eq!(hand.named("centre of widget 1"), before);
}

#[test]
fn what_was_selected_last_is_deleted_wherever_the_pointer_is() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let widget = hand.named("centre of widget 1");
    hand.click(widget);
    // Over the parameters, the graph, the picture: it is still the widget.
    let other = hand.named("node view");
    hand.move_to(other, Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::Delete, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("[nodes.look]") && !hand.text().contains("kind = \"gaussian\""));
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
    // A node, with the pointer over the plane.
    hand.click_on("node view");
    let plane = hand.named("plane of s and g");
    hand.move_to(plane, Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::Delete, Modifiers::NONE);
    assert!(!hand.text().contains("[nodes.view]") && hand.text().contains("kind = \"gaussian\""));
}

#[test]
fn the_right_button_has_a_menu_everywhere() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    for (what, entry) in [
        ("node view", "Duplicate"),
        ("output gradient.volume", "Add a node that fits …"),
        ("picture picture", "Isometric"),
        ("centre of widget 1", "Take away"),
    ] {
        right_click(&mut hand, what);
        assert!(hand.sees(entry), "{what}");
        hand.key(Key::Escape, Modifiers::NONE);
        hand.frames(2);
        assert!(!hand.sees(entry), "{what}: Escape closes it");
    }
    assert_eq!(hand.text(), TEXT);
    right_click(&mut hand, "node view");
    hand.click_on("Delete");
    assert!(!hand.text().contains("[nodes.view]"), "{}", hand.text());
    hand.key(Key::Z, Modifiers::COMMAND);
    // A wire, in its middle.
    let (from, to) = (hand.named("output grid.grid"), hand.named("input gradient.grid"));
    right_click_at(&mut hand, from + 0.5 * (to - from));
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(!hand.text().contains("inputs = { grid = \"grid\" }"), "{}", hand.text());
}

#[test]
fn escape_closes_sheets_one_after_the_other() {
    let mut hand = Hand::new(TEXT);
    for command in [Command::Costs, Command::Section, Command::Study, Command::Help] {
        hand.command(command);
    }
    hand.frames(3);
    let open = |hand: &Hand| {
        let panels = &hand.editor.panels;
        [panels.help, panels.study.open, panels.costs, panels.section.open]
            .iter()
            .filter(|open| **open)
            .count()
    };
    for count in (0..4).rev() {
        hand.key(Key::Escape, Modifiers::NONE);
        assert_eq!(open(&hand), count);
    }
    // A menu is above a sheet.
    right_click(&mut hand, "node view");
    hand.command(Command::Costs);
    hand.frames(2);
    assert!(hand.sees("Duplicate") && open(&hand) == 1);
    hand.key(Key::Escape, Modifiers::NONE);
    hand.frames(2);
    assert!(!hand.sees("Duplicate") && open(&hand) == 1);
    hand.key(Key::Escape, Modifiers::NONE);
    assert_eq!(open(&hand), 0);
    hand.key(Key::X, Modifiers::NONE);
    let changed = hand.text();
    hand.command(Command::Quit);
    hand.frames(2);
    // The question has the keys: none of the window's is read, and Enter changes nothing.
    for key in [Key::Delete, Key::Y, Key::L] {
        hand.key(key, Modifiers::NONE);
    }
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), changed);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.editor.unsaved.is_none() && !hand.editor.ends() && !hand.editor.document().is_saved());
    hand.command(Command::Quit);
    hand.frames(2);
    hand.key(Key::Escape, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.editor.unsaved.is_none() && !hand.editor.ends());
}

#[test]
fn panes_keep_their_shares_of_a_window_that_shrinks_and_grows() {
    let mut hand = Hand::before_window(TEXT, [1600.0, 1000.0], &|_| {});
    let sizes = |hand: &Hand| (hand.rect("picture picture").size(), hand.rect("plane of s and g").size());
    let before = sizes(&hand);
    hand.resize([700.0, 500.0], 1.0);
    hand.frames(4);
    let small = sizes(&hand);
    assert!(small.0.x < 0.5 * before.0.x && small.1.y < 0.75 * before.1.y, "{before:?} {small:?}");
    // What stands above the plane leaves it room.
    assert!(small.1.y > 105.0, "{small:?}");
    hand.resize([1600.0, 1000.0], 1.0);
    hand.frames(4);
    let after = sizes(&hand);
    let near = |a: f32, b: f32| (a - b).abs() < 3.0;
    assert!(near(before.0.x, after.0.x) && near(before.0.y, after.0.y), "{before:?} {after:?}");
    // A click where panes are as small as they may be takes no share away.
    hand.resize([480.0, 320.0], 1.0);
    hand.frames(4);
    let picture = hand.named("picture picture");
    hand.click(picture);
    hand.resize([1600.0, 1000.0], 1.0);
    hand.frames(4);
    let after = sizes(&hand);
    assert!(near(before.0.x, after.0.x) && near(before.1.y, after.1.y), "{before:?} {after:?}");
}

#[test]
fn each_size_of_the_window_has_panes_of_its_own() {
    let [wide, narrow] = [[1600.0, 1000.0], [900.0, 600.0]];
    let mut hand = Hand::before_window(TEXT, wide, &|_| {});
    let width = |hand: &Hand| hand.rect("picture picture").width();
    let pull = |hand: &mut Hand, by: f32| {
        let border = hand.rect("picture picture").left_center() - vec2(8.0, 0.0);
        hand.drag(border, border + vec2(by, 0.0));
    };
    pull(&mut hand, -200.0);
    let of_wide = width(&hand);
    hand.resize(narrow, 1.0);
    hand.frames(4);
    pull(&mut hand, 100.0);
    let of_narrow = width(&hand);
    assert!(of_narrow / 900.0 < of_wide / 1600.0 - 0.05, "{of_narrow} {of_wide}");
    for (size, before) in [(wide, of_wide), (narrow, of_narrow)] {
        hand.resize(size, 1.0);
        hand.frames(8);
        assert!((width(&hand) - before).abs() < 3.0, "{size:?}: {before} {}", width(&hand));
    }
    // A size that is passed while the window's border is pulled changes no shares.
    hand.resize(wide, 1.0);
    hand.frames(2);
    hand.resize([1500.0, 1000.0], 1.0);
    hand.frames(8);
    let share = width(&hand) / 1500.0;
    assert!((share - of_narrow / 900.0).abs() < 0.02, "{share} {}", of_narrow / 900.0);
}

#[test]
fn the_files_to_open_are_those_that_are_read() {
    let refusal = |folder: &Path| {
        let none = folder.join("none");
        std::fs::write(&none, "of no format").unwrap();
        let request = voltet_io::formats::Request::default();
        voltet_io::formats::read(&none, &request, &voltet_core::progress::NoProgress)
            .err()
            .unwrap()
            .expected
            .unwrap()
    };
    // The formats that a refusal lists, and what is known by its name alone.
    let listed = refusal(tempfile::tempdir().unwrap().path());
    let is_end = |word: &&str| word.starts_with('.') && word.len() > 1;
    let ends = listed.split([' ', ',', '(', ')', ';']).filter(is_end);
    let ends =
        ends.chain([".nas", ".fem", ".xyz", ".grd", ".grid", ".foam", ".cgns", ".pvtu", ".toml", ".PNG"]);
    let read: Vec<String> = ends.map(|end| format!("a{end}")).collect();
    assert!(read.len() > 30, "{listed}");
    let mut hand = Hand::in_folder(TEXT, &|folder| {
        read.iter().for_each(|name| std::fs::write(folder.join(name), "x").unwrap());
        std::fs::write(folder.join("j.txt"), "x").unwrap();
    });
    hand.command(Command::Open);
    hand.frames(2);
    let unseen: Vec<_> = read.iter().filter(|name| !hand.sees(&format!("      {name}"))).collect();
    assert!(unseen.is_empty() && !hand.sees("      j.txt"), "{unseen:?}");
    // The name is typed in all of the room beside the button.
    let (field, button) = (hand.rect("name of the file"), hand.rect("Open"));
    assert!((button.left() - field.right()).abs() < 20.0, "{field} {button}");
}

#[test]
fn an_error_about_another_file_names_it() {
    let hand = Hand::new(&TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"data.vtk\"",
    ));
    let said = |text: &str| text.starts_with("grid: ") && text.contains("data.vtk");
    assert!(!hand.shown(&said).is_empty(), "{:?}", hand.shown_beginning("grid: "));
    let own = hand.path().display().to_string();
    assert!(hand.shown(&|text| text.starts_with("grid: ") && text.contains(&own)).is_empty());
}

#[test]
fn what_is_wrong_has_a_way_out() {
    let mut hand = Hand::new(&TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"gone.vtk\"",
    ));
    // One below the other where they have no room side by side.
    let wide = ["Show 'grid'", "Choose a file …"].map(|text| hand.rect(text));
    assert!(wide[0].top() == wide[1].top() && wide[0].right() < wide[1].left(), "{wide:?}");
    hand.resize([560.0, 720.0], 1.0);
    hand.frames(4);
    let narrow = ["Show 'grid'", "Choose a file …"].map(|text| hand.rect(text));
    let pane = hand.editor.panels.picture.rect.unwrap();
    assert!(pane.width() < 340.0 && narrow[0].bottom() < narrow[1].top(), "{pane} {narrow:?}");
    assert!(
        narrow.iter().all(|at| pane.x_range().contains(at.left()) && pane.x_range().contains(at.right()))
    );
    hand.resize([1280.0, 720.0], 1.0);
    hand.frames(4);
    // The histogram says nothing of its own of the same node.
    assert_eq!(hand.texts("no histogram: 'grid' has a fault").len(), 1);
    hand.click_on("Show 'grid'");
    assert!(hand.editor.selection.iter().eq(["grid"]) && !hand.sees("Show 'grid'"));
    hand.click_on("Choose a file …");
    let asks = hand.editor.file_dialog.as_ref().map(|dialog| dialog.purpose.clone());
    let of_reader =
        crate::scene::FilePurpose::Parameter { node: "grid".into(), path: "path".into(), writes: false };
    assert_eq!(asks, Some(of_reader));
    // What reads no file has its parameters alone.
    let hand = Hand::new(&TEXT.replace("eye = [-28.0, -38.0, 24.0]\n", ""));
    assert!(hand.sees("Show 'view'") && !hand.sees("Choose a file …"));
}

#[test]
fn a_file_that_cannot_be_opened_leaves_its_dialog_with_the_reason() {
    let mut hand = Hand::with_file(TEXT, "wrong.vtu", "no data");
    hand.command(Command::Open);
    hand.frames(2);
    hand.click_on("      wrong.vtu");
    assert!(hand.sees("7 bytes · just now"));
    hand.click_on("Open");
    until(&mut hand, "the dialog is gone", |hand| hand.editor.file_dialog.is_some());
    hand.frames(2);
    let dialog = hand.editor.file_dialog.as_ref().unwrap();
    assert!(dialog.fault.as_ref().is_some_and(|fault| fault.contains("no data here")), "{dialog:?}");
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn a_fault_is_said_in_words_of_the_window() {
    let mut hand = Hand::new(&TEXT.replace("eye = [-28.0, -38.0, 24.0]\n", ""));
    hand.editor.selection = ["view".to_string()].into();
    hand.frames(3);
    let fault = "view: the camera has no 'eye'";
    assert_eq!(hand.shown_beginning(fault).len(), 1, "at the parameters");
    assert!(!hand.texts("no picture: 'view' has a fault").is_empty());
    assert!(hand.shown_beginning("view: ").iter().all(|at| hand.texts(fault).contains(at)));
    hand.editor.selection.clear();
    hand.frames(3);
    assert_eq!(hand.shown_beginning(fault).len(), 1, "in the last line");
}

#[test]
fn a_picture_that_is_made_of_the_shown_one_is_shown_at_once() {
    let mut hand = Hand::new(TEXT);
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(2);
    add(&mut hand, "annotation");
    assert_eq!(hand.editor.shown_node.as_deref(), Some("annotation"));
    hand.editor.selection.clear();
    hand.frames(2);
    add(&mut hand, "renderer");
    assert_eq!(hand.editor.shown_node.as_deref(), Some("annotation"), "another picture has nothing of it");
}

#[test]
fn a_new_node_feeds_the_only_one_that_lacks_it() {
    let mut hand = Hand::new(&TEXT.replace("transfer_function = \"look\", ", ""));
    hand.editor.selection = ["grid".to_string()].into();
    hand.frames(2);
    add(&mut hand, "transfer-function");
    let inputs = &node(&hand, "picture").inputs;
    let fed = inputs.iter().find(|link| link.port == "transfer_function").expect("it is fed");
    assert_eq!(fed.source.text(), Some("transfer_function"));
}

/// A parameter that a node from outside requires.
const fn required(name: &'static str, parameter_type: ParameterType) -> Parameter {
    Parameter { name, parameter_type, unit: "", default: DefaultValue::Required, help: "of the node" }
}

const ONE_GRID: &[Port] = &[Port { name: "grid", port_type: PortType::Grid, summary: "a grid" }];

static FROM_OUTSIDE: Node = Node {
    name: "from-outside",
    summary: "Makes an array of others.",
    inputs: ONE_GRID,
    outputs: ONE_GRID,
    parameters: &[
        required("of", ParameterType::ArrayName),
        required("those", ParameterType::ArrayNames),
        required("formula", ParameterType::Expression),
        // A name with another first value.
        required("text", ParameterType::ArrayName),
        Parameter { default: DefaultValue::Text("wavelet"), ..required("made", ParameterType::NewArrayName) },
    ],
    ..Node::BLANK
};

#[test]
fn the_menu_of_nodes_reads_files_for_a_node_that_begins_with_an_array_alone() {
    let text = "[pipeline]\nformat = 1\n\n[nodes.grid]\ntype = \"reader\"\npath = \"data.vtk\"\n";
    let mut hand = Hand::with_file(text, "data.vtk", "");
    hand.key(Key::Space, Modifiers::NONE);
    hand.typed("camera");
    hand.frames(3);
    assert_eq!(hand.editor.arrays.asked_count(), 0);
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("calculator");
    hand.frames(3);
    assert_eq!(hand.editor.arrays.asked_count(), 1);
}

#[test]
fn new_calculators_and_multi_gradients_begin_with_an_array_of_the_data() {
    let mut hand = Hand::new(TEXT);
    for (name, node_name, key) in
        [("calculator", "calculator", "expression"), ("multi-gradient", "multi_gradient", "fields")]
    {
        hand.editor.selection = ["grid".to_string()].into();
        hand.frames(2);
        add(&mut hand, name);
        let stated = node(&hand, node_name).setting(key).unwrap_or_else(|| panic!("{}", hand.text()));
        let stated = stated.list().map_or(stated, |list| &list[0]);
        assert_eq!(stated.text(), Some("wavelet"));
        assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    }
    // A node from outside, by the types of its parameters.
    let mut registry = voltet_nodes::registry().unwrap();
    registry.add(&FROM_OUTSIDE).unwrap();
    let mut hand = Hand::with_registry(TEXT, [1280.0, 720.0], &|_| {}, &registry);
    hand.settle();
    hand.editor.selection = ["grid".to_string()].into();
    hand.frames(2);
    add(&mut hand, "from-outside");
    let own = node(&hand, "from_outside");
    for key in ["of", "those", "formula", "text"] {
        let stated = own.setting(key).unwrap_or_else(|| panic!("{key}: {}", hand.text()));
        assert_eq!(stated.list().map_or(stated, |list| &list[0]).text(), Some("wavelet"), "{key}");
    }
    assert_eq!(own.setting("made").and_then(|made| made.text()), Some("wavelet_2"));
    assert_eq!(own.settings.iter().filter(|field| field.name == "text").count(), 1, "{}", hand.text());
    assert!(hand.editor.scene().faults.is_empty(), "{:?}", hand.editor.scene().faults);
    // Without data coordinates are there.
    let mut hand = Hand::new("[pipeline]\nformat = 1\n");
    add(&mut hand, "calculator");
    assert_eq!(node(&hand, "calculator").setting("expression").and_then(|stated| stated.text()), Some("x"));
}

#[test]
fn the_picture_that_was_shown_before_comes_back_where_the_shown_one_goes() {
    let other = "\n[nodes.other]\ntype = \"renderer\"\nengine = \"cpu\"\n\
                 inputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }\n";
    let mut hand = Hand::new(&[TEXT, other].concat());
    let shown = |hand: &Hand| hand.editor.shown_node.clone().unwrap();
    assert_eq!(shown(&hand), "other");
    hand.editor.show_picture("picture");
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(2);
    add(&mut hand, "annotation");
    assert_eq!(shown(&hand), "annotation");
    for (command, picture) in
        [(Command::Undo, "picture"), (Command::Redo, "annotation"), (Command::Undo, "picture")]
    {
        hand.command(command);
        hand.frames(2);
        assert_eq!(shown(&hand), picture, "{command:?}");
    }
    // A renamed node stays the shown one.
    let rename = voltet_document::Edit::Rename { node: "picture".into(), to: "front".into() };
    hand.editor.edit("rename".into(), &[rename]);
    hand.frames(2);
    assert_eq!(shown(&hand), "front");
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.frames(2);
    assert_eq!(shown(&hand), "picture");
    // Another node of the name is none that was shown.
    hand.editor.show_picture("other");
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(2);
    add(&mut hand, "annotation");
    assert!(hand.text().contains("[nodes.annotation]"), "{}", hand.text());
    assert_eq!(shown(&hand), "other");
}

#[test]
fn a_calculator_behind_another_of_the_usual_name_has_a_name_of_its_own() {
    let behind = "[pipeline]\nformat = 1\n\n[nodes.grid]\ntype = \"reader\"\npath = \"data.vtk\"\n\n[nodes.calculator]\n\
                  type = \"calculator\"\nexpression = \"x\"\ninputs = { grid = \"grid\" }\n";
    let data = "# vtk DataFile Version 3.0\ntest\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n0 0 0 1 0 0 0 1 0 0 0 1\n\
                CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS result double 1\nLOOKUP_TABLE default\n1 2 3 4\n";
    for reader_alone in [false, true] {
        let mut hand = Hand::with_file(behind, "data.vtk", data);
        let from = if reader_alone { "grid" } else { "calculator" };
        hand.editor.selection = [from.to_string()].into();
        hand.key(Key::Space, Modifiers::NONE);
        until(&mut hand, "the names of the arrays are read", |hand| {
            let scene = hand.editor.scene();
            let (extent, reader) = (crate::jobs::Extent::Heads, scene.entry("grid").unwrap());
            let found = scene.arrays.of_reader(&hand.ctx, scene.document, scene.registry, reader, extent);
            !found.choices.is_empty()
        });
        hand.typed("calculator");
        hand.frames(2);
        hand.key(Key::Enter, Modifiers::NONE);
        hand.frames(4);
        let stated = |key: &str| node(&hand, "calculator_2").setting(key).and_then(|stated| stated.text());
        assert_eq!((stated("expression"), stated("name")), (Some("result"), Some("result_2")));
        let scene = hand.editor.scene();
        let is_of_it = |fault: &&Error| fault.to_string().contains("calculator_2");
        assert_eq!(scene.faults.iter().find(is_of_it).map(ToString::to_string), None);
    }
}
