//! A run that leaves nothing out, held against the usual one: by how much it is slower, and whether the pictures are the
//! same.

use serde::Serialize;
use serde_json::Value;
use voltet_core::picture::Picture;
use voltet_graph::{RunReport, SkippedWork};

/// Largest difference of a channel that leaving something out may make: what culled cells add, and the rounding of 32 bits
/// where one colour is summed and not composited.
pub const SAME: f64 = 1e-6;

/// Comparison of an exhaustive run with the usual one.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NoLeaveOut {
    /// Seconds of the usual run.
    pub usual_seconds: f64,
    /// Seconds of the other one.
    pub seconds: f64,
    /// The one by the other.
    pub times_slower: f64,
    /// Each node's seconds, usual and other, where they differ most first.
    pub nodes: Vec<NodeSeconds>,
    /// The engines that drew, usual and other, where they are not the same: the other run may be more than a device holds.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engines: Option<[String; 2]>,
    /// Largest difference of a channel of premultiplied linear RGBA between their pictures; `None` without a picture.
    pub largest_difference: Option<f64>,
    /// Work that the usual run skips.
    pub left_out: Vec<SkippedWork>,
}

/// Time of a node.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NodeSeconds {
    /// Its name.
    pub node: String,
    /// Seconds in the usual run.
    pub usual: f64,
    /// Seconds where nothing is left out.
    pub no_leave_out: f64,
}

impl NoLeaveOut {
    /// Compares two runs of one graph.
    pub fn compare(usual: &RunReport, no_leave_out: &RunReport) -> NoLeaveOut {
        let seconds =
            |name: &str| no_leave_out.nodes.iter().find(|node| node.name == name).map(|node| node.seconds);
        let pair = |node: &voltet_graph::NodeReport| {
            let no_leave_out = seconds(&node.name)?;
            Some(NodeSeconds { node: node.name.clone(), usual: node.seconds, no_leave_out })
        };
        let mut nodes: Vec<NodeSeconds> = usual.nodes.iter().filter_map(pair).collect();
        nodes.sort_by(|a, b| (b.no_leave_out - b.usual).total_cmp(&(a.no_leave_out - a.usual)));
        let pictures = usual.pictures.iter().filter_map(|(name, picture)| {
            let other = &no_leave_out.pictures.iter().find(|(other, _)| other == name)?.1;
            Some(largest_difference(picture, other))
        });
        let engine = |report: &RunReport| report.engine.as_ref().map(|engine| engine.0.clone());
        let engines = engine(usual).zip(engine(no_leave_out)).filter(|(usual, other)| usual != other);
        NoLeaveOut {
            engines: engines.map(|(usual, other)| [usual, other]),
            usual_seconds: usual.seconds,
            seconds: no_leave_out.seconds,
            times_slower: no_leave_out.seconds / usual.seconds,
            nodes,
            largest_difference: pictures.reduce(f64::max),
            left_out: usual.left_out.clone(),
        }
    }

    /// True if the pictures are the same.
    pub fn is_same(&self) -> bool {
        self.largest_difference.is_none_or(|difference| difference <= SAME)
    }

    /// For people.
    pub fn in_words(&self) -> String {
        let mut text = format!(
            "leaving nothing out took {:.3} s, the usual run {:.3} s: {:.2} times as long",
            self.seconds, self.usual_seconds, self.times_slower
        );
        let most: Vec<String> = (self.nodes.iter())
            .filter(|node| node.no_leave_out - node.usual > 0.05 * (self.seconds - self.usual_seconds))
            .map(|node| format!("{} {:.3} s for {:.3} s", node.node, node.no_leave_out, node.usual))
            .collect();
        if self.times_slower > 1.0 && !most.is_empty() {
            text += &format!(" ({})", most.join(", "));
        }
        text += match self.largest_difference {
            Some(difference) => format!("; the pictures differ by at most {difference:.1e}\n"),
            None => "\n".into(),
        }
        .as_str();
        if let Some([usual, other]) = &self.engines {
            text += &format!(
                "the usual run drew on the {usual}, the other on the {other}: --set NODE.engine=cpu compares on one\n"
            );
        } else if !self.is_same() {
            text += &format!("warning: the pictures should be the same to {SAME:.0e}\n");
        }
        text
    }

    /// For programs.
    pub fn as_json(&self) -> Value {
        serde_json::json!(self)
    }
}

/// Largest difference of a channel; ∞ for pictures of different sizes.
fn largest_difference(a: &Picture, b: &Picture) -> f64 {
    if (a.width, a.height) != (b.width, b.height) {
        return f64::INFINITY;
    }
    let channels = a.rgba.iter().flatten().zip(b.rgba.iter().flatten());
    channels.map(|(a, b)| (f64::from(*a) - f64::from(*b)).abs()).fold(0.0, f64::max)
}
