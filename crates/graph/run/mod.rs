//! Runs graphs: plan, cache, the services to a running node, and the report.

mod cache;
mod node_run;
mod parts;
pub(crate) mod plan;
pub(crate) mod session;
mod shared;
