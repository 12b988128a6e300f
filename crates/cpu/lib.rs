//! voltet-cpu: the native engine. Cull, sort, project and composite on all cores with vector units.
//!
//! | room | what |
//! | --- | --- |
//! | `view` | the camera as the stages use it |
//! | `cells`, `attribute` | the cells that are drawn, and the point arrays that are looked at |
//! | `cull` | which cells can contribute |
//! | `project` | cells to records of 32 bits, and the tiles that they touch |
//! | `cast` | rays from cell to cell through the faces that these share |
//! | `fragments` | the pixels that a tile's cells cover, and the rays' segments in them |
//! | `shade` | a segment's colour and opacity |
//! | [`integrator`] | integrators from outside, in lanes |
//! | `sample` | what the compositor reads: the projection and how segments are shaded |
//! | `composite` | segments in order to pixels |
//! | `kept` | segments kept between pictures of one view |
//! | `draw` | the stages end to end |
//! | `ready` | what is ready to be drawn, by all threads |
//! | `memory`, `spare` | what they take, and what a frame leaves to the next one |
//! | `native` | the engine as one of the program's |
//! | `segments` | what becomes of segments alone, for judging |

mod attribute;
mod cast;
mod cells;
mod composite;
mod cull;
mod draw;
mod fragments;
pub mod integrator;
mod kept;
mod memory;
mod native;
mod project;
mod ready;
mod sample;
mod segments;
mod shade;
mod spare;
mod view;

pub use cells::{Casting, Cells, Counts};
pub use cull::{Known, Sample, cull, keep_all};
pub use draw::{Projection, composite, draw, integrator, needs_gradient, prepare, project, sort};
pub use memory::drawing_bytes;
pub use native::ENGINE;
pub use ready::Ready;
pub use segments::{Integrated, Segments, segments};
