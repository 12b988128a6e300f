//! The window itself: eframe's glow backend around [`Editor`].

use crate::editor::{Editor, Start};
use crate::files::{Recent, is_pipeline};
use crate::film::Film;
use crate::keys::InputQueue;
use crate::panes::Layouts;
use crate::plugins::LoadPlugin;
use crate::study::Study;
use crate::theme;
use eframe::egui::{Context, RawInput, Ui, Vec2, ViewportBuilder, ViewportCommand, Visuals};
use eframe::{App, Frame, NativeOptions, Renderer};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_document::Document;
use voltet_graph::Registry;
use voltet_nodes::files::state_folder;

/// Width and height at the first start, points.
const SIZE: [f32; 2] = [1280.0, 720.0];

/// Least width and height, points.
const MIN_SIZE: [f32; 2] = [700.0, 500.0];

/// Frames of one size after which no hand is at the window's border any more.
const STILL: u32 = 4;

/// Functions of the program that the window calls, on threads of their own.
pub struct Services {
    /// Makes the text of a pipeline for a file that is none.
    pub start: Start,
    /// Makes studies.
    pub study: Study,
    /// Makes films.
    pub film: Film,
    /// Loads plug-ins; what the others do is with these from then on.
    pub plugin: LoadPlugin,
}

/// Opens the window on a file, or on an empty pipeline, and waits for its end. Must be called from the main thread. Errors: the file cannot be read, there is no display, or it has no
/// OpenGL.
pub fn run(file: Option<&Path>, registry: &Registry, services: Services) -> Result<()> {
    let document = match file {
        Some(path) if is_pipeline(path) => Document::open(path)?,
        Some(path) => {
            std::fs::metadata(path)
                .map_err(|error| Error::usage("the file cannot be read").got(error).in_file(path))?;
            Document::new()
        }
        None => Document::new(),
    };
    if !cfg!(any(target_os = "macos", target_os = "windows")) {
        refuse_without_display(&|name| std::env::var_os(name).is_some_and(|value| !value.is_empty()))?;
    }
    let data = file.filter(|path| !is_pipeline(path)).map(Path::to_path_buf);
    let kept = state_folder().map(|folder| folder.join("window"));
    let layouts = kept.as_deref().map(Layouts::read).unwrap_or_default();
    let options = NativeOptions {
        viewport: ViewportBuilder::default()
            .with_title("voltet")
            .with_app_id("voltet")
            .with_inner_size(layouts.last_size().unwrap_or(SIZE))
            .with_min_inner_size(MIN_SIZE),
        renderer: Renderer::Glow,
        // Text and textures need no depth, and smooth edges come from feathering.
        multisampling: 0,
        // Pictures are shown as they are, without noise.
        dithering: false,
        ..NativeOptions::default()
    };
    let failed = |error: &dyn std::fmt::Display| {
        Error::run("the window cannot be opened")
            .got(without_place(&error.to_string().replace('\n', ", ")))
            .expected("a display with OpenGL 2 or later (Mesa's software driver will do)")
    };
    let made = |context: &eframe::CreationContext| -> std::result::Result<Box<dyn App>, Box<dyn std::error::Error + Send + Sync>> {
        theme::apply(&context.egui_ctx);
        let ctx = context.egui_ctx.clone();
        let wake = Arc::new(move || ctx.request_repaint());
        let mut editor = Editor::new(document, registry, services.start, wake)?;
        editor.panels.study.make = Some(services.study);
        editor.panels.time.film.make = Some(services.film);
        editor.plugins.load = Some(services.plugin);
        if let Some(place) = voltet_document::Recovery::usual() {
            editor.keep_in(place);
        }
        editor.recent = Recent::usual();
        if let Some(path) = editor.document.path().map(Path::to_path_buf) {
            editor.recent.add(&path);
        }
        if let Some(data) = data {
            editor.open_any(&context.egui_ctx, &data);
        }
        Ok(Box::new(Window { kept, ..Window::new(editor, layouts) }))
    };
    eframe::run_native("voltet", options, Box::new(made)).map_err(|error| failed(&error))
}

/// A driver's message without the source file that it comes from.
fn without_place(message: &str) -> &str {
    match message.rsplit_once(".rs:").and_then(|(_, rest)| rest.split_once(": ")) {
        Some((_, words)) => words,
        None => message,
    }
}

/// Errors: the environment names no display where one is needed. `is_set`: true for a variable that is set.
fn refuse_without_display(is_set: &dyn Fn(&str) -> bool) -> Result<()> {
    match ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"].into_iter().any(is_set) {
        true => Ok(()),
        false => Err(Error::run("there is no display to open a window on")
            .got("neither DISPLAY nor WAYLAND_DISPLAY is set")
            .expected("a desktop session, or `voltet run FILE`, which needs none")),
    }
}

/// The application: the editor, and what its window has of it.
pub(crate) struct Window {
    pub editor: Editor,
    title: String,
    pub presses: InputQueue,
    /// The file in which layouts are kept, they, the size of the last frame, points, and the frames since it was another.
    kept: Option<PathBuf>,
    layouts: Layouts,
    size: Vec2,
    still_count: u32,
}

impl Window {
    pub fn new(mut editor: Editor, layouts: Layouts) -> Window {
        editor.panels.panes = layouts.last_panes();
        let (title, presses) = (String::new(), InputQueue::default());
        Window { editor, title, presses, kept: None, layouts, size: Vec2::ZERO, still_count: 0 }
    }

    /// Gives the panes the shares that a hand gave them at this size, once the window keeps it.
    fn follow_size(&mut self, ctx: &Context) {
        let size = ctx.content_rect().size();
        self.still_count = if size == self.size { self.still_count.saturating_add(1) } else { 0 };
        self.size = size;
        if self.still_count < STILL {
            ctx.request_repaint();
        } else if self.still_count == STILL {
            self.layouts.take_up(size, &mut self.editor.panels.panes);
        }
    }
}

impl App for Window {
    fn on_exit(&mut self, _gl: Option<&eframe::glow::Context>) {
        // The person ended it and was asked: nothing is left behind.
        if self.editor.ends() {
            self.editor.recover.forget();
        }
        self.editor.panels.time.film.end();
        if let Some(file) = self.kept.as_deref().filter(|_| self.size != Vec2::ZERO) {
            self.layouts.write(file, self.size, &self.editor.panels.panes);
        }
    }

    fn clear_color(&self, visuals: &Visuals) -> [f32; 4] {
        theme::panel(visuals.dark_mode).to_normalized_gamma_f32()
    }

    fn raw_input_hook(&mut self, ctx: &Context, input: &mut RawInput) {
        if self.presses.cut(input) {
            ctx.request_repaint();
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut Frame) {
        self.follow_size(ui.ctx());
        let before = self.editor.panels.panes.each_ref().map(|pane| pane.share_or(0.0));
        self.editor.frame(ui);
        // Shown for the first time, a pane gets a share without a hand.
        let mut both = before.iter().zip(&self.editor.panels.panes);
        if both.any(|(before, pane)| *before > 0.0 && pane.share_or(0.0) != *before) {
            self.layouts.keep(self.size, &self.editor.panels.panes);
        }
        let ctx = ui.ctx();
        let document = self.editor.document();
        let name =
            document.path().and_then(|path| path.file_name()).map(|name| name.to_string_lossy().into_owned());
        let mark = if document.is_unwritten() { " •" } else { "" };
        let title = format!("{}{mark} – voltet", name.as_deref().unwrap_or("new pipeline"));
        if title != self.title {
            ctx.send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
        if self.editor.ends() {
            ctx.send_viewport_cmd(ViewportCommand::Close);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Color32, Theme};
    use voltet_core::progress::Progress;

    #[test]
    fn without_a_display_there_is_one_clear_line() {
        let error = refuse_without_display(&|_| false).unwrap_err().to_string();
        assert!(error.starts_with("there is no display") && error.contains("voltet run"), "{error}");
        assert_eq!(error.lines().count(), 1);
        assert!(refuse_without_display(&|name| name == "WAYLAND_DISPLAY").is_ok());
        let of_driver = "winit EventLoopError: os error at /home/a/src/x11/mod.rs:42: XOpenDisplayFailed";
        assert_eq!(without_place(of_driver), "XOpenDisplayFailed");
    }

    #[test]
    fn the_window_is_cleared_to_the_colour_of_panels_which_are_clear() {
        let ctx = Context::default();
        theme::apply(&ctx);
        let start: Start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Err(Error::usage("no data here")));
        let editor = Editor::new(Document::new(), &Registry::default(), start, Arc::new(|| {})).unwrap();
        let window = Window::new(editor, Layouts::default());
        for (of, dark) in [(Theme::Dark, true), (Theme::Light, false)] {
            let visuals = ctx.style_of(of).visuals.clone();
            assert_eq!((visuals.dark_mode, visuals.panel_fill), (dark, Color32::TRANSPARENT));
            let gray = f32::from(theme::panel(dark).r()) / 255.0;
            assert_eq!(window.clear_color(&visuals), [gray, gray, gray, 1.0]);
        }
    }

    #[test]
    fn the_next_window_has_the_shares_of_the_last_at_any_size() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("window");
        let lines = ["1000 700 0.4 0.5 0.3\n", "900 600 0.2 0.25 0.1\n"];
        std::fs::write(&file, lines.concat()).unwrap();
        let start: Start = Arc::new(|_: &Path, _: &Path, _: &dyn Progress| Err(Error::usage("no data here")));
        let editor = Editor::new(Document::new(), &Registry::default(), start, Arc::new(|| {})).unwrap();
        let window = Window::new(editor, Layouts::read(&file));
        assert_eq!(window.editor.panels.panes.each_ref().map(|pane| pane.share_or(0.0)), [0.4, 0.5, 0.3]);
        // An empty window that ends at another size loses nothing, and adds no size that no hand chose.
        let mut window = Window { kept: Some(file.clone()), size: Vec2::new(1600.0, 800.0), ..window };
        window.on_exit(None);
        let written = std::fs::read_to_string(&file).unwrap();
        assert_eq!(written, format!("1600 800 0.4 0.5 0.3\n{}", lines[1]));
    }
}
