//! Provenance: program, pipeline and data files, written into pictures and reports, and read again (docs/src/reference/provenance.md).
//!
//! | file | what |
//! | --- | --- |
//! | `block` | what is written |
//! | `embedded` | the texts that a picture carries, read from it |
//! | `date` | dates |
//! | `report` | the report of a run |
//! | `source` | the text of a pipeline, from its file or from a picture |

mod block;
pub mod date;
mod embedded;
mod report;
mod source;

pub use block::{
    CameraRecord, DataFile, MAX_NAMED, MAX_TEXT, PIPELINE, PROVENANCE, PluginRecord, Provenance,
    SidecarFiles, UnitDistance, Units,
};
pub use embedded::{is_picture, read};
pub use report::{run_report, whole_report};
pub use source::Source;
