//! Requests to the worker, and handling of its answers.

use crate::editor::{Answers, Editor};
use crate::eyes::visible_nodes;
use crate::jobs::{self, Arrays};
use crate::scene::{camera_of, pictures};
use crate::section;
use crate::time_strip::Readers;
use crate::transfer;
use crate::view::View;
use crate::worker::{
    DataScales, DistributionQuery, PreviewQuery, RenderRequest, SectionQuery, ShareQuery, VolumeSource,
    retain_widgets, size_of,
};
use eframe::egui::Context;
use std::time::Instant;
use voltet_core::parameters::ENTRY_NAME;
use voltet_document::links::{self, upstream};
use voltet_graph::{NodeEntry, ParameterValue};

impl Editor {
    /// Asks the worker for what is wanted now; what was asked last is not asked again.
    pub(crate) fn wish(&mut self) {
        self.draw();
        self.find_distribution();
        self.find_share();
        self.find_section();
        self.find_hovered();
        self.find_previews();
    }

    /// True if the document still gives this volume.
    pub(crate) fn is_current(&self, source: &VolumeSource) -> bool {
        let now = self.volume_source(source.output.clone());
        let before = links::feeding(&source.nodes, links::source(&source.output, &source.nodes).0);
        (now.folder, now.nodes) == (source.folder.clone(), before)
    }

    /// Looks how far the worker's answers are behind, and has the window shown again once that is long.
    pub(crate) fn follow_answers(&mut self, ctx: &Context) {
        let (answered, section) = self.worker.shown(|shown| (shown.answered, shown.section.numbers()));
        let newest = if self.answers.asked.is_some() { self.answers.picture_number } else { answered };
        let now = Instant::now();
        let left = [
            self.answers.picture_lag.follow([newest, answered], now),
            self.answers.section_lag.follow(section, now),
        ];
        left.into_iter().flatten().for_each(|left| ctx.request_repaint_after(left));
    }

    /// Forgets what the worker found, which belongs to nothing that is shown any more.
    pub(crate) fn forget_answers(&mut self) {
        self.worker.forget();
        self.answers = Answers::default();
    }

    /// Asks anew for all that is read from files; what they still say is not done again.
    pub(crate) fn read_again(&mut self) {
        self.answers.asked = None;
        self.worker.forget_queries();
        self.arrays = Arrays::default();
        self.panels.time.readers = Readers::default();
    }

    pub(crate) fn look_at_disk(&mut self) {
        let (document, registry) = (&self.document, &self.registry);
        let read = || {
            let read = document.pipeline().nodes.iter().filter(|entry| jobs::reads(entry, registry));
            read.filter_map(jobs::path_of).map(|path| document.folder().join(path)).collect()
        };
        if self.disk.look(document, read, &self.watch) {
            self.read_again();
            if !self.say_what_is_missing() {
                self.say("a data file has changed: the data are read again");
            }
        }
    }

    /// Says which data file is not there, if one is not.
    pub(crate) fn say_what_is_missing(&mut self) -> bool {
        let read = self.document.pipeline().nodes.iter().filter(|entry| jobs::reads(entry, &self.registry));
        let missing = |path: &&str| !self.document.folder().join(path).exists();
        let missing = read.filter_map(jobs::path_of).find(missing);
        let Some(text) = missing.map(|path| format!("the data file '{path}' is missing")) else {
            return false;
        };
        self.say(text);
        true
    }

    /// Asks the worker for the picture where another is wanted than before.
    fn draw(&mut self) {
        let Some(node) = &self.shown_node else {
            if self.answers.asked.is_some() {
                self.forget_answers();
            }
            return;
        };
        let size = self.camera().and_then(size_of).map(|own| fitted(own, self.panels.picture.room));
        let all = visible_nodes(&self.document, &self.registry);
        let mut wanted = self.request_of(&all, node, size, true);
        if let (Some(look), Some(found)) = (self.panels.transfer.dragged(), self.scene().distribution) {
            put_in_numbers(&mut wanted.nodes, look, &found.known);
        }
        self.answers.proposes = self.put_shown_widgets(&mut wanted.nodes);
        let next = self.put_frame(&mut wanted);
        // That a hand lets go of a grip asks for no other picture.
        wanted.grip_moves = self.answers.asked.as_ref().is_some_and(|asked| asked.grip_moves);
        if self.answers.asked.as_ref() != Some(&wanted) {
            self.panels.time.count_no_more();
            wanted.grip_moves = self.panels.picture.handles.are_moved();
            self.answers.picture_number = self.worker.draw_and_read(wanted.clone(), next);
            self.answers.asked = Some(wanted);
        }
    }

    /// Leaves out the widgets that the window's picture is drawn without, and adds the one that is proposed; whether there is one.
    pub(crate) fn put_shown_widgets(&self, nodes: &mut [NodeEntry]) -> bool {
        if let Some((look, hidden)) = self.panels.transfer.hidden() {
            retain_widgets(nodes, look, |place| !hidden.contains(&place));
        }
        let proposed = self.panels.transfer.proposed();
        if let Some((look, entry)) = proposed {
            add_widget(nodes, look, entry);
        }
        proposed.is_some()
    }

    /// The request for the picture of a node among these.
    pub(crate) fn request_of(
        &self,
        all: &[NodeEntry],
        node: &str,
        size: Option<[u32; 2]>,
        coarse_first: bool,
    ) -> RenderRequest {
        let (mut nodes, folder) = (links::feeding(all, node), self.document.folder());
        forget_names(&mut nodes);
        let background = background(all, node);
        let node = node.to_string();
        RenderRequest { nodes, folder, node, size, background, coarse_first, grip_moves: false }
    }

    /// The transfer function that is edited, and the output that gives the volume that it is drawn with.
    pub(crate) fn edited(&self) -> Option<(&NodeEntry, String)> {
        let scene = self.scene();
        let look = transfer::edited_node(&scene)?;
        Some((look, transfer::volume_of(&scene, &look.name)?))
    }

    fn volume_source(&self, output: String) -> VolumeSource {
        let all = self.nodes_of_frame();
        let nodes = links::feeding(&all, links::source(&output, &all).0);
        VolumeSource { nodes, folder: self.document.folder(), output }
    }

    /// Asks for the distribution of what the edited transfer function is drawn with.
    fn find_distribution(&mut self) {
        let Some((look, output)) = self.edited() else {
            return self.worker.forget_query(|output| &mut output.distribution);
        };
        let (fields, scope) = (transfer::fields_of(look), transfer::data_scope(look));
        let (source, axes) = (self.volume_source(output.clone()), self.panels.transfer.axes());
        let scales = transfer::scales(look, &axes);
        let wanted = DistributionQuery { source, axes, scales, fields, scope };
        let is_known = self.worker.shown(|shown| {
            let asked = shown.distribution.asked().filter(|_| !shown.distribution.is_waiting());
            // Of the same output and axes, whatever the frame.
            asked.is_some_and(|asked| {
                let nodes = asked.source.nodes.clone();
                let source = VolumeSource { nodes, ..wanted.source.clone() };
                DistributionQuery { source, ..wanted.clone() } == *asked
            })
        });
        if !self.keeps_histogram() || !is_known {
            self.worker.ask(|output| &mut output.distribution, wanted);
        }
        if self.answers.probed.as_ref().is_some_and(|(source, _)| source.output != output) {
            self.answers.probed = None;
        }
    }

    /// Asks what the widget in hand adds to the picture, once the full one is there.
    fn find_share(&self) {
        let Some((look, place)) = self.panels.transfer.in_hand() else { return };
        let is_due = self.worker.shown(|shown| !shown.is_busy && shown.failure.is_none());
        let hidden = self.panels.transfer.hidden().filter(|(of, _)| *of == look);
        let is_hidden = |place: &usize| hidden.is_some_and(|(_, hidden)| hidden.contains(place));
        let Some(wanted) = self.answers.asked.as_ref().filter(|_| is_due && !is_hidden(&place)) else {
            return;
        };
        if wanted.nodes.iter().any(|node| node.name == look) {
            let widget = (0..place).filter(|place| !is_hidden(place)).count();
            let (picture, look, wanted) = (self.answers.picture_number, look.to_string(), wanted.clone());
            let wanted = ShareQuery { picture, look, wanted, widget };
            self.worker.ask(|output| &mut output.share, wanted);
        } else {
            // The last answer is that of a widget of the picture.
            self.worker.forget_query(|output| &mut output.share);
        }
    }

    /// Asks for small pictures of the other nodes that give one, once the shown one is there and no hand is at work.
    fn find_previews(&self) {
        if self.gesture.is_some()
            || self.panels.time.playing.is_some()
            || self.worker.shown(|shown| shown.is_busy)
        {
            return;
        }
        let all = self.nodes_of_frame();
        for node in pictures(&self.document, &self.registry) {
            if Some(node) != self.shown_node.as_deref() {
                let wanted = PreviewQuery(self.request_of(&all, node, None, false));
                self.worker.ask(|output| output.preview(node), wanted);
            }
        }
    }

    fn find_section(&self) {
        if !self.panels.section.open {
            return;
        }
        let plane = self
            .view()
            .zip(self.worker.shown(|shown| shown.bounds))
            .and_then(|(view, bounds)| self.panels.section.wanted(view, bounds));
        let Some(((_, output), (centre, axes, half))) = self.edited().zip(plane) else {
            return self.worker.forget_query(|output| &mut output.section);
        };
        let (source, size) = (self.volume_source(output), section::SIZE);
        let wanted = SectionQuery { source, centre, axes, half, size };
        self.worker.ask(|output| &mut output.section, wanted);
    }

    /// The view of the picture, as its camera states it; of one that is stated otherwise than by eye and target, that of the last full
    /// picture.
    pub(crate) fn view(&self) -> Option<View> {
        let camera = self.camera()?;
        let drawn = || {
            let report = self.worker.shown(|shown| shown.report.clone())?;
            let found = report.origins.cameras.iter().find(|(node, _)| *node == camera.name);
            found.map(|(_, camera)| View::from(**camera))
        };
        let free = self.panels.time.free.as_ref().map(|(_, view)| *view);
        free.or_else(|| View::from_camera(camera)).or_else(drawn)
    }

    pub(crate) fn camera(&self) -> Option<&NodeEntry> {
        camera_of(&self.document.pipeline().nodes, self.shown_node.as_deref()?)
    }
}

/// Puts numbers in the place of those relative to data, where they are known.
fn put_in_numbers(nodes: &mut [NodeEntry], look: &str, known: &DataScales) {
    let Some(node) = nodes.iter_mut().find(|node| node.name == look) else { return };
    let list = node.setting("widgets").and_then(|setting| setting.list());
    if let Some(list) = list.and_then(|list| transfer::in_numbers(list, known)) {
        // Only a path that leads nowhere is refused.
        let _ = node.set("widgets", &[], ParameterValue::List(list).into());
    }
}

/// Takes the names of widgets and such out, of which no picture is made.
fn forget_names(nodes: &mut [NodeEntry]) {
    for field in nodes.iter_mut().flat_map(|node| &mut node.settings) {
        let ParameterValue::List(list) = &mut field.setting.datum else { continue };
        for entry in list {
            if let ParameterValue::Table(fields) = &mut entry.datum {
                fields.retain(|field| field.name != ENTRY_NAME);
            }
        }
    }
}

/// Adds a widget to a transfer function.
fn add_widget(nodes: &mut [NodeEntry], look: &str, entry: &ParameterValue) {
    let Some(node) = nodes.iter_mut().find(|node| node.name == look) else { return };
    let before = node.setting("widgets").and_then(|setting| setting.list()).unwrap_or_default();
    let list = before.iter().cloned().chain([entry.clone().into()]).collect();
    // Only a path that leads nowhere is refused.
    let _ = node.set("widgets", &[], ParameterValue::List(list).into());
}

/// A picture of that shape with no more pixels than there is room for, and no more than it has.
fn fitted([width, height]: [u32; 2], room: [u32; 2]) -> [u32; 2] {
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height)).min(1.0);
    [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1))
}

/// The background that a writer puts behind the picture of a node, or behind what another makes of it.
fn background(nodes: &[NodeEntry], node: &str) -> [f64; 3] {
    let writes = |entry: &&NodeEntry| {
        entry.node_type.text() == Some("image-writer") && upstream(nodes, &entry.name).contains(node)
    };
    let stated = nodes.iter().find(writes).and_then(|writer| writer.setting("background"));
    stated.and_then(|stated| stated.color()).unwrap_or([0.0; 3])
}
