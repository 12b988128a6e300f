//! Grids that plug-ins give.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `head` | sizes and names |
//! | `buffers` | memory written to |
//! | `validate` | checks of what was written |

mod buffers;
mod head;
mod validate;

pub(crate) use buffers::Buffers;
pub(crate) use head::{ArrayRecord, Head, refuse_flags};
pub(crate) use validate::GridContents;
