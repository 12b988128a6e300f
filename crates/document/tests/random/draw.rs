//! Edits drawn by lot that suit a model.

use crate::lot::Lot;
use crate::model::{Model, part};
use std::collections::BTreeSet;
use voltet_document::{Annotation, AnnotationId, Document, Edit, Path, Step};
use voltet_graph::{Field, LocatedValue, ParameterValue};

impl Model {
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
        match (lot.below(25), list) {
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
                    let is_table = matches!(self.part_of(&node, path), ParameterValue::Table(_));
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
                let ParameterValue::List(entries) = self.part_of(&node, &list) else {
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
            (21, _) => match lot.below(3) {
                0 => Edit::Hide { node, hidden: lot.below(2) == 0 },
                1 => Edit::Fold { node, folded: lot.below(2) == 0 },
                _ => Edit::Remark { node, text: Some("so".to_string()).filter(|_| lot.below(3) > 0) },
            },
            (22, _) => {
                let (count, at) = (self.view.frames.len(), [lot.below(900) as f64, -5.0]);
                match lot.below(3) {
                    0 if count > 0 => Edit::RemoveAnnotation(AnnotationId::Frame(lot.below(count))),
                    _ => {
                        let frame = Annotation {
                            text: "F # \"".into(),
                            position: at,
                            size: Some([30.0, 40.0]),
                            color: None,
                        };
                        Edit::Annotate(AnnotationId::Frame(lot.below(count + 1)), frame)
                    }
                }
            }
            (23, _) => {
                let widgets = (0..lot.below(3)).map(|_| table(lot, 2).into()).collect();
                Edit::StoreSet(lot.below(10) as u8, widgets)
            }
            _ => {
                let (count, at) = (self.view.notes.len(), [lot.below(900) as f64, -5.0]);
                match lot.below(3) {
                    0 if count > 0 => Edit::RemoveAnnotation(AnnotationId::Note(lot.below(count))),
                    _ => Edit::Annotate(
                        AnnotationId::Note(lot.below(count + 1)),
                        Annotation { text: "n\nn".into(), position: at, ..Annotation::default() },
                    ),
                }
            }
        }
    }

    fn new_node(&self, lot: &mut Lot, document: &Document) -> Edit {
        let name = document.free_name(["renderer", "x y", "look"][lot.below(3)]);
        let ParameterValue::Table(settings) = table(lot, 2) else { unreachable!() };
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

    fn part_of(&self, node: &str, path: &Path) -> ParameterValue {
        let (first, rest) = path.0.split_first().unwrap();
        let mut root = LocatedValue::from(self.nodes[node].settings[first.key().as_ref()].clone());
        part(&mut root, rest).datum.clone()
    }

    /// Every list among it that has entries, and how many.
    fn lists(&self, node: &str) -> Vec<(Path, usize)> {
        let mut lists = Vec::new();
        for (name, datum) in &self.nodes[node].settings {
            walk(&Path(vec![Step::Key(name.clone())]), datum, &mut |path, datum| {
                if let ParameterValue::List(list) = datum
                    && !list.is_empty()
                {
                    lists.push((path.clone(), list.len()));
                }
            });
        }
        lists
    }
}

fn walk(path: &Path, datum: &ParameterValue, see: &mut dyn FnMut(&Path, &ParameterValue)) {
    see(path, datum);
    match datum {
        ParameterValue::List(list) => {
            list.iter().enumerate().for_each(|(i, part)| walk(&path.with(i), &part.datum, see));
        }
        ParameterValue::Table(fields) => {
            fields.iter().for_each(|f| walk(&path.with(f.name.as_str()), &f.setting.datum, see));
        }
        ParameterValue::Boolean(_)
        | ParameterValue::Integer(_)
        | ParameterValue::Number(_)
        | ParameterValue::Text(_) => {}
    }
}

fn datum(lot: &mut Lot, depth: usize) -> ParameterValue {
    match lot.below(if depth == 0 { 4 } else { 7 }) {
        0 => ParameterValue::Boolean(lot.below(2) == 0),
        1 => ParameterValue::Integer(lot.below(2000) as i64 - 1000),
        2 => ParameterValue::Number([lot.number(), 1e300, -1e-7, 0.0][lot.below(4)]),
        3 => ParameterValue::Text(["", "word", "a \"b\" # c\n", "25 %", "é\\'"][lot.below(5)].to_string()),
        4 | 5 => ParameterValue::List((0..lot.below(4)).map(|_| datum(lot, depth - 1).into()).collect()),
        _ => table(lot, depth - 1),
    }
}

fn table(lot: &mut Lot, depth: usize) -> ParameterValue {
    let names = ["kind", "color", "a.b", "two words", "path"];
    let mut fields: Vec<Field> = Vec::new();
    for name in names {
        if lot.below(2) == 0 {
            let setting = datum(lot, depth).into();
            fields.push(Field { name: name.to_string(), origin: Default::default(), setting });
        }
    }
    ParameterValue::Table(fields)
}
