//! Queries beside the pictures: their kinds, what they are answered with, and the newest query and answer of each.

use super::crowding::Crowding;
use super::request::{ARRAYS, VolumeSource, WIRES, feeding};
use std::collections::BTreeSet;
use voltet_core::Result;
use voltet_core::error::ErrorKind;
use voltet_document::links;
use voltet_graph::{
    Demand, Field, Graph, NodeEntry, Observer, ParameterValue, Registry, RunContext, Session,
};

/// A question that is answered while no picture is wanted.
pub(crate) trait Query: Clone + PartialEq + 'static {
    type Reply;

    /// True if it is asked again after the picture that it was given up for.
    const WAITS: bool;
    /// The stage of the answer itself, if it reports any: those of nodes are shown before it alone.
    const STAGE: Option<&'static str> = None;

    /// The answer, found on the worker's thread. Errors: a newer picture is wanted; those of a run.
    fn answer(&self, run: &mut QueryRun) -> Result<Self::Reply>;
}

pub(crate) struct QueryRun<'a> {
    pub session: &'a mut Session,
    pub registry: &'a Registry,
    /// Reports that a newer picture is wanted.
    pub observer: &'a dyn Observer,
    pub crowding: &'a mut Crowding,
}

/// The newest query of a kind, and the newest answer.
pub(crate) struct Exchange<Q: Query> {
    asked: Option<Q>,
    number: u64,
    is_open: bool,
    answer: Option<(u64, Result<Q::Reply>)>,
    /// The number of the query that is being answered, its stage, and how much of that is done (0 … 1).
    progress: Option<(u64, String, f64)>,
}

impl<Q: Query> Default for Exchange<Q> {
    fn default() -> Self {
        Exchange { asked: None, number: 0, is_open: false, answer: None, progress: None }
    }
}

impl<Q: Query> Exchange<Q> {
    pub fn asked(&self) -> Option<&Q> {
        self.asked.as_ref()
    }

    pub fn answer(&self) -> Option<&Result<Q::Reply>> {
        self.answer.as_ref().filter(|(number, _)| *number == self.number).map(|(_, found)| found)
    }

    /// The newest answer, whatever was asked since.
    pub fn last(&self) -> Option<&Result<Q::Reply>> {
        self.answer.as_ref().map(|(_, found)| found)
    }

    pub fn is_waiting(&self) -> bool {
        self.asked.is_some() && self.answer().is_none()
    }

    /// Stage of the newest query, and how much of that is done (0 … 1), while it is being answered.
    pub fn progress(&self) -> Option<(&str, f64)> {
        let (_, stage, fraction) = self.progress.as_ref().filter(|(number, ..)| *number == self.number)?;
        Some((stage, *fraction))
    }

    pub(super) fn advance(&mut self, number: u64, stage: &str, fraction: f64) {
        let is_begun = self
            .progress
            .as_ref()
            .is_some_and(|(of, own, _)| *of == number && Q::STAGE == Some(own.as_str()));
        if !is_begun || Q::STAGE == Some(stage) {
            self.progress = Some((number, stage.to_string(), fraction));
        }
    }

    pub(super) fn ask(&mut self, query: Q) {
        if self.asked.as_ref() != Some(&query) {
            self.asked = Some(query);
            self.number += 1;
            self.is_open = true;
        }
    }

    /// Numbers of the newest query, and of the one that the newest answer is to.
    pub fn numbers(&self) -> [u64; 2] {
        [self.number, self.answer.as_ref().map_or(0, |(number, _)| *number)]
    }

    /// As if nothing had been asked; the answer stays as that of an earlier query.
    pub(super) fn forget_query(&mut self) {
        (self.asked, self.is_open) = (None, false);
        self.number += 1;
    }

    /// Forgets the query and its answer, which belong to nothing that is shown.
    pub(super) fn forget(&mut self) {
        self.forget_query();
        self.answer = None;
    }

    /// Takes over what was found for the query of a number.
    pub(super) fn settle(&mut self, number: u64, found: Result<Q::Reply>) {
        self.progress = None;
        match found {
            Err(error) if error.kind == ErrorKind::Cancelled => match Q::WAITS {
                true => self.is_open = self.asked.is_some(),
                false if number == self.number => self.forget_query(),
                false => {}
            },
            // What is not asked again is of use for the newest query alone.
            found if Q::WAITS || number == self.number => self.answer = Some((number, found)),
            _ => {}
        }
    }

    /// Takes over a query whose answer is known.
    pub(super) fn adopt(&mut self, query: Q, found: Result<Q::Reply>) {
        self.ask(query);
        (self.is_open, self.answer) = (false, Some((self.number, found)));
    }

    /// The query to be answered next, with its number, if it is open.
    pub(super) fn take(&mut self) -> Option<(u64, Q)> {
        let query = self.asked.clone().filter(|_| std::mem::take(&mut self.is_open))?;
        Some((self.number, query))
    }
}

impl VolumeSource {
    /// Feeds the volume, with these arrays and with *g* where there is a gradient, and other outputs, each a port's name and
    /// `"node.port"`, to a function.
    pub(super) fn feed<T>(
        &self,
        run: &mut QueryRun,
        arrays: &BTreeSet<String>,
        others: &[(&str, &str)],
        work: impl FnOnce(&RunContext) -> Result<T>,
    ) -> Result<T> {
        let fed = [("volume", &*self.output)].into_iter().chain(others.iter().copied());
        let mut nodes: Vec<NodeEntry> = Vec::new();
        for (_, source) in fed.clone() {
            for node in feeding(&self.nodes, links::source(source, &self.nodes).0)? {
                if !nodes.iter().any(|known| known.name == node.name) {
                    nodes.push(node);
                }
            }
        }
        let arrays: ParameterValue = arrays.iter().map(String::as_str).collect();
        let fed = fed.map(|(port, source)| (port, source.to_string()));
        nodes.push(NodeEntry::of_program(&WIRES, vec![Field::new(ARRAYS, arrays)], fed));
        let graph = Graph::build(&nodes, run.registry, self.folder.clone())?;
        let of_volumes = Demand { gradient_magnitude: true, ..Demand::default() };
        let place = graph.nodes.len() - 1;
        Ok(run.session.stand_in(&graph, place, &of_volumes, run.observer, work)?.0)
    }
}
