//! voltet-c: the renderer for programs in C, C++ and Fortran. `include/voltet.h` documents its functions.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `interface` | exported functions |
//! | `structs` | structs of the header |
//! | `guard` | handles, errors and panics |
//! | `camera` | camera to parameters |
//! | `grid` | arrays to a grid |
//! | `follow` | runs with callbacks |
//! | `image` | pictures into the caller's memory |

mod camera;
mod follow;
mod grid;
mod guard;
mod image;
mod interface;
mod structs;

pub use grid::GridHandle;
pub use guard::{CANCELLED, DONE, FAILED, Handle, PANIC, USAGE};
pub use interface::*;
pub use structs::{Array, Camera, Follow, GridInfo, GridSource, Image};
