//! What was drawn from what, by which program: written into pictures and reports, and read again (docs/provenance.md).
//!
//! | file | what |
//! | --- | --- |
//! | `block` | what is written |
//! | `carried` | the texts that a picture carries, read from it |
//! | `date` | dates |

mod block;
mod carried;
mod date;

pub use block::{
    Beside, CameraOf, DataFile, NAMED_MOST, PIPELINE, PROVENANCE, PluginOf, Provenance, TEXT_MOST,
    UnitDistance, Units,
};
pub use carried::{is_picture, read};
