//! Colours, light and dark, and the shapes of ports.

use eframe::egui::{
    Button, Color32, Context, FontId, Id, Order, Painter, PopupAnchor, Pos2, Rect, RectAlign, Response, Rgba,
    Shape, Stroke, TextStyle, TextWrapMode, Theme, Tooltip, Ui, Visuals, WidgetInfo, WidgetText, WidgetType,
    vec2,
};
use voltet_graph::PortType;

/// Panels are clear: the window is cleared to their colour, which costs nothing, where each fill costs a software driver several milliseconds.
pub(crate) fn apply(ctx: &Context) {
    for (theme, visuals, grays) in
        [(Theme::Dark, Visuals::dark(), [36, 18, 210]), (Theme::Light, Visuals::light(), [250, 255, 30])]
    {
        let [window_fill, extreme_bg_color, text] = grays.map(Color32::from_gray);
        let (panel_fill, override_text_color) = (Color32::TRANSPARENT, Some(text));
        ctx.set_visuals_of(
            theme,
            Visuals { panel_fill, window_fill, extreme_bg_color, override_text_color, ..visuals },
        );
        ctx.style_mut_of(theme, |style| {
            // Labels are dragged with what they stand on.
            style.interaction.selectable_labels = false;
            // A blinking cursor would keep an idle window busy.
            style.visuals.text_cursor.blink = false;
            style.spacing.slider_width = 130.0;
            // What goes on beyond its end shows a bar.
            style.spacing.scroll.dormant_handle_opacity = 0.5;
            // Words beside values are read as they are.
            style.text_styles.insert(TextStyle::Small, FontId::proportional(10.5));
        });
    }
}

pub(crate) fn panel(dark: bool) -> Color32 {
    Color32::from_gray(if dark { 30 } else { 243 })
}

pub(crate) fn accent(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(255, 200, 80) } else { Color32::from_rgb(200, 110, 0) }
}

/// Colour of errors.
pub(crate) fn wrong(dark: bool) -> Color32 {
    if dark { Color32::from_rgb(255, 110, 100) } else { Color32::from_rgb(190, 20, 20) }
}

/// Tint of a picture: darker where it is of an earlier state.
pub(crate) fn tint(is_earlier: bool) -> Color32 {
    if is_earlier { Color32::from_gray(90) } else { Color32::WHITE }
}

/// A colour as it can be told from the ground that it is drawn on: a dark one lighter, a bright one darker, of the same hue.
pub(crate) fn readable(color: Color32, dark: bool) -> Color32 {
    let [r, g, b] = [color.r(), color.g(), color.b()].map(f32::from);
    // The luma of Rec. 601.
    let luma = 0.299 * r + 0.587 * g + 0.114 * b;
    let (least, most) = if dark { (90.0, 255.0) } else { (0.0, 150.0) };
    let lighter = ((least - luma) / (255.0 - luma).max(1.0)).max(0.0);
    let darker = (most / luma.max(1.0)).min(1.0);
    let [r, g, b] = [r, g, b].map(|x| (darker * (x + lighter * (255.0 - x))).round() as u8);
    Color32::from_rgb(r, g, b)
}

/// A linear colour on the screen; what is brighter than it is clamped.
pub(crate) fn on_screen(linear: [f64; 3]) -> Color32 {
    let [r, g, b] = linear.map(|x| x.clamp(0.0, 1.0) as f32);
    Rgba::from_rgb(r, g, b).into()
}

/// Colour of secondary text, still easy to read.
pub(crate) fn weak(dark: bool) -> Color32 {
    if dark { Color32::from_gray(165) } else { Color32::from_gray(85) }
}

pub(crate) fn ground(dark: bool) -> Color32 {
    if dark { Color32::from_gray(22) } else { Color32::from_gray(226) }
}

/// A small button of a sign, with the name by which it is found without a pointer, and help.
pub(crate) fn button(ui: &mut Ui, sign: &str, name: &str, help: &str) -> Response {
    let response = ui.small_button(sign);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, name));
    response.help(help)
}

/// A small button that is on or off, with help.
pub(crate) fn switch(ui: &mut Ui, is_on: bool, text: &str, help: &str) -> Response {
    ui.add(Button::new(text).small().selected(is_on)).help(help)
}

/// Place of help: at the right of a rectangle, or at its left where there is no room; or below the control, near the pointer.
enum HelpPlace {
    Beside(Rect),
    Below,
}

/// Place in egui's memory of the time at which help was hidden.
const HIDDEN_AT: &str = "help was hidden at";

/// Hides help and words beside the pointer until it moves.
pub(crate) fn hide_help(ctx: &Context) {
    let now = ctx.input(|input| input.time);
    ctx.data_mut(|data| data.insert_temp(Id::new(HIDDEN_AT), now));
}

fn is_help_hidden(ctx: &Context) -> bool {
    let hidden_at = ctx.data(|data| data.get_temp::<f64>(Id::new(HIDDEN_AT)));
    let moved_at = ctx.input(|input| input.time - f64::from(input.pointer.time_since_last_movement()));
    // The time since is less exact than the time.
    hidden_at.is_some_and(|hidden_at| moved_at < hidden_at + 1e-3)
}

/// Width of controls up to which help below them begins where they do, points.
const WIDE_WIDTH: f32 = 160.0;

/// Shows help of a control while the pointer is over what is seen of it. Returns the response.
fn with_help(response: Response, place: HelpPlace, help: &str) -> Response {
    // egui keeps help open over all of the control, also where other things cover it.
    let mut seen = response.clone();
    seen.rect = response.interact_rect;
    let Some(at) = response.ctx.pointer_hover_pos().filter(|_| !is_help_hidden(&response.ctx)) else {
        return response;
    };
    if !response.ctx.rect_contains_pointer(response.layer_id, seen.rect) {
        return response;
    }
    let mut tooltip = match response.enabled() {
        true => Tooltip::for_enabled(&seen),
        false => Tooltip::for_disabled(&seen),
    };
    match place {
        HelpPlace::Beside(rect) => {
            let beside = Rect::from_x_y_ranges(rect.x_range(), seen.rect.y_range());
            let aligns = &[RectAlign::LEFT, RectAlign::BOTTOM, RectAlign::TOP];
            tooltip.popup = tooltip.popup.anchor(beside).align(RectAlign::RIGHT).align_alternatives(aligns);
        }
        HelpPlace::Below if seen.rect.width() > WIDE_WIDTH => {
            let near = Rect::from_x_y_ranges((at.x - GAP)..=(at.x + GAP), seen.rect.y_range());
            tooltip.popup = tooltip.popup.anchor(near);
        }
        HelpPlace::Below => {}
    }
    tooltip.show(|ui| {
        ui.set_max_width(ui.spacing().tooltip_width);
        ui.label(help)
    });
    response
}

/// Help of controls, where the pointer rests on them.
pub(crate) trait Help {
    /// Shows help: of a control near the right end of a menu or sheet beside that, so that it covers none of the others; else below the
    /// control.
    fn help(self, help: impl AsRef<str>) -> Self;

    /// Shows, as help of a control that is disabled, why it is.
    fn why_disabled(self, why: &str) -> Self;

    /// Shows help at the right, of controls that stand below each other.
    fn help_at_right(self, help: impl AsRef<str>) -> Self;
}

impl Help for Response {
    fn help(self, help: impl AsRef<str>) -> Response {
        if !self.enabled() {
            return self;
        }
        let id = self.layer_id.id;
        let is_panes = self.layer_id.order == Order::Background;
        let sheet = self.ctx.memory(|memory| memory.area_rect(id)).filter(|_| !is_panes);
        let near = sheet.filter(|sheet| sheet.right() - self.rect.right() < WIDE_WIDTH);
        with_help(self, near.map_or(HelpPlace::Below, HelpPlace::Beside), help.as_ref())
    }

    fn why_disabled(self, why: &str) -> Response {
        if self.enabled() { self } else { with_help(self, HelpPlace::Below, why) }
    }

    fn help_at_right(self, help: impl AsRef<str>) -> Response {
        let rect = self.rect;
        with_help(self, HelpPlace::Beside(rect), help.as_ref())
    }
}

/// Width of words beside what is pointed at, and their distance from it, points.
const TOOLTIP_WIDTH: f32 = 320.0;
const GAP: f32 = 6.0;

/// Shows words beside the pointer, a little away from it, so that they cover nothing that is pointed at.
pub(crate) fn words_at_pointer(ui: &Ui, name: &str, words: impl Into<WidgetText>) {
    let (ctx, id) = (ui.ctx().clone(), ui.id().with(name));
    if is_help_hidden(&ctx) {
        return;
    }
    let tooltip =
        Tooltip::always_open(ctx, ui.layer_id(), id, PopupAnchor::Pointer).gap(16.0).width(TOOLTIP_WIDTH);
    tooltip.show(|ui| ui.label(words));
}

/// Area of others, square points, that words cover rather than being a point further from the pointer.
const AREA_PER_POINT: f32 = 100.0;

/// Shows words beside a rectangle of the window, near the pointer, where they cover little of others: next to it, else above or below all of
/// them, or beside.
pub(crate) fn words_beside(ui: &Ui, name: &str, rect: Rect, others: &[Rect], words: impl Into<WidgetText>) {
    if is_help_hidden(ui.ctx()) {
        return;
    }
    let words = words.into();
    let galley = words.clone().into_galley(ui, Some(TextWrapMode::Wrap), TOOLTIP_WIDTH, TextStyle::Body);
    let size = galley.size() + ui.spacing().menu_margin.sum();
    let (ctx, id) = (ui.ctx().clone(), ui.id().with(name));
    let (window, pointer) = (ctx.content_rect(), ctx.pointer_hover_pos());
    let common = |one: Rect, other: Rect| {
        let both = one.intersect(other);
        if both.is_positive() { both.area() } else { 0.0 }
    };
    let all = others.iter().fold(rect, |all, other| all.union(*other)).intersect(window.expand(1.0));
    let column = Rect::from_x_y_ranges(rect.x_range(), all.y_range());
    let row = Rect::from_x_y_ranges(all.x_range(), rect.y_range());
    let places = [rect, column, row].into_iter();
    let places = places.flat_map(|beside| RectAlign::MENU_ALIGNS.map(|align| (beside, align)));
    let covered = |(beside, align): &(Rect, RectAlign)| {
        let own = align.align_rect(beside, size, GAP);
        // What does not fit into the window is pushed back over the rectangle itself.
        let outside = own.area() - common(own, window);
        let distance = pointer.map_or(0.0, |at| own.distance_to_pos(at));
        others.iter().map(|other| common(own, *other)).sum::<f32>()
            + 10.0 * outside
            + AREA_PER_POINT * distance
    };
    let best = places.min_by(|one, other| covered(one).total_cmp(&covered(other)));
    let (beside, align) = best.unwrap_or((rect, RectAlign::default()));
    let mut tooltip = Tooltip::always_open(ctx, ui.layer_id(), id, beside).gap(GAP).width(TOOLTIP_WIDTH);
    tooltip.popup = tooltip.popup.align(align).align_alternatives(&[]);
    tooltip.show(|ui| ui.label(words));
}

/// The colour of a port type: hues apart also for most who see few of them, which the shapes serve besides.
pub(crate) fn port_color(port_type: PortType, dark: bool) -> Color32 {
    let [r, g, b] = match port_type {
        PortType::Grid => [86, 156, 230],
        PortType::Volume => [60, 190, 180],
        PortType::TransferFunction => [226, 120, 200],
        PortType::Camera => [235, 190, 70],
        PortType::Cells => [120, 200, 90],
        PortType::Projection => [170, 200, 60],
        PortType::Image => [240, 120, 80],
        PortType::Report => [170, 170, 180],
        PortType::CellValues => [160, 130, 240],
        PortType::Surface => [200, 150, 110],
    };
    let color = Color32::from_rgb(r, g, b);
    // On white the same hues, darker.
    if dark { color } else { color.lerp_to_gamma(Color32::BLACK, 0.3) }
}

/// The shape of a port: round for what lies in space, a diamond for a transfer function, a triangle for a camera, a square
/// for pictures, a bar for figures.
pub(crate) fn port(painter: &Painter, at: Pos2, radius: f32, port_type: PortType, dark: bool, is_fed: bool) {
    let color = port_color(port_type, dark);
    let fill = if is_fed { color } else { ground(dark) };
    let stroke = Stroke::new((radius * 0.4).max(1.0), color);
    let polygon = |corners: &[(f32, f32)]| {
        let points = corners.iter().map(|&(x, y)| at + radius * vec2(x, y)).collect();
        Shape::convex_polygon(points, fill, stroke)
    };
    painter.add(match port_type {
        PortType::Grid | PortType::Volume | PortType::Surface | PortType::Cells | PortType::Projection => {
            Shape::Circle(eframe::egui::epaint::CircleShape { center: at, radius, fill, stroke })
        }
        PortType::TransferFunction => polygon(&[(0.0, -1.25), (1.25, 0.0), (0.0, 1.25), (-1.25, 0.0)]),
        PortType::Camera => polygon(&[(-0.95, -1.1), (1.25, 0.0), (-0.95, 1.1)]),
        PortType::Image => polygon(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]),
        PortType::Report | PortType::CellValues => {
            polygon(&[(-0.6, -1.1), (0.6, -1.1), (0.6, 1.1), (-0.6, 1.1)])
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable;

    /// A control that is 700 points wide, of which a part is seen.
    fn pointed_at(seen: f32) -> impl FnMut(f32) -> Option<Rect> {
        let mut harness = Harness::builder().with_size([900.0, 200.0]).build_ui(move |ui| {
            ui.set_clip_rect(Rect::from_min_size(Pos2::ZERO, vec2(seen, 200.0)));
            ui.add_sized([700.0, 20.0], eframe::egui::Label::new("control")).help("words");
        });
        move |x: f32| {
            harness.input_mut().events.push(eframe::egui::Event::PointerMoved(Pos2::new(x, 18.0)));
            harness.run_steps(8);
            harness.query_by_label("words").map(|words| words.rect())
        }
    }

    #[test]
    fn help_is_near_the_pointer_and_goes_with_it() {
        let mut pointed_at = pointed_at(900.0);
        for x in [60.0, 300.0, 640.0] {
            let words = pointed_at(x).expect("it is shown");
            assert!((words.left() - x).abs() < 30.0 && words.top() > 18.0, "{words} at {x}");
        }
        assert_eq!(pointed_at(850.0), None);
    }

    /// egui leaves it open over all of the control.
    #[test]
    fn help_is_gone_where_the_control_is_covered() {
        let mut pointed_at = pointed_at(400.0);
        assert!(pointed_at(300.0).is_some());
        assert_eq!(pointed_at(500.0), None);
    }

    #[test]
    fn colours_are_told_from_the_ground_and_others_stay_as_they_are() {
        let luma =
            |c: Color32| 0.299 * f32::from(c.r()) + 0.587 * f32::from(c.g()) + 0.114 * f32::from(c.b());
        for color in [Color32::BLACK, Color32::from_rgb(10, 0, 60), Color32::from_rgb(60, 0, 0)] {
            assert!(luma(readable(color, true)) > 85.0 && readable(color, false) == color, "{color:?}");
        }
        for color in [Color32::WHITE, Color32::from_rgb(255, 240, 90)] {
            assert!(luma(readable(color, false)) < 155.0 && readable(color, true) == color, "{color:?}");
        }
        let orange = Color32::from_rgb(220, 110, 40);
        assert_eq!([true, false].map(|dark| readable(orange, dark)), [orange; 2]);
    }
}
