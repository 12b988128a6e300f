//! What is held in the plane.

use super::drawn::Drawn;
use super::handles::Handle;

/// A drag: the widget as it was, what is held, and where that was and is.
pub(super) struct Drag {
    pub widget: Drawn,
    pub handle: Option<Handle>,
    pub from: [f64; 2],
    pub at: [f64; 2],
    /// The extinction at the top of the plot stands still meanwhile.
    pub peak: f64,
}
