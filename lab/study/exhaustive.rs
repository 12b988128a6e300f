//! An exhaustive run compared with the usual one: how much slower it is, and the difference of the pictures.

use crate::work_precision::pixel_errors;
use serde::Serialize;
use serde_json::Value;
use voltet_graph::{RunReport, SkippedWork};

/// Largest difference of a channel that skipped work may make: what culled cells add, and the rounding of 32 bits
/// where one colour is summed and not composited.
pub const SAME: f64 = 1e-6;

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExhaustiveComparison {
    pub usual_seconds: f64,
    pub seconds: f64,
    /// Ratio of the exhaustive run's seconds to the usual ones.
    pub times_slower: f64,
    /// Seconds of each node in both runs, the largest difference first.
    pub nodes: Vec<NodeSeconds>,
    /// Engines of the usual and the exhaustive run, where they differ: a device may not hold the exhaustive one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub engines: Option<[String; 2]>,
    /// Largest difference of a channel of premultiplied linear RGBA between their pictures; `None` without a picture.
    pub largest_difference: Option<f64>,
    pub left_out: Vec<SkippedWork>,
}

#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct NodeSeconds {
    pub node: String,
    pub usual: f64,
    pub exhaustive: f64,
}

impl ExhaustiveComparison {
    pub fn compare(usual: &RunReport, exhaustive: &RunReport) -> ExhaustiveComparison {
        let seconds =
            |name: &str| exhaustive.nodes.iter().find(|node| node.name == name).map(|node| node.seconds);
        let pair = |node: &voltet_graph::NodeReport| {
            let exhaustive = seconds(&node.name)?;
            Some(NodeSeconds { node: node.name.clone(), usual: node.seconds, exhaustive })
        };
        let mut nodes: Vec<NodeSeconds> = usual.nodes.iter().filter_map(pair).collect();
        nodes.sort_by(|a, b| (b.exhaustive - b.usual).total_cmp(&(a.exhaustive - a.usual)));
        let pictures = usual.pictures.iter().filter_map(|(name, picture)| {
            let other = &exhaustive.pictures.iter().find(|(other, _)| other == name)?.1;
            // Pictures of different sizes have nothing in common.
            let same_size = (picture.width, picture.height) == (other.width, other.height);
            Some(if same_size { pixel_errors(picture, other).fold(0.0, f64::max) } else { f64::INFINITY })
        });
        let engine = |report: &RunReport| report.engine.as_ref().map(|engine| engine.0.clone());
        let engines = engine(usual).zip(engine(exhaustive)).filter(|(usual, other)| usual != other);
        ExhaustiveComparison {
            engines: engines.map(|(usual, other)| [usual, other]),
            usual_seconds: usual.seconds,
            seconds: exhaustive.seconds,
            times_slower: exhaustive.seconds / usual.seconds,
            nodes,
            largest_difference: pictures.reduce(f64::max),
            left_out: usual.skipped.clone(),
        }
    }

    /// True if the pictures are the same to [`SAME`].
    pub fn is_same(&self) -> bool {
        self.largest_difference.is_none_or(|difference| difference <= SAME)
    }

    pub fn to_text(&self) -> String {
        let mut text = format!(
            "the exhaustive run took {:.3} s, the usual run {:.3} s: {:.2} times as long",
            self.seconds, self.usual_seconds, self.times_slower
        );
        let most: Vec<String> = (self.nodes.iter())
            .filter(|node| node.exhaustive - node.usual > 0.05 * (self.seconds - self.usual_seconds))
            .map(|node| format!("{} {:.3} s for {:.3} s", node.node, node.exhaustive, node.usual))
            .collect();
        if self.times_slower > 1.0 && !most.is_empty() {
            text += &format!(" ({})", most.join(", "));
        }
        if let Some(difference) = self.largest_difference {
            text += &format!("; the pictures differ by at most {difference:.1e}");
        }
        text += "\n";
        if let Some([usual, other]) = &self.engines {
            text += &format!(
                "the usual run drew on the {usual}, the other on the {other}: --set NODE.engine=cpu compares on one\n"
            );
        } else if !self.is_same() {
            text += &format!("warning: the pictures should be the same to {SAME:.0e}\n");
        }
        text
    }

    /// The comparison as JSON; each node bears its seconds under the former key `no_leave_out`, too.
    pub fn as_json(&self) -> Value {
        let mut found = serde_json::json!(self);
        for node in found["nodes"].as_array_mut().into_iter().flatten() {
            node["no_leave_out"] = node["exhaustive"].clone();
        }
        found
    }
}
