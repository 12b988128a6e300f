//! Project: kept cells to what 32 bits draw each with, and the tiles that they touch.

pub(crate) mod cell64;
pub(crate) mod outline;
pub(crate) mod part;
pub(crate) mod record;
