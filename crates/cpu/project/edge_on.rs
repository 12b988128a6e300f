//! Faces seen edge-on: lines on the screen. Which of the two cells beside one gets a ray is decided by the rounded pixel coordinates,
//! by one rule for projected cells and precise cells, whichever of them lie beside it. A line that is all but level and crosses a row of
//! pixels is beyond that rule: its corners' rounding alone says where it crosses. Both cells are drawn in 64 bits then, by the plane.

use crate::tile::TILE;
use crate::tolerances::{EDGE_ON_AREA, EDGE_ON_COLUMN_DISTANCE, LEVEL_RATIO, LEVEL_ROW_DISTANCE};
use crate::view::{ScreenVertex, View};
use voltet_simd::{Double, Mask};

/// Classification of faces by their corners on the screen.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeOn<D: Double> {
    /// True if the face is seen edge-on.
    pub edge_on: D::Mask,
    /// True if it is level besides.
    pub level: D::Mask,
    /// True if it is level and crosses a row of pixels: none of its rays is decided by the rule.
    pub undecided: D::Mask,
}

/// `x`, `y`: pixel coordinates of the faces' corners. `area`: twice the area that they span there, without sign.
#[inline(always)]
pub(crate) fn edge_on<D: Double>(x: [D; 3], y: [D; 3], area: D) -> EdgeOn<D> {
    let [left, right] = range(x);
    let [top, bottom] = range(y);
    let (reach_x, reach_y) = (right - left, bottom - top);
    let edge_on = area.le(D::splat(EDGE_ON_AREA) * (reach_x + reach_y));
    let level = edge_on.and((D::splat(LEVEL_RATIO) * reach_y).lt(reach_x));
    EdgeOn { edge_on, level, undecided: level.and(top.ceil().lt(bottom.ceil())) }
}

/// True if a face of cells may be edge-on. `reach`: extent of the cells' corners on the screen, in x and y together.
#[inline(always)]
pub(crate) fn may_be_edge_on<D: Double>(area: D, reach: D) -> D::Mask {
    area.le(D::splat(EDGE_ON_AREA) * reach)
}

#[inline(always)]
fn range<D: Double>([a, b, c]: [D; 3]) -> [D; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

#[derive(Debug, Clone, Copy)]
pub(crate) struct EdgeOnFace {
    corners: [ScreenVertex; 3],
    /// True if its cell lies to the right of the line; below it.
    right: bool,
    below: bool,
    /// Rows of pixels that it lies between, if it is level.
    level: Option<[f64; 2]>,
    /// Columns from a crossing within which rounding decides.
    beside: f32,
}

impl EdgeOnFace {
    /// `corners`: of the face, in eye space, by ascending number. `inward`: where its cell lies, on the screen. `None` where the
    /// face is not seen edge-on, or reaches behind the eye.
    pub fn of(view: &View, corners: [[f64; 3]; 3], inward: [f64; 2]) -> Option<EdgeOnFace> {
        if view.perspective && corners.iter().any(|corner| corner[2] <= 0.0) {
            return None;
        }
        let corners = corners.map(|corner| view.pixel_from_eye(corner));
        let [x, y] = [corners.map(|corner| corner.x), corners.map(|corner| corner.y)];
        let area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
        let EdgeOn { edge_on: true, level, undecided: false } = edge_on(x, y, area.abs()) else {
            return None;
        };
        // The longest edge gives the direction, the 64-bit plane the side.
        let along = [[0, 1], [0, 2], [1, 2]].map(|[a, b]| [x[b] - x[a], y[b] - y[a]]);
        let long = |d: &[f64; 2]| d[0] * d[0] + d[1] * d[1];
        let [dx, dy] = along.into_iter().max_by(|a, b| long(a).total_cmp(&long(b)))?;
        let turned = if dx * inward[1] - dy * inward[0] < 0.0 { [dy, -dx] } else { [-dy, dx] };
        let level = level.then_some(range(y));
        let beside = EDGE_ON_COLUMN_DISTANCE * (dx / dy).abs().max(1.0) as f32;
        Some(EdgeOnFace { corners, right: turned[0] > 0.0, below: turned[1] > 0.0, level, beside })
    }

    /// True if the line leaves a pixel to its cell; `None` where the line does not pass there: the plane decides then. A face may be a
    /// line on the screen also since it is narrow, whichever way it looks.
    pub fn admits(&self, [i, j]: [usize; 2]) -> Option<bool> {
        let edges = [[0, 1], [0, 2], [1, 2]].map(|ends| ends.map(|k| &self.corners[k]));
        let crossings = edges.into_iter().filter_map(|ends| crossing_of_row(ends, [i, j]));
        let crossing = crossings.reduce(if self.right { f32::min } else { f32::max });
        let column = (i % TILE) as f32;
        match (crossing, self.level) {
            (Some(x), _) => ((x - column).abs() <= self.beside).then_some(self.right == (x.ceil() <= column)),
            (None, Some([top, bottom])) => {
                let row = j as f64;
                (top - LEVEL_ROW_DISTANCE..=bottom + LEVEL_ROW_DISTANCE)
                    .contains(&row)
                    .then_some(self.below == (bottom <= row))
            }
            (None, None) => None,
        }
    }
}

/// 1.5 · 2²³ · 2⁻¹⁷: adding and taking away this times a power of two rounds to 2⁻¹⁷ of that power (up to 32 times
/// it, twice a tile; beyond, where spans are cut off, more coarsely).
pub(crate) const CROSSING_ROUND: f32 = 96.0;

/// Crossing of the edge between two points with the row of a pixel (columns from the left edge of the tile that holds the pixel); `None`
/// where the edge does not cross it. Bit for bit the value that [`crate::fragments::spans`] finds.
pub(crate) fn crossing_of_row(ends: [&ScreenVertex; 2], [i, j]: [usize; 2]) -> Option<f32> {
    let [upper, lower] = if ends[0].y <= ends[1].y { ends } else { [ends[1], ends[0]] };
    let (left, top) = ((i - i % TILE) as f64, (j - j % TILE) as f64);
    let row = (j % TILE) as f32;
    let rows = (upper.y.ceil() - top) as f32..(lower.y.ceil() - top) as f32;
    if !rows.contains(&row) {
        return None;
    }
    let tilt = (lower.x - upper.x) / (lower.y - upper.y);
    let at_top = (top - upper.y).mul_add(tilt, upper.x - left) as f32;
    let slope = tilt as f32;
    let power = f32::from_bits(slope.abs().clamp(1.0, 1e6).to_bits() & 0x7f80_0000);
    let x = row.mul_add(slope, at_top);
    Some((x + power * CROSSING_ROUND) - power * CROSSING_ROUND)
}
