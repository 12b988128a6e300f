//! The graph: nodes joined by typed ports, the two passes of a run, and the registry of node types and gradient filters.
//!
//! A node type is a [`Node`]: a constant that declares ports and parameters, and the functions that work for it.
//! Nodes keep no state. A run has two passes, as in VTK:
//!
//! 1. **Demand**, from the sinks upward: each node states its demands on its inputs for the demand on it
//!    ([`Demand`]). Nothing else is read, computed or sorted; skipped work is listed in the report.
//! 2. **Data**, from the sources downward: a node runs when its parameters, its inputs (a [`Revision`] per output)
//!    or the demand on it changed, and its former outputs are used again otherwise.
//!
//! An exhaustive session ([`Session::exhaustive`]) requests everything instead, and nodes skip no work, to measure what
//! skipping saves.
//!
//! The [`Session`] holds all that outlives a run: former outputs, and values made from a revision.
//! Absent on purpose: files (a [`Session`] is given a function that stamps them), threads (a stage uses all cores
//! itself, so nodes run one after the other), and node state.

mod api;
mod build;
pub mod pipeline;
mod run;
#[cfg(test)]
mod unit_tests;

pub use api::context::{DemandContext, Outputs, PlanContext, Preparation, RunContext};
pub use api::demand::{Arrays, Demand};
pub use api::node::{NamedStub, Node, PartWork, PlanningStub, Steps, TimeSeries};
pub use api::observer::{NoObserver, NodeProgress, Observer};
pub use api::origins::{FileRead, FileStamp, Origins, ResolvedPipeline, Stamp, relative_path};
pub use api::parts::{GRADIENT_LAYERS, GridPart, MEAN_LAYERS, PIECES_READ, SweptParts};
pub use api::ranks;
pub use api::value::{
    CellValues, Edge, Port, PortType, Revision, StagePayload, TransferFunctionSpec, Value, diagonal,
};
pub use build::entry::{Diagnostic, DiagnosticTarget, LinkEntry, NodeEntry, unknown_node};
pub use build::graph::{Graph, GraphNode, NodeOverride};
pub use build::registry::{Registry, VariantAlias};
pub use run::plan::{NodeReport, Plan, RunReport};
pub use run::session::Session;
pub use voltet_core::diagnostics::{DataFinding, Diagnostics, SavedWork, SkippedWork};
pub use voltet_core::parameters::{
    ArrayOrigin, ArrayRef, AxisRef, DefaultValue, Field, LocatedValue, NamedPath, Parameter, ParameterType,
    ParameterValue, Parameters, Range, Relative, RelativeNumber, RelativeNumberType, SourceSpan,
    StatisticKind, Variant, VariantSchema, find_setting, nearest, suggest,
};
