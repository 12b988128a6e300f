use super::*;
use crate::scene::Command;

/// A window with room for so much.
fn on(size: [f32; 2], pixels_per_point: f32, text: &str) -> Hand {
    let mut hand = Hand::new(text);
    hand.resize(size, pixels_per_point);
    hand.command(Command::FitGraph);
    hand.frames(4);
    hand.settle();
    hand
}

/// Texts that do not fit where they are shown; those that end with "…" by themselves do.
pub(super) fn cut(hand: &Hand) -> Vec<String> {
    fn of(shape: &Shape, clip: Rect, found: &mut Vec<String>) {
        match shape {
            Shape::Vec(shapes) => shapes.iter().for_each(|shape| of(shape, clip, found)),
            Shape::Text(text) if !text.galley.text().trim().is_empty() => {
                let rect = text.galley.rect.translate(text.pos.to_vec2());
                // What is scrolled out of view, above or below, is not cut.
                let is_seen = clip.y_range().contains(rect.center().y) && clip.intersects(rect);
                if is_seen && (rect.left() < clip.left() - 1.0 || rect.right() > clip.right() + 1.0) {
                    found.push(format!("{:?} at {rect:?} in {clip:?}", text.galley.text()));
                }
            }
            _ => {}
        }
    }
    let screen = hand.ctx.content_rect();
    let mut found = Vec::new();
    for clipped in hand.shapes() {
        of(&clipped.shape, clipped.clip_rect.intersect(screen), &mut found);
    }
    found
}

#[test]
fn no_text_is_cut_on_small_and_dense_screens() {
    for (size, density) in [
        ([900.0, 600.0], 1.0),
        ([1280.0, 720.0], 1.0),
        ([1280.0, 720.0], 1.5),
        ([1280.0, 720.0], 2.0),
        ([1920.0, 1080.0], 1.0),
    ] {
        let mut hand = on(size, density, TEXT);
        assert_eq!(hand.ctx.pixels_per_point(), density);
        for node in ["grid", "look", "view", "picture", "file"] {
            hand.editor.selection = [node.to_string()].into();
            hand.frames(3);
            assert_eq!(cut(&hand), [""; 0], "{size:?} {density} {node}");
        }
        for command in [Command::Help, Command::Costs] {
            hand.command(command);
            hand.frames(4);
            assert_eq!(cut(&hand), [""; 0], "{size:?} {density} {command:?}");
            hand.command(command);
        }
    }
}

#[test]
fn a_denser_screen_gets_a_picture_of_more_pixels() {
    let text = TEXT.replace("size = [160, 120]", "size = [2000, 1500]");
    let pixels = |density: f32| {
        let hand = on([1280.0, 720.0], density, &text);
        hand.editor.scene().pixels.unwrap().size()[0] as f32
    };
    let (usual, dense) = (pixels(1.0), pixels(2.0));
    assert!((dense / usual - 2.0).abs() < 0.02, "{usual} {dense}");
}

#[test]
fn nothing_is_shown_anew_while_nothing_happens() {
    let mut hand = Hand::new(TEXT);
    hand.frames(20);
    assert!(!hand.ctx.has_requested_repaint(), "{:?}", hand.ctx.repaint_causes());
}

#[test]
fn the_buttons_of_the_picture_stand_in_one_line() {
    let wide = ["Home", "+x", "iso", "box", "outline", "measure", "cut", "1:1", "remember", "section"];
    let middle = ["Home", "views", "probe", "measure", "cut", "1:1", "remember", "section"];
    for (size, shown) in [
        ([900.0, 600.0], &["Home", "views", "probe", "cut", "1:1", "remember"][..]),
        ([1280.0, 720.0], &middle),
        ([1600.0, 1000.0], &wide),
    ] {
        let hand = on(size, 1.0, TEXT);
        let places: Vec<f32> = shown.iter().flat_map(|text| hand.texts(text)).map(|at| at.y).collect();
        assert_eq!(places.len(), shown.len(), "{size:?}");
        assert!(places.iter().all(|y| (y - places[0]).abs() < 3.0), "{size:?} {places:?}");
    }
    let mut hand = on([900.0, 600.0], 1.0, TEXT);
    hand.click(hand.texts("views")[0]);
    hand.frames(2);
    hand.click_on("seen from +x");
    assert_eq!(hand.numbers("view", "eye")[1..], [0.0, 0.0], "{}", hand.text());
}

/// A window of 900 by 600 pixels at one and a half times and twice the usual size, with and without a line above all.
#[test]
fn panes_of_a_tiny_window_share_what_there_is() {
    for size in [[600.0, 400.0], [450.0, 300.0], [450.0, 255.0]] {
        let mut hand = on(size, 2.0, TEXT);
        transfer::with_distribution(&mut hand);
        let has_room = size[0] > 500.0;
        for node in ["grid", "look", "view", "picture", "file"] {
            hand.editor.selection = [node.to_string()].into();
            hand.frames(4);
            // Titles of so small nodes are cut.
            assert!(!has_room || cut(&hand).is_empty(), "{size:?} {node} {:?}", cut(&hand));
        }
        let (picture, pane) = (hand.editor.panels.picture.rect.unwrap(), hand.rect("picture picture"));
        assert!(picture.width() > 80.0 && picture.height() > 60.0, "{size:?}: {picture}");
        let plane = hand.rect("plane of s and g");
        assert!(plane.height() >= 39.0, "{size:?}: {plane}");
        let head = hand.texts("+ at peak")[0];
        assert!(pane.bottom() < head.y - 6.0 && plane.bottom() < size[1], "{size:?}: {pane} {head} {plane}");
        // Else it is scrolled to.
        assert!(!has_room || !hand.texts("extinction").is_empty(), "{size:?}");
        // No border of a pane at the left goes on at the right.
        let border = pane.left() - 8.0;
        let lines = hand.shapes().iter().filter_map(|clipped| match &clipped.shape {
            Shape::LineSegment { points: [from, to], .. } if from.y == to.y => {
                Some(Rect::from_two_pos(*from, *to).intersect(clipped.clip_rect))
            }
            _ => None,
        });
        let inside = |line: &Rect| line.center().y > pane.top() && line.center().y < plane.bottom();
        for line in lines.filter(inside) {
            assert!(line.left() > border - 2.0 || line.right() < border + 2.0, "{size:?}: {line} {border}");
        }
    }
}
