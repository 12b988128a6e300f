//! 32-bit twins of the segment integrals, over vector lanes.
//!
//! Each bears the name and argument order of the 64-bit truth in [`crate::optics`]; `docs` of each state the
//! range and the error measured. They take differences from a widget's centre, formed in 64 bits before rounding.

pub mod clip;
pub mod elementary;
pub mod gaussian;
pub mod linear;
pub mod wave;

#[cfg(test)]
mod tests;
