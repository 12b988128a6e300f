//! One pass: compiled, bound to the grid's arrays, and the tables that it reads.

pub(crate) mod bound_pass;
pub(crate) mod tables;
