//! Shape of a widget in the plane of the transfer function editor.

use super::geometry::{Change, Handle, S_AND_G, Scale};
use super::images::Images;
use super::plane::WidgetPainter;
use crate::worker::DataScales;
use std::fmt::Debug;
use voltet_graph::ArrayRef;

/// A widget in the plane, but for its region. Places are values along the plane's axes.
pub(super) trait Shape: Debug {
    /// Handles and their positions.
    fn handles(&self, _scale: &Scale) -> Vec<(Handle, [f64; 2])> {
        Vec::new()
    }

    /// Changes of the numbers when a handle moves to a position.
    fn moved(&self, _handle: Handle, _to: [f64; 2], _scale: &Scale) -> Vec<Change> {
        Vec::new()
    }

    /// Changes of the numbers when the whole shape is moved: by its centre.
    fn shifted(&self, by: [f64; 2], scale: &Scale) -> Vec<Change> {
        let centre = self.handles(scale).into_iter().find(|(handle, _)| *handle == Handle::Centre);
        centre.map_or(Vec::new(), |(handle, at)| self.moved(handle, [at[0] + by[0], at[1] + by[1]], scale))
    }

    fn draw(&self, _pen: &WidgetPainter) {}

    /// True if it has points, to which others can be added.
    fn has_points(&self) -> bool {
        false
    }

    /// With a point more at a place, and which one that is.
    fn with_point(&self, _at: [f64; 2], _scale: &Scale) -> Option<(Vec<Change>, Handle)> {
        None
    }

    /// Without the point of a handle; `None` where it is none, or is needed.
    fn without_point(&self, _handle: Handle) -> Option<Vec<Change>> {
        None
    }

    /// The values of its further fields at a place, in the order of its properties.
    fn fields(&self, _at: [f64; 2]) -> Vec<f64> {
        Vec::new()
    }

    /// True if the plane shows all of it: no field lies outside, and the widths do not depend on such a field.
    fn is_in_plane(&self) -> bool {
        true
    }

    /// The magnitude that it is drawn at, where it depends on one that is no axis.
    fn level(&self) -> Option<f64> {
        None
    }
}

/// The plane that a widget is to be drawn in.
pub(super) struct PlaneContext<'a> {
    pub axes: &'a [ArrayRef; 2],
    /// Lengths along both axes that are equal on the screen, for angles.
    pub extent: [f64; 2],
    pub known: Option<&'a DataScales>,
    pub images: &'a Images,
}

impl PlaneContext<'_> {
    /// True if the plane is that of s and g.
    pub fn is_of_s_and_g(&self) -> bool {
        *self.axes == S_AND_G
    }
}
