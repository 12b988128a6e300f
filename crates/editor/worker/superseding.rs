//! Cancellation of a pass that a newer request supersedes: at once, but for two cases:
//!
//! - The node that runs is not touched by the change: its output will serve, and the pass ends after it.
//! - The picture is the first of its wish, coarse or quick, and the change is a hand's movement (numbers of cameras and transfer
//!   functions): stopped each time, a steady drag would never show any. It has about the time that such a picture takes.
//!
//! A picture that was drawn to its end after another kind of change is not shown.

use super::request::RenderRequest;
use super::shared::{Shared, lock};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use voltet_document::links::upstream;
use voltet_graph::NodeEntry;

/// A pass that may be superseded.
pub(super) struct Pass<'a> {
    shared: &'a Shared,
    number: u64,
    wanted: &'a RenderRequest,
    begun: Instant,
    /// Time limit while the user moves on; `None` for a picture after a coarse one.
    patience: Option<Duration>,
    /// Changes of the newest request, by its number.
    judged: Mutex<Option<(u64, Arc<Change>)>>,
}

/// Changes from one request to another.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Change {
    /// The nodes whose output is another, or is not needed any more.
    touched: BTreeSet<String>,
    /// True if it is a movement by the pointer.
    moves: bool,
}

impl<'a> Pass<'a> {
    pub fn new(
        shared: &'a Shared,
        number: u64,
        wanted: &'a RenderRequest,
        patience: Option<Duration>,
    ) -> Self {
        Pass { shared, number, wanted, begun: Instant::now(), patience, judged: Mutex::default() }
    }

    /// True if the pass is to stop. `running`: the node that runs; none between two.
    pub fn stops(&self, running: &dyn Fn() -> Option<String>) -> bool {
        let newest = self.shared.newest();
        if newest == self.number {
            return false;
        }
        let Some(change) = self.change(newest) else { return true };
        if change.moves && self.patience.is_some_and(|patience| self.begun.elapsed() < patience) {
            return false;
        }
        running().is_none_or(|node| change.touched.contains(&node))
    }

    /// True if its picture is useless, even during a movement.
    pub fn is_stale(&self) -> bool {
        let newest = self.shared.newest();
        newest != self.number && self.change(newest).is_none_or(|change| !change.moves)
    }

    /// Changes of the newest request; `None` if the worker ends.
    fn change(&self, newest: u64) -> Option<Arc<Change>> {
        let mut judged = lock(&self.judged);
        if let Some((number, change)) = &*judged
            && *number == newest
        {
            return Some(change.clone());
        }
        let state = lock(&self.shared.state);
        let change = Arc::new(Change::between(self.wanted, state.picture.as_ref()?));
        *judged = Some((newest, change.clone()));
        Some(change)
    }
}

impl Change {
    fn between(before: &RenderRequest, now: &RenderRequest) -> Change {
        let elsewhere = before.folder != now.folder;
        let needed = now.upstream();
        let is_other = |name: &String| elsewhere || find(&before.nodes, name) != find(&now.nodes, name);
        let touched = before
            .upstream()
            .into_iter()
            .filter(|name| !needed.contains(name) || upstream(&before.nodes, name).iter().any(is_other));
        let moves = !elsewhere
            && (&before.node, before.size, before.background) == (&now.node, now.size, now.background)
            && before.nodes.len() == now.nodes.len()
            && before.nodes.iter().zip(&now.nodes).all(|(a, b)| a == b || is_movement(a, b));
        Change { touched: touched.collect(), moves }
    }
}

fn find<'a>(nodes: &'a [NodeEntry], name: &str) -> Option<&'a NodeEntry> {
    nodes.iter().find(|node| node.name == name)
}

/// True if two states of a node differ in numbers that the pointer moves in the picture or over the histogram.
fn is_movement(before: &NodeEntry, now: &NodeEntry) -> bool {
    let is_moved = ["camera", "transfer-function"].iter().any(|name| before.node_type.text() == Some(name));
    is_moved && NodeEntry { settings: now.settings.clone(), ..before.clone() } == *now
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::PathBuf;
    use voltet_graph::pipeline::Pipeline;
    use voltet_graph::{LocatedValue, ParameterValue};

    fn wanted() -> RenderRequest {
        RenderRequest {
            nodes: Pipeline::parse(include_str!("../ui_tests/scene.toml")).unwrap().nodes,
            folder: PathBuf::new(),
            node: "picture".into(),
            size: None,
            background: [0.0; 3],
            coarse_first: true,
        }
    }

    fn with(node: &str, key: &str, datum: ParameterValue) -> RenderRequest {
        let mut wanted = wanted();
        let node = wanted.nodes.iter_mut().find(|entry| entry.name == node).unwrap();
        node.set(key, &[], LocatedValue::from(datum)).unwrap();
        wanted
    }

    fn touched(now: &RenderRequest) -> (Vec<String>, bool) {
        let change = Change::between(&wanted(), now);
        (change.touched.into_iter().collect(), change.moves)
    }

    #[test]
    fn a_moved_camera_or_widget_touches_what_follows_and_is_a_movement() {
        let of = |names: &[&str]| names.iter().map(|name| name.to_string()).collect::<Vec<_>>();
        assert_eq!(touched(&wanted()), (of(&[]), true));
        assert_eq!(
            touched(&with("view", "fov_y", ParameterValue::Number(20.0))),
            (of(&["picture", "view"]), true)
        );
        assert_eq!(
            touched(&with("look", "unit_distance", ParameterValue::Number(2.0))),
            (of(&["look", "picture"]), true)
        );
        let other = with("gradient", "method", ParameterValue::Text("cell-average".into()));
        assert_eq!(touched(&other), (of(&["gradient", "picture"]), false));
        let elsewhere = RenderRequest { folder: "elsewhere".into(), ..wanted() };
        assert_eq!(touched(&elsewhere).0.len(), 5);
        let other_node = RenderRequest { node: "gradient".into(), ..wanted() };
        assert_eq!(touched(&other_node), (of(&["look", "picture", "view"]), false));
    }
}
