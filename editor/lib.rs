//! voltet-editor: the node editor, a window over the pipeline file.
//!
//! | room | what |
//! | --- | --- |
//! | [`worker`] | draws the picture at a node, on a thread of its own |
//! | [`view`] | movements of the camera |

pub mod view;
pub mod worker;
