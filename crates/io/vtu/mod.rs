//! Grids with results to VTK files (.vtu).
//!
//! | file | what |
//! | --- | --- |
//! | `contents` | what is written: points, cells, arrays |
//! | `gather` | values of the grid as those of the file's own points and cells, or of tetrahedra |
//! | `encode` | the file's bytes, by the crate vtkio |

mod contents;
mod encode;
mod gather;

pub use contents::{Column, Contents, Precision, Role, Topology, Values};
pub use encode::{Encoded, encode, encoding_bytes};
pub use gather::{CellSource, TetrahedraSource, gather};
