//! voltet-c: the renderer for programs in C, C++ and Fortran. `include/voltet.h` documents its functions.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `interface` | exported functions |
//! | `structs` | structs of the header |
//! | `guard` | handles, errors and panics |
//! | `grid` | arrays to a grid |
//! | `render` | cameras, runs with callbacks, pictures into the caller's memory |

mod grid;
mod guard;
mod interface;
mod render;
mod structs;

pub use grid::GridHandle;
pub use guard::{CANCELLED, DONE, FAILED, Handle, PANIC, USAGE};
pub use interface::*;
pub use structs::{Array, Camera, Follow, GridInfo, GridSource, Image};
