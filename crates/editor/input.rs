//! Input events: their grouping into steps of the undo history, and those that wait for the next frame.

use eframe::egui::{Context, Event, Key, RawInput, Vec2};
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

/// Events that wait. A button pressed and the pointer moved on within one slow frame: what is taken hold of lies where it was
/// pressed, as is what is let go of. egui looks at a frame's last place alone, so what follows a button waits for the next frame.
#[derive(Default)]
pub(crate) struct InputQueue {
    waiting: Vec<Event>,
}

impl InputQueue {
    /// Leaves of a frame's events, after those that waited, those up to the first press, or those before a release: what is dragged
    /// is brought there first. Whether some wait now, for a frame that is to follow at once.
    pub fn cut(&mut self, input: &mut RawInput) -> bool {
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        let button = |event: &Event| match event {
            Event::PointerButton { pressed, .. } => Some(*pressed),
            _ => None,
        };
        let first = events.iter().enumerate().find_map(|(place, event)| Some((place, button(event)?)));
        if let Some((place, pressed)) = first {
            let moves = events[..place].iter().any(|event| matches!(event, Event::PointerMoved(_)));
            self.waiting = events.split_off(if !pressed && moves { place } else { place + 1 });
        }
        input.events = events;
        !self.waiting.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Modifiers, PointerButton, pos2};

    #[test]
    fn each_button_ends_a_frame_and_nothing_is_lost() {
        let button = |x: f32, pressed| Event::PointerButton {
            pos: pos2(x, 0.0),
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        };
        let moved = |x: f32| Event::PointerMoved(pos2(x, 0.0));
        let mut presses = InputQueue::default();
        let mut frame = |events: Vec<Event>| {
            let mut input = RawInput { events, ..RawInput::default() };
            let waits = presses.cut(&mut input);
            (input.events, waits)
        };
        let all = vec![moved(1.0), button(1.0, true), moved(2.0), button(2.0, false), moved(3.0)];
        assert_eq!(frame(all), (vec![moved(1.0), button(1.0, true)], true));
        assert_eq!(frame(vec![moved(4.0)]), (vec![moved(2.0)], true), "it is brought there");
        assert_eq!(frame(vec![]), (vec![button(2.0, false)], true), "and let go of");
        assert_eq!(frame(vec![]), (vec![moved(3.0), moved(4.0)], false));
        assert_eq!(frame(vec![]), (vec![], false));
    }
}
