//! Model of a document's contents, without any text.

use std::collections::BTreeMap;
use voltet_document::{AnnotationId, Document, Edit, Step, View, links};
use voltet_graph::{Field, LinkEntry, LocatedValue, NodeEntry, ParameterValue};

/// Nodes by name, what feeds them, what the view says.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    title: Option<String>,
    pub nodes: BTreeMap<String, Node>,
    pub view: View,
    /// Positions of nodes that have none in the file.
    pub shown: Unequal,
}

#[derive(Debug, Clone, PartialEq)]
pub struct Node {
    node_type: ParameterValue,
    pub settings: BTreeMap<String, ParameterValue>,
    pub inputs: BTreeMap<String, Vec<String>>,
}

/// Field ignored when models are compared.
#[derive(Debug, Clone)]
pub struct Unequal(pub BTreeMap<String, [f64; 2]>);

impl PartialEq for Unequal {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Model {
    pub fn of(document: &Document) -> Model {
        let pipeline = document.pipeline();
        let node = |entry: &NodeEntry| Node {
            node_type: entry.node_type.datum.clone(),
            settings: settings(&entry.settings),
            inputs: entry.inputs.iter().map(|link| (link.port.clone(), wires(link))).collect(),
        };
        let place = |entry: &NodeEntry| (entry.name.clone(), document.position(&entry.name));
        Model {
            title: pipeline.title.clone(),
            nodes: pipeline.nodes.iter().map(|entry| (entry.name.clone(), node(entry))).collect(),
            view: document.view().clone(),
            shown: Unequal(pipeline.nodes.iter().map(place).collect()),
        }
    }

    pub fn carry_out(&mut self, edit: &Edit) {
        match edit {
            Edit::AddNode { name, node_type, settings, at } => {
                let settings = self::settings(settings);
                let node_type = ParameterValue::Text(node_type.clone());
                self.nodes.insert(name.clone(), Node { node_type, settings, inputs: BTreeMap::new() });
                if let Some(at) = at {
                    self.pin(&[(name.clone(), *at)]);
                }
            }
            Edit::RemoveNodes(names) => {
                for name in names {
                    self.nodes.remove(name);
                    self.view.nodes.remove(name);
                }
                let all = self.names();
                self.keep_wires(|_, _, text| !names.contains(&feeding(text, &all, names)));
            }
            Edit::Rename { node, to } => {
                let all = self.names();
                if let Some(renamed) = self.nodes.remove(node) {
                    self.nodes.insert(to.clone(), renamed);
                }
                if let Some(view) = self.view.nodes.remove(node) {
                    self.view.nodes.insert(to.clone(), view);
                }
                if let Some(at) = self.shown.0.remove(node) {
                    self.shown.0.insert(to.clone(), at);
                }
                for text in self.nodes.values_mut().flat_map(|n| n.inputs.values_mut()).flatten() {
                    let name = feeding(text, &all, &[]);
                    if name == *node {
                        *text = format!("{to}{}", &text[name.len()..]);
                    }
                }
            }
            Edit::Set { node, path, value } => {
                self.with(node, |root| {
                    let keys: Vec<String> = path.0.iter().map(|step| step.key().into_owned()).collect();
                    let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
                    root.replace(&keys, value.clone().into()).unwrap();
                });
            }
            Edit::Unset { node, path } => self.with(node, |root| take(root, &path.0)),
            Edit::Insert { node, list, place, entry } => self.with(node, |root| {
                entries(root, &list.0).insert(*place, entry.clone().into());
            }),
            Edit::Duplicate { node, list, place } => self.with(node, |root| {
                let entries = entries(root, &list.0);
                entries.insert(place + 1, entries[*place].clone());
            }),
            Edit::MoveEntry { node, list, from, to } => self.with(node, |root| {
                let entries = entries(root, &list.0);
                let moved = entries.remove(*from);
                entries.insert(*to, moved);
            }),
            Edit::Connect { node, port, source, beside } => {
                let inputs = &mut self.nodes.get_mut(node).unwrap().inputs;
                let wires = inputs.entry(port.clone()).or_default();
                if !*beside {
                    wires.clear();
                }
                if !wires.contains(source) {
                    wires.push(source.clone());
                }
            }
            Edit::Disconnect { node, port, source } => {
                self.keep_wires(|n, p, text| {
                    !(n == node && p == port && source.as_ref().is_none_or(|source| source == text))
                });
            }
            Edit::MoveNodes(moved) => self.pin(moved),
            Edit::Fold { node, folded } => {
                let at = self.shown.0.get(node).copied();
                let view = self.view.nodes.entry(node.clone()).or_default();
                view.position = view.position.or(at.map(|at| at.map(f64::round)));
                view.folded = *folded;
            }
            Edit::Hide { node, hidden } => {
                let at = self.shown.0.get(node).copied();
                let view = self.view.nodes.entry(node.clone()).or_default();
                view.position = view.position.or(at.map(|at| at.map(f64::round)));
                view.hidden = *hidden;
            }
            Edit::Remark { node, text } => {
                let at = self.shown.0.get(node).copied();
                let view = self.view.nodes.entry(node.clone()).or_default();
                view.position = view.position.or(at.map(|at| at.map(f64::round)));
                view.remark = text.clone();
            }
            Edit::Annotate(AnnotationId::Frame(number), frame) => {
                put(&mut self.view.frames, *number, frame.clone());
            }
            Edit::RemoveAnnotation(AnnotationId::Frame(number)) => drop(self.view.frames.remove(*number)),
            Edit::Annotate(AnnotationId::Note(number), note) => {
                put(&mut self.view.notes, *number, note.clone());
            }
            Edit::RemoveAnnotation(AnnotationId::Note(number)) => drop(self.view.notes.remove(*number)),
            Edit::StoreSet(digit, widgets) => drop(self.view.sets.insert(*digit, widgets.clone())),
            Edit::Title(title) => self.title = title.clone(),
            Edit::AddLines(_) | Edit::Text(_) => unreachable!("not drawn here"),
        }
    }

    /// Places for some nodes, and for all others as they are shown.
    fn pin(&mut self, moved: &[(String, [f64; 2])]) {
        for name in self.nodes.keys() {
            let at = moved.iter().find(|(moved, _)| moved == name).map(|(_, at)| *at);
            let view = self.view.nodes.entry(name.clone()).or_default();
            let at = at.or(view.position).or(self.shown.0.get(name).copied());
            view.position = at.map(|at| at.map(f64::round));
        }
    }

    pub fn names(&self) -> Vec<String> {
        self.nodes.keys().cloned().collect()
    }

    /// Keeps the wires (node, port, source) that the predicate selects.
    fn keep_wires(&mut self, keep: impl Fn(&str, &str, &str) -> bool) {
        for (name, node) in &mut self.nodes {
            for (port, wires) in &mut node.inputs {
                let all = wires.len();
                wires.retain(|text| keep(name, port, text));
                if wires.is_empty() && all > 0 {
                    wires.push(String::new());
                }
            }
            node.inputs.retain(|_, wires| *wires != [String::new()]);
        }
    }

    /// Changes what a node sets.
    fn with(&mut self, node: &str, change: impl FnOnce(&mut LocatedValue)) {
        let settings = &mut self.nodes.get_mut(node).unwrap().settings;
        let field = |(name, datum): (String, ParameterValue)| Field {
            name,
            origin: Default::default(),
            setting: datum.into(),
        };
        let fields = std::mem::take(settings).into_iter().map(field).collect();
        let mut root = LocatedValue::from(ParameterValue::Table(fields));
        change(&mut root);
        let ParameterValue::Table(fields) = root.datum else { unreachable!() };
        *settings = self::settings(&fields);
    }
}

/// Settings of a node.
fn settings(fields: &[Field]) -> BTreeMap<String, ParameterValue> {
    let all = fields.iter().map(|field| (field.name.clone(), sorted(&field.setting.datum)));
    all.filter(|(_, datum)| holds(datum)).collect()
}

fn put<T>(all: &mut Vec<T>, number: usize, one: T) {
    match all.get_mut(number) {
        Some(there) => *there = one,
        None => all.push(one),
    }
}

fn wires(link: &LinkEntry) -> Vec<String> {
    links::sources(link).map(str::to_string).collect()
}

/// The node that a source means among `all`, and those of `more`.
fn feeding(text: &str, all: &[String], more: &[String]) -> String {
    let is_node = |name: &str| all.iter().chain(more).any(|known| known == name);
    match text.rsplit_once('.') {
        Some((node, _)) if !is_node(text) => node.to_string(),
        _ => text.to_string(),
    }
}

/// True if there is something in it: the last entry of `[[…]]`, and the last key with points, leave nothing behind.
fn holds(datum: &ParameterValue) -> bool {
    match datum {
        ParameterValue::List(list) => !list.is_empty(),
        ParameterValue::Table(fields) => !fields.is_empty(),
        ParameterValue::Boolean(_)
        | ParameterValue::Integer(_)
        | ParameterValue::Number(_)
        | ParameterValue::Text(_) => true,
    }
}

/// With the keys of tables in their order, which is of no account, and without keys that hold nothing.
fn sorted(datum: &ParameterValue) -> ParameterValue {
    match datum {
        ParameterValue::List(list) => {
            ParameterValue::List(list.iter().map(|part| sorted(&part.datum).into()).collect())
        }
        ParameterValue::Table(fields) => {
            let mut fields: Vec<Field> = fields.clone();
            fields.sort_by(|a, b| a.name.cmp(&b.name));
            fields.iter_mut().for_each(|field| field.setting = sorted(&field.setting.datum).into());
            fields.retain(|field| holds(&field.setting.datum));
            ParameterValue::Table(fields)
        }
        other => other.clone(),
    }
}

pub fn part<'a>(root: &'a mut LocatedValue, path: &[Step]) -> &'a mut LocatedValue {
    path.iter().fold(root, |at, step| match (&mut at.datum, step) {
        (ParameterValue::Table(fields), step) => {
            &mut fields.iter_mut().find(|field| field.name == step.key()).unwrap().setting
        }
        (ParameterValue::List(list), Step::Entry(number)) => &mut list[*number],
        _ => unreachable!("a path that was drawn leads somewhere"),
    })
}

fn take(root: &mut LocatedValue, path: &[Step]) {
    let (last, before) = path.split_last().unwrap();
    match (&mut part(root, before).datum, last) {
        (ParameterValue::Table(fields), step) => fields.retain(|field| field.name != step.key()),
        (ParameterValue::List(list), Step::Entry(number)) => drop(list.remove(*number)),
        _ => unreachable!("a path that was drawn leads somewhere"),
    }
}

fn entries<'a>(root: &'a mut LocatedValue, path: &[Step]) -> &'a mut Vec<LocatedValue> {
    let (last, before) = path.split_last().unwrap();
    let holder = part(root, before);
    if let ParameterValue::Table(fields) = &mut holder.datum
        && !fields.iter().any(|field| field.name == last.key())
    {
        let setting = ParameterValue::List(Vec::new()).into();
        fields.push(Field { name: last.key().into_owned(), origin: Default::default(), setting });
    }
    match &mut part(holder, std::slice::from_ref(last)).datum {
        ParameterValue::List(list) => list,
        _ => unreachable!("a list was drawn"),
    }
}
