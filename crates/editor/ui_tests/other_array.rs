//! Another array is drawn: the widgets follow it.

use super::*;
use voltet_document::Edit;

/// Of two arrays, of which one is 20 times the other less 100.
const DATA: &str = "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n\
    0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\nPOINT_DATA 5\n\
    SCALARS A double 1\nLOOKUP_TABLE default\n0 2 5 10 8\n\
    SCALARS B double 1\nLOOKUP_TABLE default\n-100 -60 0 100 60\n";

fn before(look: &str) -> Hand {
    let widgets = &TEXT[TEXT.find("\n[[nodes.look.widgets]]").unwrap()..TEXT.find("\n[nodes.view]").unwrap()];
    let text = TEXT.replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"data.vtk\"\nscalar = \"A\" # coarse",
    );
    let text = text.replace(widgets, look);
    // Shares are those of the volume that is wired in.
    let text = text
        .replace("\"transfer-function\"\n", "\"transfer-function\"\ninputs = { volume = \"gradient\" }\n");
    let mut hand = Hand::with_file(&text, "data.vtk", DATA);
    until(&mut hand, "no histogram", |hand| hand.editor.scene().distribution.is_some());
    hand.frames(2);
    hand
}

const LOOK: &str = "\n[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.5, 0.15]  # orange\nextinction = 4.0\n\
    centre = [ 5.0,  4.0 ] # of A\nsigma = [1.0, inf]\nregion = { s = [0.0, 10.0] } # all\n\n\
    # By shares.\n[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [0.1, 0.5, 0.9]\nextinction = 4.0\n\
    centre = [\"50 %\", 2.0]\nsigma = [\"5 %\", 1.0]\n";

/// Chooses an array in the menu over the widgets.
fn choose(hand: &mut Hand, from: &str, to: &str) {
    hand.click_on(&format!("s: {from}"));
    let beginning = format!("{to}  (points");
    until(hand, "no arrays", |hand| !hand.shown_beginning(&beginning).is_empty());
    let at = hand.shown_beginning(&beginning)[0];
    hand.click(at);
}

/// Adds a calculator between the reader and the gradient, which makes another scalar.
fn with_calculator(hand: &mut Hand) {
    let text = hand.text().replace("inputs = { grid = \"grid\" }", "inputs = { grid = \"twice\" }");
    let calculator = "\n[nodes.twice]\ntype = \"calculator\"\nexpression = \"2*A\"\nname = \"C\"\ninputs = { grid = \"grid\" }\n";
    hand.editor.edit("calculate".into(), &[Edit::Text(text + calculator)]);
    hand.settle();
    until(hand, "no histogram", |hand| hand.editor.scene().distribution.is_some());
    hand.frames(2);
}

#[test]
fn the_array_of_a_calculator_is_named_and_another_takes_its_place() {
    let mut hand = before(LOOK);
    assert_eq!((hand.texts("s = A").len(), hand.sees("s: A")), (1, true));
    with_calculator(&mut hand);
    assert_eq!((hand.texts("s = C").len(), hand.sees("s: C")), (1, true), "what is drawn, not what is read");
    let text = hand.text();
    choose(&mut hand, "C", "B");
    followed(&mut hand);
    until(&mut hand, "it is not drawn", |hand| hand.sees("s: B"));
    assert_eq!(hand.texts("s = B").len(), 1);
    // From 5 in 0 … 20 to the same share of -100 … 100.
    let [s, _]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s + 50.0).abs() < 1e-3, "{}", hand.text());
    assert!(hand.text().contains("scalar = \"B\" # coarse") && hand.text().contains("scalar = false"));
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    // And back.
    hand.click_on("s: B");
    let entry = "C  (computed by twice)";
    until(&mut hand, "no arrays", |hand| !hand.texts(entry).is_empty());
    hand.click(hand.texts(entry)[0]);
    followed(&mut hand);
    until(&mut hand, "it is not drawn", |hand| hand.sees("s: C"));
    let [s, _]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s - 5.0).abs() < 1e-3 && !hand.text().contains("scalar = false"), "{}", hand.text());
    for _ in 0..2 {
        hand.key(Key::Z, Modifiers::COMMAND);
    }
    hand.frames(2);
    assert_eq!(hand.text(), text, "each choice is one step");
    // The section has the colours of what is drawn.
    hand.command(Command::Section);
    until(&mut hand, "no section comes", |hand| !hand.shown_beginning("C from ").is_empty());
}

fn followed(hand: &mut Hand) {
    until(hand, "the widgets do not follow", |hand| hand.editor.pending_rescale.is_none());
}

fn widget(hand: &Hand, place: usize, key: &str) -> String {
    let nodes = &hand.editor.document().pipeline().nodes;
    let look = nodes.iter().find(|node| node.name == "look").unwrap();
    let list = look.setting("widgets").unwrap().list().unwrap().to_vec();
    let table = list[place].table().unwrap().to_vec();
    table.iter().find(|field| field.name == key).unwrap().setting.datum.to_string()
}

#[test]
fn widgets_follow_the_array_of_the_menu_in_the_step_that_chose_it() {
    let mut hand = before(LOOK);
    let text = hand.text();
    choose(&mut hand, "A", "B");
    followed(&mut hand);
    let [s, g]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s.abs() < 1e-4) && (g - 80.0).abs() < 1e-2, "{}", hand.text());
    assert_eq!(hand_numbers::<1>(&widget(&hand, 0, "sigma")), [20.0]);
    assert_eq!(widget(&hand, 0, "region"), "{ s = [-100.0, 100.0] }");
    // What is relative stays, number by number.
    assert!(widget(&hand, 1, "centre").starts_with("[\"50 %\", 4"), "{}", hand.text());
    assert!(widget(&hand, 1, "sigma").starts_with("[\"5 %\", 2"), "{}", hand.text());
    for kept in ["# orange", "# of A", "centre = [ ", "# all", "# By shares.", "scalar = \"B\" # coarse"] {
        assert!(hand.text().contains(kept), "{kept}: {}", hand.text());
    }
    assert_eq!(hand.steps(), 1);
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    let drawn = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    assert!(drawn.rgba.iter().any(|pixel| pixel[3] > 0.0), "there is something to see");
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.frames(2);
    assert_eq!((hand.text(), hand.steps()), (text, 0));
    // Back and forth: they are where they were.
    hand.key(Key::Y, Modifiers::COMMAND);
    hand.settle();
    until(&mut hand, "no histogram", |hand| hand.editor.scene().distribution.is_some());
    hand.frames(2);
    choose(&mut hand, "B", "A");
    followed(&mut hand);
    let [s, g]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s - 5.0).abs() < 1e-4 && (g - 4.0).abs() < 1e-3, "{}", hand.text());
}

/// First numbers of a list as a file has it.
fn hand_numbers<const N: usize>(list: &str) -> [f64; N] {
    let inner = list.trim_start_matches('[').split(']').next().unwrap();
    let all: Vec<f64> = inner.split(',').map(|x| x.trim().parse().unwrap()).collect();
    all[..N].try_into().unwrap()
}

#[test]
fn widgets_follow_the_array_of_the_readers_parameters_and_of_a_second_choice() {
    let mut hand = before(LOOK);
    let text = hand.text();
    // The others before the first has come; one of them twice.
    for array in ["A:magnitude", "B", "B"] {
        hand.editor.actions.edit(Edit::set("grid", ["scalar"], array.into()));
        hand.frames(1);
    }
    followed(&mut hand);
    let [s, g]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s.abs() < 1e-4) && (g - 80.0).abs() < 1e-2, "{}", hand.text());
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!((hand.text(), hand.steps()), (text, 0), "the choices and what follows are one step");
}

/// A step in between is undone by itself.
#[test]
fn what_is_done_while_ranges_are_looked_for_stays_a_step_of_its_own() {
    let mut hand = before(LOOK);
    hand.editor.edit("array".into(), &[Edit::set("grid", ["scalar"], "B".into())]);
    hand.editor.edit("by hand".into(), &[Edit::set("view", ["orbit"], 360.0.into())]);
    followed(&mut hand);
    let [s, g]: [f64; 2] = hand_numbers(&widget(&hand, 0, "centre"));
    assert!((s.abs() < 1e-4) && (g - 80.0).abs() < 1e-2, "{}", hand.text());
    assert_eq!(hand.steps(), 3);
}

#[test]
fn widgets_of_two_volumes_and_relative_ones_stay() {
    let mut hand = before(LOOK);
    let other = "\n[nodes.other]\ntype = \"reader\"\npath = \"data.vtk\"\nscalar = \"A\"\n\n[nodes.slope]\n\
        type = \"gradient-magnitude\"\ninputs = { grid = \"other\" }\n\n[nodes.second]\ntype = \"renderer\"\n\
        inputs = { volume = \"slope\", transfer_function = \"look\", camera = \"view\" }\n";
    let text = hand.text() + other;
    hand.editor.edit("a second picture".into(), &[Edit::Text(text)]);
    hand.settle();
    hand.editor.edit("array".into(), &[Edit::set("grid", ["scalar"], "B".into())]);
    assert!(hand.said().contains("'look' stay at their numbers"), "{}", hand.said());
    assert!(hand.editor.pending_rescale.is_none());
    let relative = "\n[[nodes.look.widgets]]\nkind = \"gaussian\"\ncolor = [0.1, 0.5, 0.9]\nextinction = 4.0\n\
        centre = [\"50 %\", \"p50\"]\nsigma = [\"5 %\", \"5 %\"]\n";
    let mut hand = before(relative);
    hand.editor.edit("array".into(), &[Edit::set("grid", ["scalar"], "B".into())]);
    assert!(hand.editor.pending_rescale.is_none() && hand.said().is_empty(), "{}", hand.said());
}

#[test]
fn widgets_that_a_hand_changed_meanwhile_and_a_choice_that_is_undone_are_left() {
    let mut hand = before(LOOK);
    hand.editor.edit("array".into(), &[Edit::set("grid", ["scalar"], "B".into())]);
    hand.editor
        .edit("by hand".into(), &[Edit::set("look", "widgets.0.centre", [7.0, 4.0].into_iter().collect())]);
    followed(&mut hand);
    hand.settle();
    assert_eq!(widget(&hand, 0, "centre").replace(' ', ""), "[7.0,4.0]");
    assert_eq!(hand.steps(), 2);
    let mut hand = before(LOOK);
    let text = hand.text();
    hand.editor.edit("array".into(), &[Edit::set("grid", ["scalar"], "B".into())]);
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.settle();
    assert_eq!(hand.text(), text);
}

#[test]
fn on_a_symmetric_logarithm_the_linear_part_follows_too() {
    let mut hand = before(&format!("s_scale = \"symlog\"\ns_linear_below = 0.1\n{LOOK}"));
    choose(&mut hand, "A", "B");
    followed(&mut hand);
    assert!(hand.text().contains("s_linear_below = 1.0\n"), "ten times the largest value: {}", hand.text());
    assert_eq!(hand.steps(), 1);
}
