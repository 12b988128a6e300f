//! What `egui_node_graph2` needs: our nodes as its types. It draws the nodes that it is given and says what a hand does to
//! them; it is given the visible ones alone, made from the document each frame, and no wires: those it would look for at both
//! ends, drawn or not, and join by equal types only. Where its ports lie it does not say, so the callbacks write that down.

use crate::theme;
use crate::worker::NodeState;
use eframe::egui::{self, Align, Color32, Layout, RichText, TextureId, Ui, pos2, vec2};
use egui_node_graph2::{
    AnyParameterId, DataTypeTrait, Graph, GraphEditorState, NodeDataTrait, NodeId, NodeResponse,
    NodeTemplateIter, NodeTemplateTrait, UserResponseTrait, WidgetValueTrait,
};
use std::borrow::Cow;
use std::collections::HashMap;
use voltet_core::graph::PortType;

/// Width of what a node shows, points at the usual scale: the package's 200, less its margins of 15.
pub(super) const INNER: f32 = 170.0;

/// Height of a picture in its node.
const PICTURE: f32 = 64.0;

/// A port's type and its side, so that what may be joined counts as equal: an output serves an input.
#[derive(Debug, Clone, Copy, Eq)]
pub(super) struct End {
    pub port_type: PortType,
    pub is_input: bool,
}

impl PartialEq for End {
    fn eq(&self, other: &End) -> bool {
        match (self.is_input, other.is_input) {
            (false, true) => self.port_type.serves(other.port_type),
            (true, false) => other.port_type.serves(self.port_type),
            _ => self.port_type == other.port_type,
        }
    }
}

/// What a node shows besides its ports.
#[derive(Debug, Clone, Default)]
pub(super) struct Face {
    pub name: String,
    pub node_type: String,
    pub summary: String,
    pub state: Option<NodeState>,
    pub seconds: Option<f64>,
    /// Why it is not needed for the picture.
    pub idle: Option<String>,
    pub fault: Option<String>,
    pub picture: Option<(TextureId, f32)>,
    pub is_folded: bool,
    pub remark: Option<String>,
}

/// What the callbacks write down: for each port its height in the window, for each node its right edge.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub zoom: f32,
    pub rows: HashMap<AnyParameterId, f32>,
    pub right: HashMap<NodeId, f32>,
    pub begun: f32,
    /// For each node the lower end of its title.
    pub titled: HashMap<NodeId, f32>,
    /// For each node the lower end of what it shows.
    pub bottom: HashMap<NodeId, f32>,
}

impl Written {
    /// A row of a node begins.
    fn begin(&mut self, node: NodeId, ui: &Ui) {
        self.begun = ui.min_rect().bottom();
        self.titled.entry(node).or_insert(self.begun);
    }
}

/// Parameters stand in a panel of their own.
#[derive(Debug, Clone, Default)]
pub(super) struct NoValue;

#[derive(Debug, Clone)]
pub(super) struct NoResponse;

impl UserResponseTrait for NoResponse {}

/// Nodes are added by our own menu, which knows what fits.
#[derive(Clone)]
pub(super) struct NoTemplate;

pub(super) struct NoTemplates;

pub(super) type State = GraphEditorState<Face, End, NoValue, NoTemplate, Written>;

impl NodeTemplateIter for NoTemplates {
    type Item = NoTemplate;
    fn all_kinds(&self) -> Vec<NoTemplate> {
        Vec::new()
    }
}

impl NodeTemplateTrait for NoTemplate {
    type NodeData = Face;
    type DataType = End;
    type ValueType = NoValue;
    type UserState = Written;
    type CategoryType = ();

    fn node_finder_label(&self, _: &mut Written) -> Cow<'_, str> {
        Cow::Borrowed("")
    }

    fn node_graph_label(&self, _: &mut Written) -> String {
        String::new()
    }

    fn user_data(&self, _: &mut Written) -> Face {
        Face::default()
    }

    fn build_node(&self, _: &mut Graph<Face, End, NoValue>, _: &mut Written, _: NodeId) {}
}

impl DataTypeTrait<Written> for End {
    fn data_type_color(&self, _: &mut Written) -> Color32 {
        // The port's own shape is drawn over it.
        Color32::TRANSPARENT
    }

    fn name(&self) -> Cow<'_, str> {
        Cow::Borrowed(self.port_type.name())
    }
}

impl WidgetValueTrait for NoValue {
    type Response = NoResponse;
    type UserState = Written;
    type NodeData = Face;

    fn value_widget(
        &mut self,
        name: &str,
        node: NodeId,
        ui: &mut Ui,
        written: &mut Written,
        _: &Face,
    ) -> Vec<NoResponse> {
        written.begin(node, ui);
        ui.label(RichText::new(name).text_style(egui::TextStyle::Body));
        Vec::new()
    }
}

impl NodeDataTrait for Face {
    type Response = NoResponse;
    type UserState = Written;
    type DataType = End;
    type ValueType = NoValue;

    fn top_bar_ui(
        &self,
        ui: &mut Ui,
        _: NodeId,
        _: &Graph<Face, End, NoValue>,
        written: &mut Written,
    ) -> Vec<NodeResponse<NoResponse, Face>> {
        let dark = ui.visuals().dark_mode;
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let (text, color) = self.mark(dark);
            if !text.is_empty() {
                ui.label(RichText::new(text).size(11.0 * written.zoom).color(color));
            }
        });
        Vec::new()
    }

    fn output_ui(
        &self,
        ui: &mut Ui,
        node: NodeId,
        _: &Graph<Face, End, NoValue>,
        written: &mut Written,
        name: &str,
    ) -> Vec<NodeResponse<NoResponse, Face>> {
        written.begin(node, ui);
        let font = egui::TextStyle::Body.resolve(ui.style());
        let galley = ui.painter().layout_no_wrap(name.into(), font, ui.visuals().text_color());
        let (rect, _) =
            ui.allocate_exact_size(vec2(INNER * written.zoom, galley.size().y), egui::Sense::hover());
        ui.painter().galley(
            pos2(rect.right() - galley.size().x, rect.top()),
            galley,
            ui.visuals().text_color(),
        );
        Vec::new()
    }

    fn separator(
        &self,
        ui: &mut Ui,
        _: NodeId,
        port: AnyParameterId,
        _: &Graph<Face, End, NoValue>,
        written: &mut Written,
    ) {
        // As the package finds the height of the port that it draws.
        written.rows.insert(port, 0.5 * (written.begun + ui.min_rect().bottom()));
    }

    fn bottom_ui(
        &self,
        ui: &mut Ui,
        node: NodeId,
        _: &Graph<Face, End, NoValue>,
        written: &mut Written,
    ) -> Vec<NodeResponse<NoResponse, Face>> {
        let dark = ui.visuals().dark_mode;
        let zoom = written.zoom;
        ui.allocate_space(vec2(INNER * zoom, 0.0));
        let small = |text: &str, color: Color32| RichText::new(text).size(10.5 * zoom).color(color);
        if !self.is_folded {
            if let Some((texture, aspect)) = self.picture {
                let height = (PICTURE * zoom).min(INNER * zoom / aspect);
                let (rect, _) = ui.allocate_exact_size(vec2(INNER * zoom, height), egui::Sense::hover());
                let rect = egui::Rect::from_center_size(rect.center(), vec2(height * aspect, height));
                let whole = egui::Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                ui.painter().image(texture, rect, whole, Color32::WHITE);
            }
            let text = if self.node_type == self.name { "" } else { self.node_type.as_str() };
            if !text.is_empty() {
                ui.add(egui::Label::new(small(text, theme::weak(dark))).truncate());
            }
        }
        if let Some(remark) = &self.remark {
            ui.add(egui::Label::new(small(remark, theme::weak(dark)).italics()).wrap());
        }
        if let Some(fault) = &self.fault {
            let first: String = fault.chars().take(70).collect();
            let text = if first.len() < fault.len() { format!("{first} …") } else { first };
            ui.add(egui::Label::new(small(&text, theme::wrong(dark))).wrap());
        }
        written.right.insert(node, ui.min_rect().right());
        written.bottom.insert(node, ui.min_rect().bottom());
        Vec::new()
    }

    fn titlebar_color(
        &self,
        ui: &Ui,
        _: NodeId,
        _: &Graph<Face, End, NoValue>,
        _: &mut Written,
    ) -> Option<Color32> {
        let dark = ui.visuals().dark_mode;
        let gray = if dark { 72 } else { 205 };
        Some(match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => {
                if dark {
                    Color32::from_rgb(120, 40, 36)
                } else {
                    Color32::from_rgb(240, 180, 175)
                }
            }
            (None, Some(NodeState::Running(..))) => {
                if dark {
                    Color32::from_rgb(40, 84, 130)
                } else {
                    Color32::from_rgb(175, 208, 240)
                }
            }
            (None, Some(NodeState::Fresh | NodeState::Stale)) => Color32::from_gray(gray),
            (None, None) => Color32::from_gray(if dark { 52 } else { 220 }),
        })
    }

    fn can_delete(&self, _: NodeId, _: &Graph<Face, End, NoValue>, _: &mut Written) -> bool {
        // By key and menu, so that a click beside the title takes nothing away.
        false
    }
}

impl Face {
    /// What stands at the right of the title.
    fn mark(&self, dark: bool) -> (String, Color32) {
        let weak = theme::weak(dark);
        match (&self.fault, &self.state) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => ("✖".into(), theme::wrong(dark)),
            (None, Some(NodeState::Running(_, fraction))) if *fraction > 0.0 => {
                (format!("{:.0} %", 100.0 * fraction), theme::accent(dark))
            }
            (None, Some(NodeState::Running(..))) => ("…".into(), theme::accent(dark)),
            (None, Some(NodeState::Stale)) => ("stale".into(), weak),
            (None, Some(NodeState::Fresh)) => {
                (self.seconds.map_or(String::new(), crate::picture::milliseconds), weak)
            }
            (None, None) => ("–".into(), weak),
        }
    }

    /// Everything about it, for whoever points at it.
    pub fn in_words(&self) -> String {
        let state = match (&self.state, &self.idle) {
            (Some(NodeState::Fresh), _) => match self.seconds {
                Some(seconds) => format!("done; took {}", crate::picture::milliseconds(seconds)),
                None => "done".into(),
            },
            (Some(NodeState::Stale), _) => "stale: will be made again".into(),
            (Some(NodeState::Running(stage, fraction)), _) => format!("{stage} {:.0} %", 100.0 * fraction),
            (Some(NodeState::Failed(error)), _) => error.clone(),
            (None, Some(idle)) => format!("not needed: {idle}"),
            (None, None) => String::new(),
        };
        let fault = self.fault.as_ref().filter(|fault| state != **fault);
        let lines = [
            Some(format!("{} ({})", self.name, self.node_type)),
            Some(self.summary.clone()),
            Some(state),
            fault.cloned(),
        ];
        lines.into_iter().flatten().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }
}
