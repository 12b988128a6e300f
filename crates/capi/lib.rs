//! voltet-c: the renderer for programs in C, C++ and Fortran. What each function means stands in `include/voltet.h` alone.
//!
//! | file | what |
//! | --- | --- |
//! | `interface` | the functions that the library exports |
//! | `structs` | the header's structs, and how a caller's are read |
//! | `guard` | handles, errors and panics at the border |
//! | `session` | a pipeline, its grids, and what its runs leave |
//! | `grid` | a caller's arrays to a grid, lent where their layout allows |
//! | `follow` | a run that a caller follows and may stop |
//! | `image` | a picture into a caller's memory |

mod follow;
mod grid;
mod guard;
mod image;
mod interface;
mod session;
mod structs;

pub use grid::GridHandle;
pub use guard::{CANCELLED, DONE, FAILED, Handle, PANIC, USAGE};
pub use interface::*;
pub use structs::{Array, Camera, Follow, GridInfo, GridSource, Image};
