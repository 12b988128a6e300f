//! The transfer function editor: points, keys, sets, relative numbers, several fields, shares.

use super::transfer::with_distribution;
use super::*;
use voltet_graph::{ArrayRef, LocatedValue, NodeEntry};

pub(super) fn widgets(hand: &Hand) -> Vec<LocatedValue> {
    let nodes = &hand.editor.document().pipeline().nodes;
    let look: &NodeEntry = nodes.iter().find(|node| node.name == "look").unwrap();
    look.settings.iter().find(|field| field.name == "widgets").unwrap().setting.list().unwrap().to_vec()
}

pub(super) fn of(widget: &LocatedValue, key: &str) -> LocatedValue {
    widget.table().unwrap().iter().find(|field| field.name == key).unwrap().setting.clone()
}

fn points(hand: &Hand) -> Vec<Vec<f64>> {
    of(&widgets(hand)[0], "points").list().unwrap().iter().map(|row| row.numbers().unwrap()).collect()
}

pub(super) fn place(hand: &Hand, value: [f64; 2]) -> Pos2 {
    hand.editor.panels.transfer.place_of(value).unwrap()
}

fn double_click(hand: &mut Hand, at: Pos2) {
    hand.move_to(at, Modifiers::NONE);
    for _ in 0..2 {
        hand.button(true, PointerButton::Primary, Modifiers::NONE);
        hand.button(false, PointerButton::Primary, Modifiers::NONE);
    }
    hand.frames(2);
    hand.pause = 1.0;
}

fn right_click(hand: &mut Hand, at: Pos2) {
    hand.move_to(at, Modifiers::NONE);
    hand.button(true, PointerButton::Secondary, Modifiers::NONE);
    hand.button(false, PointerButton::Secondary, Modifiers::NONE);
    hand.frames(2);
}

/// The first widget as a curve over s.
fn with_curve() -> String {
    let i = TEXT.find("kind = \"gaussian\"").unwrap();
    let j = TEXT.find("[nodes.view]").unwrap();
    let curve = "kind = \"piecewise-linear\"\npoints = [\n  [60.0, 1.0, 0.0, 0.0, 0.0], # the foot\n  [250.0, 0.0, 0.0, 1.0, 8.0],\n]\n\n";
    format!("{}{curve}{}", &TEXT[..i], &TEXT[j..])
}

#[test]
fn points_of_a_curve_are_added_and_taken_away() {
    let text = with_curve();
    let mut hand = Hand::new(&text);
    with_distribution(&mut hand);
    let [_, [_, top]] = hand.editor.panels.transfer.shown_axes();
    // Half way up by the cube root: an eighth of the scale, which reaches a tenth over the largest.
    let at = place(&hand, [150.0, 0.5 * top]);
    double_click(&mut hand, at);
    let after = points(&hand);
    assert_eq!(after.len(), 3);
    assert!((after[1][0] - 150.0).abs() < 1.0 && (after[1][4] / 1.1 - 1.0).abs() < 0.05, "{after:?}");
    assert!(after[1][1] > 0.4 && after[1][3] > 0.4, "the colours of both sides: {after:?}");
    assert!(hand.text().contains("# the foot"));
    // Near the foot a fifth of the hand's way tells small extinctions apart.
    let from = place(&hand, [after[1][0], 0.5 * top]);
    let to = place(&hand, [after[1][0], 0.05 * top]);
    hand.drag_with(from, to, PointerButton::Primary, Modifiers::ALT);
    let fine = points(&hand)[1][4];
    // From 0.5 to 0.41 of the height.
    assert!((fine / (8.8 * 0.41f64.powi(3)) - 1.0).abs() < 0.06, "{fine}");
    let at = place(&hand, [points(&hand)[1][0], (fine / 8.8).cbrt() * top]);
    right_click(&mut hand, at);
    assert_eq!(points(&hand).len(), 2);
    assert_eq!(hand.steps(), 3);
    (0..3).for_each(|_| hand.key(Key::Z, Modifiers::COMMAND));
    assert_eq!(hand.text(), text);
}

#[test]
fn keys_over_the_plane_are_for_widgets_and_elsewhere_for_nodes() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = place(&hand, [150.0, 20.0]);
    hand.move_to(at, Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::D, Modifiers::COMMAND);
    assert_eq!(widgets(&hand).len(), 2);
    hand.key(Key::P, Modifiers::NONE);
    assert_eq!(widgets(&hand).len(), 3);
    assert_ne!(of(&widgets(&hand)[2], "centre"), of(&widgets(&hand)[0], "centre"));
    let last = of(&widgets(&hand)[2], "color");
    hand.key(Key::PageUp, Modifiers::SHIFT);
    assert_eq!(of(&widgets(&hand)[1], "color"), last, "its place in the list");
    hand.key(Key::V, Modifiers::NONE);
    assert_eq!(
        hand.editor.panels.transfer.hidden().map(|(_, hidden)| hidden.iter().copied().collect()),
        Some(vec![1])
    );
    hand.key(Key::PageUp, Modifiers::NONE);
    hand.key(Key::Delete, Modifiers::NONE);
    assert_eq!(widgets(&hand).len(), 2);
    assert_eq!(
        hand.editor.panels.transfer.hidden().map(|(_, hidden)| hidden.iter().copied().collect()),
        Some(vec![0])
    );
    assert!(hand.editor.document().pipeline().nodes.iter().any(|node| node.name == "look"));
    let picture = hand.named("picture picture");
    hand.move_to(picture, Modifiers::NONE);
    hand.frames(2);
    // By the keyboard alone, wherever the pointer is.
    let centre = of(&widgets(&hand)[0], "centre");
    hand.key(Key::W, Modifiers::NONE);
    hand.key(Key::PageDown, Modifiers::NONE);
    hand.key(Key::PageDown, Modifiers::NONE);
    hand.key(Key::ArrowRight, Modifiers::NONE);
    assert_ne!(of(&widgets(&hand)[0], "centre"), centre);
    hand.key(Key::Escape, Modifiers::NONE);
    hand.key(Key::Delete, Modifiers::NONE);
    assert_eq!(widgets(&hand).len(), 1, "the widget in hand, until a node is selected");
}

#[test]
fn menus_delete_and_duplicate_the_widget_that_was_selected_last() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    hand.click(at);
    hand.command(Command::Duplicate);
    hand.frames(2);
    assert_eq!(widgets(&hand).len(), 2);
    hand.frame(vec![Event::Cut], Modifiers::NONE);
    hand.frames(2);
    assert!(hand.said().contains("a widget is not cut"), "{}", hand.said());
    for _ in 0..3 {
        hand.command(Command::Delete);
        hand.frames(2);
    }
    assert!(hand.said().contains("there is no widget"), "{}", hand.said());
    (0..3).for_each(|_| hand.key(Key::Z, Modifiers::COMMAND));
    assert_eq!(hand.text(), TEXT);
    // The menu of a node is for the node, even where it was selected before.
    let node = hand.named("node look");
    hand.click(node);
    let at = hand.named("centre of widget 1");
    hand.click(at);
    right_click(&mut hand, node);
    hand.click_on("Delete");
    assert!(!hand.text().contains("[nodes.look]"), "{}", hand.text());
}

#[test]
fn arrows_are_for_what_has_the_focus_not_for_the_widget_too() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    hand.click(at);
    hand.frames(2);
    hand.key(Key::Tab, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.ctx.memory(|memory| memory.focused()).is_some() && !hand.editor.panels.graph.has_focus());
    hand.key(Key::ArrowRight, Modifiers::NONE);
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn sets_are_kept_in_the_file_and_are_steps() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = place(&hand, [150.0, 20.0]);
    hand.move_to(at, Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::Num3, Modifiers::COMMAND);
    let stored = hand.text();
    assert!(stored.starts_with(TEXT) && stored.contains("[editor.sets]\n3 = [{"), "{stored}");
    hand.drag(at, at + vec2(60.0, 0.0));
    // Another window on the file as it is now knows them.
    let mut other = Hand::new(&hand.text());
    with_distribution(&mut other);
    let elsewhere = of(&widgets(&other)[0], "centre").numbers().unwrap();
    assert!(elsewhere[0] > 151.0);
    let at = place(&other, [150.0, 20.0]);
    other.move_to(at, Modifiers::NONE);
    other.frames(2);
    other.key(Key::Num3, Modifiers::NONE);
    assert_eq!(of(&widgets(&other)[0], "centre").numbers().unwrap(), [150.0, 20.0]);
    assert_eq!(other.steps(), 1);
    (0..2).for_each(|_| hand.key(Key::Z, Modifiers::COMMAND));
    assert_eq!(hand.text(), TEXT);
}

#[test]
fn a_recalled_set_has_the_names_that_comments_gave() {
    let mut hand =
        Hand::new(&TEXT.replace("[[nodes.look.widgets]]", "# The warm core.\n[[nodes.look.widgets]]"));
    with_distribution(&mut hand);
    let at = place(&hand, [150.0, 20.0]);
    hand.move_to(at, Modifiers::NONE);
    hand.frames(2);
    hand.key(Key::Num3, Modifiers::COMMAND);
    hand.click(at);
    hand.key(Key::Delete, Modifiers::NONE);
    assert!(!hand.text().contains("[[nodes.look.widgets]]"), "{}", hand.text());
    hand.frames(2);
    hand.key(Key::Num3, Modifiers::NONE);
    assert_eq!(of(&widgets(&hand)[0], "name").text(), Some("The warm core"));
}

#[test]
fn relative_numbers_stay_relative_where_a_hand_moves_them() {
    let text = TEXT
        .replace("centre = [150.0, 20.0]", "centre = [\"p60\", \"40 %\"]")
        .replace("sigma = [60.0, 40.0]", "sigma = [\"20 %\", 40.0]")
        .replace(
            "type = \"transfer-function\"",
            "type = \"transfer-function\"\ninputs = { volume = \"gradient\" }",
        );
    let mut hand = Hand::new(&text);
    with_distribution(&mut hand);
    let axes = hand.editor.panels.transfer.shown_axes();
    let known = hand.editor.scene().distribution.clone().unwrap();
    let of_s = &known.known.spreads[&ArrayRef::Named("s")];
    let [_, high] = known.known.ranges[&ArrayRef::Named("g")];
    let centre = [of_s.value_at(0.6), 0.4 * high];
    let from = place(&hand, centre);
    // While it is dragged the picture is drawn with numbers: no percentile is found for each step.
    hand.move_to(from, Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    (1..=10).for_each(|step| hand.move_to(from + step as f32 * vec2(4.0, -1.2), Modifiers::NONE));
    let drawn = |hand: &Hand| {
        let asked = hand.editor.answers.asked.clone().unwrap();
        let look = asked.nodes.iter().find(|node| node.name == "look").unwrap().clone();
        let widgets = look.settings.iter().find(|field| field.name == "widgets").unwrap().setting.clone();
        of(&widgets.list().unwrap()[0], "centre")
    };
    let meanwhile = drawn(&hand).numbers().unwrap();
    hand.button(false, PointerButton::Primary, Modifiers::NONE);
    hand.frames(2);
    assert!(drawn(&hand).numbers().is_none(), "the file's own at the end");
    let after = of(&widgets(&hand)[0], "centre");
    let texts: Vec<&str> = after.list().unwrap().iter().map(|part| part.text().unwrap()).collect();
    assert!(texts[0].starts_with('p') && texts[1].ends_with(" %"), "{texts:?}");
    assert_eq!(of(&widgets(&hand)[0], "sigma").datum.to_string(), "[\"20 %\", 40.0]");
    assert_eq!(hand.steps(), 1);
    // What a run makes of it is where the hand left it.
    hand.settle();
    let report = hand.editor.worker().shown(|shown| shown.report.clone().unwrap());
    let said = format!("{:?}", report.findings);
    let to = hand.editor.panels.transfer.value_at(from + vec2(40.0, -12.0)).unwrap();
    let percent: f64 = texts[0][1..].parse().unwrap();
    let landed = of_s.value_at(percent / 100.0);
    assert!((meanwhile[0] - landed).abs() < 1e-9 * landed, "{meanwhile:?} {landed}");
    assert!((landed - to[0]).abs() < 1e-3 * (axes[0][1] - axes[0][0]), "{landed} for {}: {said}", to[0]);
}

/// A cube of two arrays, cut into tetrahedra by the reader.
pub(super) const CUBE: &str = "# vtk DataFile Version 3.0\ncube\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 8 float\n\
    0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1\nCELLS 1 9\n8 0 1 2 3 4 5 6 7\nCELL_TYPES 1\n12\nPOINT_DATA 8\n\
    SCALARS a float 1\nLOOKUP_TABLE default\n0 1 1 0 0 1 1 0\nSCALARS b float 1\nLOOKUP_TABLE default\n0 0 4 4 0 0 4 4\n\
    SCALARS c float 1\nLOOKUP_TABLE default\n0 0 0 0 2 2 2 2\n\
    SCALARS same float 1\nLOOKUP_TABLE default\n5 5 5 5 5 5 5 5\n";

#[test]
fn a_widget_over_several_fields_is_moved_on_the_plane_of_two_of_them() {
    let widget = "kind = \"gaussian-nd\"\nfields = [\"a\", \"b\", \"c\"]\ncolor = [1.0, 0.5, 0.15]\nextinction = 4.0\n\
        centre = [0.5, \"50 %\", 1.0]\nsigma = [0.2, 0.8, inf]\n\n";
    let (i, j) = (TEXT.find("kind = \"gaussian\"").unwrap(), TEXT.find("[nodes.view]").unwrap());
    let text = format!("{}{widget}{}", &TEXT[..i], &TEXT[j..]).replace(
        "type = \"wavelet\"\nresolution = [12, 12, 12] # coarse",
        "type = \"reader\"\npath = \"cube.vtk\"\nscalar = \"a\"",
    );
    let text = text.replace(
        "type = \"transfer-function\"",
        "type = \"transfer-function\"\ninputs = { volume = \"gradient\" }",
    );
    let mut hand = Hand::with_file(&text, "cube.vtk", CUBE);
    with_distribution(&mut hand);
    hand.editor.panels.transfer.choose_for_tests(["b", "a"].map(|name| ArrayRef::Array(name.into())));
    hand.frames(4);
    with_distribution(&mut hand);
    let [[low, high], _] = hand.editor.panels.transfer.shown_axes();
    assert!(low < 0.0 && low > -0.3 && high > 4.0 && high < 4.3, "{low} {high}");
    let at = place(&hand, [2.0, 0.5]);
    let to = place(&hand, [3.0, 0.25]);
    hand.drag(at, to);
    let centre = of(&widgets(&hand)[0], "centre");
    let parts = centre.list().unwrap();
    assert!((parts[0].number().unwrap() - 0.25).abs() < 0.02, "{centre:?}");
    let share: f64 = parts[1].text().unwrap().trim_end_matches(" %").parse().unwrap();
    assert!((share - 75.0).abs() < 2.0, "{centre:?}");
    assert_eq!(parts[2].number(), Some(1.0));
}

#[test]
fn the_share_of_the_widget_in_hand_is_found() {
    let mut hand = Hand::new(TEXT);
    let found = |hand: &mut Hand| {
        for _ in 0..4000 {
            hand.frames(1);
            if let Some(found) = hand.editor.scene().share {
                return found.unwrap();
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("no share comes");
    };
    let alone = found(&mut hand);
    assert!(alone.opacity == 1.0 && alone.light == 1.0, "it is all of the picture: {alone:?}");
    let [own, all] = alone.cells.unwrap();
    assert!(own > 0 && own <= all, "{alone:?}");
    // Of two the same, one is what makes it denser.
    let at = hand.named("picture picture") + vec2(0.0, 200.0);
    hand.move_to(at, Modifiers::NONE);
    hand.editor.edit(
        "two".into(),
        &[voltet_document::Edit::Duplicate { node: "look".into(), list: "widgets".into(), place: 0 }],
    );
    hand.settle();
    let both = found(&mut hand);
    assert!(both.opacity > 0.0 && both.opacity < 0.5, "{both:?}");
}

/// The distribution asks for a gradient that the picture does not.
#[test]
fn a_late_distribution_leaves_the_picture_as_it_is() {
    let mut hand = Hand::new(&TEXT.replace("sigma = [60.0, 40.0]", "sigma = [60.0, inf]"));
    let picture = |hand: &Hand| {
        hand.editor.worker().shown(|shown| {
            let pixels = shown.pixels.clone().unwrap();
            (pixels.number, pixels.divisor, pixels.picture)
        })
    };
    let before = picture(&hand);
    let empty = hand.editor.panels.transfer.shown_axes();
    with_distribution(&mut hand);
    hand.settle();
    assert_eq!(picture(&hand), before, "not even drawn again");
    assert!(empty == hand.editor.panels.transfer.shown_axes() || empty == [[0.0, 1.0]; 2]);
}

/// On the screen: the ring follows the hand, both half axes stay as long as they are, at a right angle.
#[test]
fn an_ellipse_is_turned_as_it_is_seen() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    hand.frames(2);
    let length = |hand: &Hand, value: [f64; 2]| {
        let by = place(hand, value) - place(hand, [150.0, 20.0]);
        f64::from(by.length())
    };
    let [wide, high] = [length(&hand, [210.0, 20.0]), length(&hand, [150.0, 60.0])];
    let centre = place(&hand, [150.0, 20.0]);
    hand.click(centre);
    let ring = place(&hand, [150.0 + 1.7 * 60.0, 20.0]);
    // A quarter of the way round, upward.
    let turned = centre + (ring - centre).length() * vec2(1.0, -1.0) / 2f32.sqrt();
    hand.drag(ring, turned);
    let rows = of(&widgets(&hand)[0], "matrix");
    let k: Vec<Vec<f64>> = rows.list().unwrap().iter().map(|row| row.numbers().unwrap()).collect();
    let strength = |at: Pos2| {
        let value = hand.editor.panels.transfer.value_at(at).unwrap();
        let v = [value[0] - 150.0, value[1] - 20.0];
        (-k.iter().map(|row| (row[0] * v[0] + row[1] * v[1]).powi(2)).sum::<f64>()).exp()
    };
    for (length, way) in [(wide, vec2(1.0, -1.0)), (high, vec2(-1.0, -1.0)), (high, vec2(1.0, 1.0))] {
        let at = strength(centre + length as f32 * way / 2f32.sqrt());
        assert!((at - (-0.5f64).exp()).abs() < 0.02, "{way:?}: {at}");
    }
}

#[test]
fn the_buttons_of_a_widget_stand_in_one_line_in_a_small_window() {
    for (size, name) in [([900.0, 600.0], ""), ([1280.0, 720.0], "name = \"thermal interface\"\n")] {
        let text = TEXT.replace("kind = \"gaussian\"\n", &format!("kind = \"gaussian\"\n{name}"));
        let mut hand = Hand::before_window(&text, size, &|_| {});
        with_distribution(&mut hand);
        let first = hand.shown_beginning("1 gaussian")[0].y;
        for button in ["duplicate the widget", "take the widget away", "hide", "solo"] {
            assert!((hand.named(button).y - first).abs() < 6.0, "{size:?} {button}");
        }
    }
}

#[test]
fn a_colour_map_over_all_of_the_data_is_shown_where_they_lie() {
    let gaussian = TEXT.split("kind = ").nth(1).and_then(|rest| rest.split("\n\n").next()).unwrap();
    let unstated = TEXT.replace(gaussian, "\"colormap\"\nextinction = 0.1");
    let stated = unstated.replace("extinction = 0.1", "extinction = 0.1\nrange = [\"0 %\", \"100 %\"]");
    let drawn = [unstated, stated].map(|text| {
        let mut hand = Hand::new(&text);
        with_distribution(&mut hand);
        assert!(hand.shown(&|text| text.contains("not of the type")).is_empty());
        let plane = hand.rect("plane of s and g");
        let within =
            hand.shapes().iter().filter(|shape| plane.contains_rect(shape.shape.visual_bounding_rect()));
        within.map(|shape| shape.shape.visual_bounding_rect()).collect::<Vec<_>>()
    });
    assert!(drawn[0] == drawn[1], "{drawn:?}");
}
