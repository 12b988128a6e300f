//! Programs in C, C++ and Fortran, written against the header alone: compiled, run, and their pictures held against those of the
//! program `voltet`.
#![allow(clippy::unwrap_used)] // A test that cannot go on has failed.

mod examples;
mod layout;
mod library;
mod threads;
mod truth;
mod wrong;
