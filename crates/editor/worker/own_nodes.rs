//! The nodes that the worker adds to those that files may name.

use super::{look_on, series};
use voltet_core::Result;
use voltet_graph::Registry;

/// The same registry with the worker's own nodes.
pub(super) fn with_own(registry: &Registry) -> Result<Registry> {
    let mut own = registry.clone();
    own.add(&look_on::NODE)?;
    own.add(&look_on::ASKS_FOR_ARRAYS)?;
    own.add(&look_on::PROBES)?;
    own.add(&series::NODE)?;
    Ok(own)
}
