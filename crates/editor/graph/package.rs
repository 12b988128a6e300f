//! Adapter to `egui_node_editor`: contents of a node and its ports as the package's types. The package draws each node and reports the
//! pointer's actions on it. It is given no wires: it would look for both ends of those, drawn or not, and join by equal types only.

use crate::eyes::eye;
use crate::picture::{WHOLE, milliseconds};
use crate::scene::{EARLIER, Scene};
use crate::theme::{self, Help};
use crate::worker::NodeState;
use eframe::egui::epaint::EllipseShape;
use eframe::egui::{
    Align, Align2, Color32, FontId, Label, Layout, Rect, RichText, Sense, Stroke, TextStyle, TextureHandle,
    TextureId, Ui, WidgetInfo, WidgetType, vec2,
};
use egui_node_editor::{
    AnyParameterId, DataTypeTrait, Graph, InputParamKind, NodeDataTrait, NodeId, NodeResponse,
    UserResponseTrait, WidgetValueTrait,
};
use std::borrow::Cow;
use voltet_document::links;
use voltet_graph::{Node, NodeEntry};

/// Width of what a node shows, points at the usual scale: the package's 200, less its margins of 15.
pub(super) const INNER: f32 = 170.0;

const PICTURE: f32 = 64.0;

/// Height of the body of a folded node, points at the usual scale.
const FOLDED: f32 = 10.0;

const SMALL: f32 = 11.5;

/// Letters of a name that fit beside the time.
const LETTERS: usize = 17;

pub(super) type Pictures<'a> = dyn Fn(&str) -> Option<TextureHandle> + 'a;

#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Port {
    pub node: String,
    pub declared: &'static voltet_graph::Port,
    pub is_input: bool,
    /// True if it takes several wires, or none.
    pub is_optional: bool,
}

#[derive(Debug, Default)]
pub(super) struct Face {
    pub name: String,
    node_type: String,
    summary: String,
    state: Option<NodeState>,
    seconds: Option<f64>,
    /// Reason why the picture does not need it.
    idle: Option<String>,
    fault: Option<String>,
    /// With its width by its height.
    picture: Option<(TextureId, f32)>,
    is_picture_earlier: bool,
    is_folded: bool,
    /// True if what it adds to a picture is drawn; none where it adds nothing that can be left out.
    eye: Option<bool>,
    remark: Option<String>,
    zoom: f32,
    /// Texts are too small to be read: they are left out, their room is kept.
    is_far: bool,
}

/// Parameters stand in a panel of their own.
#[derive(Debug, Clone, Default)]
pub(super) struct Nothing;

#[derive(Debug, Clone)]
pub(super) struct EyePress(pub String);

pub(super) type NodeGraph = Graph<Face, Port, Nothing>;
pub(super) type Response = NodeResponse<EyePress, Face>;

/// Adds a node of the document, with its ports unless it is folded.
pub(super) fn add(
    graph: &mut NodeGraph,
    scene: &Scene,
    entry: &NodeEntry,
    pictures: &Pictures,
    zoom: f32,
    is_far: bool,
) -> NodeId {
    let node = scene.node_type(entry);
    let face = Face { zoom, is_far, ..Face::new(scene, entry, node, pictures) };
    let ports = if face.is_folded { Vec::new() } else { ports(entry, node) };
    let label = match entry.name.char_indices().nth(LETTERS - 1) {
        _ if is_far => String::new(),
        Some((end, last)) if end + last.len_utf8() < entry.name.len() => format!("{}…", &entry.name[..end]),
        _ => entry.name.clone(),
    };
    let id = graph.add_node(label, face, |_, _| {});
    for port in ports {
        let name = port.declared.name.to_string();
        if port.is_input {
            graph.add_input_param(id, name, port, Nothing, InputParamKind::ConnectionOnly, true);
        } else {
            graph.add_output_param(id, name, port);
        }
    }
    id
}

/// The ports of a node in the order in which they are shown.
fn ports(entry: &NodeEntry, node: Option<&'static Node>) -> Vec<Port> {
    let Some(node) = node else { return Vec::new() };
    let groups =
        [(node.inputs, true, false), (node.optional_inputs, true, true), (node.outputs, false, false)];
    let of = |(ports, is_input, is_optional): (&'static [voltet_graph::Port], bool, bool)| {
        let node = entry.name.clone();
        ports.iter().map(move |declared| Port { node: node.clone(), declared, is_input, is_optional })
    };
    groups.into_iter().flat_map(of).collect()
}

fn idle(scene: &Scene, node: Option<&'static Node>) -> String {
    match (node, scene.shown_node) {
        (None, _) => "its type is not known".into(),
        (Some(node), _) if node.outputs.is_empty() => {
            "it writes a file, and only a run (Ctrl+R) does that".into()
        }
        (Some(_), Some(shown)) => format!("the picture of '{shown}' does not use it"),
        (Some(_), None) => "no picture is shown".into(),
    }
}

impl Face {
    fn new(scene: &Scene, entry: &NodeEntry, node: Option<&'static Node>, pictures: &Pictures) -> Face {
        let status = scene.nodes.get(&entry.name);
        let is_at = |error: &&voltet_core::Error| error.location.node.as_deref() == Some(&entry.name);
        let failures = scene.failure.iter().chain(&scene.distribution_fault);
        let fault = scene.faults.iter().chain(failures).find(is_at);
        let view = scene.document.view().nodes.get(&entry.name);
        let aspect = |size: eframe::egui::Vec2| size.x / size.y.max(1.0);
        Face {
            name: entry.name.clone(),
            node_type: entry.node_type.text().unwrap_or("no type").to_string(),
            summary: node.map_or(String::new(), |node| node.summary.to_string()),
            state: status.map(|status| status.state.clone()),
            seconds: status.and_then(|status| status.seconds),
            idle: status.is_none().then(|| idle(scene, node)),
            fault: fault.map(|error| {
                error.what.clone() + &error.got.as_ref().map_or(String::new(), |f| format!(": {f}"))
            }),
            picture: pictures(&entry.name).map(|texture| (texture.id(), aspect(texture.size_vec2()))),
            is_picture_earlier: scene.earlier.contains(entry.name.as_str()),
            eye: eye(scene, entry),
            is_folded: view.is_some_and(|view| view.folded),
            remark: view.and_then(|view| view.remark.clone()),
            ..Face::default()
        }
    }

    /// Mark at the right of the title.
    fn mark(&self, dark: bool) -> (String, Color32) {
        let weak = theme::weak(dark);
        match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => ("✖".into(), theme::wrong(dark)),
            (None, Some(NodeState::Running(_, fraction))) if *fraction > 0.0 => {
                (format!("{:.0} %", 100.0 * fraction), theme::accent(dark))
            }
            (None, Some(NodeState::Running(..))) => ("…".into(), theme::accent(dark)),
            (None, Some(NodeState::Stale)) => ("stale".into(), weak),
            (None, Some(NodeState::Fresh)) => (self.seconds.map_or(String::new(), milliseconds), weak),
            (None, None) => ("–".into(), weak),
        }
    }

    /// Shows the eye; true if it is pressed.
    fn eye_button(&self, ui: &mut Ui, is_open: bool) -> bool {
        let dark = ui.visuals().dark_mode;
        let size = vec2(14.0, 12.0) * self.zoom;
        // Tab goes from node to node; a key does what the eye does.
        let (rect, response) = ui.allocate_exact_size(size, Sense::CLICK);
        let color = if is_open { ui.visuals().strong_text_color() } else { theme::weak(dark) };
        let color = if response.hovered() { theme::accent(dark) } else { color };
        let (at, stroke) = (rect.center(), Stroke::new((1.2 * self.zoom).max(0.8), color));
        ui.painter().add(EllipseShape::stroke(at, vec2(6.0, 3.6) * self.zoom, stroke));
        if is_open {
            ui.painter().circle_filled(at, 1.8 * self.zoom, color);
        } else {
            ui.painter().line_segment([rect.left_bottom(), rect.right_top()], stroke);
        }
        let name = format!("eye of {}", self.name);
        response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, true, is_open, &name));
        let help = if is_open { "take it out of this window's picture (E)" } else { "bring it back (E)" };
        response.help(help).clicked()
    }

    pub fn description(&self) -> String {
        let state = match (&self.state, &self.idle) {
            (Some(NodeState::Fresh), _) => match self.seconds {
                Some(seconds) => format!("done; took {}", milliseconds(seconds)),
                None => "done".into(),
            },
            (Some(NodeState::Stale), _) => "stale: will be computed again".into(),
            (Some(NodeState::Running(stage, fraction)), _) => format!("{stage} {:.0} %", 100.0 * fraction),
            (Some(NodeState::Failed(error)), _) => error.clone(),
            (None, Some(idle)) => format!("not needed: {idle}"),
            (None, None) => String::new(),
        };
        // The same mistake may be known in other words: what it is stands before the colon or semicolon.
        let what = |text: &str| text.split([':', ';']).next().map(str::to_string);
        let fault = self.fault.clone().filter(|fault| what(&state) != what(fault));
        let title = format!("{} ({})", self.name, self.node_type);
        let earlier = if self.is_picture_earlier { format!("picture {EARLIER}") } else { String::new() };
        let lines = [title, self.summary.clone(), state, fault.unwrap_or_default(), earlier];
        lines.into_iter().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

impl Port {
    /// The name by which a person or a program without a pointer finds it: "output gradient.volume".
    pub fn full_name(&self) -> String {
        let side = if self.is_input { "input" } else { "output" };
        format!("{side} {}.{}", self.node, self.declared.name)
    }

    pub fn description(&self, scene: &Scene) -> String {
        let entry = scene.entry(&self.node);
        let voltet_graph::Port { name, port_type, summary } = self.declared;
        let side = match (self.is_input, self.is_optional) {
            (true, true) => "optional input",
            (true, false) => "input",
            (false, _) => "output",
        };
        let full = |text| {
            let (node, output, _) = scene.giving(text);
            format!("{node}.{output}")
        };
        let sources: Vec<String> = match self.is_input {
            false => vec![format!("{}.{name}", self.node)],
            true => {
                let links = entry.into_iter().flat_map(|entry| &entry.inputs);
                links.filter(|link| link.port == *name).flat_map(links::sources).map(full).collect()
            }
        };
        let mut text = format!("{name} ({}, {side})\n{summary}", port_type.name());
        for (source, value) in sources.iter().filter_map(|source| Some((source, scene.values.get(source)?))) {
            let node = scene.nodes.get(scene.giving(source).0);
            let is_fresh = node.is_some_and(|status| status.state == NodeState::Fresh);
            let earlier = if is_fresh { String::new() } else { format!(" ({EARLIER})") };
            let from = if self.is_input { format!("from {source}: ") } else { String::new() };
            text += &format!("\n{from}{value}{earlier}");
        }
        if sources.is_empty() {
            text += "\nnot wired";
        }
        text
    }
}

impl UserResponseTrait for EyePress {}

impl DataTypeTrait<()> for Port {
    fn data_type_color(&self, _: &mut ()) -> Color32 {
        // The port's own shape is drawn over it.
        Color32::TRANSPARENT
    }

    fn name(&self) -> Cow<'_, str> {
        Cow::Borrowed(self.declared.port_type.name())
    }
}

impl WidgetValueTrait for Nothing {
    type Response = EyePress;
    type UserState = ();
    type NodeData = Face;

    fn value_widget(
        &mut self,
        name: &str,
        _: NodeId,
        ui: &mut Ui,
        (): &mut (),
        face: &Face,
    ) -> Vec<EyePress> {
        if face.is_far {
            ui.allocate_space(vec2(1.0, ui.text_style_height(&TextStyle::Body)));
        } else {
            ui.label(RichText::new(name).text_style(TextStyle::Body));
        }
        Vec::new()
    }
}

impl NodeDataTrait for Face {
    type Response = EyePress;
    type UserState = ();
    type DataType = Port;
    type ValueType = Nothing;

    fn top_bar_ui(&self, ui: &mut Ui, _: NodeId, _: &NodeGraph, (): &mut ()) -> Vec<Response> {
        let (text, color) = self.mark(ui.visuals().dark_mode);
        let mut responses = Vec::new();
        if !self.is_far && (self.eye.is_some() || !text.is_empty()) {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if self.eye.is_some_and(|is_open| self.eye_button(ui, is_open)) {
                    responses.push(NodeResponse::User(EyePress(self.name.clone())));
                }
                if !text.is_empty() {
                    ui.label(RichText::new(text).size(11.0 * self.zoom).color(color));
                }
            });
        }
        responses
    }

    fn output_ui(&self, ui: &mut Ui, _: NodeId, _: &NodeGraph, (): &mut (), name: &str) -> Vec<Response> {
        let height = ui.text_style_height(&TextStyle::Body);
        let (_, rect) = ui.allocate_space(vec2(INNER * self.zoom, height));
        if !self.is_far {
            let (font, color) = (TextStyle::Body.resolve(ui.style()), ui.visuals().text_color());
            ui.painter().text(rect.right_top(), Align2::RIGHT_TOP, name, font, color);
        }
        Vec::new()
    }

    fn bottom_ui(&self, ui: &mut Ui, _: NodeId, _: &NodeGraph, (): &mut ()) -> Vec<Response> {
        let (dark, zoom) = (ui.visuals().dark_mode, self.zoom);
        // The package draws the lower half of a title's height again, rounded: without a body it would lie on the title.
        let body = if self.is_folded { FOLDED } else { 0.0 };
        ui.allocate_space(vec2(INNER * zoom, body * zoom));
        if let Some((texture, aspect)) = self.picture.filter(|_| !self.is_folded) {
            let height = PICTURE.min(INNER / aspect) * zoom;
            let (_, rect) = ui.allocate_space(vec2(INNER * zoom, height));
            let rect = Rect::from_center_size(rect.center(), vec2(height * aspect, height));
            ui.painter().image(texture, rect, WHOLE, theme::tint(self.is_picture_earlier));
        }
        let row = ui.fonts_mut(|fonts| fonts.row_height(&FontId::proportional(SMALL * zoom)));
        let line = |ui: &mut Ui, text: RichText, color: Color32, is_one: bool| {
            let label = Label::new(text.size(SMALL * zoom).color(color));
            match (self.is_far, is_one) {
                (true, _) => drop(ui.allocate_space(vec2(1.0, row))),
                (false, true) => drop(ui.add(label.truncate())),
                (false, false) => drop(ui.add(label.wrap())),
            }
        };
        if !self.is_folded && self.node_type != self.name {
            line(ui, RichText::new(&self.node_type), theme::weak(dark), true);
        }
        if let Some(remark) = &self.remark {
            line(ui, RichText::new(remark).italics(), theme::weak(dark), false);
        }
        if let Some(fault) = &self.fault {
            let first: String = fault.chars().take(70).collect();
            let text = if first.len() < fault.len() { format!("{first} …") } else { first };
            line(ui, RichText::new(text), theme::wrong(dark), false);
        }
        Vec::new()
    }

    fn titlebar_color(&self, ui: &Ui, _: NodeId, _: &NodeGraph, (): &mut ()) -> Option<Color32> {
        let [on_dark, on_light] = match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => [[120, 40, 36], [240, 180, 175]],
            (None, Some(NodeState::Running(..))) => [[40, 84, 130], [175, 208, 240]],
            (None, Some(NodeState::Fresh | NodeState::Stale)) => [[72; 3], [222; 3]],
            (None, None) => [[52; 3], [232; 3]],
        };
        let [r, g, b] = if ui.visuals().dark_mode { on_dark } else { on_light };
        Some(Color32::from_rgb(r, g, b))
    }

    fn can_delete(&self, _: NodeId, _: &NodeGraph, (): &mut ()) -> bool {
        // By key and menu, so that a click beside the title takes nothing away.
        false
    }
}

/// The ports of a node that the package drew, each with its key.
pub(super) fn drawn_ports(graph: &NodeGraph, id: NodeId) -> impl Iterator<Item = (&Port, AnyParameterId)> {
    let node = &graph[id];
    let inputs = node.inputs.iter().map(|(_, id)| (&graph[*id].typ, AnyParameterId::Input(*id)));
    inputs.chain(node.outputs.iter().map(|(_, id)| (&graph[*id].typ, AnyParameterId::Output(*id))))
}
