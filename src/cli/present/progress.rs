//! Progress of work that takes longer than a second, on a terminal; and stopping at a signal.

use crate::graph::Observer;
use crate::io::memory;
use crate::nodes::files;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Time before a bar is shown.
const BAR_DELAY: Duration = Duration::from_secs(1);

/// True after Ctrl-C, or after the system's request to end.
static STOP: AtomicBool = AtomicBool::new(false);

/// Estimate of the remaining time of a piece of work, from the time of the completed part.
#[derive(Debug, Clone, Copy)]
pub struct Estimate {
    start: Instant,
    fraction: f64,
}

impl Estimate {
    /// An estimate for work that begins now.
    pub fn begin() -> Self {
        Estimate { start: Instant::now(), fraction: 0.0 }
    }

    /// Remaining time (seconds) once `fraction` is done; `None` while too little is done. A fraction that falls starts another piece
    /// of work.
    pub fn remaining(&mut self, fraction: f64) -> Option<f64> {
        // Threads report in no order, so a little less is no beginning.
        if fraction + 0.1 < self.fraction {
            *self = Estimate::begin();
        }
        self.fraction = self.fraction.max(fraction);
        let left = self.start.elapsed().as_secs_f64() * (1.0 - fraction) / fraction;
        (fraction > 0.02 && left.is_finite()).then_some(left)
    }
}

/// Progress bar of a run.
pub struct Bar {
    bar: ProgressBar,
    visible: bool,
    start: Instant,
    shown: AtomicBool,
    place: Mutex<String>,
    /// The current stage.
    stage: Mutex<(String, Estimate)>,
}

impl Bar {
    /// A bar, shown only on a terminal and where not `quiet`.
    pub fn new(quiet: bool) -> Self {
        // The first Ctrl-C or request to end stops the run cleanly; the second one, should that take long, the program, and
        // so does the first where the run waits for a reader.
        let _ = ctrlc::set_handler(|| {
            if STOP.swap(true, Ordering::Relaxed) || files::is_waiting() {
                files::end_now(1);
            }
        });
        let bar = ProgressBar::with_draw_target(Some(1000), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg:40} {bar:30} {percent:>3} %  {elapsed}") {
            bar.set_style(style);
        }
        let visible = !quiet && std::io::stderr().is_terminal();
        let (start, shown) = (Instant::now(), AtomicBool::new(false));
        let stage = Mutex::new((String::new(), Estimate::begin()));
        Bar { bar, visible, start, shown, place: Mutex::default(), stage }
    }

    /// Removes the bar from the screen.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }

    /// Shows that `fraction` of `what` is done, and the remaining time.
    pub fn show(&self, what: &str, fraction: f64, left: Option<f64>) {
        if !self.visible || self.start.elapsed() < BAR_DELAY {
            return;
        }
        if !self.shown.swap(true, Ordering::Relaxed) {
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        // Less than a second says nothing to a person.
        let left = left.filter(|left| *left >= 1.0).map(|left| format!(", about {left:.0} s left"));
        self.bar.set_message(format!("{what}{}", left.unwrap_or_default()));
        self.bar.set_position((fraction.clamp(0.0, 1.0) * 1000.0) as u64);
    }
}

impl Observer for Bar {
    fn started(&self, node: &str, place: usize, count: usize) {
        let mut shown = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        *shown = format!("{}/{count} {node}", place + 1);
    }

    fn progress(&self, _node: &str, stage: &str, fraction: f64) {
        if !self.visible {
            return;
        }
        let place = self.place.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let mut known = self.stage.lock().unwrap_or_else(PoisonError::into_inner);
        let what = if place.is_empty() { stage.to_string() } else { format!("{place}: {stage}") };
        if known.0 != what {
            *known = (what, Estimate::begin());
        }
        let left = known.1.remaining(fraction);
        self.show(&known.0, fraction, left);
    }

    fn cancelled(&self) -> bool {
        STOP.load(Ordering::Relaxed)
    }

    fn memory_left(&self) -> Option<u64> {
        memory::available()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_follows_from_what_is_done_and_begins_anew() {
        let ago = |seconds: u64| Instant::now().checked_sub(Duration::from_secs(seconds)).unwrap();
        let mut estimate = Estimate { start: ago(30), fraction: 0.0 };
        assert_eq!(estimate.remaining(0.01), None, "too little to tell");
        // The test itself takes some of the time, on a busy machine seconds.
        let least = 3.0 * estimate.start.elapsed().as_secs_f64();
        let left = estimate.remaining(0.25).unwrap();
        assert!((least..=3.0 * estimate.start.elapsed().as_secs_f64()).contains(&left), "{left}");
        assert!(least >= 90.0, "{least}");
        assert!(estimate.remaining(1.0).unwrap() < 1.0);
        assert!(estimate.remaining(0.5).unwrap() < 25.0, "another piece of work began just now");
    }
}
