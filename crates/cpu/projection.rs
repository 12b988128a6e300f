//! Projection: cells prepared for the compositor.

use crate::attribute::Attribute;
use crate::cast::RayCastPolicy;
use crate::cells::Cells;
use crate::subpixel::SubpixelView;
use voltet_core::Result;
use voltet_core::camera::Camera;
use voltet_core::progress::Progress;

/// Cells prepared for the compositor: one projection for each sample of a pixel. Of more cells than are resident at once
/// ([`crate::CellSelection::max_resident_cells`]) it holds the region of the picture that each touches; the compositor projects them region
/// by region.
#[derive(Debug)]
pub struct Projection {
    pub(crate) cells: Cells,
    pub(crate) camera: Camera,
    /// First samples of a pixel, at least one; further ones are projected when they are composited.
    pub(crate) samples: Vec<SubpixelView>,
    /// Upper bound of the optical depth, or colour, that all widgets together give over a scene length.
    pub(crate) max_optical_depth: f64,
    pub(crate) policy: RayCastPolicy,
}

impl Projection {
    /// The volume's cells that were projected, and their order.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// The camera.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Cells that cover a pixel centre (of the first sample). `None` where no cell is projected, since rays go from cell to cell.
    pub fn cells_projected(&self) -> Option<u64> {
        self.samples.first().map_or(Some(0), SubpixelView::cell_count)
    }

    /// Projects the cells for one more sample of every pixel. `attributes`: at least those that the first was projected with.
    pub(crate) fn sample(
        &self,
        offset: [f64; 2],
        attributes: &[Attribute<'_>],
        progress: &dyn Progress,
    ) -> Result<SubpixelView> {
        let count = self.samples.first().map_or(attributes.len(), |first| first.attribute_count);
        let bounds = (self.max_optical_depth, self.policy);
        SubpixelView::new(&self.cells, &self.camera, offset, &attributes[..count], bounds, progress)
    }
}
