//! A node: its size, its drawing, and words about it. Lengths are points at the usual scale.

use super::places::{NodePlace, Port, Viewport};
use crate::picture::{WHOLE, milliseconds};
use crate::scene::Scene;
use crate::theme;
use crate::worker::{NodeState, NodeStatus};
use eframe::egui::epaint::text::{LayoutJob, TextWrapping};
use eframe::egui::{
    Align2, Color32, FontId, Galley, Rect, Rounding, Stroke, TextStyle, TextureHandle, TextureId, Ui, pos2,
    vec2,
};
use std::sync::Arc;
use voltet_document::NodeView;
use voltet_graph::{Node, NodeEntry, PortType};

/// The picture of a node, where there is one.
pub(super) type Pictures<'a> = dyn Fn(&str) -> Option<TextureHandle> + 'a;

/// Width of a node and of what it shows.
const WIDTH: f32 = 200.0;
const INNER: f32 = 170.0;

/// Heights of a title, of a port's row, of a picture at most, and of the body of a folded node.
const TITLE: f32 = 28.0;
const ROW: f32 = 21.0;
const PICTURE: f32 = 64.0;
const FOLDED: f32 = 10.0;

/// Space between parts.
const GAP: f32 = 5.0;

/// Sizes of letters of the name, and of the time, the type, a remark and an error.
const NAME: f32 = 14.0;
const SMALL: f32 = 11.5;

/// Rows of a remark and of an error, at most.
const MAX_ROWS: usize = 3;

/// Height of the letters of names where others are left out.
const FAR_NAME: f32 = 9.0;

/// Height of letters in the window below which they are left out.
const FAR_LETTERS: f32 = 6.0;

/// True if the letters of nodes are too small to read; then nodes show their names alone, in letters of one size.
pub(super) fn is_far(ui: &Ui, zoom: f32) -> bool {
    // On screens of a high density smaller letters can be read, down to a limit.
    let sharp = ui.ctx().pixels_per_point().clamp(1.0, 1.5);
    TextStyle::Body.resolve(ui.style()).size * zoom * sharp < FAR_LETTERS
}

/// Width and height that a node of a type will have, with its picture and an error.
pub(crate) fn usual_size(node: Option<&Node>) -> [f64; 2] {
    let ports = node.map_or(0, |node| node.all_inputs().count() + node.outputs.len());
    let has_picture =
        node.is_some_and(|node| node.outputs.iter().any(|port| port.port_type == PortType::Image));
    let picture = if has_picture { PICTURE + GAP } else { 0.0 };
    let texts = SMALL * (1.0 + MAX_ROWS as f32);
    [f64::from(WIDTH), f64::from(TITLE + ROW * ports as f32 + picture + texts + 3.0 * GAP)]
}

/// A node of this frame.
pub(super) struct NodeShape<'a> {
    pub entry: &'a NodeEntry,
    node: Option<&'static Node>,
    status: Option<&'a NodeStatus>,
    view: Option<&'a NodeView>,
    fault: Option<String>,
    picture: Option<(TextureId, f32)>,
    ports: Vec<Port>,
    /// Rows of the remark and of the error.
    rows: [usize; 2],
    /// Upper left corner and size in the document.
    pub position: [f64; 2],
    pub size: [f64; 2],
}

impl<'a> NodeShape<'a> {
    pub fn new(ui: &Ui, scene: &'a Scene, entry: &'a NodeEntry, pictures: &Pictures) -> NodeShape<'a> {
        let is_at = |error: &&voltet_core::Error| error.location.node.as_deref() == Some(&entry.name);
        let fault = scene.faults.iter().find(is_at).or(scene.failure.as_ref().filter(is_at));
        let texture = pictures(&entry.name);
        let mut shape = NodeShape {
            entry,
            node: scene.node_type(entry),
            status: scene.nodes.get(&entry.name),
            view: scene.document.view().nodes.get(&entry.name),
            fault: fault.map(|error| {
                error.what.clone() + &error.got.as_ref().map_or(String::new(), |got| format!(": {got}"))
            }),
            picture: texture.map(|texture| (texture.id(), texture.aspect_ratio().max(1e-3))),
            ports: Vec::new(),
            rows: [0; 2],
            position: scene.document.position(&entry.name),
            size: [f64::from(WIDTH); 2],
        };
        if !shape.is_folded() {
            shape.ports = shape.all_ports();
        }
        let rows = |text: Option<&str>| text.map_or(0, |text| small(ui, text, MAX_ROWS, 1.0).rows.len());
        shape.rows = [rows(shape.remark()), rows(shape.fault.as_deref())];
        shape.size[1] = f64::from(shape.height());
        shape
    }

    fn is_folded(&self) -> bool {
        self.view.is_some_and(|view| view.folded)
    }

    fn remark(&self) -> Option<&'a str> {
        self.view.and_then(|view| view.remark.as_deref())
    }

    /// Type, where the name does not say it.
    fn shown_type(&self) -> Option<&'a str> {
        let node_type = self.entry.node_type.text().unwrap_or("no type");
        Some(node_type).filter(|node_type| !self.is_folded() && *node_type != self.entry.name)
    }

    /// The ports in the order in which they are shown.
    fn all_ports(&self) -> Vec<Port> {
        let Some(node) = self.node else { return Vec::new() };
        let of = |port: &voltet_graph::Port, is_input: bool, is_optional: bool| Port {
            node: self.entry.name.clone(),
            name: port.name,
            port_type: port.port_type,
            is_input,
            is_optional,
        };
        let inputs = node.inputs.iter().map(|port| of(port, true, false));
        let optional = node.optional_inputs.iter().map(|port| of(port, true, true));
        inputs.chain(optional).chain(node.outputs.iter().map(|port| of(port, false, false))).collect()
    }

    fn picture_height(&self) -> Option<f32> {
        self.picture.filter(|_| !self.is_folded()).map(|(_, aspect)| PICTURE.min(INNER / aspect))
    }

    fn height(&self) -> f32 {
        let picture = self.picture_height().map_or(0.0, |height| height + GAP);
        let rows = usize::from(self.shown_type().is_some()) + self.rows.iter().sum::<usize>();
        let body = if self.is_folded() { FOLDED } else { 2.0 * GAP };
        TITLE + ROW * self.ports.len() as f32 + picture + 1.3 * SMALL * rows as f32 + body
    }

    /// The node and its ports in the window.
    pub fn place(&self, viewport: Viewport) -> NodePlace {
        let rect = viewport.rect_of(self.position, self.size);
        let port = |(i, port): (usize, &Port)| {
            let x = if port.is_input { rect.left() } else { rect.right() };
            (port.clone(), pos2(x, rect.top() + viewport.zoom * (TITLE + ROW * (i as f32 + 0.5))))
        };
        let ports = self.ports.iter().enumerate().map(port).collect();
        NodePlace { name: self.entry.name.clone(), rect, ports }
    }

    /// Draws the node but for its ports.
    pub fn draw(&self, ui: &Ui, place: &NodePlace, zoom: f32) {
        let (rect, dark) = (place.rect, ui.visuals().dark_mode);
        let (ground, text) = match dark {
            true => (Color32::from_gray(63), Color32::from_gray(254)),
            false => (Color32::WHITE, Color32::from_gray(80)),
        };
        let painter = ui.painter();
        let round = 4.0 * zoom;
        painter.rect_filled(rect, round, ground);
        let title = Rect::from_min_size(rect.min, vec2(rect.width(), TITLE * zoom));
        painter.rect_filled(
            title,
            Rounding { nw: round, ne: round, sw: 0.0, se: 0.0 },
            self.title_color(dark),
        );
        let mut y = title.bottom() + ROW * zoom * self.ports.len() as f32 + GAP * zoom;
        let middle = rect.center().x;
        if let (Some((texture, aspect)), Some(height)) = (self.picture, self.picture_height()) {
            let size = zoom * vec2(height * aspect, height);
            let at = Rect::from_min_size(pos2(middle - 0.5 * size.x, y), size);
            painter.image(texture, at, WHOLE, Color32::WHITE);
            y = at.bottom() + GAP * zoom;
        }
        if is_far(ui, zoom) {
            let font = FontId::proportional(FAR_NAME);
            let galley =
                painter.layout_no_wrap(self.entry.name.clone(), font, ui.visuals().strong_text_color());
            let at = rect.center() - 0.5 * galley.size();
            let clipped = painter.with_clip_rect(rect.intersect(ui.clip_rect()));
            clipped.galley(at.max(pos2(rect.left() + 2.0, at.y)), galley, Color32::WHITE);
            return;
        }
        let (mark, color) = self.mark(dark);
        let side = 0.5 * (WIDTH - INNER) * zoom;
        let at = pos2(rect.right() - side, title.center().y);
        let mark = painter.text(at, Align2::RIGHT_CENTER, mark, FontId::proportional(SMALL * zoom), color);
        let room = (mark.left() - rect.left() - side - GAP * zoom).max(0.0);
        let name = one_line(ui, &self.entry.name, NAME * zoom, text, room);
        painter.galley(pos2(rect.left() + side, title.center().y - 0.5 * name.size().y), name, text);
        let font = FontId::proportional(TextStyle::Body.resolve(ui.style()).size * zoom);
        for (port, at) in &place.ports {
            let (anchor, x) = match port.is_input {
                true => (Align2::LEFT_CENTER, rect.left() + side),
                false => (Align2::RIGHT_CENTER, rect.right() - side),
            };
            painter.text(pos2(x, at.y), anchor, port.name, font.clone(), ui.visuals().text_color());
        }
        let weak = theme::weak(dark);
        let texts = [
            (self.shown_type(), 1, weak),
            (self.remark(), self.rows[0], weak),
            (self.fault.as_deref(), self.rows[1], theme::wrong(dark)),
        ];
        for (text, rows, color) in texts {
            let Some(text) = text else { continue };
            painter.galley_with_override_text_color(
                pos2(rect.left() + side, y),
                small(ui, text, rows, zoom),
                color,
            );
            y += 1.3 * SMALL * zoom * rows as f32;
        }
    }

    /// Frame of a selected node.
    pub fn draw_selection(ui: &Ui, place: &NodePlace, zoom: f32) {
        let stroke = Stroke::new(2.0, theme::accent(ui.visuals().dark_mode));
        ui.painter().rect_stroke(place.rect.expand(2.0), Rounding::same(5.0 * zoom), stroke);
    }

    /// The ground of the title: by the state.
    fn title_color(&self, dark: bool) -> Color32 {
        let of = |on_dark: [u8; 3], on_light: [u8; 3]| {
            let [r, g, b] = if dark { on_dark } else { on_light };
            Color32::from_rgb(r, g, b)
        };
        match (&self.fault, self.status.map(|status| &status.state)) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => of([120, 40, 36], [240, 180, 175]),
            (None, Some(NodeState::Running(..))) => of([40, 84, 130], [175, 208, 240]),
            (None, Some(NodeState::Fresh | NodeState::Stale)) => of([72; 3], [205; 3]),
            (None, None) => of([52; 3], [220; 3]),
        }
    }

    /// Mark at the right of the title.
    fn mark(&self, dark: bool) -> (String, Color32) {
        let weak = theme::weak(dark);
        match (&self.fault, self.status.map(|status| &status.state)) {
            (Some(_), _) | (None, Some(NodeState::Failed(_))) => ("✖".into(), theme::wrong(dark)),
            (None, Some(NodeState::Running(_, fraction))) if *fraction > 0.0 => {
                (format!("{:.0} %", 100.0 * fraction), theme::accent(dark))
            }
            (None, Some(NodeState::Running(..))) => ("…".into(), theme::accent(dark)),
            (None, Some(NodeState::Stale)) => ("stale".into(), weak),
            (None, Some(NodeState::Fresh)) => (self.seconds().map_or(String::new(), milliseconds), weak),
            (None, None) => ("–".into(), weak),
        }
    }

    fn seconds(&self) -> Option<f64> {
        self.status.and_then(|status| status.seconds)
    }

    /// Everything about it, for whoever points at it.
    pub fn description(&self, scene: &Scene) -> String {
        let state = match self.status.map(|status| &status.state) {
            Some(NodeState::Fresh) => match self.seconds() {
                Some(seconds) => format!("done; took {}", milliseconds(seconds)),
                None => "done".into(),
            },
            Some(NodeState::Stale) => "stale: will be made again".into(),
            Some(NodeState::Running(stage, fraction)) => format!("{stage} {:.0} %", 100.0 * fraction),
            Some(NodeState::Failed(error)) => error.clone(),
            None => format!("not needed: {}", self.idle(scene)),
        };
        // The same mistake may be known in other words: what it is stands before the colon.
        let what = |text: &str| text.split(':').next().map(str::to_string);
        let fault = self.fault.as_ref().filter(|fault| what(&state) != what(fault));
        let lines = [
            Some(format!("{} ({})", self.entry.name, self.entry.node_type.text().unwrap_or("no type"))),
            self.node.map(|node| node.summary.to_string()),
            Some(state),
            fault.cloned(),
        ];
        lines.into_iter().flatten().filter(|line| !line.is_empty()).collect::<Vec<_>>().join("\n")
    }

    /// Reason why it does not run for the picture.
    fn idle(&self, scene: &Scene) -> String {
        match (self.node, scene.shown_node) {
            (None, _) => "its type is not known".into(),
            (Some(node), _) if node.outputs.is_empty() => {
                "it writes a file, which a run does and the window never".into()
            }
            (Some(_), Some(shown)) => format!("nothing of it leads to the picture of '{shown}'"),
            (Some(_), None) => "no picture is shown".into(),
        }
    }
}

/// A text on one line, cut to a width.
fn one_line(ui: &Ui, text: &str, size: f32, color: Color32, width: f32) -> Arc<Galley> {
    let mut job = LayoutJob::simple_singleline(text.into(), FontId::proportional(size), color);
    job.wrap = TextWrapping::truncate_at_width(width);
    ui.fonts(|fonts| fonts.layout_job(job))
}

/// A text in small letters in the width of a node, of so many rows at most.
fn small(ui: &Ui, text: &str, rows: usize, zoom: f32) -> Arc<Galley> {
    let font = FontId::proportional(SMALL * zoom);
    let mut job = LayoutJob::simple(text.into(), font, Color32::PLACEHOLDER, INNER * zoom);
    job.wrap.max_rows = rows;
    ui.fonts(|fonts| fonts.layout_job(job))
}
