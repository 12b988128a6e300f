//! A drag in the plane.

use super::handles::Handle;
use super::screen_widget::ScreenWidget;

/// A drag: the widget as it was, what is held, and where that was and is.
pub(super) struct Drag {
    pub widget: ScreenWidget,
    pub handle: Option<Handle>,
    pub from: [f64; 2],
    pub at: [f64; 2],
    /// The extinction at the top of the plot stands still meanwhile.
    pub peak: f64,
}
