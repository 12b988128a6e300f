//! The gradient filters by name: the built-in ones, and those that plug-ins add.

use super::{CellAverage, FromArray, GradientFilter, LeastSquares, QuadraticFit, VolumeWeighted};
use crate::{Error, Result};
use std::sync::Arc;

/// Gradient filters by name.
#[derive(Clone, Default)]
pub struct Registry {
    filters: Vec<Arc<dyn GradientFilter>>,
}

impl Registry {
    /// The built-in filters.
    pub fn built_in() -> Self {
        Registry {
            filters: vec![
                Arc::new(LeastSquares),
                Arc::new(QuadraticFit),
                Arc::new(VolumeWeighted),
                Arc::new(CellAverage),
                Arc::new(FromArray),
            ],
        }
    }

    /// Adds a filter; its name must be new.
    pub fn register(&mut self, filter: Arc<dyn GradientFilter>) -> Result<()> {
        let name = filter.declaration().name;
        if self.names().contains(&name) {
            return Err(Error::usage("a gradient method of this name is registered already")
                .found(format!("'{name}'"))
                .accepted("a name of its own"));
        }
        self.filters.push(filter);
        Ok(())
    }

    /// The filter of this name.
    pub fn get(&self, name: &str) -> Result<&Arc<dyn GradientFilter>> {
        self.filters.iter().find(|f| f.declaration().name == name).ok_or_else(|| {
            Error::usage("unknown gradient method")
                .found(format!("'{name}'"))
                .accepted(format!("one of: {}", self.names().join(", ")))
        })
    }

    /// Names of all filters, built-in ones first.
    pub fn names(&self) -> Vec<String> {
        self.filters.iter().map(|f| f.declaration().name).collect()
    }

    /// All filters.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<dyn GradientFilter>> {
        self.filters.iter()
    }
}
