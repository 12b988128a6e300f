//! Numbers relative to data: what a volume, or all steps of a time series, say of them.
//!
//! | file | what |
//! | --- | --- |
//! | `widgets` | the widgets of a transfer function, before and after the data are known |
//! | `scales` | what is found of the data, found once and kept |
//! | `volume`, `over_steps` | ranges and percentiles of one volume, and of all steps of a series |
//! | `found` | these, as scales |
//! | `shown` | what the numbers became, in words and figures |

mod over_steps;
mod scales;
mod shown;
mod statistics;
mod volume;
mod widgets;

pub use shown::note_numbers;
pub use volume::values;
pub use widgets::{Widgets, ask, known, stood_in};
