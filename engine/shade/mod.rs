//! Shade: from a segment's length and the values at its ends to its colour and opacity.
//!
//! | file | what |
//! | --- | --- |
//! | `shader` | a scene's widgets made ready, and the three roads through them |
//! | `roads` | a batch by all three, one after the other |
//! | `shaded` | what comes out |
//! | `shapes` | the widgets that a vector of segments meets |
//! | `along`, `region` | segments in lanes, and their stretch inside a region |
//! | `reach` | where a widget counts: segments elsewhere are not asked of it |
//! | `kinds` | any widget in lanes, one file a kind |
//! | `overlap` | several widgets on one segment, in their order: closed forms and quadrature |
//! | `panels` | the same for what is left over: a walk in panels |
//! | `later` | dense segments, whose colour waits until it is known whether they are seen |
//! | `light` | silhouettes and light |

pub(crate) mod along;
pub(crate) mod kinds;
pub(crate) mod later;
pub(crate) mod light;
pub(crate) mod overlap;
pub(crate) mod panels;
pub(crate) mod reach;
#[cfg(test)]
mod reach_tests;
pub(crate) mod region;
pub(crate) mod roads;
pub(crate) mod shaded;
pub(crate) mod shader;
pub(crate) mod shapes;
