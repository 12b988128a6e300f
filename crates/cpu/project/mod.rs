//! Project: kept cells to what 32 bits draw each with, and the tiles that they touch.

pub(crate) mod area;
pub(crate) mod cell64;
pub(crate) mod covered;
pub(crate) mod outline;
pub(crate) mod part;
pub(crate) mod record;
pub(crate) mod tiles;
pub(crate) mod windows;
#[cfg(test)]
mod windows_tests;
