//! The menu of node types: searchable, in groups, and by a wire dropped on empty space only what fits.

use super::places::Port;
use crate::actions::Actions;
use crate::scene::Scene;
use crate::theme;
use eframe::egui::{Area, Frame, Key, Order, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};
use voltet_core::graph::{Node, PortType};
use voltet_document::Edit;

/// Width and greatest height, points.
const SIZE: [f32; 2] = [300.0, 360.0];

/// The menu while it is open.
pub(super) struct Menu {
    /// Where in the window.
    pub at: Pos2,
    /// The wire that it was opened by.
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
    pub fn show(
        &mut self,
        ui: &mut Ui,
        rect: Rect,
        scene: &Scene,
        at: [f64; 2],
        actions: &mut Actions,
    ) -> bool {
        let entries = self.entries(scene);
        let dark = ui.visuals().dark_mode;
        let corner =
            self.at.min(rect.max - vec2(SIZE[0] + 20.0, SIZE[1].min(rect.height() - 20.0))).max(rect.min);
        let mut taken: Option<&'static Node> = None;
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
                    let words = format!("what {verb} {}", wire.port_type.with_article());
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
                    let mut group = "";
                    for (i, (of, node)) in entries.iter().enumerate() {
                        if *of != group {
                            ui.label(RichText::new(*of).small().color(theme::weak(dark)));
                            group = of;
                        }
                        let row = ui.selectable_label(i == self.chosen, format!("  {}", node.name));
                        let row = row.on_hover_text(node.summary);
                        if row.clicked() {
                            taken = Some(node);
                        }
                        if i == self.chosen && (up || down) {
                            row.scroll_to_me(None);
                        }
                    }
                    if entries.is_empty() {
                        ui.label("nothing of that name fits");
                    }
                });
                let chosen = entries.get(self.chosen).map_or("", |(_, node)| node.summary);
                ui.separator();
                ui.label(RichText::new(chosen).small());
            });
        });
        if enter {
            taken = entries.get(self.chosen).map(|(_, node)| *node);
        }
        if let Some(node) = taken {
            self.add(scene, node, at, actions);
            return false;
        }
        let clicked = ui.input(|input| input.pointer.any_pressed());
        let over =
            ui.input(|input| input.pointer.interact_pos()).is_some_and(|at| shown.response.rect.contains(at));
        !(escape || (clicked && !over))
    }

    /// The types that fit, those of one group together.
    fn entries(&self, scene: &Scene) -> Vec<(&'static str, &'static Node)> {
        let typed = self.typed.to_lowercase();
        let words: Vec<&str> = typed.split_whitespace().collect();
        let matches = |node: &&'static Node| {
            let text = format!("{} {}", node.name, node.summary).to_lowercase();
            words.iter().all(|word| text.contains(word))
        };
        let fits = |node: &&'static Node| self.wire.as_ref().is_none_or(|wire| fitting(wire, node).is_some());
        let mut entries: Vec<(&'static str, &'static Node)> =
            scene.registry.iter().filter(matches).filter(fits).map(|node| (group(node), node)).collect();
        // A name that was typed comes before a sentence that has the word.
        entries.sort_by_key(|(group, node)| {
            let by_name = !typed.is_empty() && node.name.contains(typed.trim());
            (!by_name, ORDER.iter().position(|of| of == group))
        });
        entries
    }

    fn add(&self, scene: &Scene, node: &'static Node, at: [f64; 2], actions: &mut Actions) {
        let name = scene.document.free_name(&node.name.replace('-', "_"));
        let mut edits = vec![Edit::AddNode {
            name: name.clone(),
            node_type: node.name.to_string(),
            settings: Vec::new(),
            at: Some(at),
        }];
        if let Some(wire) = &self.wire
            && let Some((port, port_type, is_optional)) = fitting(wire, node)
        {
            let own =
                Port { node: name.clone(), name: port, port_type, is_input: !wire.is_input, is_optional };
            if wire.is_input {
                let source =
                    if node.outputs.len() == 1 { name.clone() } else { format!("{name}.{}", own.name) };
                edits.push(Edit::Connect {
                    node: wire.node.clone(),
                    port: wire.name.clone(),
                    source,
                    beside: wire.is_optional,
                });
            } else {
                let given = scene.entry(&wire.node).and_then(|entry| scene.node_type(entry));
                let source = match given.map_or(1, |node| node.outputs.len()) {
                    1 => wire.node.clone(),
                    _ => format!("{}.{}", wire.node, wire.name),
                };
                edits.push(Edit::Connect { node: name.clone(), port: own.name, source, beside: is_optional });
            }
        }
        actions.edits(format!("add '{name}'"), edits);
    }
}

/// The groups in their order.
const ORDER: [&str; 6] =
    ["data", "looks and cameras", "drawing in one node", "drawing, stage by stage", "figures", "files"];

/// What a node type belongs to, by what it takes and gives.
fn group(node: &Node) -> &'static str {
    let gives = |wanted: &[PortType]| node.outputs.iter().any(|port| wanted.contains(&port.port_type));
    let takes = |wanted: PortType| node.inputs.iter().any(|port| port.port_type == wanted);
    if node.outputs.is_empty() {
        "files"
    } else if gives(&[PortType::TransferFunction, PortType::Camera]) {
        "looks and cameras"
    } else if gives(&[PortType::Image]) && takes(PortType::Volume) && takes(PortType::Camera) {
        "drawing in one node"
    } else if gives(&[PortType::Cells, PortType::Projection])
        || (gives(&[PortType::Image]) && takes(PortType::Projection))
    {
        "drawing, stage by stage"
    } else if gives(&[PortType::Grid, PortType::Volume]) {
        "data"
    } else {
        "figures"
    }
}

/// Whether a node type has a port that a wire of this port fits.
fn fitting(held: &Port, node: &Node) -> Option<(String, PortType, bool)> {
    let of =
        |port: &voltet_core::graph::Port, optional: bool| (port.name.to_string(), port.port_type, optional);
    if held.is_input {
        let port = node.outputs.iter().find(|port| port.port_type.serves(held.port_type))?;
        return Some(of(port, false));
    }
    let exact = node.inputs.iter().find(|port| port.port_type == held.port_type);
    let port = exact.or_else(|| node.inputs.iter().find(|port| held.port_type.serves(port.port_type)));
    let optional = || node.optional_inputs.iter().find(|port| held.port_type.serves(port.port_type));
    port.map(|port| of(port, false)).or_else(|| optional().map(|port| of(port, true)))
}
