//! Output for people: errors with their location, progress bars, reports, the reference of nodes.

mod error;
mod progress;
mod reference;
mod report;
mod streams;

pub use error::{error, warning};
pub use progress::{Bar, Estimate};
pub use reference::{filter_markdown, filter_text, node_markdown, node_text};
pub use report::{findings, json, number, summary, warnings};
pub use streams::{name, print, say};
