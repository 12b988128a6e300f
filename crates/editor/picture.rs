//! The picture: what the worker drew last, and the hand that moves the camera.

use crate::compare::Compare;
use crate::eyes::left_out;
use crate::fields::follow_arrows;
use crate::handles::Handles;
use crate::hit_marks;
use crate::outline::{Drawing, Outline, OutlineShape, enclosed};
pub(crate) use crate::scene::milliseconds;
use crate::scene::{Action, Command, EARLIER, ProbePurpose, Scene, command_buttons};
pub(crate) use crate::textures::{WHOLE, set_texture};
use crate::theme::{self, Help, button, switch};
use crate::view::View;
use crate::ways_out::{FEWER_PIXELS, ways_out_of_data};
use eframe::egui::scroll_area::ScrollSource;
use eframe::egui::{
    Align2, Button, Color32, ColorImage, ComboBox, CursorIcon, FontId, PointerButton, Pos2, Rect, Response,
    RichText, ScrollArea, Sense, Stroke, TextureHandle, TextureOptions, Ui, Vec2, WidgetInfo, WidgetType,
    pos2, vec2,
};
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Arc;
use std::time::Duration;
use voltet_document::panel::default_value;
use voltet_document::{Edit, Path, links};
use voltet_graph::{LocatedValue, NodeEntry, ParameterType};
use voltet_nodes::drawing::CLIP;

/// Radians that a drag over the height of the picture turns.
const TURN: f64 = PI;

/// Rays through the box about an outline that is probed, along each side at most.
const RAYS: usize = 16;

/// Shapes of what is probed: the words of their switches, and what they do.
const OUTLINES: &[(&str, OutlineShape, &str)] = &[
    ("box", OutlineShape::Box, "a drag probes the values in a box, as it does with Alt"),
    ("outline", OutlineShape::Free, "a drag probes the values in the outline that it draws"),
];

/// Width below which the choice of the picture and its buttons do not stand in one line, so that those of views and probes go into menus; and that
/// below which the section is left to the window's menu, and lengths to that of probes, points.
const HEAD: f32 = 770.0;
const SHORT_HEAD: f32 = 512.0;

/// Width below which all buttons go into one menu, points.
const TINY_HEAD: f32 = 250.0;

/// Factor of one notch of the wheel (50 points).
const NOTCH: f64 = 1.15;

const PICTURE_MENU: &[(&str, Command)] = &[
    ("All of the data", Command::Home),
    ("Isometric", Command::Isometric),
    ("Section", Command::Section),
    ("Costs and errors", Command::Costs),
    ("Run: write the files", Command::Run),
];

/// A small picture, and what its texture holds.
struct Thumbnail {
    holds: Arc<ColorImage>,
    texture: TextureHandle,
}

#[derive(Default)]
pub(crate) struct PicturePanel {
    texture: Option<TextureHandle>,
    previews: HashMap<String, Thumbnail>,
    /// Contents of the texture: the request, and true for its full picture.
    holds: Option<(u64, bool)>,
    /// Shape of the outline to be probed that a drag draws; a box is drawn with Alt, too, which some window managers keep for themselves.
    probes: Option<OutlineShape>,
    outline: Outline,
    /// True if clicks are the ends of a length.
    measures: bool,
    /// Place under the pointer, where it rests.
    pub hovered: Option<[f64; 2]>,
    pub handles: Handles,
    /// True if each pixel of the picture is one of the screen.
    is_own_size: bool,
    /// True if the middle of the picture is to be seen.
    is_to_centre: bool,
    pub compare: Compare,
    pub rect: Option<Rect>,
    /// Pixels that it can show.
    pub room: [u32; 2],
}

impl PicturePanel {
    pub fn show(&mut self, ui: &mut Ui, scene: &Scene) {
        self.head(ui, scene);
        // What no camera gives a size has that of its pixels.
        let of_pixels = || {
            let pixels = scene.pixels.as_ref()?;
            Some([pixels.picture.width, pixels.picture.height].map(|length| length as u32 * pixels.divisor))
        };
        let own = scene.picture_size.or_else(of_pixels).filter(|_| self.is_own_size);
        let own = own.map(|[width, height]| vec2(width as f32, height as f32) / ui.pixels_per_point());
        match own {
            Some(_) => {
                let mut area = ScrollArea::both().scroll_source(ScrollSource::SCROLL_BAR);
                if let Some(size) = own.filter(|_| std::mem::take(&mut self.is_to_centre)) {
                    area = area.scroll_offset((0.5 * (size - ui.available_size())).max(Vec2::ZERO));
                }
                area.show(ui, |ui| self.image(ui, scene, own));
            }
            None => self.image(ui, scene, None),
        }
    }

    /// Leaves what a hand does in the picture beside turning it, else ends the comparison; false if there was none.
    pub fn leave_mode(&mut self) -> bool {
        let was_probing = self.probes.take().is_some();
        was_probing || std::mem::take(&mut self.measures) || self.compare.end()
    }

    /// The picture of a size, points, else as large as fits.
    fn image(&mut self, ui: &mut Ui, scene: &Scene, own: Option<Vec2>) {
        let least = own.unwrap_or(vec2(16.0, 16.0));
        let (rect, response) =
            ui.allocate_exact_size(ui.available_size().max(least), Sense::click_and_drag());
        let (whole, rect) = (rect, self.compare.room(rect));
        let room = own.unwrap_or(whole.size()) * ui.pixels_per_point();
        self.room = [room.x.round().max(1.0) as u32, room.y.round().max(1.0) as u32];
        self.take(ui, scene);
        let aspect = scene.picture_size.map_or(4.0 / 3.0, |[width, height]| width as f32 / height as f32);
        let size = if rect.width() > rect.height() * aspect {
            vec2(rect.height() * aspect, rect.height())
        } else {
            vec2(rect.width(), rect.width() / aspect)
        };
        let picture = Rect::from_center_size(rect.center(), own.unwrap_or(size));
        self.rect = Some(picture);
        let texture = self.texture.as_ref().filter(|_| scene.pixels.is_some());
        // The opaque picture covers what is not filled.
        let inner = if texture.is_some() { picture.shrink(1.0) } else { Rect::NOTHING };
        for around in beside(whole, inner) {
            ui.painter().rect_filled(around, 0.0, Color32::BLACK);
        }
        if let Some(texture) = texture {
            ui.painter().image(texture.id(), picture, WHOLE, theme::tint(scene.is_earlier()));
        }
        self.compare.over(ui, scene, whole, picture);
        self.over(ui, scene, rect);
        let bare = response.clone();
        // A hand that probes or measures takes hold of nothing.
        let response = if scene.view.is_some() && self.probes.is_none() && !self.measures {
            self.handles.show(ui, scene, picture, response)
        } else {
            self.handles = Handles::default();
            response
        };
        if let Some(view) = scene.view {
            triad(ui, picture.intersect(ui.clip_rect()), view);
            self.hand(ui, scene, &response, view);
        }
        self.compare.controls(ui, scene, whole, picture);
        let before = self.hovered;
        self.hovered = scene.view.and_then(|_| hovered(ui, &response, picture, before));
        if before.is_some() && self.hovered.is_none() {
            // Its words and its mark are gone in the next frame.
            ui.ctx().request_repaint();
        }
        hit_marks::show(ui, scene, picture, self.measures, &self.handles.places);
        let name = format!("picture {}", scene.shown_node.unwrap_or("none"));
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Image, true, &name));
        response.context_menu(|ui| command_buttons(ui, scene.actions, PICTURE_MENU));
        match scene.view {
            // Nothing follows the hand.
            None => {}
            Some(_) if self.probes.is_some() || self.measures => {
                drop(bare.on_hover_cursor(CursorIcon::Crosshair))
            }
            Some(_) => drop(bare.on_hover_cursor(CursorIcon::Grab)),
        }
    }

    pub fn texture_of(&self, scene: &Scene, node: &str) -> Option<TextureHandle> {
        if scene.shown_node == Some(node) {
            return self.texture.clone().filter(|_| scene.pixels.is_some());
        }
        self.previews.get(node).map(|small| small.texture.clone())
    }

    /// Choice of the picture, and of the pointer's mode.
    fn head(&mut self, ui: &mut Ui, scene: &Scene) {
        ui.horizontal_wrapped(|ui| {
            let pictures = scene.pictures();
            let shown = scene.shown_node.unwrap_or("no picture");
            let room = ui.available_size_before_wrap().x;
            ComboBox::from_id_salt("shown").selected_text(shown).width(90.0).show_ui(ui, |ui| {
                let mut entries = Vec::new();
                for name in pictures {
                    let is_shown = scene.shown_node == Some(name);
                    let entry = ui.selectable_label(is_shown, name);
                    if entry.clicked() {
                        scene.actions.push(Action::Show(name.to_string()));
                        ui.close();
                    }
                    entries.push((entry, is_shown));
                }
                follow_arrows(ui, &entries);
            });
            ui.add_enabled_ui(scene.view.is_some(), |ui| {
                if room < TINY_HEAD {
                    ui.menu_button("more", |ui| self.buttons(ui, scene, room));
                } else {
                    self.buttons(ui, scene, room);
                }
            });
        });
    }

    /// Buttons of views, probes and cuts, in a room of this width.
    fn buttons(&mut self, ui: &mut Ui, scene: &Scene, room: f32) {
        use crate::scene::Command::{Along, Home, Isometric, Roll, Section};
        let (is_narrow, has_section) = (room < HEAD, room > SHORT_HEAD);
        let buttons = |ui: &mut Ui, all: &[(&str, Command, &str)]| {
            for (text, command, help) in all {
                // The name without a pointer is the help without its key.
                let name = help.split(" (").next().unwrap_or(help);
                if button(ui, text, name, help).clicked() {
                    scene.actions.command(*command);
                }
            }
        };
        buttons(ui, &[("Home", Home, "all of the data into the picture (H)")]);
        let views = [
            ("+x", Along(0, true), "seen from +x (X)"),
            ("−x", Along(0, false), "seen from −x (Shift+X)"),
            ("+y", Along(1, true), "seen from +y (Y)"),
            ("−y", Along(1, false), "seen from −y (Shift+Y)"),
            ("+z", Along(2, true), "seen from +z (Z)"),
            ("−z", Along(2, false), "seen from −z (Shift+Z)"),
            ("iso", Isometric, "seen from the positive sides of x, y and z alike (I)"),
            ("⟲", Roll(true), "roll to the left (,)"),
            ("⟳", Roll(false), "roll to the right (.)"),
        ];
        if is_narrow {
            ui.menu_button("views", |ui| ui.horizontal(|ui| buttons(ui, &views)));
        } else {
            buttons(ui, &views);
        }
        if is_narrow {
            let chosen = OUTLINES.iter().find(|(_, shape, _)| self.probes == Some(*shape));
            let title = chosen.map_or("probe", |(text, ..)| text);
            ui.menu_button(title, |ui| {
                ui.horizontal(|ui| {
                    self.outlines(ui);
                    (!has_section).then(|| self.measure(ui));
                })
            });
        } else {
            self.outlines(ui);
        }
        has_section.then(|| self.measure(ui));
        cut_menu(ui, scene);
        let help = "a pixel of the picture is a pixel of the screen";
        if switch(ui, self.is_own_size, "1:1", help).clicked() {
            self.is_own_size = !self.is_own_size;
            self.is_to_centre = self.is_own_size;
        }
        self.compare.button(ui, scene);
        if has_section {
            buttons(ui, &[("section", Section, "s on a plane through the data (K)")]);
        }
    }

    /// Switch of the lengths that clicks measure.
    fn measure(&mut self, ui: &mut Ui) {
        let help = "the distance between the points at two clicks";
        if switch(ui, self.measures, "measure", help).clicked() {
            self.measures = !self.measures;
        }
    }

    /// Switches of the outlines that a drag draws.
    fn outlines(&mut self, ui: &mut Ui) {
        for (text, shape, help) in OUTLINES {
            let is_chosen = self.probes == Some(*shape);
            if switch(ui, is_chosen, text, help).clicked() {
                self.probes = Some(*shape).filter(|_| !is_chosen);
            }
        }
    }

    fn take(&mut self, ui: &Ui, scene: &Scene) {
        self.previews.retain(|node, _| scene.previews.contains_key(node));
        for (node, pixels) in &scene.previews {
            if self.previews.get(node).is_none_or(|small| !Arc::ptr_eq(&small.holds, &pixels.image)) {
                let texture = ui.ctx().load_texture(node, pixels.image.clone(), TextureOptions::LINEAR);
                self.previews.insert(node.clone(), Thumbnail { holds: pixels.image.clone(), texture });
            }
        }
        let Some(pixels) = &scene.pixels else { return };
        if self.holds == Some((pixels.number, pixels.is_full())) {
            return;
        }
        set_texture(&mut self.texture, ui, "picture", pixels.image.clone(), TextureOptions::LINEAR);
        self.holds = Some((pixels.number, pixels.is_full()));
    }

    /// Text over the picture: the reason for which there is none, or that it is being drawn.
    fn over(&self, ui: &mut Ui, scene: &Scene, rect: Rect) {
        let dark = true; // The ground is black.
        // `below`: height of what stands below the text.
        let say = |ui: &Ui, text: &str, color: Color32, below: f32| {
            let galley =
                ui.painter().layout(text.into(), FontId::proportional(14.0), color, rect.width() - 40.0);
            let middle = rect.center() - vec2(0.0, 0.5 * below);
            let place = Align2::CENTER_CENTER.anchor_size(middle, galley.size());
            let place = place.translate(vec2(0.0, (rect.top() + 8.0 - place.top()).max(0.0)));
            ui.painter().rect_filled(place.expand(8.0), 4.0, Color32::from_black_alpha(200));
            ui.painter().galley(place.min, galley, color);
            place
        };
        match (&scene.failure, scene.shown_node) {
            (_, None) => {
                say(ui, "No node gives a picture yet: add a renderer (Space).", Color32::from_gray(200), 0.0);
            }
            (Some(failure), Some(_)) => {
                let mut ways = ways_out_of_data(scene, failure);
                // The window draws no more pixels than it has room for, however many the camera asks for.
                let room = ui.ctx().pixels_per_point() * rect.size();
                let fits = |size: [u32; 2]| size[0] as f32 <= room.x && size[1] as f32 <= room.y;
                ways.retain(|(text, _)| text != FEWER_PIXELS || scene.picture_size.is_some_and(fits));
                let [size, step] = steps_of_buttons(ways.len(), rect.width());
                let whole = size + ways.len().saturating_sub(1) as f32 * step;
                let text = scene.reason("picture", failure);
                let place = say(ui, &text, theme::wrong(dark), whole.y + BELOW_TEXT);
                let first = place.center_bottom() + vec2(-0.5 * whole.x, BELOW_TEXT);
                let first = first.min(rect.max - whole).max(rect.min);
                for (place, (text, action)) in ways.into_iter().enumerate() {
                    let at = Rect::from_min_size(first + place as f32 * step, size);
                    if ui.put(at, Button::new(text).truncate()).clicked() {
                        scene.actions.push(action);
                    }
                }
            }
            (None, Some(_)) if scene.pixels.is_none() => {
                say(ui, scene.running.as_deref().unwrap_or("drawing …"), Color32::from_gray(200), 0.0);
            }
            (None, Some(_)) => {}
        }
        if scene.is_earlier() {
            let (font, color) = (FontId::proportional(12.0), Color32::from_gray(230));
            let galley = ui.painter().layout_no_wrap(format!("picture {EARLIER}"), font, color);
            let place = Rect::from_min_size(rect.min + vec2(10.0, 8.0), galley.size());
            ui.painter().rect_filled(place.expand(4.0), 4.0, Color32::from_black_alpha(200));
            ui.painter().galley(place.min, galley, color);
        }
    }

    /// A drag whose outline is probed, of a box also by Alt; true if one is drawn.
    fn outline(
        &mut self,
        ui: &Ui,
        scene: &Scene,
        response: &Response,
        picture: Rect,
        place: &dyn Fn(Pos2) -> [f64; 2],
    ) -> bool {
        let with_alt = ui.input(|input| input.modifiers.alt).then_some(OutlineShape::Box);
        match self.outline.follow(ui, response, picture, self.probes.or(with_alt)) {
            Drawing::Idle => return false,
            Drawing::Going => {}
            // Beside the picture alone, or a line: nothing lies within.
            Drawing::Done(corners) if !Rect::from_points(&corners).is_positive() => {}
            Drawing::Done(corners) => {
                let places = enclosed(&corners, grid(Rect::from_points(&corners)));
                let places = places.into_iter().map(place).collect();
                scene.actions.push(Action::Probe(places, ProbePurpose::Values));
            }
        }
        true
    }

    /// Drags and the wheel, as movements of the camera.
    fn hand(&mut self, ui: &Ui, scene: &Scene, response: &Response, view: View) {
        let Some(picture) = self.rect else { return };
        let height = f64::from(picture.height().max(1.0));
        let place = |at: Pos2| {
            let from = at - picture.center();
            [f64::from(from.x) / height, -f64::from(from.y) / height]
        };
        let delta = response.drag_delta();
        let by = [f64::from(delta.x) / height, -f64::from(delta.y) / height];
        if self.outline(ui, scene, response, picture, &place) {
            return;
        }
        let mut to = view;
        if delta != Vec2::ZERO {
            let modifiers = ui.input(|input| input.modifiers);
            let middle = response.dragged_by(PointerButton::Middle);
            let at = response.interact_pointer_pos().unwrap_or(picture.center());
            if response.dragged_by(PointerButton::Secondary) {
                let from = ui.input(|input| input.pointer.press_origin()).unwrap_or(at);
                to = to.zoomed((3.0 * by[1]).exp(), place(from));
            } else if middle || modifiers.shift {
                to = to.panned(by);
            } else if modifiers.command {
                let [x, y] = place(at);
                let angle = |x: f64, y: f64| y.atan2(x);
                to = to.rolled(angle(x - by[0], y - by[1]) - angle(x, y));
            } else {
                to = to.orbited([TURN * by[0], TURN * by[1]]);
            }
        }
        if let Some(at) = response.hover_pos() {
            let scroll =
                ui.input(|input| input.smooth_scroll_delta.y + 50.0 * 5.0 * (input.zoom_delta().ln()));
            if scroll != 0.0 {
                to = to.zoomed(NOTCH.powf(f64::from(scroll) / 50.0), place(at));
            }
        }
        let at = response.interact_pointer_pos().filter(|at| picture.contains(*at));
        if let Some(at) = at.filter(|_| response.clicked()) {
            let purpose = match (self.measures, response.double_clicked()) {
                (true, _) => ProbePurpose::Length,
                (false, true) => ProbePurpose::Centre,
                (false, false) => ProbePurpose::Values,
            };
            scene.actions.push(Action::Probe(vec![place(at)], purpose));
        }
        if to != view {
            scene.actions.push(Action::MoveCamera(to));
        }
    }
}

/// The parts of a box above, below, left and right of another, or all of it where that is none.
fn beside(whole: Rect, inner: Rect) -> Vec<Rect> {
    let inner = inner.intersect(whole);
    if !inner.is_positive() {
        return vec![whole];
    }
    let left = Rect { max: pos2(inner.left(), inner.bottom()), min: pos2(whole.left(), inner.top()) };
    let right = Rect { min: pos2(inner.right(), inner.top()), max: pos2(whole.right(), inner.bottom()) };
    let (above, below) = (whole.with_max_y(inner.top()), whole.with_min_y(inner.bottom()));
    [above, below, left, right].into_iter().filter(Rect::is_positive).collect()
}

/// Menu of the shapes by which the volume in the picture is cut: another clip of the node that draws it, which is selected.
fn cut_menu(ui: &mut Ui, scene: &Scene) {
    let node = scene.shown_node.and_then(|shown| {
        let feeding = links::upstream(&scene.document.pipeline().nodes, shown);
        let has_clips =
            |node: &&NodeEntry| scene.node_type(node).is_some_and(|of| of.parameter(CLIP.name).is_some());
        let gives_picture = |node: &&NodeEntry| scene.pictures().contains(&&*node.name);
        let nodes = scene.document.pipeline().nodes.iter();
        nodes.filter(|node| feeding.contains(&node.name)).find(|node| has_clips(node) && gives_picture(node))
    });
    let (Some(node), ParameterType::Kinds(kinds)) = (node, CLIP.parameter_type) else { return };
    let place = node.setting(CLIP.name).and_then(LocatedValue::list).map_or(0, |list| list.len());
    let menu = ui.menu_button("cut", |ui| {
        for kind in kinds {
            if ui.button(kind.name).help(kind.summary).clicked() {
                let entry = default_value(kind, &scene.data_extent());
                let (node, list) = (node.name.clone(), Path::from(CLIP.name));
                scene.actions.push(Action::Select([node.clone()].into()));
                scene.actions.edit(Edit::Insert { node, list, place, entry });
                ui.close();
            }
        }
    });
    menu.response.help("cuts the volume through its middle, a box from there to the highest corner; grips in the picture move the cut");
}

/// Distance of buttons from the text above them, points.
const BELOW_TEXT: f32 = 16.0;

/// Size of so many buttons, and the step from one to the next: side by side where there is room for that, else one below the other.
fn steps_of_buttons(count: usize, width: f32) -> [Vec2; 2] {
    let size = vec2(170.0f32.min(width), 28.0);
    let across = size.x + 8.0;
    let is_row = size.x + count.saturating_sub(1) as f32 * across <= width;
    [size, if is_row { vec2(across, 0.0) } else { vec2(0.0, size.y + 8.0) }]
}

/// Time for which the pointer rests before what is under it is asked for, seconds: none while it only passes.
const REST: f32 = 0.05;

/// Movement of a hand that rests, points.
const STILL: f64 = 2.0;

/// The place of the picture where a pointer over it rests, in heights from its middle, to the right and up.
fn hovered(ui: &Ui, response: &Response, picture: Rect, before: Option<[f64; 2]>) -> Option<[f64; 2]> {
    let at = response.hover_pos().filter(|at| picture.contains(*at))?;
    let (rest, is_down) =
        ui.input(|input| (input.pointer.time_since_last_movement(), input.pointer.any_down()));
    if is_down {
        return None;
    }
    let from = (at - picture.center()) / picture.height().max(1.0);
    let place = [f64::from(from.x), -f64::from(from.y)];
    if rest < REST {
        ui.ctx().request_repaint_after(Duration::from_secs_f32(REST - rest));
        let way = |before: &[f64; 2]| (before[0] - place[0]).hypot(before[1] - place[1]);
        return before.filter(|before| way(before) * f64::from(picture.height()) < STILL);
    }
    Some(place)
}

/// Length of an axis of the triad, and its distance from the corner, points.
const AXIS: f32 = 24.0;
const CORNER: f32 = 38.0;

/// Directions of the axes of the data, in the lower left corner of the picture; the nearest above the others.
fn triad(ui: &Ui, picture: Rect, view: View) {
    let Some([right, up]) = view.sides().filter(|_| picture.height() > 3.0 * CORNER) else { return };
    let towards = right.cross(up);
    let origin = picture.left_bottom() + vec2(CORNER, -CORNER);
    let mut axes = [("x", [235, 90, 80]), ("y", [110, 200, 90]), ("z", [100, 150, 255])]
        .into_iter()
        .enumerate()
        .map(|(k, (name, [r, g, b]))| {
            (towards[k], vec2(right[k] as f32, -up[k] as f32), name, Color32::from_rgb(r, g, b))
        })
        .collect::<Vec<_>>();
    axes.sort_by(|a, b| a.0.total_cmp(&b.0));
    for (_, way, name, color) in axes {
        ui.painter().line_segment([origin, origin + AXIS * way], Stroke::new(2.0, color));
        let at = origin + (AXIS + 8.0) * way;
        ui.painter().text(at, Align2::CENTER_CENTER, name, FontId::proportional(12.0), color);
    }
}

/// Places spread evenly over a box, no nearer to each other than three points.
fn grid(of: Rect) -> impl Iterator<Item = Pos2> {
    let count = |length: f32| ((length / 3.0).ceil() as usize).clamp(1, RAYS);
    let (wide, high) = (count(of.width()), count(of.height()));
    let at = |i: usize, count: usize| (i as f32 + 0.5) / count as f32;
    let places = (0..high).flat_map(move |row| (0..wide).map(move |column| (column, row)));
    places.map(move |(column, row)| of.lerp_inside(vec2(at(column, wide), at(row, high))))
}

pub(crate) fn status(ui: &mut Ui, scene: &Scene) {
    let dark = ui.visuals().dark_mode;
    if let Some(running) = &scene.running {
        ui.label(running.as_str());
    } else if let Some(pixels) = &scene.pixels {
        let [width, height] = pixels.size();
        let seconds = scene.seconds.map_or(String::new(), |s| format!(" · {}", milliseconds(s)));
        let engine = scene.report.as_ref().and_then(|report| report.engine.as_ref());
        let engine = engine.map_or(String::new(), |(engine, _)| format!(" · {engine}"));
        let earlier = if scene.is_earlier() { format!(" · {EARLIER}") } else { String::new() };
        let without = left_out(scene).map_or(String::new(), |text| format!(" · {text}"));
        let proposed = if scene.proposes { " · with a proposed widget" } else { "" };
        let text = format!("{width} × {height}{seconds}{engine}{earlier}{without}{proposed}");
        ui.label(RichText::new(text).color(theme::weak(dark)));
    }
}
