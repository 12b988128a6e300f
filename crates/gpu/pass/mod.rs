//! One pass: compiled, bound to the grid's arrays, and the tables that it reads.

pub(crate) mod steps;
pub(crate) mod tables;
