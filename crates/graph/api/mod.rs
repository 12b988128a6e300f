//! Interface of a node type: its declaration, the contexts of its functions, demands and values.

pub(crate) mod context;
pub(crate) mod demand;
pub(crate) mod node;
pub(crate) mod observer;
pub(crate) mod origins;
pub(crate) mod parts;
pub mod ranks;
pub(crate) mod value;
