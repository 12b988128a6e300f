//! Handles in the picture: clips and slices, by the pointer and by keys.

use super::*;
use glam::DVec3;

/// The scene with lines more at its renderer.
fn with_clips(clips: &str) -> String {
    TEXT.replace("engine = \"cpu\"\n", &format!("engine = \"cpu\"\nclip = [{clips}]\n"))
}

const PLANE: &str = "{ kind = \"plane\", origin = [1.0, 2.0, -1.0], normal = [0.0, 0.0, 2.0] }";

/// A number of a clip.
fn of_clip(hand: &Hand, place: usize, key: &str) -> DVec3 {
    let nodes = &hand.editor.document().pipeline().nodes;
    let node = nodes.iter().find(|node| node.name == "picture").unwrap();
    let list = node.setting("clip").unwrap().list().unwrap().to_vec();
    let table = list[place].table().unwrap();
    let found = table.iter().find(|field| field.name == key).unwrap();
    match found.setting.number() {
        Some(number) => DVec3::splat(number),
        None => DVec3::from(found.setting.array::<3>().unwrap()),
    }
}

/// Place in the window of a point in space.
fn window(hand: &Hand, point: DVec3) -> Pos2 {
    let picture = hand.editor.panels.picture.rect.unwrap();
    let [x, y] = hand.editor.view().unwrap().place(point).unwrap();
    picture.center() + picture.height() * vec2(x as f32, -y as f32)
}

#[test]
fn a_plane_is_moved_along_its_normal_by_its_grip_in_one_step_and_the_picture_follows() {
    let text = with_clips(PLANE);
    let mut hand = Hand::new(&text);
    let picture = |hand: &Hand| hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
    let before = picture(&hand);
    let grip = hand.named("plane of clip: position");
    // The middle of the plane's cut with the data's box of ± 10.
    assert!(grip.distance(window(&hand, DVec3::new(0.0, 0.0, -1.0))) < 0.5, "{grip}");
    hand.drag(grip, window(&hand, DVec3::new(0.0, 0.0, 4.0)));
    let origin = of_clip(&hand, 0, "origin");
    assert!((origin - DVec3::new(1.0, 2.0, 4.0)).length() < 0.02, "along the normal alone: {origin}");
    assert_eq!(of_clip(&hand, 0, "normal"), DVec3::new(0.0, 0.0, 2.0));
    assert_eq!(hand.steps(), 1);
    assert!(
        hand.text().contains("origin = [1.0, 2.0, ") && hand.text().contains("# coarse"),
        "{}",
        hand.text()
    );
    hand.settle();
    assert_ne!(picture(&hand), before);
    hand.key(Key::Z, Modifiers::COMMAND);
    hand.settle();
    assert_eq!((hand.text(), picture(&hand)), (text, before));
}

/// A place that is not stated is a share of the data, and stays one when it is moved.
#[test]
fn what_a_clip_does_not_state_stays_a_share_of_the_data() {
    for (clip, grip, to, stated) in [
        (
            "plane\", normal = [0.0, 0.0, 2.0]",
            "plane of clip: position",
            DVec3::new(0.0, 0.0, 5.0),
            "origin = [\"50 %\", \"50 %\", \"7",
        ),
        (
            "box\"",
            "box of clip: upper z face",
            DVec3::new(5.0, 5.0, 5.0),
            "high = [\"100 %\", \"100 %\", \"7",
        ),
        ("sphere\", centre = [0.0, 0.0, 0.0]", "sphere of clip: radius", DVec3::ZERO, "radius = \"0."),
    ] {
        let mut hand = Hand::new(&with_clips(&format!("{{ kind = \"{clip} }}")));
        let from = hand.named(grip);
        hand.drag(from, window(&hand, to));
        let text = hand.text();
        assert!(text.contains(stated) && text.contains(" %\""), "{clip}: {text}");
        assert_eq!(hand.steps(), 1);
    }
}

/// The data of a clip at `composite` are those that are drawn, not those that a transfer function is relative to.
#[test]
fn a_clip_of_the_stages_lies_in_the_data_that_are_drawn() {
    let stages = "[nodes.other]\ntype = \"reader\"\npath = \"data.vtk\"\n\n\
        [nodes.cells]\ntype = \"cull\"\ninputs = { volume = \"gradient\", transfer_function = \"look\", camera = \"view\" }\n\n\
        [nodes.order]\ntype = \"sort\"\ninputs = { cells = \"cells\", camera = \"view\" }\n\n\
        [nodes.cover]\ntype = \"project\"\ninputs = { cells = \"order\", camera = \"view\" }\n\n\
        [nodes.picture]\ntype = \"composite\"\nclip = [{ kind = \"plane\" }]\n\
        inputs = { transfer_function = \"look\", projection = \"cover\" }\n\n[nodes.file]";
    let begin = &TEXT[..TEXT.find("[nodes.picture]").unwrap()];
    let end = &TEXT[TEXT.find("[nodes.file]").unwrap() + "[nodes.file]".len()..];
    let text = format!("{begin}{stages}{end}")
        .replace("\"transfer-function\"\n", "\"transfer-function\"\ninputs = { volume = \"other\" }\n")
        .replace("centre = [150.0, 20.0]", "centre = [\"50 %\", 20.0]");
    let data = "# vtk DataFile Version 3.0\ndata\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n50 0 0\n51 0 0\n50 1 0\n50 0 1\n\
                CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\nSCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4\n";
    let hand = Hand::with_file(&text, "data.vtk", data);
    let grip = hand.named("plane of clip: position");
    assert!(grip.distance(window(&hand, DVec3::ZERO)) < 0.5, "{grip}");
}

/// Slow frames hold the way to the grip and the press on it.
#[test]
fn a_press_in_the_frame_in_which_the_pointer_comes_moves_nothing() {
    let mut hand = Hand::new(&with_clips(PLANE));
    let grip = hand.named("plane of clip: position");
    hand.move_to(hand.named("node look"), Modifiers::NONE);
    hand.at = grip;
    let button = |pressed| Event::PointerButton {
        pos: grip,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    hand.frame(vec![Event::PointerMoved(grip), button(true)], Modifiers::NONE);
    hand.frames(2);
    hand.frame(vec![button(false)], Modifiers::NONE);
    assert_eq!(of_clip(&hand, 0, "origin"), DVec3::new(1.0, 2.0, -1.0));
    assert_eq!(hand.steps(), 0);
}

#[test]
fn the_tip_of_the_arrow_turns_a_plane_about_its_middle() {
    let mut hand = Hand::new(&with_clips(PLANE));
    let (middle, arrow) = (DVec3::new(0.0, 0.0, -1.0), 0.2 * 20.0 * 3f64.sqrt());
    let tip = hand.named("plane of clip: direction");
    assert!(tip.distance(window(&hand, middle + arrow * DVec3::Z)) < 0.5, "{tip}");
    let to = DVec3::new(-0.6, 0.0, 0.8);
    hand.drag(tip, window(&hand, middle + arrow * to));
    let (normal, origin) = (of_clip(&hand, 0, "normal"), of_clip(&hand, 0, "origin"));
    assert!((normal - to).length() < 0.02 && (normal.length() - 1.0).abs() < 1e-4, "{normal}");
    assert!((origin - middle).length() < 1e-3, "the grip stays in its middle: {origin}");
    assert_eq!(hand.steps(), 1);
}

#[test]
fn keys_move_what_has_the_focus_by_a_hundredth_of_the_diagonal() {
    let mut hand = Hand::new(&with_clips(PLANE));
    let selection = hand.editor.selection.clone();
    hand.click_on("plane of clip: position");
    assert_eq!(hand.steps(), 0, "a click moves nothing");
    hand.key(Key::ArrowUp, Modifiers::NONE);
    hand.frames(2);
    let step = 0.01 * 20.0 * 3f64.sqrt();
    let z = of_clip(&hand, 0, "origin").z;
    assert!((z + 1.0 - step).abs() < 1e-3, "{z}");
    hand.key(Key::ArrowLeft, Modifiers::ALT);
    hand.frames(2);
    let z = of_clip(&hand, 0, "origin").z;
    assert!((z + 1.0 - 0.8 * step).abs() < 1e-3, "with Alt a fifth back: {z}");
    assert_eq!(hand.editor.selection, selection, "the arrows choose no other node");
    assert_eq!(hand.steps(), 1, "keys that follow one another are one step");
}

#[test]
fn a_box_has_six_grips_a_ball_two_and_a_cylinder_three_and_none_is_moved_through_another() {
    let clips = "{ kind = \"box\", low = [-6.0, -6.0, -6.0], high = [6.0, 6.0, 6.0] }, \
                 { kind = \"sphere\", centre = [0.0, 0.0, 0.0], radius = 8.0 }, \
                 { kind = \"cylinder\", from = [0.0, 0.0, -9.0], to = [0.0, 0.0, 9.0], radius = 7.0 }";
    let mut hand = Hand::new(&with_clips(clips));
    assert!(!hand.sees("box of clip 1: upper x face"), "which of several is meant is not known");
    hand.editor.selection = ["picture".to_string()].into();
    hand.frames(3);
    for axis in ["x", "y", "z"] {
        assert!(hand.sees(&format!("box of clip 1: lower {axis} face")), "{axis}");
    }
    let face = hand.named("box of clip 1: upper z face");
    hand.drag(face, window(&hand, DVec3::new(0.0, 0.0, 8.0)));
    let high = of_clip(&hand, 0, "high");
    assert!(high.x == 6.0 && high.y == 6.0 && (high.z - 8.0).abs() < 0.05, "{high}");
    // Through the lower face: it stays above.
    hand.drag(hand.named("box of clip 1: upper z face"), window(&hand, DVec3::new(0.0, 0.0, -9.0)));
    let high = of_clip(&hand, 0, "high");
    assert!(high.z > -6.0 && high.z < -5.9, "{high}");
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    let rim = hand.named("sphere of clip 2: radius");
    let centre = hand.named("sphere of clip 2: centre");
    hand.drag(rim, centre + 0.5 * (rim - centre));
    assert!((of_clip(&hand, 1, "radius").x - 4.0).abs() < 0.05, "{}", of_clip(&hand, 1, "radius").x);
    hand.drag(hand.named("sphere of clip 2: centre"), centre + vec2(20.0, 0.0));
    let right = hand.editor.view().unwrap().sides().unwrap()[0];
    let moved = of_clip(&hand, 1, "centre");
    assert!(moved.length() > 1.0 && (moved.normalize() - right).length() < 1e-3, "{moved}");
    hand.drag(hand.named("cylinder of clip 3: end 2"), centre);
    assert!(of_clip(&hand, 2, "to").z < 9.0);
    assert!(hand.sees("cylinder of clip 3: radius"));
    assert_eq!(hand.steps(), 5);
}

const SLICE: &str = "[nodes.cut]\ntype = \"slice\"\norigin = [\"50 %\", 0.0, \"30 %\"]\nnormal = [0.0, 0.0, 1.0]\n\
                     inputs = { volume = \"gradient\" }\n\n[nodes.view]";

/// A slice in the scene's picture.
pub(super) fn with_slice() -> String {
    TEXT.replace("[nodes.view]", SLICE)
        .replace("camera = \"view\" }", "camera = \"view\", surfaces = [\"cut\"] }")
}

#[test]
fn a_slice_is_dragged_and_shares_of_the_data_stay_shares() {
    let mut hand = Hand::new(&with_slice());
    let grip = hand.named("plane of cut: position");
    assert!(grip.distance(window(&hand, DVec3::new(0.0, 0.0, -4.0))) < 0.5, "30 % of ± 10: {grip}");
    hand.drag(grip, window(&hand, DVec3::new(0.0, 0.0, 2.0)));
    let text = hand.text();
    let line = text.lines().find(|line| line.starts_with("origin")).unwrap();
    let rest = line.strip_prefix("origin = [\"50 %\", 0.0, \"").unwrap();
    let share: f64 = rest.strip_suffix(" %\"]").unwrap().parse().unwrap();
    assert!((share - 60.0).abs() < 0.2, "{line}");
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    // Beside a clip it is one of two: the selected node's has grips.
    let both = with_slice().replace("engine = \"cpu\"\n", &format!("engine = \"cpu\"\nclip = [{PLANE}]\n"));
    let mut hand = Hand::new(&both);
    assert!(!hand.sees("plane of cut: position") && !hand.sees("plane of clip: position"));
    hand.editor.selection = ["cut".to_string()].into();
    hand.frames(3);
    assert!(hand.sees("plane of cut: position") && !hand.sees("plane of clip: position"));
}

#[test]
fn texts_and_the_scale_of_an_annotation_are_brought_to_where_they_are_to_stand() {
    let figure = "[nodes.figure]\ntype = \"annotation\"\nbar_range = [0.0, 300.0] # by hand\n\
                  texts = [{ kind = \"point\", text = \"here\", at = [0.5, 0.5] }, { kind = \"border\", text = \"there\" }]\n\
                  inputs = { image = \"picture\", transfer_function = \"look\", volume = \"gradient\" }\n\n[nodes.file]";
    // Of a function of s alone the scale is a bar.
    let of_s = "kind = \"uniform\"\nregion = { s = [100.0, 200.0] }";
    let text = TEXT.replace("[nodes.file]", figure).replace("kind = \"gaussian\"", of_s);
    let text = text.replace("centre = [150.0, 20.0]\nsigma = [60.0, 40.0]\n", "");
    let mut hand = Hand::new(&text);
    assert!(!hand.sees("figure: bar"), "its node is not selected");
    hand.editor.selection = ["figure".to_string()].into();
    hand.frames(3);
    let picture = hand.editor.panels.picture.rect.unwrap();
    let grip = hand.named("figure: text 1");
    let beside = picture.center() - grip;
    assert!(beside.x > 6.0 && beside.y.abs() < 0.5, "the grip hides no letter: {beside}");
    hand.drag(grip, picture.left_top() + picture.size() * vec2(0.25, 0.75) - beside);
    hand.drag(hand.named("figure: text 2"), picture.right_top() + vec2(-30.0, 20.0));
    // Not far enough for another side.
    let bar = hand.named("figure: bar");
    hand.drag(bar, bar - vec2(30.0, 0.0));
    assert!(hand.steps() == 2 && !hand.text().contains("bar = "), "{}", hand.text());
    hand.drag(bar, picture.center_bottom() - vec2(0.0, 20.0));
    let written = hand.text();
    assert!(written.contains("at = [0.25, 0.75]") && written.contains("at = \"top-right\""), "{written}");
    assert!(written.contains("bar = \"bottom\"") && written.contains("# by hand"), "{written}");
    assert_eq!(hand.steps(), 3);
    hand.settle();
    assert!(hand.editor.scene().failure.is_none(), "{:?}", hand.editor.scene().failure);
    // By keys: the next place of three, a hundredth of the picture, the other side.
    for (name, key) in [("text 2", Key::ArrowLeft), ("text 1", Key::ArrowRight), ("bar", Key::ArrowUp)] {
        hand.click_on(&format!("figure: {name}"));
        hand.key(key, Modifiers::NONE);
        hand.frames(2);
    }
    let written = hand.text();
    assert!(written.contains("at = [0.26, 0.75]") && written.contains("at = \"top\""), "{written}");
    assert!(written.contains("bar = \"top\""), "{written}");
}

/// A plane that is seen face on has no way in the picture: up is along its normal, and the grip stays in the hand.
#[test]
fn a_plane_that_faces_the_eye_is_moved_steadily() {
    let plane =
        PLANE.replace("[1.0, 2.0, -1.0]", "[0.0, 0.0, 0.0]").replace("[0.0, 0.0, 2.0]", "[0.0, -1.0, 0.0]");
    let text = with_clips(&plane).replace("eye = [-28.0, -38.0, 24.0]", "eye = [0.0, -52.0, 0.0]");
    let mut hand = Hand::new(&text);
    let grip = hand.named("plane of clip: position");
    let height = hand.editor.panels.picture.rect.unwrap().height();
    hand.move_to(grip, Modifiers::NONE);
    hand.button(true, PointerButton::Primary, Modifiers::NONE);
    let mut before = 0.0;
    for step in 1..=9 {
        hand.move_to(grip - vec2(0.0, 0.05 * step as f32 * height), Modifiers::NONE);
        let towards = -of_clip(&hand, 0, "origin").y;
        // The picture is 27.9 high at the plane.
        assert!((towards - before - 0.05 * 27.87).abs() < 0.05, "{step}: from {before} to {towards}");
        before = towards;
    }
    let moves = |hand: &Hand| hand.editor.answers.asked.as_ref().unwrap().grip_moves;
    assert!(moves(&hand), "the picture follows the hand");
    hand.button(false, PointerButton::Primary, Modifiers::NONE);
    hand.frames(2);
    assert_eq!(hand.steps(), 1);
    let entry = voltet_graph::ParameterValue::List(Vec::new());
    hand.editor.edit("typed".into(), &[voltet_document::Edit::set("picture", ["clip"], entry)]);
    hand.frames(2);
    assert!(!moves(&hand), "what is typed is no movement");
}

#[test]
fn what_is_not_for_a_grip_is_for_the_picture_below_it() {
    let mut hand = Hand::new(&with_clips(PLANE));
    let grip = |hand: &Hand| hand.named("plane of clip: position");
    let view = |hand: &Hand| hand.editor.view().unwrap();
    for button in [PointerButton::Middle, PointerButton::Secondary] {
        let (before, at) = (view(&hand), grip(&hand));
        hand.drag_with(at, at + vec2(12.0, 20.0), button, Modifiers::NONE);
        assert_ne!(view(&hand), before, "{button:?}");
    }
    let (before, at) = (view(&hand), grip(&hand));
    hand.move_to(at, Modifiers::NONE);
    let unit = eframe::egui::MouseWheelUnit::Line;
    let (delta, phase, modifiers) = (vec2(0.0, 2.0), TouchPhase::Move, Modifiers::NONE);
    hand.frame(vec![Event::MouseWheel { unit, delta, phase, modifiers }], modifiers);
    hand.frames(10);
    assert_ne!(view(&hand), before, "the wheel");
    hand.settle();
    let at = grip(&hand);
    hand.click(at);
    until(&mut hand, "nothing is picked", |hand| hand.said().contains("on the ray"));
    assert_eq!(of_clip(&hand, 0, "origin"), DVec3::new(1.0, 2.0, -1.0));
    // A hand that measures, or draws a box, takes hold of none.
    for (mode, shown) in [("measure", false), ("measure", true), ("box", false), ("box", true)] {
        if mode == "box" {
            // In a menu, whose title is what was chosen.
            hand.click_on(if shown { "box" } else { "probe" });
        }
        hand.click(*hand.texts(mode).last().unwrap());
        hand.frames(2);
        assert_eq!(hand.sees("plane of clip: position"), shown, "{mode}");
    }
}

/// Shares of all steps of a series are found by a run alone.
#[test]
fn a_slice_by_shares_of_a_series_has_no_grips() {
    let of_series = with_slice().replace("type = \"slice\"", "type = \"slice\"\nrelative_to = \"series\"");
    assert!(!Hand::new(&of_series).sees("plane of cut: position"));
    let in_numbers = of_series.replace("[\"50 %\", 0.0, \"30 %\"]", "[0.0, 0.0, -4.0]");
    assert!(Hand::new(&in_numbers).sees("plane of cut: position"));
}

/// Places and lengths that are shares of the data stay shares, whichever grip is dragged.
#[test]
fn spheres_and_cylinders_by_shares_stay_shares_when_they_are_dragged() {
    let sphere = "sphere\", centre = [\"50 %\", \"50 %\", \"50 %\"], radius = \"20 %\"";
    let tube = "cylinder\", from = [\"50 %\", \"50 %\", \"20 %\"], to = [\"50 %\", \"50 %\", \"80 %\"], radius = \"10 %\"";
    for (clip, grip, key, texts) in [
        (sphere, "sphere of clip: centre", "centre", 3),
        (sphere, "sphere of clip: radius", "radius", 1),
        (tube, "cylinder of clip: end 1", "from", 3),
        (tube, "cylinder of clip: end 2", "to", 3),
        (tube, "cylinder of clip: radius", "radius", 1),
    ] {
        let mut hand = Hand::new(&with_clips(&format!("{{ kind = \"{clip} }}")));
        let before = hand.text();
        let from = hand.named(grip);
        hand.drag(from, from + vec2(12.0, -7.0));
        assert_eq!(shares_after(&hand, key), texts, "{grip}: {}", hand.text());
        assert!(hand.text() != before && hand.steps() == 1, "{grip}");
        hand.settle();
        assert!(hand.editor.scene().failure.is_none(), "{grip}: {:?}", hand.editor.scene().failure);
    }
}

/// Number of the shares that a parameter states.
fn shares_after(hand: &Hand, key: &str) -> usize {
    let text = hand.text();
    // Not of the widget.
    let text = &text[text.find("clip = ").or(text.find("[nodes.cut]")).unwrap()..];
    let after = &text[text.find(&format!("{key} = ")).unwrap()..];
    let end = if after.starts_with(&format!("{key} = [")) { ']' } else { '"' };
    // A length is one text.
    let length = after.match_indices(end).nth(usize::from(end == '"')).unwrap().0 + 1;
    after[..length].matches(" %\"").count()
}

#[test]
fn slices_on_spheres_and_cylinders_by_shares_stay_shares_when_they_are_dragged() {
    for (shape, grip, key, texts) in [
        ("sphere", "sphere of cut: centre", "origin", 2),
        ("sphere", "sphere of cut: radius", "radius", 1),
        ("cylinder", "cylinder of cut: position", "origin", 2),
        ("cylinder", "cylinder of cut: radius", "radius", 1),
    ] {
        let of = format!("type = \"slice\"\nshape = \"{shape}\"\nradius = \"20 %\"");
        let mut hand = Hand::new(&with_slice().replace("type = \"slice\"", &of));
        let from = hand.named(grip);
        hand.drag(from, from + vec2(12.0, -7.0));
        assert_eq!(shares_after(&hand, key), texts, "{grip}: {}", hand.text());
        assert_eq!(hand.steps(), 1, "{grip}");
        hand.settle();
        assert!(hand.editor.scene().failure.is_none(), "{grip}: {:?}", hand.editor.scene().failure);
    }
}

#[test]
fn the_menu_over_the_picture_cuts_the_volume_and_its_node_is_selected() {
    for (kind, grip) in [
        ("plane", "plane of clip: position"),
        ("box", "box of clip: upper z face"),
        ("sphere", "sphere of clip: radius"),
        ("cylinder", "cylinder of clip: end 1"),
    ] {
        let mut hand = Hand::new(TEXT);
        let opaque = |hand: &Hand| {
            let picture = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
            picture.rgba.iter().map(|pixel| f64::from(pixel[3])).sum::<f64>()
        };
        let whole = opaque(&hand);
        hand.click_on("cut");
        hand.click_on(kind);
        hand.settle();
        assert!(hand.editor.selection.contains("picture") && hand.editor.selection.len() == 1);
        assert!(hand.sees(grip), "{kind}: {}", hand.text());
        assert!(opaque(&hand) < 0.95 * whole, "{kind}: {} of {whole}", opaque(&hand));
        assert_eq!(hand.steps(), 1);
        // Another cut beside the first.
        hand.click_on("cut");
        hand.click_on(kind);
        hand.frames(3);
        assert_eq!(hand.text().matches(&format!("kind = \"{kind}\"")).count(), 2, "{}", hand.text());
        hand.key(Key::Z, Modifiers::COMMAND);
        hand.key(Key::Z, Modifiers::COMMAND);
        hand.settle();
        assert_eq!(hand.text(), TEXT);
    }
}

/// The pixel under the grip is one of the plane.
#[test]
fn the_grip_of_the_plane_of_colours_lies_on_it() {
    let figure = "[nodes.figure]\ntype = \"annotation\"\n\
                  inputs = { image = \"picture\", transfer_function = \"look\", volume = \"gradient\" }\n\n[nodes.file]";
    let text = TEXT.replace("[nodes.file]", figure).replace("size = [160, 120]", "size = [640, 480]");
    let mut hand = Hand::in_tall_window(&text);
    hand.editor.selection = ["figure".to_string()].into();
    hand.frames(3);
    let under_grip = |hand: &mut Hand| {
        hand.settle();
        let (grip, within) = (hand.named("figure: bar"), hand.editor.panels.picture.rect.unwrap());
        let drawn = hand.editor.worker().shown(|shown| shown.pixels.clone().unwrap().picture);
        let share = (grip - within.min) / within.size();
        let at = [share.x * drawn.width as f32, share.y * drawn.height as f32].map(|at| at as usize);
        (share, drawn.rgba[at[1] * drawn.width + at[0]])
    };
    for (bar, is_right) in [("right", true), ("bottom", true), ("left", false)] {
        hand.editor.edit("place".into(), &[voltet_document::Edit::set("figure", ["bar"], bar.into())]);
        hand.frames(2);
        let (share, pixel) = under_grip(&mut hand);
        assert!(share.y > 0.5 && (share.x > 0.5) == is_right, "{bar} {share}");
        assert_eq!(pixel[3], 1.0, "{bar}: the plane is opaque, unlike the picture there");
    }
    // A hand takes it to the other corner.
    let grip = hand.named("figure: bar");
    let middle = hand.editor.panels.picture.rect.unwrap().center();
    hand.drag(grip, pos2(2.0 * middle.x - grip.x, grip.y));
    assert!(hand.text().contains("bar = \"right\""), "{}", hand.text());
}

#[test]
fn words_over_the_picture_leave_a_grip_uncovered() {
    let figure = |at: &str| {
        let text = format!("{{ kind = \"point\", text = \"a\", at = {at}, align = \"end\" }}");
        let inputs = "inputs = { image = \"picture\" }";
        let node =
            format!("[nodes.figure]\ntype = \"annotation\"\ntexts = [{text}]\n{inputs}\n\n[nodes.file]");
        TEXT.replace("[nodes.file]", &node)
    };
    for (at, is_at_top) in [("[0.5, 0.5]", true), ("[0.9, 0.04]", false)] {
        let mut hand = Hand::in_tall_window(&figure(at));
        hand.editor.selection = ["figure".to_string()].into();
        hand.frames(3);
        let picture = hand.editor.panels.picture.rect.unwrap();
        hand.move_to(picture.center() + vec2(15.0, 15.0), Modifiers::NONE);
        hand.pause = 0.2;
        until(&mut hand, "nothing is found", |hand| hand.editor.scene().hovered.is_some());
        hand.frames(2);
        let words = hand.shown(&|text| text.contains("   at ("));
        assert_eq!((words.len(), words[0].y < picture.center().y), (1, is_at_top), "{at} {words:?}");
    }
}
