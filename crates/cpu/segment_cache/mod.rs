//! Segment cache of a view: while only widgets change, a picture is shaded and blended anew, and nothing is culled, projected, intersected
//! or sorted.
//!
//! Each segment is cached with its length and its values at both ends: those of every cell in view, front to back, the pixels of a row side
//! by side. Pictures from the cache differ from others by what culling leaves out, 1e-6 at most, and by the rounding of values that are
//! counted from the centre of their range.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `views` | views that are worth caching |
//! | `recorder` | segments recorded from lists |
//! | `slices` | cached segments by slices |
//! | `tile` | cached segments of a tile |

mod recorder;
mod slices;
mod tile;
mod views;

pub(crate) use recorder::{CacheBudget, TileRecorder};
pub(crate) use slices::CachedSlices;
pub(crate) use tile::{CachedTile, SegmentCache};
pub(crate) use views::{Plan, ViewCache};
