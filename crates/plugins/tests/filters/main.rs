//! Filters written against the header alone, compiled, loaded and held against those that ship.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod examples;
mod support;
