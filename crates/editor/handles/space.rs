//! Clips and slices in space: what their node states, the lines that show them over the picture, and their grips. A plane is shown by its cut
//! with the box of the data.

use super::movable::Movable;
use crate::scene::Scene;
use crate::view::View;
use glam::DVec3;
use std::collections::BTreeSet;
use std::f64::consts::TAU;
use std::rc::Rc;
use voltet_core::arithmetic::{decimal, unit_vector};
use voltet_core::clip::ClipShape;
use voltet_core::grid::extent::{corners, diagonal};
use voltet_document::{Edit, Path, links};
use voltet_graph::{
    Field, LinkEntry, LocatedValue, NodeEntry, Parameter, ParameterType, ParameterValue, Parameters,
    PortType, Relative, SourceSpan, find_setting,
};
use voltet_nodes::drawing::{CLIP, clips};
use voltet_nodes::relative::{DataScope, RELATIVE_TO, placed};

/// Length of the arrow along a normal, and a step of the keys, as shares of the diagonal of the data.
const ARROW: f64 = 0.2;
const STEP: f64 = 0.01;

/// Longest way of a drag along a line, diagonals.
const REACH: f64 = 3.0;

/// Least radius and least side of a box, and the step of written numbers, as shares of the diagonal.
const MIN_SIZE: f64 = 1e-3;
const WRITTEN: f64 = 1e-5;

/// Pieces of a circle.
const ROUND: usize = 48;

/// Ends of the edges of a box, as corners are numbered.
const EDGES: [[usize; 2]; 12] =
    [[0, 1], [2, 3], [4, 5], [6, 7], [0, 2], [1, 3], [4, 6], [5, 7], [0, 4], [1, 5], [2, 6], [3, 7]];

#[derive(Debug, Clone, Copy, PartialEq)]
enum Part {
    Position,
    Direction,
    /// Face of a box: its axis, and true for the upper one.
    Face(usize, bool),
    Radius,
    End(usize),
}

/// Movement of a grip.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Motion {
    /// Along a unit direction.
    Along(DVec3),
    /// About a point.
    About(DVec3),
    /// In the plane that is parallel to the picture.
    Aside,
}

/// Part of space of a clip, or surface of a slice, world units.
#[derive(Debug, Clone, Copy, PartialEq)]
enum StatedShape {
    /// As of a clip.
    Clip(ClipShape),
    /// A cylinder without ends.
    Tube { origin: DVec3, axis: DVec3, radius: f64 },
}

struct Object {
    node: String,
    name: String,
    /// Place of its parameters in those of the node.
    path: Path,
    /// Its parameters as the file states them, and standard values for places that it does not state.
    stated: Vec<Field>,
    /// True for a slice, whose parameters have other names: a sphere's centre is its origin.
    is_slice: bool,
    shape: StatedShape,
    /// Least and greatest coordinates of the data that it cuts.
    bounds: [DVec3; 2],
    view: View,
}

/// Clips and slices of these nodes, as far as they are stated soundly and the data are known.
pub(super) fn objects<'a>(
    scene: &Scene,
    view: View,
    nodes: impl Iterator<Item = &'a NodeEntry> + Clone,
) -> Vec<Rc<dyn Movable>> {
    let has_clips = |node: &&NodeEntry| {
        let is_declared = scene.node_type(node).is_some_and(|known| known.parameter(CLIP.name).is_some());
        is_declared && node.setting(CLIP.name).is_some()
    };
    let several = nodes.clone().filter(has_clips).count() > 1;
    let mut found: Vec<Rc<dyn Movable>> = Vec::new();
    for node in nodes {
        let Some(bounds) = bounds_at(scene, node) else { continue };
        let mut add = |title: &str, path: Path, stated: &[Field], is_slice: bool| {
            let shape = if is_slice { slice_shape(stated, bounds) } else { clip_shape(stated, bounds) };
            let Some(shape) = shape else { return };
            let declared = if is_slice {
                scene.node_type(node).map(|known| known.parameters)
            } else {
                clip_kind(stated)
            };
            let (name, node) = (format!("{} of {title}", word(&shape)), node.name.clone());
            found.push(Rc::new(Object {
                node,
                name,
                path,
                stated: with_standard_places(stated, declared.unwrap_or_default()),
                is_slice,
                shape,
                bounds,
                view,
            }));
        };
        let list = node.setting(CLIP.name).and_then(LocatedValue::list).filter(|_| has_clips(&node));
        let list = list.unwrap_or_default();
        for (place, entry) in list.iter().enumerate() {
            let number = if list.len() > 1 { format!(" {}", place + 1) } else { String::new() };
            let of = if several { format!(" of {}", node.name) } else { String::new() };
            let path = Path::from(CLIP.name).with(place);
            add(&format!("clip{number}{of}"), path, entry.table().unwrap_or_default(), false);
        }
        // Shares of what several steps of a series give are numbers of a run alone.
        let is_known = data_scope(node) == DataScope::Step || is_of_numbers(&node.settings);
        if matches!(node.node_type.text(), Some("slice" | "slice-image")) && is_known {
            add(&node.name, Path::default(), &node.settings, true);
        }
    }
    found
}

fn clip_kind(stated: &[Field]) -> Option<&'static [Parameter]> {
    let ParameterType::Kinds(kinds) = CLIP.parameter_type else { return None };
    let kind = find_setting(stated, "kind").and_then(LocatedValue::text)?;
    kinds.iter().find(|known| known.name == kind).map(|known| known.parameters)
}

/// Fields with the standard values of the places and lengths that they do not state: shares of the data stay shares when they are moved.
fn with_standard_places(stated: &[Field], declared: &[Parameter]) -> Vec<Field> {
    let is_silent = |parameter: &&Parameter| {
        matches!(parameter.parameter_type, ParameterType::Measured(_))
            && find_setting(stated, parameter.name).is_none()
    };
    let standard = declared
        .iter()
        .filter(is_silent)
        .filter_map(|parameter| parameter.default.datum().map(|datum| Field::new(parameter.name, datum)));
    stated.iter().cloned().chain(standard).collect()
}

/// The data that a slice's shares refer to.
fn data_scope(node: &NodeEntry) -> DataScope {
    let stated = node.setting(RELATIVE_TO.name).and_then(LocatedValue::text);
    stated.map(DataScope::from_word).unwrap_or_default()
}

/// True if a slice's place is stated in numbers alone.
fn is_of_numbers(stated: &[Field]) -> bool {
    let is_number = |setting: &LocatedValue| setting.text().is_none();
    let radius = find_setting(stated, "radius").is_none_or(is_number);
    let origin = find_setting(stated, "origin").and_then(LocatedValue::list);
    radius && origin.is_some_and(|origin| origin.iter().all(is_number))
}

/// Lowest and highest coordinates of the volume that comes to a node: the nearest known on its way, not of other inputs, such as that of a
/// transfer function.
fn bounds_at(scene: &Scene, node: &NodeEntry) -> Option<[DVec3; 2]> {
    let (mut node, mut seen) = (node, BTreeSet::new());
    while seen.insert(&node.name) {
        let is_drawn = |link: &&LinkEntry| {
            let ports = scene.node_type(node).map_or(&[][..], |known| known.inputs);
            ports.iter().any(|port| port.name == link.port && DRAWN.contains(&port.port_type))
        };
        let link = node.inputs.iter().find(is_drawn)?;
        let (name, output, _) = scene.giving(links::sources(link).next()?);
        match scene.bounds.get(&format!("{name}.{output}")) {
            Some(found) => return Some(*found),
            None => node = scene.entry(name)?,
        }
    }
    None
}

/// Types of ports by which a volume reaches the node that draws it.
const DRAWN: [PortType; 4] = [PortType::Grid, PortType::Volume, PortType::Cells, PortType::Projection];

/// A point that a parameter states, in numbers or shares of the bounds.
fn point(stated: &[Field], key: &str, [low, high]: [DVec3; 2]) -> Option<DVec3> {
    let list = find_setting(stated, key)?.list()?;
    let number = |(axis, setting): (usize, &LocatedValue)| match (
        setting.number(),
        setting.text().and_then(Relative::parse),
    ) {
        (Some(number), _) => Some(number),
        (None, Some(Relative::Share(share))) => Some(Relative::at_share(share, [low[axis], high[axis]])),
        _ => None,
    };
    let numbers: Option<Vec<f64>> = list.iter().enumerate().take(3).map(number).collect();
    let numbers: [f64; 3] = numbers?.try_into().ok()?;
    Some(DVec3::from(numbers)).filter(|point| point.is_finite() && list.len() == 3)
}

/// The parameter `clip` with this list. Errors: one of the clips is not sound.
pub(crate) fn clip_parameters(list: LocatedValue) -> voltet_core::Result<Parameters> {
    Parameters::check(&[CLIP], &[Field::new(CLIP.name, list)], &SourceSpan::Nowhere, &[])
}

/// The shape that a clip states; `None` of one that is not sound.
fn clip_shape(stated: &[Field], bounds: [DVec3; 2]) -> Option<StatedShape> {
    let entry = LocatedValue::from(ParameterValue::Table(stated.to_vec()));
    let p = clip_parameters(ParameterValue::List(vec![entry]).into()).ok()?;
    let shape = clips(&placed(&p, Some(bounds)).ok()?).ok()?.first()?.shape;
    Some(StatedShape::Clip(match shape {
        ClipShape::Plane { origin, normal } => ClipShape::Plane { origin, normal: unit_vector(normal) },
        other => other,
    }))
}

/// The shape that a slice states; `None` of one that is not sound.
fn slice_shape(stated: &[Field], bounds: [DVec3; 2]) -> Option<StatedShape> {
    let at_or = |key: &str, usual: DVec3| match find_setting(stated, key) {
        None => Some(usual),
        Some(_) => point(stated, key, bounds),
    };
    let origin = at_or("origin", 0.5 * (bounds[0] + bounds[1]))?;
    let axis = unit_vector(at_or("normal", DVec3::X)?);
    let radius = || {
        let setting = find_setting(stated, "radius")?;
        let of_diagonal = match setting.text().and_then(Relative::parse) {
            Some(Relative::Share(share)) => Some(share * diagonal(bounds)),
            _ => None,
        };
        setting.number().or(of_diagonal)
    };
    let shape = match find_setting(stated, "shape").and_then(LocatedValue::text) {
        Some("sphere") => ClipShape::Sphere { centre: origin, radius: radius()? },
        Some("cylinder") => {
            let radius = radius()?;
            let is_sound = axis != DVec3::ZERO && radius > 0.0 && radius.is_finite();
            return is_sound.then_some(StatedShape::Tube { origin, axis, radius });
        }
        _ => ClipShape::Plane { origin, normal: axis },
    };
    shape.check().is_ok().then_some(StatedShape::Clip(shape))
}

fn word(shape: &StatedShape) -> &'static str {
    match shape {
        StatedShape::Clip(ClipShape::Plane { .. }) => "plane",
        StatedShape::Clip(ClipShape::Box { .. }) => "box",
        StatedShape::Clip(ClipShape::Sphere { .. }) => "sphere",
        StatedShape::Clip(ClipShape::Cylinder { .. }) | StatedShape::Tube { .. } => "cylinder",
    }
}

/// Corners of the cut of a plane with a box, in their order around it; none where it does not cut it.
fn cut([low, high]: [DVec3; 2], origin: DVec3, normal: DVec3) -> Vec<DVec3> {
    let points = corners([low, high]);
    let aside = points.map(|point| (point - origin).dot(normal));
    let crossing = |[a, b]: [usize; 2]| {
        let is_cut = (aside[a] < 0.0) != (aside[b] < 0.0);
        is_cut.then(|| points[a].lerp(points[b], aside[a] / (aside[a] - aside[b])))
    };
    let mut found: Vec<DVec3> = EDGES.into_iter().filter_map(crossing).collect();
    let middle = found.iter().sum::<DVec3>() / found.len().max(1) as f64;
    let (right, up) = normal.any_orthonormal_pair();
    let angle = |point: &DVec3| (*point - middle).dot(up).atan2((*point - middle).dot(right));
    found.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
    found
}

fn circle(centre: DVec3, axis: DVec3, radius: f64) -> Vec<DVec3> {
    let (right, up) = axis.any_orthonormal_pair();
    let at = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / ROUND as f64).sin_cos();
        centre + radius * (cos * right + sin * up)
    };
    (0..=ROUND).map(at).collect()
}

/// Both ends of a cylinder, and lines between them.
fn cylinder([from, to]: [DVec3; 2], radius: f64) -> Vec<Vec<DVec3>> {
    let axis = unit_vector(to - from);
    let ends = [from, to].map(|end| circle(end, axis, radius));
    let side = |k: usize| ends.each_ref().map(|end| end[k * ROUND / 4]).to_vec();
    let sides: Vec<Vec<DVec3>> = (0..4).map(side).collect();
    ends.into_iter().chain(sides).collect()
}

impl Object {
    fn size(&self) -> f64 {
        diagonal(self.bounds)
    }

    /// The middle of a plane's cut with the data; of one beside them, the point nearest to their middle.
    fn middle(&self, origin: DVec3, normal: DVec3) -> DVec3 {
        let cut = cut(self.bounds, origin, normal);
        if cut.len() < 3 {
            let middle = 0.5 * (self.bounds[0] + self.bounds[1]);
            return middle - (middle - origin).dot(normal) * normal;
        }
        cut.iter().sum::<DVec3>() / cut.len() as f64
    }

    /// Ends of what is shown of a cylinder without ends.
    fn shown_ends(&self, origin: DVec3, axis: DVec3) -> [DVec3; 2] {
        let along = corners(self.bounds).map(|corner| (corner - origin).dot(axis));
        let [low, high] = [f64::min as fn(f64, f64) -> f64, f64::max].map(|of| along.into_iter().reduce(of));
        [low, high].map(|end| origin + end.unwrap_or_default() * axis)
    }

    fn polylines(&self) -> Vec<Vec<DVec3>> {
        match self.shape {
            StatedShape::Clip(ClipShape::Plane { origin, normal }) => {
                let mut outline = cut(self.bounds, origin, normal);
                outline.extend(outline.first().copied());
                let middle = self.middle(origin, normal);
                vec![outline, vec![middle, middle + ARROW * self.size() * normal]]
            }
            StatedShape::Clip(ClipShape::Box { low, high }) => {
                let points = corners([low, high]);
                EDGES.map(|ends| ends.map(|end| points[end]).to_vec()).to_vec()
            }
            StatedShape::Clip(ClipShape::Sphere { centre, radius }) => {
                DVec3::AXES.map(|axis| circle(centre, axis, radius)).to_vec()
            }
            StatedShape::Tube { origin, axis, radius } => {
                let mut lines = cylinder(self.shown_ends(origin, axis), radius);
                lines.push(vec![origin, origin + ARROW * self.size() * axis]);
                lines
            }
            StatedShape::Clip(ClipShape::Cylinder { from, to, radius }) => cylinder([from, to], radius),
        }
    }

    /// Its grips: name, point and movement.
    fn parts(&self) -> Vec<(Part, DVec3, Motion)> {
        let sides = self.view.sides().unwrap_or([DVec3::X, DVec3::Y]);
        let tip = |at: DVec3, normal: DVec3| {
            (Part::Direction, at + ARROW * self.size() * normal, Motion::About(at))
        };
        // Aside of an axis, as far as it is seen.
        let beside = |axis: DVec3| {
            let across = axis.cross(sides[0].cross(sides[1]));
            if across.length() > 0.1 { across.normalize() } else { sides[0].reject_from(axis).normalize() }
        };
        let rim = |at: DVec3, way: DVec3, radius: f64| (Part::Radius, at + radius * way, Motion::Along(way));
        match self.shape {
            StatedShape::Clip(ClipShape::Plane { origin, normal }) => {
                let at = self.middle(origin, normal);
                vec![(Part::Position, at, Motion::Along(normal)), tip(at, normal)]
            }
            StatedShape::Clip(ClipShape::Box { low, high }) => {
                let [least, most] = [low.max(self.bounds[0]), high.min(self.bounds[1])];
                let whole = 0.5 * (low + high);
                // In the middle of what is seen of the face.
                let middle = DVec3::select(least.cmplt(most), 0.5 * (least + most), whole);
                let face = |axis: usize, is_upper: bool| {
                    let mut at = middle;
                    at[axis] = if is_upper { high[axis] } else { low[axis] };
                    (Part::Face(axis, is_upper), at, Motion::Along(DVec3::AXES[axis]))
                };
                (0..3).flat_map(|axis| [face(axis, false), face(axis, true)]).collect()
            }
            StatedShape::Clip(ClipShape::Sphere { centre, radius }) => {
                vec![(Part::Position, centre, Motion::Aside), rim(centre, sides[0], radius)]
            }
            StatedShape::Tube { origin, axis, radius } => vec![
                (Part::Position, origin, Motion::Aside),
                tip(origin, axis),
                rim(origin, beside(axis), radius),
            ],
            StatedShape::Clip(ClipShape::Cylinder { from, to, radius }) => vec![
                (Part::End(0), from, Motion::Aside),
                (Part::End(1), to, Motion::Aside),
                rim(0.5 * (from + to), beside(unit_vector(to - from)), radius),
            ],
        }
    }

    fn part_name(&self, part: Part) -> String {
        match (part, self.shape) {
            (Part::Position, StatedShape::Clip(ClipShape::Sphere { .. })) => "centre".into(),
            (Part::Position, _) => "position".into(),
            (Part::Direction, _) => "direction".into(),
            (Part::Face(axis, is_upper), _) => {
                format!("{} {} face", if is_upper { "upper" } else { "lower" }, ["x", "y", "z"][axis])
            }
            (Part::Radius, _) => "radius".into(),
            (Part::End(end), _) => format!("end {}", end + 1),
        }
    }

    /// The changed parameters when a grip, which was at a point, is brought to another.
    fn changes(&self, part: Part, from: DVec3, to: DVec3) -> Vec<(&'static str, ParameterValue)> {
        let least = MIN_SIZE * self.size();
        let point = |key: &'static str, at: DVec3| (key, self.written(key, at, WRITTEN * self.size()));
        let origin = |at: DVec3| point("origin", at);
        let turned = |about: DVec3| ("normal", self.written("normal", unit_vector(to - about), WRITTEN));
        let radius = |centre: DVec3| {
            let way = unit_vector(from - centre);
            vec![("radius", self.length((to - centre).dot(way).max(least)))]
        };
        match (part, self.shape) {
            (Part::Position, StatedShape::Clip(ClipShape::Plane { origin: before, .. })) => {
                vec![origin(before + to - from)]
            }
            (Part::Direction, StatedShape::Clip(ClipShape::Plane { origin: before, normal })) => {
                // The plane turns about the grip in its middle.
                let about = self.middle(before, normal);
                let is_there = about.distance(before) < WRITTEN * self.size();
                let moved = (!is_there).then(|| origin(about));
                moved.into_iter().chain([turned(about)]).collect()
            }
            (Part::Face(axis, is_upper), StatedShape::Clip(ClipShape::Box { low, high })) => {
                let (mut end, key) = if is_upper { (high, "high") } else { (low, "low") };
                end[axis] = match is_upper {
                    true => to[axis].max(low[axis] + least),
                    false => to[axis].min(high[axis] - least),
                };
                vec![point(key, end)]
            }
            (Part::Position, StatedShape::Clip(ClipShape::Sphere { .. })) if !self.is_slice => {
                vec![point("centre", to)]
            }
            (Part::Position, _) => vec![origin(to)],
            (Part::Direction, StatedShape::Tube { origin, .. }) => vec![turned(origin)],
            (Part::Radius, StatedShape::Clip(ClipShape::Sphere { centre, .. })) => radius(centre),
            (Part::Radius, StatedShape::Tube { origin, .. }) => radius(origin),
            (Part::Radius, StatedShape::Clip(ClipShape::Cylinder { from, to, .. })) => {
                radius(0.5 * (from + to))
            }
            (Part::End(end), _) => vec![point(["from", "to"][end], to)],
            _ => Vec::new(),
        }
    }

    /// A point as the file states it: coordinates that stay are not written anew, and shares of the bounds stay shares.
    fn written(&self, key: &str, at: DVec3, step: f64) -> ParameterValue {
        let before = find_setting(&self.stated, key).and_then(LocatedValue::list).unwrap_or_default();
        let known = point(&self.stated, key, self.bounds);
        let [low, high] = self.bounds;
        let coordinate = |axis: usize| -> LocatedValue {
            let stated = before.get(axis);
            let stays = known.is_some_and(|known| (known[axis] - at[axis]).abs() < 0.1 * step);
            match stated.filter(|_| stays) {
                Some(stated) => stated.clone(),
                None if stated.is_some_and(|stated| stated.text().is_some()) && low[axis] < high[axis] => {
                    let share = 100.0 * (at[axis] - low[axis]) / (high[axis] - low[axis]);
                    format!("{} %", decimal(share, 100.0 * WRITTEN)).as_str().into()
                }
                None => decimal(at[axis], step).into(),
            }
        };
        ParameterValue::List((0..3).map(coordinate).collect())
    }

    /// A radius as the file states it: a share of the diagonal stays one.
    fn length(&self, radius: f64) -> ParameterValue {
        let is_share = find_setting(&self.stated, "radius").is_some_and(|stated| stated.text().is_some());
        match is_share {
            true => format!("{} %", decimal(100.0 * radius / self.size(), 100.0 * WRITTEN)).as_str().into(),
            false => decimal(radius, WRITTEN * self.size()).into(),
        }
    }

    fn edits(&self, part: Part, from: DVec3, to: Option<DVec3>) -> Vec<Edit> {
        let changes = to.filter(|to| to.is_finite()).map(|to| self.changes(part, from, to));
        let set = |(key, value)| Edit::Set { node: self.node.clone(), path: self.path.with(key), value };
        changes.into_iter().flatten().map(set).collect()
    }
}

impl Movable for Object {
    fn name(&self) -> &str {
        &self.name
    }

    fn node(&self) -> &str {
        &self.node
    }

    fn lines(&self) -> Vec<[[f64; 2]; 2]> {
        let of = |points: Vec<DVec3>| {
            let places: Vec<Option<[f64; 2]>> =
                points.into_iter().map(|point| self.view.place(point)).collect();
            places.windows(2).filter_map(|ends| Some([ends[0]?, ends[1]?])).collect::<Vec<_>>()
        };
        self.polylines().into_iter().flat_map(of).collect()
    }

    fn places(&self) -> Vec<(String, Option<[f64; 2]>)> {
        let place = |(part, at, _): (Part, DVec3, Motion)| (self.part_name(part), self.view.place(at));
        self.parts().into_iter().map(place).collect()
    }

    fn moved(&self, grip: usize, to: [f64; 2]) -> Vec<Edit> {
        let Some(&(part, at, motion)) = self.parts().get(grip) else { return Vec::new() };
        let to = match motion {
            Motion::Along(way) => self.view.on_line(at, way, to, REACH * self.size()),
            Motion::About(centre) => self.view.on_ball(centre, at, to),
            Motion::Aside => self.view.beside(at, to),
        };
        self.edits(part, at, to)
    }

    fn nudged(&self, grip: usize, [right, up]: [f64; 2]) -> Vec<Edit> {
        let (Some(&(part, at, motion)), Some(sides)) = (self.parts().get(grip), self.view.sides()) else {
            return Vec::new();
        };
        let step = STEP * self.size();
        let to = match motion {
            Motion::Along(way) => at + step * (right + up) * way,
            Motion::About(_) | Motion::Aside => at + step * (right * sides[0] + up * sides[1]),
        };
        self.edits(part, at, Some(to))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_axis_of_a_slice_is_the_stated_one_wherever_its_origin_and_its_data_are() {
        let field = |(name, datum): (&str, ParameterValue)| Field {
            name: name.into(),
            origin: Default::default(),
            setting: datum.into(),
        };
        let list = |numbers: [f64; 3]| ParameterValue::List(numbers.map(LocatedValue::from).to_vec());
        let shape = |normal: [f64; 3], radius: f64, bounds| {
            let stated = [
                ("shape", ParameterValue::Text("cylinder".into())),
                ("origin", list([1e17, -3.0, 2e9])),
                ("normal", list(normal)),
                ("radius", ParameterValue::Number(radius)),
            ];
            slice_shape(&stated.map(field), bounds)
        };
        let (origin, axis) = (DVec3::new(1e17, -3.0, 2e9), unit_vector(DVec3::new(1.0, 2.0, 3.0)));
        for high in [DVec3::ONE, DVec3::ZERO] {
            let found = shape([1.0, 2.0, 3.0], 0.5, [DVec3::ZERO, high]);
            assert_eq!(found, Some(StatedShape::Tube { origin, axis, radius: 0.5 }), "{high}");
        }
        for (normal, radius) in
            [([0.0; 3], 0.5), ([1.0; 3], 0.0), ([1.0; 3], f64::NAN), ([1.0; 3], f64::INFINITY)]
        {
            assert_eq!(shape(normal, radius, [DVec3::ZERO, DVec3::ONE]), None, "{normal:?} {radius}");
        }
    }
}
