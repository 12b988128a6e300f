//! The cells that a picture is drawn from, and what is counted on the way.

use crate::cast::KnownFaces;
use crate::cull::Sample;
use crate::spare::Spare;
use crate::view::Seen;
use std::borrow::Cow;
use std::sync::Arc;
use voltet_core::camera::Camera;
use voltet_core::transfer::TransferFunction;
use voltet_core::volume::Volume;
use voltet_optics::shading::Ordering;
use voltet_simd::LaneSet;

/// When rays go from cell to cell through the faces that these share; else cells are projected one by one. Either shows the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Casting {
    /// Never.
    Never,
    /// Where that serves, there is room for the faces, and it is faster by enough, soon or late.
    IfItPays,
    /// Wherever it serves, fast or not.
    Always,
}

/// Cells that can contribute. Made by [`crate::cull`]; the `sort` node sets the order.
#[derive(Debug, Clone)]
pub struct Cells {
    /// The volume they belong to.
    pub volume: Arc<Volume>,
    /// Numbers of the tetrahedra kept: ascending (grid order), or by centroid if that is the order asked for.
    pub kept: Arc<Vec<u32>>,
    /// Order of a pixel's segments that the compositor makes.
    pub ordering: Ordering,
    /// Tetrahedra left out because no widget touches their values.
    pub culled_by_transfer_function: u64,
    /// Tetrahedra left out because they are outside the view.
    pub culled_by_frustum: u64,
    /// The sample for which none was left out because of its values: asking all would not have paid.
    pub not_worth_asking: Option<Sample>,
    /// Widgets that no kept cell touches: left out of the integrals.
    pub untouched: Vec<usize>,
    /// True in exhaustive mode: they were not culled, and segments are ordered also where one colour needs no order.
    pub exhaustive: bool,
    /// The vector lanes that the further stages run on: the widest that this processor has.
    pub lanes: LaneSet,
    /// When rays go from cell to cell.
    pub casting: Casting,
    /// Where the cells are more, they are projected window by window while they are composited. The picture is the same.
    pub most_at_once: usize,
    /// Whether values are counted from the middle of their range, and not from where widgets are.
    pub(crate) from_the_middle: bool,
    /// They are projected for at least this density: see [`crate::project::part::Input::densest`].
    pub(crate) densest_least: f64,
    /// Memory to work in, and to leave to the next frame.
    pub(crate) spare: Arc<Spare>,
    /// What is known of the faces of the cells that widgets touch, where rays may follow them.
    pub(crate) faces: Option<KnownFaces>,
    /// What the cells were culled for.
    pub(crate) culled_for: Option<TransferFunction>,
    /// World units in the scene length that the stages work in: the diagonal of the grid.
    pub(crate) length: f64,
    /// The points on the screen of the camera that culled, so that the project stage need not do it again.
    pub(crate) seen: Option<(Camera, Arc<Vec<Seen>>)>,
    /// Ranges of s and g over the grid.
    pub(crate) ranges: [[f64; 2]; 2],
    /// Largest component of ∇s over the grid; 0 where there is no gradient.
    pub(crate) steepest: f64,
}

/// Cells that are projected at once: some 130 bytes each. Windows of half as many took as long on two cores.
pub(crate) const MOST_AT_ONCE: usize = 1 << 19;

impl Cells {
    /// The transfer function without the widgets that no kept cell touches. Widgets over further fields stay: the fields
    /// are numbered by the whole transfer function.
    pub(crate) fn touched<'a>(&self, transfer_function: &'a TransferFunction) -> Cow<'a, TransferFunction> {
        let known = self.culled_for.as_ref() == Some(transfer_function);
        let all = self.untouched.len() == transfer_function.widgets.len();
        if !known || all || self.untouched.is_empty() {
            return Cow::Borrowed(transfer_function);
        }
        let mut touched = transfer_function.clone();
        let mut number = 0;
        touched.widgets.retain(|widget| {
            let untouched = self.untouched.contains(&number);
            number += 1;
            !untouched || !widget.profile.properties().fields.is_empty()
        });
        Cow::Owned(touched)
    }
}

/// Counts of a composited picture.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Counts {
    /// Ray segments integrated.
    pub segments: u64,
    /// Pixels (samples, where a pixel has several) whose segments were composited in an order that was not exact.
    pub pixels_disordered: u64,
    /// Cells that were projected: kept, and covering a pixel centre.
    pub cells_projected: u64,
    /// Segments integrated in 64 bits because 32 do not hold them.
    pub segments_exact: u64,
    /// How often the transfer function was asked: see [`voltet_optics::engine::Counts::evaluations`].
    pub evaluations: u64,
    /// Segments on which widgets overlap: the optical depths of some two multiply to more than 1e-8.
    pub segments_overlapping: u64,
    /// Tiles with more than 1,024 segments on a pixel.
    pub tiles_deep: u64,
    /// Tiles that were left because every pixel was opaque.
    pub tiles_stopped: u64,
    /// Cells that such tiles did not look at any more; a cell counts in each of them. Those that no ray came to are not counted.
    pub cells_hidden: u64,
    /// Tiles that rays were lost in from cell to cell, and that were drawn from their cells.
    pub tiles_lost: u64,
    /// Tiles whose pixels' segments were sorted.
    pub tiles_sorted: u64,
    /// Bytes of the integrator's tables.
    pub table_bytes: u64,
}
