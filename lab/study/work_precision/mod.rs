//! The study of a scene: every integrator that can serve it, over its settings, on every engine, against the 64-bit
//! reference: what each costs and how wrong it is.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `options`, `settings` | options of a study, variants of engines, and what is tried |
//! | `subject` | the scene of the pipeline's node that draws |
//! | `reference` | the picture to compare with, kept between studies |
//! | `bench`, `measure` | engines, and times and memory on them |
//! | `errors`, `flip` | differences of pictures |
//! | `run` | the study itself, its Pareto front and recommendation |
//! | `convergence`, `refine` | orders of convergence; integration and data model apart |
//! | `table`, `plot`, `canvas`, `page` | tables, plot and page |
//! | `output` | the files of a study, and a setting written into a pipeline file |

mod bench;
pub(crate) mod canvas;
mod convergence;
mod errors;
mod flip;
mod measure;
mod options;
mod output;
pub(crate) mod page;
mod plot;
mod reference;
mod refine;
mod run;
mod settings;
mod subject;
mod table;

pub use bench::{Adapter, Benches};
pub use convergence::{Convergence, Level};
pub(crate) use errors::pixel_errors;
pub use errors::{Errors, errors};
pub use measure::{Cost, Pass, Times};
pub use options::{Engines, Frames, Measure, RendererVariant, StudyOptions, patience};
pub use output::{apply, write, written};
pub use page::recommendation;
pub use reference::{Reference, cache_folder, reference};
pub use refine::{Refinement, Source, refinement, refuse_too_fine};
pub use run::{Refused, Row, Study, study};
pub(crate) use settings::Numbers;
pub use settings::{RenderConfig, studied};
pub use subject::{RendererNode, Subject, SubjectRequest, drawing_nodes};
pub use table::{json, text};
