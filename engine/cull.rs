//! Cull: keep each tetrahedron that could contribute.
//!
//! Conservative in truth: a cell is left out only if no point of the convex hull of its four (s, g) pairs comes
//! near enough to any widget to matter, or if it lies outside one plane of the view. The papers test the four
//! vertices only (Song et al. 2009), which drops a cell whose vertices straddle a narrow widget.

use crate::attribute::attributes_of;
use crate::cells::Cells;
use crate::view::View;
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use voltet_core::camera::Camera;
use voltet_core::grid::extent;
use voltet_core::progress::Progress;
use voltet_core::shading::Order;
use voltet_core::transfer::{Support, TransferFunction};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_lanes::LaneSet;

/// Optical depth that all culled cells together may have along the longest ray: a tenth of the 1e-6 that a
/// pixel may change.
const DEPTH_LEFT_OUT: f64 = 1e-7;

/// Keeps each tetrahedron that could contribute to the picture. Culling changes no pixel by more than 1e-6.
///
/// Errors: a camera out of range, a transfer function that looks at quantities the volume does not have.
pub fn cull(
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
    progress: &dyn Progress,
) -> Result<Cells> {
    let grid = &volume.grid;
    let mut cells = none_kept(volume)?;
    let (length, ranges) = (cells.length, cells.ranges);
    let view = View::new(camera, length, [0.0; 2])?;
    let (seen, outside) = view.see(&grid.points);
    cells.seen = Some((*camera, Arc::new(seen)));
    progress.report("cull", 0.3);
    let attributes = attributes_of(&cells, transfer_function)?;
    let corner_values = CornerValues {
        s: attributes[0].values,
        g: attributes.get(1).filter(|_| transfer_function.uses_gradient_magnitude()).map(|a| a.values),
        fields: attributes.iter().skip(2).map(|a| a.values).collect(),
    };
    let touched: Vec<AtomicBool> = transfer_function.widgets.iter().map(|_| AtomicBool::new(false)).collect();
    // A cell whose density is nowhere above this adds less than DEPTH_LEFT_OUT over the whole diagonal.
    let support = Support::new(transfer_function)?;
    let least = DEPTH_LEFT_OUT / length;

    let touched_count = touched.len();
    // What not even the box of all values touches is not asked for, cell by cell.
    let [[s0, s1], [g0, g1]] = ranges;
    let conceivable: Vec<usize> = (0..touched_count)
        .filter(|&w| support.widget_touches(w, &[s0, s1, s0, s1], &[g0, g0, g1, g1], &[], least))
        .collect();
    const CHUNK: usize = 1 << 14;
    let parts: Vec<(Vec<u32>, u64, u64)> = grid
        .tetrahedra
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, tetrahedra)| {
            let mut kept = Vec::with_capacity(CHUNK);
            let (mut by_function, mut by_frustum, mut toucher) = (0, 0, 0);
            for (k, corners) in tetrahedra.iter().enumerate() {
                let at = corners.map(|p| p as usize);
                if at.iter().fold(u8::MAX, |all, &p| all & outside[p]) != 0 {
                    by_frustum += 1;
                    continue;
                }
                let values = corner_values.of(&at);
                match values.touch(|s, g, fields| support.toucher(toucher, s, g, fields, least)) {
                    Some(widget) => {
                        toucher = widget;
                        kept.push((chunk * CHUNK + k) as u32);
                    }
                    None => by_function += 1,
                }
            }
            // Which widgets are worth their place; asked until one cell says so.
            for &widget in &conceivable {
                let touched = &touched[widget];
                let touches = |id: &u32| {
                    let values = corner_values.of(&grid.tetrahedra[*id as usize].map(|p| p as usize));
                    values.touch(|s, g, fields| support.widget_touches(widget, s, g, fields, least))
                };
                if !touched.load(Ordering::Relaxed) && (touched_count == 1 || kept.iter().any(touches)) {
                    touched.store(true, Ordering::Relaxed);
                }
            }
            (kept, by_function, by_frustum)
        })
        .collect();
    if progress.cancelled() {
        return Err(Error::cancelled());
    }
    let mut kept = Vec::with_capacity(parts.iter().map(|(kept, ..)| kept.len()).sum());
    for (part, by_function, by_frustum) in &parts {
        kept.extend_from_slice(part);
        cells.culled_by_transfer_function += by_function;
        cells.culled_by_frustum += by_frustum;
    }
    cells.kept = Arc::new(kept);
    cells.untouched = (0..touched.len()).filter(|&w| !touched[w].load(Ordering::Relaxed)).collect();
    cells.culled_for = Some(transfer_function.clone());
    Ok(cells)
}

/// Keeps every tetrahedron and every widget, for comparison with [`cull`]: the picture is the same, by more work. Nothing
/// is handed on to the project stage that it could use again.
///
/// Errors: those of [`cull`].
pub fn keep_all(
    volume: &Arc<Volume>,
    transfer_function: &TransferFunction,
    camera: &Camera,
) -> Result<Cells> {
    let mut cells = none_kept(volume)?;
    View::new(camera, cells.length, [0.0; 2])?;
    attributes_of(&cells, transfer_function)?;
    let count = u32::try_from(volume.grid.tetrahedra.len()).map_err(|_| {
        Error::run("the grid has too many tetrahedra").accepted(format!("at most {}", u32::MAX))
    })?;
    (cells.kept, cells.no_leave_out) = (Arc::new((0..count).collect()), true);
    Ok(cells)
}

/// What is known of a volume before any cell is kept.
pub(crate) fn none_kept(volume: &Arc<Volume>) -> Result<Cells> {
    let range = |values: &[f64]| extent::range(values).unwrap_or_default();
    Ok(Cells {
        volume: volume.clone(),
        kept: Arc::default(),
        order: Order::Exact,
        culled_by_transfer_function: 0,
        culled_by_frustum: 0,
        length: extent::scene_length(extent::bounds(&volume.grid.points))?,
        seen: None,
        ranges: [range(&volume.scalar), volume.gradient_magnitude.as_ref().map_or([0.0; 2], |g| range(g))],
        untouched: Vec::new(),
        no_leave_out: false,
        lanes: LaneSet::detect()?,
        culled_for: None,
        steepest: volume.gradient.as_ref().map_or(0.0, |gradient| {
            let [low, high] = range(bytemuck::cast_slice(gradient));
            low.abs().max(high.abs())
        }),
    })
}

/// The point arrays that cells are held against.
struct CornerValues<'a> {
    s: &'a [f64],
    g: Option<&'a [f64]>,
    fields: Vec<&'a [f64]>,
}

/// Most further fields that the culling test looks at; a scene with more keeps the cells that only those would cull.
const FIELDS_MOST: usize = 8;

/// Values at the corners of one cell.
struct CellValues {
    s: [f64; 4],
    g: [f64; 4],
    fields: [[f64; 4]; FIELDS_MOST],
    field_count: usize,
}

impl CornerValues<'_> {
    #[inline]
    fn of(&self, corners: &[usize; 4]) -> CellValues {
        let mut fields = [[0.0; 4]; FIELDS_MOST];
        let field_count = if self.fields.len() <= FIELDS_MOST { self.fields.len() } else { 0 };
        for (field, values) in fields.iter_mut().zip(&self.fields).take(field_count) {
            *field = corners.map(|p| values[p]);
        }
        CellValues {
            s: corners.map(|p| self.s[p]),
            g: self.g.map_or([0.0; 4], |g| corners.map(|p| g[p])),
            fields,
            field_count,
        }
    }
}

impl CellValues {
    #[inline]
    fn touch<T>(&self, test: impl FnOnce(&[f64; 4], &[f64; 4], &[[f64; 4]]) -> T) -> T {
        test(&self.s, &self.g, &self.fields[..self.field_count])
    }
}
