//! The editor: a document, a worker, what is selected and shown; one function a frame, which knows no window.

use crate::actions::Command;
use crate::arrays::Arrays;
use crate::file_dialog::FileDialog;
use crate::files::{BETWEEN, Disk, FileWatcher, Recent, Recover};
use crate::graph::GraphView;
use crate::input::GestureTracker;
use crate::jobs::Job;
use crate::parameters::ParameterPanel;
use crate::picture::PicturePanel;
use crate::scene::{Scene, pictures};
use crate::section::SectionPanel;
use crate::study::StudyPanel;
use crate::transfer::TransferPanel;
use crate::view::View;
use crate::worker::{Estimate, NodeState, PixelProbe, RenderRequest, Worker, WorkerOutput, size_of};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use voltet_core::{Error, Result};
use voltet_document::{Document, Gesture};
use voltet_graph::{NodeEntry, Registry, RunReport};

/// Makes the text of a pipeline for a file that is none, such as data; the second path is where it would be saved.
pub type Start = Arc<dyn Fn(&Path, &Path) -> Result<String> + Send + Sync>;

/// All that a window shows.
pub struct Editor {
    pub(crate) document: Document,
    pub(crate) registry: Registry,
    pub(crate) worker: Worker,
    pub(crate) start: Start,
    /// A pipeline that is being made.
    pub(crate) made: Option<Job<Document>>,
    pub(crate) selection: BTreeSet<String>,
    pub(crate) shown_node: Option<String>,
    pub(crate) graph: GraphView,
    pub(crate) picture: PicturePanel,
    pub(crate) parameters: ParameterPanel,
    pub(crate) transfer: TransferPanel,
    pub(crate) arrays: Arrays,
    pub(crate) message: Option<(String, bool)>,
    pub(crate) recover: Recover,
    pub(crate) disk: Disk,
    pub(crate) watch: FileWatcher,
    pub(crate) help: bool,
    pub(crate) costs: bool,
    pub(crate) file_dialog: Option<FileDialog>,
    /// File to open once unsaved work is settled; `None` opens a file dialog.
    pub(crate) begin_with: Option<PathBuf>,
    pub(crate) recent: Recent,
    /// A whole run that is under way.
    pub(crate) run: Option<Job<RunReport>>,
    /// Command that waits for a decision about unsaved work.
    pub(crate) unsaved: Option<Command>,
    /// The picture that was asked for last, and its number.
    pub(crate) asked: Option<RenderRequest>,
    pub(crate) picture_number: u64,
    /// The revision and the shown node that small pictures were asked for last.
    pub(crate) previews_of: Option<(u64, Option<String>)>,
    /// True for a probe that is waited for to centre the picture.
    pub(crate) probing: Option<bool>,
    pub(crate) probed: Option<Arc<PixelProbe>>,
    pub(crate) section: SectionPanel,
    pub(crate) study: StudyPanel,
    pub(crate) faults: (Option<u64>, Vec<Error>),
    pub(crate) gestures: GestureTracker,
    /// Undo step of the edits of this frame.
    pub(crate) gesture: Option<Gesture>,
    pub(crate) ends: bool,
}

impl Editor {
    /// An editor of a document. `wake` has the window shown again, from any thread.
    pub fn new(
        document: Document,
        registry: &Registry,
        start: Start,
        wake: crate::worker::RepaintCallback,
    ) -> Result<Editor> {
        let wakes = wake.clone();
        let no_thread = |error| Error::run("no thread can be had to look at files with").got(error);
        let watch = FileWatcher::start(BETWEEN, move || wakes()).map_err(no_thread)?;
        let mut editor = Editor {
            document,
            worker: Worker::start(registry, wake)?,
            registry: registry.clone(),
            start,
            made: None,
            selection: BTreeSet::new(),
            shown_node: None,
            graph: GraphView::default(),
            picture: PicturePanel::default(),
            parameters: ParameterPanel::default(),
            transfer: TransferPanel::default(),
            arrays: Arrays::default(),
            message: None,
            recover: Recover::default(),
            disk: Disk::default(),
            watch,
            help: false,
            costs: false,
            file_dialog: None,
            begin_with: None,
            recent: Recent::default(),
            run: None,
            unsaved: None,
            asked: None,
            picture_number: 0,
            previews_of: None,
            probing: None,
            probed: None,
            section: SectionPanel::default(),
            study: StudyPanel::default(),
            faults: (None, Vec::new()),
            gestures: GestureTracker::default(),
            gesture: None,
            ends: false,
        };
        editor.begin();
        Ok(editor)
    }

    /// The document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The worker.
    pub fn worker(&self) -> &Worker {
        &self.worker
    }

    /// True if the window is to close.
    pub fn ends(&self) -> bool {
        self.ends
    }

    /// Lays out the document; the transfer function is what is worked on first.
    pub(crate) fn begin(&mut self) {
        let nodes = &self.document.pipeline().nodes;
        let look = nodes.iter().find(|node| node.node_type.text() == Some("transfer-function"));
        self.selection = look.iter().map(|node| node.name.clone()).collect();
        let registry = &self.registry;
        let node = |entry: &NodeEntry| entry.node_type.text().and_then(|name| registry.find(name).ok());
        self.document.lay_out(&|entry| crate::graph::usual_size(node(entry)));
    }

    /// Drops from the selection what is gone, and finds a picture to show where there is none.
    pub(crate) fn settle_on_nodes(&mut self) {
        let nodes = &self.document.pipeline().nodes;
        self.selection.retain(|name| nodes.iter().any(|node| node.name == *name));
        let pictures = pictures(&self.document, &self.registry);
        if !self.shown_node.as_deref().is_some_and(|shown| pictures.contains(&shown)) {
            self.shown_node = pictures.last().map(|name| name.to_string());
        }
        if self.faults.0 != Some(self.document.revision()) {
            self.faults = (Some(self.document.revision()), faults(&self.document, &self.registry));
        }
    }

    /// Read-only view of the editor for the window's parts.
    pub(crate) fn scene(&self) -> Scene<'_> {
        let camera = self.camera();
        self.worker.shown(|shown| {
            let distribution = shown.distribution.answer();
            let is_newest = shown.share.asked().is_some_and(|asked| asked.picture == self.picture_number);
            let previews = shown.previews.iter();
            let preview = |(node, preview): (&String, &crate::worker::Preview)| {
                Some((node.clone(), preview.last()?.as_ref().ok()?.clone()))
            };
            Scene {
                document: &self.document,
                registry: &self.registry,
                arrays: &self.arrays,
                selection: &self.selection,
                shown_node: self.shown_node.as_deref(),
                view: camera.and_then(View::from_camera),
                picture_size: camera.and_then(size_of),
                pixels: shown.pixels.clone().filter(|_| self.shown_node.is_some()),
                previews: previews.filter_map(preview).collect(),
                asks: self.unsaved.is_some() || self.file_dialog.is_some(),
                nodes: shown.nodes.clone(),
                values: shown.values.clone(),
                failure: shown.failure.clone(),
                running: running(shown),
                seconds: shown.pixels.as_ref().and_then(|p| shown.seconds[usize::from(!p.is_full())]),
                distribution: distribution.and_then(|found| found.as_ref().ok().cloned()),
                distribution_fault: distribution.and_then(|found| found.as_ref().err().cloned()),
                probed: self.probed.clone(),
                share: shown.share.answer().filter(|_| is_newest).cloned(),
                section: shown.section.last().cloned(),
                report: shown.report.clone(),
                estimate: shown.estimate.answer().cloned(),
                is_estimating: shown.estimate.is_waiting(),
                faults: &self.faults.1,
                entries: self.document.pipeline().nodes.iter().map(|n| (n.name.as_str(), n)).collect(),
            }
        })
    }

    /// Asks how wrong the picture is.
    pub(crate) fn estimate(&self) {
        if let Some(asked) = self.asked.clone() {
            self.worker.ask(|output| &mut output.estimate, Estimate(asked));
        }
    }
}

/// Description of the work in progress.
fn running(shown: &WorkerOutput) -> Option<String> {
    if !shown.is_busy {
        return None;
    }
    let in_hand = shown.nodes.iter().find_map(|(name, status)| match &status.state {
        NodeState::Running(stage, _) if stage.is_empty() => Some(format!("{name} …")),
        NodeState::Running(stage, fraction) => Some(format!("{name}: {stage} {:.0} %", 100.0 * fraction)),
        _ => None,
    });
    Some(in_hand.unwrap_or_else(|| "drawing …".into()))
}

/// Errors of the document, each at its node.
fn faults(document: &Document, registry: &Registry) -> Vec<Error> {
    if document.pipeline().nodes.is_empty() && document.is_toml() {
        return Vec::new();
    }
    let named = |fault: voltet_document::Diagnostic| match fault.node {
        Some(node) => fault.error.at_node(node),
        None => fault.error,
    };
    document.faults(registry).into_iter().map(named).collect()
}
