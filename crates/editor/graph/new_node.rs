//! A node that is added: in a free place, with what it cannot do without, joined to what is selected.

use super::package::Port;
use super::places::{Places, usual_size};
use crate::drawn_with::{Feeding, drawing, inputs_of_picture, nearest_first};
use crate::expression::in_expression;
use crate::jobs::{ArrayChoice, new_array};
use crate::scene::Scene;
use crate::transfer::fields_of;
use eframe::egui::{Context, Rect, Vec2, pos2, vec2};
use voltet_core::Result;
use voltet_document::panel::first_field;
use voltet_document::{Document, Edit, Fitting, links};
use voltet_graph::{
    DefaultValue, Field, Node, NodeEntry, Parameter, ParameterType, ParameterValue, Parameters, PortType,
};
use voltet_io::formats::Association;

/// Least distance to other nodes (ports stand out of their sides), the step by which a free place is sought, and the most such steps, points.
const GAP: Vec2 = vec2(30.0, 14.0);
const STEP: f32 = 30.0;
const MAX_STEPS: i32 = 100;

/// Distance from what feeds a new node, points.
const FEEDING_GAP: f32 = 40.0;

/// Edits that add a node of a type, one step: near a place (document's points), or beside what feeds it unless that place was chosen by a
/// pointer. `held`: the wire that it is made for, and the port of the new node for that. Errors: the wire does not fit.
pub(super) fn adding(
    ctx: &Context,
    scene: &Scene,
    places: &Places,
    node: &'static Node,
    (mut near, is_chosen): ([f64; 2], bool),
    held: Option<(&Port, Fitting)>,
) -> Result<Vec<Edit>> {
    let mut add = scene.document.adding(node, near);
    let Edit::AddNode { name, settings, .. } = &mut add else { return Ok(vec![add]) };
    let name = name.clone();
    *settings = first_settings(scene, node);
    let mut with_it = scene.document.clone();
    with_it.edit(&add)?;
    let mut edits = vec![add];
    if let Some((port, fitting)) = held {
        let (own, held) = ((name.as_str(), fitting.port.name), (port.node.as_str(), port.declared.name));
        let (from, to) = if port.is_input { (own, held) } else { (held, own) };
        let join = with_it.join(scene.registry, from, to)?;
        with_it.edit(&join)?;
        edits.push(join);
    }
    join_to_others(scene, &mut with_it, node, &name, &mut edits);
    let arrays = scene.arrays.feeding(ctx, &with_it, scene.registry, &name);
    let own = links::node(&with_it.pipeline().nodes, &name)?;
    let feeding =
        own.inputs.iter().flat_map(links::sources).find_map(|text| scene.entry(scene.giving(text).0));
    if let Some(frame) = feeding.filter(|_| !is_chosen).map(|entry| places.frame(scene, entry)) {
        near = [frame.right() + FEEDING_GAP, frame.top()].map(f64::from);
    }
    if let Some(Edit::AddNode { settings, at, .. }) = edits.first_mut() {
        *at = Some(free_place(scene, places, node, near));
        let of_arrays = settings_of_arrays(node, &arrays.choices());
        // The type says more than the name by which a first value was found.
        settings.retain(|known| of_arrays.iter().all(|field| field.name != known.name));
        settings.extend(of_arrays);
    }
    Ok(edits)
}

fn required(node: &Node) -> impl Iterator<Item = &Parameter> {
    node.parameters.iter().filter(|parameter| matches!(parameter.default, DefaultValue::Required))
}

/// True if a new node of the type begins with an array of the data.
pub(super) fn needs_arrays(node: &Node) -> bool {
    use ParameterType::{ArrayName, ArrayNames, Expression};
    required(node).any(|parameter| matches!(parameter.parameter_type, ArrayName | ArrayNames | Expression))
}

/// Settings by which a new node works with an array of the data where it requires one: the first, at the points where there is one.
fn settings_of_arrays(node: &Node, arrays: &[&ArrayChoice]) -> Vec<Field> {
    let at = |place: Association| arrays.iter().find(|array| array.is_at(place));
    let first = at(Association::Point).or(at(Association::Cell));
    let value = |parameter: &Parameter| match (parameter.parameter_type, first) {
        (ParameterType::Expression, Some(array)) => Some(in_expression(&array.name).into()),
        // While no array is known: coordinates are at all points.
        (ParameterType::Expression, None) => Some("x".into()),
        (ParameterType::ArrayName, Some(array)) => Some(array.name.as_str().into()),
        (ParameterType::ArrayNames, Some(array)) => Some(ParameterValue::from_iter([array.name.as_str()])),
        _ => None,
    };
    let mut settings: Vec<Field> =
        required(node).filter_map(|parameter| Some(Field::new(parameter.name, value(parameter)?))).collect();
    let association = node.parameter("association").filter(|_| !settings.is_empty());
    let has_cells =
        association.is_some_and(|own| own.parameter_type.words().iter().any(|word| word.0 == "cell"));
    if has_cells && first.is_some_and(|array| !array.is_at(Association::Point)) {
        settings.push(Field::new("association", "cell"));
    }
    settings.extend(free_name(node, arrays));
    settings
}

/// A name for the array that a new node makes where there is one of the usual name, which it might compute with, or hide.
fn free_name(node: &Node, arrays: &[&ArrayChoice]) -> Option<Field> {
    let parameter =
        new_array(node).filter(|own| matches!(own.parameter_type, ParameterType::NewArrayName))?;
    let DefaultValue::Text(usual) = parameter.default else { return None };
    let is_taken = |name: &str| arrays.iter().any(|array| array.is_of(name));
    let free = (2..).map(|number| format!("{usual}_{number}")).find(|name| !is_taken(name));
    Some(Field::new(parameter.name, free.filter(|_| is_taken(usual))?))
}

/// Joins the inputs of a new node: to the selected node where that fits; a required one also to the only node that fits, or to the
/// nearest that feeds the selected node or the shown picture. Then its outputs: to the selected node where that lacks them, else where
/// one node alone does; a surface to what draws the selected picture, or the shown one, where that draws some; a picture made of
/// another to the writers of that one. What is made of a picture takes what that is drawn with, too.
fn join_to_others(
    scene: &Scene,
    with_it: &mut Document,
    node: &'static Node,
    name: &str,
    edits: &mut Vec<Edit>,
) {
    let selected = scene.selection.first().filter(|_| scene.selection.len() == 1);
    let is_fed = |document: &Document, node: &str, port: &str| {
        let entry = links::node(&document.pipeline().nodes, node);
        entry.is_ok_and(|entry| entry.inputs.iter().any(|link| link.port == port))
    };
    let mut join = |document: &mut Document, from: (&str, &str), to: (&str, &str)| {
        if let Ok(edit) = document.join(scene.registry, from, to)
            && document.edit(&edit).is_ok()
        {
            edits.push(edit);
        }
    };
    let mut uses_selected = false;
    for input in node.all_inputs() {
        if is_fed(with_it, name, input.name) {
            continue;
        }
        let gives = |entry: &&NodeEntry| {
            let outputs = scene.node_type(entry).map_or(&[][..], |node| node.outputs);
            outputs.iter().any(|output| output.port_type.serves(input.port_type))
        };
        let mut fitting = scene.document.pipeline().nodes.iter().filter(gives);
        let own = fitting.clone().find(|entry| !uses_selected && Some(&entry.name) == selected);
        let is_required = node.inputs.iter().any(|port| port.name == input.name);
        let is_view = input.port_type == PortType::Volume && is_camera(node);
        let other = match (fitting.next(), fitting.next_back()) {
            (Some(first), None) if is_required || is_view => Some(first),
            // Any of the data shows where they lie; the last one is what is drawn.
            (_, Some(last)) if is_view => Some(last),
            (Some(_), Some(_)) if is_required => {
                let mut begins = selected.map(String::as_str).into_iter().chain(scene.shown_node);
                begins.find_map(|from| nearest_first(scene, from).into_iter().find(gives))
            }
            _ => None,
        };
        uses_selected |= own.is_some();
        let Some(from) = own.or(other) else { continue };
        let outputs = scene.node_type(from).map_or(&[][..], |node| node.outputs);
        if let Some(output) = outputs.iter().find(|output| output.port_type.serves(input.port_type)) {
            join(with_it, (&from.name, output.name), (name, input.name));
        }
    }
    let of_picture =
        links::node(&with_it.pipeline().nodes, name).map(|own| first_inputs_of_picture(scene, own));
    for (from, output, input) in of_picture.unwrap_or_default() {
        join(with_it, (&from, &output), (name, input));
    }
    for output in node.outputs {
        let lacking = |entry: &&NodeEntry| {
            let inputs = scene.node_type(entry).map_or(&[][..], |node| node.inputs).iter();
            let mut fitting = inputs.filter(|input| output.port_type.serves(input.port_type));
            fitting.find(|input| !is_fed(with_it, &entry.name, input.name)).map(|input| input.name)
        };
        let others = || scene.document.pipeline().nodes.iter().filter(|entry| lacking(entry).is_some());
        let own = others().find(|entry| Some(&entry.name) == selected);
        let only = others().next().filter(|_| others().count() == 1);
        if let Some((entry, input)) = own.or(only).and_then(|entry| Some((entry, lacking(&entry)?))) {
            join(with_it, (name, output.name), (&entry.name, input));
        }
        match output.port_type {
            PortType::Surface => {
                let drawn_by = |entry: &NodeEntry| {
                    let mut inputs = scene.node_type(entry)?.optional_inputs.iter();
                    inputs.find(|port| port.port_type == PortType::Surface)
                };
                let begins = selected.map(String::as_str).into_iter().chain(scene.shown_node);
                let mut drawing = begins.flat_map(|from| nearest_first(scene, from));
                if let Some((entry, input)) = drawing.find_map(|entry| Some((entry, drawn_by(entry)?))) {
                    join(with_it, (name, output.name), (&entry.name, input.name));
                }
            }
            PortType::Image => {
                for (writer, input) in writers_of_source(scene, with_it, node, name) {
                    join(with_it, (name, output.name), (&writer, &input));
                }
            }
            _ => {}
        }
    }
}

/// Inputs that a new node takes of what draws its picture: none where another of its type is made of the picture already, and no transfer
/// function of several fields, whose colours have no scale.
fn first_inputs_of_picture(scene: &Scene, entry: &NodeEntry) -> Vec<Feeding> {
    let is_alike = |other: &&NodeEntry| other.node_type.text() == entry.node_type.text();
    if drawing(scene, entry).iter().any(is_alike) {
        return Vec::new();
    }
    let has_scale = |(node, _, _): &Feeding| scene.entry(node).is_none_or(|look| fields_of(look).is_empty());
    inputs_of_picture(scene, entry).into_iter().filter(has_scale).collect()
}

/// Inputs, each of a node that writes, which the picture feeds that a new node takes.
fn writers_of_source(scene: &Scene, with_it: &Document, node: &Node, name: &str) -> Vec<(String, String)> {
    let takes =
        |port: &str| node.all_inputs().any(|input| input.name == port && input.port_type == PortType::Image);
    let own = links::node(&with_it.pipeline().nodes, name);
    let taken = own.into_iter().flat_map(|entry| &entry.inputs).filter(|link| takes(&link.port));
    let sources: Vec<(String, String)> =
        taken.flat_map(links::sources).map(|text| scene.output_of(text)).collect();
    let writers = scene.document.pipeline().nodes.iter();
    let writers = writers.filter(|entry| scene.node_type(entry).is_some_and(|node| node.outputs.is_empty()));
    let inputs = writers.flat_map(|entry| entry.inputs.iter().map(move |link| (entry, link)));
    let is_fed = |text: &str| sources.contains(&scene.output_of(text));
    let fed = inputs.filter(|(_, link)| link.source.text().is_some_and(is_fed));
    fed.map(|(entry, link)| (entry.name.clone(), link.port.clone())).collect()
}

fn is_camera(node: &Node) -> bool {
    node.outputs.iter().any(|port| port.port_type == PortType::Camera)
}

/// Settings of a new node: a view of all the data for a camera, the name of a file for a writer, and values to begin with of what others
/// require.
fn first_settings(scene: &Scene, node: &Node) -> Vec<Field> {
    if is_camera(node) && node.parameters.iter().any(|parameter| parameter.name == "view") {
        return vec![Field::new("view", "isometric")];
    }
    let is_file = |parameter: &&Parameter| matches!(parameter.parameter_type, ParameterType::OutputPath);
    let Some(file) = required(node).find(is_file) else {
        let extent = scene.data_extent();
        let first = |parameter| first_field(parameter, &extent);
        let settings: Vec<Field> = required(node).filter_map(first).collect();
        let with = |more: Option<Field>| settings.iter().cloned().chain(more).collect::<Vec<_>>();
        let is_enough = |settings: &Vec<Field>| {
            let checked = Parameters::check(node.parameters, settings, &Default::default(), &[]);
            checked.is_ok_and(|parameters| (node.check)(&parameters).is_ok())
        };
        let optional = node.parameters.iter().filter(|own| matches!(own.default, DefaultValue::Unset(_)));
        // Of some that exclude each other one is needed.
        let alone = std::iter::once(None).chain(optional.filter_map(first).map(Some));
        return alone.map(with).find(is_enough).unwrap_or(settings);
    };
    let (stem, ending) = match node.inputs.first().map(|port| port.port_type) {
        Some(PortType::Image) => ("picture", "png"),
        Some(PortType::Grid | PortType::Volume) => ("grid", "vtu"),
        Some(PortType::Report) => ("report", "json"),
        _ => return Vec::new(),
    };
    let is_taken = |path: &str| {
        let names = |entry: &NodeEntry| entry.setting(file.name).and_then(|value| value.text()) == Some(path);
        scene.document.pipeline().nodes.iter().any(names) || scene.document.folder().join(path).exists()
    };
    let numbered = (2..).map(|number| format!("{stem}_{number}.{ending}"));
    let path = std::iter::once(format!("{stem}.{ending}")).chain(numbered).find(|path| !is_taken(path));
    path.map(|path| Field::new(file.name, path)).into_iter().collect()
}

/// The free place nearest to another: where a node of a type lies on no other.
fn free_place(scene: &Scene, places: &Places, node: &Node, near: [f64; 2]) -> [f64; 2] {
    let taken: Vec<Rect> =
        scene.document.pipeline().nodes.iter().map(|entry| places.frame(scene, entry).expand2(GAP)).collect();
    let size = usual_size(Some(node)).map(|side| side as f32).into();
    let is_free = |[x, y]: [f32; 2]| {
        let own = Rect::from_min_size(pos2(x, y), size);
        !taken.iter().any(|frame| frame.intersects(own))
    };
    let near = near.map(|x| x as f32);
    let at = |step: [i32; 2]| [0, 1].map(|k: usize| near[k] + STEP * step[k] as f32);
    // Around it in squares; to the right and down before the opposite.
    let place = (0..=MAX_STEPS).find_map(|n| {
        let along = move || (-n..=n).rev();
        let steps = along().flat_map(|down| along().map(move |right| [right, down]));
        let around = steps.filter(|step| step.iter().any(|step| step.abs() == n));
        let free = around.filter(|step| is_free(at(*step)));
        free.min_by_key(|[right, down]| right * right + down * down)
    });
    place.map_or(near, at).map(f64::from)
}
