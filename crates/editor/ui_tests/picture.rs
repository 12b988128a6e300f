use super::*;

fn middle(hand: &Hand) -> Pos2 {
    hand.named("picture picture")
}

#[test]
fn a_drag_orbits_the_camera_in_the_file_and_is_one_step() {
    let mut hand = Hand::new(TEXT);
    let before = hand.numbers("view", "eye");
    let at = middle(&hand);
    hand.drag(at, at + vec2(60.0, 0.0));
    let after = hand.numbers("view", "eye");
    let length = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert_ne!(before, after);
    assert!((length(&after) / length(&before) - 1.0).abs() < 1e-5, "the distance is kept");
    assert_eq!(hand.steps(), 1);
    assert!(hand.text().contains("# The wavelet, in one colour") && hand.text().contains("# coarse"));
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
    assert!(hand.editor.document().is_saved());
}

#[test]
fn a_drag_makes_numbers_of_a_view_in_words() {
    let eye = "eye = [-28.0, -38.0, 24.0]\ntarget = [0.0, 0.0, 0.0]\n";
    let view = "view = \"-y\"\nazimuth = 20.0\ninputs = { volume = \"grid\" }\n";
    let mut hand = Hand::new(&TEXT.replace(eye, view));
    hand.settle();
    let at = middle(&hand);
    hand.drag(at, at + vec2(60.0, 0.0));
    hand.settle();
    let [x, y, z] = hand.numbers("view", "eye")[..] else { panic!("an eye") };
    // From where azimuth 20 sees the box of ± 10: before it, and turned some more.
    assert!(
        y < -30.0 && y > -60.0 && (x / -y - 20f64.to_radians().tan()).abs() > 0.1 && z.abs() < 1e-3,
        "{x} {y} {z}"
    );
    assert!(!hand.text().contains("view = \"-y\"") && !hand.text().contains("azimuth"), "{}", hand.text());
    assert_eq!(hand.steps(), 1);
}

#[test]
fn other_drags_and_the_wheel_do_what_the_sheet_says() {
    let mut hand = Hand::new(TEXT);
    let at = middle(&hand);
    hand.drag_with(at, at + vec2(40.0, 0.0), PointerButton::Primary, Modifiers::SHIFT);
    assert_ne!(hand.numbers("view", "target"), [0.0, 0.0, 0.0], "Shift-drag pans");
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.drag_with(at, at + vec2(0.0, 40.0), PointerButton::Middle, Modifiers::NONE);
    assert_ne!(hand.numbers("view", "target"), [0.0, 0.0, 0.0], "the middle button pans");
    hand.key(Key::Z, Modifiers::COMMAND);
    assert_eq!(hand.text(), TEXT);
    hand.move_to(at, Modifiers::NONE);
    let wheel = Event::MouseWheel {
        unit: eframe::egui::MouseWheelUnit::Line,
        delta: vec2(0.0, 2.0),
        phase: TouchPhase::Move,
        modifiers: Modifiers::NONE,
    };
    hand.frame(vec![wheel], Modifiers::NONE);
    hand.frames(20);
    let length = |v: Vec<f64>| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!(length(hand.numbers("view", "eye")) < 52.0, "the wheel zooms: {:?}", hand.numbers("view", "eye"));
    assert_eq!(hand.steps(), 1, "the smooth steps of a wheel are one");
}

#[test]
fn the_picture_follows_the_camera_and_typed_numbers_do_the_same() {
    let mut hand = Hand::new(TEXT);
    let picture = |hand: &Hand| hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    let before = picture(&hand);
    hand.key(Key::X, Modifiers::NONE);
    hand.settle();
    let eye = hand.numbers("view", "eye");
    assert!(eye[0] > 50.0 && eye[1].abs() < 1e-3 && eye[2].abs() < 1e-3, "seen from +x: {eye:?}");
    assert_ne!(picture(&hand), before);
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.settle();
    assert_eq!(picture(&hand), before, "undone, the picture is the same bit for bit");
}

#[test]
fn views_by_name_with_all_of_the_data_are_those_of_the_camera_node() {
    let eye = "eye = [-28.0, -38.0, 24.0]\ntarget = [0.0, 0.0, 0.0]\n";
    let mut hand = Hand::new(TEXT);
    for (name, item, button, key, held) in [
        (
            "isometric",
            "Isometric I",
            "seen from the positive sides of x, y and z alike",
            Key::I,
            Modifiers::NONE,
        ),
        ("-y", "From −y Shift+Y", "seen from −y", Key::Y, Modifiers::SHIFT),
        ("+z", "From +z Z", "seen from +z", Key::Z, Modifiers::NONE),
    ] {
        let words = format!("view = \"{name}\"\ninputs = {{ volume = \"grid\" }}\n");
        let stated = Hand::new(&TEXT.replace(eye, &words)).editor.view().unwrap();
        for way in 0..3 {
            match way {
                0 => hand.key(key, held),
                1 => {
                    hand.click_on("views");
                    hand.click_on(button);
                }
                _ => {
                    hand.click_on("View");
                    hand.click_on(item);
                }
            }
            hand.key(Key::H, Modifiers::NONE);
            let view = hand.editor.view().unwrap();
            // The file has six digits of the distance.
            let near = |a: glam::DVec3, b: glam::DVec3| (a - b).length() < 1e-5 * stated.eye.length();
            let is_it = near(view.eye, stated.eye) && near(view.target, stated.target);
            assert!(is_it && view.up.distance(stated.up) < 1e-5, "{name} {way}: {view:?}, {stated:?}");
            hand.key(Key::Z, Modifiers::COMMAND);
            hand.key(Key::Z, Modifiers::COMMAND);
            assert_eq!(hand.text(), TEXT, "{name} {way}: undone");
        }
    }
}

/// Until a probe answers.
fn answered(hand: &mut Hand) {
    for _ in 0..2000 {
        hand.frames(1);
        if hand.said().contains("ray") {
            return;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    panic!("no answer comes: {}", hand.said());
}

#[test]
fn a_click_finds_the_values_there_and_they_make_a_widget() {
    let mut hand = Hand::new(TEXT);
    let at = middle(&hand);
    hand.click(at);
    answered(&mut hand);
    let probed = hand.editor.scene().probed.clone().unwrap();
    let ([s, g], [[ss, _], [_, gg]]) = probed.moments().unwrap();
    // The widget that is drawn holds s from 90 to 210, and its middle is opaque.
    assert!((90.0..260.0).contains(&s) && g > 0.0 && ss > 0.0 && gg > 0.0, "{s} {g} {ss} {gg}");
    assert!(probed.opacity > 0.5, "{}", probed.opacity);
    assert!(probed.point.unwrap().length() < 18.0, "within the box: {:?}", probed.point);
    assert_eq!(hand.text(), TEXT, "looking changes nothing");
}

#[test]
fn a_double_click_makes_what_is_there_the_centre() {
    let mut hand = Hand::new(TEXT);
    let at = middle(&hand) + vec2(30.0, -20.0);
    hand.move_to(at, Modifiers::NONE);
    for _ in 0..2 {
        hand.button(true, PointerButton::Primary, Modifiers::NONE);
        hand.button(false, PointerButton::Primary, Modifiers::NONE);
    }
    for _ in 0..2000 {
        hand.frames(1);
        if hand.steps() > 0 {
            break;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let target = hand.numbers("view", "target");
    assert!(target.iter().any(|x| x.abs() > 0.5) && target.iter().all(|x| x.abs() <= 10.0), "{target:?}");
    assert_eq!(hand.steps(), 1);
}

/// A small picture of a node that is not shown at large comes once that one is there, which stays as it is.
#[test]
fn every_node_that_gives_a_picture_shows_it() {
    let counts = "[nodes.counts]\ntype = \"histogram\"\ninputs = { volume = \"gradient\" }\n\n[nodes.view]";
    let mut hand = Hand::new(&TEXT.replace("[nodes.view]", counts));
    assert_eq!(hand.editor.shown_node.as_deref(), Some("picture"));
    let shown = |hand: &Hand| hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().number);
    let before = shown(&hand);
    let preview = |hand: &mut Hand, node: &str, wide: &dyn Fn(usize) -> bool| {
        for _ in 0..4000 {
            hand.frames(1);
            let found = hand.editor.scene().previews.get(node).cloned();
            if let Some(pixels) = found.filter(|pixels| wide(pixels.size()[0])) {
                return pixels;
            }
            std::thread::sleep(Duration::from_millis(5));
        }
        panic!("no small picture of '{node}' comes");
    };
    let small = preview(&mut hand, "counts", &|_| true);
    assert_eq!(small.size(), [512, 512], "as many pixels as it has");
    assert!(small.image.pixels.iter().any(|pixel| *pixel != small.image.pixels[0]), "something is on it");
    assert_eq!(shown(&hand), before, "the large picture is not drawn again");
    transfer::with_distribution(&mut hand);
    assert!(hand.has_textures(4), "letters, the picture, the distribution, the small picture");
    // Shown at large, it gives its place in the node to the other.
    hand.editor.show_picture("counts");
    hand.settle();
    let small = preview(&mut hand, "picture", &|_| true);
    assert!(small.size()[0] <= 160, "{:?}", small.size());
    // What it follows from is another: so is it.
    let coarser = voltet_document::Edit::set(
        "counts",
        "bins",
        voltet_graph::ParameterValue::List(vec![voltet_graph::ParameterValue::Integer(64).into(); 2]),
    );
    hand.editor.show_picture("picture");
    hand.settle();
    hand.editor.edit("fewer bins".into(), &[coarser]);
    hand.settle();
    assert_eq!(preview(&mut hand, "counts", &|width| width < 512).size(), [128, 128]);
}

#[test]
fn a_picture_whose_camera_gives_no_size_has_that_of_its_pixels() {
    let mut hand = Hand::new(&TEXT.replace("size = [160, 120]\n", ""));
    hand.click_on("1:1");
    hand.settle();
    let pixels = hand.editor.scene().pixels.unwrap();
    assert!(pixels.is_full() && pixels.picture.width > 100);
    let shown = hand.editor.panels.picture.rect.unwrap().size();
    assert_eq!(shown, vec2(pixels.picture.width as f32, pixels.picture.height as f32));
}
