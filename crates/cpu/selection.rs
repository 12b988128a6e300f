//! Selection of the cells that a picture is drawn from: plain data, without caches.

use std::borrow::Cow;
use std::sync::Arc;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_optics::scene_parts::SceneExtent;
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;

/// Method that generates ray segments: ray casting from cell to cell through shared faces, or projection of single cells. The image is
/// the same up to rounding.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traversal {
    /// Cells are projected.
    Project,
    /// Rays are cast where that is possible, there is memory for the faces, and it is faster by enough.
    Auto,
    /// Rays are cast wherever that is possible.
    RayCast,
}

/// Sample of a grid's cells that decides if culling by values is worth its cost.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CullSample {
    /// Cells that were tested.
    pub tested: u64,
    /// Cells that lie in no widget's support.
    pub dropped: u64,
}

/// Default of [`CellSelection::max_resident_cells`]: some 130 bytes each. Regions of half as many took as long on two cores.
pub(crate) const MAX_RESIDENT_CELLS: usize = 1 << 19;

/// Cells that can contribute to a picture.
#[derive(Debug, Clone)]
pub struct CellSelection {
    /// The volume they belong to.
    pub volume: Arc<Volume>,
    /// Numbers of the selected tetrahedra: ascending (grid order), or by centroid in that visibility order.
    pub ids: Arc<Vec<u32>>,
    /// Order of a pixel's segments that the compositor makes.
    pub ordering: Ordering,
    /// Tetrahedra left out because their values lie in no widget's support.
    pub culled_by_transfer_function: u64,
    /// Tetrahedra left out because they are outside the view.
    pub culled_by_frustum: u64,
    /// Sample for which culling by values was skipped: it would not have paid.
    pub culling_skipped: Option<CullSample>,
    /// Widgets whose support no selected cell meets: left out of the integrals.
    pub inactive_widgets: Vec<usize>,
    /// True if no work is skipped: the cells were not culled, and segments are ordered also where one colour needs no order.
    pub exhaustive: bool,
    /// Vector lanes that the further stages run on: the widest that this processor has.
    pub lanes: LaneSet,
    /// Method that generates ray segments.
    pub traversal: Traversal,
    /// Cells resident in projected form: of more, regions of the picture are projected one at a time while they are composited. The
    /// picture is the same.
    pub max_resident_cells: usize,
    /// True if attributes are scaled about the centre of their range, not about the widgets.
    pub(crate) centered_ranges: bool,
    /// Lower bound of the optical depth that cells are projected for: see [`crate::project::cells::Input::max_optical_depth`].
    pub(crate) optical_depth_floor: f64,
    /// Transfer function that the cells were culled for.
    pub(crate) culled_for: Option<TransferFunction>,
    /// Scene length that the stages work in: the diagonal of the grid (world units).
    pub(crate) length: f64,
    /// Ranges of s and g over the grid.
    pub(crate) ranges: [[f64; 2]; 2],
    /// Largest component of ∇s over the grid; 0 where there is no gradient.
    pub(crate) max_gradient: f64,
    /// True to cast rays wherever that is possible, also where the boundary is large or it does not pay: by the choice for a whole grid.
    pub(crate) casts_rays: bool,
    /// Extent of the whole grid, of which the volume is a part.
    pub(crate) whole: Option<Arc<SceneExtent>>,
}

impl CellSelection {
    /// The transfer function without inactive widgets. Widgets over further fields stay: the fields are numbered by the whole transfer
    /// function.
    pub(crate) fn active_widgets<'a>(
        &self,
        transfer_function: &'a TransferFunction,
    ) -> Cow<'a, TransferFunction> {
        match self.culled_for.as_ref() == Some(transfer_function) {
            true => without(transfer_function, &self.inactive_widgets),
            false => Cow::Borrowed(transfer_function),
        }
    }
}

/// A transfer function without these widgets, unless they are all; those over further fields stay.
pub(crate) fn without<'a>(
    transfer_function: &'a TransferFunction,
    inactive_widgets: &[usize],
) -> Cow<'a, TransferFunction> {
    if inactive_widgets.is_empty() || inactive_widgets.len() == transfer_function.widgets.len() {
        return Cow::Borrowed(transfer_function);
    }
    let mut active = transfer_function.clone();
    let mut number = 0;
    active.widgets.retain(|widget| {
        let inactive = inactive_widgets.contains(&number);
        number += 1;
        !inactive || !widget.profile.properties().fields.is_empty()
    });
    Cow::Owned(active)
}
