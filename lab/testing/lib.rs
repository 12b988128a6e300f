//! Helpers that the tests of several crates share. Nothing of it ships.
//!
//! The unit tests of `core` build scenes of their own: to them those here are of another `voltet_core`.
//!
//! | room | what |
//! | --- | --- |
//! | `pictures` | scenes that every engine is held to, and the comparison with the referee |
//! | `random` | random widgets of every kind, transfer functions and segments for property tests |
//! | `segments` | ray segments drawn by lot, and widgets of every kind for them |
//! | `twin` | a formula in 32 bits against its 64-bit truth |
//! | `segment_twin` | an integrator in 32 bits on a segment against its 64-bit truth |
//! | `compilers` | plug-ins and programs in other languages |
//! | `thread_ranks` | processes of one run as threads |
//! | `files` | small data files in every format and encoding, written independently of the readers |

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

/// Says loudly that a test is skipped for want of a graphics device; fails if the environment variable `VOLTET_REQUIRE_GPU`
/// is 1.
#[track_caller]
pub fn skipped_without_device(why: impl std::fmt::Display) {
    let required = std::env::var("VOLTET_REQUIRE_GPU").is_ok_and(|value| value == "1");
    assert!(!required, "VOLTET_REQUIRE_GPU is 1, but there is no device: {why}");
    eprintln!("\n*** SKIPPED: {why}; scripts/install-software-vulkan.sh ***\n");
}

/// True if every case of a long series is tested, as in CI: the environment variable `VOLTET_TEST_SERIES` is `all`. Otherwise one in a
/// few is, so that `cargo test` stays short.
pub fn whole_series() -> bool {
    std::env::var("VOLTET_TEST_SERIES").is_ok_and(|value| value == "all")
}

pub mod compilers;
#[cfg(feature = "files")]
pub mod files;
#[cfg(feature = "pictures")]
pub mod pictures;
#[cfg(feature = "segments")]
pub mod random;
#[cfg(feature = "segments")]
pub mod segment_twin;
#[cfg(feature = "segments")]
pub mod segments;
#[cfg(feature = "ranks")]
pub mod thread_ranks;
#[cfg(feature = "segments")]
pub mod twin;

/// WebAssembly modules from their text.
#[cfg(feature = "wat")]
pub use wat;
