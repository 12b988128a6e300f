use super::*;

#[test]
fn a_picture_is_remembered_and_later_ones_are_compared_with_it() {
    let mut hand = Hand::new(TEXT);
    assert!(!hand.sees("line of comparison") && hand.texts("swipe").is_empty());
    hand.click_on("remember");
    let is_none = |hand: &Hand| !hand.shown_beginning("no difference").is_empty();
    until(&mut hand, "it is the same picture", is_none);
    let line = hand.rect("line of comparison");
    // Each side says what it shows, where the line is and beside each other.
    let sides = |hand: &Hand| {
        let place = |text: &str| hand.texts(text).first().copied().unwrap_or_else(|| panic!("no '{text}'"));
        [place("remembered").x, place("present").x]
    };
    let [left, right] = sides(&hand);
    assert!(left < line.center().x && line.center().x < right, "{left} {line} {right}");
    let steps = hand.steps();
    // The line is dragged, and the camera stays where it is.
    hand.drag(line.center(), line.center() + vec2(-80.0, 30.0));
    let moved = hand.rect("line of comparison").center();
    assert!((moved.x - (line.center().x - 80.0)).abs() < 1.5, "{moved} after {line}");
    let [left, right] = sides(&hand);
    assert!(left < moved.x && moved.x < right, "{left} {moved} {right}");
    assert_eq!(hand.steps(), steps);
    hand.key(Key::X, Modifiers::NONE);
    hand.settle();
    let said = |hand: &Hand| !hand.shown_beginning("largest difference").is_empty();
    until(&mut hand, "it is another picture", |hand| said(hand) && !is_none(hand));
    let whole = hand.editor.panels.picture.rect.unwrap();
    // What the pointer meets is said above, and hides no figure.
    assert!(hand.shown_beginning("largest difference")[0].y > whole.center().y);
    hand.click_on("beside");
    hand.settle();
    let half = hand.editor.panels.picture.rect.unwrap();
    assert!(half.width() < whole.width() + 1.0 && half.left() > whole.center().x - 1.0, "{half} of {whole}");
    // Beside each other both are as large as they were drawn, and compared as before.
    until(&mut hand, "they differ beside each other", |hand| said(hand) && !is_none(hand));
    let [left, right] = sides(&hand);
    assert!(left < half.left() && half.left() < right, "{left} {half} {right}");
    hand.click_on("difference");
    until(&mut hand, "they differ", |hand| said(hand) && !is_none(hand));
    assert!(!hand.sees("line of comparison") && hand.texts("present").is_empty());
    hand.click_on("forget the remembered picture");
    assert!(!said(&hand) && hand.texts("swipe").is_empty());
}

#[test]
fn words_and_buttons_keep_inside_a_small_pane_and_stand_on_a_ground_over_the_line() {
    let mut hand = Hand::before_window(TEXT, [700.0, 500.0], &|_| {});
    hand.click_on("remember");
    hand.key(Key::X, Modifiers::NONE);
    hand.settle();
    until(&mut hand, "it is compared", |hand| !hand.shown_beginning("largest difference").is_empty());
    assert_eq!(screens::cut(&hand), [""; 0]);
    let buttons = ["swipe", "beside", "difference"].map(|text| hand.texts(text)[0]);
    let shape =
        |is_it: &dyn Fn(&Shape) -> bool| hand.shapes().iter().rposition(|clipped| is_it(&clipped.shape));
    let line = shape(
        &|shape| matches!(shape, Shape::LineSegment { stroke, .. } if stroke.color == crate::theme::accent(true)),
    );
    let ground = shape(&|shape| {
        matches!(shape, Shape::Rect(rect) if rect.fill == eframe::egui::Color32::BLACK
            && buttons.iter().all(|at| rect.rect.contains(*at)) && rect.rect.height() < 40.0)
    });
    assert!(line.is_some() && ground > line, "{ground:?} over {line:?}");
}
