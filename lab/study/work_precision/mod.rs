//! The study of a scene: every integrator that can serve it, over its settings, on every engine, against the 64-bit
//! reference: what each costs and how wrong it is.
//!
//! | file | what |
//! | --- | --- |
//! | `options` | what is asked of a study |
//! | `subject` | what the pipeline's node that draws is given |
//! | `settings` | what is tried |
//! | `reference`, `picture_cache` | the picture to compare with, kept between studies, also where it was stopped |
//! | `variant`, `bench` | which engines there are to measure on |
//! | `measure` | times and memory on an engine |
//! | `errors`, `flip` | differences of pictures |
//! | `convergence` | observed and expected orders |
//! | `refine` | integration and data model apart, by refining the grid |
//! | `pareto` | what is worth taking |
//! | `table`, `plot`, `canvas`, `page` | how it is shown |
//! | `apply` | a setting written into a pipeline file |
//!
//! It knows no terminal: [`study`] is given a [`Progress`], and what it gives is written by [`write`].

mod apply;
mod bench;
pub(crate) mod canvas;
mod convergence;
mod errors;
mod flip;
mod measure;
mod options;
mod output;
pub(crate) mod page;
mod pareto;
mod picture_cache;
mod plot;
mod reference;
mod refine;
mod run;
mod settings;
mod subject;
mod table;
mod variant;

pub use apply::apply;
pub use bench::{Adapter, Benches};
pub use convergence::{Convergence, Level, convergence};
pub use errors::{Errors, difference, errors};
pub use flip::PreparedPicture;
pub use measure::{Cost, Frames, Pass, Times};
pub use options::{Measure, StudyOptions};
pub use output::{write, written};
pub use page::recommendation;
pub use pareto::{cheapest, front};
pub use reference::{Reference, cache_folder, reference};
pub use refine::{Refinement, Source, refinement, refuse_too_fine};
pub use run::{Refused, Row, Study, study};
pub use settings::{RenderConfig, Value, settings, studied};
pub use subject::{RendererNode, Subject, SubjectRequest, drawing_nodes};
pub use table::{csv, json, text};
pub use variant::{Engines, RendererVariant};
