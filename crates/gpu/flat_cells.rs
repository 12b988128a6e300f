//! Flat cells, whose faces the rounding of points to 32 bits moves by a visible part of their distance.
//!
//! Both cells of a face find the same face, so that a move takes from one cell what it gives to the other. It is seen where nothing
//! makes up for it: at the outer surface of a thin layer, and where the values at the rounded corners are others.
//!
//! Symbols, lengths in scene lengths: h, the least height of a cell; d, the move of its largest face along the normal; κ, the most that
//! a ray loses or gains in it. A chord has the optical depth T = κh, and the move changes its transmittance by (d/h) T e^(−T) at
//! most: by κd, or d/(he) at T = 1. (Behind a lesser density than κ the depth may be 1 where κh is more.)

use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::E;
use voltet_core::grid::extent::{self, longest_edge_squared};
use voltet_core::transfer::{Corners, Support, TransferFunction, box_corners};
use voltet_core::volume::Volume;
use voltet_core::{Error, Result};
use voltet_shaders::ViewRecord;

/// Longest edge by least height from which on a cell is flat. Thicker ones have neighbours that make up for what a move takes.
const FLATNESS: f64 = 1e3;

/// Change of a pixel by one moved face that is allowed: half the bound of ordinary pictures, since a layer has two sides.
const MAX_CHANGE: f64 = 1e-4;

/// Rounding of a coordinate about the view's base, and of the turn into camera axes, as a share of the coordinate.
const ROUNDING: f64 = f32::EPSILON as f64;

pub(crate) struct FlatCell {
    cell: u32,
    /// Least height, scene lengths.
    height: f64,
    /// Unit normal of the largest face.
    normal: DVec3,
}

impl FlatCell {
    /// `None` for a cell that is not flat, or has no volume. `corners`: in scene lengths.
    pub fn new(cell: u32, corners: [DVec3; 4]) -> Option<FlatCell> {
        let [a, b, c, d] = corners;
        let faces = [(b - a).cross(c - a), (b - a).cross(d - a), (c - a).cross(d - a), (c - b).cross(d - b)];
        let largest = faces.into_iter().max_by(|x, y| x.length_squared().total_cmp(&y.length_squared()))?;
        let height = faces[0].dot(d - a).abs() / largest.length();
        let is_flat = height > 0.0 && FLATNESS * height < longest_edge_squared(corners).sqrt();
        is_flat.then(|| FlatCell { cell, height, normal: largest.normalize() })
    }
}

pub(crate) struct FlatCells {
    pub cells: Vec<FlatCell>,
    /// Middle of the grid's box, which corners are counted from, world units.
    pub centre: DVec3,
    /// World units in the scene length.
    pub length: f64,
}

impl FlatCells {
    /// Checks that none is so dense that its moved faces are seen. `volume` is the one that the cells are of.
    pub fn check(
        &self,
        volume: &Volume,
        transfer_function: &TransferFunction,
        view: &ViewRecord,
    ) -> Result<()> {
        let FlatCells { cells, centre, length } = self;
        let world = |v: [f32; 3]| DVec3::from(v.map(f64::from));
        let base = world(view.base_high) + world(view.base_low);
        // No widget is denser than its peak, and no point farther from the base than the grid's middle and half a diagonal.
        let brightest = |peak: f64, emission: f64| peak.max(1.0) * emission.max(1.0);
        let widgets = transfer_function.widgets.iter().filter(|widget| widget.is_drawn());
        let most: f64 = widgets.map(|widget| brightest(widget.peak(), widget.max_emission())).sum();
        let scale = length / transfer_function.unit_distance;
        if cells.is_empty() || most * scale * (1.0 + 2.0 * base.length()) * ROUNDING <= MAX_CHANGE {
            return Ok(());
        }
        let support = Support::new(transfer_function)?;
        let names = transfer_function.fields();
        let arrays = names.iter().filter_map(|name| volume.grid.point_arrays.get(*name));
        let fields: Vec<&[f64]> = arrays.map(|array| &array.values[..]).collect();
        let axes = [view.right, view.down, view.forward].map(world);
        let refused = |flat: &FlatCell| {
            let points = volume.grid.tetrahedra[flat.cell as usize].map(|point| point as usize);
            let seen = points.map(|p| (volume.grid.points[p] - *centre) / *length - base);
            let moved_at =
                |p: DVec3| axes.iter().map(|axis| (flat.normal.dot(*axis) * p.dot(*axis)).abs()).sum::<f64>();
            // At the farthest corner alone the face moves where the cell ends in a point.
            let mut moved = seen.map(moved_at);
            moved.sort_by(f64::total_cmp);
            let moved = ROUNDING * moved[2];
            if moved / (flat.height * E) <= MAX_CHANGE {
                return None;
            }
            let of = |values: &[f64]| points.map(|p| values[p]);
            let fields: Vec<[f64; 4]> = fields.iter().map(|values| of(values)).collect();
            let g = volume.gradient_magnitude.as_ref().map_or([0.0; 4], |g| of(g));
            let mut values = (of(&volume.scalar), g);
            if transfer_function.has_curved_axes() {
                let ranges = [values.0, values.1].map(|values| extent::range(&values).unwrap_or_default());
                let scales = transfer_function.axes_read();
                values = box_corners(scales[0].positions(ranges[0]), scales[1].positions(ranges[1]));
            }
            let (s, g) = &values;
            let density = length * support.bound(&Corners { s, g, fields: &fields });
            (density * moved > MAX_CHANGE).then(|| too_dense(flat, density, MAX_CHANGE / moved))
        };
        cells.par_iter().find_map_first(refused).map_or(Ok(()), Err)
    }
}

fn too_dense(FlatCell { cell, height, .. }: &FlatCell, density: f64, allowed: f64) -> Error {
    let diagonal = "of the grid's diagonal thick, with an optical depth of up to";
    Error::run("a flat cell is too dense for the device's 32 bits, which move its faces visibly")
        .got(format!("tetrahedron {cell}, {height:.1e} {diagonal} {density:.1e} over the diagonal"))
        .expected(format!("at most {allowed:.1e} in so flat a cell; engine = \"cpu\" holds it"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_flat_by_their_height_over_the_largest_face() {
        let height = |z: f64| {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::new(0.3, 0.3, z)];
            FlatCell::new(7, corners).map(|flat| (flat.height, flat.normal.z.abs()))
        };
        assert_eq!((height(0.1), height(0.0)), (None, None));
        let (height, normal) = height(1e-4).expect("flat");
        assert!((height - 1e-4).abs() < 1e-12 && (normal - 1.0).abs() < 1e-6, "{height} {normal}");
        // Four points near a line are needles, thin in two directions.
        let needle = [DVec3::ZERO, DVec3::X, 1e-5 * DVec3::Y, 1e-5 * DVec3::Z];
        assert!(FlatCell::new(0, needle).is_some_and(|flat| flat.height < 1.1e-5));
    }
}
