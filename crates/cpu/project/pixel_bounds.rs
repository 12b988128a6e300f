//! Corners on the screen of as many cells as there are 64-bit lanes, and the pixel centres that their boxes cover.

use crate::tolerances::{MAX_CELL_DEPTH_RATIO, SPAN_SLACK};
use crate::view::{ScreenVertex, View};
use voltet_simd::{Double, Mask, inlined};

/// Most 64-bit lanes.
pub(crate) const MAX_DOUBLE_LANES: usize = 8;

/// Four corners of each cell.
#[derive(Clone, Copy)]
pub(crate) struct Corners<D: Double> {
    pub x: [D; 4],
    pub y: [D; 4],
    pub z: [D; 4],
}

/// Pixel centres that a cell's box covers, and those that its spans may round to.
#[derive(Clone, Copy)]
pub(crate) struct PixelBounds<D: Double> {
    /// First column, and the one behind the last.
    pub columns: [D; 2],
    /// First row, and the one behind the last.
    pub rows: [D; 2],
    /// True if 32 bits hold its depths.
    pub in_depth: D::Mask,
    /// True if there are such pixels.
    pub any: D::Mask,
}

#[inline(always)]
pub(crate) fn load<D: Double>(rows: &[[f64; MAX_DOUBLE_LANES]; 4]) -> [D; 4] {
    [D::load(&rows[0]), D::load(&rows[1]), D::load(&rows[2]), D::load(&rows[3])]
}

#[inline(always)]
pub(crate) fn min_of<D: Double>(c: &[D; 4]) -> D {
    c[0].min(c[1]).min(c[2].min(c[3]))
}

#[inline(always)]
pub(crate) fn max_of<D: Double>(c: &[D; 4]) -> D {
    c[0].max(c[1]).max(c[2].max(c[3]))
}

impl<D: Double> Corners<D> {
    /// `group`: numbers of the tetrahedra, at least one; the lanes behind them are filled with the last.
    #[inline(always)]
    pub fn gather(vertices: &[ScreenVertex], tetrahedra: &[[u32; 4]], group: &[u32]) -> Corners<D> {
        let [mut x, mut y, mut z] = [[[0.0; MAX_DOUBLE_LANES]; 4]; 3];
        for lane in 0..D::COUNT {
            let tetrahedron = &tetrahedra[group[lane.min(group.len() - 1)] as usize];
            for (k, &point) in tetrahedron.iter().enumerate() {
                let vertex = &vertices[point as usize];
                x[k][lane] = vertex.x;
                y[k][lane] = vertex.y;
                z[k][lane] = vertex.z;
            }
        }
        Corners { x: load(&x), y: load(&y), z: load(&z) }
    }

    /// Pixels of a picture that the boxes cover.
    #[inline(always)]
    pub fn covered(&self, view: &View) -> PixelBounds<D> {
        let splat = D::splat;
        let zero = splat(0.0);
        let size = [view.size[0] as f64, view.size[1] as f64];
        let within = inlined!(|end: D, size: f64| end.ceil().max(zero).min(splat(size)));
        let beside = splat(SPAN_SLACK);
        let columns = [within(min_of(&self.x) - beside, size[0]), within(max_of(&self.x) + beside, size[0])];
        let rows = [within(min_of(&self.y), size[1]), within(max_of(&self.y), size[1])];
        let (nearest, farthest) = (min_of(&self.z), max_of(&self.z));
        let in_depth = if view.perspective {
            zero.lt(nearest).and(farthest.le(splat(MAX_CELL_DEPTH_RATIO) * nearest))
        } else {
            nearest.le(farthest)
        };
        let any = columns[0].lt(columns[1]).and(rows[0].lt(rows[1]));
        PixelBounds { columns, rows, in_depth, any }
    }
}
