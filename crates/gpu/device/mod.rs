//! A device: which adapter it is, what it holds, what is compiled for it, and what its passes take.
//!
//! | file | what |
//! | --- | --- |
//! | `adapter` | which there are, and which is taken |
//! | `open` | the open device, its limits, and what it says when something fails |
//! | `buffers` | made within those limits, written, read back |
//! | `bindings` | what each pass is bound to |
//! | `pipelines`, `compiled` | compiling passes, and keeping them |
//! | `timing` | seconds of each pass |

pub(crate) mod absent;
pub(crate) mod adapter;
pub(crate) mod bindings;
pub(crate) mod buffers;
pub(crate) mod compiled;
pub(crate) mod open;
pub(crate) mod pipelines;
pub(crate) mod timing;
