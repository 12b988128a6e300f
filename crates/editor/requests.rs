//! Requests to the worker, and handling of its answers.

use crate::arrays::{self, Arrays};
use crate::editor::{Editor, RequestInputs, camera_size};
use crate::scene::pictures;
use crate::transfer;
use crate::view::View;
use crate::worker::{
    DataScales, DistributionQuery, PixelProbe, ProbeQuery, RenderRequest, SectionQuery, ShareQuery, short,
};
use std::collections::BTreeSet;
use std::sync::Arc;
use voltet_document::links::{self, upstream};
use voltet_graph::{NodeEntry, ParameterValue};

impl Editor {
    /// Asks the worker for what is wanted now and was not before.
    pub(crate) fn wish(&mut self) {
        let hidden = self.transfer.hidden().map(|(look, hidden)| (look.to_string(), hidden.clone()));
        let ground = RequestInputs {
            revision: self.document.revision(),
            shown: self.shown_node.clone(),
            room: self.picture.room,
            hidden,
            axes: self.transfer.axes(),
            drags: self.transfer.dragged().is_some(),
            selection: self.selection.clone(),
        };
        if self.ground.as_ref() != Some(&ground) {
            self.draw();
            self.find_distribution();
            self.ground = Some(ground);
        }
        self.find_share();
        self.find_section();
        self.find_previews();
    }

    /// Asks anew for all that is read from files; what they still say is not done again.
    pub(crate) fn read_again(&mut self) {
        (self.ground, self.asked) = (None, None);
        if let Some(asked) = &mut self.distribution {
            asked.nodes.clear();
        }
        self.lookups.forget();
        self.arrays = Arrays::default();
    }

    /// Notices what other programs wrote.
    pub(crate) fn look_at_disk(&mut self) {
        let (document, registry) = (&self.document, &self.registry);
        let read = || {
            let read = document.pipeline().nodes.iter().filter(|entry| arrays::reads(entry, registry));
            read.filter_map(arrays::path_of).map(|path| document.folder().join(path)).collect()
        };
        if self.disk.look(document, read, &self.watch) {
            self.read_again();
            self.message = Some(("the data were written anew: they are read again".into(), false));
        }
    }

    /// Asks the worker for the picture where another is wanted than before.
    fn draw(&mut self) {
        let Some(node) = self.shown_node.clone() else { return };
        let nodes = &self.document.pipeline().nodes;
        let size = self.camera().and_then(camera_size).map(|own| fitted(own, self.picture.room));
        let mut nodes = nodes.clone();
        if let (Some(look), Some(found)) = (self.transfer.dragged(), self.scene().distribution) {
            put_in_numbers(&mut nodes, look, &found.known);
        }
        if let Some((look, hidden)) = self.transfer.hidden() {
            remove_hidden_widgets(&mut nodes, look, hidden);
        }
        let wanted = RenderRequest {
            background: background(&nodes, &node),
            nodes,
            folder: self.document.folder(),
            node,
            size,
            coarse_first: true,
        };
        let same = |asked: &RenderRequest| {
            let feeding = |wanted: &RenderRequest| {
                let names = wanted.upstream();
                wanted.nodes.iter().filter(|node| names.contains(&node.name)).cloned().collect::<Vec<_>>()
            };
            (&asked.node, asked.size, asked.background, &asked.folder)
                == (&wanted.node, wanted.size, wanted.background, &wanted.folder)
                && feeding(asked) == feeding(&wanted)
        };
        if !self.asked.as_ref().is_some_and(same) {
            self.lookups.picture = self.worker.draw(wanted.clone());
            self.asked = Some(wanted);
        }
    }

    /// Asks for the distribution of what the edited transfer function is drawn with, where another is wanted than before.
    fn find_distribution(&mut self) {
        let (source, fields, of_series) = {
            let scene = self.scene();
            let look = transfer::edited_node(&scene);
            let fields = look.map(transfer::fields_of).unwrap_or_default();
            let of_series = look.is_some_and(transfer::is_of_series);
            (look.and_then(|look| transfer::volume_of(&scene, &look.name)), fields, of_series)
        };
        let Some(source) = source else { return };
        let nodes = self.feeding(&source);
        let (folder, axes) = (self.document.folder(), self.transfer.axes());
        let key = self.distribution.as_ref().map_or(0, |asked| asked.key);
        let mut wanted = DistributionQuery { nodes, folder, node: source, axes, fields, of_series, key };
        if self.distribution.as_ref() != Some(&wanted) {
            wanted.key += 1;
            self.worker.find_distribution(wanted.clone());
            self.distribution = Some(wanted);
        }
    }

    /// The nodes that feed an output, and its own.
    fn feeding(&self, source: &str) -> Vec<NodeEntry> {
        let all = &self.document.pipeline().nodes;
        let (name, _) = links::source(source, all);
        let names = upstream(all, name);
        all.iter().filter(|node| names.contains(&node.name)).cloned().collect()
    }

    /// Asks what the widget in hand adds to the picture, once the full one is there.
    fn find_share(&mut self) {
        let Some((look, chosen)) = self.transfer.in_hand() else { return };
        let of = (self.lookups.picture, look.to_string(), chosen);
        if self.lookups.is_shared(&of)
            || !self.worker.shown(|shown| !shown.is_busy && shown.failure.is_none())
        {
            return;
        }
        let drawn = self.transfer.hidden().filter(|(of, _)| *of == look);
        let is_hidden = |place: &usize| drawn.is_some_and(|(_, hidden)| hidden.contains(place));
        let Some(wanted) = self.asked.clone().filter(|_| !is_hidden(&chosen)) else { return };
        if !wanted.upstream().contains(look) {
            return;
        }
        let widget = (0..chosen).filter(|place| !is_hidden(place)).count();
        let key = self.lookups.next_share(of.clone());
        self.worker.share(ShareQuery { wanted, look: of.1, widget, key });
    }

    /// Asks for small pictures of the other nodes that give one, once the shown one is there and no hand is at work.
    fn find_previews(&mut self) {
        let of = (self.document.revision(), self.shown_node.clone());
        let is_asked = self.lookups.previews_of.as_ref() == Some(&of);
        if is_asked || self.gesture.is_some() || self.worker.shown(|shown| shown.is_busy) {
            return;
        }
        let names = pictures(&self.document, &self.registry).into_iter().map(str::to_string);
        let others: Vec<String> = names.filter(|name| Some(name) != self.shown_node.as_ref()).collect();
        for node in others {
            let background = background(&self.document.pipeline().nodes, &node);
            let (nodes, folder) = (self.feeding(&node), self.document.folder());
            let wanted = RenderRequest {
                nodes,
                folder,
                node: node.clone(),
                size: None,
                background,
                coarse_first: false,
            };
            if self.lookups.previews.get(&node) != Some(&wanted) {
                self.worker.preview(wanted.clone());
                self.lookups.previews.insert(node, wanted);
            }
        }
        self.lookups.previews_of = Some(of);
    }

    /// Asks for the section, where it is shown and another is wanted than before.
    fn find_section(&mut self) {
        if !self.section.open {
            return;
        }
        let found = {
            let scene = self.scene();
            let look = transfer::edited_node(&scene).map(|look| look.name.clone());
            let source = look.and_then(|look| transfer::volume_of(&scene, &look));
            let plane =
                scene.view.zip(scene.bounds).and_then(|(view, bounds)| self.section.wanted(view, bounds));
            source.zip(plane)
        };
        let Some((node, (centre, axes, half))) = found else { return };
        let nodes = self.feeding(&node);
        let (folder, size) = (self.document.folder(), self.section.size());
        let key = self.lookups.section.as_ref().map_or(0, |asked| asked.key);
        let mut wanted = SectionQuery { nodes, folder, node, centre, axes, half, size, key };
        if self.lookups.section.as_ref() != Some(&wanted) {
            wanted.key += 1;
            self.worker.cut(wanted.clone());
            self.lookups.section = Some(wanted);
        }
    }

    /// Asks what lies at places of the picture.
    pub(crate) fn probe(&mut self, places: Vec<[f64; 2]>, centres: bool) {
        let sources = {
            let scene = self.scene();
            let look = transfer::edited_node(&scene).map(|look| look.name.clone());
            look.and_then(|look| {
                Some([transfer::volume_of(&scene, &look)?, look, self.camera()?.name.clone()])
            })
        };
        let Some(sources) = sources else { return };
        self.last_probe += 1;
        let key = self.last_probe;
        self.probing = Some((key, centres));
        let nodes = self.document.pipeline().nodes.clone();
        self.worker.probe(ProbeQuery { nodes, folder: self.document.folder(), sources, places, key });
    }

    /// Takes over what a probe found: values in a line, or the centre.
    pub(crate) fn take_probed(&mut self) {
        let Some((key, centres)) = self.probing else { return };
        let found = self.worker.shown(|shown| shown.probed.as_ref().filter(|(of, _)| *of == key).cloned());
        match found {
            Some((_, Err(error))) => self.complain(&error),
            Some((_, Ok(found))) if centres => {
                if let (Some(point), Some(view)) = (found.point, self.camera().and_then(View::from_camera)) {
                    self.look(view.centred(point));
                }
            }
            Some((_, Ok(found))) => self.show_probed(found),
            None => return,
        }
        self.probing = None;
    }

    /// Shows values that were found.
    pub(crate) fn show_probed(&mut self, found: Arc<PixelProbe>) {
        let place = match found.rays {
            0 => "in the section".to_string(),
            1 => "on the ray".to_string(),
            rays => format!("on {rays} rays"),
        };
        let text = match found.moments() {
            Some(([s, g], [[ss, _], [_, gg]])) => format!(
                "{} values {place}: s {} ± {}, g {} ± {}; \"+ at probe\" makes a widget of them",
                found.values.len(),
                short(s),
                short(ss.sqrt()),
                short(g),
                short(gg.sqrt()),
            ),
            None => format!("no cell is met {place}"),
        };
        self.message = Some((text, false));
        self.probed = Some(found);
    }

    /// The camera node that the shown picture is seen from.
    pub(crate) fn camera(&self) -> Option<&NodeEntry> {
        let nodes = &self.document.pipeline().nodes;
        let feeding = upstream(nodes, self.shown_node.as_deref()?);
        nodes.iter().find(|node| node.node_type.text() == Some("camera") && feeding.contains(&node.name))
    }
}

/// Puts numbers in the place of those relative to data, where they are known.
fn put_in_numbers(nodes: &mut [NodeEntry], look: &str, known: &DataScales) {
    let Some(node) = nodes.iter_mut().find(|node| node.name == look) else { return };
    let widgets = node.settings.iter_mut().find(|field| field.name == "widgets");
    if let Some(setting) = widgets.map(|field| &mut field.setting)
        && let Some(list) = setting.list().and_then(|list| transfer::in_numbers(list, known))
    {
        setting.datum = ParameterValue::List(list);
    }
}

/// Takes widgets out of a transfer function.
fn remove_hidden_widgets(nodes: &mut [NodeEntry], look: &str, hidden: &BTreeSet<usize>) {
    let node = nodes.iter_mut().find(|node| node.name == look);
    let field = node.and_then(|node| node.settings.iter_mut().find(|field| field.name == "widgets"));
    if let Some(ParameterValue::List(list)) = field.map(|field| &mut field.setting.datum) {
        let mut place = 0;
        list.retain(|_| {
            place += 1;
            !hidden.contains(&(place - 1))
        });
    }
}

/// A picture of that shape with no more pixels than there is room for, and no more than it has.
fn fitted([width, height]: [u32; 2], room: [u32; 2]) -> [u32; 2] {
    let scale = (f64::from(room[0]) / f64::from(width)).min(f64::from(room[1]) / f64::from(height)).min(1.0);
    [width, height].map(|side| ((f64::from(side) * scale).round() as u32).max(1))
}

/// The background that a writer puts behind the picture of a node.
fn background(nodes: &[NodeEntry], node: &str) -> [f64; 3] {
    let writes = |entry: &&NodeEntry| {
        entry.node_type.text() == Some("image-writer")
            && entry.inputs.iter().any(|link| {
                link.source.text().is_some_and(|text| text == node || text.split('.').next() == Some(node))
            })
    };
    let writer = nodes.iter().find(writes);
    let stated = writer.and_then(|writer| writer.settings.iter().find(|field| field.name == "background"));
    stated.and_then(|field| field.setting.numbers()?.try_into().ok()).unwrap_or([0.0; 3])
}
