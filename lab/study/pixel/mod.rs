//! One pixel: its ray cell by cell, by the 64-bit referee, beside what engine and integrators make of it.
//!
//! | file | what |
//! | --- | --- |
//! | `found` | what is found out |
//! | `trace` | finding it out |
//! | `cells` | the file's own cells, by name |
//! | `said` | what each integrator makes of the rays |
//! | `nothing` | why a ray shows nothing |
//! | `text`, `tables`, `plot` | how it is shown |

mod cells;
mod integrators;
mod invisible;
mod plot;
mod record;
mod tables;
mod text;
mod trace;

pub use plot::plot;
pub use record::{EnginePixel, IntegratorPixel, Pixel};
pub use tables::{csv, json};
pub use text::{SHOWN, text};
pub use trace::pixel;
