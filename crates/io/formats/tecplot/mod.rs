//! Tecplot data as [`text`] (.dat, .tec) and [`binary`] (.plt): zones of tetrahedra, bricks, polyhedra, or ordered points, with variables
//! at nodes and at cells. Zones are blocks; zones of different solution times are steps.
//!
//! Source: Tecplot 360 data format guide. Variables named x, y and z, or else the first three, are the coordinates.

mod binary;
mod text;
mod zones;

use super::request::Format;

/// The declarations: of text, and of the binary form.
pub(super) const TEXT: Format = text::FORMAT;
pub(super) const BINARY: Format = binary::FORMAT;
