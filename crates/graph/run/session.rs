//! Sessions run graphs: the demand pass from the sinks up, then the nodes from the sources down, with a cache between runs.

use super::cache::{Entry, files_of};
use super::node_run::{NodeRun, files_of_other_steps, origins, upstream};
use super::parts::{Division, PartRuns, gather_notes, in_parts};
use super::plan::{Done, Plan, RunReport, asks_of, everything_of, inputs_of};
use super::shared::{Claim, NodeCall, Share};
use crate::api::context::{Preparation, RunContext};
use crate::api::demand::Demand;
use crate::api::node::{NamedStub, Steps};
use crate::api::observer::{NoObserver, Observer};
use crate::api::origins::{FileStamp, Origins};
use crate::api::ranks::{OneRank, Ranks};
use crate::api::value::{Edge, Revision, Value};
use crate::build::graph::Graph;
use std::sync::Arc;
use std::time::Instant;
use voltet_core::diagnostics::{Diagnostics, SavedWork};
use voltet_core::picture::Picture;
use voltet_core::{Error, Result};

/// Session: former outputs and values made from them, kept between runs.
pub struct Session {
    outputs: Share,
    file_stamp: FileStamp,
    exhaustive: bool,
    /// True if a user will move the widgets from run to run.
    widgets_move: bool,
    /// True while outputs may be of a preview.
    allows_preview: bool,
    /// True while nodes run for a run to come.
    reads_ahead: bool,
    /// Memory that a grid may take, bytes; `None`: grids are read whole.
    memory: Option<u64>,
    ranks: Arc<dyn Ranks>,
}

impl Session {
    /// A session without former runs. `file_stamp` finds the state of the files that parameters name.
    pub fn new(file_stamp: FileStamp) -> Self {
        let (exhaustive, widgets_move, allows_preview, reads_ahead) = (false, false, false, false);
        let (outputs, memory, ranks) = (Share::new(Arc::default()), None, Arc::new(OneRank));
        Session { outputs, file_stamp, exhaustive, widgets_move, allows_preview, reads_ahead, memory, ranks }
    }

    /// A session for another thread that shares the former outputs of this one: what both need is made once.
    pub fn beside(&self) -> Self {
        Session { outputs: self.outputs.another(), ranks: self.ranks.clone(), ..*self }
    }

    /// Tells the graphs that will be run, by this session or those that share its outputs: grids and volumes that they can use are
    /// held from one to the other while there is memory for them.
    pub fn expect<'g>(&self, graphs: impl Iterator<Item = &'g Graph>) {
        self.outputs.expect(graphs);
    }

    /// Makes it one of several processes that run each graph together: a grid in pieces is shared out among them, and the first alone
    /// runs the nodes without outputs, such as writers. The picture of such a grid is on the first; on the others it is transparent.
    pub fn with_ranks(self, ranks: Arc<dyn Ranks>) -> Self {
        Session { ranks, ..self }
    }

    /// Lets a grid take so many bytes of memory: one that takes more, whose file is in pieces, is read and drawn part after part
    /// ([`Session::run`]). The pictures are the same but for rounding.
    pub fn with_memory(self, bytes: u64) -> Self {
        Session { memory: Some(bytes), ..self }
    }

    /// Makes it the session of an editor, where a user will move the widgets: values that depend on data alone are computed at all points at once, so
    /// that no movement waits for the places that no widget looked at before. The pictures are the same.
    pub fn widgets_move(self) -> Self {
        Session { widgets_move: true, ..self }
    }

    /// Makes the session exhaustive, for comparison: it does all work, needed or not. Everything that a node can give is requested
    /// of it, nodes skip nothing ([`crate::RunContext::exhaustive`]), and no former output is used. The pictures are the same.
    pub fn exhaustive(self) -> Self {
        Session { exhaustive: true, ..self }
    }

    /// Drops all former outputs and values made from them; values of the session, such as open devices, stay.
    pub fn forget(&mut self) {
        self.outputs.forget();
    }

    /// Drops the former runs that gave this picture, so that its owner may modify it.
    pub fn release(&mut self, picture: &Arc<Picture>) {
        let is_it = |value: &Value| value.picture().is_some_and(|known| Arc::ptr_eq(known, picture));
        self.outputs.drop_runs(|entry| entry.done.outputs.iter().any(|(value, _)| is_it(value)));
    }

    /// Number of former outputs that are held, and of values made from them.
    pub fn held_counts(&self) -> [usize; 2] {
        self.outputs.held_counts()
    }

    /// Origins of what a node (its place in [`Graph::nodes`]) is made from, as far as they are known without a run: files and
    /// plug-ins.
    pub fn origins_before_run(&self, graph: &Graph, place: usize) -> Origins {
        let nothing = vec![None; graph.nodes.len()];
        origins(graph, &upstream(graph, place), &nothing, (&self.outputs.store, None), self.file_stamp)
    }

    /// Runs the demand pass, and the early nodes only.
    pub fn plan(&mut self, graph: &Graph) -> Result<Plan> {
        self.plan_with(graph, &Demand::default())
    }

    /// `of_volumes`: what is asked, beside what nodes ask for, of those that make a volume of a grid.
    fn plan_with(&mut self, graph: &Graph, of_volumes: &Demand) -> Result<Plan> {
        let count = graph.nodes.len();
        let mut plan = Plan {
            demands: vec![Demand::default(); count],
            notes: vec![Diagnostics::new(self.exhaustive); count],
            early: vec![None; count],
            exhaustive: self.exhaustive,
        };
        for &i in &graph.order {
            let node = &graph.nodes[i];
            if node.node.early && node.inputs.iter().all(|edge| plan.early[edge.node].is_some()) {
                let inputs = inputs_of(node, &plan.early);
                let done =
                    self.execute(graph, i, inputs, &Demand::default(), (&plan.early, None), &NoObserver)?;
                plan.early[i] = Some(done);
            }
        }
        let outlines = outlines(graph, &plan.early)?;
        let mut demands: Vec<Option<Demand>> = vec![None; count];
        for &i in graph.order.iter().rev() {
            let node = &graph.nodes[i];
            plan.demands[i] = demands[i].take().unwrap_or_default();
            if node.makes_volume() {
                plan.demands[i].join(of_volumes);
            }
            if self.exhaustive {
                plan.demands[i].join(&everything_of(node));
            }
            let early = |edge: &Edge| {
                let value = outlines[edge.node].get(edge.output).cloned();
                (value, plan.early[edge.node].is_some())
            };
            let asks = asks_of(graph, node, &plan.demands[i], &mut plan.notes[i], early)?;
            for (edge, ask) in node.inputs.iter().zip(asks) {
                let says_where = node.draws() && !self.widgets_move;
                let ask = if says_where { ask } else { ask.everywhere() };
                ask.add_to(&mut demands[edge.node]);
            }
        }
        Ok(plan)
    }

    /// Like [`Session::run`], for one of many runs that follow each other while a user moves something: nodes may keep what
    /// serves the next, and what they give may differ by rounding from what a run by itself gives. No later run takes it.
    pub fn run_preview(&mut self, graph: &Graph, observer: &dyn Observer) -> Result<RunReport> {
        self.allows_preview = !self.exhaustive;
        let report = self.run(graph, observer);
        self.allows_preview = false;
        report
    }

    /// Both passes. Every node finds out first whether it can succeed.
    pub fn run(&mut self, graph: &Graph, observer: &dyn Observer) -> Result<RunReport> {
        let start = Instant::now();
        self.outputs.begin(graph, observer);
        let plan = self.plan(graph)?;
        for &i in &graph.order {
            let node = &graph.nodes[i];
            let preparation = Preparation { parameters: &node.parameters, folder: &graph.folder };
            (node.node.prepare)(&preparation).map_err(|error| node.locate(error))?;
        }
        let division = Division::new(graph, self.memory, &*self.ranks)?;
        if division.is_none() {
            self.ranks.wait_for_start()?;
        }
        let part_runs = division.as_ref().map(|division| PartRuns::new(&plan.demands, division));
        let (all_done, mut report) =
            self.work_through(graph, &plan, &graph.order, part_runs.as_ref(), observer)?;
        let known = (&self.outputs.store, part_runs.as_ref().and_then(PartRuns::diagonal));
        report.origins = origins(graph, &graph.order, &all_done, known, self.file_stamp);
        report.seconds = start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// Runs the nodes without inputs, which read files, of a graph that another session of the same outputs will run next. That run
    /// uses what they give as its own.
    ///
    /// # Errors
    /// - those of the nodes; the run to come meets them, too.
    pub fn read_ahead(&mut self, graph: &Graph, observer: &dyn Observer) -> Result<()> {
        // Parts are read when they are drawn, and processes read together.
        if self.memory.is_some() || self.ranks.count() > 1 {
            return Ok(());
        }
        self.outputs.begin_ahead(graph);
        self.reads_ahead = true;
        let sources = |&&i: &&usize| graph.nodes[i].inputs.is_empty() && !graph.nodes[i].node.early;
        let sources: Vec<usize> = graph.order.iter().filter(sources).copied().collect();
        let plan = self.plan(graph);
        let read = plan.and_then(|plan| self.work_through(graph, &plan, &sources, None, observer).map(drop));
        self.reads_ahead = false;
        read
    }

    /// Runs what feeds a node (its place in [`Graph::nodes`]) and gives the values at its inputs, in the order of
    /// its edges, with the report of the run: for programs that do with them what no node does. The node itself and what follows
    /// do not run. `of_volumes`: what is asked, beside what nodes ask for, of those that make a volume of a grid.
    pub fn feed(
        &mut self,
        graph: &Graph,
        place: usize,
        of_volumes: &Demand,
        observer: &dyn Observer,
    ) -> Result<(Vec<Value>, RunReport)> {
        self.stand_in(graph, place, of_volumes, observer, |call| {
            Ok(call.inputs.iter().map(|(value, _)| value.clone()).collect())
        })
    }

    /// Like [`Session::feed`], with a function in place of the node's own.
    pub fn stand_in<T>(
        &mut self,
        graph: &Graph,
        place: usize,
        of_volumes: &Demand,
        observer: &dyn Observer,
        work: impl FnOnce(&RunContext) -> Result<T>,
    ) -> Result<(T, RunReport)> {
        let plan = self.plan_with(graph, of_volumes)?;
        let feeding: Vec<usize> = upstream(graph, place).into_iter().filter(|&i| i != place).collect();
        let (all_done, report) = self.work_through(graph, &plan, &feeding, None, observer)?;
        let (node, nothing) = (&graph.nodes[place], Demand::default());
        let (store, file_stamp) = (&self.outputs.store, self.file_stamp);
        let (part_runs, part, ranks) = (None, None, &*self.ranks);
        let run =
            NodeRun { graph, place, done: &all_done, store, file_stamp, observer, part_runs, part, ranks };
        let call =
            run.context(&node.parameters, &nothing, inputs_of(node, &all_done), (self.exhaustive, false));
        Ok((work(&call)?, report))
    }

    /// Runs these nodes, each after those upstream; returns their outputs and the report.
    fn work_through(
        &mut self,
        graph: &Graph,
        plan: &Plan,
        order: &[usize],
        part_runs: Option<&PartRuns>,
        observer: &dyn Observer,
    ) -> Result<(Vec<Option<Done>>, RunReport)> {
        let is_mapped = |i: usize| part_runs.is_some_and(|runs| runs.division.is_mapped[i]);
        let warnings = graph.warnings.iter().map(Error::to_string).collect();
        let mut report = RunReport { warnings, ..RunReport::default() };
        let mut all_done: Vec<Option<Done>> = vec![None; graph.nodes.len()];
        for (place, &i) in order.iter().enumerate() {
            if observer.cancelled() {
                return Err(Error::cancelled());
            }
            let node = &graph.nodes[i];
            if is_mapped(i) {
                let outputs = node.node.outputs.iter().map(|port| port.port_type);
                all_done[i] = Some(in_parts(outputs, || self.outputs.next_revision()));
                continue;
            }
            if node.node.outputs.is_empty() {
                if self.ranks.rank() > 0 {
                    continue;
                }
                // Before anything is written.
                self.ranks.wait_for_start()?;
            }
            observer.started(&node.name, place, order.len());
            let mut done = match &plan.early[i] {
                Some(done) => done.clone(),
                None => {
                    let inputs = inputs_of(node, &all_done);
                    let so_far = (all_done.as_slice(), part_runs);
                    self.execute(graph, i, inputs, &plan.demands[i], so_far, observer)?
                }
            };
            done.notes.add(plan.notes[i].clone());
            if let Some(seconds) = done.reused {
                let why = "a former output serves: parameters, inputs and files are the same";
                done.notes.record_skipped("repetition", why, Some(SavedWork::Seconds(seconds)));
            }
            observer.finished(&node.name, done.seconds);
            all_done[i] = Some(done);
        }
        let mut of_parts = part_runs.map(PartRuns::take_notes).unwrap_or_default();
        // At the end, since processes wait for each other here.
        if part_runs.is_some() {
            for (i, done) in all_done.iter_mut().enumerate() {
                let is_of_parts = graph.nodes[i].inputs.iter().any(|edge| is_mapped(edge.node));
                if let Some(done) = done.as_mut().filter(|_| is_of_parts && !is_mapped(i)) {
                    of_parts.insert(i, std::mem::take(&mut done.notes));
                }
            }
            gather_notes(&mut of_parts, &*self.ranks)?;
        }
        for &i in order.iter().filter(|&&i| !is_mapped(i)) {
            if let Some(done) = &mut all_done[i] {
                if let Some(of_all) = of_parts.remove(&i) {
                    done.notes = of_all;
                }
                report.add(&graph.nodes[i].name, graph.nodes[i].node.name, done);
            }
        }
        for (i, mut notes) in of_parts {
            let node = &graph.nodes[i];
            notes.add(plan.notes[i].clone());
            report.add(&node.name, node.node.name, &Done { notes, ..Done::default() });
        }
        Ok((all_done, report))
    }

    /// Runs a node, or finds its former outputs. `done`: what ran so far, and the runs for parts of a grid.
    fn execute(
        &mut self,
        graph: &Graph,
        i: usize,
        inputs: Vec<(Value, Revision)>,
        demand: &Demand,
        (done, part_runs): (&[Option<Done>], Option<&PartRuns>),
        observer: &dyn Observer,
    ) -> Result<Done> {
        let start = Instant::now();
        let node = &graph.nodes[i];
        let revisions: Vec<(usize, Revision)> =
            node.inputs.iter().zip(&inputs).map(|(edge, input)| (edge.port, input.1)).collect();
        let mut files = files_of(graph, node, Steps::Read, self.file_stamp);
        let other_steps = files_of_other_steps(graph, i, &self.outputs.store, self.file_stamp);
        files.extend(other_steps.into_iter().map(|(_, file)| file));
        let work = NodeCall::new(node, &revisions, &files);
        let (claim, was_elsewhere) =
            match self.outputs.claim(node, work, demand, &graph.stated, self.exhaustive) {
                Claim::Former(done) => return Ok(*done),
                Claim::Own { claim, was_elsewhere } => (claim, was_elsewhere),
            };
        // A gradient that is asked for in other places than before will be so again: it is asked for everywhere.
        let demand = &if was_elsewhere { demand.everywhere() } else { demand.clone() };
        let (store, file_stamp) = (&self.outputs.store, self.file_stamp);
        let (part, ranks) = (None, &*self.ranks);
        let run = NodeRun { graph, place: i, done, store, file_stamp, observer, part_runs, part, ranks };
        let mut call = run.context(&node.parameters, demand, inputs, (self.exhaustive, self.allows_preview));
        let values = node.run(&mut call)?;
        let notes = std::mem::take(&mut call.notes);
        let is_of_preview = |edge: &Edge| done[edge.node].as_ref().is_some_and(|done| done.is_preview);
        let is_preview = call.is_preview.get() || node.inputs.iter().any(is_of_preview);
        let carried = call.reads_pipeline.get().then(|| graph.stated.clone());
        let declared = node.node.outputs.iter().map(|port| port.port_type);
        if !values.iter().map(Value::port_type).eq(declared) {
            return Err(node.locate(Error::run("the node gave other outputs than it declares")));
        }
        let outputs: Vec<(Value, Revision)> =
            values.into_iter().map(|value| (value, self.outputs.next_revision())).collect();
        let seconds = start.elapsed().as_secs_f64();
        let done = Done { outputs, files: files.clone(), notes, seconds, reused: None, is_preview };
        if !is_preview {
            for named in node.parameters.paths().into_iter().filter(|named| named.written) {
                let path = named.from(&graph.folder);
                let written = files.iter_mut().filter(|(file, _)| *file == path);
                written.for_each(|(file, state)| *state = (self.file_stamp)(file));
            }
            self.outputs.add(Entry {
                node: node.node,
                parameters: node.parameters.clone(),
                plugin: node.plugin().cloned(),
                given: node.given.clone(),
                inputs: revisions,
                demand: demand.clone(),
                files,
                is_ahead: self.reads_ahead,
                carried,
                done: done.clone(),
            });
        }
        drop(claim);
        Ok(done)
    }
}

/// Values of each node's outputs, or their stand-ins; empty where they are not known.
fn outlines(graph: &Graph, early: &[Option<Done>]) -> Result<Vec<Vec<Value>>> {
    let mut outlines: Vec<Vec<Value>> = vec![Vec::new(); graph.nodes.len()];
    for &i in &graph.order {
        let node = &graph.nodes[i];
        outlines[i] = match &early[i] {
            Some(done) => done.outputs.iter().map(|output| output.0.clone()).collect(),
            None => {
                let port = |edge: &Edge| node.node.all_inputs().nth(edge.port).map_or("", |port| port.name);
                let known = |edge: &Edge| (port(edge), outlines[edge.node].get(edge.output).cloned());
                let inputs: Vec<NamedStub> = node.inputs.iter().map(known).collect();
                (node.node.outline)(&node.parameters, &inputs).map_err(|error| node.locate(error))?
            }
        };
    }
    Ok(outlines)
}
