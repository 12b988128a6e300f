//! Numbers that the editor writes have as many digits as the data need, and come back bit for bit.

use super::transfer::with_distribution;
use super::*;
use crate::view::View;

/// Two tetrahedra with values 101325 + 0.01 f.
const DATA: &str = "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n\
    0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\nCELLS 2 10\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 2\n10\n10\nPOINT_DATA 5\n\
    SCALARS pressure double 1\nLOOKUP_TABLE default\n101325.00 101325.01 101325.02 101325.03 101325.05\n";

fn far_from_zero() -> Hand {
    let text = TEXT
        .replace(
            "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
            "type = \"reader\"\npath = \"data.vtk\"",
        )
        .replace("centre = [150.0, 20.0]", "centre = [101325.0234375, 0.03]")
        .replace("sigma = [60.0, 40.0]", "sigma = [0.004, 0.01]");
    Hand::with_file(&text, "data.vtk", DATA)
}

fn centre(document: &Document) -> [f64; 2] {
    let look = document.pipeline().nodes.iter().find(|node| node.name == "look").unwrap();
    let widget = look.setting("widgets").unwrap().list().unwrap()[0].table().unwrap();
    widget.iter().find(|field| field.name == "centre").unwrap().setting.array().unwrap()
}

/// The document as it is read from its file.
fn saved(hand: &mut Hand) -> Document {
    hand.key(Key::S, Modifiers::COMMAND);
    assert!(hand.editor.document().is_saved(), "{}", hand.said());
    Document::open(&hand.path()).unwrap()
}

#[test]
fn a_widget_goes_where_the_hand_does_in_a_small_range_far_from_zero() {
    let mut hand = far_from_zero();
    with_distribution(&mut hand);
    let place = |hand: &Hand| hand.editor.panels.transfer.place_of(centre(hand.editor.document())).unwrap();
    let at = place(&hand);
    hand.drag(at, at + vec2(37.0, -11.0));
    let off = place(&hand) - (at + vec2(37.0, -11.0));
    assert!(off.length() < 0.3, "{off:?}: {}", hand.text());
    let now = centre(hand.editor.document());
    assert!(now[0].to_string().len() <= "101325.023437".len() && now[0] != 101_325.0, "{now:?}");
    assert!(hand.text().contains("sigma = [0.004, 0.01]"));
    let read = centre(&saved(&mut hand));
    assert_eq!(read.map(f64::to_bits), now.map(f64::to_bits));
    // A nudge of one number leaves the other as it is.
    hand.move_to(place(&hand), Modifiers::NONE);
    hand.key(Key::ArrowRight, Modifiers::ALT);
    let nudged = centre(hand.editor.document());
    assert!(nudged[0] > now[0] && nudged[0] - now[0] < 1e-3 && nudged[1] == now[1], "{nudged:?}");
}

#[test]
fn numbers_on_an_axis_far_from_zero_are_told_apart() {
    let mut hand = far_from_zero();
    with_distribution(&mut hand);
    assert!(hand.texts("1.013e5").is_empty());
    let ticks = ["101325.01", "101325.02", "101325.03", "101325.04"].map(|text| hand.texts(text).len());
    assert!(ticks.iter().sum::<usize>() > 1, "{ticks:?}");
}

#[test]
fn a_typed_number_is_taken_with_all_its_digits_and_a_shown_one_loses_none() {
    let mut hand = Hand::in_tall_window(&TEXT.replace("extinction = 4.0", "extinction = 101325.0123456789"));
    let text = hand.text();
    let title = hand.rect("node look").min + vec2(30.0, 8.0);
    hand.click(title);
    hand.frames(3);
    let row = hand.rect("look.widgets.0.extinction");
    let at = row.left_center() + vec2(14.0, 0.0);
    hand.click(at);
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.text(), text, "nothing was typed");
    hand.click(at);
    hand.key(Key::A, Modifiers::COMMAND);
    hand.typed("101325.0123456788");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("extinction = 101325.0123456788"), "{}", hand.text());
}

#[test]
fn a_camera_at_map_coordinates_is_saved_bit_for_bit_and_follows_the_hand() {
    let text = TEXT
        .replace("eye = [-28.0, -38.0, 24.0]", "eye = [5000012.25, 4999990.5, 31.0]")
        .replace("target = [0.0, 0.0, 0.0]", "target = [5000000.0, 5000000.0, 10.0]");
    let mut hand = Hand::new(&text);
    let view = |document: &Document| {
        View::from_camera(document.pipeline().nodes.iter().find(|node| node.name == "view").unwrap()).unwrap()
    };
    let before = view(hand.editor.document());
    let at = hand.named("picture picture");
    hand.drag(at, at + vec2(61.0, 17.0));
    let now = view(hand.editor.document());
    let distance = |view: &View| (view.eye - view.target).length();
    // Each number is written to a millionth of the distance.
    assert!((distance(&now) - distance(&before)).abs() < 1e-5 * distance(&before), "{now:?}");
    assert!((now.eye - before.eye).length() > 1.0 && now.target == before.target, "{now:?}");
    let read = view(&saved(&mut hand));
    let bits = |view: &View| [view.eye, view.target, view.up].map(|v| v.to_array().map(f64::to_bits));
    assert_eq!((bits(&read), read.projection), (bits(&now), now.projection));
}

/// A slow frame holds the last digit and Enter, which ends the typing: the digit is none of the stored widgets.
#[test]
fn the_last_digit_of_a_number_recalls_no_widgets() {
    let mut hand = Hand::new(TEXT);
    hand.click(hand.named("widget 1 gaussian"));
    let at = hand.texts("4.0").into_iter().max_by(|a, b| a.x.total_cmp(&b.x)).unwrap();
    hand.click(at);
    hand.frames(2);
    assert!(hand.ctx.text_edit_focused());
    hand.key(Key::A, Modifiers::COMMAND);
    let key = |key| Event::Key {
        key,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::NONE,
    };
    hand.frame(vec![key(Key::Num7), Event::Text("7".into()), key(Key::Enter)], Modifiers::NONE);
    hand.frames(3);
    assert!(hand.text().contains("extinction = 7.0"), "{}", hand.text());
    assert!(!hand.said().contains("stored"), "{}", hand.said());
}
