//! The focus of the keyboard: kept within the sheet that has the keys, brought into view where it is scrolled, and marked by a ring.

use eframe::egui::scroll_area::ScrollAreaOutput;
use eframe::egui::style::ScrollAnimation;
use eframe::egui::{
    Context, FocusDirection, Id, Key, LayerId, Modifiers, Order, Rect, ScrollArea, StrokeKind, Ui,
    WidgetRect, Window, vec2,
};

/// A sheet over the panes, by the usual title of its window.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Sheet(&'static str);

impl Sheet {
    pub const TEXT: Self = Self("Text of the pipeline");
    pub const KEYS: Self = Self("Keys and mouse");
    pub const FILM: Self = Self("Film");
    pub const STUDY: Self = Self("Study: error against time");
    pub const COSTS: Self = Self("Costs");
    pub const FILE: Self = Self("Choice of a file");
    pub const SECTION: Self = Self("Section: s on a plane");

    pub fn window(self) -> Window<'static> {
        Window::new(self.0).id(self.id()).collapsible(false)
    }

    /// The id of its window, by which it has the keys.
    pub fn id(self) -> Id {
        Id::new(self.0)
    }
}

/// Way of a key in a sheet that scrolls, in steps down.
#[derive(Debug, Clone, Copy)]
enum Scroll {
    Lines(f32),
    Pages(f32),
    ToStart,
    ToEnd,
}

/// Keys that scroll a sheet. A line is [`LINE`] points, a page nine tenths of what is seen.
const SCROLL_KEYS: [(Key, Scroll); 6] = [
    (Key::ArrowUp, Scroll::Lines(-1.0)),
    (Key::ArrowDown, Scroll::Lines(1.0)),
    (Key::PageUp, Scroll::Pages(-0.9)),
    (Key::PageDown, Scroll::Pages(0.9)),
    (Key::Home, Scroll::ToStart),
    (Key::End, Scroll::ToEnd),
];
const LINE: f32 = 40.0;

/// Places in egui's memory: the sheet whose content goes on beyond its end, and what a key scrolls in this frame.
const SCROLLED: &str = "sheet that scrolls";
const STEP: &str = "step of a sheet that scrolls";

/// The sheet that has the keys: the one that was opened or pressed last, until a press elsewhere.
#[derive(Default)]
pub(crate) struct SheetKeys {
    open: Vec<Id>,
    pub sheet: Option<Id>,
}

impl SheetKeys {
    /// Follows which sheets are open, by the ids of their windows, those first that lie above others. Called before they are shown.
    pub fn follow(&mut self, ctx: &Context, open: Vec<Id>) {
        let pressed = ctx.input(|input| input.pointer.interact_pos().filter(|_| input.pointer.any_pressed()));
        let pressed = pressed.and_then(|at| ctx.layer_id_at(at));
        if let Some(new) = open.iter().find(|sheet| !self.open.contains(sheet)) {
            self.sheet = Some(*new);
        } else if self.sheet.is_some_and(|sheet| !open.contains(&sheet)) {
            self.sheet = open.first().copied();
        } else if let Some(layer) = pressed.filter(|layer| layer.order <= Order::Middle) {
            self.sheet = Some(layer.id).filter(|id| open.contains(id));
        }
        self.open = open;
    }

    fn layer(&self) -> Option<LayerId> {
        self.sheet.map(|sheet| LayerId::new(Order::Middle, sheet))
    }

    /// Has Tab go from control to control of the sheet, after the last one to the first. Called before anything is shown.
    pub fn take_tab(&self, ctx: &Context) {
        let Some(layer) = self.layer() else { return };
        let controls: Vec<Id> = ctx.viewport(|viewport| {
            let all = viewport.prev_pass.widgets.get_layer(layer);
            all.filter(|control| control.enabled && control.sense.is_focusable())
                .map(|control| control.id)
                .collect()
        });
        let [back, on] = [Modifiers::SHIFT, Modifiers::NONE]
            .map(|held| ctx.input_mut(|input| input.consume_key(held, Key::Tab)));
        if !back && !on {
            return;
        }
        ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
        let Some(last) = controls.len().checked_sub(1) else { return };
        let at = ctx
            .memory(|memory| memory.focused())
            .and_then(|id| controls.iter().position(|known| *known == id));
        let next = match (at, back) {
            (Some(at), false) if at < last => at + 1,
            (_, false) => 0,
            (Some(at), true) if at > 0 => at - 1,
            (_, true) => last,
        };
        if let Some(next) = controls.get(next) {
            ctx.memory_mut(|memory| memory.request_focus(*next));
        }
    }

    /// Takes the keys that scroll the sheet, where it goes on beyond its end. Called before anything is shown.
    pub fn take_scroll(&self, ctx: &Context) {
        let Some(layer) = self.layer().filter(|_| !ctx.text_edit_focused()) else { return };
        if ctx.data(|data| data.get_temp::<LayerId>(Id::new(SCROLLED))) != Some(layer) {
            return;
        }
        let pressed = SCROLL_KEYS
            .into_iter()
            .find(|(key, _)| ctx.input_mut(|input| input.consume_key(Modifiers::NONE, *key)));
        if let Some((_, step)) = pressed {
            ctx.memory_mut(|memory| memory.move_focus(FocusDirection::None));
            ctx.data_mut(|data| data.insert_temp(Id::new(STEP), (layer, step)));
        }
    }
}

/// Areas that scroll to what gains the focus by a key, and sheets that scroll by keys.
pub(crate) trait FollowFocus {
    fn show_followed<R>(self, ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> ScrollAreaOutput<R>;
}

impl FollowFocus for ScrollArea {
    fn show_followed<R>(self, ui: &mut Ui, add: impl FnOnce(&mut Ui) -> R) -> ScrollAreaOutput<R> {
        self.show(ui, |ui| {
            let inner = add(ui);
            follow(ui);
            inner
        })
    }
}

/// Brings what gained the focus by a key into view, and scrolls by keys where the area is that of the sheet that has them. Called at the
/// end of what an area shows.
pub(crate) fn follow(ui: &Ui) {
    scroll_by_key(ui);
    let known = ui.id().with("focus");
    let now = ui.memory(|memory| memory.focused());
    if ui.data_mut(|data| data.get_temp::<Option<Id>>(known)).flatten() == now {
        return;
    }
    ui.data_mut(|data| data.insert_temp(known, now));
    let by_pointer = ui.input(|input| input.pointer.any_down() || input.pointer.any_released());
    let (false, Some(focused)) = (by_pointer, focused(ui.ctx())) else { return };
    let (all, seen) = (ui.min_rect(), focused.interact_rect);
    let is_elsewhere = seen.is_positive() && !ui.clip_rect().intersects(seen);
    if focused.layer_id == ui.layer_id() && all.contains(focused.rect.center()) && !is_elsewhere {
        // With its name, where that stands above it.
        let room = focused.rect.expand2(vec2(0.0, ui.spacing().interact_size.y));
        ui.scroll_to_rect(room.intersect(all), None);
    }
}

fn scroll_by_key(ui: &Ui) {
    let (all, seen, layer) = (ui.min_rect(), ui.clip_rect(), ui.layer_id());
    if layer.order == Order::Middle && all.height() > seen.height() + 1.0 {
        ui.data_mut(|data| data.insert_temp(Id::new(SCROLLED), layer));
    } else if ui.data(|data| data.get_temp::<LayerId>(Id::new(SCROLLED))) == Some(layer) {
        ui.data_mut(|data| data.remove::<LayerId>(Id::new(SCROLLED)));
    }
    let step = ui.data(|data| data.get_temp::<(LayerId, Scroll)>(Id::new(STEP)));
    let Some((_, step)) = step.filter(|(of, _)| *of == layer) else { return };
    ui.data_mut(|data| data.remove::<(LayerId, Scroll)>(Id::new(STEP)));
    let down = match step {
        Scroll::Lines(count) => count * LINE,
        Scroll::Pages(count) => count * seen.height(),
        Scroll::ToStart => all.top() - seen.top(),
        Scroll::ToEnd => all.bottom() - seen.bottom(),
    };
    ui.scroll_with_delta_animation(vec2(0.0, -down), ScrollAnimation::none());
}

/// Place of what has the focus. Its response is not read: that would take the focus away again where a press elsewhere has just given it.
fn focused(ctx: &Context) -> Option<WidgetRect> {
    let id = ctx.memory(|memory| memory.focused())?;
    ctx.viewport(|viewport| {
        let [now, before] = [&viewport.this_pass, &viewport.prev_pass].map(|pass| pass.widgets.get(id));
        now.or(before).copied()
    })
}

/// True if what has the focus lies in a rectangle of the panes.
pub(crate) fn is_within(ctx: &Context, rect: Rect) -> bool {
    focused(ctx).is_some_and(|focused| {
        focused.layer_id.order == Order::Background && rect.contains(focused.rect.center())
    })
}

/// Draws a ring around what has the focus; fields of text show it by themselves. Called after everything was shown.
pub(crate) fn ring(ctx: &Context) {
    let Some(focused) = focused(ctx).filter(|_| !ctx.text_edit_focused()) else { return };
    let stroke = ctx.global_style().visuals.selection.stroke;
    let rect = focused.interact_rect;
    if rect.is_positive() {
        let painter = ctx.layer_painter(focused.layer_id);
        painter.rect_stroke(rect, 3.0, (2.0, stroke.color), StrokeKind::Middle);
    }
}
