//! The menu of node types: searchable, in groups, and by a wire dropped on empty space only what fits.

use super::package::Port;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{Area, Frame, Key, Order, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};
use voltet_document::{Fitting, Group, giving, search, taking};
use voltet_graph::Node;

/// Width and greatest height, points.
const SIZE: [f32; 2] = [300.0, 360.0];

/// A type, and the port of it that the wire in hand would go to.
type Entry = (&'static Node, Option<Fitting>);

pub(super) struct Menu {
    pub at: Pos2,
    wire: Option<Port>,
    typed: String,
    /// The entry that Enter takes.
    chosen: usize,
    is_new: bool,
}

impl Menu {
    pub fn new(at: Pos2, wire: Option<Port>) -> Menu {
        Menu { at, wire, typed: String::new(), chosen: 0, is_new: true }
    }

    /// Shows it; false once it is to close. `at`: where a new node goes in the document.
    pub fn show(&mut self, ui: &mut Ui, rect: Rect, scene: &Scene, at: [f64; 2]) -> bool {
        let entries = self.entries(scene);
        let dark = ui.visuals().dark_mode;
        let corner =
            self.at.min(rect.max - vec2(SIZE[0] + 20.0, SIZE[1].min(rect.height() - 20.0))).max(rect.min);
        let mut taken: Option<Entry> = None;
        let (up, down, enter, escape) = ui.input_mut(|input| {
            let mut pressed = |key| input.consume_key(eframe::egui::Modifiers::NONE, key);
            (pressed(Key::ArrowUp), pressed(Key::ArrowDown), pressed(Key::Enter), pressed(Key::Escape))
        });
        let count = entries.len().max(1);
        self.chosen = (self.chosen + usize::from(down) + (count - usize::from(up)) % count) % count;
        let area = Area::new(ui.id().with("menu")).order(Order::Foreground).fixed_pos(corner);
        let shown = area.show(ui.ctx(), |ui| {
            Frame::popup(ui.style()).show(ui, |ui| {
                ui.set_width(SIZE[0]);
                if let Some(wire) = &self.wire {
                    let verb = if wire.is_input { "gives" } else { "takes" };
                    let words = format!("what {verb} {}", wire.declared.port_type.with_article());
                    ui.label(RichText::new(words).color(theme::weak(dark)));
                }
                let field =
                    TextEdit::singleline(&mut self.typed).hint_text("search").desired_width(SIZE[0] - 8.0);
                let field = ui.add(field);
                if std::mem::take(&mut self.is_new) {
                    field.request_focus();
                }
                if field.changed() {
                    self.chosen = 0;
                }
                let height = (SIZE[1] - 60.0).min(rect.height() - 80.0).max(80.0);
                ScrollArea::vertical().max_height(height).show(ui, |ui| {
                    ui.set_width(SIZE[0]);
                    let (mut group, by_group) = (None, self.typed.trim().is_empty());
                    for (i, entry) in entries.iter().enumerate() {
                        let (node, of) = (entry.0, Group::from_node(entry.0));
                        if by_group && group.replace(of) != Some(of) {
                            ui.label(RichText::new(of.name()).small().color(theme::weak(dark)));
                        }
                        let row = ui.selectable_label(i == self.chosen, format!("  {}", node.name));
                        let row = row.on_hover_text(node.summary);
                        if row.clicked() {
                            taken = Some(*entry);
                        }
                        if i == self.chosen && (up || down) {
                            row.scroll_to_me(None);
                        }
                    }
                    if entries.is_empty() {
                        ui.label("nothing of that name fits");
                    }
                });
                let chosen = entries.get(self.chosen).map_or("", |(node, _)| node.summary);
                ui.separator();
                ui.label(RichText::new(chosen).small());
            });
        });
        if enter {
            taken = entries.get(self.chosen).copied();
        }
        if let Some(entry) = taken {
            self.add(scene, entry, at);
            return false;
        }
        let clicked = ui.input(|input| input.pointer.any_pressed());
        let over =
            ui.input(|input| input.pointer.interact_pos()).is_some_and(|at| shown.response.rect.contains(at));
        !(escape || (clicked && !over))
    }

    /// The types that fit, the best of the words that were typed first; without words those of one group together. With the
    /// port that a wire would go to.
    fn entries(&self, scene: &Scene) -> Vec<Entry> {
        let found = search(scene.registry, &self.typed).into_iter();
        let mut entries: Vec<Entry> = match &self.wire {
            None => found.map(|node| (node, None)).collect(),
            Some(wire) => {
                let fitting = if wire.is_input { giving } else { taking };
                let fitting = fitting(scene.registry, wire.declared.port_type);
                let of = |node: &Node| fitting.iter().find(|fitting| fitting.node.name == node.name).copied();
                found.filter_map(|node| Some((node, Some(of(node)?)))).collect()
            }
        };
        if self.typed.trim().is_empty() {
            entries.sort_by_key(|(node, _)| Group::from_node(node));
        }
        entries
    }

    fn add(&self, scene: &Scene, (node, fitting): Entry, at: [f64; 2]) {
        let edits = match (&self.wire, fitting) {
            (Some(wire), Some(fitting)) => {
                let held = (wire.node.as_str(), wire.declared.name);
                let edits = scene.document.adding_joined(scene.registry, fitting, at, held, wire.is_input);
                edits.map(|edits| edits.to_vec())
            }
            _ => Ok(vec![scene.document.adding(node, at)]),
        };
        match edits {
            Ok(edits) => scene.actions.edits(edits[0].label(), edits),
            Err(error) => scene.actions.say(error),
        }
    }
}
