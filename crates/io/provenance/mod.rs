//! Provenance: program, pipeline and data files, written into pictures and reports, and read again (docs/src/reference/provenance.md).
//!
//! | file | what |
//! | --- | --- |
//! | `block` | what is written |
//! | `date` | dates |
//! | `report` | the report of a run |

mod block;
pub mod date;
mod report;

pub use block::{
    CameraRecord, DataFile, MAX_NAMED, MAX_TEXT, PIPELINE, PROVENANCE, PluginRecord, Provenance,
    SidecarFiles, UnitDistance, Units,
};
pub use report::{run_report, whole_report};
