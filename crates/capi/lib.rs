//! voltet-c: the renderer for programs in C, C++ and Fortran. `include/voltet.h` documents its functions.

mod grid;
mod guard;
mod interface;
mod render;
mod structs;

pub use grid::GridHandle;
pub use guard::{CANCELLED, DONE, FAILED, Handle, PANIC, USAGE};
pub use interface::*;
pub use structs::{Array, Camera, Follow, GridInfo, GridSource, Image};
