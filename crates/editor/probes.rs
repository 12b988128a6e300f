//! Probes of the picture: requests to the worker for what rays meet, and handling of its answers.

use crate::editor::Editor;
use crate::handles::clip_parameters;
use crate::scene::ProbePurpose;
use crate::transfer;
use crate::worker::{PixelProbe, ProbeQuery, VolumeSource, short, short_by};
use glam::DVec3;
use std::sync::Arc;
use voltet_core::{counted, with_commas};
use voltet_document::links::{self, upstream};
use voltet_graph::{NodeEntry, PortType};
use voltet_nodes::drawing;

impl Editor {
    /// Rays through places of the picture, with the clips and surfaces that it is drawn with.
    fn probe_query(&self, places: Vec<[f64; 2]>) -> Option<ProbeQuery> {
        let ((look, output), camera) = (transfer::drawn_with(&self.scene())?, self.camera()?);
        let all = &*self.nodes_of_frame();
        let mut names = upstream(all, self.shown_node.as_deref()?);
        let draws = |node: &&NodeEntry| {
            let declared = self.registry.node_type(node);
            let gives =
                |node: &voltet_graph::Node| node.outputs.iter().any(|port| port.port_type == PortType::Image);
            names.contains(&node.name) && declared.is_some_and(gives)
        };
        let drawing: Vec<&NodeEntry> = all.iter().filter(draws).collect();
        let lists = drawing.iter().filter_map(|node| node.setting(drawing::CLIP.name).cloned());
        // What is not sound is a fault of the document, and no such picture is shown.
        let clips = lists.filter_map(|list| clip_parameters(list).ok()).collect();
        let links = drawing.iter().flat_map(|node| &node.inputs);
        let of_surfaces = links.filter(|link| link.port == drawing::SURFACES.name);
        let surfaces = of_surfaces.flat_map(links::sources).map(str::to_string).collect();
        names.extend(upstream(all, links::source(&output, all).0));
        names.extend(upstream(all, &look.name));
        let mut nodes: Vec<NodeEntry> =
            all.iter().filter(|node| names.contains(&node.name)).cloned().collect();
        self.put_shown_widgets(&mut nodes);
        let source = VolumeSource { nodes, folder: self.document.folder(), output };
        let (look, camera) = (look.name.clone(), camera.name.clone());
        Some(ProbeQuery { source, look, camera, clips, surfaces, places })
    }

    pub(crate) fn probe(&mut self, places: Vec<[f64; 2]>, purpose: ProbePurpose) {
        if let Some(wanted) = self.probe_query(places) {
            // A second click at the same place is another probe.
            self.worker.forget_query(|output| &mut output.probe);
            self.worker.ask(|output| &mut output.probe, wanted);
            // A hand waits for it, and not for a step that is read ahead.
            self.worker.read_no_further();
            self.answers.probing = Some(purpose);
        }
    }

    /// Asks for what is seen first under the pointer; a request for another place takes the place of one that is still open.
    pub(crate) fn find_hovered(&self) {
        match self.panels.picture.hovered.and_then(|place| self.probe_query(vec![place])) {
            Some(wanted) => self.worker.ask_hover(wanted),
            None => self.worker.forget_query(|output| &mut output.hover),
        }
    }

    /// Takes over what a probe found: values in a line, the centre, or an end of a length.
    pub(crate) fn take_probed(&mut self) {
        let Some(purpose) = self.answers.probing else { return };
        let answer = self.worker.shown(|shown| {
            let probe = &shown.probe;
            probe.answer().cloned().zip(probe.asked().map(|query| query.source.clone()))
        });
        let Some((answer, source)) = answer else { return };
        self.answers.probing = None;
        let Some(found) = self.check(answer) else { return };
        match (purpose, found.point) {
            (ProbePurpose::Values, _) => self.show_probed(source, found),
            (ProbePurpose::Centre, Some(point)) => self.move_camera(|view| view.centred(point)),
            (ProbePurpose::Centre, None) => {}
            (ProbePurpose::Length, _) => self.measure_to(found.hit.as_ref().map(|hit| hit.point)),
        }
    }

    /// Takes an end of the length that is measured; after two ends the next one begins another.
    fn measure_to(&mut self, point: Option<DVec3>) {
        let Some(point) = point else {
            return self.say("nothing is seen there: click at what is to be measured");
        };
        if self.answers.measured.len() == 2 {
            self.answers.measured.clear();
        }
        self.answers.measured.push(point);
        self.say(match self.answers.measured[..] {
            [from, to] => {
                let [x, y, z] = (to - from).to_array().map(short);
                let length = short(from.distance(to));
                format!(
                    "distance {length} in the unit of the data's coordinates; along x, y, z: {x}, {y}, {z}"
                )
            }
            _ => "click at the other end of the distance".into(),
        });
    }

    /// Shows what a probe of a volume found.
    pub(crate) fn show_probed(&mut self, source: VolumeSource, found: Arc<PixelProbe>) {
        if !self.is_current(&source) {
            return self.say("what was probed has changed since: probe again");
        }
        let place = match found.rays {
            0 => "in the section".to_string(),
            1 => "on the ray".to_string(),
            rays if found.heaviest.is_empty() => format!("on {rays} rays"),
            rays => format!("on {rays} rays, the most visible of each"),
        };
        let cell = found.hit.as_ref().and_then(|hit| hit.cell.as_ref());
        let cell = cell.map_or(String::new(), |cell| format!("cell {}; ", with_commas(cell.number)));
        let is_of_plane = self.edited().is_some_and(|(_, output)| output == source.output);
        let offer = if is_of_plane { "; \"+ at probe\" makes a widget of them" } else { "" };
        let count = match found.rays {
            1 => counted(found.cells, "cell"),
            _ => counted(found.gathered().len(), "value"),
        };
        let text = match found.moments() {
            Some(([s, g], [[ss, _], [_, gg]])) => format!(
                "{cell}{count} {place}: s {} ± {}, g {} ± {}{offer}",
                short_by(s, 0.1 * ss.sqrt()),
                short(ss.sqrt()),
                short_by(g, 0.1 * gg.sqrt()),
                short(gg.sqrt()),
            ),
            None if cell.is_empty() && found.opacity == 0.0 => format!("no cell is met {place}"),
            None => format!("{cell}surfaces alone are met {place}"),
        };
        self.say(text);
        self.answers.probed = Some((source, found));
    }
}
