//! The menu of the graph, searchable: node types in groups, by a wire dropped on empty space only what fits; or the wires of a node.

use super::new_node::{adding, needs_arrays};
use super::package::Port;
use super::places::Places;
use super::wire_list::wires_of;
use crate::jobs::{Extent, reads};
use crate::scene::Scene;
use crate::theme::{self, Help};
use eframe::egui::{Area, Context, Frame, Key, Order, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};
use voltet_document::{Edit, Fitting, Group, giving, search, taking};
use voltet_graph::Node;

/// Width and greatest height, points.
const SIZE: [f32; 2] = [300.0, 360.0];

enum Offers {
    /// Node types, those that fit a wire in the hand.
    Nodes(Option<Port>),
    /// Wires, each in words, under a title.
    Wires(String, Vec<(String, Edit)>),
}

/// An entry: its words, what they mean, and what is done.
struct Entry<'a> {
    text: &'a str,
    help: &'a str,
    group: Option<Group>,
    choice: MenuAction<'a>,
}

#[derive(Clone, Copy)]
enum MenuAction<'a> {
    /// A type, and the port of it that the wire in hand would go to.
    Add(&'static Node, Option<Fitting>),
    Do(&'a Edit),
}

pub(super) struct Menu {
    pub at: Pos2,
    offers: Offers,
    typed: String,
    /// The entry that Enter takes; none where a wire would go that was not chosen.
    chosen: Option<usize>,
    /// True if a pointer chose its place.
    is_at_pointer: bool,
    is_new: bool,
}

impl Menu {
    /// Menu of node types at the pointer.
    pub fn new(at: Pos2, wire: Option<Port>) -> Menu {
        let (typed, chosen) = (String::new(), Some(0));
        Menu { at, offers: Offers::Nodes(wire), typed, chosen, is_at_pointer: true, is_new: true }
    }

    /// Menu of node types where no pointer is.
    pub fn in_middle(at: Pos2) -> Menu {
        Menu { is_at_pointer: false, ..Menu::new(at, None) }
    }

    /// Menu of one wire, which can be taken off.
    pub fn of_wire(at: Pos2, wire: (String, Edit)) -> Menu {
        Menu { offers: Offers::Wires("wire".into(), vec![wire]), ..Menu::new(at, None) }
    }

    /// Menu of the wires of a node.
    pub fn of_wires(at: Pos2, scene: &Scene, node: &str) -> Menu {
        let wires = wires_of(scene, node);
        let is_new = wires.first().is_some_and(|(_, edit)| !matches!(edit, Edit::Disconnect { .. }));
        let offers = Offers::Wires(format!("wires of {node}"), wires);
        Menu { offers, chosen: is_new.then_some(0), ..Menu::new(at, None) }
    }

    /// Shows it; false once it is to close. `at`: where a new node goes in the document.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene, places: &Places, at: [f64; 2]) -> bool {
        let typed = self.typed.clone();
        let entries = entries(&self.offers, &typed, scene);
        let dark = ui.visuals().dark_mode;
        let corner =
            self.at.min(rect.max - vec2(SIZE[0] + 20.0, SIZE[1].min(rect.height() - 20.0))).max(rect.min);
        let mut taken: Option<MenuAction> = None;
        let (up, down, enter, escape) = ui.input_mut(|input| {
            let mut pressed = |key| input.consume_key(eframe::egui::Modifiers::NONE, key);
            (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Enter), pressed(Key::Escape))
        });
        let count = entries.len().max(1);
        let mut chosen = match self.chosen {
            Some(at) => Some((at + usize::from(down) + (count - usize::from(up)) % count) % count),
            None if down || up => Some(if down { 0 } else { count - 1 }),
            None => None,
        };
        let area = Area::new(ui.id().with("menu")).order(Order::Foreground).fixed_pos(corner);
        let shown = area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(SIZE[0]);
                let title = match &self.offers {
                    Offers::Nodes(None) => None,
                    Offers::Nodes(Some(wire)) => {
                        let verb = if wire.is_input { "gives" } else { "takes" };
                        Some(format!("what {verb} {}", wire.declared.port_type.with_article()))
                    }
                    Offers::Wires(title, _) => Some(title.clone()),
                };
                if let Some(title) = title {
                    ui.label(RichText::new(title).color(theme::weak(dark)));
                }
                let field =
                    TextEdit::singleline(&mut self.typed).hint_text("search").desired_width(SIZE[0] - 8.0);
                let field = ui.add(field);
                if std::mem::take(&mut self.is_new) {
                    field.request_focus();
                }
                if field.changed() {
                    chosen = Some(0);
                }
                let height = (SIZE[1] - 60.0).min(rect.height() - 80.0).max(80.0);
                ScrollArea::vertical().max_height(height).show(ui, |ui| {
                    ui.set_width(SIZE[0]);
                    let (mut group, by_group) = (None, typed.trim().is_empty());
                    for (i, entry) in entries.iter().enumerate() {
                        if let Some(of) = entry.group.filter(|_| by_group)
                            && group.replace(of) != Some(of)
                        {
                            ui.label(RichText::new(of.name()).small().color(theme::weak(dark)));
                        }
                        let row = ui.selectable_label(Some(i) == chosen, format!("  {}", entry.text));
                        let row = row.help(entry.help);
                        if let MenuAction::Add(node, _) = entry.choice
                            && (row.hovered() || Some(i) == chosen)
                            && needs_arrays(node)
                        {
                            read_heads(ui.ctx(), scene);
                        }
                        if row.clicked() {
                            taken = Some(entry.choice);
                        }
                        if Some(i) == chosen && (up || down) {
                            row.scroll_to_me(None);
                        }
                    }
                    if entries.is_empty() {
                        ui.label("nothing of that name fits");
                    }
                });
                let help = chosen.and_then(|at| entries.get(at)).map_or("", |entry| entry.help);
                ui.separator();
                ui.label(RichText::new(help).small());
            });
        });
        if enter {
            taken = chosen.and_then(|at| entries.get(at)).map(|entry| entry.choice);
        }
        self.chosen = chosen;
        match taken {
            Some(MenuAction::Add(node, fitting)) => {
                let wire = if let Offers::Nodes(wire) = &self.offers { wire.as_ref() } else { None };
                let near = (at, self.is_at_pointer);
                match adding(ui.ctx(), scene, places, node, near, wire.zip(fitting)) {
                    Ok(edits) => scene.actions.edits(edits[0].label(), edits),
                    Err(error) => scene.actions.say(error),
                }
                return false;
            }
            Some(MenuAction::Do(edit)) => {
                scene.actions.edit(edit.clone());
                return false;
            }
            None => {}
        }
        let clicked = ui.input(|input| input.pointer.any_pressed());
        let over =
            ui.input(|input| input.pointer.interact_pos()).is_some_and(|at| shown.response.rect.contains(at));
        !(escape || (clicked && !over))
    }
}

/// Reads the names of the arrays in the files, one of which a new node will have.
fn read_heads(ctx: &Context, scene: &Scene) {
    let nodes = scene.document.pipeline().nodes.iter();
    for reader in nodes.filter(|node| reads(node, scene.registry)) {
        scene.arrays.of_reader(ctx, scene.document, scene.registry, reader, Extent::Heads);
    }
}

/// The choices that fit the typed words: node types the best first, without words those of one group together, each with the port that a
/// wire would go to; or wires.
fn entries<'a>(offers: &'a Offers, typed: &str, scene: &Scene) -> Vec<Entry<'a>> {
    let wire = match offers {
        Offers::Wires(_, wires) => {
            let words: Vec<String> = typed.split_whitespace().map(str::to_lowercase).collect();
            let fits = |text: &str| words.iter().all(|word| text.to_lowercase().contains(word));
            let fitting = wires.iter().filter(|(text, _)| fits(text));
            return fitting
                .map(|(text, edit)| Entry { text, help: "", group: None, choice: MenuAction::Do(edit) })
                .collect();
        }
        Offers::Nodes(wire) => wire,
    };
    let found = search(scene.registry, typed).into_iter();
    let mut entries: Vec<(&'static Node, Option<Fitting>)> = match wire {
        None => found.map(|node| (node, None)).collect(),
        Some(wire) => {
            let fitting = if wire.is_input { giving } else { taking };
            let fitting = fitting(scene.registry, wire.declared.port_type);
            let of = |node: &Node| fitting.iter().find(|fitting| fitting.node.name == node.name).copied();
            found.filter_map(|node| Some((node, Some(of(node)?)))).collect()
        }
    };
    if typed.trim().is_empty() {
        // With a wire, what makes such a thing out of less comes first.
        let needs = |node: &Node| if wire.is_some() { node.inputs.len() } else { 0 };
        entries.sort_by_key(|(node, _)| (Group::from_node(node), needs(node)));
    }
    let entry = |(node, fitting): (&'static Node, Option<Fitting>)| Entry {
        text: node.name,
        help: node.summary,
        group: Some(Group::from_node(node)),
        choice: MenuAction::Add(node, fitting),
    };
    entries.into_iter().map(entry).collect()
}
