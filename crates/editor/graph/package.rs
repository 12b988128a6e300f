//! Adapter to `egui_node_graph2`: our nodes as its types. The package draws the nodes that it is given and reports the
//! pointer's actions. It is given the visible nodes alone, made from the document each frame, and no wires: it would look
//! for both ends of those, drawn or not, and join by equal types only. It does not report positions of ports, so the
//! callbacks record them.

use super::face::Face;
use crate::theme;
use eframe::egui::{self, Align, Align2, Color32, FontId, Layout, RichText, TextStyle, Ui, pos2, vec2};
use egui_node_graph2::{
    AnyParameterId, DataTypeTrait, Graph, GraphEditorState, NodeDataTrait, NodeId, NodeResponse,
    NodeTemplateIter, NodeTemplateTrait, UserResponseTrait, WidgetValueTrait,
};
use std::borrow::Cow;
use std::collections::HashMap;
use voltet_graph::PortType;

/// Width of what a node shows, points at the usual scale: the package's 200, less its margins of 15.
pub(super) const INNER: f32 = 170.0;

/// Height of a picture in its node.
const PICTURE: f32 = 64.0;

/// Height of the body of a folded node, points at the usual scale.
const FOLDED: f32 = 10.0;

/// Size of small letters.
const SMALL: f32 = 11.5;

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

/// Record of the callbacks: for each port its height in the window, for each node its right edge.
#[derive(Debug, Default)]
pub(super) struct Written {
    pub zoom: f32,
    /// Texts are too small to be read: they are left out, their room is kept.
    pub is_far: bool,
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

impl Face {
    /// The room of what [`NodeDataTrait::bottom_ui`] shows where it can be read; the picture is shown all the same.
    fn far_bottom(&self, ui: &mut Ui, zoom: f32) {
        let row = ui.fonts(|fonts| fonts.row_height(&FontId::proportional(SMALL * zoom)));
        if let Some((texture, aspect)) = self.picture.filter(|_| !self.is_folded) {
            paint_picture(ui, texture, aspect, zoom);
        }
        let has_type = !self.is_folded && self.node_type != self.name;
        let rows =
            usize::from(has_type) + usize::from(self.remark.is_some()) + usize::from(self.fault.is_some());
        for _ in 0..rows {
            ui.allocate_space(vec2(1.0, row));
        }
    }
}

fn paint_picture(ui: &mut Ui, texture: egui::TextureId, aspect: f32, zoom: f32) {
    let height = PICTURE.min(INNER / aspect) * zoom;
    let (_, rect) = ui.allocate_space(vec2(INNER * zoom, height));
    let rect = egui::Rect::from_center_size(rect.center(), vec2(height * aspect, height));
    let whole = egui::Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
    ui.painter().image(texture, rect, whole, Color32::WHITE);
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
        match written.is_far {
            true => drop(ui.allocate_space(vec2(1.0, ui.text_style_height(&TextStyle::Body)))),
            false => drop(ui.label(RichText::new(name).text_style(TextStyle::Body))),
        }
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
        if written.is_far {
            return Vec::new();
        }
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
        let height = ui.text_style_height(&TextStyle::Body);
        let (_, rect) = ui.allocate_space(vec2(INNER * written.zoom, height));
        if !written.is_far {
            let (font, color) = (TextStyle::Body.resolve(ui.style()), ui.visuals().text_color());
            ui.painter().text(rect.right_top(), Align2::RIGHT_TOP, name, font, color);
        }
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
        written.titled.entry(node).or_insert(ui.min_rect().bottom());
        // The package draws the lower half of a title's height again, rounded: without a body it would lie on the title.
        let body = if self.is_folded { FOLDED } else { 0.0 };
        ui.allocate_space(vec2(INNER * zoom, body * zoom));
        if written.is_far {
            self.far_bottom(ui, zoom);
            written.right.insert(node, ui.min_rect().right());
            written.bottom.insert(node, ui.min_rect().bottom());
            return Vec::new();
        }
        let small = |text: &str, color: Color32| RichText::new(text).size(SMALL * zoom).color(color);
        if !self.is_folded {
            if let Some((texture, aspect)) = self.picture {
                paint_picture(ui, texture, aspect, zoom);
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
        Some(self.title_color(ui.visuals().dark_mode))
    }

    fn can_delete(&self, _: NodeId, _: &Graph<Face, End, NoValue>, _: &mut Written) -> bool {
        // By key and menu, so that a click beside the title takes nothing away.
        false
    }
}
