//! Shade: from a segment's length and the values at its ends to its colour and opacity.
//!
//! | file | what |
//! | --- | --- |
//! | `shader` | a scene's widgets made ready, and the roads through them |
//! | `roads` | a batch by all of them, one after the other |
//! | `shaded` | what comes out |
//! | `along`, `region` | segments in lanes, and their stretch inside a region |
//! | `quick` | what serves segments first: closed forms |
//! | `reach` | where a widget counts: segments elsewhere are not asked of it |
//! | `kinds` | any widget in lanes, one file a kind |
//! | `stepped` | several widgets on one segment, in their order, by quadrature |
//! | `panels` | the same for what that does not serve: a walk in panels |
//! | `gathered` | those segments side by side |
//! | `light` | silhouettes and light |

pub(crate) mod along;
mod gathered;
pub(crate) mod kinds;
pub(crate) mod light;
pub(crate) mod panels;
mod quick;
pub(crate) mod reach;
#[cfg(test)]
mod reach_tests;
pub(crate) mod region;
pub(crate) mod roads;
pub(crate) mod shaded;
pub(crate) mod shader;
pub(crate) mod stepped;
