//! Start screen of an empty window, and the screen of an unreadable file.

use crate::actions::{Action, Actions, Command};
use crate::theme;
use eframe::egui::{Align, Button, Frame, Layout, Rect, RichText, Ui, UiBuilder, vec2};
use std::path::Path;
use voltet_core::Error;

/// Width of what is offered, points.
const WIDTH: f32 = 340.0;

/// Message above the graph of a file that is no TOML.
pub(crate) fn broken(ui: &mut Ui, place: Rect, faults: &[Error]) {
    let dark = ui.visuals().dark_mode;
    // At the top, on a ground of its own: what can be read of the file is shown below.
    let rect = Rect::from_min_size(place.min + vec2(12.0, 8.0), vec2(place.width() - 24.0, 120.0));
    ui.allocate_new_ui(UiBuilder::new().max_rect(rect), |ui| {
        Frame::none().fill(ui.visuals().window_fill).inner_margin(8.0).rounding(4.0).show(ui, |ui| {
            for fault in faults.iter().take(3) {
                ui.label(RichText::new(fault.to_string()).color(theme::wrong(dark)));
            }
            let text = "Mend it in a text editor; once it is saved there, it can be taken over here.";
            ui.label(RichText::new(text).color(theme::weak(dark)));
        });
    });
}

/// Shows the ways to begin, in the middle of a place. `recent`: files that were opened last; `is_making`: a pipeline is being
/// made for data.
pub(crate) fn invite(ui: &mut Ui, place: Rect, recent: &[&Path], is_making: bool, actions: &mut Actions) {
    let dark = ui.visuals().dark_mode;
    let weak = theme::weak(dark);
    let height = 150.0 + 26.0 * recent.len() as f32;
    let size = vec2(WIDTH.min(place.width() - 20.0), height.min(place.height() - 10.0));
    let rect = Rect::from_center_size(place.center(), size);
    let layout = Layout::top_down(Align::Center);
    ui.allocate_new_ui(UiBuilder::new().max_rect(rect).layout(layout), |ui| {
        if is_making {
            ui.add_space(0.4 * rect.height());
            ui.label(RichText::new("Looking at the data …").size(16.0));
            return;
        }
        let button =
            |text: &str| Button::new(RichText::new(text).size(15.0)).min_size(vec2(rect.width(), 34.0));
        let open = ui.add(button("Open data or a pipeline …"));
        if open.on_hover_text("for a data file, a pipeline with a picture is made (Ctrl+O)").clicked() {
            actions.command(Command::Open);
        }
        ui.add_space(4.0);
        if ui.add(button("Add a node …")).on_hover_text("Space").clicked() {
            actions.command(Command::Add);
        }
        ui.add_space(6.0);
        ui.label(RichText::new("or drop a file here").color(weak));
        if recent.is_empty() {
            return;
        }
        ui.add_space(8.0);
        ui.label(RichText::new("Lately opened").color(weak));
        for path in recent {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let folder = path.parent().unwrap_or(Path::new("")).display().to_string();
            let entry = Button::new(format!("{name}   in {folder}")).frame(false).truncate();
            if ui.add(entry).on_hover_text(path.display().to_string()).clicked() {
                actions.push(Action::Begin(path.to_path_buf()));
            }
        }
    });
}
