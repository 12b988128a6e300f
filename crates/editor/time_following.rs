//! The strip of frames and the worker: the series of the shown picture, the frame that is asked for, and playing.

use crate::editor::Editor;
use crate::eyes::visible_nodes;
use crate::jobs::Job;
use crate::scene::{TimeMove, camera_of};
use crate::time_strip::{Readers, TimeStrip};
use crate::view::View;
use crate::worker::RenderRequest;
use eframe::egui::Context;
use std::time::{Duration, Instant};
use voltet_core::Error;
use voltet_document::series::{TIME, TIME_STEP};
use voltet_document::{Document, Series, links};
use voltet_graph::{NodeEntry, ParameterValue, Registry};

/// Shortest time that a frame is shown while the strip plays.
const SHORTEST: Duration = Duration::from_millis(40);

/// Least time for which the histogram may be of an earlier frame while the strip plays, which then waits for it: each newer picture takes
/// precedence of it.
const LAGGING: Duration = Duration::from_secs(1);

/// Least time that the strip plays on, beside the time that it waited for the histogram.
const PLAYING: u32 = 9;

/// Time for which the histogram may be of an earlier frame, after one that was waited for so long.
fn lagging(waited: Duration) -> Duration {
    LAGGING.max(waited.saturating_mul(PLAYING))
}

/// The readers that feed a picture, without the numbers of the steps that they name.
fn readers(document: &Document, registry: &Registry, shown: &str) -> Readers {
    let is_reader = |node: &NodeEntry| {
        registry.node_type(node).is_some_and(|node_type| node_type.parameter(TIME_STEP).is_some())
    };
    let mut nodes = links::feeding(&document.pipeline().nodes, shown);
    nodes.retain(is_reader);
    for node in &mut nodes {
        for field in node.settings.iter_mut().filter(|field| [TIME_STEP, TIME].contains(&field.name.as_str()))
        {
            if field.setting.number().is_some() {
                field.setting = ParameterValue::Integer(0).into();
            }
        }
    }
    (nodes, document.folder())
}

impl Editor {
    /// Finds the series of the shown picture, and goes on to the next frame where the strip plays and the last one was drawn.
    pub(crate) fn follow_time(&mut self, ctx: &Context) {
        self.find_series(ctx);
        let newest = self.answers.picture_number;
        let (answered, has_failed, is_whole, lags) = self.worker.shown(|shown| {
            let whole = shown.pixels.as_ref().filter(|pixels| pixels.is_full());
            let is_whole = whole.is_some_and(|pixels| pixels.number == newest);
            let lags = shown.distribution.is_waiting() || shown.section.is_waiting();
            (shown.answered, shown.failure.is_some(), is_whole, lags)
        });
        let is_drawn = answered >= newest;
        let nodes = &self.document.pipeline().nodes;
        let camera = self.shown_node.as_deref().and_then(|shown| camera_of(nodes, shown));
        let strip = &mut self.panels.time;
        if !lags {
            strip.count_no_more();
        }
        if strip.free.as_ref().is_some_and(|(former, _)| camera != Some(former)) {
            strip.leave_view();
        }
        let count = strip.count(camera);
        strip.is_drawn = is_drawn && is_whole && !has_failed && strip.frame(nodes) == strip.requested;
        match strip.playing {
            Some(_) if count > 1 && has_failed && is_drawn => {
                let frame = strip.frame(nodes);
                let edits = strip.stop(nodes, count);
                if !edits.is_empty() {
                    self.edit("set the time step".into(), &edits);
                }
                let what = format!("frame {frame} cannot be drawn: it plays no further");
                let _ = self.check::<()>(Err(Error::run(what)));
            }
            // It goes on once they are there.
            Some(_) if count > 1 && strip.counting.is_some() => {}
            Some(last) if count > 1 => {
                let left = SHORTEST.saturating_sub(last.elapsed());
                if is_drawn && left.is_zero() {
                    strip.playing = Some(Instant::now());
                    strip.move_to((strip.frame(nodes) + 1) % count);
                    // Where the next frame is the same picture nothing is drawn, and nobody else wakes the window.
                    ctx.request_repaint_after(SHORTEST);
                } else if is_drawn {
                    ctx.request_repaint_after(left);
                }
            }
            Some(_) => strip.playing = None,
            None if !strip.is_dragged && !strip.keeps_step() => strip.moved = None,
            None => {}
        }
        if self.panels.time.playing.is_none() {
            self.worker.read_no_further();
        }
        self.panels.time.is_dragged = false;
    }

    /// Looks for the series where the readers are others than before, or the document is another since none could be found. One search
    /// at a time: what is asked for meanwhile is looked for after it.
    fn find_series(&mut self, ctx: &Context) {
        let shown = self.shown_node.as_deref();
        let now = shown.map(|shown| readers(&self.document, &self.registry, shown)).unwrap_or_default();
        let revision = self.document.revision();
        let strip = &mut self.panels.time;
        if let Some(job) = &strip.found {
            let Some(found) = job.result() else { return };
            strip.found = None;
            (strip.series, strip.fault) = match found {
                Ok(series) => (series, None),
                Err(error) => (Series::default(), Some(error)),
            };
        }
        if strip.readers == now && !(strip.fault.is_some() && strip.revision != revision) {
            return;
        }
        strip.revision = revision;
        strip.found = match shown.filter(|_| !now.0.is_empty()) {
            Some(shown) => {
                let wanted = RenderRequest {
                    nodes: links::feeding(&self.document.pipeline().nodes, shown),
                    folder: now.1.clone(),
                    node: shown.to_string(),
                    size: None,
                    background: [0.0; 3],
                    coarse_first: false,
                    grip_moves: false,
                };
                let registry = self.registry.clone();
                Job::start("time steps", ctx, move |_| wanted.series(&registry)).ok()
            }
            None => None,
        };
        if strip.found.is_none() {
            (strip.series, strip.fault) = (Series::default(), None);
        }
        strip.readers = now;
    }

    /// Carries out a command of the strip.
    pub(crate) fn move_time(&mut self, to: TimeMove) {
        let (camera, strip) = (self.camera(), &self.panels.time);
        let count = strip.count(camera);
        if to == TimeMove::Play && strip.playing.is_none() && count > 1 && !strip.moves(camera) {
            return self.say("nothing here moves: there are no time steps, and the camera has no way");
        }
        let edits = self.panels.time.step(&self.document.pipeline().nodes, count, to);
        if count < 2 {
            self.say("nothing here has time steps, and no camera has a way");
        } else if !edits.is_empty() {
            self.edit("set the time step".into(), &edits);
        }
    }

    /// Puts the strip's frame into a request for a picture; gives the request for the next one while it plays. While a hand drags,
    /// the frame before stays until it is drawn: no more than one is waited for.
    pub(crate) fn put_frame(&mut self, wanted: &mut RenderRequest) -> Option<RenderRequest> {
        let is_drawn = self.worker.shown(|shown| shown.answered) >= self.answers.picture_number;
        let camera = camera_of(&wanted.nodes, &wanted.node);
        let strip = &mut self.panels.time;
        let count = strip.count(camera);
        if count < 2 {
            return None;
        }
        let now = strip.frame(&wanted.nodes).min(count - 1);
        let waits = strip.is_dragged && !is_drawn && self.answers.asked.is_some();
        strip.requested = if waits { strip.requested.min(count - 1) } else { now };
        let mut next = strip.playing.is_some().then(|| wanted.clone());
        strip.put(&mut wanted.nodes, strip.requested, count);
        if let Some(next) = &mut next {
            strip.put(&mut next.nodes, (now + 1) % count, count);
        }
        next
    }

    /// True if the histogram may stay that of an earlier frame; else the strip waits for it. While a hand is at work, which has new
    /// pictures drawn, it would wait until the hand rests.
    pub(crate) fn keeps_histogram(&mut self) -> bool {
        let strip = &mut self.panels.time;
        let is_new = || strip.lags_until.is_some_and(|until| Instant::now() < until);
        let is_free = strip.playing.is_some() && strip.counting.is_none();
        let keeps = is_free && (self.gesture.is_some() || is_new());
        if is_free && !keeps {
            strip.counting = Some(Instant::now());
        }
        keeps
    }

    /// The nodes that the window draws, with what the frame of the picture that was asked for last changes.
    pub(crate) fn nodes_of_frame(&self) -> Vec<NodeEntry> {
        let mut nodes = visible_nodes(&self.document, &self.registry).into_owned();
        let strip = &self.panels.time;
        let count = strip.count(self.camera());
        if count > 1 {
            strip.put(&mut nodes, strip.requested.min(count - 1), count);
        }
        nodes
    }

    /// Takes a view of a camera whose way is by keys: what a hand does stays beside them until it is made one of them.
    pub(crate) fn take_free_view(&mut self, view: View) -> bool {
        let Some(camera) = self.camera().filter(|camera| camera.setting("keys").is_some()).cloned() else {
            return false;
        };
        self.panels.time.free = Some((camera, view));
        true
    }
}

impl TimeStrip {
    /// Waits for the histogram no more: it is there, or a hand has another picture drawn, which takes precedence of it.
    pub(crate) fn count_no_more(&mut self) {
        if let Some(since) = self.counting.take() {
            self.lags_until = Some(Instant::now() + lagging(since.elapsed()));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_stands_still_a_tenth_of_the_time_at_most() {
        for (waited, plays) in [(0.01, 1.0), (0.1, 1.0), (0.2, 1.8), (5.0, 45.0)] {
            assert_eq!(lagging(Duration::from_secs_f64(waited)), Duration::from_secs_f64(plays), "{waited}");
        }
    }
}
