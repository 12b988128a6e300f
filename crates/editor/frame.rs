//! One frame: what happened meanwhile, what the hand asks for, what is shown, what is asked of the worker.

use crate::actions::{Action, Actions, Command};
use crate::editor::Editor;
use crate::{keys, layout};
use eframe::egui::{Context, ViewportCommand};

impl Editor {
    /// Shows everything once and carries out what was asked for.
    pub fn frame(&mut self, ctx: &Context) {
        self.look_at_disk();
        self.take_made();
        self.take_probed();
        self.study.take_found();
        self.show_run();
        self.settle_on_nodes();
        self.gesture = self.gestures.gesture(ctx);
        if ctx.input(|input| input.viewport().close_requested()) && !self.ends {
            ctx.send_viewport_cmd(ViewportCommand::CancelClose);
            self.command(ctx, Command::Quit);
        }
        let mut actions = Actions::default();
        let dropped = ctx.input(|input| input.raw.dropped_files.iter().find_map(|file| file.path.clone()));
        dropped.into_iter().for_each(|path| actions.push(Action::Begin(path)));
        keys::read(ctx, self.transfer.takes_keys(), &mut actions);
        layout::show(self, ctx, &mut actions);
        for action in actions.0 {
            self.apply(ctx, action);
        }
        self.paste(ctx);
        self.keep(ctx);
        self.settle_on_nodes();
        if self.picture.room == [0; 2] {
            // Nothing was shown yet; how large the picture is follows from the next frame.
            if !self.document.pipeline().nodes.is_empty() {
                ctx.request_repaint();
            }
            return;
        }
        self.wish();
    }
}
