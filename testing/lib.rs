//! What the tests of several crates share. Nothing of it ships.
//!
//! | room | what |
//! | --- | --- |
//! | `pictures` | scenes that every engine is held to, and the comparison with the referee |
//! | `files` | small data files in every format and encoding, written independently of the readers |

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

#[cfg(feature = "files")]
pub mod files;
#[cfg(feature = "pictures")]
pub mod pictures;
