//! Grouping of edits into steps of the undo history.

use eframe::egui::{Context, Key, Vec2};
use std::time::{Duration, Instant};
use voltet_document::Gesture;

/// Edits by wheel and keys that follow one another within this time are one step.
const PAUSE: Duration = Duration::from_millis(600);

/// Grouping of edits into undo steps.
#[derive(Default)]
pub(crate) struct GestureTracker {
    last: u64,
    pressed: Option<u64>,
    at: Option<(Instant, u64)>,
}

impl GestureTracker {
    fn next(&mut self) -> u64 {
        self.last += 1;
        self.last
    }

    /// The gesture of an edit made now: a mouse button held, or what follows soon after by wheel or key.
    pub fn gesture(&mut self, ctx: &Context) -> Option<Gesture> {
        let (down, pressed, released, repeated) = ctx.input(|input| {
            let pointer = &input.pointer;
            let wheel = input.smooth_scroll_delta != Vec2::ZERO || input.zoom_delta() != 1.0;
            let arrows = [Key::ArrowLeft, Key::ArrowRight, Key::ArrowUp, Key::ArrowDown];
            let nudged = arrows.iter().any(|key| input.keys_down.contains(key));
            (pointer.any_down(), pointer.any_pressed(), pointer.any_released(), wheel || nudged)
        });
        if pressed || (down && self.pressed.is_none()) {
            self.pressed = Some(self.next());
        }
        if down || released {
            return self.pressed.map(Gesture);
        }
        self.pressed = None;
        if !repeated {
            return None;
        }
        let now = Instant::now();
        let number = match self.at {
            Some((before, number)) if now - before < PAUSE => number,
            _ => self.next(),
        };
        self.at = Some((now, number));
        Some(Gesture(number))
    }
}
