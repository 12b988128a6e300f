//! Grids that plug-ins give: how large they are, the memory that they are written to, what is wrong with them.

mod buffers;
mod head;
mod judge;

pub(crate) use buffers::{Buffers, Fresh, Mixed, fresh, overran};
pub(crate) use head::{ArrayOf, Head, refuse_flags};
pub(crate) use judge::Made;
