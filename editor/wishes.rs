//! What the worker is asked for, and what becomes of its answers.

use crate::editor::{Editor, Ground, camera_size};
use crate::transfer;
use crate::view::View;
use crate::worker::{Distribution, Probing, Wanted, short};
use std::collections::BTreeSet;
use voltet_core::graph::{Datum, NodeEntry};
use voltet_document::links::{self, upstream};

impl Editor {
    /// Asks the worker for what is wanted now and was not before.
    pub(crate) fn wish(&mut self) {
        let hidden = self.transfer.hidden().map(|(look, hidden)| (look.to_string(), hidden.clone()));
        let ground = Ground {
            revision: self.document.revision(),
            shown: self.shown_node.clone(),
            room: self.picture.room,
            hidden,
            selection: self.selection.clone(),
        };
        if self.ground.as_ref() != Some(&ground) {
            self.draw();
            self.find_distribution();
            self.ground = Some(ground);
        }
    }

    /// Asks the worker for the picture where another is wanted than before.
    fn draw(&mut self) {
        let Some(node) = self.shown_node.clone() else { return };
        let nodes = &self.document.pipeline().nodes;
        let size = self.camera().and_then(camera_size).map(|own| fitted(own, self.picture.room));
        let mut nodes = nodes.clone();
        if let Some((look, hidden)) = self.transfer.hidden() {
            leave_out(&mut nodes, look, hidden);
        }
        let wanted = Wanted {
            background: background(&nodes, &node),
            nodes,
            folder: self.document.folder(),
            node,
            size,
            coarse_first: true,
        };
        let same = |asked: &Wanted| {
            let feeding = |wanted: &Wanted| {
                let names = wanted.upstream();
                wanted.nodes.iter().filter(|node| names.contains(&node.name)).cloned().collect::<Vec<_>>()
            };
            (&asked.node, asked.size, asked.background, &asked.folder)
                == (&wanted.node, wanted.size, wanted.background, &wanted.folder)
                && feeding(asked) == feeding(&wanted)
        };
        if !self.asked.as_ref().is_some_and(same) {
            self.worker.draw(wanted.clone());
            self.asked = Some(wanted);
        }
    }

    /// Asks for the distribution of what the edited transfer function is drawn with, where another is wanted than before.
    fn find_distribution(&mut self) {
        let source = {
            let scene = self.scene();
            let look = transfer::of(&scene).map(|look| look.name.clone());
            look.and_then(|look| transfer::volume_of(&scene, &look))
        };
        let Some(source) = source else { return };
        let all = &self.document.pipeline().nodes;
        let (name, _) = links::source(&source, all);
        let feeding = upstream(all, name);
        let nodes: Vec<NodeEntry> = all.iter().filter(|node| feeding.contains(&node.name)).cloned().collect();
        let folder = self.document.folder();
        let same =
            |asked: &Distribution| asked.nodes == nodes && asked.node == source && asked.folder == folder;
        if !self.distribution.as_ref().is_some_and(same) {
            let key = self.distribution.as_ref().map_or(0, |asked| asked.key) + 1;
            let wanted = Distribution { nodes, folder, node: source, key };
            self.worker.find_distribution(wanted.clone());
            self.distribution = Some(wanted);
        }
    }

    /// Asks what lies at places of the picture.
    pub(crate) fn probe(&mut self, places: Vec<[f64; 2]>, centres: bool) {
        let sources = {
            let scene = self.scene();
            let look = transfer::of(&scene).map(|look| look.name.clone());
            look.and_then(|look| {
                Some([transfer::volume_of(&scene, &look)?, look, self.camera()?.name.clone()])
            })
        };
        let Some(sources) = sources else { return };
        self.last_probe += 1;
        let key = self.last_probe;
        self.probing = Some((key, centres));
        let nodes = self.document.pipeline().nodes.clone();
        self.worker.probe(Probing { nodes, folder: self.document.folder(), sources, places, key });
    }

    /// Takes over what a probe found: values in a line, or the centre.
    pub(crate) fn take_probed(&mut self) {
        let Some((key, centres)) = self.probing else { return };
        let found = self.worker.shown(|shown| shown.probed.as_ref().filter(|(of, _)| *of == key).cloned());
        match found {
            Some((_, Err(error))) => self.complain(&error),
            Some((_, Ok(found))) if centres => {
                if let (Some(point), Some(view)) = (found.point, self.camera().and_then(View::of)) {
                    self.look(view.centred(point));
                }
            }
            Some((_, Ok(found))) => {
                let text = match found.moments() {
                    Some([[s, g], [ds, dg]]) => format!(
                        "on the ray: s {} ± {}, g {} ± {}, opacity {}; \"+ at probe\" makes a widget of it",
                        short(s),
                        short(ds),
                        short(g),
                        short(dg),
                        short(found.opacity)
                    ),
                    None => "the ray meets no cell".into(),
                };
                self.message = Some((text, false));
                self.probed = Some(found);
            }
            None => return,
        }
        self.probing = None;
    }

    /// The camera node that the shown picture is seen from.
    pub(crate) fn camera(&self) -> Option<&NodeEntry> {
        let nodes = &self.document.pipeline().nodes;
        let feeding = upstream(nodes, self.shown_node.as_deref()?);
        nodes.iter().find(|node| node.node_type.text() == Some("camera") && feeding.contains(&node.name))
    }
}

/// Takes widgets out of a transfer function.
fn leave_out(nodes: &mut [NodeEntry], look: &str, hidden: &BTreeSet<usize>) {
    let node = nodes.iter_mut().find(|node| node.name == look);
    let field = node.and_then(|node| node.settings.iter_mut().find(|field| field.name == "widgets"));
    if let Some(Datum::List(list)) = field.map(|field| &mut field.setting.datum) {
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
