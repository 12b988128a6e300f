//! The study of a scene: every integrator that can serve it, over its settings, on every engine, against the 64-bit
//! reference: what each costs and how wrong it is.

pub(crate) mod canvas;
mod convergence;
mod errors;
mod flip;
mod measure;
pub(crate) mod output;
mod plot;
mod reference;
mod run;
mod settings;
mod subject;
mod variant;

pub use convergence::{Convergence, Level, Refinement, Source, refinement, refuse_too_fine};
pub(crate) use errors::pixel_errors;
pub use errors::{Errors, difference, errors};
pub use flip::PreparedPicture;
pub use measure::{Adapter, Benches, Cost, Pass, Times};
pub use output::{apply, files_to_overwrite, json, measure, recommendation, text, write};
pub use reference::{Reference, cache_folder, reference};
pub use run::{Refused, Row, Study, study};
pub(crate) use settings::Numbers;
pub use settings::{Frames, Measure, RenderConfig, StudyOptions, patience, studied};
pub use subject::{RendererNode, Subject, SubjectRequest, drawing_nodes};
pub use variant::{Engines, RendererVariant};
