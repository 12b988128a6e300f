//! Visibility: orders of cells.
//!
//! | file | what |
//! | --- | --- |
//! | `centroid` | by the distance of the cells' centroids: what `order = "centroid"` asks for, for comparison and for speed |
//! | `faces` | which cells meet at which faces: found once a grid |
//! | `order` | the order along faces, exact at every pixel where there is one |
//! | `gaps` | which cells follow each other across a gap along the rays of the pixels |
//! | `rays` | the rays of a picture, and the triangles that they cross |
//! | `convex` | whether a grid has no gaps whatever it is seen from |
//! | `disorder` | pixels at which an order of cells is not that of the entries: the check |
//!
//! An order of whole cells need not exist: cells may hide each other in a cycle. Where there is none, the exact order is carried
//! out by a compositor, pixel by pixel.

mod centroid;
mod disorder;
mod faces;
mod order;
mod rays;

pub use centroid::centroid_order;
pub use disorder::{Disorder, disorder};
pub use faces::Faces;
pub use order::{FaceOrder, OrderError};
