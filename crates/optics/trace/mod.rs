//! Ray tracer in 64 bits: every cell that a ray crosses, in the order of the scene, by an integral of the caller's choice. It is slow
//! and shares no geometry with the engines.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `crossing` | ray against cell |
//! | `integral` | integral of a segment |
//! | `tracer` | shading and compositing |
//! | `tiles` | the picture |
//! | `walk` | one ray cell by cell |

mod crossing;
mod integral;
mod tiles;
mod tracer;
mod walk;

pub use crossing::{Crossing, Ray};
pub use integral::{ClosedForms, SegmentIntegral};
pub use tiles::{TILE_PIXELS, Tiles};
pub use tracer::{TracedRay, Tracer};
pub use walk::{CellCrossing, Walk};
