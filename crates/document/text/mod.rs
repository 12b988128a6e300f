//! TOML texts changed where asked and nowhere else.
//!
//! A [`Draft`] holds a text and the places of everything in it, and collects replacements of bytes; what is not replaced is not
//! written again, so comments, order, spaces and line ends stay by construction.

mod draft;
mod lines;
mod syntax;

pub use draft::Draft;
pub use syntax::Syntax;
