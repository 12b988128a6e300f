//! The graph: nodes joined by typed ports, the two passes of a run, and the registry of node types and gradient filters.
//!
//! A node type is a [`Node`]: a constant that declares ports and parameters, and the functions that work for it.
//! Nodes keep no state. A run has two passes, as in VTK:
//!
//! 1. **Demand**, from the sinks upward: each node says what it needs of its inputs for what is asked of it
//!    ([`Demand`]). What nobody asks for is not read, computed or sorted, and is listed in the report.
//! 2. **Data**, from the sources downward: a node runs when its parameters, its inputs (a [`Revision`] per output)
//!    or the demand on it changed, and its former outputs are used again otherwise.
//!
//! A session of [`Session::no_leave_out`] asks for everything instead, and gives no node leave to leave something out
//! ([`MayLeaveOut`]), to show what that saves.
//!
//! What lives longer than a run (former outputs, things made from a revision) is held by the [`Session`].
//! Absent on purpose: files (a [`Session`] is given a function that stamps them), threads (a stage uses all cores
//! itself, so nodes run one after the other), and node state.

mod builder;
mod cache;
mod call;
mod declaration;
mod demand;
mod faults;
mod given;
mod leave_out;
mod method;
mod notes;
mod origins;
pub mod pipeline;
mod registry;
mod session;
mod stated;
mod steps;
#[cfg(test)]
mod unit_tests;
mod value;
mod wire;

pub use builder::{Edge, Graph, GraphNode, LinkEntry, NodeEntry};
pub use cache::{FileStamp, Stamp};
pub use call::{DemandContext, Outputs, PlanContext, Preparation, RunContext};
pub use declaration::{NamedStub, Node, PlanningStub, Port, PortType, Steps};
pub use demand::{Arrays, Demand, Plan};
pub use faults::{Diagnostic, DiagnosticTarget};
pub use given::NodeOverride;
pub use leave_out::MayLeaveOut;
pub use notes::{DataFinding, NodeDiagnostics, NodeReport, RunReport, SavedWork, SkippedWork};
pub use origins::{FileRead, Origins};
pub use registry::{Registry, VariantAlias};
pub use session::{NoObserver, Observer, Session};
pub use stated::{ResolvedPipeline, relative_path};
pub use value::{CellValues, Revision, StagePayload, TransferFunctionSpec, Value, diagonal};
pub use voltet_core::parameters::{
    ArrayRef, AxisRef, DefaultValue, Field, LocatedValue, NamedPath, Parameter, ParameterType,
    ParameterValue, Parameters, Range, Relative, RelativeNumber, RelativeNumberType, SourceSpan,
    StatisticKind, Variant, VariantSchema, nearest, suggest,
};
