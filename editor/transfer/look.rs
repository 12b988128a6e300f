//! What the panel shows and edits.

use super::form::Drawn;
use crate::worker::Probed;
use std::sync::Arc;
use voltet_core::graph::{NodeEntry, Setting};
use voltet_core::probing::Histogram;

/// What is edited.
pub(super) struct Look<'a> {
    pub node: &'a NodeEntry,
    pub list: &'a [Setting],
    pub widgets: Vec<Drawn>,
    pub histogram: Option<Arc<Histogram>>,
    pub extent: [f64; 2],
    /// The extinction at the top of the plot, for curves.
    pub peak: f64,
    pub probed: Option<Arc<Probed>>,
}
