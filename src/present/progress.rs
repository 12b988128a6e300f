//! Progress of work that takes longer than a second, on a terminal; and stopping at Ctrl-C.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};
use voltet::core::graph::Observer;

/// Work that takes less than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);

/// Set by Ctrl-C.
static STOP: AtomicBool = AtomicBool::new(false);

/// Follows a run.
pub struct Bar {
    bar: ProgressBar,
    visible: bool,
    start: Instant,
    shown: AtomicBool,
    place: Mutex<String>,
}

impl Bar {
    /// A bar, shown only on a terminal and where not `quiet`.
    pub fn new(quiet: bool) -> Self {
        // The first Ctrl-C stops the run cleanly; the second one, should that take long, the program. Where no
        // handler can be set, Ctrl-C ends the program at once, which leaves no partial file either.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) {
                std::process::exit(1);
            }
        });
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg:40} {bar:30} {percent:>3} %  {elapsed}") {
            bar.set_style(style);
        }
        let visible = !quiet && std::io::stderr().is_terminal();
        let (start, shown) = (Instant::now(), AtomicBool::new(false));
        Bar { bar, visible, start, shown, place: Mutex::default() }
    }

    /// Takes the bar off the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl Observer for Bar {
    fn started(&self, node: &str, place: usize, count: usize) {
        let mut shown = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        *shown = format!("{}/{count} {node}", place + 1);
    }

    fn progress(&self, _node: &str, stage: &str, fraction: f64) {
        if !self.visible || self.start.elapsed() < PATIENCE {
            return;
        }
        if !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        let place = self.place.lock().unwrap_or_else(PoisonError::into_inner).clone();
        self.bar.set_message(format!("{place}: {stage}"));
        self.bar.set_position((fraction.clamp(0.0, 1.0) * 1000.0) as u64);
    }

    fn cancelled(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }
}
