//! Selected cells with the caches of their volume.

use crate::cast::FaceCache;
use crate::composite::frame::BufferPool;
use crate::selection::CellSelection;
use crate::view::ScreenVertex;
use std::ops::{Deref, DerefMut};
use std::sync::Arc;
use voltet_core::camera::Camera;

/// Cells that can contribute, as [`crate::cull()`] makes them, with what their volume's cache hands to the further stages.
#[derive(Debug, Clone)]
pub struct Cells {
    /// The selection.
    pub selection: CellSelection,
    /// Buffers that frames use again.
    pub(crate) buffers: Arc<BufferPool>,
    /// Faces of the cells in widgets' supports, where rays may follow them.
    pub(crate) faces: Option<FaceCache>,
    /// Points on the screen of the camera that culled.
    pub(crate) screen_vertices: Option<(Camera, Arc<Vec<ScreenVertex>>)>,
}

impl Deref for Cells {
    type Target = CellSelection;

    fn deref(&self) -> &CellSelection {
        &self.selection
    }
}

impl DerefMut for Cells {
    fn deref_mut(&mut self) -> &mut CellSelection {
        &mut self.selection
    }
}
