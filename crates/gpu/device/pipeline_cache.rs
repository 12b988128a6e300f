//! Cache of the pipelines that were compiled for a device.

use std::collections::HashMap;
use std::hash::Hash;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use voltet_core::Result;

/// Key of a compute pipeline: its sources.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct PassKey {
    pub text: String,
    pub entry_point: &'static str,
    pub constants: Vec<(&'static str, u64)>,
}

/// Key of a render pipeline: its text, and the formats that it draws into.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(crate) struct DrawingKey {
    pub text: String,
    pub fragment: &'static str,
    pub formats: Vec<wgpu::TextureFormat>,
    pub factors: [wgpu::BlendFactor; 2],
}

/// Pipelines by what they were compiled from.
pub(crate) struct PipelineCache<K, P>(Mutex<HashMap<K, Arc<P>>>);

impl<K, P> Default for PipelineCache<K, P> {
    fn default() -> Self {
        PipelineCache(Mutex::default())
    }
}

impl<K: Eq + Hash, P> PipelineCache<K, P> {
    /// The pipeline, compiled if it is not there; compiling blocks no other thread.
    pub fn get_or_compile(&self, key: K, compile: impl FnOnce() -> Result<P>) -> Result<Arc<P>> {
        let known = self.locked().get(&key).cloned();
        if let Some(pipeline) = known {
            return Ok(pipeline);
        }
        let compiled = Arc::new(compile()?);
        Ok(self.locked().entry(key).or_insert(compiled).clone())
    }

    pub fn locked(&self) -> MutexGuard<'_, HashMap<K, Arc<P>>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
