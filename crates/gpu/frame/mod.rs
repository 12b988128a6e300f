//! A frame: a scene's inputs on the device, its windows, and the passes over each.
//!
//! | file | responsibility |
//! | --- | --- |
//! | `draw`, `plan` | draws a scene; by which compositor |
//! | `output` | picture, counts, times |
//! | `face_order`, `order_check` | order along faces; its check |
//! | `in_flight` | submitted frames, collected later |
//! | `limits`, `support`, `view` | refusals; widget supports; camera uniform |
//! | `renderer`, `buffers` | a grid with its frames' buffers |
//! | `inputs` | inputs of a frame |
//! | `windows` | windows that fit memory; work of a dispatch |
//! | `passes` | passes over a window, in order |
//! | `counters` | indices of the counts |

pub(crate) mod buffers;
pub(crate) mod counters;
pub(crate) mod draw;
pub(crate) mod face_order;
pub(crate) mod in_flight;
pub(crate) mod inputs;
pub(crate) mod limits;
pub(crate) mod order_check;
pub(crate) mod output;
pub(crate) mod passes;
pub(crate) mod plan;
pub(crate) mod renderer;
pub(crate) mod support;
pub(crate) mod view;
pub(crate) mod windows;
