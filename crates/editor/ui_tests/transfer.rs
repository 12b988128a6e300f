use super::*;

/// Until the distribution is there.
pub(super) fn with_distribution(hand: &mut Hand) {
    for _ in 0..4000 {
        hand.frames(1);
        if hand.editor.scene().distribution.is_some() {
            hand.frames(2);
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no distribution comes: {:?}", hand.editor.scene().distribution_fault);
}

fn centre(hand: &Hand) -> Vec<f64> {
    let nodes = &hand.editor.document().pipeline().nodes;
    let look = nodes.iter().find(|node| node.name == "look").unwrap();
    let widgets = look.settings.iter().find(|field| field.name == "widgets").unwrap();
    let first = widgets.setting.list().unwrap()[0].table().unwrap();
    first.iter().find(|field| field.name == "centre").unwrap().setting.numbers().unwrap()
}

#[test]
fn a_widget_is_dragged_on_the_histogram_and_the_picture_follows() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let picture = |hand: &Hand| hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    let before = picture(&hand);
    let at = hand.named("centre of widget 1");
    hand.drag(at, at + vec2(40.0, -20.0));
    let after = centre(&hand);
    assert!(after[0] > 151.0 && after[1] > 20.1, "{after:?}");
    assert_eq!(hand.steps(), 1);
    hand.settle();
    assert_ne!(picture(&hand), before);
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.settle();
    assert_eq!(hand.text(), TEXT);
    assert_eq!(picture(&hand), before);
}

#[test]
fn arrows_nudge_and_the_modifiers_change_by_how_much() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    hand.move_to(at, Modifiers::NONE);
    hand.key(Key::ArrowRight, Modifiers::NONE);
    let one = centre(&hand)[0] - 150.0;
    hand.key(Key::ArrowRight, Modifiers::SHIFT);
    let five = centre(&hand)[0] - 150.0 - one;
    hand.key(Key::ArrowLeft, Modifiers::ALT);
    let fifth = 150.0 + one + five - centre(&hand)[0];
    assert!(
        one > 0.0 && (five / one - 5.0).abs() < 0.01 && (fifth / one - 0.2).abs() < 0.01,
        "{one} {five} {fifth}"
    );
}

#[test]
fn the_wheel_zooms_one_axis_and_with_alt_the_other() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    let wheel = |modifiers| Event::MouseWheel {
        unit: eframe::egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 2.0),
        phase: TouchPhase::Move,
        modifiers,
    };
    let lengths = |hand: &Hand| hand.editor.panels.transfer.shown_axes().map(|[low, high]| high - low);
    let before = lengths(&hand);
    hand.move_to(at, Modifiers::NONE);
    hand.frame(vec![wheel(Modifiers::NONE)], Modifiers::NONE);
    hand.frames(20);
    let after = lengths(&hand);
    assert!(after[0] < 0.9 * before[0] && after[1] == before[1], "{before:?} {after:?}");
    hand.frame(vec![wheel(Modifiers::ALT)], Modifiers::ALT);
    (0..20).for_each(|_| hand.frame(Vec::new(), Modifiers::ALT));
    assert!(lengths(&hand)[1] < 0.9 * before[1]);
    assert_eq!(hand.text(), TEXT, "looking changes nothing");
}

/// Wherever the pointer is: over the widgets digits are theirs.
#[test]
fn the_window_is_made_larger_and_smaller_by_keys_and_by_its_menu() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let over_widgets = hand.named("centre of widget 1");
    for at in [hand.named("node view"), over_widgets] {
        hand.move_to(at, Modifiers::NONE);
        hand.frames(2);
        for (key, factor) in [(Key::Num0, 1.0), (Key::Plus, 1.1), (Key::Num0, 1.0), (Key::Minus, 0.9)] {
            hand.key(key, Modifiers::COMMAND);
            hand.frames(2);
            assert!((hand.ctx.zoom_factor() - factor).abs() < 1e-3, "{key:?} {}", hand.ctx.zoom_factor());
        }
        hand.key(Key::Num0, Modifiers::COMMAND);
        hand.frames(2);
    }
    assert_eq!(hand.text(), TEXT, "no widgets are stored");
    for (entry, factor) in [("Larger", 1.1), ("Smaller", 0.9), ("Usual size", 1.0)] {
        hand.click_on("View");
        let place = hand.texts(entry)[0];
        hand.click(place);
        hand.frames(2);
        assert!((hand.ctx.zoom_factor() - factor).abs() < 1e-3, "{entry} {}", hand.ctx.zoom_factor());
        hand.ctx.set_zoom_factor(1.0);
        hand.frames(2);
    }
}

#[test]
fn digits_store_and_recall_the_widgets() {
    let mut hand = Hand::new(TEXT);
    with_distribution(&mut hand);
    let at = hand.named("centre of widget 1");
    hand.move_to(at, Modifiers::NONE);
    hand.key(Key::Num3, Modifiers::COMMAND);
    hand.drag(at, at + vec2(50.0, 0.0));
    assert_ne!(centre(&hand), [150.0, 20.0]);
    hand.key(Key::Num3, Modifiers::NONE);
    assert_eq!(centre(&hand), [150.0, 20.0]);
}

#[test]
fn a_widget_has_the_name_that_its_comment_or_a_hand_gives() {
    let text = TEXT.replace("[[nodes.look.widgets]]", "# The shell: thin.\n[[nodes.look.widgets]]");
    let mut hand = Hand::new(&text);
    with_distribution(&mut hand);
    assert!(hand.sees("widget 1 gaussian: The shell"));
    hand.move_to(hand.named("centre of widget 1"), Modifiers::NONE);
    hand.frames(3);
    assert_eq!(hand.texts("centre of widget 1: The shell").len(), 1, "the pointer is told what it is at");
    hand.click_on("name of the widget");
    hand.typed("bone");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("\nname = \"bone\"\n"), "{}", hand.text());
    assert!(hand.sees("widget 1 gaussian: bone"));
    assert_eq!(hand.steps(), 1);
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), text);
    for (typed, key) in [("skull", Key::Escape), ("  ", Key::Enter)] {
        hand.click_on("name of the widget");
        hand.typed(typed);
        hand.key(key, Modifiers::NONE);
        hand.frames(2);
        assert_eq!(hand.text(), text, "'{typed}' is no name");
    }
    hand.click_on("name of the widget");
    hand.typed(" skull ");
    hand.key(Key::Enter, Modifiers::NONE);
    hand.frames(2);
    assert!(hand.text().contains("\nname = \"skull\"\n"), "{}", hand.text());
}

#[test]
fn the_picture_stays_when_a_widget_is_named() {
    let mut hand = Hand::new(TEXT);
    let full = |hand: &Hand| {
        let pixels = hand.editor.worker().shown(|shown| shown.pixels.clone()).unwrap();
        assert!(pixels.is_full());
        (pixels.number, pixels.picture)
    };
    let before = full(&hand);
    hand.editor.edit("name".into(), &[voltet_document::Edit::set("look", "widgets.0.name", "bone".into())]);
    hand.settle();
    let after = full(&hand);
    assert!(after.0 == before.0 && Arc::ptr_eq(&after.1, &before.1), "a name asks for no picture");
    hand.editor
        .edit("thin".into(), &[voltet_document::Edit::set("look", "widgets.0.extinction", 2.0.into())]);
    hand.settle();
    assert!(!Arc::ptr_eq(&full(&hand).1, &before.1));
}

#[test]
fn handles_of_a_widget_that_is_small_on_the_screen_are_told_apart() {
    let mut hand = Hand::new(&TEXT.replace("sigma = [60.0, 40.0]", "sigma = [0.5, 0.5]"));
    with_distribution(&mut hand);
    let names = ["centre", "width 1", "width 2"].map(|name| format!("{name} of widget 1"));
    let places = names.each_ref().map(|name| hand.named(name));
    for (i, a) in places.iter().enumerate() {
        for b in &places[..i] {
            assert!(a.distance(*b) > 8.0, "{places:?}");
        }
    }
    let sigma = |hand: &Hand| hand.text().lines().find(|line| line.starts_with("sigma")).unwrap().to_string();
    let before = sigma(&hand);
    hand.drag(places[1], places[1] + vec2(60.0, 0.0));
    assert_eq!(centre(&hand), [150.0, 20.0]);
    assert_ne!(sigma(&hand), before);
}
