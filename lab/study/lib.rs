//! voltet-study: measurements of the program. It prints nothing.
//!
//! | room | what |
//! | --- | --- |
//! | [`work_precision`] | one scene with every integrator and setting on every engine: time against error |
//! | [`pixel`] | one pixel's ray cell by cell, and what each integrator makes of it |
//! | [`stability`] | every formula by exact values, hard pictures by the referee, formulas as printed |
//! | [`gradient_test`] | gradient filters by manufactured fields: orders, exactness, invariance, noise, cost, pictures |
//! | `papers` | tables and figures of the papers, made anew (feature of that name) |
//! | [`exhaustive`] | an exhaustive run compared with the usual one |

#![allow(missing_docs, reason = "unpublished: names say what fields and short functions are")]

mod columns;
mod devices;
pub mod exhaustive;
pub mod gradient_test;
#[cfg(feature = "papers")]
pub mod papers;
pub mod pixel;
pub mod stability;
pub mod work_precision;

pub use exhaustive::{ExhaustiveComparison, SAME};
