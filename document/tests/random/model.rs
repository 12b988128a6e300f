//! What a document should state, without any text; and edits drawn by lot that suit it.

use crate::lot::Lot;
use std::collections::{BTreeMap, BTreeSet};
use voltet_core::graph::{Datum, Field, LinkEntry, NodeEntry, Setting};
use voltet_document::{Document, Edit, Frame, Note, Path, Step, View, links};

/// Nodes by name, what feeds them, what the view says.
#[derive(Debug, Clone, PartialEq)]
pub struct Model {
    title: Option<String>,
    nodes: BTreeMap<String, Node>,
    view: View,
    /// Where nodes are shown that have no place in the file.
    shown: Unequal,
}

#[derive(Debug, Clone, PartialEq)]
struct Node {
    node_type: Datum,
    settings: BTreeMap<String, Datum>,
    inputs: BTreeMap<String, Vec<String>>,
}

/// Of no account when models are compared.
#[derive(Debug, Clone)]
struct Unequal(BTreeMap<String, [f64; 2]>);

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
                let node_type = Datum::Text(node_type.clone());
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
                view.at = view.at.or(at.map(|at| at.map(f64::round)));
                view.folded = *folded;
            }
            Edit::Remark { node, text } => {
                let at = self.shown.0.get(node).copied();
                let view = self.view.nodes.entry(node.clone()).or_default();
                view.at = view.at.or(at.map(|at| at.map(f64::round)));
                view.remark = text.clone();
            }
            Edit::PutFrame(number, frame) => put(&mut self.view.frames, *number, frame.clone()),
            Edit::RemoveFrame(number) => drop(self.view.frames.remove(*number)),
            Edit::PutNote(number, note) => put(&mut self.view.notes, *number, note.clone()),
            Edit::RemoveNote(number) => drop(self.view.notes.remove(*number)),
            Edit::Title(title) => self.title = title.clone(),
            Edit::AddLines(_) | Edit::Text(_) => unreachable!("not drawn here"),
        }
    }

    /// Places for some nodes, and for all others as they are shown.
    fn pin(&mut self, moved: &[(String, [f64; 2])]) {
        for name in self.nodes.keys() {
            let at = moved.iter().find(|(moved, _)| moved == name).map(|(_, at)| *at);
            let view = self.view.nodes.entry(name.clone()).or_default();
            let at = at.or(view.at).or(self.shown.0.get(name).copied());
            view.at = at.map(|at| at.map(f64::round));
        }
    }

    fn names(&self) -> Vec<String> {
        self.nodes.keys().cloned().collect()
    }

    /// What feeds nodes, less the wires (node, port, source) that are not kept.
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
    fn with(&mut self, node: &str, change: impl FnOnce(&mut Setting)) {
        let settings = &mut self.nodes.get_mut(node).unwrap().settings;
        let field = |(name, datum): (String, Datum)| Field {
            name,
            origin: Default::default(),
            setting: datum.into(),
        };
        let fields = std::mem::take(settings).into_iter().map(field).collect();
        let mut root = Setting::from(Datum::Table(fields));
        change(&mut root);
        let Datum::Table(fields) = root.datum else { unreachable!() };
        *settings = self::settings(&fields);
    }

    /// An edit that can be done.
    pub fn draw(&mut self, lot: &mut Lot, document: &Document) -> Edit {
        for entry in &document.pipeline().nodes {
            self.shown.0.insert(entry.name.clone(), document.position(&entry.name));
        }
        let names = self.names();
        let few = names.len() < 3;
        let Some(node) = lot.of(&names).filter(|_| !few).cloned() else {
            return self.new_node(lot, document);
        };
        // Of the document itself: what holds nothing may be there.
        let sets = |key: &str| {
            let entry = document.pipeline().nodes.iter().find(|entry| entry.name == node);
            entry.is_some_and(|entry| entry.settings.iter().any(|field| field.name == key))
        };
        let paths = self.paths(&node);
        let lists: Vec<(Path, usize)> = self.lists(&node);
        let list = lot.of(&lists).cloned();
        match (lot.below(24), list) {
            (0 | 1, _) => self.new_node(lot, document),
            (2, _) => {
                let count = 1 + lot.below(2);
                let gone: BTreeSet<String> = (0..count).filter_map(|_| lot.of(&names).cloned()).collect();
                Edit::RemoveNodes(gone.into_iter().collect())
            }
            (3, _) => {
                let like = ["n", "a b", "q.r", "ü\"", "grid"][lot.below(5)];
                let to = document.free_name(like);
                Edit::Rename { node, to }
            }
            (4..=8, _) => match lot.of(&paths) {
                Some(path) => {
                    // An entry of [[…]] can be nothing but a table.
                    let is_entry = matches!(path.0.last(), Some(Step::Entry(_)));
                    let is_table = matches!(self.part_of(&node, path), Datum::Table(_));
                    let value = if is_entry && is_table { table(lot, 2) } else { datum(lot, 2) };
                    Edit::Set { node, path: path.clone(), value }
                }
                None => Edit::set(&node, "fresh", datum(lot, 2)),
            },
            (9 | 10, _) => {
                let path = ["fresh", "light.ambient", "a b", "deep.down.there"][lot.below(4)];
                let clash = path.split('.').next().is_some_and(sets);
                let path = if clash { Path::from("other") } else { Path::from(path) };
                Edit::Set { node, path, value: datum(lot, 2) }
            }
            (11 | 12, _) => match lot.of(&paths) {
                Some(path) => Edit::Unset { node, path: path.clone() },
                None => Edit::Title(None),
            },
            (13 | 14, Some((list, count))) => {
                let Datum::List(entries) = self.part_of(&node, &list) else {
                    unreachable!("a list was drawn")
                };
                let is_tables = entries.iter().all(|entry| entry.table().is_some());
                let entry = if is_tables { table(lot, 1) } else { datum(lot, 1) };
                Edit::Insert { node, list, place: lot.below(count + 1), entry }
            }
            (13 | 14, None) if !sets("widgets") => {
                Edit::Insert { node, list: "widgets".into(), place: 0, entry: table(lot, 1) }
            }
            (15, Some((list, count))) if count > 0 => Edit::Duplicate { node, list, place: lot.below(count) },
            (16, Some((list, count))) if count > 0 => {
                Edit::MoveEntry { node, list, from: lot.below(count), to: lot.below(count) }
            }
            (17 | 18, _) => {
                let port = ["volume", "camera", "image", "a port"][lot.below(4)].to_string();
                let from = lot.of(&names).cloned().unwrap_or_default();
                let plain = lot.below(2) == 0 || from.contains('.');
                let source = if plain { from } else { format!("{from}.out") };
                // A text that is a node's name is that node.
                Edit::Connect { node, port, source, beside: lot.below(2) == 0 }
            }
            (19, _) => {
                let inputs: Vec<(&String, &Vec<String>)> = self.nodes[&node].inputs.iter().collect();
                match lot.of(&inputs) {
                    Some((port, wires)) => {
                        let source = lot.of(wires).filter(|_| lot.below(2) == 0).cloned();
                        Edit::Disconnect { node, port: port.to_string(), source }
                    }
                    None => Edit::Title(Some("a \"title\"\n".into())),
                }
            }
            (20, _) => {
                let moved: BTreeSet<String> =
                    (0..1 + lot.below(3)).filter_map(|_| lot.of(&names).cloned()).collect();
                Edit::MoveNodes(moved.into_iter().map(|name| (name, [lot.number(), lot.number()])).collect())
            }
            (21, _) => match lot.below(2) {
                0 => Edit::Fold { node, folded: lot.below(2) == 0 },
                _ => Edit::Remark { node, text: Some("so".to_string()).filter(|_| lot.below(3) > 0) },
            },
            (22, _) => {
                let (count, at) = (self.view.frames.len(), [lot.below(900) as f64, -5.0]);
                match lot.below(3) {
                    0 if count > 0 => Edit::RemoveFrame(lot.below(count)),
                    _ => {
                        let frame = Frame { title: "F # \"".into(), at, size: [30.0, 40.0], color: None };
                        Edit::PutFrame(lot.below(count + 1), frame)
                    }
                }
            }
            _ => {
                let (count, at) = (self.view.notes.len(), [lot.below(900) as f64, -5.0]);
                match lot.below(3) {
                    0 if count > 0 => Edit::RemoveNote(lot.below(count)),
                    _ => Edit::PutNote(lot.below(count + 1), Note { text: "n\nn".into(), at }),
                }
            }
        }
    }

    fn new_node(&self, lot: &mut Lot, document: &Document) -> Edit {
        let name = document.free_name(["renderer", "x y", "look"][lot.below(3)]);
        let Datum::Table(settings) = table(lot, 2) else { unreachable!() };
        let at = (lot.below(2) == 0).then(|| [lot.number(), lot.number()]);
        Edit::AddNode { name, node_type: "some-type".into(), settings, at }
    }

    /// Every part of what a node sets.
    fn paths(&self, node: &str) -> Vec<Path> {
        let mut paths = Vec::new();
        for (name, datum) in &self.nodes[node].settings {
            walk(&Path(vec![Step::Key(name.clone())]), datum, &mut |path, _| paths.push(path.clone()));
        }
        paths
    }

    fn part_of(&self, node: &str, path: &Path) -> Datum {
        let (first, rest) = path.0.split_first().unwrap();
        let mut root = Setting::from(self.nodes[node].settings[first.key().as_ref()].clone());
        part(&mut root, rest).datum.clone()
    }

    /// Every list among it that has entries, and how many.
    fn lists(&self, node: &str) -> Vec<(Path, usize)> {
        let mut lists = Vec::new();
        for (name, datum) in &self.nodes[node].settings {
            walk(&Path(vec![Step::Key(name.clone())]), datum, &mut |path, datum| {
                if let Datum::List(list) = datum
                    && !list.is_empty()
                {
                    lists.push((path.clone(), list.len()));
                }
            });
        }
        lists
    }
}

/// What a node sets.
fn settings(fields: &[Field]) -> BTreeMap<String, Datum> {
    let all = fields.iter().map(|field| (field.name.clone(), sorted(&field.setting.datum)));
    all.filter(|(_, datum)| holds(datum)).collect()
}

fn put<T>(all: &mut Vec<T>, number: usize, one: T) {
    match all.get_mut(number) {
        Some(there) => *there = one,
        None => all.push(one),
    }
}

fn walk(path: &Path, datum: &Datum, see: &mut dyn FnMut(&Path, &Datum)) {
    see(path, datum);
    match datum {
        Datum::List(list) => {
            list.iter().enumerate().for_each(|(i, part)| walk(&path.with(i), &part.datum, see));
        }
        Datum::Table(fields) => {
            fields.iter().for_each(|f| walk(&path.with(f.name.as_str()), &f.setting.datum, see));
        }
        Datum::Boolean(_) | Datum::Integer(_) | Datum::Number(_) | Datum::Text(_) => {}
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

/// Whether there is something in it: the last entry of `[[…]]`, and the last key with points, leave nothing behind.
fn holds(datum: &Datum) -> bool {
    match datum {
        Datum::List(list) => !list.is_empty(),
        Datum::Table(fields) => !fields.is_empty(),
        Datum::Boolean(_) | Datum::Integer(_) | Datum::Number(_) | Datum::Text(_) => true,
    }
}

/// With the keys of tables in their order, which is of no account, and without keys that hold nothing.
fn sorted(datum: &Datum) -> Datum {
    match datum {
        Datum::List(list) => Datum::List(list.iter().map(|part| sorted(&part.datum).into()).collect()),
        Datum::Table(fields) => {
            let mut fields: Vec<Field> = fields.clone();
            fields.sort_by(|a, b| a.name.cmp(&b.name));
            fields.iter_mut().for_each(|field| field.setting = sorted(&field.setting.datum).into());
            fields.retain(|field| holds(&field.setting.datum));
            Datum::Table(fields)
        }
        other => other.clone(),
    }
}

fn part<'a>(root: &'a mut Setting, path: &[Step]) -> &'a mut Setting {
    path.iter().fold(root, |at, step| match (&mut at.datum, step) {
        (Datum::Table(fields), step) => {
            &mut fields.iter_mut().find(|field| field.name == step.key()).unwrap().setting
        }
        (Datum::List(list), Step::Entry(number)) => &mut list[*number],
        _ => unreachable!("a path that was drawn leads somewhere"),
    })
}

fn take(root: &mut Setting, path: &[Step]) {
    let (last, before) = path.split_last().unwrap();
    match (&mut part(root, before).datum, last) {
        (Datum::Table(fields), step) => fields.retain(|field| field.name != step.key()),
        (Datum::List(list), Step::Entry(number)) => drop(list.remove(*number)),
        _ => unreachable!("a path that was drawn leads somewhere"),
    }
}

fn entries<'a>(root: &'a mut Setting, path: &[Step]) -> &'a mut Vec<Setting> {
    let (last, before) = path.split_last().unwrap();
    let holder = part(root, before);
    if let Datum::Table(fields) = &mut holder.datum
        && !fields.iter().any(|field| field.name == last.key())
    {
        let setting = Datum::List(Vec::new()).into();
        fields.push(Field { name: last.key().into_owned(), origin: Default::default(), setting });
    }
    match &mut part(holder, std::slice::from_ref(last)).datum {
        Datum::List(list) => list,
        _ => unreachable!("a list was drawn"),
    }
}

fn datum(lot: &mut Lot, depth: usize) -> Datum {
    match lot.below(if depth == 0 { 4 } else { 7 }) {
        0 => Datum::Boolean(lot.below(2) == 0),
        1 => Datum::Integer(lot.below(2000) as i64 - 1000),
        2 => Datum::Number([lot.number(), 1e300, -1e-7, 0.0][lot.below(4)]),
        3 => Datum::Text(["", "word", "a \"b\" # c\n", "25 %", "é\\'"][lot.below(5)].to_string()),
        4 | 5 => Datum::List((0..lot.below(4)).map(|_| datum(lot, depth - 1).into()).collect()),
        _ => table(lot, depth - 1),
    }
}

fn table(lot: &mut Lot, depth: usize) -> Datum {
    let names = ["kind", "color", "a.b", "two words", "path"];
    let mut fields: Vec<Field> = Vec::new();
    for name in names {
        if lot.below(2) == 0 {
            let setting = datum(lot, depth).into();
            fields.push(Field { name: name.to_string(), origin: Default::default(), setting });
        }
    }
    Datum::Table(fields)
}
