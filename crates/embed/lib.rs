//! voltet-embed: what a program holds that draws by voltet, whatever its language; below the interfaces for C and for Python.
//!
//! | file | what |
//! | --- | --- |
//! | `session` | pictures and figures of a pipeline, the grids that the program gives, what runs leave |
//! | `grid` | a program's arrays to a grid, lent where their layout allows |
//! | `follow` | a run that the program follows and may stop, from its own thread |
//! | `panic` | a panic in words |

mod follow;
mod graphs;
mod grid;
mod panic;
mod session;

pub use follow::{Moment, follow};
pub use grid::{ArraySource, CellSource, Numbers, Source, grid, no_scalar};
pub use panic::said;
pub use session::{Account, Drawing, Scene, Session};
