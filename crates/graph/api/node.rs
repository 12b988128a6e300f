//! Declaration of a node type: ports, parameters, an example. Command-line help, the checker, editor panels and
//! the reference of nodes are made from this alone.

use super::context::{DemandContext, Outputs, PlanContext, Preparation, RunContext};
use super::parts::GridPart;
use super::value::{Port, Value};
use std::path::{Path, PathBuf};
use voltet_core::Result;
use voltet_core::field::Plugin;
use voltet_core::parameters::{Parameter, ParameterType, Parameters};
use voltet_core::reading::GridReader;

/// Name of an input port with the stand-in for its value before any data are read; `None` where there is none.
pub type NamedStub<'a> = (&'a str, Option<Value>);

/// See [`Node::outline`].
pub type PlanningStub = dyn Fn(&Parameters, &[NamedStub]) -> Result<Outputs> + Send + Sync;

/// Selection of steps of a time series.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Steps {
    /// The one that parameters name.
    Read,
    /// All.
    All,
}

/// Work of a node where a grid does not fit into memory and is read part after part.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PartWork {
    /// None: it works on whole grids.
    None,
    /// Runs once for each part ([`RunContext::part`]); what it gives for the cells of a part is what it gives for them in the whole grid.
    Each,
    /// Runs once, over all parts ([`RunContext::each_part`]).
    All,
}

/// Time series that a node reads.
#[derive(Debug, Clone)]
pub struct TimeSeries {
    /// Parameters with which the node reads each step.
    pub steps: Vec<Parameters>,
    /// Number of the step that it reads.
    pub own: usize,
    /// Time of each step; none where the node reads no series.
    pub times: Vec<f64>,
}

impl TimeSeries {
    /// Series of one step: the node reads none.
    pub fn of_one(parameters: &Parameters) -> TimeSeries {
        TimeSeries { steps: vec![parameters.clone()], own: 0, times: Vec::new() }
    }
}

/// A node type: its declaration and the functions that work for it. A constant for the nodes that ship; a plug-in
/// leaks its own (`Box::leak`), since node types live as long as the program.
pub struct Node {
    /// The name that a pipeline file gives as `type`.
    pub name: &'static str,
    /// Its purpose, one sentence.
    pub summary: &'static str,
    /// Required inputs, each fed by one output.
    pub inputs: &'static [Port],
    /// Optional inputs: each may be unwired, or fed by one output or by a list of them.
    pub optional_inputs: &'static [Port],
    /// Outputs; a node without outputs is a sink, and the run is made for the sinks (see [`Node::finds`], too).
    pub outputs: &'static [Port],
    /// Its parameters, in the order in which help lists them.
    pub parameters: &'static [Parameter],
    /// A pipeline file that uses it; must pass the checker.
    pub example: &'static str,
    /// The plug-in that it was loaded from; `None` for one that the program was built with.
    pub plugin: Option<&'static Plugin>,
    /// The format that it reads, if it is the node of a format that comes from outside.
    pub reader: Option<&'static dyn GridReader>,
    /// First bytes of a file of no format that the node reads itself: of the nodes of formats that come from outside, the one that
    /// such a file is of does the work. `None` for other files, and for those that cannot be read.
    pub foreign_head: &'static (dyn Fn(&Path) -> Option<Vec<u8>> + Send + Sync),
    /// True for cheap nodes without data (a camera, a transfer function): they run before the demand pass, which
    /// can then look at their values.
    pub early: bool,
    /// True for nodes that find something out about the data, which is worth a run though nobody uses their outputs.
    pub finds: bool,
    /// Stand-ins for its outputs, for the demand pass, before any data is known: values that
    /// stand for the outputs, given what stands for each wire of the inputs. Nothing at all where it cannot be
    /// said. Must ask for no less than the true outputs will.
    pub outline: &'static PlanningStub,
    /// Checks what single declarations cannot say (parameters that exclude each other). Touches no file.
    pub check: &'static (dyn Fn(&Parameters) -> Result<()> + Send + Sync),
    /// Says what is needed of the inputs for what is asked of the node.
    pub demand: &'static (dyn Fn(&mut DemandContext) -> Result<()> + Send + Sync),
    /// Notes what the headers of its files tell that it will leave out; reads no data. An error where they do not tell.
    pub foresee: &'static (dyn Fn(&mut PlanContext) -> Result<()> + Send + Sync),
    /// The time series that its files are, as far as headers tell.
    pub steps: &'static (dyn Fn(&Preparation) -> Result<TimeSeries> + Send + Sync),
    /// The files that it reads beside those that its parameters name, from headers alone: where one of them changes it runs again,
    /// and pictures say what they were. Of a series the files of the step that is read, or of all. What cannot be read names none.
    pub files_beside: &'static (dyn Fn(&Preparation, Steps) -> Vec<PathBuf> + Send + Sync),
    /// Work of the node where its grid is read part after part.
    pub part_work: PartWork,
    /// True if it drops cells of its grid, and with them what surrounds a part.
    pub drops_cells: bool,
    /// Prepares the reading of the parts of this process, once, before the first of them is read. All processes call it together, also one
    /// without parts.
    pub begin_parts: &'static (dyn Fn(&mut RunContext, &[GridPart]) -> Result<()> + Send + Sync),
    /// Memory that each piece of the file that it reads takes when it is drawn, bytes, from headers alone; none where it reads no file in pieces.
    pub piece_bytes: &'static (dyn Fn(&Preparation) -> Result<Vec<u64>> + Send + Sync),
    /// Numbers of the steps of the time series at its inputs, of so many, that it looks at beside the one that is read: its outputs
    /// depend on their files.
    pub other_steps: &'static (dyn Fn(&Parameters, usize) -> Vec<usize> + Send + Sync),
    /// Finds out before any long work whether the run can succeed (files exist, folders can be written).
    pub prepare: &'static (dyn Fn(&Preparation) -> Result<()> + Send + Sync),
    /// Does the work: one value for each output, in their order.
    pub run: &'static (dyn Fn(&mut RunContext) -> Result<Outputs> + Send + Sync),
}

impl Node {
    /// A node with nothing declared, for `..Node::BLANK`: nothing to check or prepare, every demand passed on to
    /// every input.
    pub const BLANK: Node = Node {
        name: "",
        summary: "",
        inputs: &[],
        optional_inputs: &[],
        outputs: &[],
        parameters: &[],
        example: "",
        plugin: None,
        reader: None,
        foreign_head: &|_| None,
        early: false,
        finds: false,
        outline: &|_, _| Ok(Vec::new()),
        check: &|_| Ok(()),
        demand: &|asking| asking.pass_on(),
        foresee: &|_| Ok(()),
        steps: &|preparation| Ok(TimeSeries::of_one(preparation.parameters)),
        files_beside: &|_, _| Vec::new(),
        part_work: PartWork::None,
        drops_cells: false,
        begin_parts: &|_, _| Ok(()),
        piece_bytes: &|_| Ok(Vec::new()),
        other_steps: &|_, _| Vec::new(),
        prepare: &|_| Ok(()),
        run: &|_| Ok(Vec::new()),
    };

    /// The inputs that must be fed, then the optional ones.
    pub fn all_inputs(&self) -> impl Iterator<Item = &'static Port> + Clone {
        self.inputs.iter().chain(self.optional_inputs)
    }

    /// True if runs are made for it.
    pub fn is_sink(&self) -> bool {
        self.finds || self.outputs.is_empty()
    }

    /// The parameter of that name.
    pub fn parameter(&self, name: &str) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| p.name == name)
    }

    /// The parameter whose words are registered variants, if there is one.
    pub fn registered_parameter(&self) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| matches!(p.parameter_type, ParameterType::Registered(_)))
    }

    /// The parameter that names a gradient filter, where it has one.
    pub fn method(&self) -> Option<&'static Parameter> {
        self.parameters.iter().find(|p| matches!(p.parameter_type, ParameterType::GradientFilter))
    }
}

impl std::fmt::Debug for Node {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Node").field("name", &self.name).finish_non_exhaustive()
    }
}
