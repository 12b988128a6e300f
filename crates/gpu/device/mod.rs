//! A device: adapter, limits, buffers, and compiled pipelines.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `adapter`, `adapter_probe_cache` | adapters; cached absence of hardware ones |
//! | `device_handle` | the open device, limits, errors |
//! | `buffers` | buffers within limits, uploads, readbacks |
//! | `bindings` | bindings of each pass |
//! | `pipelines`, `pipeline_cache` | compiles passes, caches them |
//! | `timing` | seconds of each pass |

pub(crate) mod adapter;
pub(crate) mod adapter_probe_cache;
pub(crate) mod bindings;
pub(crate) mod buffers;
pub(crate) mod device_handle;
pub(crate) mod pipeline_cache;
pub(crate) mod pipelines;
pub(crate) mod timing;
