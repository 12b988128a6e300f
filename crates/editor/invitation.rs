//! Ways to begin, which an empty window offers.

use crate::scene::{Action, Command, Scene};
use crate::theme::{self, Help};
use eframe::egui::containers::menu::MenuButton;
use eframe::egui::{Align, Button, Layout, Rect, RichText, Ui, UiBuilder, vec2};
use std::path::Path;

/// Width of what is offered, points.
const WIDTH: f32 = 340.0;

/// Shows the ways to begin, in the middle of a place. `recent`: files that were opened last; `is_making`: a pipeline is being
/// made for data.
pub(crate) fn invite(ui: &mut Ui, scene: &Scene, place: Rect, recent: &[&Path], is_making: bool) {
    let dark = ui.visuals().dark_mode;
    let weak = theme::weak(dark);
    let height = 190.0 + 26.0 * recent.len() as f32;
    let size = vec2(WIDTH.min(place.width() - 20.0), height.min(place.height() - 10.0));
    let rect = Rect::from_center_size(place.center(), size);
    let layout = Layout::top_down(Align::Center);
    ui.scope_builder(UiBuilder::new().max_rect(rect).layout(layout), |ui| {
        if is_making {
            ui.add_space(0.4 * rect.height());
            ui.label(RichText::new("Reading the data …").size(16.0));
            return;
        }
        let button =
            |text: &str| Button::new(RichText::new(text).size(15.0)).min_size(vec2(rect.width(), 34.0));
        for (text, command, help) in [
            (
                "Open data or a pipeline …",
                Command::Open,
                "for a data file, a pipeline with a picture is made (Ctrl+O)",
            ),
            ("Add a node …", Command::Add, "Space"),
            ("Begin with an example", Command::Example, "a pipeline that needs no data file"),
        ] {
            if ui.add(button(text)).help_at_right(help).clicked() {
                scene.actions.command(command);
            }
            ui.add_space(4.0);
        }
        let title = RichText::new("Begin with a template …").size(15.0);
        let offers = MenuButton::from_button(Button::new(title).min_size(vec2(rect.width(), 34.0)));
        let (offered, _) = offers.ui(ui, |ui| template_buttons(ui, scene));
        offered.help_at_right("a pipeline that fits any data, for a file that you choose");
        ui.add_space(4.0);
        ui.label(RichText::new("or drop a file here").color(weak));
        if recent.is_empty() {
            return;
        }
        ui.add_space(8.0);
        ui.label(RichText::new("Recent files").color(weak));
        for path in recent {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let folder = path.parent().unwrap_or(Path::new("")).display().to_string();
            let entry = Button::new(format!("{name}   in {folder}")).frame(false).truncate();
            if ui.add(entry).help_at_right(path.display().to_string()).clicked() {
                scene.actions.push(Action::Begin(path.to_path_buf()));
            }
        }
    });
}

/// Buttons of the templates, each of which asks for data.
pub(crate) fn template_buttons(ui: &mut Ui, scene: &Scene) {
    for template in scene.templates {
        if ui.button(&template.title).clicked() {
            scene.actions.push(Action::BeginFrom(template.clone()));
            ui.close();
        }
    }
}
