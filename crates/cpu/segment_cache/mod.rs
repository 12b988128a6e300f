//! Segment cache of a view: while only widgets change, a picture is shaded and blended anew, and nothing is culled, projected, intersected
//! or sorted.
//!
//! Each segment is cached with its length and its values at both ends: those of every cell in view, front to back, the pixels of a row side
//! by side. Pictures from the cache differ from others by what culling leaves out, 1e-6 at most, and by the rounding of values that are
//! counted from the centre of their range.
//!
//! While a widget is dragged, a picture from the cells takes 1.2 to 3.0 times as long as one from the cache, in the median 2.0 times: heat
//! sink and blunt fin, each with a piecewise-linear function and a wide Gaussian, the blunt fin with four Gaussians, too, at 512 × 512 and
//! 1024 × 768; a virtual machine with two cores and AVX-512. Narrow widgets, of which culling leaves few cells, are drawn from these (see `views`).
//! `VOLTET_TEST_DATA=FOLDER cargo bench -p voltet-bench --bench frame -- --scenes heat_sink,bluntfin --changes` prints it in the rows "widget
//! moved"; FOLDER has `bluntfin.vtu`.
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
