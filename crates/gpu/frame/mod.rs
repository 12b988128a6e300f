//! A frame: what a scene asks of the device, its windows, and the passes over each.
//!
//! | file | what |
//! | --- | --- |
//! | `draw`, `drawn` | the door: a scene to a picture and its counts |
//! | `plan` | whether it is drawn as asked, along the faces of its cells, or by tiles instead |
//! | `faces`, `checked` | the order of cells along their faces, for what is blended; how it is held against tiles |
//! | `flight` | frames in flight: begun, and taken later |
//! | `limits`, `support`, `view` | what is refused; where widgets lie; the camera, for the passes |
//! | `renderer`, `buffers` | a grid with what stays between its frames |
//! | `inputs` | what a frame is drawn from |
//! | `windows` | windows that fit the device's memory, and how much work one dispatch does |
//! | `passes` | all passes over a window, in their order |
//! | `count` | the numbers that they count |

pub(crate) mod buffers;
pub(crate) mod checked;
pub(crate) mod count;
pub(crate) mod draw;
pub(crate) mod drawn;
pub(crate) mod faces;
pub(crate) mod flight;
pub(crate) mod inputs;
pub(crate) mod limits;
pub(crate) mod passes;
pub(crate) mod plan;
pub(crate) mod renderer;
pub(crate) mod support;
pub(crate) mod view;
pub(crate) mod windows;
