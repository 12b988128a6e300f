//! The study of a scene: every integrator that can serve it, over its settings, on every engine, against the 64-bit
//! reference: what each costs and how wrong it is.
//!
//! | file | what |
//! | --- | --- |
//! | `scene` | what the pipeline's node that draws is given |
//! | `settings` | what is tried |
//! | `reference`, `kept` | the picture to compare with, kept between studies, also where it was stopped |
//! | `engine`, `bench` | which engines there are to measure on |
//! | `measure`, `device` | times and memory, on the native engine and on a device |
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
mod canvas;
mod convergence;
#[cfg(feature = "gpu")]
mod device;
#[cfg(not(feature = "gpu"))]
#[path = "no_device.rs"]
mod device;
mod engine;
mod errors;
mod flip;
mod kept;
mod measure;
mod output;
mod page;
mod pareto;
mod plot;
mod reference;
mod refine;
mod run;
mod scene;
mod settings;
mod table;

pub use apply::apply;
pub use bench::{Adapter, Benches};
pub use convergence::{Convergence, Level, convergence};
pub use engine::{Engine, Engines};
pub use errors::{Errors, difference, errors};
pub use flip::Seen;
pub use measure::{Cost, Frames, Pass, Times};
pub use output::write;
pub use page::recommendation;
pub use pareto::{cheapest, front};
pub use reference::{Reference, cache_folder, reference};
pub use refine::{Refinement, Source, refinement};
pub use run::{Measure, Refused, Row, Study, Wish, study};
pub use scene::{Asked, Form, Scene, drawing_nodes};
pub use settings::{Setting, Value, settings};
pub use table::{csv, json, text};
