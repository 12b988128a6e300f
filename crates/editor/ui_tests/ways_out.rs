//! Every error has a way out, offered as a button.

use super::*;
use crate::film::FilmRequest;
use voltet_core::error::Remedy;
use voltet_core::progress::{Progress, refuse_beyond_memory};
use voltet_document::Edit;
use voltet_graph::Observer;

/// Refuses all work that takes memory.
struct Nothing;

impl Progress for Nothing {
    fn report(&self, _: &str, _: f64) {}

    fn memory_left(&self) -> Option<u64> {
        Some(0)
    }
}

fn no_memory() -> Error {
    refuse_beyond_memory(&Nothing, || "the picture".into(), 1).unwrap_err().with_remedy(Remedy::FewerPixels)
}

#[test]
fn a_run_that_fails_leads_to_its_node_to_another_file_and_is_tried_again() {
    let mut hand = Hand::new(&TEXT.replace("picture.png", "missing/picture.png"));
    hand.key(Key::R, Modifiers::COMMAND);
    until(&mut hand, "the run does not fail", |hand| {
        hand.editor.message.as_ref().is_some_and(|said| said.error.is_some())
    });
    hand.frames(2);
    assert!(
        hand.sees("Show 'file'") && hand.sees("Save elsewhere …") && hand.sees("Try again"),
        "{}",
        hand.said()
    );
    hand.click_on("Show 'file'");
    assert!(hand.editor.selection.contains("file"));
    std::fs::create_dir(hand.folder.path().join("missing")).unwrap();
    hand.click_on("Try again");
    until(&mut hand, "it is not written", |hand| hand.said().starts_with("written in"));
    assert!(hand.folder.path().join("missing/picture.png").is_file() && !hand.sees("Try again"));
}

#[test]
fn the_file_of_a_writer_that_fails_is_chosen_anew() {
    let mut hand = Hand::new(&TEXT.replace("picture.png", "missing/picture.png"));
    hand.key(Key::R, Modifiers::COMMAND);
    until(&mut hand, "the run does not fail", |hand| hand.sees("Save elsewhere …"));
    hand.click_on("Save elsewhere …");
    hand.frames(2);
    assert!(hand.sees("A file to write: file.path"));
}

#[test]
fn what_cannot_be_saved_is_saved_elsewhere() {
    let mut hand = Hand::new(TEXT);
    hand.key(Key::X, Modifiers::NONE);
    let path = hand.folder.path().join("missing/other.toml");
    hand.editor.save_as(&path);
    hand.frames(2);
    assert!(!hand.sees("Try again"), "the file of the document is another");
    hand.click_on("Save elsewhere …");
    hand.frames(2);
    assert!(hand.sees("Save as"));
    let mut hand = Hand::new(TEXT);
    hand.key(Key::X, Modifiers::NONE);
    std::fs::remove_file(hand.path()).unwrap();
    std::fs::create_dir(hand.path()).unwrap();
    hand.editor.settle_with_disk(false);
    hand.frames(2);
    assert!(hand.sees("Save elsewhere …"), "{}", hand.said());
}

#[test]
fn a_fault_in_the_status_line_leads_to_its_node() {
    let mut hand = Hand::new(&TEXT.replace("extinction = 4.0", "extinction = -4.0"));
    hand.editor.selection = ["view".to_string()].into();
    hand.frames(3);
    hand.click_on("Show 'look'");
    assert!(hand.editor.selection.contains("look"));
}

#[test]
fn a_fault_beside_the_nodes_leads_to_its_line() {
    let text = TEXT.replace("format = 1", "format = 99");
    let mut hand = Hand::new(&text);
    let line = TEXT.lines().position(|line| line == "format = 1").unwrap() + 1;
    hand.click_on(&format!("Show the text at line {line}"));
    hand.frames(2);
    assert!(hand.sees("Take over"), "the sheet stays open");
    hand.editor.edit("mend".into(), &[Edit::Text(TEXT.into())]);
    hand.frames(3);
    assert!(!hand.sees("Take over"), "and closes once it is right");
}

#[test]
fn of_a_text_that_is_no_toml_the_first_fault_is_said_alone() {
    let hand =
        Hand::new(&TEXT.replace("type = \"camera\"", "type = camera\"").replace("path = \"", "path = "));
    assert_eq!(hand.editor.scene().faults.len(), 1);
    assert_eq!(hand.shown_beginning("Mend the text at line").len(), 1);
}

#[test]
fn a_picture_without_memory_is_drawn_with_fewer_pixels() {
    let mut hand = Hand::new(TEXT);
    let failed = no_memory().at_node("picture");
    let message =
        crate::ways_out::Message { text: failed.to_string(), error: Some(failed), again: Some(Command::Run) };
    hand.editor.message = Some(message);
    hand.frames(2);
    hand.click_on("Fewer pixels");
    assert_eq!(hand.numbers("view", "size"), [80.0, 60.0]);
    hand.settle();
    let drawn = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    assert_eq!(drawn.rgba.len(), 80 * 60);
    // A grid takes no less memory in a smaller picture.
    let failed = Error { remedy: None, ..no_memory() }.at_node("grid");
    hand.editor.message =
        Some(crate::ways_out::Message { text: failed.to_string(), error: Some(failed), again: None });
    hand.frames(2);
    assert!(hand.sees("Show 'grid'") && !hand.sees("Fewer pixels"));
}

/// Neither another file nor another try helps.
#[test]
fn a_parameter_that_is_wrong_leads_to_its_node_alone() {
    let text = TEXT.replace("path = \"picture.png\"", "path = \"picture.png\"\nbackground = \"nowhere\"");
    let mut hand = Hand::new(&text);
    hand.editor.selection = ["view".to_string()].into();
    hand.frames(3);
    assert!(hand.sees("Show 'file'") && !hand.sees("Save elsewhere …"), "{:?}", hand.editor.scene().faults);
    let mut hand = Hand::new(&TEXT.replace("extinction = 4.0", "extinction = -4.0"));
    hand.editor.selection = ["view".to_string()].into();
    hand.settle();
    assert!(hand.sees("Show 'look'") && !hand.sees("Try again"));
}

#[test]
fn an_input_that_is_wrong_or_not_wired_is_none_of_the_file_that_is_written() {
    let input = "inputs = { image = \"picture\" }";
    for wrong in
        ["inputs = { image = \"picture\", imgae = \"picture\" }", "inputs = { image = \"view\" }", ""]
    {
        let mut hand = Hand::new(&TEXT.replace(input, wrong));
        hand.editor.selection = ["view".to_string()].into();
        hand.settle();
        assert!(hand.sees("Show 'file'") && !hand.sees("Save elsewhere …"), "{wrong} {}", hand.said());
        hand.editor.selection = ["file".to_string()].into();
        hand.frames(2);
        assert!(!hand.sees("Save elsewhere …"), "{wrong}");
        hand.key(Key::R, Modifiers::COMMAND);
        until(&mut hand, "nothing is said", |hand| !hand.said().is_empty());
        hand.frames(2);
        assert!(!hand.sees("Save elsewhere …"), "{wrong}: {}", hand.said());
    }
}

#[test]
fn the_text_of_what_is_no_node_is_shown() {
    let mut hand = Hand::new(&format!("{TEXT}\n[nodes]\nx = 5\n"));
    hand.frames(2);
    let at = hand.shown_beginning("Show the text at line")[0];
    hand.click(at);
    hand.frames(3);
    assert!(hand.sees("Take over"), "the sheet stays open");
}

#[test]
fn a_film_that_fails_is_made_with_fewer_pixels_elsewhere_or_once_more() {
    let orbit = TEXT.replace("size = [160, 120]", "size = [160, 120]\norbit = 360.0");
    let mut hand = Hand::new(&orbit);
    let asked = Arc::new(std::sync::Mutex::new(Vec::<FilmRequest>::new()));
    let known = asked.clone();
    hand.editor.panels.time.film.make = Some(Arc::new(move |of: &FilmRequest, _: &dyn Observer| {
        let mut known = known.lock().unwrap();
        known.push(of.clone());
        match known.len() {
            1 => Err(no_memory()),
            2 => Err(Error::run("it cannot be written").in_file(&of.film)),
            _ => Ok("made".into()),
        }
    }));
    hand.command(Command::Film);
    hand.frames(4);
    hand.click_on("Make the film");
    until(&mut hand, "it does not fail", |hand| hand.sees("Fewer pixels"));
    assert!(!hand.sees("Save elsewhere …"), "another file takes as much");
    hand.click_on("Fewer pixels");
    until(&mut hand, "it does not fail", |hand| hand.sees("Save elsewhere …"));
    // What was mended since is what is made.
    hand.editor.edit("mend".into(), &[Edit::set("view", ["orbit"], 180.0.into())]);
    hand.frames(2);
    hand.click_on("Try again");
    until(&mut hand, "it is not made", |hand| hand.sees("made"));
    let sizes: Vec<_> = asked.lock().unwrap().iter().map(|of| of.size).collect();
    assert_eq!(sizes, [None, Some([80, 60]), Some([80, 60])]);
    assert_eq!(asked.lock().unwrap()[0].rate, 25.0, "of many frames");
    assert_eq!(asked.lock().unwrap()[2].text, hand.text());
}

#[test]
fn a_camera_without_a_way_gets_one_from_the_sheet_of_films() {
    let mut hand = Hand::new(TEXT);
    hand.command(Command::Film);
    hand.frames(4);
    hand.click_on("Orbit about the data");
    hand.frames(4);
    assert!(hand.text().contains("orbit = 360.0") && hand.sees("Make the film"), "{}", hand.text());
}

/// In a small window, too, the buttons stand below what is wrong.
#[test]
fn ways_out_of_a_picture_cover_nothing_of_what_is_wrong() {
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"gone.vtk\"",
    );
    let mut hand = Hand::before_window(&text, [700.0, 500.0], &|_| {});
    hand.frames(4);
    let wrong = |shape: &Shape| match shape {
        Shape::Text(text) if text.galley.text().contains("gone.vtk") => Some(text.visual_bounding_rect()),
        _ => None,
    };
    let picture = hand.rect("picture picture");
    let texts: Vec<Rect> = hand.shapes().iter().filter_map(|clipped| wrong(&clipped.shape)).collect();
    let text =
        texts.into_iter().find(|text| picture.contains(text.center())).expect("it is said in the picture");
    for button in ["Show 'grid'", "Choose a file …", "Try again"] {
        let rect = hand.rect(button);
        assert!(
            rect.top() >= text.bottom() && rect.bottom() <= picture.bottom() + 1.0,
            "{button} {rect} {text}"
        );
    }
}

/// Errors of figures that are computed beside the picture.
#[test]
fn errors_in_sheets_lead_to_their_node_and_are_tried_again() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let failed = || Error { remedy: None, ..no_memory() }.at_node("grid");
    let is_offered = |hand: &Hand| hand.sees("Show 'grid'");
    // The share of the widget.
    until(&mut hand, "no share comes", |hand| matches!(hand.editor.scene().share, Some(Ok(_))));
    hand.editor.worker.fail(|output| &mut output.share, failed());
    hand.frames(2);
    assert!(is_offered(&hand));
    hand.click_on("Try again");
    until(&mut hand, "it is not tried again", |hand| matches!(hand.editor.scene().share, Some(Ok(_))));
    hand.frames(2);
    assert!(!is_offered(&hand));
    // The section.
    hand.command(Command::Section);
    until(&mut hand, "no section comes", |hand| matches!(hand.editor.scene().section, Some(Ok(_))));
    hand.editor.worker.fail(|output| &mut output.section, failed());
    hand.frames(3);
    assert!(is_offered(&hand));
    hand.click_on("Try again");
    until(&mut hand, "it is not tried again", |hand| matches!(hand.editor.scene().section, Some(Ok(_))));
    hand.command(Command::Section);
    hand.settle();
    // The estimate.
    hand.command(Command::Costs);
    hand.frames(3);
    hand.click_on("Estimate the error");
    until(&mut hand, "no estimate comes", |hand| matches!(hand.editor.scene().estimate, Some(Ok(_))));
    hand.editor.worker.fail(|output| &mut output.estimate, failed());
    hand.frames(3);
    assert!(is_offered(&hand));
    hand.click_on("Estimate the error");
    until(&mut hand, "it is not tried again", |hand| matches!(hand.editor.scene().estimate, Some(Ok(_))));
    hand.command(Command::Costs);
    hand.frames(2);
    // The comparison.
    hand.click_on("remember");
    until(&mut hand, "it is not compared", |hand| !hand.shown_beginning("no difference").is_empty());
    hand.editor.panels.picture.compare.fail(failed());
    hand.frames(2);
    assert!(is_offered(&hand));
    hand.click_on("Try again");
    until(&mut hand, "it is not tried again", |hand| !hand.shown_beginning("no difference").is_empty());
    hand.frames(2);
    assert!(!is_offered(&hand));
}

/// An axis whose array the data lack.
#[test]
fn a_histogram_that_fails_alone_leads_back_to_s_and_g() {
    let mut hand = Hand::new(TEXT);
    transfer::with_distribution(&mut hand);
    let axes = [voltet_graph::ArrayRef::Named("s"), voltet_graph::ArrayRef::Array("Q".into())];
    hand.editor.panels.transfer.set_axes(axes);
    until(&mut hand, "it does not fail", |hand| hand.editor.scene().distribution_fault.is_some());
    hand.frames(2);
    assert!(hand.editor.scene().failure.is_none(), "the picture is drawn");
    hand.click_on("Axes s, g");
    transfer::with_distribution(&mut hand);
    assert!(!hand.sees("Axes s, g") && hand.sees("plane of s and g"));
}

/// A picture that is made of one has the error of that one.
#[test]
fn the_error_of_an_annotated_picture_is_estimated() {
    let figure = "[nodes.figure]\ntype = \"annotation\"\ntitle = \"a title\"\ninputs = { image = \"picture\" }\n\n[nodes.file]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.file]", figure));
    assert_eq!(hand.editor.shown_node.as_deref(), Some("figure"));
    hand.editor.estimate();
    until(&mut hand, "no estimate comes", |hand| hand.editor.scene().estimate.is_some());
    assert!(hand.editor.scene().estimate.unwrap().is_ok_and(|[most, _]| most < 0.01));
}

/// A file of two arrays, the first with a name that is near to a mistyped one.
const DATA: &str = "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 double\n\
    0 0 0 1 0 0 0 1 0 0 0 1\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n\
    SCALARS temperature double 1\nLOOKUP_TABLE default\n0 2 5 10\n\
    SCALARS p double 1\nLOOKUP_TABLE default\n0 1 2 3\n";

#[test]
fn an_array_that_the_file_lacks_is_another_one_of_it() {
    for (wrong, offered, other) in
        [("temprature", &["temperature"][..], "p"), ("velocity_of_gas", &["temperature", "p"], "q")]
    {
        let reader = format!("type = \"reader\"\npath = \"data.vtk\"\nscalar = \"{wrong}\" # coarse");
        let text = TEXT.replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", &reader);
        let mut hand = Hand::with_file(&text, "data.vtk", DATA);
        hand.editor.selection = ["view".to_string()].into();
        hand.frames(3);
        let button = |name: &str| format!("Use '{name}'");
        assert!(hand.sees("Show 'grid'") && !hand.sees("Choose a file …"), "{:?}", hand.harness);
        assert!(offered.iter().all(|name| hand.sees(&button(name))) && !hand.sees(&button(other)), "{wrong}");
        // Below the field, too.
        hand.click_on("Show 'grid'");
        hand.frames(2);
        let field = hand.rect("grid.scalar");
        let below = hand.all_named(&button("temperature"));
        assert!(below.iter().any(|own| field.contains(own.center())), "{below:?} {field}");
        hand.click_on(&button("temperature"));
        hand.settle();
        assert!(hand.text().contains("scalar = \"temperature\" # coarse"), "{}", hand.text());
        assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    }
}

#[test]
fn an_array_that_an_expression_names_in_vain_is_another_one_wherever_it_stands() {
    let sum = "[nodes.sum]\ntype = \"calculator\"\nexpression = \"temprature + 2 * p * temprature\"\n\
        name = \"sum\"\ninputs = { grid = \"grid\" }\n\n[nodes.gradient]";
    let reader = "type = \"reader\"\npath = \"data.vtk\"\nscalar = \"p\" # coarse";
    let text = TEXT.replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", reader);
    let text = text.replace("grid = \"grid\" }", "grid = \"sum\" }").replace("[nodes.gradient]", sum);
    let mut hand = Hand::with_file(&text, "data.vtk", DATA);
    hand.editor.selection = ["sum".to_string()].into();
    hand.frames(3);
    hand.click_on("Use 'temperature'");
    hand.settle();
    assert!(hand.text().contains("\"temperature + 2 * p * temperature\""), "{}", hand.text());
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
}

#[test]
fn a_data_file_that_is_missing_is_no_pipeline_and_no_changed_one() {
    let reader = "type = \"reader\"\npath = \"scene.vtk\"";
    let text = TEXT.replace("type = \"wavelet\"\nresolution = [12, 12, 12] # coarse", reader);
    let mut hand = Hand::new(&text);
    let expected = |hand: &Hand| hand.editor.scene().failure.clone().unwrap().expected.unwrap();
    assert!(!expected(&hand).contains("scene.toml"), "{}", expected(&hand));
    hand.key(Key::F5, Modifiers::NONE);
    assert_eq!(hand.said(), "the data file 'scene.vtk' is missing");
    std::fs::write(hand.folder.path().join("scene_1.vtk"), "").unwrap();
    hand.settle();
    hand.key(Key::F5, Modifiers::NONE);
    hand.settle();
    assert!(expected(&hand).contains("such as 'scene_1.vtk'"), "{}", expected(&hand));
}

#[test]
fn an_annotation_without_the_data_of_its_plane_is_joined_to_them() {
    let figure = "[nodes.figure]\ntype = \"annotation\"\ninputs = { image = \"picture\", transfer_function = \"look\" }\n\n[nodes.file]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.file]", figure));
    assert!(hand.editor.scene().failure.is_some());
    hand.click_on("Join 'gradient' to 'volume'");
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    assert!(hand.text().contains("volume = \"gradient\" }\n\n[nodes.file]"), "{}", hand.text());
}

#[test]
fn widgets_that_come_by_a_wire_are_those_of_another_node() {
    let further =
        "[nodes.further]\ntype = \"transfer-function\"\ninputs = { widgets = \"look\" }\n\n[nodes.view]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.view]", further));
    hand.editor.selection = ["further".to_string()].into();
    hand.frames(3);
    assert!(hand.shown_beginning("Nothing to see yet").is_empty());
    hand.click_on("Show 'look'");
    assert!(hand.editor.selection.contains("look") && hand.sees("centre of widget 1"));
}
