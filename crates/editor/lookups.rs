//! Queries to the worker besides pictures, and the test for answers to the newest.

use crate::worker::{RenderRequest, Section, SectionQuery, Share, WorkerOutput};
use std::collections::BTreeMap;
use std::sync::Arc;

/// The newest questions.
#[derive(Default)]
pub(crate) struct Lookups {
    /// The number of the newest picture.
    pub picture: u64,
    /// The picture, the transfer function and the widget that a share was asked for last.
    share: Option<(u64, String, usize)>,
    last_share: u64,
    /// The small pictures that were asked for last, by their nodes, and for which document and shown node.
    pub previews: BTreeMap<String, RenderRequest>,
    pub previews_of: Option<(u64, Option<String>)>,
    /// The section that was asked for last.
    pub section: Option<SectionQuery>,
}

impl Lookups {
    /// As if nothing but pictures and shares had been asked for.
    pub fn forget(&mut self) {
        self.previews.clear();
        (self.previews_of, self.section) = (None, None);
    }

    /// True if the share of this widget in this picture was requested.
    pub fn is_shared(&self, of: &(u64, String, usize)) -> bool {
        self.share.as_ref() == Some(of)
    }

    /// The key of the next question for a share.
    pub fn next_share(&mut self, of: (u64, String, usize)) -> u64 {
        self.share = Some(of);
        self.last_share += 1;
        self.last_share
    }

    /// The share, once it is that of the newest question and picture.
    pub fn share(&self, shown: &WorkerOutput) -> Option<Result<Share, String>> {
        let (picture, ..) = self.share.as_ref()?;
        let (key, found) = shown.share.as_ref()?;
        let is_newest = *key == self.last_share && *picture == self.picture;
        is_newest.then(|| found.clone().map_err(|error| error.to_string()))
    }

    /// The section, the newest one that there is.
    pub fn section(&self, shown: &WorkerOutput) -> Option<Result<Arc<Section>, String>> {
        self.section.as_ref()?;
        let (_, found) = shown.section.as_ref()?;
        Some(found.clone().map_err(|error| error.to_string()))
    }
}
