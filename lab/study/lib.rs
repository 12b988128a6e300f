//! voltet-study: what measures and judges the program. It knows no terminal.
//!
//! | room | what |
//! | --- | --- |
//! | [`work_precision`] | one scene with every integrator and setting on every engine: time against error |
//! | [`pixel`] | one pixel's ray cell by cell, and what each integrator makes of it |
//! | [`stability`] | every formula by exact values, hard pictures by the referee, formulas as printed |
//! | [`gradient_test`] | gradient filters by manufactured fields: orders, exactness, invariance, noise, cost, pictures |
//! | [`papers`] | the tables and figures of the papers, made anew |
//! | [`no_leave_out`] | a run that leaves nothing out, held against the usual one |

mod devices;
pub mod gradient_test;
pub mod no_leave_out;
pub mod numbers;
pub mod papers;
pub mod pixel;
pub mod stability;
pub mod work_precision;

pub use no_leave_out::{NoLeaveOut, SAME};
