//! What the tests of several crates share. Nothing of it ships.
//!
//! | room | what |
//! | --- | --- |
//! | `files` | small data files in every format and encoding, written independently of the readers |

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[cfg(feature = "files")]
pub mod files;
