//! Parameters: their declarations, the settings of a file or a program, and the check of one against the other.
//!
//! A node, a gradient filter and each kind of widget declare what can be set by one type, [`Parameter`]. Help, the checker,
//! editor panels and the reference are made from that. A [`LocatedValue`] is a value with the place where it was written;
//! [`Parameters`] are settings checked against declarations.
//!
//! Declarations live as long as the program: constants for what ships. What is loaded at run time leaks its texts and
//! lists (`String::leak`, `Vec::leak`), a few hundred bytes each time it is loaded.

mod check;
mod declaration;
mod named_paths;
mod relative;
mod setting;
#[cfg(test)]
mod tests;

pub use crate::nearest::{edit_distance, nearest, nearest_first, suggest};
pub use check::{FaultSink, Parameters, refuse_contradictions, repeated};
pub use declaration::{
    AxisRef, DefaultValue, Parameter, ParameterType, Range, RelativeNumberType, StatisticKind, Variant,
    VariantSchema,
};
pub use named_paths::NamedPath;
pub use relative::{ArrayRef, Relative, RelativeNumber};
pub use setting::{
    ArrayOrigin, ENTRY_NAME, Field, LocatedValue, ParameterValue, SourceSpan, find_setting, key_text,
    replace_field,
};
