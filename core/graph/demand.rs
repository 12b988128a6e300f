//! The demand pass: what is asked of each node, from the sinks upward.

use super::notes::Notes;
use super::value::{Revision, Value};
use std::collections::BTreeSet;

/// What is asked of a node's outputs. Nothing but what stands here is read, computed or sorted.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Demand {
    /// Point arrays beside the scalar.
    pub arrays: BTreeSet<String>,
    /// Arrays of the file's cells, as they are.
    pub cell_arrays: BTreeSet<String>,
    /// *g* = |∇s| at every point.
    pub gradient_magnitude: bool,
    /// ∇s at every point.
    pub gradient: bool,
    /// An order of the cells.
    pub order: bool,
}

impl Demand {
    /// Everything that a node downstream could ever ask for: what holds when it cannot be known beforehand.
    pub fn unknown() -> Self {
        Demand { gradient_magnitude: true, gradient: false, order: true, ..Demand::default() }
    }

    /// Adds another demand on the same node.
    pub fn join(&mut self, other: &Demand) {
        self.arrays.extend(other.arrays.iter().cloned());
        self.cell_arrays.extend(other.cell_arrays.iter().cloned());
        self.gradient_magnitude |= other.gradient_magnitude;
        self.gradient |= other.gradient;
        self.order |= other.order;
    }

    /// Whether an output made for this demand serves the other one too.
    pub fn covers(&self, other: &Demand) -> bool {
        self.arrays.is_superset(&other.arrays)
            && self.cell_arrays.is_superset(&other.cell_arrays)
            && self.gradient_magnitude >= other.gradient_magnitude
            && self.gradient >= other.gradient
            && self.order >= other.order
    }
}

/// What will run: the outcome of the demand pass. One entry a node of the graph.
#[derive(Debug, Default)]
pub struct Plan {
    /// What is asked of each node.
    pub demands: Vec<Demand>,
    /// What each node said while planning: what it leaves out, which engine it takes.
    pub notes: Vec<Notes>,
    /// The nodes that ran early.
    pub(super) early: Vec<Option<Done>>,
}

/// A node that ran.
#[derive(Debug, Clone)]
pub(super) struct Done {
    pub(super) outputs: Vec<(Value, Revision)>,
    pub(super) notes: Notes,
    pub(super) seconds: f64,
    /// Seconds that the former run took, where its outputs were used.
    pub(super) reused: Option<f64>,
}
