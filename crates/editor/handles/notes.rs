//! Parts of an annotation: the scale of the colours, which stands at a border or as a plane in a lower corner, and texts at a border or at a point.

use super::movable::Movable;
use crate::scene::Scene;
use crate::transfer::looks_at_g;
use std::rc::Rc;
use voltet_core::arithmetic::decimal;
use voltet_document::links::upstream;
use voltet_document::{Edit, Path};
use voltet_figure::font_size;
use voltet_figure::scale::plane_size;
use voltet_graph::{Field, LocatedValue, NodeEntry, ParameterValue, find_setting};

/// Distance of the grip of a bar from its border, and of that of a text, which stands farther in; heights of the picture.
const MARGIN: f64 = 0.05;
const TEXT_MARGIN: f64 = 0.012;

/// Distance of the plane from the sides and the lower border, where its numbers and names stand, heights of letters.
const BESIDE_PLANE: f64 = 1.4;
const BELOW_PLANE: f64 = 4.0;

/// Distance of a grip from the point where a text stands, heights of the picture: it hides no letter.
const GRIP_DISTANCE: f64 = 0.025;

/// Step of the keys, and of written places, as shares of the picture.
const STEP: f64 = 0.01;
const WRITTEN: f64 = 1e-3;

/// Position of a part.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Anchor {
    /// At a side: -1, 0 or 1 to the right and up.
    Bar([i8; 2]),
    /// The plane of s and g in the lower right corner, or in the left one where the parameter says so; and its middle in the right one,
    /// heights to the right and up.
    Plane([i8; 2], [f64; 2]),
    /// In a corner or at the middle of a side, alike.
    Border([i8; 2]),
    /// Shares of width and height, from the upper left corner; and the way from there to the grip, heights to the right and up.
    Point([f64; 2], [f64; 2]),
}

/// The annotation of a node.
struct Note {
    node: String,
    /// Its parts: name, the parameter that places it, whether that is stated, and the place.
    parts: Vec<(String, Path, bool, Anchor)>,
    /// Width of the picture by its height.
    aspect: f64,
}

/// Words for sides; the first of up and down, the second of left and right.
fn side(word: &str) -> [i8; 2] {
    let sign = |low: &str, high: &str| i8::from(word.contains(high)) - i8::from(word.contains(low));
    [sign("left", "right"), sign("bottom", "top")]
}

fn word([right, up]: [i8; 2]) -> String {
    let words = [["bottom", "", "top"][(up + 1) as usize], ["left", "", "right"][(right + 1) as usize]];
    words.into_iter().filter(|word| !word.is_empty()).collect::<Vec<_>>().join("-")
}

/// The annotations among these nodes, in a picture of that width by its height.
pub(super) fn objects<'a>(scene: &Scene, nodes: impl Iterator<Item = &'a NodeEntry>) -> Vec<Rc<dyn Movable>> {
    let size = scene.picture_size.unwrap_or([1024, 768]);
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    let note = |node: &NodeEntry| {
        let parts = parts(node, aspect, plane(scene, node, size));
        Note { node: node.name.clone(), parts, aspect }
    };
    let annotations = nodes.filter(|node| node.node_type.text() == Some("annotation"));
    annotations.map(|node| Rc::new(note(node)) as Rc<dyn Movable>).collect()
}

/// Middle of the plane of s and g in the lower right corner of a picture of this size, heights to the right and up; `None` where the scale of
/// the annotation is a bar.
fn plane(scene: &Scene, node: &NodeEntry, size: [u32; 2]) -> Option<[f64; 2]> {
    let link = node.inputs.iter().find(|link| link.port == "transfer_function")?;
    let giving = scene.giving(link.source.text()?).0;
    let nodes = &scene.document.pipeline().nodes;
    let feeding = upstream(nodes, giving);
    nodes.iter().filter(|node| feeding.contains(&node.name)).find(|node| looks_at_g(node))?;
    let height = f64::from(size[1]);
    let scale = node.setting("scale").and_then(LocatedValue::number).unwrap_or(1.0);
    let letters = scale * f64::from(font_size(size.map(|length| length as usize))) / height;
    let [width, high] = plane_size(size.map(|length| length as f32)).map(|length| f64::from(length) / height);
    let right = 0.5 * f64::from(size[0]) / height - BESIDE_PLANE * letters - 0.5 * width;
    Some([right, BELOW_PLANE * letters + 0.5 * high - 0.5])
}

fn parts(node: &NodeEntry, aspect: f64, plane: Option<[f64; 2]>) -> Vec<(String, Path, bool, Anchor)> {
    let mut parts = Vec::new();
    let stated = node.setting("bar").and_then(LocatedValue::text);
    let has_scale = node.inputs.iter().any(|link| link.port == "transfer_function");
    let at = side(stated.unwrap_or("right"));
    if has_scale && at != [0, 0] {
        let anchor = plane.map_or(Anchor::Bar(at), |middle| Anchor::Plane(at, middle));
        parts.push(("bar".into(), Path::from("bar"), stated.is_some(), anchor));
    }
    let texts = node.setting("texts").and_then(LocatedValue::list).unwrap_or_default();
    for (place, text) in texts.iter().enumerate() {
        let fields = text.table().unwrap_or_default();
        if let Some(anchor) = anchor(fields, aspect) {
            let path = Path::from("texts").with(place).with("at");
            parts.push((format!("text {}", place + 1), path, find_setting(fields, "at").is_some(), anchor));
        }
    }
    parts
}

/// The place of a text, in a picture of that width by its height.
fn anchor(text: &[Field], aspect: f64) -> Option<Anchor> {
    let at = find_setting(text, "at");
    match find_setting(text, "kind")?.text()? {
        "border" => Some(Anchor::Border(side(at.and_then(LocatedValue::text).unwrap_or("bottom-left")))),
        "point" => {
            // The letters are to the right of the point, to its left, or on both sides.
            let beside = match find_setting(text, "align").and_then(LocatedValue::text) {
                Some("middle") => [0.0, GRIP_DISTANCE],
                Some("end") => [GRIP_DISTANCE, 0.0],
                _ => [-GRIP_DISTANCE, 0.0],
            };
            let shares = at?.array()?;
            let (point, most) = (from_middle(shares, aspect), farthest(aspect, TEXT_MARGIN));
            // A hand reaches what is in the picture alone.
            let grip = |k: usize| (point[k] + beside[k]).clamp(-most[k], most[k]);
            Some(Anchor::Point(shares, [0, 1].map(|k| grip(k) - point[k])))
        }
        _ => None,
    }
}

/// A point by shares of width and height from the upper left corner, as heights from the middle to the right and up.
fn from_middle([right, down]: [f64; 2], aspect: f64) -> [f64; 2] {
    [(right - 0.5) * aspect, 0.5 - down]
}

/// Distances from the middle to the right and up at which the border is `margin` away, heights of the picture.
fn farthest(aspect: f64, margin: f64) -> [f64; 2] {
    [0.5 * aspect - margin, 0.5 - margin]
}

/// The side that a plane is to have for the left corner (-1) or the right one (1): the one that it has where that means the same.
fn corner_of_plane(side: [i8; 2], right: i8) -> [i8; 2] {
    if (side[0] < 0) == (right < 0) { side } else { [right, 0] }
}

impl Note {
    fn place(&self, anchor: Anchor) -> [f64; 2] {
        match anchor {
            Anchor::Bar(side) | Anchor::Border(side) => {
                let margin = if matches!(anchor, Anchor::Bar(_)) { MARGIN } else { TEXT_MARGIN };
                let half = farthest(self.aspect, margin);
                [0, 1].map(|k: usize| f64::from(side[k]) * half[k])
            }
            Anchor::Plane([right, _], [x, y]) => [if right < 0 { -x } else { x }, y],
            Anchor::Point(shares, beside) => {
                let point = from_middle(shares, self.aspect);
                [0, 1].map(|k: usize| point[k] + beside[k])
            }
        }
    }

    /// The anchor of the same kind that is nearest to a place.
    fn nearest(&self, anchor: Anchor, [x, y]: [f64; 2]) -> Anchor {
        // Halves of the sides, from the middle.
        let shares = [2.0 * x / self.aspect, 2.0 * y];
        let beside = |k: usize| if shares[k] < 0.0 { -1 } else { 1 };
        let is_across = shares[0].abs() > shares[1].abs();
        let nearest_side = if is_across { [beside(0), 0] } else { [0, beside(1)] };
        match anchor {
            Anchor::Bar(_) => Anchor::Bar(nearest_side),
            Anchor::Plane(side, middle) => Anchor::Plane(corner_of_plane(side, beside(0)), middle),
            Anchor::Border(_) => {
                let third = [0, 1].map(|k: usize| if shares[k].abs() < 1.0 / 3.0 { 0 } else { beside(k) });
                Anchor::Border(if third == [0, 0] { nearest_side } else { third })
            }
            Anchor::Point(_, beside) => {
                let share = |x: f64| decimal(x.clamp(0.0, 1.0), WRITTEN);
                let shares = [share((x - beside[0]) / self.aspect + 0.5), share(0.5 - (y - beside[1]))];
                Anchor::Point(shares, beside)
            }
        }
    }

    /// The anchor after keys: one step to the right and up. Sides are stepped from one to the next, also with Alt.
    fn stepped(&self, anchor: Anchor, by: [f64; 2]) -> Anchor {
        let step = by.map(|x| if x == 0.0 { 0 } else { x.signum() as i8 });
        match anchor {
            Anchor::Bar(_) if step[0] != 0 => Anchor::Bar([step[0], 0]),
            Anchor::Bar(_) => Anchor::Bar(step),
            Anchor::Plane(side, middle) if step[0] != 0 => {
                Anchor::Plane(corner_of_plane(side, step[0]), middle)
            }
            Anchor::Plane(..) => anchor,
            Anchor::Border(side) => {
                let on = |side: [i8; 2]| [0, 1].map(|k: usize| (side[k] + step[k]).clamp(-1, 1));
                let next = on(side);
                Anchor::Border(if next == [0, 0] { on(next) } else { next })
            }
            Anchor::Point(..) => {
                let [x, y] = self.place(anchor);
                self.nearest(anchor, [x + STEP * self.aspect * by[0], y + STEP * by[1]])
            }
        }
    }

    fn edits(&self, part: usize, to: impl Fn(Anchor) -> Anchor) -> Vec<Edit> {
        let Some((_, path, is_stated, before)) = self.parts.get(part) else { return Vec::new() };
        let after = to(*before);
        let (node, path) = (self.node.clone(), path.clone());
        vec![match after {
            // As the file leaves it out.
            _ if after == *before && !is_stated => Edit::Unset { node, path },
            Anchor::Bar(side) | Anchor::Plane(side, _) | Anchor::Border(side) => {
                Edit::Set { node, path, value: ParameterValue::Text(word(side)) }
            }
            Anchor::Point(shares, _) => Edit::Set { node, path, value: shares.into_iter().collect() },
        }]
    }
}

impl Movable for Note {
    fn node(&self) -> &str {
        &self.node
    }

    fn places(&self) -> Vec<(String, Option<[f64; 2]>)> {
        self.parts.iter().map(|(name, _, _, anchor)| (name.clone(), Some(self.place(*anchor)))).collect()
    }

    fn moved(&self, grip: usize, to: [f64; 2]) -> Vec<Edit> {
        self.edits(grip, |anchor| self.nearest(anchor, to))
    }

    fn nudged(&self, grip: usize, by: [f64; 2]) -> Vec<Edit> {
        let stays = |anchor: &Anchor| self.stepped(*anchor, by) == *anchor;
        match self.parts.get(grip) {
            Some((_, _, _, anchor)) if stays(anchor) => Vec::new(),
            _ => self.edits(grip, |anchor| self.stepped(anchor, by)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_sides_come_back() {
        for at in ["top-left", "top", "top-right", "left", "right", "bottom-left", "bottom", "bottom-right"] {
            assert_eq!(word(side(at)), at);
        }
    }

    #[test]
    fn keys_lead_from_each_place_at_the_border_to_the_next_also_with_alt() {
        let note = Note { node: "figure".into(), parts: Vec::new(), aspect: 1.5 };
        let keys = [[-1.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
        // Left, right, up, down.
        for (from, to) in [
            ("top-left", ["top-left", "top", "top-left", "left"]),
            ("top", ["top-left", "top-right", "top", "bottom"]),
            ("top-right", ["top", "top-right", "top-right", "right"]),
            ("left", ["left", "right", "top-left", "bottom-left"]),
            ("right", ["left", "right", "top-right", "bottom-right"]),
            ("bottom-left", ["bottom-left", "bottom", "left", "bottom-left"]),
            ("bottom", ["bottom-left", "bottom-right", "top", "bottom"]),
            ("bottom-right", ["bottom", "bottom-right", "right", "bottom-right"]),
        ] {
            for (key, to) in keys.into_iter().zip(to) {
                for times in [1.0, 0.2] {
                    let Anchor::Border(at) = note.stepped(Anchor::Border(side(from)), key.map(|x| times * x))
                    else {
                        panic!("another kind of place")
                    };
                    assert_eq!(word(at), to, "{from} {key:?}");
                }
            }
        }
        for from in ["left", "right", "top", "bottom"] {
            let to = keys.map(|key| note.stepped(Anchor::Bar(side(from)), key.map(|x| 0.2 * x)));
            assert_eq!(to, ["left", "right", "top", "bottom"].map(|at| Anchor::Bar(side(at))), "{from}");
        }
        let text = Anchor::Point([0.5, 0.25], [-GRIP_DISTANCE, 0.0]);
        let Anchor::Point(at, _) = note.stepped(text, [0.2, -1.0]) else { panic!() };
        assert!((at[0] - 0.502).abs() < 1e-9 && (at[1] - 0.26).abs() < 1e-9, "{at:?}");
        // A grip that is let go of where it stands leaves the text there.
        assert_eq!(note.nearest(text, note.place(text)), text);
    }

    #[test]
    fn grips_stand_beside_the_letters() {
        assert_eq!(
            ["start", "middle", "end"].map(|align| placed([0.5, 0.5], align).0),
            [[-GRIP_DISTANCE, 0.0], [0.0, GRIP_DISTANCE], [GRIP_DISTANCE, 0.0]]
        );
    }

    /// Place of the grip of a text at a point of a picture of 1.5 by 1, and whether it leaves the text there where it is let go of.
    fn placed(at: [f64; 2], align: &str) -> ([f64; 2], bool) {
        let field = |(name, value): (&str, ParameterValue)| Field::new(name, value);
        let at = ParameterValue::from_iter(at);
        let text = [("kind", "point".into()), ("at", at), ("align", align.into())].map(field);
        let note = Note { node: "figure".into(), parts: Vec::new(), aspect: 1.5 };
        let anchor = anchor(&text, note.aspect).unwrap();
        (note.place(anchor), note.nearest(anchor, note.place(anchor)) == anchor)
    }

    #[test]
    fn grips_of_texts_at_the_border_stay_in_the_picture() {
        for align in ["start", "middle", "end"] {
            for at in [[0.0, 0.0], [0.0, 0.5], [0.5, 0.0], [1.0, 0.5], [0.5, 1.0], [1.0, 1.0]] {
                let ([x, y], stays) = placed(at, align);
                assert!(x.abs() < 0.75 && y.abs() < 0.5 && stays, "{align} {at:?}: {x} {y} {stays}");
            }
        }
    }
}
