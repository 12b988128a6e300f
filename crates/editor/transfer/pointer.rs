//! Mouse in the plane: panning and zooming, dragging widgets, adding and removing points.

use super::edited_function::{EditedFunction, axis_name};
use super::plane::{self, Handle, Plane, height_of};
use super::screen_widget::{Drag, Grip, Region, ScreenWidget};
use super::{TransferPanel, edit};
use crate::theme;
use eframe::egui::{self, PointerButton, Popup, Pos2, SetOpenCommand, Ui, Vec2};

/// Distance from a handle, or from a curve, within which a pointer hits it (points).
const NEAR: f32 = 9.0;

/// Factor of a zoom by one notch of the wheel (50 points).
const NOTCH: f64 = 1.2;

/// With Alt a drag goes so much of the hand's way.
pub(super) const FINE: f64 = 0.2;

/// Coverage of a position above which a press hits the widget there.
const COVERS: f64 = 0.13;

impl TransferPanel {
    /// Wheel and Shift-drag: which part of the plane is shown.
    pub(super) fn move_plane(&mut self, ui: &Ui, response: &egui::Response, plane: Plane) {
        if let Some(at) = response.hover_pos() {
            let (scroll, alt) = ui.input(|input| {
                let scroll = input.smooth_scroll_delta;
                // Some systems turn the wheel sideways where Alt is held.
                (if scroll.y == 0.0 { scroll.x } else { scroll.y }, input.modifiers.alt)
            });
            if scroll != 0.0 {
                let axis = usize::from(alt);
                let mut shown = plane.shown;
                let factor = NOTCH.powf(f64::from(scroll) / 50.0);
                shown[axis] = plane::zoomed(shown[axis], factor, plane.to_values(at)[axis]);
                self.shown = Some(shown);
            }
        }
        let pans = ui.input(|input| input.modifiers.shift) || response.dragged_by(PointerButton::Middle);
        let delta = response.drag_delta();
        if pans && self.drag.is_none() && delta != Vec2::ZERO {
            let by = plane.drag_in_values(-delta);
            let [s, g] = plane.shown;
            self.shown = Some([s.map(|x| x + by[0]), g.map(|x| x + by[1])]);
        }
    }

    pub(super) fn hand(&mut self, ui: &Ui, response: &egui::Response, look: &EditedFunction) {
        let plane = look.plane;
        let modifiers = ui.input(|input| input.modifiers);
        let press = ui.input(|input| input.pointer.press_origin());
        let at = response.interact_pointer_pos();
        if let Some(at) = at.filter(|_| response.double_clicked()) {
            self.add_point_or_show_all(plane.to_values(at), look);
            return;
        }
        if let Some(at) = at.filter(|_| response.clicked()) {
            self.before_click = self.chosen;
            self.take(at, look);
            self.drag = None;
        }
        let asked = at.filter(|_| response.secondary_clicked());
        let opens_menu = asked.is_some_and(|at| {
            let takes_point = self.take_point_away(at, look);
            if !takes_point {
                self.take(at, look);
                self.drag = None;
            }
            !takes_point
        });
        let menu =
            Popup::context_menu(response).open_memory(opens_menu.then_some(SetOpenCommand::Bool(true)));
        menu.show(|ui| self.menu(ui, look));
        let begins = response.drag_started_by(PointerButton::Primary) && !modifiers.shift;
        if let Some(at) = press.filter(|_| begins) {
            self.take(at, look);
        }
        let Some(drag) = &mut self.drag else { return };
        if response.drag_stopped() || !ui.input(|input| input.pointer.primary_down()) {
            self.drag = None;
            return;
        }
        let delta = response.drag_delta();
        if delta == Vec2::ZERO {
            return;
        }
        // From where it was taken hold of the hand may have gone a little before that was a drag.
        let delta = match at.filter(|_| begins) {
            Some(at) => at - drag.grip,
            None => delta,
        };
        let way = plane.drag_in_values(delta);
        let times = if modifiers.alt { FINE } else { 1.0 };
        (0..2).for_each(|k| drag.at[k] += times * way[k]);
        let by = [0, 1].map(|k: usize| drag.at[k] - drag.from[k]);
        let changes = match drag.handle {
            Some(handle) => drag.widget.moved(handle, plane.moved_place(drag.from, by), &plane),
            None => drag.widget.shifted(by, &plane),
        };
        let before = drag.widget.clone();
        edit(look, self.chosen, &before, changes);
    }

    /// A double click adds a point to a curve or polygon in hand, else all of the data is shown.
    fn add_point_or_show_all(&mut self, at: [f64; 2], look: &EditedFunction) {
        let has_points = |place: usize| look.widgets.get(place).is_some_and(ScreenWidget::has_points);
        let Some(place) = [self.chosen, self.before_click].into_iter().find(|place| has_points(*place))
        else {
            self.shown = None;
            return;
        };
        self.chosen = place;
        let widget = &look.widgets[place];
        let at = [0, 1].map(|axis: usize| look.plane.moved(axis, 0.0, at[axis]));
        if let Some((changes, handle)) = widget.with_point(at, &look.plane) {
            self.held = Some(handle);
            edit(look, place, widget, changes);
        }
    }

    /// Takes away the point of a curve or polygon that lies there; false where none does.
    fn take_point_away(&mut self, at: Pos2, look: &EditedFunction) -> bool {
        let Some(widget) = look.widgets.get(self.chosen) else { return false };
        let handle = nearest(&look.grips[self.chosen], at);
        let changes = handle.and_then(|handle| widget.without_point(handle));
        let takes = changes.is_some();
        if let Some(changes) = changes {
            self.held = None;
            edit(look, self.chosen, widget, changes);
        }
        takes
    }

    /// Names what a press would take.
    pub(super) fn hover(&mut self, ui: &Ui, response: &egui::Response, look: &EditedFunction) {
        let at = response.hover_pos().filter(|at| self.drag.is_none() && look.plane.rect.contains(*at));
        self.hovered = at.and_then(|at| self.target(at, look));
        let Some((place, handle)) = self.hovered.filter(|_| !Popup::is_any_open(ui.ctx())) else { return };
        let of = format!("widget {}: {}", place + 1, look.widgets[place].title());
        let axis = |axis: usize| axis_name(&look.axes[axis]);
        let words = match handle {
            None => of,
            Some(Handle::Side(k, is_upper)) => {
                let [end, beyond] = if is_upper { ["upper", "above"] } else { ["lower", "below"] };
                format!("{end} limit of the region of {of}\n{beyond} this {} the widget is 0", axis(k))
            }
            Some(handle @ Handle::Corner(_)) => {
                format!("{} of the region of {of}\noutside of the region the widget is 0", handle.name())
            }
            Some(Handle::Width(k)) => format!("width along {} of {of}", axis(k)),
            Some(handle) => format!("{} of {of}", handle.name()),
        };
        theme::words_at_pointer(ui, "widget", words);
    }

    /// Target of a press: a handle of the selected widget, another widget, or nothing.
    fn target(&self, at: Pos2, look: &EditedFunction) -> Option<(usize, Option<Handle>)> {
        let plane = look.plane;
        let value = plane.to_values(at);
        // Handles and lines of others come before what others cover; of what covers the place, the strongest.
        let mut in_turn = [self.chosen].into_iter().chain(0..look.widgets.len());
        let by_handle = in_turn.find_map(|place| Some((place, Some(nearest(look.grips.get(place)?, at)?))));
        let on_curve = || look.widgets.iter().position(|widget| is_on_curve(widget, at, plane));
        // What is everywhere, and lines, are taken by what is drawn of them alone.
        let local = || {
            let widgets = look.widgets.iter().enumerate();
            let strengths = widgets.filter(|(_, widget)| widget.is_area() && !is_everywhere(widget, look));
            let strengths = strengths.map(|(place, widget)| (place, widget.strength(value)));
            strengths.filter(|(_, strength)| *strength > COVERS).max_by(|a, b| a.1.total_cmp(&b.1))
        };
        let other = || on_curve().or_else(|| local().map(|(place, _)| place));
        by_handle.or_else(|| other().map(|place| (place, None)))
    }

    /// Starts a drag of the target of a press.
    fn take(&mut self, at: Pos2, look: &EditedFunction) {
        let plane = look.plane;
        let taken = self.target(at, look);
        self.held = taken.and_then(|(_, handle)| handle);
        let Some((place, handle)) = taken else { return };
        let widget = &look.widgets[place];
        let held = look.grips[place].iter().find(|grip| Some(grip.handle) == handle);
        let (from, grip) = held.map_or((plane.to_values(at), at), |held| (held.at, held.place));
        (self.chosen, self.is_last) = (place, true);
        self.drag = Some(Drag { widget: widget.clone(), handle, grip, from, at: from, peak: plane.peak });
    }
}

/// The handle that a pointer means.
pub(super) fn nearest(grips: &[Grip], at: Pos2) -> Option<Handle> {
    let by_distance = grips.iter().map(|grip| (grip.place.distance(at), grip.handle));
    let near = by_distance.filter(|(distance, _)| *distance <= NEAR);
    near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, handle)| handle)
}

fn is_on_curve(widget: &ScreenWidget, at: Pos2, plane: Plane) -> bool {
    let Some(peak) = widget.peak_of_curve() else { return false };
    let value = plane.to_values(at);
    let height = height_of(peak * widget.strength(value), plane.peak) * plane.top();
    (plane.to_window([value[0], height]).y - at.y).abs() <= NEAR
}

/// True if it is equally strong at all four corners of the data.
fn is_everywhere(widget: &ScreenWidget, look: &EditedFunction) -> bool {
    let Some(histogram) = look.histogram() else { return false };
    if !matches!(widget.region, Region::Whole) {
        return false;
    }
    let [s, g] = histogram.axes;
    let corners = [[s.low, g.low], [s.high, g.low], [s.low, g.high], [s.high, g.high]];
    corners.iter().all(|at| widget.strength(*at) > COVERS)
}
