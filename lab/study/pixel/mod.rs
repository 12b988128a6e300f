//! One pixel: its ray cell by cell, by the 64-bit referee, beside what engine and integrators make of it.

mod plot;
mod text;
mod trace;

pub use plot::plot;
pub use text::{SHOWN, csv, json, text};
pub use trace::{EnginePixel, IntegratorPixel, Pixel, pixel};
