//! Shade: from a segment's length and the values at its ends to its colour and opacity.
//!
//! | file | what |
//! | --- | --- |
//! | `shader` | a scene's widgets made ready, and the three roads through them |
//! | `roads` | a batch by all three, one after the other |
//! | `shaded` | what comes out |
//! | `along`, `region` | segments in lanes, and their stretch inside a region |
//! | `widget` | any widget in lanes; `gaussian`, `gaussian_nd`, `piecewise`, `triangular`, `wave`: the kinds |
//! | `overlap` | several widgets on one segment, in their order: closed forms and quadrature |
//! | `panels`, `member` | the same for what is left over: a walk in panels |
//! | `light` | silhouettes and light |

pub(crate) mod along;
pub(crate) mod gaussian;
pub(crate) mod gaussian_nd;
pub(crate) mod light;
pub(crate) mod member;
pub(crate) mod overlap;
pub(crate) mod panels;
pub(crate) mod piecewise;
pub(crate) mod region;
pub(crate) mod roads;
pub(crate) mod shaded;
pub(crate) mod shader;
pub(crate) mod triangular;
pub(crate) mod wave;
pub(crate) mod widget;
