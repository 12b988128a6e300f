//! Reading files of every format.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod encodings;
mod real_files;
mod samples;
mod writer;
